# SPDX-License-Identifier: MIT
# For tests that make again what a guide shows: the fenced block after a line <!-- MARK -->.

# block FILE MARK: what the guide shows there.
block() {
    awk -v mark="<!-- $2 -->" '
        $0 == mark { wanted = 1; next }
        wanted && /^```/ { if (inside) exit; inside = 1; next }
        inside { print }' "$1"
}
# replace_block FILE MARK SHOT: the guide shows the file SHOT there from now on.
replace_block() {
    awk -v mark="<!-- $2 -->" -v shot="$3" '
        $0 == mark { wanted = 1 }
        !inside { print }
        /^```/ && inside { print; inside = wanted = 0; next }
        /^```/ && wanted {
            inside = 1
            while ((getline line <shot) > 0)
                print line
        }' "$1" >"$work/guide.md" && cat "$work/guide.md" >"$1"
}
