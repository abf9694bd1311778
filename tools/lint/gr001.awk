# SPDX-License-Identifier: MIT
# Gate: code for every robot does not know one of them. Names of GR001 and of its joints, and
# counts of its joints, are in its own files (src/robots, src/body, the classic shelf, its board),
# and where tools/lint/gr001.txt lists them with a reason. Comments and help may have examples.
#
# variables: robot (the path of GR001's file), list (that of gr001.txt), whole (not empty: all
# sources are read)

BEGIN {
    while ((getline line <robot) > 0 && line !~ /^groups:/) {
        if (line ~ /^  - name: [A-Z_]+$/) {
            joints = joints (joints == "" ? "" : "|") substr(line, 11)
        }
    }
    close(robot)
    while ((getline line <list) > 0) {
        if (line !~ /^#/ && split(line, word, " ") >= 2) {
            allowed[word[1]] = 1
        }
    }
    close(list)
    thing = "(joint|servo|motor|Joint|Servo|Motor)[A-Za-z_]*(\\[[A-Za-z0-9_]*\\])?"
    count = thing " *(<|>|<=|>=|==|!=|=|\\+|-|\\*) *(19|20|21)($|[^0-9.a-zA-Z_])"
    counted = "(^|[^0-9.a-zA-Z_])(19|20|21) *(<|>|<=|>=|==|!=) *[A-Za-z_.>-]*" thing
}

FNR == 1 {
    own = FILENAME ~ /(^|\/)src\/(robots|body|classic|servo\/gr001|link\/classic)\// ||
          FILENAME ~ /(^|\/)include\/grobo\/(classic\/|core\/gr001\.h)/
    library = FILENAME ~ /(^|\/)(src|ports|include)\//
}

{ code = strip($0) }

own { next }

(code ~ /(^|[^a-z0-9])(grobo_(i_)?)?[gG][rR]001/ ||
 ($0 ~ /"[gG][rR]001"/ && code ~ /cmp\(|answers\(/)) && code !~ /^ *GROBO_API|#include/ {
    seen[FILENAME] = 1
    if (!allowed[FILENAME]) {
        complain("gr001: code for every robot names GR001; " \
                 "if it must, tools/lint/gr001.txt says why")
    }
}

# In a string, which `code` does not have; in the command examples of help are none that decide.
code ~ /""/ && $0 ~ "\"(" joints ")\"" && (library || code ~ /cmp\(|find_joint/) {
    complain("gr001: a joint of GR001 by its name")
}

code ~ count || code ~ counted || code ~ /\[(20|21)\]/ {
    complain("gr001: the number of joints of GR001: the model says how many there are")
}

END {
    for (file in allowed) {
        if (!seen[file] && whole) {
            print list ":1: gr001: " file " does not name GR001 any more"
            complaints++
        }
    }
    exit complaints > 0
}
