# SPDX-License-Identifier: MIT
# Compares a catalogue with the texts of the sources, or writes it anew:
#   awk -f check.awk WANTED ja.po                 what is wrong, a line each; exit status 1
#   awk -v update=1 -f check.awk WANTED ja.po     the catalogue with the texts of the sources, in
#                                                 their order; new ones are empty, and those that
#                                                 the sources lost stand behind #~ at the end
# WANTED is what strings.awk printed.

function quoted(line) {
    sub(/^[^"]*"/, "", line)
    sub(/"[ \t]*$/, "", line)
    return line
}

function complain(line, why) {
    printf "%s:%d: lang: %s\n", catalogue, line, why
    bad = 1
}

function finish() {
    if (id != "" && id in text_of) {
        complain(at, "twice: \"" id "\"")
    }
    if (id != "") {
        text_of[id] = text
        line_of[id] = at
        order[++n] = id
    }
    id = text = state = ""
}

# The conversions of a format in their order, without what only changes how they look.
function conversions(format,    list, one) {
    list = ""
    gsub(/%%/, "", format)
    while (match(format, /%[-+ #0-9.*]*(hh|h|ll|l|z|j|t)?[a-zA-Z]/)) {
        one = substr(format, RSTART + 1, RLENGTH - 1)
        format = substr(format, RSTART + RLENGTH)
        gsub(/[-+ #0-9.]/, "", one)
        list = list " %" one
    }
    return list
}

function last(text) {
    return substr(text, length(text))
}

function check(id, text,    line, plain) {
    line = line_of[id]
    plain = text
    gsub(/\\[nt"\\]/, "", plain)
    if (text == "") {
        complain(line, "not translated: \"" id "\"")
    } else if (conversions(id) != conversions(text)) {
        complain(line, "other conversions than" conversions(id) ": \"" text "\"")
    } else if ((id ~ /\\n$/) != (text ~ /\\n$/)) {
        complain(line, "one text ends with a newline, the other does not: \"" text "\"")
    } else if ((last(id) == "?") != (last(text) == "?")) {
        complain(line, "one text ends with a '?', the other does not: \"" text "\"")
    } else if (plain ~ /\\|[\001-\037]/) {
        complain(line, "an escape other than \\n \\t \\\" \\\\: \"" text "\"")
    }
}

# As msgid or msgstr; a text of several lines is one on several lines.
function put(name, text, prefix,    i) {
    i = index(text, "\\n")
    if (i == 0 || i + 1 == length(text)) {
        printf "%s%s \"%s\"\n", prefix, name, text
        return
    }
    printf "%s%s \"\"\n", prefix, name
    while ((i = index(text, "\\n")) > 0) {
        printf "%s\"%s\"\n", prefix, substr(text, 1, i + 1)
        text = substr(text, i + 2)
    }
    if (text != "") {
        printf "%s\"%s\"\n", prefix, text
    }
}

function put_entry(id, prefix) {
    put("msgid", id, prefix)
    put("msgstr", text_of[id], prefix)
    print ""
}

FNR == NR {
    i = index($0, "\t")
    wanted[++n_wanted] = substr($0, i + 1)
    file_of[wanted[n_wanted]] = substr($0, 1, i - 1)
    next
}
FNR == 1 { catalogue = FILENAME; heads = 1 }
/^#~/ && !update { complain(FNR, "the sources lost this text: delete it when it is used up") }
/^#, .*fuzzy/ { complain(FNR, "marked as fuzzy") }
heads && /^$/ { heads = 0; head = head "\n" }
heads { head = head $0 "\n" }
/^#/ { next }
/^$/ { finish(); next }
/^msgid "/ { finish(); state = "id"; id = quoted($0); at = FNR; next }
/^msgstr "/ { state = "text"; text = quoted($0); next }
/^"/ && state == "id" { id = id quoted($0); next }
/^"/ && state == "text" { text = text quoted($0); next }
{ complain(FNR, "neither msgid nor msgstr") }
END {
    finish()
    for (i = 1; i <= n_wanted; i++) {
        used[wanted[i]] = 1
    }
    if (update) {
        printf "%s", head
        for (i = 1; i <= n_wanted; i++) {
            printf "#: %s\n", file_of[wanted[i]]
            put_entry(wanted[i], "")
        }
        for (i = 1; i <= n; i++) {
            if (!(order[i] in used)) {
                put_entry(order[i], "#~ ")
            }
        }
        exit
    }
    for (i = 1; i <= n_wanted; i++) {
        if (wanted[i] in text_of) {
            check(wanted[i], text_of[wanted[i]])
        } else {
            complain(1, "missing, of " file_of[wanted[i]] ": \"" wanted[i] "\"")
        }
    }
    for (i = 1; i <= n; i++) {
        if (!(order[i] in used)) {
            complain(line_of[order[i]], "no longer in the sources: \"" order[i] "\"")
        }
    }
    exit bad
}
