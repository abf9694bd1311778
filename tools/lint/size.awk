# SPDX-License-Identifier: MIT
# Gate: functions and files stay small.
#   lines        of a function, from its signature to its closing brace: 60
#   complexity   modified McCabe: 1 + if, for, while, &&, ||, ?, and 1 a switch: 15
#   parameters   6
#   lines        of a file: 1000
# A function is found by its braces, which stand alone in column 0 (house style).

function finish_file() {
    if (file != "" && lines > 1000) {
        printf "%s:%d: size: file of %d lines, 1000 allowed\n", file, lines, lines
        complaints++
    }
}

function occurrences(text, pattern) {
    return gsub(pattern, "&", text)
}

function decisions(text,    padded, count) {
    padded = " " text " "
    gsub(/[^A-Za-z0-9_&|?]/, "  ", padded)
    count = occurrences(padded, " (if|for|while|switch) ")
    count += occurrences(padded, "&&") + occurrences(padded, "[|][|]") + occurrences(padded, "[?]")
    return count
}

# Parameters of "type name(a, b(*c)(d, e))": commas at depth one, and one more unless empty or void.
function parameters(text,    i, c, depth, count, inner) {
    depth = count = 0
    inner = ""
    for (i = index(text, "("); i <= length(text); i++) {
        c = substr(text, i, 1)
        if (c == "(") {
            depth++
        } else if (c == ")") {
            depth--
            if (depth == 0) {
                break
            }
        } else if (c == "," && depth == 1) {
            count++
        }
        inner = inner c
    }
    gsub(/[( ]/, "", inner)
    return inner == "" || inner == "void" ? 0 : count + 1
}

function begin_function() {
    inside = 1
    complexity = 1
    name = signature
    sub(/ *\(.*/, "", name)
    sub(/.*[^A-Za-z0-9_]/, "", name)
    count = parameters(signature)
    if (count > 6) {
        printf "%s:%d: size: %s has %d parameters, 6 allowed\n", FILENAME, first, name, count
        complaints++
    }
}

function end_function(    length_lines) {
    inside = 0
    length_lines = FNR - first + 1
    if (length_lines > 60) {
        printf "%s:%d: size: %s has %d lines, 60 allowed\n", FILENAME, first, name, length_lines
        complaints++
    }
    if (complexity > 15) {
        printf "%s:%d: size: %s has complexity %d, 15 allowed\n", FILENAME, first, name, complexity
        complaints++
    }
    signature = ""
}

FNR == 1 {
    finish_file()
    file = FILENAME
    inside = 0
    signature = ""
}
{ lines = FNR }
inside && code ~ /^}/ { end_function(); next }
inside { complexity += decisions(code); next }
code ~ /^[{] *$/ && signature ~ /\(/ { begin_function(); next }
code ~ /^ *#/ || code ~ /^ *$/ || code ~ /[;}] *$/ { signature = ""; next }
{
    if (signature == "") {
        first = FNR
    }
    signature = signature " " code
}
END { finish_file(); if (complaints) exit 1 }
