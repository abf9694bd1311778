# SPDX-License-Identifier: MIT
# For tests that need a fresh Debian or Ubuntu: a root of its own, made by debootstrap. It takes
# root rights and a network.
# set before: work, a directory that keeps $work/roots; root, where it is to stand

# make_root SUITE PACKAGES: kept as a tarball; unpacked into $root, with its lists of packages.
make_root() {
    tarball=$work/roots/$1-$2.tar
    rm -rf "$root"
    mkdir -p "$work/roots"
    if [ ! -s "$tarball" ]; then
        case $1 in
        noble) set -- "$1" "$2" http://archive.ubuntu.com/ubuntu gutsy main,universe ;;
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
    cp /etc/resolv.conf "$root/etc/resolv.conf" && in_root apt-get -q update
}

clean_environment="PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8
    DEBIAN_FRONTEND=noninteractive TMPDIR=/tmp"

# in_root COMMAND...
in_root() {
    # shellcheck disable=SC2086
    env -i $clean_environment chroot "$root" "$@"
}

# in_live_root COMMAND...: with the devices and processes of this machine, for pseudo-terminals.
in_live_root() {
    # shellcheck disable=SC2016,SC2086
    env -i $clean_environment unshare -m sh -c 'mount --rbind /dev "$0/dev" &&
        mount -t proc proc "$0/proc" && exec chroot "$0" "$@"' "$root" "$@"
}
