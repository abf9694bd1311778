# SPDX-License-Identifier: MIT
# Put before the rules of a gate over a document that names tests, as `engine/test_x.c:function` or
# `cli/x.sh:what a check is called`, below tests/.

# Reads a file once into loaded[]; true if there is one.
function load(file,    line, whole) {
    if (file in loaded) {
        return loaded[file] != ""
    }
    whole = "\n"
    while ((getline line < file) > 0) {
        whole = whole line "\n"
    }
    close(file)
    loaded[file] = whole == "\n" ? "" : whole
    return loaded[file] != ""
}

# How often a word stands in a text.
function times(word, text,    n, at, before, after) {
    n = 0
    while ((at = index(text, word)) > 0) {
        before = substr(text, at - 1, 1)
        after = substr(text, at + length(word), 1)
        if ((at == 1 || before !~ /[A-Za-z0-9_]/) && after !~ /[A-Za-z0-9_]/) {
            n++
        }
        text = substr(text, at + length(word))
    }
    return n
}

# The file of a test that is there and run, or "" and it is complained about.
function file_of_test(name,    at, file, what) {
    at = index(name, ":")
    file = "tests/" substr(name, 1, at - 1)
    what = substr(name, at + 1)
    if (at == 0 || !load(file)) {
        complain(gate ": " id ": no such test program: " name)
        return ""
    }
    if (file ~ /\.sh$/) {
        if (index(loaded[file], what) == 0) {
            complain(gate ": " id ": no check called so: " name)
        }
        return file
    }
    if (loaded[file] !~ ("\nTEST[A-Z_]*[(]([^\n]*, )?" what "[)]\n")) {
        complain(gate ": " id ": no such test: " name)
    }
    return file
}

# Cuts the `spans` of a cell into list; returns how many.
function spans(cell, list,    parts, n, i) {
    n = split(cell, parts, "`")
    for (i = 2; i < n; i += 2) {
        list[i / 2] = parts[i]
    }
    return int((n - 1) / 2)
}

function trim(text) {
    gsub(/^ +| +$/, "", text)
    return text
}
