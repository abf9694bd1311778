#!/bin/sh
# SPDX-License-Identifier: MIT
# grctl shell: scripts, the original programs' letters and words, and a person at a terminal.
. tests/support/cli.sh
. tests/support/terminal.sh

grctl=$GRCTL

# script STATUS TEXT [OPTION...]: runs the lines of TEXT from a pipe, on a simulator.
script() {
    script_want=$1
    script_text=$2
    shift 2
    printf '%s' "$script_text" | "$grctl" -d sim shell "$@" >"$work/out" 2>"$work/err"
    status_was "$script_want" shell "$@"
}

# told PATTERN: a line like that on standard error.
told() {
    grep -q -e "$1" "$work/err" || { echo "no '$1' in:"; cat "$work/err"; return 1; }
}

test_case "scripts run, and mistakes end them"
check "commands of grctl" both script 0 'status m3
version
' --- says '^    3  R_SHOULDER_P'
check "both of them" says '^grctl [0-9]'
check "the last line needs no end" both script 0 'version' --- says '^grctl'
# Nothing of a command is left over for the next one of its kind.
again() {
    "$grctl" -d sim --trace "$work/again.pcapng" status >"$work/out" || return 1
    for again_line in 'show motions/greet.pseq' 'show --rate 5 motions/step.pseq' \
        "replay $work/again.pcapng" "decode $work/again.pcapng" \
        'check --balance motions/step.pseq' \
        'plot --balance -o - motions/step.pseq' \
        'convert --to m motions/greet.pseq -' \
        'play --dry-run motions/greet.pseq'; do
        script 0 "$again_line
" || return 1
        cat "$work/out" "$work/out" "$work/out" "$work/out" >"$work/four"
        script 0 "$again_line
$again_line
$again_line
$again_line
" && diff "$work/four" "$work/out" >"$work/more" || { sed 5q "$work/more"; return 1; }
    done
}
check "the same command four times" again
check "comments, blanks, quotes" both script 0 '
  # nothing
 status "m3" # that one
' --- says R_SHOULDER_P
check "nothing at all" script 0 ''
check "a mistake ends it, with its status" both script 2 'version
nonsense
status m3
' --- told '^grctl: standard input:2: no command .nonsense.'
ended() {
    says '^grctl' && ! grep -q R_SHOULDER_P "$work/out"
}
check "and what stands behind is not run" ended
check "-k goes on" both script 2 'nonsense
move m5 99
version
' -k --- says '^grctl'
check "and tells each" told 'standard input:2: move: R_ELBOW_P'
check "an open quote" both script 2 'status "m3' --- told 'a quote is not closed'
check "refused for safety: status 4" both script 4 'm m5 99' --- told 'input:1: .*outside its'
check "a letter without what it needs" both script 2 'm m5' --- told 'm needs JOINT DEG'
check "another device is for connect" both script 2 'status -d sim' --- told 'connect DEV'
check "no shell in a shell" both script 2 shell --- told 'a shell already'
from_file() {
    printf 'version\nnonsense\n' >"$work/lines"
    fails_out=$("$GRCTL" -d sim shell "$work/lines" 2>&1 >/dev/null)
    [ $? -eq 2 ] && printf '%s' "$fails_out" | grep -q "lines:2: no command"
}
check "a script in a file" from_file
check "one that is not there" fails 3 'none: no such file$' "$GRCTL" shell "$work/none"

