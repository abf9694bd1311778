#!/bin/sh
# SPDX-License-Identifier: MIT
# Runs a program for Windows under wine, in a prefix of the build's own and without a display.
#
# usage: tools/cross/wine.sh PROGRAM [ARGUMENT]...
#        tools/cross/wine.sh --make     the prefix, where there is none
#        tools/cross/wine.sh --begin    its services, which else come and go with each program
#        tools/cross/wine.sh --end      what wine left running
# environment: GROBO_WINE, the folder of the prefix (default build/cross/win64)
folder=${GROBO_WINE:-$(dirname "$0")/../../build/cross/win64}
[ -d "$folder" ] && folder=$(cd "$folder" && pwd)
export WINEPREFIX="$folder/prefix"
export WINEARCH=win64
export WINEDEBUG=-all
# No menus on the desktop, no .NET, no browser: none is needed, and each asks for a display.
export WINEDLLOVERRIDES='winemenubuilder.exe,mscoree,mshtml='
unset DISPLAY TMPDIR # one server, wherever a test puts its files

case ${1:-} in
--make)
    [ -f "$WINEPREFIX/system.reg" ] && exit 0
    wine wineboot --init >/dev/null 2>&1 || exit 1
    exec wineserver -w
    ;;
--begin)
    # Its services end with the last program, and begin with the next, whose output they hold open:
    # who reads that would wait for them. So one program stays, and reads what nobody writes.
    rm -f "$folder/nothing" "$WINEPREFIX"/dosdevices/com[1-9][0-9] # of tests that were ended
    mkfifo "$folder/nothing"
    wine cmd.exe <>"$folder/nothing" >/dev/null 2>&1 &
    exec wine cmd.exe /c exit </dev/null >/dev/null 2>&1
    ;;
--end)
    [ -d "$WINEPREFIX" ] || exit 0
    wineserver -k 2>/dev/null
    exit 0
    ;;
esac
exec wine "$@"
