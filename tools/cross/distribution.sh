# SPDX-License-Identifier: MIT
# For tools/cross/libs.sh: libraries for another machine out of the distribution's own packages,
# through an apt that knows nothing of what is installed here and changes nothing of it. (To
# install libevent-dev:arm64 beside libevent-dev would remove the latter.)

packages='libc6-dev libevent-dev libyaml-dev libjansson-dev libedit-dev libncurses-dev'
packages="$packages libexpat1-dev libmosquitto-dev libcmocka-dev"
codename=$(. /etc/os-release && echo "${VERSION_CODENAME:-}") || codename=

# private_apt FOLDER ARCHITECTURE SUITE: $apt is an apt-get for that machine and suite, with all
# its state in the folder and the mirror of this machine's own lists.
private_apt() {
    mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Identifier: Packages' \
        "Codename: $codename" 2>/dev/null | head -n 1)
    keys=/usr/share/keyrings/debian-archive-keyring.gpg
    [ -n "$mirror" ] && [ -r "$keys" ] ||
        die "needs Debian's packages, and their lists (apt-get update)"
    mkdir -p "$1/lists/partial" "$1/archives/partial"
    : >"$1/status"
    for kind in deb deb-src; do
        echo "$kind [signed-by=$keys] $mirror $3 main"
    done >"$1/sources.list"
    apt="apt-get -q -y -o Dir::State=$1 -o Dir::State::status=$1/status -o Dir::Cache=$1"
    apt="$apt -o Dir::Etc::sourcelist=$1/sources.list -o Dir::Etc::sourceparts=/dev/null"
    apt="$apt -o APT::Architecture=$2 -o APT::Architectures=$2 -o APT::Sandbox::User="
    apt="$apt -o Debug::NoLocking=1 -o Acquire::Languages=none -o Acquire::Retries=3"
}

# quietly LOG COMMAND...: what it said is shown only when it fails.
quietly() {
    log=$1
    shift
    "$@" >>"$log" 2>&1 </dev/null && return
    tail -n 20 "$log" >&2
    die "failed: $*"
}

# True when what is in $work was made of $made_of.
is_made() {
    [ "$(cat "$work/made-of" 2>/dev/null)" = "$made_of" ]
}

# sysroot ARCHITECTURE SUITE: the packages and all they need, unpacked into $work/root.
sysroot() {
    made_of="$1 $2 $packages"
    is_made && return
    echo "cross: unpacking the libraries of $2 for $1" >&2
    rm -rf "$work"
    mkdir -p "$work/root"
    private_apt "$work/apt" "$1" "$2"
    # $apt and $packages are lists of words.
    # shellcheck disable=SC2086
    {
        quietly "$work/log" $apt update
        quietly "$work/log" $apt --no-install-recommends --download-only install $packages
    }
    for package in "$work"/apt/archives/*.deb; do
        quietly "$work/log" dpkg -x "$package" "$work/root"
    done
    # Packages of trixie and later take for granted that /lib is /usr/lib.
    [ -e "$work/root/lib" ] || ln -s usr/lib "$work/root/lib"
    # A link to /lib/... would lead out of the root, and the linker to a static library instead.
    find "$work/root" -type l -lname '/*' -exec sh -c '
        root=$1
        shift
        for link in "$@"; do
            ln -sfrT "$root$(readlink "$link")" "$link"
        done' sh "$work/root" {} +
    rm -rf "$work/apt"
    echo "$made_of" >"$work/made-of"
}
