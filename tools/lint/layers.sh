#!/bin/sh
# SPDX-License-Identifier: MIT
# Gate: folders are layers, and a layer links without those above it. Looks at the symbols that
# the objects of a folder leave open (nm): each must come from a layer allowed to it, or from
# outside by the rules below. Also finds banned functions that a macro hid from the source scan.
#
# usage: layers.sh BUILD     (BUILD holds the objects: BUILD/src/core/*.o ...)
set -u

build=$1
nm=${NM:-nm}
bad=0
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT

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

# Names that the objects of the folders define, one a line.
defined() {
    for folder in "$@"; do
        find "$build/$folder" -name '*.o' 2>/dev/null
    done | xargs -r "$nm" -g --defined-only 2>/dev/null | awk 'NF == 3 { print $3 }' | sort -u
}

# layer FOLDER "FOLDERS BELOW" ALLOWED DENIED: both are extended regular expressions of whole names
# for symbols from outside; an empty ALLOWED allows everything but the denied.
layer() {
    folder=$1
    below=$2
    allowed=$3
    denied=$4
    [ -d "$build/$folder" ] || return
    # $below is a list.
    # shellcheck disable=SC2086
    defined "$folder" $below >"$work/known"
    find "$build/$folder" -name '*.o' | while read -r object; do
        # A fortified function (__printf_chk) counts as what the source calls.
        "$nm" -u "$object" | awk '{ print $NF }' | sed 's/^__\(.*\)_chk$/\1/' | sort -u |
            comm -23 - "$work/known" >"$work/open"
        source=${object#"$build"/}
        source=${source%.o}.c
        grep -vE "^($helpers)\$" "$work/open" | while read -r symbol; do
            if printf '%s\n' "$symbol" | grep -qE '^grobo_'; then
                echo "$source:1: layers: $symbol does not come from: $folder $below"
            elif [ -n "$allowed" ] && ! printf '%s\n' "$symbol" | grep -qE "^($allowed)\$"; then
                echo "$source:1: layers: $folder may not use $symbol"
            elif printf '%s\n' "$symbol" | grep -qE "^($denied)\$"; then
                echo "$source:1: layers: $folder may not use $symbol"
            fi
        done
    done >"$work/found"
    if [ -s "$work/found" ]; then
        cat "$work/found"
        bad=1
    fi
}

layer src/core '' "$freestanding" "$banned"
layer src/sim 'src/core' "$freestanding" "$banned"
layer src/body 'src/core src/motion' "$freestanding" "$banned"
loop='event_.*|evutil_.*|bufferevent_.*'
layer src/motion 'src/core' '' "$banned|$output|$system|$loop"
layer ports/common 'src/core' '' "$banned|$output|$system|$loop|yaml_.*"
layer ports/posix 'src/core ports/common' '' "$banned|$output|$loop|yaml_.*"
layer src/link 'src/core src/sim src/motion src/body ports/common ports/posix' '' \
    "$banned|$output|yaml_.*"

# The command is a user like any other: what it takes from the library is public.
if [ -d "$build/tools/grctl" ]; then
    sh "$(dirname "$0")/symbols.sh" --declared >"$work/public"
    defined tools/grctl >>"$work/public"
    sort -u "$work/public" >"$work/known"
    find "$build/tools/grctl" -name '*.o' | xargs -r "$nm" -u | awk '/ grobo_/ { print $NF }' |
        sort -u | comm -23 - "$work/known" >"$work/found"
    if [ -s "$work/found" ]; then
        sed 's/^/tools\/grctl:1: layers: not a public function: /' "$work/found"
        bad=1
    fi
fi
exit $bad
