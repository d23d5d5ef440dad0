#!/bin/sh
# bugs.sh [TEXT] -- can the tests fail? Each patch of test/bugs/ (whose name contains TEXT) puts one
# plausible fault of physics into a copy of the tree. The cases that its first line names,
# "tests: SUITE/CASE ... -- what is wrong", must pass without it, and one of them must fail with it.
# Prints what caught each, then "N passed, N failed".
set -u
unset MAKEFLAGS MFLAGS MAKELEVEL 2>/dev/null

top=$(cd "$(dirname "$0")/.." && pwd) || exit 1
work=${TMPDIR:-/tmp}/rushlight-bugs.$$
mkdir "$work" || exit 1
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT TERM
cp -R "$top/src" "$top/test" "$top/bench" "$top/scenes" "$work" || exit 1
cd "$work" || exit 1

build() {
    sh src/rules.sh bugs 0 "${CC:-cc}" -O1 "" && make -j 2 -f build/bugs/rules.mk build/bugs/test
}

# The cases of these filters that fail, on one line.
failures() {
    for filter in "$@"; do
        build/bugs/test "$filter" > out.txt 2>&1
        sed -n 's/^FAILED //p' out.txt
        grep -q '^[1-9][0-9]* passed\|[1-9][0-9]* failed$' out.txt || echo "$filter: no such case"
    done | tr '\n' ' '
}

filters_of() { sed -n '1s/^tests: *\(.*\) -- .*/\1/p' "$1"; }
files_of() { sed -n 's|^+++ b/||p' "$1"; }

passed=0 failed=0
good() { passed=$((passed + 1)); echo "$1"; }
bad() { failed=$((failed + 1)); echo "FAILED $1"; }

patches=$(ls test/bugs/*"${1:-}"*.patch)
if ! build > make.txt 2>&1; then
    tail -20 make.txt
    bad "the tree without a bug does not build"
    patches=
fi

all=$(for p in $patches; do filters_of "$p" | tr ' ' '\n'; done | sort -u)
caught=$(failures $all)
test -z "$caught" || bad "without any bug: $caught"

for p in $patches; do
    name=$(basename "$p" .patch)
    if ! patch -p1 -s -f < "$p" > patch.txt 2>&1; then
        cat patch.txt
        bad "$name: does not apply"
    elif ! build > make.txt 2>&1; then
        grep -i error make.txt | head -5
        bad "$name: does not build"
    else
        caught=$(failures $(filters_of "$p"))
        if test -n "$caught"; then good "$name: caught by $caught"
        else bad "$name: not caught by $(filters_of "$p")"
        fi
    fi
    for f in $(files_of "$p"); do       # back as it was, newer than what was built
        cp "$top/$f" "$f"
        rm -f "$f.orig" "$f.rej"
    done
done

echo "$passed passed, $failed failed"
test "$failed" -eq 0
