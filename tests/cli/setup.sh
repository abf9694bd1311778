#!/bin/sh
# SPDX-License-Identifier: MIT
# grctl setup: the port, the robot, its name; and back.
. tests/support/cli.sh
. tests/support/terminal.sh
unset GRCTL_ROBOT
config=$work/config/grctl/config.yaml
said() {
    grep -q -e "$1" "$work/err" || { echo "no '$1' in:"; cat "$work/err"; return 1; }
}
# answered STATUS ANSWERS COMMAND...: lines of standard input, \n between them.
answered() {
    answered_want=$1
    printf '%b' "$2" >"$work/answers"
    shift 2
    "$@" <"$work/answers" >"$work/out" 2>"$work/err"
    status_was "$answered_want" "$@"
}
set_up() {
    "$GRCTL" -d "$robot" setup --yes "$@"
}

test_case "nothing to set up"
check "nobody to ask" fails 2 "asks a person at a terminal; without one: 'grctl ports'" \
    "$GRCTL" setup
check "nothing to undo" fails 2 'nothing that could be undone' "$GRCTL" setup --undo
check "no port" both exits 1 "$GRCTL" -d "$work/nowhere" setup --yes --- said 'fix this'


test_case "robots are named and taken back"
check "a simulated robot" answered 0 '' "$GRCTL" -d sim --robot so101 setup --yes
check "is named" grep -qx '  so101: {device: "sim", robot: "so101"}' "$config"
check "and is the default" both exits 0 "$GRCTL" status --- says wrist_flex
check "a second one" answered 0 'other\n' "$GRCTL" -d sim --robot koch setup --yes
check "stands beside it" both exits 0 "$GRCTL" -d other status --- says '^ *6  gripper'
check "the default stays" grep -qx 'default: so101' "$config"
check "undone" both exits 0 "$GRCTL" setup --undo --- said 'is as it was before'
check "it is gone" fails 1 'other: no such file' "$GRCTL" -d other status
check "the first one is not" exits 0 "$GRCTL" -d so101 status
check "once only" fails 2 'nothing that could be undone' "$GRCTL" setup --undo

# A person who says --yes is not asked, as of every command.
if have_terminal; then
    open_screen
    type_line "'$GRCTL' -d sim --robot so101 setup --yes"
    check "--yes at a terminal" until_screen 'done\. From now on'
    check "named as the brackets say" grep -q '  so101-2: {device: "sim", robot: "so101"}' "$config"
    type_line "'$GRCTL' -d sim --robot so101 first-contact --yes -o '$work/looked'; echo it is \$?"
    check "first-contact too, which reads only then" until_screen '^it is 0'
    check "and has written that" grep -q 'the person declined' "$work/looked.txt"
    check "undone again" exits 0 "$GRCTL" setup --undo
else
    skip "--yes at a terminal" "no tmux"
fi

printf '# mine\nrobots:\n    # the first\n    one: {device: sim}\n' >"$config"
test_case "what a person wrote stays"
check "a name that is taken, then another" answered 0 'one\ntwo\n' "$GRCTL" -d sim setup --yes
check "was told" said 'has a robot called one already'
cat >"$work/want" <<'END'
# mine
robots:
    two: {device: "sim", robot: "gr001"}
    # the first
    one: {device: sim}
END
check "what a person wrote stays" cmp "$work/want" "$config"
echo '# later' >>"$config"
check "what has changed since is not undone" fails 3 'has changed since' "$GRCTL" setup --undo
echo 'robots: {one: {device: sim}}' >"$config"
check "robots in braces" answered 3 'two\n' "$GRCTL" -d sim setup --yes
check "are left alone" both said 'in braces; add the robot by hand' --- \
    grep -qx 'robots: {one: {device: sim}}' "$config"
echo '{robots: {one: {device: sim}}}' >"$config"
check "a file in braces" answered 3 'two\n' "$GRCTL" -d sim setup --yes
check "is left alone" both said 'would not be read as it is meant; change it by hand' --- \
    grep -qx '{robots: {one: {device: sim}}}' "$config"
echo 'robots: [' >"$config"
check "a file that cannot be read" answered 3 'a\nb\n' "$GRCTL" -d sim setup --yes
once() {
    [ "$(grep -c 'config.yaml:1:9: ' "$work/err")" -eq 1 ] || { cat "$work/err"; return 1; }
}
check "is said once" once
check "names that are none" answered 2 'a b\nsim\n../x\na:b\nx y\n' "$GRCTL" -d sim setup --yes
rm "$config"

start_sim --robot koch || { echo "Bail out! the simulator did not start"; exit 1; }
test_case "servos that answer become a robot"
check "a robot that is known" answered 0 'spider\nkoch\nmine\n' set_up -b 1000000
check "a wrong answer is asked again" said "no robot called 'spider'"
check "it says who answers" said ' 3  XL330-M288 *1000000 bps  dynamixel2'
check "it has its port and rate" both exits 0 "$GRCTL" -d mine --timeout 500 status --- \
    says '^ *2  shoulder_lift'
check "another one" answered 0 'new\ncrab\n\n' set_up -b 1000000
check "gets a file" both exits 0 "$GRCTL" -d crab --timeout 500 status --- says '^ *2  joint2'
crab=$work/config/grctl/crab.yaml
check "no other is written over it" answered 0 'new\ncrab\n\n' set_up -b 1000000
check "but beside it" [ -e "${crab%.yaml}-2.yaml" ]
check "undone, it is gone" both exits 0 "$GRCTL" setup --undo --- said 'crab-2.yaml is removed$'
check "and only it" both [ ! -e "${crab%.yaml}-2.yaml" ] --- [ -e "$crab" ]
check "a third one" answered 0 'new\nspider\n\n' set_up -b 1000000
echo '# mine' >>"$work/config/grctl/spider.yaml"
check_json "one that somebody changed stays" 'lines[0]["undone"] and not lines[0]["removed"] and
    lines[0]["file"].endswith("spider.yaml")' "$GRCTL" --json setup --undo
check "its file is there" grep -q '^# mine$' "$work/config/grctl/spider.yaml"
check "a name that nobody may have" answered 2 'new\nant\na b\nsim\n../x\na:b\nx y\n' set_up \
    -b 1000000
check "leaves no file behind" both said 'ant.yaml is removed again$' --- \
    [ ! -e "$work/config/grctl/ant.yaml" ]
stop_sim

start_sim
test_case "GR001's board is known"
check "GR001's board" answered 0 '' set_up
check "is known at once" both said "GR001's board answers" --- grep -q 'robot: "gr001"' "$config"
stop_sim
done_testing
