# SPDX-License-Identifier: MIT
# macOS on 64-bit ARM.

SONAME := libgrobo.1.dylib
LINK_NAME := libgrobo.dylib
SHARED_FLAGS := -install_name @rpath/$(SONAME)
OWN_CALLS :=
include tools/cross/zig.mk
