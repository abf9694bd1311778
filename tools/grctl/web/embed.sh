#!/bin/sh
# SPDX-License-Identifier: MIT
# The files of the page as a C table (page.h): compressed, with type and hash.
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

files=$(cd "$folder" && find . -type f ! -name '.*' | sed 's,^\.,,' | LC_ALL=C sort)
printf '/* Made by tools/grctl/web/embed.sh. */\n#include "tools/grctl/web/page.h"\n'
n=0
table=
for file in $files; do
    type=$(type_of "$file")
    hash=$(gzip -9nc "$folder$file" | cksum | tr ' ' -)
    printf '\nstatic const unsigned char file_%d[] = {\n' "$n"
    gzip -9nc "$folder$file" | od -An -v -tu1 | sed 's/  */,/g; s/^,/    /; s/$/,/'
    printf '};\n'
    table="$table    {\"$file\", \"$type\", \"\\\\\"$hash\\\\\"\", file_$n, sizeof file_$n},
"
    n=$((n + 1))
done
printf '\nconst page_file page_files[] = {\n%b    {0}};\n' "$table"
