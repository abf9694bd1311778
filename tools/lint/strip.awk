# SPDX-License-Identifier: MIT
# Put before a gate's rules with a second -f: gives each rule `code`, the line without comments and
# without the contents of strings and character constants. $0 stays as it is.

function complain(text) {
    printf "%s:%d: %s\n", FILENAME, FNR, text
    complaints++
}

# Length of the literal that begins at the start of text, with its quotes.
function literal_length(text, quote,    i, c) {
    for (i = 2; i <= length(text); i++) {
        c = substr(text, i, 1)
        if (c == "\\") {
            i++
        } else if (c == quote) {
            return i
        }
    }
    return length(text)
}

function strip(rest,    out, at, c, two) {
    out = ""
    while (rest != "") {
        if (in_comment) {
            at = index(rest, "*/")
            if (!at) {
                return out
            }
            rest = substr(rest, at + 2)
            in_comment = 0
            out = out " "
            continue
        }
        at = match(rest, /["'\/]/)
        if (!at) {
            return out rest
        }
        out = out substr(rest, 1, at - 1)
        rest = substr(rest, at)
        c = substr(rest, 1, 1)
        two = substr(rest, 1, 2)
        if (two == "/*") {
            in_comment = 1
            rest = substr(rest, 3)
        } else if (two == "//") {
            return out
        } else if (c == "/") {
            out = out c
            rest = substr(rest, 2)
        } else {
            out = out c c
            rest = substr(rest, literal_length(rest, c) + 1)
        }
    }
    return out
}

FNR == 1 { in_comment = 0 }
{ code = strip($0) }
END { if (complaints) exit 1 }
