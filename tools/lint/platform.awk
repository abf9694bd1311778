# SPDX-License-Identifier: MIT
# Gate: a port is a folder, not an #ifdef. Platform conditionals live in ports/ and export.h only.

BEGIN {
    platforms = "_WIN32|_WIN64|_MSC_VER|__MINGW|__CYGWIN__|__linux|__APPLE__|__MACH__|__unix|" \
        "__FreeBSD__|__OpenBSD__|__NetBSD__|__ANDROID__|__arm|__aarch64__|__x86_64__|__i386__"
}
FILENAME ~ /^ports\// || FILENAME == "include/grobo/export.h" { next }

code ~ /^ *# *(if|ifdef|ifndef|elif)([^a-z]|$)/ &&
code ~ platforms {
    complain("platform: conditional outside ports/ and include/grobo/export.h")
}
