#!/bin/sh
# SPDX-License-Identifier: MIT
# What each part of the core takes on a microcontroller, beside what it took when the figures were
# last kept; fails above the limits.
#
# usage: size.sh DIR BUILD...   DIR/BUILD has the objects, as `make size` builds them; its name is
#                               that of a processor, and -default with the caps of limits.h
# environment: PREFIX=arm-none-eabi-
#              UPDATE=1         keep the figures in tools/baremetal/size.tsv
set -u

# At most: text of codec, bus and sequencer on a Cortex-M0, whatever the caps; RAM of a bus with
# 20 joints, anywhere.
text_limit=13328
ram_limit=1024

prefix=${PREFIX:-arm-none-eabi-}
kept=tools/baremetal/size.tsv
dir=$1
shift
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
: >"$work/now"

# What belongs together. Codec, bus and sequencer need of the others only postures. Other families
# than RS30x, and several replies to one frame, are linked only where a program names them.
rooms='codec bus sequencer names postures robot engine simulator families'
codec='servo/gr001/board servo/rs30x/frame bus/framer servo/rs30x/build servo/rs30x/parse
    servo/rs30x/state'
bus='bus/bus bus/queue bus/receive bus/time base/instant'
sequencer='play/sequencer play/clip play/info'
names='base/error servo/rs30x/registers play/names base/version robot/reason'
postures='model/posture model/model model/order model/interpolate model/unit'
robot='servo/driver servo/rs30x/driver robots/gr001 robots/gr001_driver'
engine='robot/robot robot/turn robot/job robot/play robot/control robot/query robot/request
    robot/slot robot/steps robot/astray robot/axis robot/trajectories play/progress play/start
    robot/start
    robot/gate robot/couple robot/wheel robot/drive robot/check robot/lines
    robot/event robot/reading robot/orders robot/watch robot/trip robot/stop robot/segments
    robot/sense robot/cost robot/budget robot/holds robot/join robot/pace robot/queue
    robot/halted robot/blocked robot/often robot/stand robot/weight robot/state robot/speed
    robot/imu robot/reason
    base/sized'
simulator='servo/gr001/parser sim/board sim/bus sim/inspect sim/sim sim/wire servo/rs30x/sim
    sim/lines sim/servo/fault sim/servo/indirect sim/servo/note sim/servo/power sim/servo/registers
    sim/servo/servo sim/servo/shaft sim/servo/talk'
# All else of servos and robots, whatever family there is.
families=bus/several
for source in src/servo/*.c src/servo/*/*.c src/robots/*.c; do
    object=${source#src/}
    object=${object%.c}
    case $object in
    servo/words/* | servo/*/words*) continue ;; # firmware has none of them
    esac
    case " $(echo $codec $names $robot $simulator) " in
    *" $object "*) ;;
    *) families="$families $object" ;;
    esac
done

# figure CPU NAME BYTES: notes it, and prints it beside the one that was kept.
figure() {
    printf '%s\t%s\t%s\n' "$1" "$2" "$3" >>"$work/now"
    before=$(awk -F '\t' -v cpu="$1" -v name="$2" '$1 == cpu && $2 == name { print $3 }' \
        "$kept" 2>/dev/null)
    printf '  %-28s %7d  %7s\n' "$2" "$3" "${before:--}"
}

# One line an object: OBJECT TEXT DATA.
measure() {
    find "$1/src" -name '*.o' | sort | while read -r object; do
        name=${object#"$1"/src/}
        "${prefix}size" "$object" | awk -v name="${name%.o}" 'NR == 2 { print name, $1, $2 + $3 }'
    done >"$work/objects"
    find "$1/src" -name '*.o' | while read -r object; do
        name=${object#"$1"/src/}
        "${prefix}objdump" -dr --no-show-raw-insn "$object" | sed "s,^,${name%.o} ,"
    done >"$work/calls"
}

sum() {
    awk -v objects="$1" -v column="$2" '
        BEGIN { n = split(objects, list, " "); for (i = 1; i <= n; i++) wanted[list[i]] = 1 }
        $1 in wanted { bytes += $column }
        END { print bytes + 0 }' "$work/objects"
}

report() {
    cpu=$1
    measure "$dir/$cpu"
    printf '%s, bytes%24s  %7s\n' "$cpu" now before
    printf ' text\n'
    told=
    for room in $rooms; do
        eval "objects=\$$room"
        for object in $objects; do
            figure "$cpu" "$object" "$(sum "$object" 2)"
            told="$told $object"
        done
        figure "$cpu" "= $room" "$(sum "$objects" 2)"
    done
    text=$(sum "$codec $bus $sequencer" 2)
    figure "$cpu" '= codec, bus, sequencer' "$text"
    figure "$cpu" '= static data of all' "$(sum "$told" 3)"
    printf ' memory of one\n'
    "${prefix}nm" -S --radix=d "$dir/$cpu/tools/baremetal/ram.o" | sed -n 's/ ram_/ /p' |
        while read -r _ bytes _ name; do
            figure "$cpu" "$name" "$(expr "$bytes" + 0)"
        done
    printf ' stack, deepest chain of calls\n'
    for room in $rooms; do
        eval "objects=\$$room"
        # The files' names have no spaces.
        # shellcheck disable=SC2046
        awk -v objects="$(echo $objects)" -f tools/baremetal/stack.awk \
            $(find "$dir/$cpu/src" -name '*.su') "$work/calls" >"$work/deepest"
        read -r bytes way <"$work/deepest"
        figure "$cpu" "stack $room" "$bytes"
        printf '    %s\n' "$way"
    done
    judge
}

# Whatever has no room, and whatever is above a limit.
judge() {
    awk '{ print $1 }' "$work/objects" | while read -r object; do
        case " $told " in
        *" $object "*) ;;
        *) echo "size: src/$object.c is in no room of tools/baremetal/size.sh" ;;
        esac
    done >>"$work/bad"
    case $cpu in
    cortex-m0 | cortex-m0-*)
        texts="$texts${texts:+ and }$text on $cpu"
        if [ "$text" -gt $text_limit ]; then
            echo "size: codec, bus and sequencer take $text bytes on $cpu, more than $text_limit"
        fi >>"$work/bad"
        ;;
    esac
    ram=$(awk -F '\t' -v cpu="$cpu" '$1 == cpu && $2 == "bus_of_20" { print $3 }' "$work/now")
    if [ "$text" -eq 0 ] || [ -z "$ram" ]; then
        echo "size: nothing could be measured on $cpu"
    elif [ "$ram" -gt $ram_limit ]; then
        echo "size: a bus of 20 joints takes $ram bytes on $cpu, more than $ram_limit"
    fi >>"$work/bad"
}

: >"$work/bad"
texts=
for cpu in "$@"; do
    report "$cpu"
done
if [ -n "${UPDATE:-}" ]; then
    cp "$work/now" "$kept"
fi
if [ -s "$work/bad" ]; then
    cat "$work/bad" >&2
    exit 1
fi
echo "size: of $text_limit bytes codec, bus and sequencer take $texts;" \
    "of $ram_limit bytes a bus of 20 joints takes $ram"
