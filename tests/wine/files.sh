#!/bin/sh
# SPDX-License-Identifier: MIT
# Files as Windows has them: drive letters and backslashes, lines with a carriage return, names in
# any language, those of devices, patterns that no shell fills in.
. tests/support/cli.sh

cp motions/greet.m motions/greet.pseq "$work"
cd "$work" || exit 1
LC_ALL=C.UTF-8 # wine takes the names of this machine's files for that
export LC_ALL
dos=Z:$(printf '%s' "$work" | tr / '\\')

is_motion() {
    exits 0 "$GRCTL" -q check "$@"
}
# converts FROM TO: by those names, and TO is as it was here.
converts() {
    exits 0 "$GRCTL" convert "$1" "$2" && cmp greet.m "$3"
}
test_case "paths of Windows"
check 'a drive and backslashes' converts "$dos\\greet.m" "$dos\\drive.m" drive.m
check 'a drive and slashes' converts "Z:$work/greet.m" "Z:$work/slash.m" slash.m
check 'here' converts '.\greet.m' '.\here.m' here.m
check 'what is not there is named as it was' fails 3 '^grctl: \.\\none\.m: no such file' \
    "$GRCTL" -d sim play '.\none.m'
check 'a trace' both exits 0 "$GRCTL" -d sim --trace "$dos\\trace" status m3 --- \
    exits 0 "$GRCTL" -q decode trace

# A motion is the same, and what is written has no carriage return.
lines_of_windows() {
    sed "s/\$/$(printf '\r')/" "greet.$1" >"dos.$1"
    exits 0 "$GRCTL" convert "greet.$1" "lf.$2" && exits 0 "$GRCTL" convert "dos.$1" "crlf.$2" &&
        cmp "lf.$2" "crlf.$2" && ! grep -q "$(printf '\r')" "crlf.$2"
}
test_case "lines of Windows"
check 'lines of Windows: .m' lines_of_windows m pseq
check 'lines of Windows: .pseq' lines_of_windows pseq m
shell_of_windows() {
    printf 'version\r\n\r\n# nothing\r\nstatus m3\r\n' >lines
    exits 0 "$GRCTL" -d sim shell lines && says 'R_SHOULDER_P' && ! grep -q "$(printf '\r')" out err
}
check 'lines of Windows: a script of the shell' shell_of_windows
config_of_windows() {
    mkdir -p config/grctl
    printf 'robots:\r\n  home:\r\n    device: sim\r\n' >config/grctl/config.yaml
    exits 0 "$GRCTL" -d home status m3 && says 'R_SHOULDER_P'
}
check 'lines of Windows: config.yaml' config_of_windows
no_carriage_return() {
    exits 0 "$GRCTL" "$@" && [ -s out ] && ! grep -q "$(printf '\r')" out
}
check 'none on standard output' no_carriage_return convert --to pseq greet.m -
check 'nor in JSON' no_carriage_return --json show greet.m

test_case "names with blanks and of other scripts"
for name in 'two words' 'grüße' '挨拶'; do
    test_case "names with blanks and of other scripts"
    check "named $name" converts greet.m "$name.m" "$name.m"
    check "$name again" is_motion "$dos\\$name.m"
    check "$name that is none" fails 3 "^grctl: no $name: no such file" \
        "$GRCTL" -d sim play "no $name"
done
check_json 'in JSON too' 'lines[0]["file"] == "挨拶.m"' "$GRCTL" --json show '挨拶.m'

test_case "NUL"
check 'NUL takes all' both exits 0 "$GRCTL" convert --to pseq greet.m NUL --- [ ! -e NUL ]
check 'NUL gives nothing' fails 3 '^grctl: NUL:1:1: an empty file' "$GRCTL" -d sim play NUL
check 'NUL is no robot' fails 1 '^grctl: NUL: is not a serial port' "$GRCTL" -d NUL status

patterns() {
    mkdir many && cp greet.m many/a.m && cp greet.m many/b.m &&
        exits 0 "$GRCTL" check "$dos\\many\\*.m" 'many/?.m' && cat err && grep -q '^4 files' err
}
test_case "patterns, which no shell fills in"
check 'patterns, which no shell fills in' patterns
done_testing
