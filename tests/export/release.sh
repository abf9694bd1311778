#!/bin/sh
# SPDX-License-Identifier: MIT
# `make release` refuses where a step is missing, and names it. The tests and sizes, which take
# long, are stood in for by a make that only notes what it was asked for.
set -u

. tests/support/tap.sh
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
unset BUILD MAKEFLAGS MAKELEVEL MFLAGS
GIT_AUTHOR_NAME=a GIT_AUTHOR_EMAIL=a@example.org GIT_COMMITTER_NAME=a
GIT_COMMITTER_EMAIL=a@example.org
export GIT_AUTHOR_NAME GIT_AUTHOR_EMAIL GIT_COMMITTER_NAME GIT_COMMITTER_EMAIL

if ! command -v git >/dev/null; then
    test_case 'a release'
    skip 'a release' 'no git'
    done_testing
    exit 0
fi

# The tree as it stands, as a repository of its own; with a changelog that a release would have.
mkdir "$work/tree"
tar -cf - Makefile CHANGELOG.md include src ports tools | tar -xf - -C "$work/tree"
cd "$work/tree" || exit 1
version=$(sed -n 's/.*GROBO_VERSION_STRING "\(.*\)"/\1/p' include/grobo/version.h)
cat >"$work/make" <<'S'
#!/bin/sh
echo "$1" >>"$0.log"
case $1 in dist) exec env -u MAKE make --no-print-directory "$@" ;; esac
[ "$1" != "${FAILS:-}" ]
S
chmod +x "$work/make"
commit() {
    git add -A && git commit -qm "$1"
}
release() {
    MAKE=$work/make BUILD=$work/build sh tools/package/release.sh >"$work/out" 2>&1
}
# refused TEXT: with exit status 1, nothing but the text being missing, and no tarball.
refused() {
    release
    [ $? -eq 1 ] && grep -q -e "^release: $1" "$work/out" &&
        [ "$(grep -c '^release:' "$work/out")" -eq 1 ] && [ ! -e "$work/build" ] ||
        { cat "$work/out"; return 1; }
}
released() {
    release || { cat "$work/out"; return 1; }
    [ "$(paste -sd ' ' "$work/make.log")" = 'check size check-abi dist dist' ] &&
        grep -q "sha256 $(sha256sum <"$work/build/libgrobo-$version.tar.gz" | cut -d ' ' -f 1)" \
            "$work/out"
}
tagged() {
    git tag -am released "v$version" && refused "version.h: v$version is a tag already"
}
# A patch of the released version, without a function that this had.
gone() {
    sed -i "s/_STRING \"$version\"/_STRING \"${version%.*}.99\"/; s/_PATCH .*/_PATCH 99/" \
        include/grobo/version.h
    sed -i '0,/^ *grobo_.*;/{/^ *grobo_.*;/d}' src/libgrobo.map
    sed -i "s/^## \[$version\]/## [${version%.*}.99]/" CHANGELOG.md
    commit 'a patch' && refused 'src/libgrobo.map: without grobo_[a-z_]* it is not the interface'
}

git init -q . && printf '/build/\n' >.gitignore && sed -i '/^## /,$d' CHANGELOG.md
printf '## [Unreleased]\n\n- A change.\n\n## [%s] - 2026-01-01\n' "$version" >>CHANGELOG.md
commit 'a change'
test_that 'refused: changes that no version has' refused 'CHANGELOG.md: \[Unreleased\] has 1 lines'
printf '# Changelog\n\n## [Unreleased]\n' >CHANGELOG.md
commit 'no section'
test_that 'refused: no section of the version' \
    refused "CHANGELOG.md: no section \"## \[$version\] - "
printf '\n## [%s] - 2026-01-01\n\n- A change.\n' "$version" >>CHANGELOG.md
test_that 'refused: what is not committed' refused 'the tree has changes'
commit 'a section'
for step in check size check-abi; do
    test_that "refused: make $step fails" env FAILS=$step sh -c \
        'MAKE=$1/make BUILD=$1/build sh tools/package/release.sh 2>&1 |
            grep "^release: make $FAILS failed" && [ ! -e "$1/build" ]' sh "$work"
done
rm -f "$work/make.log"
test_that 'released' released
rm -rf "$work/build"
test_that 'refused: a version that is released' tagged
test_that 'refused: a function that is gone' gone
# What it is linked with is in it: each pkg-config name that the Makefile asks for has a package.
bill() {
    tar -czf "$work/some.tar.gz" CHANGELOG.md
    sh tools/package/sbom.sh "$work/some.tar.gz" >"$work/bill" || return 1
    sum=$(sha256sum <"$work/some.tar.gz" | cut -d ' ' -f 1)
    python3 - "$work/bill" "$sum" <<'P'
import json, sys
bill = json.load(open(sys.argv[1]))
ours, *others = bill["packages"]
assert ours["checksums"][0]["checksumValue"] == sys.argv[2], ours
named = {p["SPDXID"] for p in others}
assert named == {r["relatedSpdxElement"] for r in bill["relationships"]}, bill["relationships"]
wanted = "libevent libyaml jansson expat libedit ncurses mosquitto".split()
assert named == {"SPDXRef-" + name for name in wanted}, named
text = open("Makefile").read()
for name in wanted:
    assert name.replace("lib", "") in text, name
P
}
if command -v python3 >/dev/null; then
    test_that 'the bill of materials' bill
else
    skip 'the bill of materials' 'no python3'
fi
done_testing
