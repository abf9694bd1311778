# SPDX-License-Identifier: MIT
# A system without an emulator here: everything is compiled and linked, the tests too, and nothing
# is run.

CC := $(abspath $(CROSS_DIR))/bin/cc
AR := $(abspath $(CROSS_DIR))/bin/ar
PKG_CONFIG := PKG_CONFIG_LIBDIR=$(abspath $(CROSS_DIR))/root/lib/pkgconfig pkg-config
# These show all of their functions where POSIX is not asked for.
OS_FLAGS := -pthread
# A younger clang than the gates know: an enum as a number, and cmocka's macros, are well meant.
TARGET_CFLAGS := -Wno-enum-float-conversion -Wno-enum-compare-conditional \
    -Wno-string-concatenation -Wno-gnu-zero-variadic-macro-arguments
SHARED_FLAGS ?= -Wl,-soname,$(SONAME)
GRCTL_HERE :=
RING :=
ALSO = $(TEST_PROGRAMS) $(EXAMPLES)
