# SPDX-License-Identifier: MIT
# awk -f links.awk FILE.html...: each link of the pages, run in their folder, leads to a file of the
# folder and to a name in it; nothing is fetched from elsewhere to show a page.

{
    rest = $0
    while (match(rest, / (id|name)="[^"]*"/)) {
        named = substr(rest, RSTART, RLENGTH)
        rest = substr(rest, RSTART + RLENGTH)
        gsub(/^ (id|name)="|"$/, "", named)
        here[FILENAME "#" named] = 1
    }
    rest = $0
    while (match(rest, / (href|src)="[^"]*"/)) {
        link = substr(rest, RSTART, RLENGTH)
        rest = substr(rest, RSTART + RLENGTH)
        is_source = link ~ /^ src/
        gsub(/^ (href|src)="|"$/, "", link)
        if (link ~ /^(https?|mailto):/) {
            if (is_source) bad(FILENAME, link, "is fetched from elsewhere")
            continue
        }
        if (link ~ /^javascript:/) continue
        wanted[++n] = link
        from[n] = FILENAME
    }
}
FNR == 1 { pages[FILENAME] = 1 }
function bad(file, link, why) {
    print file ": " link ": " why
    failed = 1
}
function exists(file,    line, got) {
    if (!(file in known)) {
        got = (getline line <file)
        close(file)
        known[file] = got >= 0
    }
    return known[file]
}
END {
    for (i = 1; i <= n; i++) {
        file = wanted[i]
        anchor = ""
        if (match(file, /#.*/)) {
            anchor = substr(file, RSTART + 1)
            file = substr(file, 1, RSTART - 1)
        }
        if (file == "") file = from[i]
        if (!(file in pages) && !exists(file)) bad(from[i], wanted[i], "no such file")
        else if (anchor != "" && (file in pages) && !((file "#" anchor) in here))
            bad(from[i], wanted[i], "no such place")
    }
    print n " links of " length(pages) " pages"
    exit failed || n == 0
}
