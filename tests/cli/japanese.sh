#!/bin/sh
# SPDX-License-Identifier: MIT
# Help and messages in Japanese; what programs read is the same in every language.
. tests/support/cli.sh
. tests/support/terminal.sh
. tests/support/guide_blocks.sh

# ja COMMAND...: in Japanese, whether or not the system has such a locale.
ja() {
    LC_ALL=ja_JP.UTF-8 "$@"
}

test_case "which language"

# speaks JA|EN VARIABLE=VALUE...
speaks() {
    expected=$1
    shift
    env -u LC_ALL -u LC_MESSAGES -u LANG "$@" "$GRCTL" help >"$work/out"
    if [ "$expected" = JA ]; then
        says '^使い方: grctl'
    else
        says '^usage: grctl'
    fi
}
check "LANG" speaks JA LANG=ja_JP.UTF-8
check "LC_MESSAGES comes before it" speaks JA LC_MESSAGES=ja_JP.utf8 LANG=en_US.UTF-8
check "for English too" speaks EN LC_MESSAGES=C LANG=ja_JP.UTF-8
check "LC_ALL comes before both" speaks JA LC_ALL=ja.UTF-8 LC_MESSAGES=C LANG=C
check "for English too" speaks EN LC_ALL=C LC_MESSAGES=ja_JP.UTF-8 LANG=ja_JP.UTF-8
check "an empty one does not count" speaks JA LC_ALL= LC_MESSAGES= LANG=ja_JP.UTF-8
check "another character set is not written" speaks EN LANG=ja_JP.eucJP
check "no variable" speaks EN

test_case "help"

# Columns of each line: a character of three bytes is two wide.
too_wide() {
    LC_ALL=C awk '{ gsub(/[\343-\357]../, "ww") } length($0) > 80 { print; bad = 1 }
        END { exit !bad }' "$work/out"
}
# Behind an option and its value the help begins in column 31, and goes on there.
is_aligned() {
    LC_ALL=C awk '
        /^(オプション|共通オプション)/ { options = 1; next }
        /^$/ || /^[^ ]/ { options = 0; next }
        !options { next }
        /^  (-.,|   ) --[^ ]+( [^ ]+)?$/ { next }
        substr($0, 29, 2) != "  " || substr($0, 31, 1) == " " { print; bad = 1 }
        END { exit bad }' "$work/out"
}
# No line begins with a mark that belongs to the character before it.
breaks_well() {
    ! LC_ALL=C grep -e '^ *\(、\|。\|）\|」\|ー\|ッ\|ュ\|ョ\|ャ\)' "$work/out"
}
is_japanese() {
    ja "$GRCTL" help "$1" >"$work/out" && says "^使い方: grctl $1" && ! too_wide && is_aligned &&
        breaks_well
}
ja "$GRCTL" help >"$work/out"
check "the overview fits" eval '! too_wide'
check "each summary is in Japanese" eval '! sed -n "/^準備:/,/^共通/p" "$work/out" |
    LC_ALL=C grep -q "^[ -~][ -~]*$"'
"$GRCTL" help | sed -n '/^Global options/q;s/^  \([a-z-]*\) .*/\1/p' >"$work/commands"
check "there are commands" [ "$(wc -l <"$work/commands")" -ge 30 ]
while read -r command; do
    check "help $command" is_japanese "$command"
done <"$work/commands"

manual() {
    ja "$GRCTL" help --man >"$work/grctl.1" && grep -q '^.Sh 書式' "$work/grctl.1" &&
        grep -q '^モーションファイルを再生する' "$work/grctl.1" &&
        [ "$(grep -c '^\.Ss' "$work/grctl.1")" = "$("$GRCTL" help --man | grep -c '^\.Ss')" ]
}
check "the manual" manual

# groff 1.23 misses a string of its own where a heading begins with a letter that is not of ASCII.
rendered() {
    groff -ww -W break -mdoc -Kutf8 -Tutf8 "$work/grctl.1" 2>"$work/err" >"$work/out" &&
        ! grep -v "macro 'doc-str-tmp2' not defined" "$work/err" && says '初期姿勢へ動かす'
}
if [ -e /usr/share/groff/current/tmac/doc.tmac ] && command -v preconv >/dev/null 2>&1; then
    check "groff renders it without warnings" rendered
else
    skip "groff on the manual" "no groff with mdoc here"
fi

test_case "messages"

# complains_ja STATUS PATTERN COMMAND...
complains_ja() {
    ja fails "$@"
}
check "a mistake" complains_ja 2 "^grctl: コマンド 'stauts' はありません; もしかして 'status'?\$" \
    "$GRCTL" stauts
check "its advice" complains_ja 2 "; 'grctl help play' を見てください\$" "$GRCTL" play --rate x y
check "an error of the library" complains_ja 1 \
    '^grctl: .*: ファイルまたはデバイスがありません; .grctl ports. で一覧' \
    "$GRCTL" -d "$work/none" status
