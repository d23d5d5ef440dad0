#!/bin/sh
# gallery.sh BENCH OUT SPP [PROBES] -- renders every scene of scenes/, 232 pixels wide, and puts them
# all on one sheet, in the order of their names. PROBES: a folder whose probe.hdr lights them instead.
set -eu
bench=$1 out=$2 spp=$3 probes=${4:-}
work=$(mktemp -d "${TMPDIR:-/tmp}/rushlight-gallery-XXXXXX") || exit 1
trap 'rm -rf "$work"' EXIT
cp -R scenes "$work"
test -z "$probes" || cp "$probes/probe.hdr" "$work/scenes/probe.hdr"
for scene in "$work"/scenes/*.pbrt; do
    name=${scene##*/}
    size=$(awk '{ for (i = 1; i < NF; i++) if ($i ~ /^[xy]resolution"$/) { v = $(i + 1)
            if (v == "[") v = $(i + 2); if ($i ~ /^x/) x = v; else y = v } }
        END { print 232 "x" int(232 * y / x + 0.5) }' "$scene")
    ./rushlight "$scene" --spp "$spp" --size "$size" --quiet -o "$work/${name%.pbrt}.pfm"
done
"$bench" sheet 8 116 84 "$out" "$work"/*.pfm