check "exit, as elsewhere" both script 0 'exit
nonsense' --- [ ! -s "$work/err" ]
check "a folder is none" fails 3 ': is a directory$' "$GRCTL" shell "$work"
check "a word nearly right" both script 2 'claer
' --- told "input:1: no command 'claer'; did you mean 'Clear'?$"
check "a command nearly right" both script 2 'stauts
' --- told "no command 'stauts'; did you mean 'status'?$"
test_case "motions of the shell"
check "increments take no posture" both script 2 "l $PWD/motions/greet.mseq
Push" --- told 'record: it holds increments, not where joints go; .Clear. it before$'
check "nor do frames at a rate" both script 2 "l $PWD/motions/greet.yaml
Push" --- told 'record: it holds frames at a rate; '
check "emptied they do" both script 0 "l $PWD/motions/greet.mseq
Clear
Push" --- told '^1 posture in the record'
test_case "help in the shell"
check "help on a command" both script 0 'help move
' --- says '^usage: grctl move JOINT DEG'
check "help on a letter" both script 0 'help m
' --- says '^ *m  *JOINT DEG \[MS\]$'
check "help on a word" both script 0 'help Rec
' --- says 'append one every 100 ms'
check "help on the beginning of one" both script 0 'help w
' --- says '^ *wait MS$'
check "help on what is none" both script 2 'help Puhs
' --- told "no command 'Puhs'; did you mean 'Push'?$"
check "help lists commands" both script 0 'help
' --- says '^  play  '
check "and words" says '^ *f  *Free '
check "elsewhere help knows no letters" fails 2 "no command 'w'; see 'grctl help'" "$GRCTL" help w

test_case "one connection"

one_connection() {
    script 0 'S m5
m m5 -30 200
status m5
r
p m5
' -v || return 1
    [ "$(grep -c 'robot found' "$work/err")" -eq 1 ] || { cat "$work/err"; return 1; }
    says 'R_ELBOW_P  *-30\.0  *-30\.0  on'
}
check "one connection, and the robot remembers" one_connection
twice() {
    script 0 'status m3
close
connect
status m3' -v && [ "$(grep -c 'robot found' "$work/err")" -eq 2 ]
}
check "closed and opened again" twice
policy() {
    script 0 'S m5
status m5
version' -v --on-exit off || return 1
    says 'R_ELBOW_P .* on' && [ "$(grep -c 'exit policy carried out' "$work/err")" -eq 1 ]
}
check "the exit policy is carried out once, at the end" policy
latched() {
    script 4 'estop
m m5 0
' && told 'standard input:2: '
}
check "an emergency stop holds" latched
check "until its reset" script 0 'estop
estop --reset
m m5 0 200
'
traced() {
    script 0 'status m3
status m4
' --trace "$work/trace" && "$GRCTL" decode "$work/trace" >"$work/out" && says 'R_SHOULDER_R'
}
check "--trace holds all commands" traced

test_case "letters and words"

letters='S arms
S m2
s m2
b m2
Break m2
On m2
Off m2
f m5
e
Free m5
End
i --time 300
Init --time 300
t 200
m m5 -45
r
m m5 0
Push 250
PrintRecord
R --key
DoRecord --key
Start --key
Reverse
Start --key
Reverse
Save saved.pseq
Save
c
a
Clear
l saved
a saved.pseq
Rec 300
p m5
C m5
connect
close
wait 10
q
nonsense
'
words() {
    mkdir -p "$work/here" && cd "$work/here" && script 0 "$letters" -v
}
check "every letter and word" words
check "the record was saved" grep -q PoseSeq "$work/here/saved.pseq"
check "and by number" grep -q '^200 ' "$work/here/Motion1.m"
check "loaded and appended" told '^4 postures in the record'
check "captured every 100 ms" told '^[78] postures in the record'
check "Reverse is told" told 'backwards'
check "PrintRecord" says '@record: .*2 postures'
for word in q i S s f b m t r R c e C p l a On Off Break Free Init Clear Push DoRecord PrintRecord \
    Save Rec End Start Reverse connect close; do
    check "help shell has $word" sh -c '"$0" help shell | grep -q -e "^ .*\<$1\>"' "$GRCTL" "$word"
