# SPDX-License-Identifier: MIT
# Gate: the body of an if, else, for or while stands in braces. clang-format 14 does not add them.

function without_braces() {
    complain("braces: the body of if, else, for or while needs braces")
}

{
    text = code
    sub(/[ \\]+$/, "", text)
}

!head && text ~ /^ *(([}] )?else if|if|for|while) [(]/ { head = 1 }
!head && text ~ /^ *([}] )?else$/ { without_braces() }
head {
    depth += gsub(/[(]/, "&", text) - gsub(/[)]/, "&", text)
    if (depth == 0) {
        if (text !~ /[{;]$/) {
            without_braces()
        }
        head = 0
    }
}
