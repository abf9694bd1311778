#!/bin/sh
# SPDX-License-Identifier: MIT
# Gate: a file uses files below it, never in a circle. Looks at the symbols of the objects (nm):
# no circle of files, none of folders, and a folder takes from others only what layers.txt allows
# it. In the folder of a family of servos (src/servo/families.list) some files are folders of their
# own here, by their names: src/servo/rs30x/sim of sim.c and sim_*.c, .../words of words.c and
# words_*.c, .../family of family.c. Also finds banned functions that a macro hid from the source
# scan.
#
# usage: layers.sh BUILD     (BUILD holds the objects: BUILD/src/bus/*.o ...)
set -u

build=$1
nm=${NM:-nm}
table=$(dirname "$0")/layers.txt
bad=0
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT

# ---- who uses whom -------------------------------------------------------------------------

# uses: FILE FILE SYMBOL, the first takes the symbol from the second; open: FILE SYMBOL, taken from
# outside. The command's own symbols may be defined in several ports, of which one is built.
# Objects of files that are gone do not count.
(cd "$build" && find src ports tools/grctl -name '*.o' 2>/dev/null) | sort |
    while read -r object; do
        [ ! -f "${object%.o}.c" ] || echo "$object"
    done >"$work/objects"
(cd "$build" && xargs -r "$nm" -o -g <"$work/objects") |
    sed -n 's/^\([^ :]*\)\.o:/\1.c /p' | awk -v uses="$work/uses" -v outside="$work/outside" '
    $(NF - 1) == "U" || $(NF - 1) == "w" { wants[++n] = $1 " " $NF; next }
    { home[$NF] = $1 }
    END {
        printf "" >uses
        printf "" >outside
        for (i = 1; i <= n; i++) {
            split(wants[i], want, " ")
            if (!(want[2] in home)) {
                print wants[i] >outside
            } else if (home[want[2]] != want[1]) {
                print want[1], home[want[2]], want[2] >uses
            }
        }
    }'

# ---- circles -------------------------------------------------------------------------------

# circles NAME: of the pairs on standard input; what is in one, a line each.
circles() {
    tsort 2>&1 >/dev/null | sed -n 's/^tsort: \([^ ]*\/[^ ]*\)$/\1/p' | sort -u >"$work/circle"
    if [ -s "$work/circle" ]; then
        sed "s/\$/:1: layers: in a circle of $1/" "$work/circle"
        bad=1
    fi
}
awk '{ print $1, $2 }' "$work/uses" | sort -u >"$work/files"
circles files <"$work/files"
families=$(sed -n 's/^FAMILY(.*, *\([a-z0-9_]*\))$/\1/p' src/servo/families.list 2>/dev/null |
    tr '\n' ' ')
# The folder of a file, and the row of layers.txt that is for it.
folder='
    function folder(file) {
        if (file ~ /^src\/servo\/[^\/]*\/(sim|words|family)(_[a-z0-9_]*)?\.c$/) {
            sub(/(_[a-z0-9_]*)?\.c$/, "", file)
            return file
        }
        sub(/\/[^\/]*$/, "", file)
        sub(/\/(posix|win32)$/, "/PORT", file)
        return file
    }
    # The family that a folder belongs to, or nothing.
    function family(name,   part) {
        return split(name, part, "/") > 2 && part[2] == "servo" &&
            index(" " families, " " part[3] " ") ? part[3] : ""
    }
    function any(name,   part) {
        if (family(name) != "") {
            sub("/" family(name), "/FAMILY", name)
        }
        return name
    }'
awk "$folder"'{ print folder($1), folder($2) }' "$work/files" | awk '$1 != $2' |
    sort -u >"$work/folders"
circles folders <"$work/folders"

# ---- what a folder may use -----------------------------------------------------------------

