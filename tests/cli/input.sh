#!/bin/sh
# SPDX-License-Identifier: MIT
# What comes from outside and is bad: files, devices, standard streams. Each gets one clear line,
# the exit status of its kind, a quick end, and leaves nothing behind. Quick is two seconds; five
# are given to a busy machine.
. tests/support/cli.sh

chmod 755 "$work" # for another user, below
bad=$work/bad
mkdir "$bad" "$work/here" "$work/tmp"
greet=$PWD/motions/greet.pseq

# The command with five seconds to live, in an empty directory.
grctl() {
    (cd "$work/here" && TMPDIR=$work/tmp exec timeout -k 1 5 ${as_other:-} "$GRCTL" "$@")
}

# pseq NAME JOINTS Q: a motion of one posture.
pseq() {
    cat >"$bad/$1" <<END
type: PoseSeq
name: "bad"
refs:
  -
    time: 0
    refer:
      type: Pose
      joints: [ $2 ]
      q: [ $3 ]
END
}

# refuses STATUS FILE PATTERN: so do the commands that read motions, each in one line.
refuses() {
    fails "$1" "^grctl: $bad/$2:$3" grctl -d sim play "$bad/$2" || return 1
    fails "$1" "^grctl: $bad/$2:$3" grctl play --dry-run "$bad/$2" || return 1
    exits 3 grctl check "$bad/$2" && says "^$bad/$2:"
}

test_case "files"

check "a missing file" refuses 3 missing.pseq ' no such file$'
mkdir "$bad/directory.pseq"
check "a directory" refuses 3 directory.pseq ' is a directory'
: >"$bad/empty.pseq"
check "an empty file" refuses 3 empty.pseq '1:1: an empty file$'
printf '\n\n' >"$bad/blank.m"
check "a .m file without a posture" fails 3 'blank.m: has no postures$' \
    grctl -d sim play "$bad/blank.m"
check "a .m file without a posture: a warning" \
    both exits 0 grctl check "$bad/blank.m" --- says 'blank.m: warning: no postures'
printf 'type: PoseSeq\nname: x\nrefs:\n  - time: 0\n    refer: {joints: [0, 1' >"$bad/cut.pseq"
check "a file cut short" refuses 3 cut.pseq '6:1: did not find expected'
head -c 100000000 /dev/zero | tr '\0' '[' >"$bad/large.pseq"
check "100 MB of [" refuses 3 large.pseq '1:1: not a motion file'
printf 'refs: ' | cat - "$bad/large.pseq" >"$bad/deep.pseq"
check "100 MB of [ where a list belongs" refuses 3 deep.pseq
head -c 40000 "$bad/large.pseq" >"$bad/nest.yaml"
check "40 kB of [" refuses 3 nest.yaml
mv "$bad/large.pseq" "$bad/large.m"
check "100 MB of [ as .m" refuses 3 large.m '1: longer than'
rm "$bad/large.m" "$bad/deep.pseq"
printf 'type: PoseSeq\nname: x\nrefs: 5\n' >"$bad/type.pseq"
check "a number where a list belongs" refuses 3 type.pseq '3:7: refs: '
printf 'type: Walk\nname: x\ncomponents: []\n' >"$bad/top.pseq"
check "another type of file" refuses 3 top.pseq
pseq short.pseq '3, 4, 5, 6' '0, 0, 0'
check "fewer angles than joints" refuses 3 short.pseq '9:10: q has 3 numbers for 4 joints$'
for word in nan .nan inf -.inf 1e999 true 0x10 "''" '[1]'; do
    pseq word.pseq 3 "$word"
    check "$word as an angle" refuses 3 word.pseq '9:'
done
pseq joint.pseq 99999999999999 0
check "a joint of many digits" refuses 3 joint.pseq '8:17: joints: '
printf '0 x 0\n' >"$bad/word.m"
check "a word in a .m file" refuses 3 word.m '1:3: '
head -c 100000 "$GRCTL" >"$bad/binary.pseq"
for name in m mseq yaml seq; do
    cp "$bad/binary.pseq" "$bad/binary.$name"
done
for name in pseq m mseq yaml seq; do
    check "a program as .$name" refuses 3 "binary.$name"
done
ln -s loop.pseq "$bad/loop.pseq"
check "a link to itself" refuses 3 loop.pseq
ln -s /dev/zero "$bad/zero.pseq"
check "zeros without an end" refuses 3 zero.pseq '1:1: '
mkfifo "$bad/pipe.pseq"
check "a pipe that nobody writes to" refuses 3 pipe.pseq '1:1: an empty file$'
slow_pipe() {
    cat "$greet" >"$bad/pipe.pseq" &
    exits 0 grctl show "$bad/pipe.pseq" && says '^ *5000 '
}
check "a pipe that somebody writes to" slow_pipe
pseq limit.pseq '2, 3' '0, 0.5'
check "an angle outside limits" refuses 4 limit.pseq \
    '9:15: R_KNEE_P: 28.6 degrees, outside -130..0; --clamp plays it at the limit$'
pseq far.pseq 3 -9e5
check "an angle that nothing can reach" refuses 4 far.pseq '9:12: R_KNEE_P: '

pseq secret.pseq 3 0
chmod 0 "$bad/secret.pseq"
as_other=
if [ "$(id -u)" -eq 0 ]; then
    as_other='setpriv --reuid=65534 --regid=65534 --clear-groups --'
    grctl version >/dev/null 2>&1 || as_other=none # no setpriv, or no way to the program
fi
if [ "$as_other" = none ]; then
    as_other=
    skip "a file without permission" "root may read all, and there is no other user to be"
