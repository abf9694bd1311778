# SPDX-License-Identifier: MIT
# 64-bit ARM.

TOOLS := aarch64-linux-gnu-
EMULATOR := $(or $(shell command -v qemu-aarch64),qemu-aarch64)
include tools/cross/static.mk
