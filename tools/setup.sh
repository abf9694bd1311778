#!/bin/sh
# SPDX-License-Identifier: MIT
# Installs what is missing to build libgrobo, with the system's package manager.
#
# usage: tools/setup.sh [--demo | --check | --ci | --cross TARGET | --drivers | --ports |
#                        --mutants | --packages | --cockpit] [--dry-run]
#   --demo     what a build and the demo need (default)
#   --check    that, what `make check` needs, and the programs without which it skips checks
#   --ci       that, and what the other stages of .ci/run need: clang with libFuzzer, abidiff
#   --cross    what `make cross TARGET=...` needs (Debian only)
#   --drivers  what --check needs, and `make check-drivers`
#   --mutants  what --check needs, and `make check-mutants`
#   --packages what a build needs, and `make deb` and `make check-deb` (Debian only)
#   --cockpit  what a build needs, and `make check-cockpit`
#   --ports    what --check needs, and every target of `make check-ports`
#   --dry-run  say what would be installed, touch nothing
#
# Silent and quick where nothing is missing. Never asks when nobody is there to answer. What only
# some checks use may be missing: then one line names it, and the exit status is 0.
set -u

level=1
targets=
dry_run=
while [ $# -gt 0 ]; do
    case $1 in
    --demo) level=1 ;;
    --check) level=2 ;;
    --ci) level=3 ;;
    --drivers) level=2 targets=drivers ;;
    --mutants) level=2 targets=mutants ;;
    --packages) targets=packages ;;
    --cockpit) targets=cockpit ;;
    --ports)
        level=2 targets='arm64 armhf riscv64 s390x musl musl-arm64 win64 macos drivers baremetal'
        ;;
    --cross)
        level=0 targets=${2:-}
        [ $# -lt 2 ] || shift
        ;;
    --dry-run) dry_run=1 ;;
    *)
        sed -n '/^# usage/,/dry-run/s/^# //p' "$0" >&2
        exit 2
        ;;
    esac
    shift
done

say() {
    printf 'setup: %s\n' "$1" >&2
}

die() {
    say "$1"
    exit 1
}

manager=
for candidate in apt-get dnf pacman apk zypper; do
    if command -v $candidate >/dev/null 2>&1; then
        manager=$candidate
        break
    fi
done

have_command() {
    command -v "$1" >/dev/null 2>&1
}

have_cc() {
    [ -n "${CC:-}" ] || have_command gcc
}

have_library() {
    have_command pkg-config && pkg-config --exists "$1"
}

have_c_headers() {
    [ -e /usr/include/stdio.h ]
}

# need WHAT FOR TEST... -- APT DNF PACMAN APK ZYPPER: notes a package when TEST fails.
packages=
reasons=
need() {
    what=$1
    purpose=$2
    shift 2
    check=
    while [ "$1" != -- ]; do
        check="$check $1"
        shift
    done
    shift
    $check && return
    case $manager in
    apt-get) package=$1 ;;
    dnf) package=$2 ;;
    pacman) package=$3 ;;
    apk) package=$4 ;;
    zypper) package=$5 ;;
    *) package=$1 ;;
    esac
    [ -n "$package" ] ||
        die "$what is missing ($purpose), and only Debian's package of it is known"
    case " $packages " in
    *" $package "*) ;;
    *) packages="${packages:+$packages }$package" ;;
    esac
    reasons="${reasons:+$reasons, }$what ($purpose)"
}

need_debian() {
    need "$@" '' '' '' ''
}

have_newlib() {
    have_command arm-none-eabi-gcc &&
        [ "$(arm-none-eabi-gcc -print-file-name=nano.specs)" != nano.specs ]
}

