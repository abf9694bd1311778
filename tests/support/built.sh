# SPDX-License-Identifier: MIT
# For scripts that make something of what is built: tests run side by side, and another PREFIX
# compiles a file again, so each works in a copy.

# copy_build FROM TO: the objects, and the flags that they were compiled with.
copy_build() {
    mkdir -p "$2" && cp -Rp "$1/src" "$1/ports" "$2" && cp -p "$1/.flags" "$2"
}

# make_in_copy DIR TARGET...: with the compiler and the flags of the copy, whatever the make above
# was told.
make_in_copy() {
    copy=$1
    shift
    flags=$(sed -n 's/^\([A-Z]*\) = ..*/\1/p' "$copy/.flags")
    (
        unset MAKEFLAGS MAKELEVEL MFLAGS
        for variable in $flags; do
            unset "$variable"
            set -- "$@" "$variable=$(sed -n "s/^$variable = //p" "$copy/.flags")"
        done
        make --no-print-directory "$@" BUILD="$copy"
    )
}