check "a file that is not there" complains_ja 3 'none.m: ファイルがありません$' \
    "$GRCTL" -d sim play "$work/none.m"
check "a limit" complains_ja 4 'R_KNEE_P.*可動範囲 -130 から 0 の外です$' \
    "$GRCTL" -d sim move R_KNEE_P 30
echo '1000 0 0 0 0 0 0 0 0 0 0 0 300 0 0 0 0 0 0 0 0' >"$work/bad.m"
check "a code of the library is explained" complains_ja 4 \
    'bad.m:1:[0-9]*: R_KNEE_P: 30 degrees, outside .* (可動範囲の外); --clamp を' \
    "$GRCTL" -d sim play "$work/bad.m"
# Each code of docs/spec.md is.
codes() {
    sed -n '/^## What is refused/,/^## Caps/p' docs/spec.md | grep '^| [a-z]' | cut -d '|' -f 2 |
        tr -d ' ' | tr ',' '\n' | grep -v '^code$' >"$work/codes"
    sed -n '/^Converting and writing note:/,/^$/p' docs/spec.md | grep -o '[a-z]*-[a-z-]*[a-z]' \
        >>"$work/codes"
    [ "$(wc -l <"$work/codes")" -ge 60 ] && while read -r code; do
        grep -q -x -e "msgid \"\\[$code\\]\"" tools/grctl/lang/ja.po ||
            { echo "no $code"; return 1; }
    done <"$work/codes"
}
check "all are" codes
check "a stop" eval 'ja exits 0 "$GRCTL" -d sim stop && complains "^停止しました"'
check "a shell" eval 'printf "help q\nm nope 3\n" >"$work/script" &&
    ja exits 2 "$GRCTL" -d sim shell "$work/script" && says "^  q  quit" && says "シェルを終わる" &&
    complains "script:2: 関節 .nope. はありません; "'

start_told_sim --wiring bus || { echo "Bail out! the simulator did not start"; exit 1; }
well() {
    ja exits 0 "$GRCTL" -d "$robot" --timeout 500 --wiring bus doctor &&
        says "^ok .* ロボットが .* bps で応答" && complains "件の検査すべてに合格"
}
check "doctor" well
# What another wiring is told by is a message.
elsewhere() {
    ja exits 1 "$GRCTL" -d "$robot" --timeout 500 doctor &&
        says '^BAD   reply  .*では応答があります (通信路に直結)' &&
        says "^ *-> grctl -d $robot --wiring bus "
}
check "doctor finds the other wiring in Japanese too" elsewhere
stop_sim

if have_full_screen; then
    open_screen
    type_line "LC_ALL=ja_JP.UTF-8 '$GRCTL' -d sim monitor motions/greet.pseq; echo status \$?"
    check "monitor, without a Japanese locale" until_screen '^e 非常停止   R 解除   q 終了'
    keys i
    check "what it says" until_screen '^初期姿勢へ移動'
    keys e
    check "an alarm ends at the right edge" until_screen '^GR001.* 非常停止中: R で解除 *$'
    keys q
    check "its end" until_screen '^status 0'
    type_line "LC_ALL=ja_JP.UTF-8 '$GRCTL' -d sim play motions/greet.pseq"
    check "the line of progress" until_screen '再生中 .* 5.0 秒、残り .*、速さ 100 %'
    keys s
else
    skip "monitor and play on a screen" "$no_screen"
fi

test_case "the guides"

# tests/cli/guide_first_hour.sh runs their commands; tests/cli/readme.sh and
# tests/export/python.sh run the programs of README.md.
guide=docs/guide/first-hour.ja.md
same_program() {
    block README.md "$1" >"$work/english" && block docs/README.ja.md "$1" >"$work/out" &&
        [ -s "$work/out" ] && diff "$work/english" "$work/out"
}
check "the program of docs/README.ja.md is that of README.md" same_program example
check "and its Python" same_program python
same_commands() {
    block README.md commands | sed 's/ *#.*//' >"$work/english" &&
        block docs/README.ja.md commands | sed 's/ *#.*//' >"$work/out" && [ -s "$work/out" ] &&
        diff "$work/english" "$work/out"
}
check "and its two commands" same_commands
# The messages that the guide shows are those of the commands above them, and name things.
shown() {
    ja "$GRCTL" -d sim move R_ELBW_P -45 2>"$work/out"
    ja "$GRCTL" -d sim move R_KNEE_P 30 2>>"$work/out"
    while read -r line; do
        grep -q -x -F -e "$line" $guide || { echo "not shown: $line"; return 1; }
    done <"$work/out"
}
check "what $guide shows" shown
named() {
    sed -n '/^| メッセージ/,/^$/s/^| `\(… \)*\([^`]*\)`.*/\2/p' $guide >"$work/named"
    [ "$(wc -l <"$work/named")" -ge 5 ] && while read -r text; do
        grep -q -F -e "$text" tools/grctl/lang/ja.po || { echo "no message has: $text"; return 1; }
    done <"$work/named"
}
check "and the messages that it names" named
links() {
    for page in docs/README.ja.md $guide; do
        grep -o '](\([^)#:]*\)[)#]' $page | sed 's/](\(.*\)[)#]/\1/' | while read -r file; do
            [ -e "$(dirname $page)/$file" ] || { echo "$page: no $file"; exit 1; }
        done || return 1
    done
}
check "what they link to is there" links

