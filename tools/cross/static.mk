# SPDX-License-Identifier: MIT
# grctl as one file: Linux with musl, everything static. Asks for TOOLS, the prefix of binutils.

CC := $(abspath $(CROSS_DIR))/bin/cc
AR := $(TOOLS)ar
PKG_CONFIG := PKG_CONFIG_LIBDIR=$(abspath $(CROSS_DIR))/root/lib/pkgconfig pkg-config
# The number of an ioctl is an int here, and the kernel's headers say unsigned long.
TARGET_CFLAGS := -Wno-overflow -Wno-sign-conversion
LDFLAGS := -static
SONAME :=
RING := unit engine link fault port cli fuzz
ALSO := one-file

one-file: $(BUILD)/grctl
	@mkdir -p $(BUILD)/bin
	@$(TOOLS)strip -o $(BUILD)/bin/grctl $<
	@! $(TOOLS)readelf -l $(BUILD)/bin/grctl | grep INTERP || { echo '$<: not static' >&2; exit 1; }
	@echo "$(BUILD)/bin/grctl: one file, $$(wc -c <$(BUILD)/bin/grctl) bytes"
