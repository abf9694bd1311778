# SPDX-License-Identifier: MIT
# Makes the table of a catalogue: LC_ALL=C awk -f po.awk ja.po >ja.c
# The table is sorted by the bytes of its ids, and is called lang_ja after the file.

function fail(why) {
    printf "%s:%d: %s\n", FILENAME, FNR, why >"/dev/stderr"
    failed = 1
    exit 1
}

# What stands between the quotes of a line.
function quoted(line) {
    sub(/^[^"]*"/, "", line)
    sub(/"[ \t]*$/, "", line)
    return line
}

# The bytes that a text means, to compare; \n, \t, \" and \\ are all that a text may have.
function bytes(text,    plain, i, c) {
    plain = ""
    while ((i = index(text, "\\")) > 0) {
        c = substr(text, i + 1, 1)
        if (!(c in escapes)) {
            fail("unknown escape \\" c)
        }
        plain = plain substr(text, 1, i - 1) escapes[c]
        text = substr(text, i + 2)
    }
    return plain text
}

function keep() {
    if (id != "" && text != "") {
        ids[++n] = id
        keys[n] = bytes(id)
        texts[n] = text
    }
    id = text = state = ""
}

# Sorted by Shell's method.
function sort(    gap, i, j, key, one, other) {
    for (gap = int(n / 2); gap > 0; gap = int(gap / 2)) {
        for (i = gap + 1; i <= n; i++) {
            key = keys[i]
            one = ids[i]
            other = texts[i]
            for (j = i - gap; j > 0 && keys[j] "" > key ""; j -= gap) {
                keys[j + gap] = keys[j]
                ids[j + gap] = ids[j]
                texts[j + gap] = texts[j]
            }
            keys[j + gap] = key
            ids[j + gap] = one
            texts[j + gap] = other
        }
    }
}

BEGIN {
    escapes["n"] = "\n"
    escapes["t"] = "\t"
    escapes["\""] = "\""
    escapes["\\"] = "\\"
}
/^#/ { next }
/^$/ { keep(); next }
/^msgid "/ { keep(); state = "id"; id = quoted($0); next }
/^msgstr "/ { state = "text"; text = quoted($0); next }
/^"/ && state == "id" { id = id quoted($0); next }
/^"/ && state == "text" { text = text quoted($0); next }
{ fail("neither msgid nor msgstr") }
END {
    if (failed) {
        exit 1
    }
    keep()
    sort()
    name = FILENAME
    sub(/.*\//, "", name)
    sub(/\.po$/, "", name)
    printf "/* Made by po.awk from %s.po. */\n#include \"tools/grctl/lang/lang.h\"\n\n", name
    printf "const lang_entry lang_%s[] = {\n", name
    for (i = 1; i <= n; i++) {
        if (i > 1 && keys[i] == keys[i - 1]) {
            printf "%s.po: twice: %s\n", name, ids[i] >"/dev/stderr"
            exit 1
        }
        printf "    {\"%s\",\n     \"%s\"},\n", ids[i], texts[i]
    }
    printf "};\nconst size_t lang_%s_count = %d;\n", name, n
}
