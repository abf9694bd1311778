# SPDX-License-Identifier: MIT
# What is tested in the machine of boot.sh. Prints TAP; prints @unplug and @plug where the robot's
# adapter is to be pulled out and put back, @pull where that is to happen as soon as a joint moves,
# @other where another one is to be plugged in, and @end at the end.
export CMOCKA_MESSAGE_OUTPUT=TAP HOME=/tmp
. /tap.sh

robot=/dev/serial/by-id/usb-QEMU_QEMU_USB_SERIAL_ROBOT-if00-port0

# run PROGRAM: a program that says nothing has failed too.
run() {
    echo "# ---- $1, $(cut -d ' ' -f 1 /proc/uptime) s"
    timeout 60 "/tests/$1"
    status=$?
    [ $status -lt 124 ] || echo "not ok 1 - $1 ended with status $status"
}

appears() {
    wait_for test -e "$1"
}
vanishes() {
    wait_for test ! -e "$1"
}

# cable DRIVER NEAR FAR
cable() {
    echo "# ==== $1: $2 to $3"
    export GROBO_TEST_DRIVER=$1 GROBO_TEST_SERIAL=$2,$3
    run test_serial_open
    run test_driver
    # Somebody has it open all the time: qemu's hardware takes no bytes while nobody has, it has
    # the sender wait instead.
    # shellcheck disable=SC2217 # it reads nothing: it holds the line open
    sleep 200 <"$2" &
    holder=$!
    run test_conformance
    run test_serial_sync
    run test_serial_async
    kill $holder
}

cable 8250 /dev/ttyS1 /dev/ttyS2
cable ftdi_sio /dev/ttyUSB0 /dev/ttyS3

echo '# ==== a robot behind ftdi_sio'
GROBO_TEST_DEVICE=$(readlink -f "$robot") GROBO_TEST_NAME=$robot run test_replug

[ -e "$robot" ] || echo @plug
appears "$robot"
tty=$(readlink -f "$robot")
sys=/sys/bus/usb-serial/devices/${tty##*/}

# says PATTERN COMMAND...
says() {
    pattern=$1
    shift
    "$@" >/tmp/said 2>&1
    status=$?
    cat /tmp/said
    [ $status -eq 0 ] && grep -q -e "$pattern" /tmp/said
}

# refused STATUS PATTERN COMMAND...
refused() {
    wanted=$1
    pattern=$2
    shift 2
    "$@" >/tmp/said 2>&1
    status=$?
    cat /tmp/said
    [ $status -eq "$wanted" ] && grep -q -e "$pattern" /tmp/said
}

test_case 'an adapter is known and found'
check 'its group is dialout' [ "$(stat -c '%G %a' "$tty")" = 'dialout 660' ]
check 'ports: USB ids and driver' says "^$tty .*free .*USB 0403:6001 .*(ftdi_sio)" grctl ports
check 'ports: its name that stays' says " $robot\$" grctl ports
check 'ports: an 8250' says '^/dev/ttyS1 .*free' grctl ports
echo 16 >"$sys/latency_timer"
check 'doctor: all is well' says '^all [0-9]* checks passed' grctl -d "$robot" doctor -v
check 'doctor: and it has shortened the latency' says 'latency timer is 1 ms' \
    grctl -d "$robot" doctor -v
check 'auto: the robot is found' says "robot found on $tty" grctl -v status

grctl -d "$robot" status --watch >/tmp/watch 2>&1 &
watcher=$!
wait_for test -s /tmp/watch
test_case 'who holds a port is named'
check 'a held port names its holder' refused 1 "held by grctl (pid $watcher)" \
    grctl -d "$robot" status
check 'ports: and who holds it' says "open in grctl (pid $watcher)" grctl ports
kill -INT $watcher
wait $watcher

test_case 'a motion, and one that loses its line'
check 'a motion' says '' grctl -d "$robot" play /greet.pseq

grctl -d "$robot" play /greet.pseq >/tmp/play 2>&1 &
player=$!
echo @pull
wait $player
status=$?
sed 's/^/# /' /tmp/play
check 'a motion that loses its line: status 1' [ $status -eq 1 ]
check 'a motion that loses its line: says so' \
    grep -q "$robot: device is gone while busy with play" /tmp/play
vanishes "$tty"
check 'ports: it is gone' [ "$(grctl ports | grep -c ROBOT)" -eq 0 ]
check 'it cannot be opened' refused 1 "$robot" grctl -d "$robot" status
echo @plug
appears "$robot"
test_case 'plugged in again it answers and stands still'
check 'plugged in, it answers under its name' says '' grctl -d "$robot" status
# Each asks all servos, which takes the line more than a tenth of a second; compared without the
# head, and the age of each reading at the end.
stands_still() {
    sed '1d; s/ *[0-9]*$//' /tmp/said >/tmp/before
    for _ in 1 2 3 4 5 6 7 8 9 10; do
        says '' grctl -d "$robot" status || return 1
        sed '1d; s/ *[0-9]*$//' /tmp/said | cmp /tmp/before - || return 1
    done
}
check 'and stands still, to a tenth of a degree' stands_still

# As in a container. Nothing after this needs /sys.
without_sys() {
    umount -l /sys && grctl ports && [ ! -e /sys/class ]
}
test_case 'without /sys'
check 'ports: without /sys an adapter has its name' says "^ .*${robot##*/}\$" without_sys
check 'ports: and may be used' says '' grctl -d "$robot" info
done_testing
echo @end
