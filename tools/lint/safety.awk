# SPDX-License-Identifier: MIT
# Gate: each rule in the tables of docs/guide/safety.md names tests that are there and run. Reads it
# with strip.awk and named_tests.awk before. A row: | rule | what happens | configured by | tests |

BEGIN {
    gate = "safety"
}

/^\|/ {
    id = trim(substr($0, 2, index(substr($0, 2), "|") - 1))
    if (id ~ /^-+$/ || id == "rule") {
        next
    }
    rows++
    n_cells = split($0, cell, "|")
    n_tests = spans(cell[n_cells - 1], test)
    if (n_cells != 6 || !n_tests) {
        complain("safety: " id ": " (n_cells != 6 ? "a row has four cells" : "names no test"))
    }
    for (i = 1; i <= n_tests; i++) {
        file_of_test(test[i])
    }
}

END {
    if (!rows) {
        complain("safety: no table of rules")
    }
    exit complaints > 0
}