# What a build for another machine needs here; its libraries are tools/cross/libs.sh's business.
look_cross() {
    need make 'to build' have_command make -- make make make make make
    need pkg-config 'to find libraries' have_command pkg-config -- \
        pkg-config pkgconf-pkg-config pkgconf pkgconf pkgconf-pkg-config
    case $1 in
    arm64)
        need_foreign aarch64-linux-gnu qemu-aarch64
        need_debian 'a C++ compiler for arm64' 'to check the headers' \
            have_command aarch64-linux-gnu-g++ -- g++-aarch64-linux-gnu
        ;;
    musl) need_cmake ;;
    macos | freebsd | openbsd)
        need_cmake
        need_debian "Python's venv" 'to install a compiler for macOS and the BSDs' have_venv -- \
            python3-venv
        ;;
    musl-arm64)
        need_cmake
        need_foreign aarch64-linux-gnu qemu-aarch64
        ;;
    armhf) need_foreign arm-linux-gnueabihf qemu-arm ;;
    riscv64) need_foreign riscv64-linux-gnu qemu-riscv64 ;;
    s390x) need_foreign s390x-linux-gnu qemu-s390x ;;
    baremetal)
        need_debian 'a compiler for microcontrollers' 'to build firmware' \
            have_command arm-none-eabi-gcc -- gcc-arm-none-eabi
        need_debian newlib 'to build firmware' have_newlib -- libnewlib-arm-none-eabi
        need_debian qemu-system-arm 'to run firmware' have_command qemu-system-arm -- \
            qemu-system-arm
        ;;
    win64) need_windows x86_64-w64-mingw32 x86-64 ;;
    mutants)
        need Python 'to make mutants' have_command python3 -- \
            python3 python3 python python3 python3
        need objcopy 'to make mutants' have_command objcopy -- \
            binutils binutils binutils binutils binutils
        ;;
    cockpit)
        need_debian chromium "to check the cockpit's page" have_command chromium -- chromium
        need node "to check the page's modules" have_command node -- \
            nodejs nodejs nodejs nodejs nodejs
        need npm "to check that the page is accessible" have_command npm -- npm npm npm npm npm
        need_debian "Python's venv" 'to install Playwright' have_venv -- python3-venv
        ;;
    packages)
        need_debian debhelper 'to build packages' have_command dh -- debhelper
        need_debian dh-python 'to build packages' have_command dh_python3 -- dh-python
        need_debian python3-cffi 'to build packages' [ -e /usr/share/doc/python3-cffi ] -- \
            python3-cffi
        need_debian lintian 'to check packages' have_command lintian -- lintian
        need_debian debootstrap 'to try packages' have_command /usr/sbin/debootstrap -- debootstrap
        need_debian "Ubuntu's keys" 'to try packages' have_ubuntu_keys -- ubuntu-keyring
        ;;
    drivers)
        need qemu-system-x86_64 'to boot a kernel' have_command qemu-system-x86_64 -- \
            qemu-system-x86 qemu-system-x86-core qemu-system-x86 qemu-system-x86_64 qemu-x86
        ;;
    esac
}

need_windows() {
    need_debian "a compiler for $1" 'to build' have_command "$1-gcc" -- "gcc-mingw-w64-$2-win32"
    need_debian "a C++ compiler for $1" 'to check the headers' have_command "$1-g++" -- \
        "g++-mingw-w64-$2-win32"
    need_cmake
    need_debian wine 'to run the tests' have_command wine -- "wine wine64"
}

need_foreign() {
    need_debian "a compiler for $1" 'to build' have_command "$1-gcc" -- "gcc-$1"
    need_debian "$2" 'to run the tests' have_command "$2" -- qemu-user
}

# Not every Debian has a package of them; without them debootstrap cannot verify Ubuntu's.
have_ubuntu_keys() {
    [ -e /usr/share/keyrings/ubuntu-archive-keyring.gpg ] ||
        ! apt-cache policy ubuntu-keyring 2>/dev/null | grep -q 'Candidate: [0-9]'
}

have_venv() {
    python3 -c 'import ensurepip' 2>/dev/null
}

need_cmake() {
    need cmake 'to build libraries' have_command cmake -- cmake cmake cmake cmake cmake
}

