# SPDX-License-Identifier: MIT
# For tests of a fleet of two hosts: one has the robots a and b, two has c, and d that is not there.
# Sourced behind fleet.sh. All that is said at the broker is kept, and fits_schema judges it.

mkdir -p "$work/config/grctl" "$work/motions"
cp motions/greet.pseq "$work/motions"
cat >"$work/config/grctl/config.yaml" <<EOF2
groups: {one: [a, b], two: [c, d]}
robots: {a: {device: sim}, b: {device: sim}, c: {device: sim}, d: {device: $work/none}}
EOF2

keeps_all=
kept=0
keep_all() { # what is said; once more for a broker that came back
    [ -n "$keeps_all" ] || return 0
    kept=$((kept + 1))
    python3 tests/support/mqtt.py "$port" keep "$work/kept.$kept" >"$work/keep.out" 2>&1 3>&- &
    echo $! >>"$work/pids"
}
begin_hosts() { # [OPTIONS of one]
    if python3 -c 'import jsonschema' 2>/dev/null; then
        keeps_all=yes
        keep_all
        wait_for test -e "$work/kept.1"
    fi
    begin_agent one "$@"
    agent_one=$agent
    begin_agent two --label arms,left --cockpit 'https://stage.local/%/'
    wait_for is_listed one ONLINE && wait_for is_listed two ONLINE && return
    echo "Bail out! the agents did not start"
    exit 1
}
fits() {
    cat "$work"/kept.[0-9] >"$work/kept"
    python3 tests/support/mqtt.py 0 fits "$work/kept" "$*"
}
# fits_schema KIND...: all that was said, some of these kinds too; each kind is in some script.
fits_schema() {
    if [ -n "$keeps_all" ]; then
        check "all that was said is as docs/fleet.schema.json says" fits "$@"
    else
        skip "all that was said is as docs/fleet.schema.json says" "no python3-jsonschema"
    fi
}

# plays_through FILE [OPTIONS]: to the end, though permits come late on a busy machine.
plays_through() {
    fleet play "$@" -s 400 --on-link-lost finish
}

# plays [OPTIONS]: with group one, slowly; returns when it was begun.
plays() {
    : >"$work/said" # what one before said is not taken for its words
    "$GRCTL" fleet play greet.pseq --broker "$broker" -s 20 --group one "$@" \
        >"$work/played" 2>"$work/said" </dev/null &
    play=$!
    written "$work/said" 'all begin in' && comes_to_move
}
# looks: at what all do; an answer that came too late is none.
looks() {
    fleet status --json >"$work/look" && grep -q '"play": *"' "$work/look"
}
moves() {
    looks && grep -q '"play": *"playing"' "$work/look"
}
rests() {
    looks && ! grep -q '"play": *"playing"' "$work/look" && grep -q '"play": *"idle"' "$work/look"
}
ended() {
    ended_with "$1" "$play"
}
# leader_killed [OPTIONS]: of a motion that plays; the agent says $lapsed.
leader_killed() {
    plays "$@" && kill -9 "$play" && { wait "$play"; written "$work/one.err" "$lapsed"; }
}
