#!/bin/sh
# SPDX-License-Identifier: MIT
# An IMU beside the robot: the cockpit is tilted by it and tells a fall, a recording keeps it.
. tests/support/pages.sh

imu() {
    printf '%s\n' "$1" >"$work/new" && mv "$work/new" "$work/reading"
}
imu '0.5 -2 0.1 0.2 0.3'
python3 tests/support/imu.py "$work/imu" "$work/reading" &
echo $! >>"$work/pids"
wait_for [ -e "$work/imu" ]

# state EXPRESSION: of the state s that the page has.
state() {
    python3 - "$page" "$1" <<'PY'
import json, sys, urllib.request
s = json.load(urllib.request.urlopen(sys.argv[1] + "api/state"))
imu, body = s["imu"], s["body"]
sys.exit(0 if eval("(" + sys.argv[2] + ")") else print(imu, body and body["root"]) or 1)
PY
}
begin() {
    "$GRCTL" -d sim serve --port 0 --imu "$work/imu" motions >"$work/link" 2>"$work/served" &
    serve_pid=$!
    echo $serve_pid >>"$work/pids"
    written "$work/link" '#token=' && page=$(sed 's/#.*//' "$work/link")
}
# The events so far: the first, and what follows in half a second.
events() {
    python3 - "$page" <<'PY'
import socket, sys, urllib.request
request = urllib.request.Request(sys.argv[1] + "api/events", headers={"Last-Event-ID": "0"})
with urllib.request.urlopen(request, timeout=5) as stream:
    for _ in range(60):
        line = stream.readline().decode()
        if '"kind": "fall"' in line or '"kind":"fall"' in line:
            print(line.strip())
        if line.startswith("event: state"):
            break
PY
}
begin
test_that 'a state has what the IMU reads' \
    wait_for state 'imu and imu["roll_deg"] == 0.5 and imu["pitch_deg"] == -2.0 and
        imu["rate_dps"] == [0.1, 0.2, 0.3] and imu["age_ms"] < 1000 and not imu["fallen"]'
test_that 'a body that stands is drawn flat on its feet' \
    wait_for state 'body and any(sole["standing"] for sole in body["soles"])'
imu '0 30 0 0 0'
test_that 'one that leans is drawn so, and has not fallen' \
    wait_for state 'imu["tilt_deg"] == 30.0 and not imu["fallen"] and body["root"] and
        abs(body["root"]["rotation"][2] - 0.5) < 1e-3 and
        abs(body["root"]["rotation"][6] + 0.5) < 1e-3'
imu '80 0 0 0 0'
test_that 'one that lies is drawn so' \
    wait_for state 'imu["fallen"] and abs(body["root"]["rotation"][7] - 0.98481) < 1e-4'
tells() {
    events | grep -q -e "$1"
}
test_that 'a fall is an event' wait_for tells 'has fallen: it is tilted by 80 degrees'
imu '31 0 0 0 0'
test_that 'one that is half up has not got up' \
    wait_for state 'imu["roll_deg"] == 31 and imu["fallen"]'
imu '0 29 0 0 0'
test_that 'its end is one too' wait_for tells 'the robot is up again'
imu 'no reading'
test_that 'without readings there is no tilt' wait_for state 'imu is None and
    any(sole["standing"] for sole in body["soles"])'
kill $serve_pid
wait $serve_pid
test_that 'lines that are none are counted' \
    grep -q 'lines of the IMU were no readings' "$work/served"

imu '1.5 -2.25 10 20 30'
keys() {
    sleep 1
    printf ' '
    sleep 0.3
    printf ' '
    sleep 0.3
    printf ' d s'
}
records() {
    "$GRCTL" -d sim servo on >"$work/out" 2>&1
    keys | (cd "$work" && "$GRCTL" -d sim record --key --imu "$work/imu" -o a.pseq) \
        >"$work/out" 2>"$work/err" || { cat "$work/err"; return 1; }
    read_row=1.50,-2.25,10.00,20.00,30.00
    printf '%s\n' time_s,roll_deg,pitch_deg,x_dps,y_dps,z_dps "1.000,$read_row" "2.000,$read_row" \
        "3.000,$read_row" |
        cmp - "$work/a.pseq.imu.csv" && grep -q 'a.pseq.imu.csv' "$work/err"
}
test_that 'a recording keeps the tilt of each posture' records
test_that 'a port that is not there ends it' ends_with 1 'no such file' \
    "$GRCTL" -d sim record --imu "$work/nowhere" -o "$work/b.pseq"
rm "$work/reading"
done_testing
