#!/bin/sh
# SPDX-License-Identifier: MIT
# Compares the shared library with that of a tag, which is built from the repository. New functions
# are fine; what programs used before and is gone or changed is not, unless the SONAME is another
# one as well, or a reviewer has noted it in tools/lint/abi.suppr.
#
# usage: check-abi.sh TAG   TAG '': there is none yet
# environment: BUILD   where both are built
#              MAKE=make
set -u

tag=$1
if [ -z "$tag" ]; then
    echo 'check-abi: no tag yet: nothing to compare with'
    exit 0
fi
if ! command -v abidiff >/dev/null; then
    echo 'check-abi: no abidiff here: nothing is compared (tools/setup.sh --ci installs it)'
    exit 0
fi
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
git archive --prefix=before/ "$tag" | tar -x -C "$work" || exit 1

# library_of TREE BUILD: builds it with debugging information, of which abidiff lives.
library_of() {
    ${MAKE:-make} -C "$1" --no-print-directory -s BUILD="$2" CFLAGS='-O1 -g' lib >&2 &&
        find "$2" -maxdepth 1 -name 'libgrobo.so.*' -type f
}

soname() {
    readelf -d "$1" | sed -n 's/.*SONAME.*\[\(.*\)\]/\1/p'
}

before=$(library_of "$work/before" "$work/build") || exit 1
now=$(library_of . "$BUILD") || exit 1
if [ "$(soname "$before")" != "$(soname "$now")" ]; then
    echo "check-abi: $(soname "$before") became $(soname "$now"): programs are compiled anew"
    exit 0
fi
abidiff --no-added-syms --headers-dir1 "$work/before/include" --headers-dir2 include \
    --suppressions tools/lint/abi.suppr "$before" "$now"
status=$?
if [ $status -eq 0 ]; then
    echo "check-abi: programs of $tag work with this library"
else
    echo "check-abi: not as in $tag: raise the SONAME, or note what is fine in abi.suppr" >&2
fi
exit $status
