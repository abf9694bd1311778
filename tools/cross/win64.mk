# SPDX-License-Identifier: MIT
# 64-bit Windows: mingw-w64 with the threads of Windows, and wine to run the tests. Programs bring
# the libraries with them (static), grobo.dll too.

TRIPLET := x86_64-w64-mingw32
PORT := win32
EXE := .exe
CC := $(TRIPLET)-gcc
CXX := $(TRIPLET)-g++
AR := $(TRIPLET)-ar
PKG_CONFIG := PKG_CONFIG_LIBDIR=$(abspath $(CROSS_DIR))/root/lib/pkgconfig pkg-config
# The C library of Windows prints no %zu and %lld; that of mingw does, and its headers choose it.
# Its isfinite() is a macro that converts to float what is none, the compiler checks formats against
# the other C library, and a SOCKET is unsigned where libevent's type of one is not.
OS_FLAGS := -D__USE_MINGW_ANSI_STDIO=1 -DWIN32_LEAN_AND_MEAN
TARGET_CFLAGS := -Wno-float-conversion -Wno-format -Wno-sign-conversion
OS_LIBS := -lws2_32 -lsetupapi -lwinmm -lm
LDFLAGS := -static
SONAME := grobo.dll
IMPORT_LIB := libgrobo.dll.a
SHARED_FLAGS = -Wl,--out-implib,$(BUILD)/$(IMPORT_LIB)
EMULATOR := $(abspath tools/cross/wine.sh)
export GROBO_WINE := $(abspath $(CROSS_DIR))
RING := unit engine link port fault cli export wine

# What the tests need of this machine: a cable between two COM ports for each test program, and the
# simulator behind a pseudo-terminal, which wine takes for a COM port.
NATIVE_GRCTL := $(BUILD)/native/grctl
CROSS_TOOLS := $(BUILD)/nullmodem $(NATIVE_GRCTL)
TEST_EMULATOR := $(BUILD)/nullmodem $(GROBO_WINE)/prefix/dosdevices $(EMULATOR)
export NATIVE_GRCTL := $(abspath $(NATIVE_GRCTL))
$(BUILD)/nullmodem: tools/cross/nullmodem.c
	@mkdir -p $(@D)
	cc -std=c11 -O2 -Wall -Wextra -D_DEFAULT_SOURCE -D_XOPEN_SOURCE=700 -o $@ $<
$(BUILD)/native/grctl: FORCE
	@env -u NATIVE_GRCTL $(MAKE) --no-print-directory CROSS= BUILD=$(BUILD)/native $@
TEST_BEGIN = $(EMULATOR) --begin; LEFT_OUT=tests/wine/left_out
TEST_END = ; status=$$?; $(EMULATOR) --end; exit $$status

# Written for a pseudo-terminal or for processes and files as POSIX has them.
LEFT_OUT_WHY := Windows has no pseudo-terminals, signals, file modes or links as it wants them
LEFT_OUT := $(addprefix tests/,unit/test_motion_links.c fault/test_serial_io.c export/examples.sh export/install.sh \
    $(filter-out $(patsubst %,cli/%.sh,check completion config convert decode help json plot servos show),\
    $(patsubst tests/%,%,$(wildcard tests/cli/*.sh))) \
    $(patsubst %,link/test_%.c,play_line serial_async serial_open serial_sync serial_tcp session \
    sim_server thread_line reconnect) $(patsubst %,support/%.c,line spy far_robot))
