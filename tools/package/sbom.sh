#!/bin/sh
# SPDX-License-Identifier: MIT
# The bill of materials of a release, SPDX 2.3 in JSON, to standard output: `make sbom`.
#
# usage: tools/package/sbom.sh TARBALL
#
# The tarball contains no library of others. What it is linked with is named without a version:
# each distribution brings its own, and the Debian packages say which. The time is that of the last
# commit.
set -eu
cd "$(dirname "$0")/../.."

tarball=$1
sum=$(sha256sum <"$tarball" | cut -d ' ' -f 1)
version=$(sed -n 's/.*GROBO_VERSION_STRING "\(.*\)"/\1/p' include/grobo/version.h)
seconds=$(stat -c %Y CHANGELOG.md)
if [ -e .git ]; then
    seconds=$(git log -1 --format=%ct)
fi
created=$(date -u -d "@$seconds" +%Y-%m-%dT%H:%M:%SZ)

# NAME, licence, who is linked with it.
needs='libevent|BSD-3-Clause|library and command
libyaml|MIT|library and command
jansson|MIT|command
expat|MIT|command
libedit|BSD-3-Clause|command
ncurses|X11|command
mosquitto|EPL-2.0 OR BSD-3-Clause|agent and fleet'

cat <<J
{
  "spdxVersion": "SPDX-2.3",
  "dataLicense": "CC0-1.0",
  "SPDXID": "SPDXRef-DOCUMENT",
  "name": "libgrobo-$version",
  "documentNamespace": "https://grobo.example/spdx/libgrobo-$version-$sum",
  "creationInfo": { "created": "$created", "creators": ["Tool: tools/package/sbom.sh"] },
  "documentDescribes": ["SPDXRef-libgrobo"],
  "packages": [
    {
      "name": "libgrobo", "SPDXID": "SPDXRef-libgrobo", "versionInfo": "$version",
      "packageFileName": "$(basename "$tarball")", "downloadLocation": "NOASSERTION",
      "filesAnalyzed": false, "licenseConcluded": "MIT", "licenseDeclared": "MIT",
      "copyrightText": "NOASSERTION",
      "checksums": [{ "algorithm": "SHA256", "checksumValue": "$sum" }]
    }
J
echo "$needs" | while IFS='|' read -r name licence who; do
    cat <<J
    , {
      "name": "$name", "SPDXID": "SPDXRef-$name", "downloadLocation": "NOASSERTION",
      "filesAnalyzed": false, "licenseConcluded": "NOASSERTION", "licenseDeclared": "$licence",
      "copyrightText": "NOASSERTION", "comment": "linked by $who"
    }
J
done
echo '  ],'
echo '  "relationships": ['
echo "$needs" | cut -d '|' -f 1 | awk '{
    printf "%s    { \"spdxElementId\": \"SPDXRef-libgrobo\", ", comma
    printf "\"relationshipType\": \"DEPENDS_ON\", \"relatedSpdxElement\": \"SPDXRef-%s\" }\n", $0
    comma = "    ,\n" }'
echo '  ]'
echo '}'
