# SPDX-License-Identifier: MIT
# 32-bit ARM with floating point.

TRIPLET := arm-linux-gnueabihf
QEMU := qemu-arm
include tools/cross/linux.mk
