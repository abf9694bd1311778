# SPDX-License-Identifier: MIT
# 64-bit ARM.

TRIPLET := aarch64-linux-gnu
QEMU := qemu-aarch64
include tools/cross/linux.mk
