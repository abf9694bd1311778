# SPDX-License-Identifier: MIT
# Gate: the unit is in the name. A modest heuristic, for headers: a number (field or parameter)
# whose name ends in a word for a dimension must go on with its unit: delay_us, not delay.

BEGIN {
    number = "(double|float|int|long|short|unsigned|size_t|u?int(8|16|32|64)_t)"
    words = "(time|times|timeout|deadline|delay|period|interval|duration|age|angle|angles|speed|" \
        "velocity|voltage|volts|current|temperature|baud|bitrate|latency)"
}

# The names there are those of the reference document.
FILENAME ~ /(^|\/)grobo\/classic\// { next }

{
    text = " " code " "
    while (match(text, number "[ *]+([a-z0-9_]+_)?" words " *([][;,)=]|\\[)")) {
        found = substr(text, RSTART, RLENGTH)
        text = substr(text, RSTART + RLENGTH)
        sub(/ *[][;,)=]$/, "", found)
        sub(/.*[ *]/, "", found)
        complain("units: " found " has no unit in its name (_us _ms _s _deg _rad _ddeg _ma ...)")
    }
}
