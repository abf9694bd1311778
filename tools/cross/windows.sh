# SPDX-License-Identifier: MIT
# For tools/cross/libs.sh: libraries for Windows. The distribution has the compiler but no library
# for it, so they are built, static, from its own source packages.

# from_source NAME CMAKE-OPTION...: into $work/root.
from_source() {
    name=$1
    shift
    rm -rf "$work/src/$name"
    mkdir -p "$work/src/$name"
    # $apt is a list of words.
    # shellcheck disable=SC2086
    (cd "$work/src" && quietly "$work/log" $apt --download-only source "$name") || exit 1
    for archive in "$work/src/$name"_*.orig.tar.[gx]z; do
        quietly "$work/log" tar -xf "$archive" -C "$work/src/$name" --strip-components 1
    done
    quietly "$work/log" cmake -S "$work/src/$name" -B "$work/src/$name/build" \
        -DCMAKE_SYSTEM_NAME=Windows -DCMAKE_C_COMPILER="$triplet-gcc" \
        -DCMAKE_RC_COMPILER="$triplet-windres" -DCMAKE_FIND_ROOT_PATH="/usr/$triplet" \
        -DCMAKE_INSTALL_PREFIX="$work/root" -DCMAKE_BUILD_TYPE=Release \
        -DBUILD_SHARED_LIBS=OFF "$@"
    quietly "$work/log" cmake --build "$work/src/$name/build" -j 2
    quietly "$work/log" cmake --install "$work/src/$name/build"
}

# The files of pkg-config are written here: what the four bring says nothing of Windows.
package() {
    printf '%s\n' "prefix=$work/root" "Name: $1" "Description: $1 for Windows" "Version: $2" \
        'Cflags: -I${prefix}/include' "Libs: -L\${prefix}/lib $3" >"$work/root/lib/pkgconfig/$1.pc"
}

# windows_libraries TRIPLET
windows_libraries() {
    triplet=$1
    mkdir -p "$work"
    made_of="$triplet $codename libevent libyaml jansson cmocka static"
    quietly "$work/log" env GROBO_WINE="$work" tools/cross/wine.sh --make
    [ "$(cat "$work/made-of" 2>/dev/null)" = "$made_of" ] && return
    echo "cross: building libevent, libyaml, jansson and cmocka for $triplet" >&2
    rm -rf "$work/root" "$work/src"
    mkdir -p "$work/root/lib/pkgconfig"
    private_apt "$work/apt" amd64 "$codename"
    # shellcheck disable=SC2086
    quietly "$work/log" $apt update
    from_source libevent -DEVENT__LIBRARY_TYPE=STATIC -DEVENT__DISABLE_TESTS=ON \
        -DEVENT__DISABLE_SAMPLES=ON -DEVENT__DISABLE_BENCHMARK=ON -DEVENT__DISABLE_REGRESS=ON \
        -DEVENT__DISABLE_OPENSSL=ON -DEVENT__DISABLE_MBEDTLS=ON
    from_source libyaml -DBUILD_TESTING=OFF -DINSTALL_CMAKE_DIR=lib/cmake/yaml
    from_source jansson -DJANSSON_BUILD_DOCS=OFF -DJANSSON_EXAMPLES=OFF -DJANSSON_WITHOUT_TESTS=ON
    from_source cmocka -DWITH_STATIC_LIB=ON -DWITH_EXAMPLES=OFF -DUNIT_TESTING=OFF
    package libevent_core 2.1 '-levent_core -lws2_32 -liphlpapi -lbcrypt -ladvapi32'
    package yaml-0.1 0.2 -lyaml
    sed -i '/^Cflags:/s/$/ -DYAML_DECLARE_STATIC/' "$work/root/lib/pkgconfig/yaml-0.1.pc"
    package jansson 2.14 -ljansson
    package cmocka 1.1 -lcmocka-static
    sed -i '/^Cflags:/s/$/ -DCMOCKA_STATIC/' "$work/root/lib/pkgconfig/cmocka.pc"
    rm -rf "$work/src" "$work/apt"
    echo "$made_of" >"$work/made-of"
}
