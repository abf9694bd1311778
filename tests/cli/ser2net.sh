#!/bin/sh
# SPDX-License-Identifier: MIT
# A robot behind ser2net, which serves its serial port as a raw TCP connection.
. tests/support/cli.sh

if ! command -v ser2net >/dev/null; then
    skip "a robot behind ser2net" "no ser2net here"
    done_testing
    exit 0
fi

server=
end_server() {
    [ -z "$server" ] || kill "$server" 2>/dev/null
    end_cli_test
}
trap end_server EXIT

# Nobody else has this address of the loopback.
address=127.$(($$ / 65536 % 256)).$(($$ / 256 % 256)).$(($$ % 254 + 1))
device=tcp:$address:47000
start_sim || { echo "Bail out! the simulator did not start"; exit 1; }
cat >"$work/ser2net.yaml" <<EOF
connection: &robot
  accepter: tcp,$address,47000
  connector: serialdev,$sim_pty,115200n81,local
EOF
ser2net -n -c "$work/ser2net.yaml" -P "$work/ser2net.pid" 2>"$work/ser2net.log" &
server=$!

answers() {
    wait_for exits 0 "$GRCTL" -d "$device" info && return
    cat "$work/err" "$work/ser2net.log"
    return 1
}

test_case "a robot behind ser2net"
check "it answers" answers
check "a motion" exits 0 "$GRCTL" -d "$device" --timeout 500 play motions/greet.pseq
check "doctor" both exits 0 "$GRCTL" -d "$device" --timeout 500 doctor --- \
    says '^ok .*all 20 answer'
"$GRCTL" -d "$device" -v play --repeat 9 motions/greet.pseq >"$work/played" 2>&1 &
player=$!
check "another one" written "$work/played" 'robot found'
kill "$server"
wait "$server"
wait "$player"
status=$?
server=
test_case "the server ends"
check "the server ends: the robot is gone" [ $status -eq 1 ]
check "and that is said" grep -q "^grctl: $device: device is gone" "$work/played"
check "nobody serves it" fails 1 "^grctl: $device: .*does a serial server listen there" \
    "$GRCTL" -d "$device" info
done_testing
