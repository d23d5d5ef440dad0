#!/bin/sh
# rules.sh VARIANT PORTABLE CC CFLAGS LDFLAGS -- writes build/VARIANT/rules.mk: one rule an object,
# with the headers it includes directly or through others, in syntax that every make reads.
set -eu
variant=$1 portable=$2 cc=$3 cflags=$4 ldflags=$5
dir=build/$variant
mkdir -p "$dir"
: "${cc:=cc}"

# Does the compiler take this flag without complaint?
takes() {
    echo 'int main(void) { return 0; }' > "$dir/probe.c"
    $cc $1 -c -o "$dir/probe.o" "$dir/probe.c" > "$dir/probe.log" 2>&1 && ! test -s "$dir/probe.log"
}

# Probing takes a while: once for each compiler and set of flags.
key="$variant $portable $cc $cflags $ldflags"
if test "$(cat "$dir/flags.key" 2>/dev/null)" != "$key"; then
    flags="-std=c99 -pedantic -D_POSIX_C_SOURCE=200809L -D_FILE_OFFSET_BITS=64 -Isrc"
    # fast: where C99 lets floats be computed as doubles (gcc on s390x does), they are not
    for f in -Wall -Wextra -Wshadow -Wstrict-prototypes -Wmissing-prototypes -ffp-contract=off \
             -fexcess-precision=fast -fno-math-errno -fno-trapping-math -pthread; do
        takes "$f" && flags="$flags $f"
    done
    case $variant in
    debug) opt="-g -O0" ;;
    asan)  opt="-g1 -O1 -fsanitize=address,undefined -fno-sanitize-recover=all" ;;
    tsan)  opt="-g1 -O1 -fsanitize=thread" ;;
    plain) opt="-O2 -DRUSHLIGHT_PLAIN" ;;
    *)     opt="-O3"; takes -O3 || opt="-O2"
           test "$portable" = 1 || { takes -march=native && opt="$opt -march=native"; } ;;
    esac
    link=
    case $variant in
    asan) link="-fsanitize=address,undefined" ;;
    tsan) link="-fsanitize=thread" ;;
    esac
    echo "$flags $opt $cflags" > "$dir/flags.c"
    echo "$link $ldflags" > "$dir/flags.ld"
    echo "$key" > "$dir/flags.key"
fi

{
    echo "# written by src/rules.sh"
    awk -v dir="$dir" -v cc="$cc" -v flags="$(cat "$dir/flags.c")" -v ld="$(cat "$dir/flags.ld")" '
    # A quoted include is written from src/ or, for test/ and bench/, from the top.
    /^#[ \t]*include[ \t]*"/ {
        name = $0; sub(/^[^"]*"/, "", name); sub(/".*/, "", name)
        direct[FILENAME] = direct[FILENAME] " " ((("src/" name) in have) ? "src/" name : name)
    }
    function closure(file, list, n, parts, i) {
        n = split(direct[file], parts, " ")
        for (i = 1; i <= n; i++)
            if (!(parts[i] in seen)) {
                seen[parts[i]] = 1
                list = list " " parts[i] closure(parts[i], "")
            }
        return list
    }
    function program(name, objects) {
        print dir "/" name ":" objects
        print "\t@echo linking " dir "/" name
        print "\t@" cc " " flags " -o " dir "/" name objects " -lm -lpthread " ld
    }
    BEGIN { for (i = 1; i < ARGC; i++) have[ARGV[i]] = 1 }
    END {
        for (i = 1; i < ARGC; i++) {
            file = ARGV[i]
            if (file !~ /\.c$/) continue
            split("", seen)
            obj = file; sub(/\.c$/, ".o", obj); obj = dir "/o/" obj
            folder = obj; sub(/\/[^\/]*$/, "", folder)
            print obj ": " file closure(file, "") " " dir "/flags.key"
            print "\t@mkdir -p " folder
            print "\t@echo " cc " " file
            print "\t@" cc " " flags " -I. -c -o " obj " " file
            if (file ~ /^src\/cli\/main\.c$/) main_o = obj
            else if (file ~ /^src\//) lib = lib " " obj
            else if (file ~ /^test\//) test = test " " obj
            else bench = bench " " obj
        }
        program("rushlight", lib " " main_o)
        program("test", lib test)
        program("bench", lib bench)
    }' $(ls src/*/*.h src/*/*.c test/*.h test/*.c bench/*.h bench/*.c 2>/dev/null)
} > "$dir/rules.new"
cmp -s "$dir/rules.new" "$dir/rules.mk" || mv "$dir/rules.new" "$dir/rules.mk"
rm -f "$dir/rules.new"
