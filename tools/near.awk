# SPDX-License-Identifier: MIT
# awk -f near.awk OLD NEW: ends well where two drawings have the same words and nearly the same
# numbers (-v near=0.05), as another machine's arithmetic may make them.
function split_up(line, words, numbers,    n, word) {
    n = 0
    word = ""
    while (match(line, /-?[0-9]+(\.[0-9]+)?/)) {
        word = word substr(line, 1, RSTART - 1) "#"
        numbers[++n] = substr(line, RSTART, RLENGTH) + 0
        line = substr(line, RSTART + RLENGTH)
    }
    words[0] = word line
    return n
}
BEGIN { if (!near) near = 0.05 }
NR == FNR { old[FNR] = $0; lines = FNR; next }
{
    n = split_up($0, new_words, a)
    if (split_up(old[FNR], old_words, b) != n || new_words[0] != old_words[0]) exit bad = 1
    for (i = 1; i <= n; i++) if ((a[i] - b[i]) ^ 2 > near ^ 2) exit bad = 1
}
END { exit bad || FNR != lines }
