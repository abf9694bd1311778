# SPDX-License-Identifier: MIT
# For tests of grctl setup: a simulator of six servos of an SO-101 whose cables the test plugs in,
# and a setup in the background that is answered.
. tests/support/cli.sh
unset GRCTL_ROBOT
own_sim
GRCTL=$(cd "$(dirname "$GRCTL")" && pwd)/${GRCTL##*/}

# Servos 11 to 16 of the simulator, as they leave the factory but for their number there, which is
# how the simulator's commands know them: all say that they have id 1, and none is plugged in.
start_told_sim --servo 11=STS3215,12=STS3215,13=STS3215,14=STS3215,15=STS3215,16=STS3215 ||
    { echo "Bail out! the simulator did not start"; exit 1; }
for number in 11 12 13 14 15 16; do
    tell id $number 1
    tell silent $number on
done

# begin OPTION...: setup in the background; answers go to descriptor 8.
begin() {
    : >"$work/asked"
    rm -f "$work/answers"
    mkfifo "$work/answers"
    rm -f "$work/status"
    {
        "$GRCTL" -d "$robot" --yes setup "$@" <"$work/answers" >"$work/out" \
            2>"$work/asked" &
        echo $! >"$work/setup_pid"
        echo $! >>"$work/pids"
        wait $!
        echo $? >"$work/status"
    } &
    exec 8>"$work/answers"
}
# asked N PATTERN: the N-th line like that has come; none comes behind the end.
asked() {
    wait_for asked_or_ended "$1" "$2"
    asked_now "$1" "$2" || { echo "no $1 of '$2' in:"; cat "$work/asked"; return 1; }
}
asked_or_ended() {
    asked_now "$1" "$2" || [ -s "$work/status" ]
}
asked_now() {
    [ "$(grep -c -e "$2" "$work/asked")" -ge "$1" ]
}
answer() {
    echo "$1" >&8
}
ends() {
    wait_for [ -s "$work/status" ] && [ "$(cat "$work/status")" -eq "$1" ] && return
    cat "$work/status" "$work/asked"
    return 1
}
# give JOINT NUMBER ID: the servo with this number is plugged in, and gets its id.
give() {
    asked 1 "plug in the servo of $1 alone" && tell silent "$2" off && answer '' &&
        asked 1 "^$1: id 1 -> $3 at 1000000 bps, kept" && tell silent "$2" on
}
