# SPDX-License-Identifier: MIT
# For tools/cross/libs.sh: libraries for Windows. The distribution has the compiler but no library
# for it, so they are built, static, from its own source packages.

# windows_libraries TRIPLET
windows_libraries() {
    triplet=$1
    mkdir -p "$work"
    made_of="$triplet $codename libevent libyaml jansson cmocka static"
    quietly "$work/log" env GROBO_WINE="$work" tools/cross/wine.sh --make
    is_made && return
    rm -rf "$work/root" "$work/src"
    private_apt "$work/apt" amd64 "$codename"
    # $apt is a list of words.
    # shellcheck disable=SC2086
    quietly "$work/log" $apt update
    toolchain="-DCMAKE_SYSTEM_NAME=Windows -DCMAKE_C_COMPILER=$triplet-gcc"
    toolchain="$toolchain -DCMAKE_RC_COMPILER=$triplet-windres"
    toolchain="$toolchain -DCMAKE_FIND_ROOT_PATH=/usr/$triplet"
    libraries_from_source Windows '-lws2_32 -liphlpapi -lbcrypt -ladvapi32' \
        -DYAML_DECLARE_STATIC -DCMOCKA_STATIC
}
