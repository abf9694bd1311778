#!/bin/sh
# SPDX-License-Identifier: MIT
# scan, servo-get, servo-set and doctor with DYNAMIXEL servos: by the names of their own registers,
# kept as they keep them.
. tests/support/cli.sh
. tests/support/registers.sh

test_case "DYNAMIXEL: kept at once, without torque only"

start_told_sim --robot koch || { echo "Bail out! the simulator did not start"; exit 1; }
check "two models on a line" both exits 0 of koch scan --last 4 --- \
    both says '^  2  XL430-W250  firmware  52  1000000 bps  shoulder_lift$' --- \
    says '^  3  XL330-M288  firmware  52  1000000 bps  elbow_flex$'
check "each has its own registers" both exits 0 of koch servo-get 1 present_load --- \
    fails 2 "no register 'present_load'; XL330-M288 has: model" of koch servo-get 3 present_load
check "a setting is kept" both exits 0 of koch servo-set 3 return_delay 0 --- \
    said '^servo 3: return_delay 250 (500 us) -> 0 (0 us), kept$'
restarted 3
check "over power-off" wait_for both exits 0 of koch servo-get 3 return_delay --- \
    says '^  9  return_delay  *0  *0 us$'
exits 0 of koch servo on elbow_flex
check "not of a servo that holds" fails 4 'servo 3 holds, and .* another return_delay' \
    of koch servo-set 3 return_delay 10
check "what is no setting" both exits 0 of koch servo-set 3 led 1 --- \
    said '^servo 3: led 0 -> 1; lost at power-off$'
exits 0 of koch servo off elbow_flex
check "one that would answer pings alone" fails 4 'reply_level 0 a servo answers nothing' \
    of koch servo-set 2 reply_level 0
check "or in another protocol" fails 4 'protocol_type 1 a servo answers nothing' \
    of koch servo-set 2 protocol_type 1
exits 0 of koch servo-set 2 reply_level 1
check "one that answers readings alone" both exits 0 of koch servo-set 2 led 1 --- \
    said '^servo 2: led 0 -> 1; lost at power-off$'
check "the rate" both exits 0 of koch servo-set 6 baud 57600 --- \
    said 'baud 3 (1000000 bps) -> 1 (57600 bps), kept; it answers at 57600 bps$'
check "and back" exits 0 of koch -b 57600 servo-set 6 baud 1000000
check "doctor" both exits 0 of koch doctor --- says 'all 6 answer'
stop_sim
done_testing
