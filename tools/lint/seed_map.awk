# SPDX-License-Identifier: MIT
# Gate: each row of docs/seed-map.md is whole and true. Reads, with strip.awk before it, the public
# headers and then the map, told apart by their names; test programs as the rows name them.
#
# A row: | id | member | symbols | note | tests |
#   symbols: `grobo_name`, `GROBO_NAME` or `grobo_struct.field`, declared in a public header
#   tests:   `engine/test_x.c:function` or `cli/x.sh:what a check is called`, below tests/. The
#            function is there, it is run, and its file uses one of the row's symbols.

# ---- headers: names and the fields of structs ----

FILENAME ~ /\.h$/ {
    if (FNR == 1) {
        depth = 0
        inside = ""
    }
    rest = code
    while (match(rest, /[A-Za-z_][A-Za-z0-9_]*|[{}]/)) {
        word = substr(rest, RSTART, RLENGTH)
        rest = substr(rest, RSTART + RLENGTH)
        if (word ~ /[{}]/) {
            if (code ~ /^#/) {
                continue
            }
            depth += word == "{" ? 1 : -1
            inside = depth == 0 ? "" : depth == 1 && word == "{" && is_tag ? last : inside
            continue
        }
        declared[word] = 1
        if (inside != "") {
            declared[inside "." word] = 1
        }
        is_tag = last == "struct"
        last = word
    }
    next
}

# ---- tests ----

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

function check_test(name,    at, file, what, i, used) {
    at = index(name, ":")
    file = "tests/" substr(name, 1, at - 1)
    what = substr(name, at + 1)
    if (at == 0 || !load(file)) {
        complain("seed-map: " id ": no such test program: " name)
        return
    }
    if (file ~ /\.sh$/) {
        if (index(loaded[file], what) == 0) {
            complain("seed-map: " id ": no check called so: " name)
        }
        return
    }
    # Defined once and listed once, at least.
    if (index(loaded[file], "\nstatic void " what "(void **state)") == 0 ||
        times(what, loaded[file]) < 2) {
        complain("seed-map: " id ": no such test: " name)
    }
    for (i = 1; i <= n_symbols; i++) {
        sub(/.*\./, "", symbol[i])
        used += times(symbol[i], loaded[file])
    }
    if (!used) {
        complain("seed-map: " id ": " file " uses none of the symbols of its row")
    }
}

# ---- rows ----

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

$0 ~ /^\| *[A-Z][A-Z][0-9][0-9] *\|/ {
    if (split($0, cell, "|") != 7) {
        complain("seed-map: a row has five cells")
        next
    }
    id = trim(cell[2])
    if (id in member) {
        complain("seed-map: " id " stands here again")
    }
    member[id] = trim(cell[3])
    n_symbols = spans(cell[4], symbol)
    n_tests = spans(cell[6], test)
    if (!n_symbols || !n_tests) {
        complain("seed-map: " id " names no " (n_symbols ? "test" : "symbol"))
    }
    for (i = 1; i <= n_symbols; i++) {
        if (!(symbol[i] in declared) || symbol[i] !~ /^(grobo|GROBO)_/) {
            complain("seed-map: " id ": no public header declares " symbol[i])
        }
    }
    for (i = 1; i <= n_tests; i++) {
        check_test(test[i])
    }
}

function expect(prefix, n,    i, name) {
    for (i = 1; i <= n; i++) {
        name = sprintf("%s%02d", prefix, i)
        wanted[name] = 1
        if (!(name in member)) {
            complain("seed-map: " name " is missing")
        }
    }
}

END {
    expect("SC", 22)
    expect("FN", 3)
    expect("RP", 20)
    expect("RM", 29)
    expect("SR", 73)
    expect("GR", 43)
    for (name in member) {
        if (!(name in wanted)) {
            complain("seed-map: " name " is no member of the reference document")
        }
    }
    while (members != "" && (getline line < members) > 0) {
        if (line !~ /^#/ && split(line, field, "\t") == 3 && member[field[1]] != field[2]) {
            complain("seed-map: " field[1] " is " field[2] ", not " member[field[1]])
        }
    }
    exit complaints > 0
}
