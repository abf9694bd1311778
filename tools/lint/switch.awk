# SPDX-License-Identifier: MIT
# Gate: a switch over an enum of ours lists every enumerator (-Wswitch-enum) and has no default,
# so that a new enumerator is noticed by the compiler. Anonymous enums are constants and do not
# count, nor does a switch over a variable that the function declares as a plain number: a register
# may hold what no enumerator names. The files are given twice: first enumerators are collected.

FNR == 1 && seen[FILENAME]++ { pass = 2 }

pass != 2 && code ~ /enum +[A-Za-z_][A-Za-z0-9_]* *[{]/ { in_enum = 1; sub(/.*[{]/, "", code) }
pass != 2 && in_enum {
    text = code
    n = split(text, parts, ",")
    for (i = 1; i <= n; i++) {
        if (match(parts[i], /[A-Z][A-Z0-9_]+/)) {
            enumerator[substr(parts[i], RSTART, RLENGTH)] = 1
        }
    }
    if (code ~ /}/) {
        in_enum = 0
    }
}
pass != 2 { next }

FNR == 1 { depth = top = 0 }
code ~ /^}/ { split("", plain) }
{
    text = code
    while (match(text, /(char|int|long|short|unsigned|u?int(8|16|32|64)_t) +[a-z_][a-z0-9_]*/)) {
        declared = substr(text, RSTART, RLENGTH)
        text = substr(text, RSTART + RLENGTH)
        sub(/.* /, "", declared)
        plain[declared] = 1
    }
}
code ~ /(^|[^A-Za-z0-9_])switch *\(/ {
    pending = 1
    subject = code
    sub(/.*switch *\(/, "", subject)
    sub(/\) *[{].*/, "", subject)
}
code ~ /^ *case / {
    label = code
    sub(/^ *case */, "", label)
    sub(/[^A-Za-z0-9_].*/, "", label)
    if (label in enumerator) {
        over_enum[top] = label
    }
}
code ~ /^ *default *:/ && top > 0 { default_line[top] = FNR }
{
    for (i = 1; i <= length(code); i++) {
        c = substr(code, i, 1)
        if (c == "{") {
            depth++
            if (pending) {
                pending = 0
                top++
                level[top] = depth
                over_enum[top] = ""
                number[top] = subject in plain
                default_line[top] = 0
            }
        } else if (c == "}") {
            if (top > 0 && level[top] == depth) {
                if (over_enum[top] != "" && default_line[top] && !number[top]) {
                    printf "%s:%d: switch: default in a switch over an enum (%s)\n", FILENAME,
                        default_line[top], over_enum[top]
                    complaints++
                }
                top--
            }
            depth--
        }
    }
}