test_case "what programs read"

# same STATUS COMMAND...: it prints the same, byte for byte, in both languages.
same() {
    expected=$1
    shift
    "$@" >"$work/english" 2>"$work/english.err" </dev/null
    [ $? -eq "$expected" ] || { cat "$work/english.err"; return 1; }
    ja "$@" >"$work/out" 2>"$work/err" </dev/null
    [ $? -eq "$expected" ] && [ -s "$work/out" ] && cmp "$work/english" "$work/out"
}
# same_json: on standard error too.
same_json() {
    same "$@" && cmp "$work/english.err" "$work/err"
}
check "joints" same 0 "$GRCTL" joints
check "robots" same 0 "$GRCTL" robot show
check "show" same 0 "$GRCTL" show motions/greet.pseq
check "check" same 3 "$GRCTL" check "$work/bad.m"
check "plot" same 0 "$GRCTL" plot -o - motions/greet.pseq
check "convert" same 0 "$GRCTL" convert --to yaml motions/greet.pseq -
check "budget" same 0 "$GRCTL" budget
check "frames" same 0 "$GRCTL" play --dry-run motions/greet.pseq
check "decode" same 0 "$GRCTL" decode 53 0C FA AF 03 00 1E 04 01 F6 FF 00 00 11
# How long ago it was read is another time each time.
# shellcheck disable=SC2016
check "status" same 0 sh -c '"$0" -d sim status m2 | sed "s/ *[0-9]*$//"' "$GRCTL"
check "completion" same 0 "$GRCTL" completion zsh
check "what a shell completes" same 0 "$GRCTL" __complete ''
check "version" same 0 "$GRCTL" version
check "JSON of help" same_json 0 "$GRCTL" --json help
check "of the manual" same_json 0 "$GRCTL" --json help --man
check "of a mistake" same_json 2 "$GRCTL" stauts --json
check "of a missing device" same_json 1 "$GRCTL" --json -d "$work/none" status
check "of an error with a fix" same_json 1 "$GRCTL" --json -d /dev/null doctor
check "of a file" same_json 3 "$GRCTL" check --json "$work/none.m"
check "of a script" same_json 2 "$GRCTL" -d sim --json shell "$work/script"
json_line() { # a line of a shell may ask for JSON alone
    printf 'move nope 3 --json\nmove nope 3\n' >"$work/script"
    ja "$GRCTL" -d sim shell -k "$work/script" >"$work/out" 2>"$work/err"
    says '"message":"[^"]*no joint called' &&
        grep -q "script:2: 関節 'nope' はありません" "$work/err"
}
check "a line of a shell" json_line

test_case "a decimal comma"

# German has one; the locale is made here, as few systems have it.
has_comma() {
    mkdir -p "$work/locales" && localedef -i de_DE -f UTF-8 "$work/locales/de_DE.UTF-8" &&
        [ "$(LOCPATH=$work/locales LC_ALL=de_DE.UTF-8 /usr/bin/printf %.1f 1)" = 1,0 ]
}
# point COMMAND...: as in English where numbers have commas.
point() {
    "$@" >"$work/english" 2>"$work/english.err" </dev/null
    LOCPATH=$work/locales LC_ALL=de_DE.UTF-8 "$@" >"$work/out" 2>"$work/err" </dev/null
    cmp "$work/english" "$work/out" && cmp "$work/english.err" "$work/err"
}
if command -v localedef >/dev/null 2>&1 && [ -z "${EMULATOR:-}" ] && has_comma 2>/dev/null; then
    check "a motion" point "$GRCTL" convert --to yaml motions/greet.pseq -
    check "a picture" point "$GRCTL" plot -o - motions/greet.pseq
    check "a table" point "$GRCTL" show --rate 20 motions/greet.pseq
    check "frames" point "$GRCTL" play --dry-run --speed 150 motions/greet.pseq
    check "JSON" point "$GRCTL" check --json --balance motions/step.pseq
    check "a number that is typed" point "$GRCTL" -d sim move R_ELBOW_P -10.5 --json
    check "a comma is none" point "$GRCTL" -d sim move R_ELBOW_P -10,5
else
    skip "numbers where the locale has a decimal comma" "no localedef with de_DE to try it with"
fi
done_testing