look() {
    packages=
    reasons=
    for target in $targets; do
        look_cross "$target"
    done
    [ $level -ge 1 ] || return
    need 'a C compiler' 'to build' have_cc -- gcc gcc gcc gcc gcc
    need "the C library's headers" 'to build' have_c_headers -- \
        libc6-dev glibc-devel glibc musl-dev glibc-devel
    need make 'to build' have_command make -- make make make make make
    need pkg-config 'to find libraries' have_command pkg-config -- \
        pkg-config pkgconf-pkg-config pkgconf pkgconf pkgconf-pkg-config
    need libevent "for the robot's event loop" have_library libevent_core -- \
        libevent-dev libevent-devel libevent libevent-dev libevent-devel
    need libyaml 'to read motion files' have_library yaml-0.1 -- \
        libyaml-dev libyaml-devel libyaml yaml-dev libyaml-devel
    need jansson 'for the JSON of grctl' have_library jansson -- \
        libjansson-dev jansson-devel jansson jansson-dev libjansson-devel
    need libedit 'to edit lines in grctl shell' have_library libedit -- \
        libedit-dev libedit-devel libedit libedit-dev libedit-devel
    need ncurses 'to draw in grctl monitor' have_library ncursesw -- \
        libncurses-dev ncurses-devel ncurses ncurses-dev ncurses-devel
    need libmosquitto 'for grctl agent and grctl fleet' have_library libmosquitto -- \
        libmosquitto-dev mosquitto-devel mosquitto mosquitto-dev libmosquitto-devel
    need expat 'to read URDF in grctl robot import' have_library expat -- \
        libexpat1-dev expat-devel expat expat-dev libexpat-devel
    [ $level -ge 2 ] || return
    need cmocka 'for the tests' have_library cmocka -- \
        libcmocka-dev libcmocka-devel cmocka cmocka-dev libcmocka-devel
    need 'a C++ compiler' 'to check the headers' have_command "${CXX:-g++}" -- \
        g++ gcc-c++ gcc g++ gcc-c++
}

have_fuzzer() {
    echo 'int LLVMFuzzerTestOneInput(const char *p, unsigned long n) { return !p + !n; }' |
        clang -x c -fsanitize=fuzzer -o /dev/null - 2>/dev/null
}

