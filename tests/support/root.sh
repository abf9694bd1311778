# SPDX-License-Identifier: MIT
# For tests that need a fresh Debian or Ubuntu: a root of its own, made by debootstrap. It takes
# root rights and a network.
# Sets: build; here, this machine's architecture; work, a directory that keeps $work/roots. A test
# sets root, where one is to stand: it is removed at the end.
build=${BUILD:-build}
here=$(dpkg --print-architecture 2>/dev/null)
work=$build/package
mkdir -p "$work/roots" || exit 1
root=
trap '[ -z "$root" ] || rm -rf "$root"' EXIT

# needs_roots WHAT TOOL...: leaves WHAT out where a tool is missing.
needs_roots() {
    what=$1
    shift
    for command in "$@"; do
        if ! PATH=$PATH:/usr/sbin command -v "$command" >/dev/null; then
            skip "$what" "no $command (tools/setup.sh --packages installs it)"
            done_testing
            exit 0
        fi
    done
}

# make_root SUITE PACKAGES: kept as a tarball; unpacked into $root, with its lists of packages.
make_root() {
    tarball=$work/roots/$1-$2.tar
    rm -rf "$root"
    mkdir -p "$work/roots"
    if [ ! -s "$tarball" ]; then
        case $1 in
        jammy | noble | resolute)
            set -- "$1" "$2" http://archive.ubuntu.com/ubuntu gutsy main,universe
            ;;
        # A release that is being made: debootstrap of the one before does not know its name.
        forky) set -- "$1" "$2" http://deb.debian.org/debian sid main ;;
        *) set -- "$1" "$2" http://deb.debian.org/debian '' main ;;
        esac
        # shellcheck disable=SC2086
        PATH=$PATH:/usr/sbin:/sbin debootstrap --variant=minbase --components="$5" \
            --include="$2" "$1" "$root" "$3" $4 >"$work/debootstrap" 2>&1 ||
            { tail -n 5 "$work/debootstrap"; return 1; }
        tar -C "$root" -cf "$tarball.new" --exclude='./proc/*' --exclude='./sys/*' . &&
            mv "$tarball.new" "$tarball" || return 1
    else
        mkdir "$root" && tar -C "$root" -xf "$tarball" || return 1
    fi
    # A mirror that stands still has lists of testing that are older than they should be.
    echo 'Acquire::Check-Valid-Until "false";' >"$root/etc/apt/apt.conf.d/90-as-it-is"
    cp /etc/resolv.conf "$root/etc/resolv.conf" && in_root apt-get -q update
}

clean_environment="PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8
    DEBIAN_FRONTEND=noninteractive TMPDIR=/tmp"

# in_root COMMAND...
in_root() {
    # shellcheck disable=SC2086
    env -i $clean_environment chroot "$root" "$@"
}

# in_live_root COMMAND...: with the devices and processes of this machine, for pseudo-terminals. Its
# root is one that a process may have a user namespace in: a chroot() is none.
in_live_root() {
    mkdir -p "$root/before"
    # shellcheck disable=SC2016,SC2086
    env -i $clean_environment unshare -m sh -c 'mount --bind "$0" "$0" &&
        mount --rbind /dev "$0/dev" && mount -t proc proc "$0/proc" && cd "$0" &&
        pivot_root . before && umount -l /before && exec "$@"' "$root" "$@"
}
