# SPDX-License-Identifier: MIT
# Gate: a port is a folder, not an #ifdef. Platform conditionals live in ports/ and export.h only,
# and what only Linux has in files called *_linux.c, where the other systems' answer stands too.

BEGIN {
    platforms = "_WIN32|_WIN64|_MSC_VER|__MINGW|__CYGWIN__|__linux|__APPLE__|__MACH__|__unix|" \
        "__FreeBSD__|__OpenBSD__|__NetBSD__|__ANDROID__|__arm|__aarch64__|__x86_64__|__i386__"
}
BEGIN {
    linux = "epoll_[a-z0-9]+|timerfd_[a-z]+|eventfd|signalfd|inotify_[a-z0-9_]+|prctl|accept4|" \
        "pipe2|dup3|ppoll|gettid|getrandom|memfd_create|sendfile|splice|mremap|execvpe|" \
        "pthread_setname_np|SOCK_CLOEXEC|SOCK_NONBLOCK|MSG_MORE|O_PATH|O_TMPFILE|TCGETS2|" \
        "TCSETS2|BOTHER|TIOC[GS]SERIAL|TIOC[GS]EXCL|CLOCK_MONOTONIC_RAW|CLOCK_BOOTTIME"
    headers = "linux/|asm/|sys/(epoll|timerfd|eventfd|signalfd|inotify|prctl|sysmacros|syscall)"
    linux = "(^|[^A-Za-z0-9_])(" linux ")([^A-Za-z0-9_]|$)"
    headers = "^ *# *include *<(" headers ")"
}
FILENAME ~ /^(src|ports|tools)\// && FILENAME !~ /_linux\.c$/ && FILENAME !~ /win32/ &&
(code ~ linux || code ~ headers || code ~ /__linux/) {
    complain("platform: only Linux has this; it belongs to a file called *_linux.c")
}
FILENAME ~ /^tools\/grctl\// && code ~ /(^|[^A-Za-z0-9_])(near|far)([^A-Za-z0-9_]|$)/ {
    complain("platform: near and far are macros in the headers of Windows")
}
FILENAME ~ /^ports\// || FILENAME == "include/grobo/export.h" { next }

code ~ /^ *# *(if|ifdef|ifndef|elif)([^a-z]|$)/ &&
code ~ platforms {
    complain("platform: conditional outside ports/ and include/grobo/export.h")
}