# No package of the system reaches a Python that is not the system's.
have_module() {
    python3 -c "import $1" 2>/dev/null && return
    case $(command -v python3) in
    '' | /usr/bin/*) return 1 ;;
    esac
}

have_python_headers() {
    python3 -c 'import os, sys, sysconfig
sys.exit(not os.path.exists(os.path.join(sysconfig.get_path("include"), "Python.h")))' 2>/dev/null
}

have_mdoc() {
    have_command groff && [ -e /usr/share/groff/current/tmac/doc.tmac ]
}

# What only some checks use.
look_wanted() {
    packages=
    reasons=
    need Python 'to check JSON' have_command python3 -- \
        python3 python3 python python3 python3
    need cffi 'to check the Python package' have_module cffi -- \
        python3-cffi python3-cffi python-cffi py3-cffi python3-cffi
    ! [ -e .git ] || need git 'to check tarballs' have_command git -- git git git git git
    need ps 'to find what tests leave behind' have_command ps -- \
        procps procps-ng procps-ng procps procps
    need openssl 'to check fleets' have_command openssl -- openssl openssl openssl openssl openssl
    need numpy 'to check the Python package' have_module numpy -- \
        python3-numpy python3-numpy python-numpy py3-numpy python3-numpy
    need mypy 'to check its types' have_module mypy -- \
        'mypy python3-mypy' python3-mypy mypy py3-mypy python3-mypy
    need jsonschema 'to check JSON' have_module jsonschema -- \
        python3-jsonschema python3-jsonschema python-jsonschema py3-jsonschema python3-jsonschema
    need cmake 'to check the build files for it' have_command cmake -- \
        cmake cmake cmake cmake cmake
    need meson 'to check the build files for it' have_command meson -- \
        meson meson meson meson meson
    need doxygen 'to check the reference site' have_command doxygen -- \
        doxygen doxygen doxygen doxygen doxygen
    need glib 'to check the guide of loops' have_library glib-2.0 -- \
        libglib2.0-dev glib2-devel glib2 glib-dev glib2-devel
    need valgrind 'to check memory' have_command valgrind -- \
        valgrind valgrind valgrind valgrind valgrind
    need shellcheck 'to check the scripts' have_command shellcheck -- \
        shellcheck ShellCheck shellcheck shellcheck ShellCheck
    need gdb 'to check the guard beside a debugger' have_command gdb -- gdb gdb gdb gdb gdb
    [ "$manager" != apt-get ] ||
        need "Python's headers" 'to check the Python package' have_python_headers -- python3-dev
    need tmux 'to check the shell at a terminal' have_command tmux -- \
        tmux tmux tmux tmux tmux
    need zsh 'to check completion' have_command zsh -- zsh zsh zsh zsh zsh
    need fish 'to check completion' have_command fish -- fish fish fish fish fish
    need rsvg-convert 'to check PNG plots' have_command rsvg-convert -- \
        librsvg2-bin librsvg2-tools librsvg rsvg-convert rsvg-convert
    need tshark 'to check the dissector' have_command tshark -- \
        tshark wireshark-cli wireshark-cli tshark wireshark
    need ser2net 'to check a robot behind a serial server' have_command ser2net -- \
        ser2net ser2net ser2net ser2net ser2net
    need mosquitto 'to check fleets' have_command mosquitto -- \
        'mosquitto mosquitto-clients' mosquitto mosquitto 'mosquitto mosquitto-clients' mosquitto
    need mandoc 'to check the man page' have_command mandoc -- \
        mandoc mandoc mandoc mandoc mandoc
    need groff 'to check the man page' have_mdoc -- groff-base groff groff groff groff
    [ "$manager" != apt-get ] ||
        need 'the source of locales' 'to check numbers where they have commas' \
            [ -e /usr/share/i18n/locales/de_DE ] -- locales
    [ "$manager" != apt-get ] ||
        need clang-format 'to check the formatting' have_command clang-format-14 -- clang-format-14
    [ $level -ge 3 ] || return
    [ "$manager" != apt-get ] ||
        need abidiff 'to compare binary interfaces' have_command abidiff -- abigail-tools
    need 'clang with libFuzzer' 'to fuzz' have_fuzzer -- \
        'clang libclang-rt-dev' 'clang compiler-rt' 'clang compiler-rt' 'clang compiler-rt' clang
}

# install_command PACKAGE...
install_command() {
    case $manager in
    apt-get) echo "apt-get install -y --no-install-recommends $*" ;;
    dnf) echo "dnf install -y $*" ;;
    pacman) echo "pacman -S --noconfirm --needed $*" ;;
    apk) echo "apk add $*" ;;
    zypper) echo "zypper --non-interactive install $*" ;;
    esac
}

# How to become root: nothing, sudo, or sudo that fails rather than asks.
choose_root() {
    if [ "$(id -u)" -eq 0 ]; then
        as_root=
        return
    fi
    have_command sudo || die "missing $reasons; as root: $(install_command "$packages")"
    as_root=sudo
    if ! [ -t 0 ] || ! [ -t 2 ]; then
        as_root='sudo -n'
        $as_root true 2>/dev/null ||
            die "missing $reasons, sudo wants a password; as root: $(install_command "$packages")"
    fi
}

run_quietly() {
    # $as_root and the command are lists of words on purpose.
    # shellcheck disable=SC2086
    $as_root env DEBIAN_FRONTEND=noninteractive "$@" >"$log" 2>&1 </dev/null
}

refresh_lists() {
    case $manager in
    apt-get) run_quietly apt-get -o DPkg::Lock::Timeout=120 update ;;
    pacman) run_quietly pacman -Sy ;;
    apk) run_quietly apk update ;;
    esac
}

# try PACKAGE...: installs them.
try() {
    # shellcheck disable=SC2046
    run_quietly $(install_command "$@")
}

# Notes in $packages what a function misses; returns 1 where there is nothing to do about it.
begin() {
    "$1"
    [ -n "$packages" ] || return 1
    [ -n "$manager" ] || die "missing $reasons, and no known package manager is here"
    [ -n "$dry_run" ] || choose_root
    say "missing $reasons"
    say "$(install_command "$packages")"
    [ -z "$dry_run" ] || return 1
    # A fresh machine has no lists or stale ones. Without a network the packages may be cached.
    [ -n "$refreshed" ] || refresh_lists ||
        say 'the package lists could not be refreshed; trying with those at hand'
    refreshed=1
}

install_needed() {
    begin look || return 0
    # shellcheck disable=SC2086
    try $packages ||
        die "could not install $packages: $(grep -E '^(E:|error|ERROR)' "$log" | head -n 1)"
    look
    [ -z "$packages" ] || die "installed, but still not found: $packages"
}

# All at once is quick; where the system does not know one of them, the others are installed.
install_wanted() {
    begin look_wanted || return 0
    # shellcheck disable=SC2086
    try $packages || for package in $packages; do try "$package"; done
    look_wanted
    [ -z "$packages" ] || say "without $reasons; these checks are skipped"
}

[ -z "${CC:-}" ] || have_command "${CC%% *}" || die "CC=$CC: no such compiler"
refreshed=
log=$(mktemp) || exit 1
trap 'rm -f "$log"' EXIT
install_needed
# Who may not install them runs the other checks.
[ $level -lt 2 ] || (trap - EXIT; install_wanted) || say 'the checks that need them are skipped'
