# SPDX-License-Identifier: MIT
# Linux with glibc on another processor: the distribution's compiler, its libraries in a sysroot,
# and qemu-user to run the tests. Asks for TRIPLET and QEMU.

SYSROOT := $(abspath $(CROSS_DIR))/root
# What the sysroot has goes before what a cross package may have put on this machine.
IN_SYSROOT := --sysroot=$(SYSROOT) -B$(SYSROOT)/usr/lib/$(TRIPLET) \
    -L$(SYSROOT)/usr/lib/$(TRIPLET) -isystem $(SYSROOT)/usr/include/$(TRIPLET) \
    -isystem $(SYSROOT)/usr/include
CC := $(TRIPLET)-gcc $(IN_SYSROOT)
CXX := $(TRIPLET)-g++ --sysroot=$(SYSROOT)
AR := $(TRIPLET)-ar
PKG_CONFIG := PKG_CONFIG_SYSROOT_DIR=$(SYSROOT) \
    PKG_CONFIG_LIBDIR=$(SYSROOT)/usr/lib/$(TRIPLET)/pkgconfig pkg-config
EMULATOR := $(or $(shell command -v $(QEMU)),$(QEMU)) -L $(SYSROOT)
