# SPDX-License-Identifier: MIT
# Reads what `make -n` would run, and prints compile_commands.json: how each file is compiled, for
# language servers. -v folder= is where make runs.
function quoted(text) {
    gsub(/\\/, "\\\\", text)
    gsub(/"/, "\\\"", text)
    return "\"" text "\""
}

/ -c -o [^ ]+ [^ ]+\.c$/ {
    printf "%s  {\"directory\": %s, \"file\": %s, \"command\": %s}", n++ ? ",\n" : "[\n",
        quoted(folder), quoted($NF), quoted($0)
}
END { print n ? "\n]" : "[]" }