else
    check "a file without permission" refuses 3 secret.pseq ' permission denied$'
    start_sim
    chmod 0 "$sim_pty"
    check "a device without permission" fails 1 "^grctl: $sim_pty: permission denied; may your" \
        grctl -d "$sim_pty" status
    stop_sim
fi
as_other=

test_case "devices"

check "an unknown device" fails 1 '^grctl: /dev/none: no such file or device; see .grctl ports' \
    grctl -d /dev/none play "$greet"
check "a device without a name" fails 2 'device needs a value' grctl -d '' play "$greet"
check "a device that is not a serial port" fails 1 '/dev/null: is not a serial port' \
    grctl -d /dev/null play "$greet"
check "a server that is none" fails 1 'tcp:127.0.0.1:1: connect: Connection refused' \
    grctl -d tcp:127.0.0.1:1 play "$greet"
check "a server without a port" fails 2 'not of the form' grctl -d tcp:localhost play "$greet"
check "a server with too large a port" fails 2 'not of the form' \
    grctl -d tcp:localhost:65536 play "$greet"

# A machine that takes no connection and refuses none: its queue of callers is full.
deaf_server() {
    cat >"$work/deaf.py" <<'EOF'
import socket, sys
server = socket.create_server(("127.0.0.1", 0), backlog=0)
callers = [socket.socket() for _ in range(8)]
for caller in callers:
    caller.setblocking(False)
    caller.connect_ex(server.getsockname())
print(server.getsockname()[1], flush=True)
sys.stdin.read()
EOF
    mkfifo "$work/hold" "$work/port"
    python3 "$work/deaf.py" <"$work/hold" >"$work/port" &
    deaf_pid=$!
    exec 4>"$work/hold"
    read -r deaf_port <"$work/port"
}
unconnected='no connection in 2 s; is the address right, and that machine on?$'
if have_json && [ "$(uname)" = Linux ]; then
    deaf_server
    check "a server that takes nobody" fails 1 "tcp:127.0.0.1:$deaf_port: $unconnected" \
        grctl -d "tcp:127.0.0.1:$deaf_port" status
    check "nor is it asked at other rates" both exits 1 \
        timeout 8 "$GRCTL" -d "tcp:127.0.0.1:$deaf_port" doctor --- says 'no connection in 2 s'
    exec 4>&-
    wait $deaf_pid
else
    skip "a server that takes nobody" "no python3, or another system's queues"
fi

start_sim
in_use() {
    "$GRCTL" -v -d "$robot" --timeout 500 --on-exit hold play "$greet" >/dev/null 2>"$work/holder" &
    holder=$!
    written "$work/holder" 'robot found' || return 1
    fails 1 "$robot: in use by another program (held by .*$(known_pid $holder)" \
        grctl -d "$robot" play "$greet"
    in_use_result=$?
    kill -TERM $holder
    wait $holder
    return $in_use_result
}
check "a device in use: who has it" in_use
stop_sim
start_sim --fault silent=1
check "a board without servos" fails 1 "$robot: no servo answers; are they powered?" \
    grctl -d "$robot" play "$greet"
stop_sim
start_sim --wiring bus # servos without a board: nobody answers to what a board is asked
check "no robot on it" fails 1 "$robot: no robot answers; is the robot switched on" \
    grctl -d "$robot" play "$greet"
stop_sim

test_case "numbers"

# A number has nothing behind it, and a number of times has no part.
no_number() {
    for number_text in 1.5 2x 0 -1 1000001 nan inf '' ' ' 1e; do
        fails 2 "^grctl: --repeat: '$number_text' is not a whole number from 1 to 1000000" \
            grctl -d sim play --repeat "$number_text" "$greet" || return 1
    done
    for number_text in 5x 0x1F nan inf '' 1,5 1e; do
        fails 2 "^grctl: move: '$number_text' is not an angle" \
            grctl -d sim move R_ELBOW_P "$number_text" || return 1
    done
}
check "what is none is refused" no_number

test_case "standard streams"

if [ -c /dev/full ]; then
    for line in help version "show $greet" "check --json $greet" "play --dry-run $greet" \
        "-d sim --json status" sim; do
        # $line is a command line, to be split.
        # shellcheck disable=SC2086
        to_full() {
            grctl $line >/dev/full 2>"$work/err"
            # musl and Windows forget the cause of what they wrote too early to be asked.
            [ $? -eq 1 ] &&
                complains '^grctl: standard output: cannot write: \(no room\|I/O\|Input/output\)'
        }
        check "a full disk: grctl ${line%%/*}" to_full
    done
fi
closed_output() {
    grctl -d sim status >&- 2>"$work/err"
    [ $? -eq 1 ] && complains '^grctl: standard output: cannot write: Bad file'
}
check "standard output closed" closed_output

# What would be printed to a closed descriptor must not go to the port that is opened next.
start_sim
all_closed() {
    grctl -d "$robot" status <&- >&- 2>&-
    [ $? -eq 1 ] || return 1
    exits 0 grctl -d "$robot" --timeout 500 status && says "L_ELBOW_P"
}
check "all three closed, on a port" all_closed
stop_sim
reader_left() {
    {
        grctl play --dry-run --rate 100 --unwatched "$greet" 2>"$work/err"
        echo $? >"$work/status"
    } | head -n 1 >"$work/out"
    [ "$(wc -l <"$work/out")" -eq 1 ] && [ ! -s "$work/err" ] && [ "$(cat "$work/status")" -eq 141 ]
}
check "a reader that leaves: the end, no complaint" reader_left

check "nothing is left behind" [ -z "$(ls -A "$work/here" "$work/tmp" | grep -v :)" ]
done_testing
