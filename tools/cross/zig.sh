# SPDX-License-Identifier: MIT
# For tools/cross/libs.sh: macOS and the BSDs. The distribution has no compiler for them. The wheel
# ziglang has one (clang), with the headers of those systems and what is needed to link for them.

# zig: $zig is that compiler, in build/cross/zig.
zig() {
    home=$top/build/cross/zig
    if [ ! -e "$home/made" ]; then
        echo 'cross: installing ziglang' >&2
        rm -rf "$home"
        mkdir -p "$home"
        quietly "$home/log" python3 -m venv "$home"
        quietly "$home/log" "$home/bin/pip" install --no-input ziglang
        : >"$home/made"
    fi
    zig=$(zig_program) || die 'no zig in the wheel ziglang'
}

zig_program() {
    "$home/bin/python" -c '
import os, ziglang
print(os.path.join(os.path.dirname(ziglang.__file__), "zig"))'
}

# zig_libraries TARGET SYSTEM: for a target of zig, and its system as cmake names it.
zig_libraries() {
    made_of="zig $1 $codename libevent libyaml jansson cmocka"
    zig
    is_made && return
    rm -rf "$work"
    mkdir -p "$work/bin"
    for tool in cc ar ranlib; do
        options=
        [ $tool = cc ] && options="-target $1"
        printf '#!/bin/sh\nZIG_GLOBAL_CACHE_DIR=%s exec %s %s %s "$@"\n' "$home/cache" "$zig" \
            $tool "$options" >"$work/bin/$tool"
        chmod +x "$work/bin/$tool"
    done
    private_apt "$work/apt" amd64 "$codename"
    # $apt is a list of words.
    # shellcheck disable=SC2086
    quietly "$work/log" $apt update
    toolchain="-DCMAKE_SYSTEM_NAME=$2 -DCMAKE_C_COMPILER=$work/bin/cc -DCMAKE_AR=$work/bin/ar"
    toolchain="$toolchain -DCMAKE_RANLIB=$work/bin/ranlib"
    toolchain="$toolchain -DCMAKE_FIND_ROOT_PATH=$work/root -DCMAKE_POSITION_INDEPENDENT_CODE=ON"
    libraries_from_source "$1" '' '' ''
}