awk -v table="$table" -v families="$families" "$folder"'
    BEGIN {
        while ((getline line <table) > 0) {
            sub(/#.*/, "", line)
            n = split(line, word, /[: ]+/)
            for (i = 2; i <= n; i++) {
                may[word[1] " " word[i]] = 1
            }
        }
    }
    # A row for FAMILY is for each of them, and what it may use of FAMILY is its own.
    function allowed(from, to) {
        if (((from " " to) in may) || ((any(from) " " to) in may)) {
            return 1
        }
        return family(to) != "" && (family(from) == "" || family(from) == family(to)) &&
            ((any(from) " " any(to)) in may)
    }
    {
        from = folder($1)
        to = folder($2)
        # The command may use the whole library; that it is public is looked at below.
        if (from ~ /^(tools|src\/classic)/ && to !~ /^(tools|src\/classic)/) {
            next
        }
        if (from != to && !allowed(from, to)) {
            print $1 ":1: layers: " $3 " comes from " to ", which " from " may not use"
        }
    }' "$work/uses" | sort >"$work/found"
if [ -s "$work/found" ]; then
    cat "$work/found"
    bad=1
fi

# ---- what a folder may take from outside ---------------------------------------------------

# What the compiler itself may ask for, and what assert() becomes.
helpers='__stack_chk_fail|__assert_fail|_GLOBAL_OFFSET_TABLE_|__aeabi_.*|__[a-z]+[dst][fi][0-9]?'
# Core: mem*, math, and strlen, which compilers make of loops.
math='sin|cos|sincos|tan|asin|acos|atan|atan2|sqrt|cbrt|hypot|exp|exp2|expm1|log|log2|log10|log1p'
math="$math|pow|fabs|floor|ceil|round|rint|nearbyint|trunc|lround|llround|lrint|llrint|fmod|modf"
math="$math|remainder|fmin|fmax|fdim|fma|copysign|scalbn|ldexp|frexp|nan|nextafter"
freestanding="mem(cpy|move|set|cmp|chr)|strlen|($math)f?|__(isnan|isinf|finite|signbit)f?"
banned='strcpy|strcat|stpcpy|sprintf|vsprintf|gets|strncpy|strncat|strtok|atoi|atof|atol|atoll'
banned="$banned|alloca|_?setjmp|longjmp|sleep|usleep"
output='printf|vprintf|puts|putchar|perror|stdout|stderr|exit|abort|_exit'
system='socket|connect|open|openat|read|write|poll|select|ioctl|clock_gettime|nanosleep|time'
system="$system|tc[sg]etattr|gettimeofday|pthread_.*|thrd_.*|fork|exec.*"
loop='event_.*|evutil_.*|bufferevent_.*'

# outside PATTERN ALLOWED DENIED: extended regular expressions, of the files' names and of whole
# names of symbols; an empty ALLOWED allows everything but the denied.
outside() {
    # A fortified function (__printf_chk) counts as what the source calls.
    grep -E "^($1) " "$work/outside" | sed 's/ __\(.*\)_chk$/ \1/' | grep -vE " ($helpers)\$" |
        awk -v allowed="^(${2:-.*})\$" -v denied="^($3)\$" '
            $2 ~ /^grobo_/ {
                print $1 ":1: layers: " $2 " is defined nowhere"
                next
            }
            $2 ~ denied || $2 !~ allowed {
                folder = $1
                sub(/\/[^\/]*$/, "", folder)
                print $1 ":1: layers: " folder " may not use " $2
            }' |
        sort -u >"$work/found"
    if [ -s "$work/found" ]; then
        cat "$work/found"
        bad=1
    fi
}

heap='src/base/memory\.c'
grep -vE "^$heap " "$work/outside" >"$work/rest"
mv "$work/rest" "$work/outside"
# What frames say is text.
words='src/servo/([^/]*/words(_[a-z0-9_]*)?\.c|words/.*)'
outside "$words" '' "$banned|$output|$system|$loop"
grep -vE "^$words " "$work/outside" >"$work/rest"
mv "$work/rest" "$work/outside"
outside 'src/(base|model|play|bus|servo|robot|sim|body)/.*' "$freestanding" "$banned"
outside 'src/motion/.*' '' "$banned|$output|$system|$loop"
outside 'ports/common/.*' '' "$banned|$output|$system|$loop|yaml_.*"
outside 'ports/posix/.*' '' "$banned|$output|$loop|yaml_.*"
outside 'src/link/.*' '' "$banned|$output|yaml_.*"

# The classic shelf is linked with the shared library: what it takes is exported.
sh "$(dirname "$0")/symbols.sh" --map 2>/dev/null | sed -n 's/^ *\(grobo_.*\);/\1/p' |
    sort >"$work/exported"
awk '$1 ~ /^src\/classic\// && $2 !~ /^src\/classic\// && $NF ~ /^grobo_/ { print $NF, $1 }' \
    "$work/uses" "$work/outside" |
    sort |
    join -v 1 - "$work/exported" |
    awk '{ print $2 ":1: layers: the shared library does not export " $1 }' >"$work/found"
if [ -s "$work/found" ]; then
    cat "$work/found"
    bad=1
fi

# The command is a user like any other: what it takes from the library is public.
sh "$(dirname "$0")/symbols.sh" --declared 2>/dev/null | sort >"$work/public"
awk '$1 ~ /^tools\/grctl\// && $NF ~ /^grobo_/ { print $NF, $1 }' "$work/uses" "$work/outside" |
    sort |
    join -v 1 - "$work/public" |
    awk '{ print $2 ":1: layers: not a public function: " $1 }' >"$work/found"
if [ -s "$work/found" ]; then
    cat "$work/found"
    bad=1
fi
exit $bad
