#!/bin/sh
# builds.sh [NAME...] -- builds a copy of the tree in one way (or in all of them) and runs tests in
# it. The same bytes are promised whatever the compiler, its flags and the machine, so each build
# runs the suite `bytes`; those that stand for a kind of machine or C library run all the tests.
# Exit status: 0 passed, 1 failed, 77 the compiler or emulator is not here.
#
# NAME      builds with                                               runs
# gcc0-3    gcc -O0, -O2, -O3                                         bytes
# native    gcc with tuning to this processor, as `make` does         bytes
# clang     clang, with tuning; clang0: -O0, without                  bytes
# portable  make PORTABLE=1 with clang                                all
# plain     make V=plain: no compiler extensions                      all
# debug     make V=debug                                              bytes
# tcc       the Tiny C Compiler                                       all, of the rays some
# musl      musl's C library, statically                              all
# m32       32 bits, with SSE arithmetic                              all
# s390x     a big-endian machine, under emulation                     bytes
# bmake     BSD make                                                  bytes
# oneline   the one plain cc line of README.md                        a picture, compared
# headers   each header alone (but those that another one makes        -
#           something of), gcc and clang
# asan      address and undefined behaviour sanitizers                bytes, hostile input, faults
# tsan      thread sanitizer                                          bytes
set -u
unset MAKEFLAGS MAKELEVEL MFLAGS MAKE_TERMOUT 2>/dev/null
cd "$(dirname "$0")/.." || exit 1
top=$(pwd)
RUSHLIGHT_DATA=${RUSHLIGHT_DATA:-$top/../shared/data}
export RUSHLIGHT_DATA
jobs=$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 1)

skip() { echo "skipped: $1 is not here"; exit 77; }
need() { command -v "$1" > /dev/null || skip "$1"; }

# A copy of the tree. What to test: "all", or names of suites that need no other file of tests.
copy() {
    dir=$(mktemp -d "${TMPDIR:-/tmp}/rushlight-build-XXXXXX") || exit 1
    trap 'rm -rf "$dir"' EXIT
    trap 'exit 1' INT TERM
    cp -R Makefile README.md src scenes "$dir" || exit 1
    if test "$1" = all; then
        cp -R .ci bench test "$dir"
    else
        mkdir "$dir/test"
        cp test/*.h test/cli_help.c test/test_bytes.c "$dir/test"
        # the runner, with the one suite
        awk '/^#define SUITES\(X\)/ { print "#define SUITES(X) X(bytes)"; more = /\\$/; next }
             more { more = /\\$/; next } { print }' test/main.c > "$dir/test/main.c"
    fi
    cd "$dir" || exit 1
}

# built WHAT "T..." [MAKE-ARGUMENT...]: make, no warnings of gcc and clang, run the tests with one
# of the T in their names, see main.c. The program that runs them: $run.
run=
built() {
    what=$1 which=$2
    shift 2
    copy "$what"
    v=release
    for a in "$@"; do case $a in V=*) v=${a#V=} ;; esac; done
    ${make:-make} -j"$jobs" "$@" > log 2>&1 &&
        sh src/rules.sh "$v" "$(arg PORTABLE 0 "$@")" "$(arg CC cc "$@")" "$(arg CFLAGS '' "$@")" \
            "$(arg LDFLAGS '' "$@")" >> log 2>&1 &&
        ${make:-make} -j"$jobs" -f "build/$v/rules.mk" "build/$v/test" >> log 2>&1 ||
        { cat log; echo "does not build"; exit 1; }
    if grep -i 'warning' log; then echo "builds with warnings"; exit 1; fi
    $run "build/$v/test" --jobs "$jobs" $which || exit 1
}

# arg NAME DEFAULT [ARGUMENT...]: the value of NAME=value among the arguments
arg() {
    name=$1 value=$2
    shift 2
    for a in "$@"; do case $a in "$name"=*) value=${a#"$name"=} ;; esac; done
    printf '%s\n' "$value"
}

takes32() {
    printf '#include <errno.h>\nint main(void) { return errno; }\n' |
        $cc32 -x c -o /dev/null - 2> /dev/null
}

headers() {
    copy all
    for cc in gcc clang; do
        command -v $cc > /dev/null || continue
        for h in src/*/*.h; do
            test "$h" = src/geometry/triangle_lanes.h && continue
            printf '#include "%s"\ntypedef int Something;\n' "${h#src/}" > alone.c
            $cc -std=c99 -pedantic -Wall -Wextra -Wshadow -Wstrict-prototypes -Wmissing-prototypes \
                -Werror -Wno-unused-function -D_POSIX_C_SOURCE=200809L -Isrc -fsyntax-only \
                alone.c || { echo "$h does not compile alone ($cc)"; exit 1; }
        done
    done
}

