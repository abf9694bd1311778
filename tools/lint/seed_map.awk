# SPDX-License-Identifier: MIT
# Gate: each row of docs/seed-map.md is whole and true. Reads, with strip.awk and named_tests.awk
# before it, the public headers and then the map, told apart by their names; test programs as the
# rows name them.
#
# A row: | id | member | symbols | note | tests |
#   symbols: `Class_name`, `Class.field`, `grobo_name`, `GROBO_NAME` or `grobo_struct.field`,
#            declared in a public header
#   tests:   `engine/test_x.c:function` or `cli/x.sh:what a check is called`, below tests/. The
#            function is there, it is run, and its file uses one of the row's symbols.

BEGIN {
    gate = "seed-map"
    # Of the library, and of its classic shelf.
    known = "^((grobo|GROBO|SerialCom|RobotPosture|RobotMotion|SerialRobot|GR001)[_.]|" \
        "(rad2deg|deg2rad|thread_execution)$)"
}

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

function check_test(name,    file, i, used) {
    file = file_of_test(name)
    if (file == "" || file ~ /\.sh$/) {
        return
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
        if (!(symbol[i] in declared) || symbol[i] !~ known) {
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
