#!/bin/sh
# SPDX-License-Identifier: MIT
# `make release`: says every step of a release that is missing and exits with 1, else makes the
# tarball and says how to tag it. The quick steps are looked at first, all of them; the tests and
# the sizes only when these are done.
# environment: BUILD=build; MAKE=make
set -u
cd "$(dirname "$0")/../.." || exit 1

make=${MAKE:-make}
build=${BUILD:-build}
missing=0

misses() {
    echo "release: $1" >&2
    missing=$((missing + 1))
}

refuse_if_missing() {
    [ $missing -eq 0 ] || exit 1
}

[ -e .git ] || {
    echo 'release: not a git checkout: a release is made of a commit' >&2
    exit 1
}
version=$(sed -n 's/.*GROBO_VERSION_STRING "\(.*\)"/\1/p' include/grobo/version.h)

# ---- what was written ----------------------------------------------------------------------

[ -z "$(git status --porcelain)" ] || misses 'the tree has changes: commit them'
grep -q -e "^## \[$version\] - [0-9-]\{10\}\$" CHANGELOG.md ||
    misses "CHANGELOG.md: no section \"## [$version] - $(date +%F)\""
unreleased=$(awk '/^## /{ open = /^## \[Unreleased\]/; next } open && NF' CHANGELOG.md | wc -l)
[ "$unreleased" -eq 0 ] ||
    misses "CHANGELOG.md: [Unreleased] has $unreleased lines: move them to the section of $version"
numbers=$(awk '/define GROBO_VERSION_(MAJOR|MINOR|PATCH)/ { printf "%s%s", dot, $3; dot = "." }' \
    include/grobo/version.h)
[ "$numbers" = "$version" ] || misses "version.h: the numbers are $numbers, the text is $version"
! git rev-parse -q --verify "refs/tags/v$version" >/dev/null ||
    misses "version.h: v$version is a tag already: raise the version"

# ---- the binary interface ------------------------------------------------------------------

# The names of a map, from stdin.
exported() {
    sed -n 's/^ *\(grobo_.*\);/\1/p' | sort
}

work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
last=$(git tag --list 'v[0-9]*' --sort=-version:refname | head -n 1)
if [ -n "$last" ]; then
    git show "$last:src/libgrobo.map" | exported >"$work/old"
    exported <src/libgrobo.map >"$work/new"
    gone=$(comm -23 "$work/old" "$work/new" | tr '\n' ' ')
    # Before 1.0.0 the second number counts changes of the interface, then the first.
    case $version in 0.*) place=2 ;; *) place=1 ;; esac
    [ -z "$gone" ] || [ "$(echo "${last#v}" | cut -d . -f -$place)" != \
        "$(echo "$version" | cut -d . -f -$place)" ] ||
        misses "src/libgrobo.map: without ${gone% } it is not the interface of $last"
fi
refuse_if_missing

# ---- what takes its time -------------------------------------------------------------------

for step in check size check-abi; do
    "$make" "$step" || misses "make $step failed"
    refuse_if_missing
done

sums=
for _ in 1 2; do
    "$make" dist BUILD="$build" >/dev/null || exit 1
    sums="$sums $(sha256sum <"$build/libgrobo-$version.tar.gz" | cut -d ' ' -f 1)"
done
# shellcheck disable=SC2086
[ "$(printf '%s\n' $sums | sort -u | wc -l)" -eq 1 ] || misses "two tarballs differ:$sums"
refuse_if_missing
tools/package/sbom.sh "$build/libgrobo-$version.tar.gz" >"$build/libgrobo-$version.spdx.json"
echo "release: $build/libgrobo-$version.spdx.json is its bill of materials"
echo "release: $build/libgrobo-$version.tar.gz, sha256 ${sums##* }"
echo "release: now git tag -a v$version -m \"libgrobo $version\""
