# SPDX-License-Identifier: MIT
# The texts of the sources that are translated, one a line, in their order and each once:
#   awk -f strings.awk rules.txt FILE...     FILE <TAB> TEXT, as it stands between its quotes
# rules.txt says which they are. A text that looks like a sentence and is neither translated nor
# kept by a rule is reported on standard error, and makes the exit status 1.

# ---- rules -----------------------------------------------------------------------------------

function in_quotes(rest) {
    sub(/^[^"]*"/, "", rest)
    sub(/"$/, "", rest)
    return rest
}

function read_rule(    where) {
    where = $NF ~ /\// ? $NF : ""
    if ($1 == "text" && $2 ~ /^\./) {
        translated[$2, where] = 1
    } else if ($1 == "text" && $2 ~ /\//) {
        translated_file[$2] = 1
    } else if ($1 == "text") {
        translated[$2 "#" $3, where] = 1
        format_at[$2, where] = $3
    } else if ($1 == "keep" && $2 ~ /^"/) {
        kept_text[in_quotes($0)] = 1
    } else if ($1 == "also") {
        printf "%s\t%s\n", $2, in_quotes($0)
        seen[in_quotes($0)] = 1
    } else if ($1 == "keep" && $2 ~ /\//) {
        kept_files = kept_files (kept_files == "" ? "" : "|") $2
    } else if ($1 == "keep") {
        kept_in[$2, where] = 1
    } else {
        printf "%s:%d: neither text, also nor keep\n", FILENAME, FNR >"/dev/stderr"
        bad = 1
    }
}

function is_translated(where) {
    return where == "_#1" || FILENAME in translated_file || where == "N_#1" ||
           (where, "") in translated || (where, FILENAME) in translated
}

# An argument behind a format: a word that a message takes in.
function is_word_of_message(where,    part, from) {
    split(where, part, "#")
    from = (part[1], FILENAME) in format_at ? format_at[part[1], FILENAME] : \
           (part[1], "") in format_at ? format_at[part[1], ""] : 0
    return from && part[2] + 0 > from
}

function is_kept(where, text,    part) {
    split(where, part, "#")
    return text in kept_text || (where, "") in kept_in || (where, FILENAME) in kept_in ||
           (part[1], "") in kept_in || (part[1], FILENAME) in kept_in ||
           (kept_files != "" && FILENAME ~ "^(" kept_files ")")
}

function finish(    plain) {
    if (!open) {
        return
    }
    open = 0
    if (defining != "") { # #define KEYS "text": it stands for itself where it is used
        macro[defining] = text
        defining = ""
        return
    }
    plain = text
    gsub(/%[-+ #0-9.*lhzjt]*[a-zA-Z]|\\./, " ", plain)
    if (is_translated(place)) {
        if (!(text in seen) && plain ~ /[A-Za-z]/) {
            printf "%s\t%s\n", FILENAME, text
        }
        seen[text] = 1
        return
    }
    if ((plain ~ /[A-Za-z][a-z]+[,;:]? [a-z][a-z]/ ||
         (is_word_of_message(place) && plain ~ /[a-z][a-z]/)) && !is_kept(place, text)) {
        printf "%s:%d: lang: \"%s\" (%s) is not translated: mark it by _() or N_(), or keep it\n",
               FILENAME, at, text, place >"/dev/stderr"
        bad = 1
    }
}

# ---- C ---------------------------------------------------------------------------------------

function enter(name, number) {
    stack[++depth] = name
    argument[depth] = number
    field[depth] = ""
}

# Where a literal stands: argument 4 of app_fail is "app_fail#4", a member's value ".summary".
function here() {
    return field[depth] != "" ? "." field[depth] : stack[depth] "#" argument[depth]
}

# A literal, or a part of one; `line` is left behind it.
function add(part) {
    if (!open) {
        open = 1
        at = FNR
        place = here()
        text = ""
    }
    text = text part
    line = substr(line, RLENGTH + 1)
    word = ""
}

# Parentheses that only group belong to what is around them.
function enter_parenthesis() {
    if (word == "" && depth > 1) {
        enter(stack[depth], argument[depth])
        field[depth] = field[depth - 1]
    } else {
        enter(word, 1)
    }
}

function take(c) {
    if (c == "(") {
        enter_parenthesis()
    } else if (c == "{" || c == "[") {
        enter(c, 1)
    } else if ((c == ")" || c == "}" || c == "]") && depth > 1) {
        depth--
    } else if (c == ",") {
        argument[depth]++
        field[depth] = ""
    } else if (c == ";") {
        argument[depth] = 1
        field[depth] = ""
    } else if (c == "=" && member) {
        field[depth] = word
    }
    member = c == "."
    word = ""
}

FILENAME ~ /rules\.txt$/ {
    if (NF > 0 && $1 !~ /^#/) {
        read_rule()
    }
    next
}
FNR == 1 {
    depth = 0
    comment = member = 0
    word = ""
    enter("", 1)
}
{
    line = $0
    if (!comment && line ~ /^#define/) {
        finish()
        match(line, /^#define +[A-Za-z_0-9]+(\([^)]*\))?/)
        name = substr(line, 1, RLENGTH)
        line = substr(line, RLENGTH + 1)
        sub(/^#define +/, "", name)
        defining = name ~ /\(/ || line !~ /^ *("|\\$)/ ? "" : name
        depth = 1
    } else if (!comment && line ~ /^#/) {
        while (line ~ /\\$/ && (getline line) > 0) {
        }
        next
    }
    while (line != "") {
        if (comment) {
            comment = !match(line, /\*\//)
            line = comment ? "" : substr(line, RSTART + 2)
        } else if (match(line, /^[ \\]+/)) {
            line = substr(line, RLENGTH + 1)
        } else if (line ~ /^\/\*/) {
            comment = 1
            line = substr(line, 3)
        } else if (match(line, /^"([^"\\]|\\.)*"/)) {
            add(substr(line, 2, RLENGTH - 2))
        } else if (match(line, /^[A-Za-z_][A-Za-z_0-9]*/) && substr(line, 1, RLENGTH) in macro) {
            add(macro[substr(line, 1, RLENGTH)])
        } else {
            finish()
            defining = ""
            if (match(line, /^[A-Za-z_][A-Za-z_0-9]*/)) {
                word = substr(line, 1, RLENGTH)
            } else if (match(line, /^'([^'\\]|\\.)*'/)) {
                word = ""
            } else {
                take(substr(line, 1, 1))
                RLENGTH = 1
            }
            line = substr(line, RLENGTH + 1)
        }
    }
}
END { exit bad }
