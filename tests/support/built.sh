# SPDX-License-Identifier: MIT
# For scripts that make something of what is built: tests run side by side, and another PREFIX
# compiles a file again, so each works in a copy.

# copy_build FROM TO [FOLDER...]: the objects of the library and of more folders, and the flags that
# they were compiled with.
copy_build() {
    from=$1
    to=$2
    shift 2
    mkdir -p "$to" && cp -p "$from/.flags" "$to" || return 1
    for folder in src ports "$@"; do
        cp -Rp "$from/$folder" "$to" || return 1
    done
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
