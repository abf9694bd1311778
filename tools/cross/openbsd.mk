# SPDX-License-Identifier: MIT
# OpenBSD on x86-64.

include tools/cross/zig.mk
