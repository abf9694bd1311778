#!/bin/sh
# SPDX-License-Identifier: MIT
# Independent clients of other servos against the simulator. PYTHON has their packages installed;
# one that is missing is skipped.
. tests/support/cli.sh

PYTHON=${PYTHON:-python3}

# PACKAGE SERVOS CLIENT...
against() {
    package=$1
    servos=$2
    shift 2
    for one in "$@"; do
        if "$PYTHON" -c "import $package" 2>/dev/null; then
            start_sim --servo "$servos"
            test_that "$one" "$PYTHON" tests/families/clients.py "$one" "$robot"
            stop_sim
        else
            test_case "$one"
            skip "$one" "the package $package is not installed"
        fi
    done
}

against dynamixel_sdk 1=XL330-M288,2=XL430-W250,3=XM430-W350 dynamixel_sdk_2
against dynamixel_sdk 1=XM430-W350,2=XM540-W270 dynamixel_sdk_indirect
against dynamixel_sdk 1=XW540-T260,2=MX-106-2 dynamixel_sdk_indirect
layouts=1=XL-320,2=XM430-W350,3=MX-28-2,4=PH54-200-S500-R,5=H54-200-S500-RA,6=H54-200-S500-R
layouts=$layouts,7=XW540-T260,8=MX-106-2
against dynamixel_sdk "$layouts" dynamixel_sdk_layouts
against dynamixel_sdk 1=AX-12A,2=MX-28,3=MX-106 dynamixel_sdk_1
against rustypot 1=XL330-M288,2=XL330-M288,3=XL330-M288 rustypot_x
against rustypot 1=STS3215,2=STS3215,3=STS3215 rustypot_sts
against scservo_sdk 1=STS3215,2=STS3215,3=STS3215 feetech
against scservo_sdk 1=HLS3930,2=HLS3930,3=HLS3930 feetech_hls
against scservo_sdk 1=SM85CL,2=SM85CL,3=SM85CL feetech_smcl
against scservo_sdk 1=SCS0009 feetech_scs
against feetech_cli 1=STS3215,2=STS3215,3=STS3215 feetech_cli
against lerobot 1=STS3215,2=STS3215,3=STS3215,4=STS3215,5=STS3215,6=STS3215 lerobot_so101
plugin() {
    PYTHONPATH=${BUILD:-build}/python GROBO_LEROBOT=real "$PYTHON" -X dev \
        tests/package/python/test_lerobot.py 2>&1
}
test_case "the plugin in LeRobot itself"
if "$PYTHON" -c 'import cffi, lerobot' 2>/dev/null; then
    check "the plugin in LeRobot itself" plugin
else
    skip "the plugin in LeRobot itself" "no lerobot or cffi"
fi
rates() {
    "$PYTHON" tests/families/clients.py rates "$robot" >"$work/rates"
}

if "$PYTHON" -c 'import grobo, lerobot, rustypot' 2>/dev/null; then
    start_sim --robot so101
    test_that "an arm is read as fast as the wire allows, beside others" rates
    sed 's/^/# /' "$work/rates"
    stop_sim
else
    test_case "an arm is read beside others"
    skip "an arm is read beside others" "a package is not installed"
fi
done_testing