done
if have_json; then
    lines_of_json() {
        script 0 'status m3
r
Reverse
t 300
version
' --json && json '[l["line"] for l in lines[1::2]] == [1, 2, 3, 4, 5] and
            lines[2]["postures"] == 1 and lines[6]["time_ms"] == 300'
    }
    check "with --json a line a command, and its mark" lines_of_json
    marks() {
        script 4 'move m5 99
# nothing
status "m3
' -k --json && json '[(l["line"], l["status"]) for l in lines if "line" in l] ==
            [(1, 4), (2, 0), (3, 2)]'
    }
    check "with the exit status of each" marks
    json_error() {
        script 2 'nonsense' --json && json '"standard input:1: " in lines[0]["error"]["message"]'
    }
    check "mistakes too" json_error
    json_refused() {
        script 2 'status "m3' --json && json 'lines[0]["error"]["code"] == "arg"'
    }
    check "and lines that are no commands" json_refused
    json_words() {
        script 0 'help w' --json && json 'lines[0]["words"][0]["word"] == "wait"'
    }
    check "and words that are asked for" json_words
else
    skip "--json" "no python3 to parse JSON with"
fi
check "elsewhere there is no record" fails 3 '@record: only a shell has' "$GRCTL" show @record

test_case "a person at a terminal"

no_person=
have_terminal || no_person='no tmux here'
[ -z "${NATIVE_GRCTL:-}" ] || no_person='the console of wine echoes what is typed before it is read'
if [ -n "$no_person" ]; then
    skip "a person at a terminal" "$no_person"
    done_testing
    exit
fi
open_screen 100 30
type_line "'$GRCTL' -d sim shell 2>$work/shell.err; echo status \$?"
check "a prompt" until_screen '^grctl>'
keys 'version' Enter
check "a command" until_screen '^grctl [0-9]'
if [ "${EDIT:-libedit}" = libedit ]; then
    keys 'serv' Tab Tab
    check "TAB lists" until_screen 'servo  servo-get  servo-set'
    keys C-u 'l gre' Tab Enter
    check "TAB completes names of motions" both until_screen '^grctl> l greet$' --- \
        written "$work/shell.err" '10 postures in the record'
    cp motions/greet.m "$work/two words.m"
    keys "show $work/tw" Tab Enter
    check "and files with blanks" until_screen 'two words.m: m, 10 postures'
    keys 'play --mi' Tab '--ik n' Tab
    check "and options and their words" until_screen '^grctl> play --mirror --ik numeric'
    keys C-u 'stat' Tab 'R_KN' Tab
    check "TAB completes commands and joints" until_screen '^grctl> status R_KNEE_P'
    keys Enter
    check "and Enter runs" until_screen 'R_KNEE_P .* -40\.0'
    keys 'garbage'
    until_screen '^grctl> garbage$' >/dev/null # a terminal forgets what is unread when Ctrl-C comes
    keys C-c
    until_cursor 7
    keys 'status m2' Enter
    check "Ctrl-C clears the line" until_screen '^ *2  NECK_Y'
    keys Up Up Enter
    check "history" until_screen '^grctl> status R_KNEE_P'
    on_screen new-session -d -s other -x 100 -y 30 'PS1="> " exec sh'
    other_shows() {
        on_screen capture-pane -p -t other | grep -q -e "$1"
    }
    wait_for other_shows '^>'
    on_screen send-keys -t other "'$GRCTL' -d sim shell" Enter
    wait_for other_shows '^grctl>'
    on_screen send-keys -t other C-z
    wait_for other_shows 'Stopped'
    on_screen send-keys -t other 'stty sane; clear; fg' Enter
    wait_for other_shows '^grctl>'
    on_screen send-keys -t other 'vers' Tab Enter
    check "after Ctrl-Z and fg lines are edited as before" wait_for other_shows '^grctl> version$'
    on_screen kill-session -t other
else
    skip "editing" "built without libedit"
fi
keys 'm m5 -100 20000' Enter
check "a long move" both until_screen '^grctl> m m5' --- until_cursor 0
keys C-c
check "Ctrl-C stops the command" written "$work/shell.err" interrupted
keys 'version --json' Enter
check "not the shell" until_screen '^{"name":"grctl"'
until_cursor 7
keys C-d
check "Ctrl-D ends it" until_screen '^status 0'
if [ -e "$work/state/grctl/history" ]; then
    check "history is kept, for nobody else" test -n "$(find "$work/state/grctl/history" -perm 600)"
fi
done_testing
