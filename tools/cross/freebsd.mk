# SPDX-License-Identifier: MIT
# FreeBSD on x86-64.

include tools/cross/zig.mk
