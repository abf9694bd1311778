#!/bin/sh
# SPDX-License-Identifier: MIT
# Gate: each text of grctl that a person reads has its translation in tools/grctl/lang/*.po, with
# the same conversions; no translation is left over, none is empty.
#
# usage: lang.sh             what is wrong
#        lang.sh --update    write the texts of the sources into the catalogues (make messages)
set -u
export LC_ALL=C
bad=

lang=tools/grctl/lang
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT

# Headers first: their macros are part of other texts. The names have no blanks.
# shellcheck disable=SC2046
awk -f $lang/strings.awk $lang/rules.txt $(find tools/grctl -name '*.h' | sort) \
    $(find tools/grctl -name '*.c' | sort) include/grobo/error.h src/robot/trip.c src/play/names.c \
    >"$work/wanted" 2>"$work/unmarked" || {
    sed "s|\$| in $lang/rules.txt|" "$work/unmarked"
    bad=1
}

for catalogue in "$lang"/*.po; do
    if [ "${1:-}" = --update ]; then
        awk -v update=1 -f $lang/check.awk "$work/wanted" "$catalogue" >"$work/new" &&
            sed -e '$ { /^$/d; }' "$work/new" >"$catalogue"
    elif ! awk -f $lang/check.awk "$work/wanted" "$catalogue" >"$work/wrong"; then
        cat "$work/wrong"
        bad=1
    fi
done
if [ "${1:-}" != --update ] && [ -n "${bad:-}" ]; then
    echo "lang: 'make messages' adds what is missing to $lang/*.po, with an empty msgstr to fill in"
fi
exit "${bad:-0}"
