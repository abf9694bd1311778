#!/bin/sh
# SPDX-License-Identifier: MIT
# grctl with none of the libraries that it can do without, as where a system has no package of them:
# what needs one says so in one line, and everything else works.
GRCTL=${BUILD:-build}/bare/grctl
[ ! -e "$GRCTL.exe" ] || GRCTL=$GRCTL.exe
. tests/support/cli.sh
bare() {
    ${EMULATOR:-} "$GRCTL" "$@"
}

if [ -z "${EMULATOR:-}" ] && command -v readelf >/dev/null 2>&1; then
    without() {
        readelf -d "$GRCTL" | grep NEEDED >"$work/needs"
        ! grep -e expat -e event_extra -e mosquitto -e libedit -e ncurses "$work/needs"
    }
    check "it is linked with none of them" without
fi
test_case "what was left out is told"
check "serve" fails 1 'serve: this grctl was built without evhttp' bare -d sim serve
check "fleet" fails 1 'this grctl has no MQTT in it' bare fleet list --broker mqtt://127.0.0.1:1
check "agent" fails 1 'this grctl has no MQTT in it' bare -d sim agent --broker mqtt://127.0.0.1:1
check "a URDF" fails 3 'built without expat' bare robot import tests/cli/urdf/so101.urdf
test_case "the rest works"
check "a robot plays" both exits 0 bare -d sim play --speed 400 motions/greet.pseq --- \
    says '^largest error'
printf 'status m2\n' >"$work/script"
check "a shell reads a script" both exits 0 bare -d sim shell "$work/script" --- says NECK_Y
done_testing
