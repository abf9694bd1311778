#!/bin/sh
# SPDX-License-Identifier: MIT
# Gate: the shared library exports exactly what headers declare, and all of it are functions.
#
# usage: symbols.sh LIBRARY      compare
#        symbols.sh --declared   print the declared names, one a line, but for the classic library's
#        symbols.sh --pointers   of them only functions that take a pointer
#        symbols.sh --classic    print the names that the classic library exports
#        symbols.sh --map        print the version script, which is kept in src/libgrobo.map
set -u

nm=${NM:-nm}

# A declaration may go over several lines; its name stands before the first bracket that is not an
# attribute's, or before [ or ; for data.
declared() {
    cat include/grobo/*.h include/grobo/core/*.h include/grobo/classic/*.h \
        ports/posix/include/grobo/core/*.h 2>/dev/null | awk -v pointers="${2:-}" '
    /^GROBO_'"$1"'/ { text = ""; open = 1 }
    open { text = text " " $0 }
    open && /;/ {
        open = 0
        sub(/GROBO_(API|CLASSIC_API)/, "", text)
        while (sub(/__attribute__ *\(\([^()]*(\([^()]*\))?[^()]*\)\)/, "", text)) {
        }
        if (pointers && text !~ /\(.*([*[]|_fn )/) {
            next
        }
        sub(/[(;[].*/, "", text)
        sub(/ *$/, "", text)
        sub(/.*[^A-Za-z0-9_]/, "", text)
        print text
    }' | sort -u
}

# The list of what is exported, for whoever reviews a change of it, and for the linker.
map() {
    echo '# What the shared library exports: tools/lint/symbols.sh --map'
    echo 'GROBO_1 {'
    echo '    global:'
    declared API | sed 's/.*/        &;/'
    printf '    local:\n        *;\n};\n'
}

case ${1:-} in
--map) map && exit ;;
--classic) declared CLASSIC_API && exit ;;
--declared) declared API && exit ;;
--pointers) declared API yes && exit ;;
esac

work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
declared API >"$work/declared"
# The sanitizers and gcov add names of their own; the library that is checked has none of them.
"$nm" -D --defined-only "$1" | awk 'NF == 3 && $2 != "A" { sub(/@.*/, "", $3); print $3 }' |
    sort -u >"$work/exported"
bad=0
for name in $("$nm" -D --defined-only "$1" |
    awk 'NF == 3 && $2 !~ /[ATW]/ && $3 ~ /^grobo_/ { sub(/@.*/, "", $3); print $3 }'); do
    echo "$1:1: symbols: exports data, $name: a function reaches it"
    bad=1
done
map >"$work/map"
if [ -f src/libgrobo.map ] && ! cmp -s "$work/map" src/libgrobo.map; then
    echo "src/libgrobo.map:1: symbols: not what the headers declare (tools/lint/symbols.sh --map)"
    bad=1
fi
for name in $(comm -13 "$work/declared" "$work/exported"); do
    echo "$1:1: symbols: exports $name, which no header declares with GROBO_API"
    bad=1
done
for name in $(comm -23 "$work/declared" "$work/exported"); do
    place=$(find include -name '*.h' -exec grep -lE "(^|[^A-Za-z0-9_])$name *[(;[]" {} + |
        head -n 1)
    echo "$place:1: symbols: declares $name, which nobody defines"
    bad=1
done
for name in $(grep -v '^grobo_' "$work/exported"); do
    echo "$1:1: symbols: $name does not begin with grobo_"
    bad=1
done
# The classic library beside it: what its headers declare.
classic=$(dirname "$1")/$(basename "$1" | sed 's/libgrobo/libgrobo-classic/')
if [ "${1##*/}" != "${classic##*/}" ] && [ -f "$classic" ]; then
    declared CLASSIC_API >"$work/classic"
    "$nm" -D --defined-only "$classic" |
        awk 'NF == 3 && $2 != "A" { sub(/@.*/, "", $3); print $3 }' | sort -u |
        comm -3 - "$work/classic" >"$work/differ"
    if [ -s "$work/differ" ]; then
        sed "s,^[[:blank:]]*,$classic:1: symbols: declared or defined alone: ," "$work/differ"
        bad=1
    fi
fi
exit $bad
