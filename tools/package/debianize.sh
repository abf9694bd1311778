#!/bin/sh
# SPDX-License-Identifier: MIT
# Lays debian/ into a copy of the sources, with a changelog whose version is that of the headers.
#
# usage: tools/package/debianize.sh TREE VERSION
# environment: SOURCE_DATE_EPOCH, the changelog's time; DEBFULLNAME, DEBEMAIL: the maintainer
set -eu

cp -R tools/package/debian "$1/debian"
if [ -n "${DEBEMAIL:-}" ]; then
    awk -v who="${DEBFULLNAME:-libgrobo developers} <$DEBEMAIL>" \
        '/^Maintainer:/ { $0 = "Maintainer: " who } { print }' \
        tools/package/debian/control >"$1/debian/control"
fi
maintainer=$(sed -n 's/^Maintainer: //p' "$1/debian/control")
cat >"$1/debian/changelog" <<C
libgrobo ($2-0upstream1) unstable; urgency=medium

  * Version $2; changelog.gz of each package lists what changed.

 -- $maintainer  $(date -R -u -d "@$SOURCE_DATE_EPOCH")
C
