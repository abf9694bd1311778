# SPDX-License-Identifier: MIT
# For tools/cross/libs.sh: musl as the C library, for programs that are one file. The distribution
# has it and the kernel's headers, but no library built with it.

# musl_libraries ARCHITECTURE COMPILER: $work/bin/cc compiles and links with musl.
musl_libraries() {
    made_of="$1 $2 $codename libevent libyaml jansson cmocka"
    is_made && return
    rm -rf "$work"
    mkdir -p "$work/root" "$work/bin"
    private_apt "$work/apt" "$1" "$codename"
    # $apt is a list of words.
    # shellcheck disable=SC2086
    {
        quietly "$work/log" $apt update
        (cd "$work" && quietly "$work/log" $apt download musl-dev linux-libc-dev) || exit 1
    }
    for package in "$work"/*.deb; do
        quietly "$work/log" dpkg -x "$package" "$work/root"
    done
    rm "$work"/*.deb
    # The compiler's specs of the distribution, with our root, and the kernel's headers behind.
    specs=$(echo "$work"/root/usr/lib/*-linux-musl/musl-gcc.specs)
    include=$work/root/usr/include
    kernel="-idirafter $include -idirafter $(dirname "$include"/*-linux-gnu*/asm)"
    sed -e "s,/usr/\(lib\|include\)/,$work/root&,g" -e "s,include%s,& $kernel," "$specs" \
        >"$work/musl.specs"
    printf '#!/bin/sh\nexec %s -specs %s "$@"\n' "$2" "$work/musl.specs" >"$work/bin/cc"
    chmod +x "$work/bin/cc"
    toolchain="-DCMAKE_C_COMPILER=$work/bin/cc -DCMAKE_SYSTEM_NAME=Linux"
    toolchain="$toolchain -DCMAKE_EXE_LINKER_FLAGS=-static -DCMAKE_FIND_ROOT_PATH=$work/root"
    # cmocka.h guesses uintptr_t, and wrong, where the C library is not glibc.
    toolchain="$toolchain -DCMAKE_C_FLAGS=-D_UINTPTR_T"
    libraries_from_source "musl on $1" '' '' -D_UINTPTR_T
}
