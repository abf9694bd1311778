#!/bin/sh
# SPDX-License-Identifier: MIT
# Makes the reference site of headers and documents, OUT/html, and man pages of the headers,
# OUT/man/man3: `make site`. Fails where Doxygen 1.9.4, that of Debian 12, warns of anything but a
# structure's field that has no comment: fields have names with units, and a comment where that does
# not suffice. What others warn of is shown.
#
# usage: tools/site/make.sh OUT
set -eu
cd "$(dirname "$0")/../.."

command -v doxygen >/dev/null || {
    echo 'site: doxygen is missing; tools/setup.sh --ci installs it' >&2
    exit 1
}
rm -rf "$1"
mkdir -p "$1"
OUT=$(cd "$1" && pwd)
TOP=$(pwd)
VERSION=$(sed -n 's/.*GROBO_VERSION_STRING "\(.*\)"/\1/p' include/grobo/version.h)
export OUT TOP VERSION

# made HTML MAN INPUT...
made() {
    { cat tools/site/Doxyfile && printf '%s\n' "GENERATE_HTML = $1" "GENERATE_MAN = $2"; } \
        >"$OUT/Doxyfile"
    shift 2
    echo "INPUT = $*" >>"$OUT/Doxyfile"
    doxygen "$OUT/Doxyfile"
    if grep -v -e ': warning: Member .* (variable) of \(struct\|union\) .* is not documented\.$' \
        "$OUT/warnings" >&2; then
        case $(doxygen --version) in 1.9.4*) exit 1 ;; esac
    fi
}
made NO YES include/grobo include/grobo/core
made YES NO tools/site/index.md docs docs/guide ports/README.md motions/README.md include/grobo \
    include/grobo/core
rm -f "$OUT/Doxyfile" "$OUT/warnings"
