# SPDX-License-Identifier: MIT
# IBM Z: here as the big-endian machine.

TRIPLET := s390x-linux-gnu
QEMU := qemu-s390x
include tools/cross/linux.mk
