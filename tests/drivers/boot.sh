#!/bin/sh
# SPDX-License-Identifier: MIT
# Tests serial ports on real drivers: boots the distribution's kernel in a virtual machine whose
# 8250 ports and FTDI adapters are qemu's, runs init and guest.sh in it, and pulls adapters out and
# puts them back when guest.sh asks. Prints TAP.
#
# environment: BUILD, GRCTL, and DRIVER_PROGRAMS, the test programs that guest.sh runs
#
# The machine's ports:
#   ttyS0    what it prints comes here
#   ttyS1    joined to ttyS2
#   ttyUSB0  joined to ttyS3
#   ttyUSB1  a simulated robot that runs here; may be pulled out, and another adapter, with nothing
#            at its end, be plugged in
set -u

give_up() {
    echo "1..0 # SKIP $1"
    exit 0
}

. tests/support/tap.sh
here=$(dirname "$0")
folder=$(cd "$BUILD" && pwd)/drivers || exit 1
qemu=qemu-system-x86_64
[ "$(uname -m)" = x86_64 ] || give_up 'the programs are not for x86_64'
for command in $qemu apt-get dpkg-deb; do
    command -v $command >/dev/null || give_up "no $command here"
done
sh "$here/fetch.sh" "$folder/debian" || exit 1

# ---- the disk: everything that the machine has -------------------------------------------------

root=$folder/root
# As the rules of udev know them.
groups='root:0 tty:5 disk:6 lp:7 kmem:15 dialout:20 cdrom:24 tape:26 audio:29 video:44 input:100
    render:101 sgx:102 kvm:103'

make_disk() {
    rm -rf "$root"
    mkdir -p "$root/etc" "$root/proc" "$root/sys" "$root/dev" "$root/run" "$root/tmp" "$root/tests"
    cp -a "$folder/debian/root/." "$folder/debian/modules" "$root"
    cp tools/udev/60-grobo.rules "$root/lib/udev/rules.d"
    cp "$here/init" "$here/guest.sh" tests/support/tap.sh motions/greet.pseq "$root"
    chmod +x "$root/init"
    echo 'root:x:0:0:root:/:/bin/sh' >"$root/etc/passwd"
    for group in $groups; do
        echo "${group%:*}:x:${group#*:}:"
    done >"$root/etc/group"
    # $DRIVER_PROGRAMS is a list.
    # shellcheck disable=SC2086
    cp $DRIVER_PROGRAMS "$root/tests"
    cp "$GRCTL" "$root/bin"
    strip "$root"/tests/* "$root/bin/grctl"
    LD_LIBRARY_PATH=$root/lib/x86_64-linux-gnu ldd "$root"/tests/* "$root/bin/grctl" \
        "$root/bin/udevadm" | grep -o '/[^ ]*lib[^ ]*\.so[^ :]*' | sort -u |
        while read -r library; do
            case $library in
            "$root"/*) ;;
            *) mkdir -p "$root${library%/*}" && cp -L "$library" "$root$library" ;;
            esac
        done
    (cd "$root" && find . | bin/busybox cpio -o -H newc 2>/dev/null) >"$folder/disk.cpio"
}
make_disk || exit 1

# ---- the simulated robot -----------------------------------------------------------------------

sim_pid=
qemu_pid=
end() {
    exec 5>&-
    for pid in $qemu_pid $sim_pid; do
        kill "$pid" 2>/dev/null
    done
    rm -rf "$work"
}
work=$(mktemp -d) || exit 1
trap end EXIT
trap 'exit 1' INT TERM

mkfifo "$work/tell" "$work/ready" "$work/monitor.in" "$work/monitor.out" "$work/console"
"$GRCTL" sim --tcp 0 <"$work/tell" >"$work/ready" 2>"$work/sim.log" &
sim_pid=$!
exec 5>"$work/tell"
read -r _ <"$work/ready"
wait_for grep -q '^also at tcp:' "$work/sim.log" || exit 1
sim_port=$(sed -n 's/^also at tcp:.*://p' "$work/sim.log")

# For wait_for: asks each time, and looks at what has been answered so far.
moves() {
    echo look >&5
    grep -q ', moving' "$work/sim.log"
}

# ---- the machine -------------------------------------------------------------------------------

# One cable is a socket: a sender waits while it is full, as for a pseudo-terminal. An adapter of
# qemu's must not wait so for the machine that it is a part of: its cable is by UDP, and what nobody
# takes is lost. Nobody else has this address of the loopback.
address=127.$(($$ / 65536 % 256)).$(($$ / 256 % 256)).$(($$ % 254 + 1))
robot=usb-serial,chardev=robot,serial=ROBOT,id=robot
other=usb-serial,chardev=other,serial=OTHER,always-plugged=on
timeout -k 5 240 $qemu -nodefaults -no-user-config -display none -no-reboot -m 512 -accel tcg \
    -kernel "$folder/debian/vmlinuz" -initrd "$folder/disk.cpio" \
    -append 'console=ttyS0 loglevel=1 panic=-1' \
    -chardev stdio,id=console,signal=off -device isa-serial,chardev=console \
    -chardev pipe,id=monitor,path="$work/monitor" -mon chardev=monitor \
    -chardev socket,id=s1,path="$work/cable",server=on,wait=off \
    -chardev socket,id=s2,path="$work/cable" \
    -chardev udp,id=u0,localaddr=$address,localport=47001,host=$address,port=47002 \
    -chardev udp,id=s3,localaddr=$address,localport=47002,host=$address,port=47001 \
    -chardev socket,id=robot,host=127.0.0.1,port="$sim_port" -chardev null,id=other \
    -device isa-serial,chardev=s1,index=1 -device isa-serial,chardev=s2,index=2,irq=5 \
    -device isa-serial,chardev=s3,index=3,irq=7 -device qemu-xhci \
    -device usb-serial,chardev=u0,serial=CABLE,always-plugged=on -device $robot \
    </dev/null >"$work/console" 2>&1 &
qemu_pid=$!

unplug() {
    echo "device_del robot" >"$work/monitor.in"
}

ended=
carriage_return=$(printf '\r')
while IFS= read -r line; do
    line=${line%"$carriage_return"}
    case $line in
    @unplug) unplug ;;
    @pull)
        wait_for moves
        unplug
        ;;
    @plug) echo "device_add $robot" >"$work/monitor.in" ;;
    @other) echo "device_add $other" >"$work/monitor.in" ;;
    @end) ended=1 ;;
    *) printf '%s\n' "$line" ;;
    esac
done <"$work/console"
wait $qemu_pid
status=$?
qemu_pid=
[ -n "$ended" ] || echo "not ok 1 - the machine came to its end (qemu: status $status)"
