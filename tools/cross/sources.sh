# SPDX-License-Identifier: MIT
# For tools/cross/libs.sh: libevent, libyaml, jansson and cmocka, built from the distribution's
# source packages, static, for machines that the distribution has no such packages for.

# from_source NAME CMAKE-OPTION...: into $work/root; $toolchain is a list of such options too.
from_source() {
    name=$1
    shift
    rm -rf "$work/src/$name"
    mkdir -p "$work/src/$name"
    # $apt and $toolchain are lists of words.
    # shellcheck disable=SC2086
    (cd "$work/src" && quietly "$work/log" $apt --download-only source "$name") || exit 1
    for archive in "$work/src/$name"_*.orig.tar.[gx]z; do
        quietly "$work/log" tar -xf "$archive" -C "$work/src/$name" --strip-components 1
    done
    quietly "$work/log" cmake -S "$work/src/$name" -B "$work/src/$name/build" $toolchain \
        -DCMAKE_INSTALL_PREFIX="$work/root" -DCMAKE_BUILD_TYPE=Release -DBUILD_SHARED_LIBS=OFF "$@"
    quietly "$work/log" cmake --build "$work/src/$name/build" -j 2
    quietly "$work/log" cmake --install "$work/src/$name/build"
}

# package NAME VERSION CFLAGS LIBS: pkg-config's file. What the four bring says nothing of other
# libraries that a static one needs.
package() {
    printf '%s\n' "prefix=$work/root" "Name: $1" "Description: $1" "Version: $2" \
        "Cflags: -I\${prefix}/include $3" "Libs: -L\${prefix}/lib $4" \
        >"$work/root/lib/pkgconfig/$1.pc"
}

# libraries_from_source WHERE EVENT-LIBS YAML-CFLAGS CMOCKA-CFLAGS: what programs that use them need
# beside the libraries. $apt is for a machine with source packages, and not needed any more.
libraries_from_source() {
    echo "cross: building libevent, libyaml, jansson and cmocka for $1" >&2
    mkdir -p "$work/root/lib/pkgconfig"
    from_source libevent -DEVENT__LIBRARY_TYPE=STATIC -DEVENT__DISABLE_TESTS=ON \
        -DEVENT__DISABLE_SAMPLES=ON -DEVENT__DISABLE_BENCHMARK=ON -DEVENT__DISABLE_REGRESS=ON \
        -DEVENT__DISABLE_OPENSSL=ON -DEVENT__DISABLE_MBEDTLS=ON
    from_source libyaml -DBUILD_TESTING=OFF -DINSTALL_CMAKE_DIR=lib/cmake/yaml
    from_source jansson -DJANSSON_BUILD_DOCS=OFF -DJANSSON_EXAMPLES=OFF -DJANSSON_WITHOUT_TESTS=ON
    from_source cmocka -DWITH_STATIC_LIB=ON -DWITH_EXAMPLES=OFF -DUNIT_TESTING=OFF
    package libevent_core 2.1 '' "-levent_core $2"
    package yaml-0.1 0.2 "$3" -lyaml
    package jansson 2.14 '' -ljansson
    package cmocka 1.1 "$4" -lcmocka-static
    rm -rf "$work/src" "$work/apt"
    echo "$made_of" >"$work/made-of"
}
