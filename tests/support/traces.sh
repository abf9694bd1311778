# SPDX-License-Identifier: MIT
# For shell tests: traces made by hand.

# Bytes of hex, "41 00", on standard output.
bytes() {
    for byte; do
        # The format is the byte.
        # shellcheck disable=SC2059
        printf "\\$(printf %03o "0x$byte")"
    done
}

# A number of 32 bits as hex bytes, lowest first.
u32() {
    printf '%02x %02x %02x %02x' $(($1 & 255)) $(($1 >> 8 & 255)) $(($1 >> 16 & 255)) \
        $(($1 >> 24 & 255))
}

# make_trace <<LINES >FILE: lines "out TIME_US HEX..." and "in TIME_US HEX...".
make_trace() {
    bytes 0a 0d 0d 0a 1c 00 00 00 4d 3c 2b 1a 01 00 00 00 ff ff ff ff ff ff ff ff 1c 00 00 00
    bytes 01 00 00 00 14 00 00 00 93 00 00 00 00 00 00 00 14 00 00 00
    while read -r way time_us hex; do
        # The hex is a list of bytes.
        # shellcheck disable=SC2086
        set -- $hex
        [ "$way" = out ] && flags=02 || flags=01
        size=$#
        while [ $(($# % 4)) -ne 0 ]; do
            set -- "$@" 00
        done
        total=$(($# + 44))
        # shellcheck disable=SC2046
        bytes 06 00 00 00 $(u32 $total) 00 00 00 00 $(u32 $((time_us >> 32))) $(u32 "$time_us") \
            $(u32 $size) $(u32 $size) "$@" 02 00 04 00 $flags 00 00 00 00 00 00 00 $(u32 $total)
    done
}
