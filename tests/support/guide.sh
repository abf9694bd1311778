# SPDX-License-Identifier: MIT
# For tests that do what a guide says, in the order of the guide, on files that it shows. Each has a
# desk of its own, $work/desk. A mark above a block tells what it is: <!-- file NAME --> is a file,
# <!-- run --> has commands, <!-- run python3 --> some that need Python.
. tests/support/cli.sh

mkdir "$work/bin" "$work/desk"
ln -s "$GRCTL" "$work/bin/grctl"
ln -s "$(pwd)/motions" "$work/desk/motions"
PATH=$work/bin:$PATH
export PATH
python=
have_json && python=yes

run_on_desk() {
    cd "$work/desk" && eval "$1" </dev/null
}

# guides_work NAME GUIDE...: a test, whose steps are the commands of these guides.
guides_work() {
    test_case "$1"
    shift
    awk -v desk="$work/desk" -v commands="$work/commands" -v python=$python '
    /^<!-- file / { file = desk "/" $3 }
    /^<!-- run -->/ { file = commands }
    /^<!-- run python3 -->/ && python { file = commands }
    /^```/ { open = !open && file != ""; if (!open) { close(file); file = "" }; next }
    open { print >>file }' "$@"
    check "the guide has commands" [ -s "$work/commands" ]
    while read -r command; do
        check "$command" run_on_desk "$command" 3<&-
    done <"$work/commands"
}
