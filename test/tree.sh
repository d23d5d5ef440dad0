#!/bin/sh
# tree.sh -- the rules of the tree: rooms include only themselves and rooms above them, every file
# stands in the map, references are listed, lines are short, no path of a machine is written down.
set -u
cd "$(dirname "$0")/.." || exit 1
bad=$(mktemp "${TMPDIR:-/tmp}/rushlight-tree-XXXXXX") || exit 1
trap 'rm -f "$bad"' EXIT
rooms="base sampling image geometry accel bsdf scene scenefile lightsampling integrators render"
rooms="$rooms view cli"
ours="src/*/*.[ch] test/*.[ch] test/*.sh bench/*.[ch] src/*.sh"

awk -v rooms="$rooms" '
    BEGIN { n = split(rooms, r, " "); for (i = 1; i <= n; i++) level[r[i]] = i }
    FNR == 1 { split(FILENAME, part, "/"); room = part[2]
               if (!(room in level)) print FILENAME ": " room " is no room" }
    /^[ \t]*#[ \t]*include[ \t]*"/ {
        name = $0; sub(/^[^"]*"/, "", name); sub(/[\/"].*/, "", name)
        if (!(name in level)) print FILENAME ":" FNR ": include \"" name "/...\" is of no room"
        else if (level[name] > level[room])
            print FILENAME ":" FNR ": " room " may not include " name
    }' src/*/*.[ch] >> "$bad"

for f in src/*/*.[ch]; do
    base=${f##*/}
    room=${f%/*}
    awk -v room="### ${room#src/}/" -v name="- \`$base\`" '
        /^###? / { here = $0 == room } here && index($0, name) == 1 { found = 1 }
        END { exit !found }' src/README.md || echo "$f does not stand in src/README.md" >> "$bad"
done

# Keys of references look like Cline07 or PBRT4. They stand in brackets in comments, and first in
# the second string of a KindInfo; src/README.md lists them in its section of references.
awk '
    FILENAME == "src/README.md" {
        if (/^## /) refs = /[Rr]eferences/
        if (refs) { t = $0; while (match(t, /[A-Z][A-Za-z]*[0-9]+[a-z]?/)) {
            listed[substr(t, RSTART, RLENGTH)] = 1; t = substr(t, RSTART + RLENGTH) } }
        next
    }
    { t = $0
      while (match(t, /[\["; ][A-Z][A-Za-z]+[0-9][0-9]+[a-z]?[]; ,"]/)) {
          key = substr(t, RSTART + 1, RLENGTH - 2)
          before = substr(t, RSTART, 1)
          if ((before == "[" || (before == "\"" && $0 ~ /", *$|\["|info = \{|^ *\{ *"/)) &&
              !(key in listed) && !(key in said)) {
              said[key] = 1
              print FILENAME ":" FNR ": the reference " key " is not listed in src/README.md"
          }
          t = substr(t, RSTART + RLENGTH - 1)
      } }' src/README.md src/*/*.[ch] >> "$bad"

# Columns, not bytes: what continues a UTF-8 letter does not count.
LC_ALL=C awk '{ t = $0; gsub(/[\200-\277]/, "", t) }
    length(t) > 100 { print FILENAME ":" FNR ": has " length(t) " columns, 100 are the most" }
    /\t/ && FILENAME !~ /\.sh$/ { print FILENAME ":" FNR ": has a tab" }
    /[ \t]$/ { print FILENAME ":" FNR ": ends with a blank" }' $ours >> "$bad"

grep -nE '/(home|root|Users|work)/' Makefile README.md src/README.md bench/README.md .ci/run \
    scenes/*.pbrt \
    src/*/*.[ch] test/*.[ch] bench/*.[ch] >> "$bad"
grep -nE 'TODO|FIXME|XXX[^X]' src/*/*.[ch] test/*.[ch] | grep -v -- '-XXXXXX' >> "$bad"

if test -s "$bad"; then cat "$bad"; exit 1; fi
