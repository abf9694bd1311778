#!/bin/sh
# SPDX-License-Identifier: MIT
# The files of the page as a C table (page.h): compressed, with type and hash. The HTML names the
# others below the hash of all: who keeps them for ever never has one of another version.
#
# usage: tools/grctl/web/embed.sh FOLDER >FILE.c
set -eu

folder=$1

type_of() {
    case $1 in
    *.html) echo 'text/html; charset=utf-8' ;;
    *.js) echo 'text/javascript; charset=utf-8' ;;
    *.css) echo 'text/css; charset=utf-8' ;;
    *.svg) echo 'image/svg+xml' ;;
    *.json) echo 'application/json' ;;
    *.webmanifest) echo 'application/manifest+json' ;;
    *.png) echo 'image/png' ;;
    *)
        echo "embed: $1: no type is known for this name" >&2
        exit 1
        ;;
    esac
}

# What is served: the HTML with the names below the version.
content() {
    case $1 in
    *.html) sed -E "s,(href|src)=\"([a-z_]+\.[a-z]+)\",\1=\"v$version/\2\",g" "$folder$1" ;;
    *) cat "$folder$1" ;;
    esac
}

# The style sheets of HTML for a Link header, which a browser reads before it has the HTML.
early() {
    content "$1" | sed -n 's|.*rel="stylesheet" href="\([^"]*\)".*|</\1>; rel=preload; as=style|p' |
        paste -sd , - | sed 's/,/, /g'
}

files=$(cd "$folder" && find . -type f ! -name '.*' | sed 's,^\.,,' | LC_ALL=C sort)
version=$(for file in $files; do echo "$file"; cat "$folder$file"; done | cksum | tr ' ' -)
printf '/* Made by tools/grctl/web/embed.sh. */\n#include "tools/grctl/web/page.h"\n'
n=0
table=
for file in $files; do
    type=$(type_of "$file")
    hash=$(content "$file" | gzip -9nc | cksum | tr ' ' -)
    printf '\nstatic const unsigned char file_%d[] = {\n' "$n"
    content "$file" | gzip -9nc | od -An -v -tu1 | sed 's/  */,/g; s/^,/    /; s/$/,/'
    printf '};\n'
    row="\"$file\", \"$type\", \"\\\\\"$hash\\\\\"\", \"$(early "$file")\""
    table="$table    {$row, file_$n, sizeof file_$n},
"
    n=$((n + 1))
done
printf '\nconst char page_version[] = "/v%s";\n' "$version"
printf 'const page_file page_files[] = {\n%b    {0}};\n' "$table"