oneline() {
    copy bytes
    line=$(sed -n 's/^    \(cc .*src\/\*\/\*\.c.*\)/\1/p' README.md)
    test -n "$line" || { echo "README.md has no cc line"; exit 1; }
    sh -c "$line" > log 2>&1 && test -x rushlight || { cat log; exit 1; }
    mv rushlight one
    make -j"$jobs" > log 2>&1 || { cat log; exit 1; }
    for p in ./one ./rushlight; do
        $p scenes/cornell.pbrt --quiet --size 48x48 --spp 4 -o "$p.pfm" || exit 1
    done
    cmp one.pfm rushlight.pfm || exit 1
}

build() {
    case $1 in
    gcc0) need gcc; built bytes bytes CC=gcc CFLAGS=-O0 PORTABLE=1 ;;
    gcc2) need gcc; built bytes bytes CC=gcc CFLAGS=-O2 PORTABLE=1 ;;
    gcc3) need gcc; built bytes bytes CC=gcc CFLAGS=-O3 PORTABLE=1 ;;
    native) need gcc; built bytes bytes CC=gcc ;;
    clang) need clang; built bytes bytes CC=clang ;;
    clang0) need clang; built bytes bytes CC=clang CFLAGS=-O0 PORTABLE=1 ;;
    portable) need clang; built all / CC=clang PORTABLE=1 ;;
    plain) built all / V=plain ;;
    debug) built bytes bytes V=debug ;;
    tcc)                # its code is 15 times slower: of the rays only some
        need tcc; built all "--except rays /" CC=tcc
        build/release/test rays/small rays_trees/arranged ;;
    musl) need musl-gcc; built all / CC=musl-gcc LDFLAGS=-static ;;
    m32)
        need gcc
        cc32="gcc -m32 -msse2 -mfpmath=sse"
        # where the headers of the kernel are those of 64 bits only
        takes32 || cc32="$cc32 -idirafter /usr/include/$(gcc -print-multiarch)"
        takes32 || skip "gcc -m32"
        built all / "CC=$cc32" PORTABLE=1 ;;
    s390x)
        need s390x-linux-gnu-gcc; need qemu-s390x
        run=qemu-s390x
        built bytes bytes CC=s390x-linux-gnu-gcc LDFLAGS=-static PORTABLE=1 ;;
    bmake) need bmake; make=bmake; built bytes bytes ;;
    oneline) oneline ;;
    headers) headers ;;
    asan) built all "hostile malformed faults cli bytes scenefile" V=asan ;;
    tsan) built bytes bytes V=tsan ;;
    *) echo "builds.sh: no build is called $1"; exit 1 ;;
    esac
}

if test $# = 1; then
    build "$1"
    exit 0
fi
test $# = 0 && set -- gcc0 gcc2 gcc3 native clang clang0 portable plain debug tcc musl m32 s390x \
    bmake oneline headers asan tsan
status=0
for name in "$@"; do
    echo "== $name"
    sh test/builds.sh "$name"
    case $? in 0|77) ;; *) echo "FAILED $name"; status=1 ;; esac
done
exit $status
