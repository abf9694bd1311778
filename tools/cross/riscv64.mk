# SPDX-License-Identifier: MIT
# 64-bit RISC-V.

TRIPLET := riscv64-linux-gnu
QEMU := qemu-riscv64
include tools/cross/linux.mk
