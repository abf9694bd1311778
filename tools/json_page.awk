# SPDX-License-Identifier: MIT
# The man page grctl-json(5), in mdoc, from docs/grctl-json.md.

function roff(text) {
    gsub(/\\/, "\\e", text)
    gsub(/-/, "\\-", text)
    if (text ~ /^[.']/)
        text = "\\\\&" text
    return text
}

# Code, italics and links of markdown.
function inline(text, out) {
    text = roff(text)
    gsub(/\]\([^)]*\)/, "", text)
    gsub(/\[/, "", text)
    out = ""
    while (match(text, /`[^`]*`|\*[^*]*\*/)) {
        out = out substr(text, 1, RSTART - 1) \
            (substr(text, RSTART, 1) == "`" ? "\\fB" : "\\fI") \
            substr(text, RSTART + 1, RLENGTH - 2) "\\fR"
        text = substr(text, RSTART + RLENGTH)
    }
    return out text
}

# A sentence on a line of its own, as roff wants it.
function put(text) {
    gsub(/[.] +/, ".\n", text)
    print inline(text)
}

BEGIN {
    print ".Dd November 21, 2026\n.Dt GRCTL-JSON 5\n.Os\n.nh"
}

/^# / {
    sub(/^# [^:]*: */, "")
    gsub(/`/, "")
    print ".Sh NAME\n.Nm grctl-json\n.Nd " roff($0) "\n.Sh DESCRIPTION"
    next
}
/^## / {
    print ".Sh " toupper(substr($0, 4))
    began = 0
    next
}
/^\| command |^\|---/ {
    next
}
/^\|/ {
    if (!table++)
        print ".Bl -tag -width Ds"
    split($0, cell, / *\| */)
    gsub(/[*`]/, "", cell[2])
    print ".It " roff(cell[2])
    put(toupper(substr(cell[4], 1, 1)) substr(cell[4], 2) ".")
    put(cell[3])
    next
}
/^$/ {
    gap = 1
    next
}
{
    if (gap && began)
        print ".Pp"
    gap = 0
    began = 1
    put($0)
}

END {
    if (table)
        print ".El"
    print ".Sh SEE ALSO\n.Xr grctl 1"
}
