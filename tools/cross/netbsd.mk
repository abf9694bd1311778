# SPDX-License-Identifier: MIT
# NetBSD on x86-64.

include tools/cross/zig.mk
