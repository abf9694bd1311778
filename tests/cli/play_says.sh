#!/bin/sh
# SPDX-License-Identifier: MIT
# grctl play: what it says while it plays and at the end, as a bar, as text, as JSON.
. tests/support/cli.sh

greet=motions/greet.pseq

test_case "what is said"

start_sim
check_json "JSON: a line a second, then the end" \
    '[sorted(l) for l in lines[:-1]] == [["step", "steps", "t_ms", "total_ms"]] * (len(lines) - 1)
     and 2 <= len(lines) - 1 <= 5 and lines[0]["total_ms"] == 5000 and
     lines[-1]["done"] is True and
     lines[-1]["frames"] > 0 and lines[-1]["frames"] + lines[-1]["late_frames"] > 100 and
     sorted(lines[-1]["jitter_us"]) == ["max", "p50", "p99"] and
     0 <= lines[-1]["max_error_deg"] <= 0.1' \
    on_robot --json play --rate 50 --unwatched --speed 200 "$greet"
says_unwatched() {
    exits 0 on_robot play --rate 50 --unwatched --speed 500 "$greet" &&
        grep -q '^play: unwatched at 50 Hz: .* up to 39 Hz)$' "$work/err"
}
check "unwatched, and it says so" says_unwatched
quiet_where_no_terminal() {
    exits 0 on_robot play --speed 500 "$greet" && [ ! -s "$work/err" ] || return 1
    says '^[0-9]* frames, [0-9]* late; jitter p50 ' && says '^largest error at the end 0\.[01] deg'
}
check "no terminal: no progress bar, nothing on standard error" quiet_where_no_terminal
check "a table at the end" both exits 0 on_robot play --speed 500 --table "$greet" --- \
    says '^ *12  R_KNEE_P  *-40\.0  *-40\.0  *-*0\.0'
check "how far off it was, and which joint" both exits 0 on_robot play "$greet" --- \
    says '^largest error on the way [0-9.]* deg ([A-Z_]*)$'
check "it ends where the motion ends" both exits 0 on_robot status m12 --- \
    says 'R_KNEE_P  *-40\.0  *-40\.0  *on '

# On a terminal, which script makes: a bar that fits into the line and is cleared away.
# on_screen COMMAND...: a machine that is away for 250 ms ends a motion, as it has to.
on_screen() {
    LC_ALL=C TERM=xterm script -qec "stty cols 60; '$GRCTL' -d '$robot' --timeout 500 $*" \
        /dev/null </dev/null >"$work/screen"
}
# bar WORD PATTERN COMMAND...: lines with the word; one is like the pattern.
bar() {
    bar_word=$1
    bar_like=$2
    shift 2
    on_screen "$@" || { grep -q 'host stalled' "$work/screen" && on_screen "$@"; } ||
        { cat -v "$work/screen"; return 1; }
    tr '\r' '\n' <"$work/screen" | grep "$bar_word" >"$work/bars"
    grep -q "$bar_like" "$work/bars" || { echo "no '$bar_like'"; cat -v "$work/screen"; return 1; }
    awk '{ sub(/\033\[K$/, ""); if (length > 57) exit 1 }' "$work/bars" && return
    echo "longer than the line"
    return 1
}
if command -v script >/dev/null 2>&1 && script -qec true /dev/null </dev/null >/dev/null 2>&1; then
    check "a bar of plain letters" bar playing \
        '^\[#[#-]*\] playing [0-9.]* of 5.0 s, .* s left' play --speed 400 "$greet"
    check "a bar of a long move" bar 'move: ' '^\[##*--*\] move: [12]\.[0-9] of 2\.5 s' \
        move R_KNEE_P -60 2500
else
    skip "a bar of plain letters" "no script(1) to make a terminal"
    skip "a bar of a long move" "no script(1) to make a terminal"
fi

stop_sim
done_testing
