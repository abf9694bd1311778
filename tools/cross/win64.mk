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

# What grctl.exe says of itself to Windows.
MANIFEST := $(BUILD)/tools/grctl/os/win32/manifest.o
$(MANIFEST): tools/grctl/os/win32/manifest.rc tools/grctl/os/win32/grctl.manifest
	@mkdir -p $(@D)
	$(say) RC $@
	$(Q)$(TRIPLET)-windres -I $(<D) -o $@ $<
$(BUILD)/grctl$(EXE): $(MANIFEST)

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
TEST_BEGIN = $(EMULATOR) --begin; LEFT_OUT=$(abspath tests/wine/left_out)
TEST_END = ; status=$$?; $(EMULATOR) --end; exit $$status

# Tests are written for a pseudo-terminal, and for processes and files as POSIX has them; these are
# not: of the ring link, and of the command's (what they cannot check is in tests/wine/left_out).
PORTABLE := $(patsubst %,tests/link/test_%.c,runner_life loop session_joints runner runner_motion \
    runner_leave runner_race runner_stop) $(patsubst %,tests/cli/%.sh,check completion config \
    convert decode doctor estop guide help input json leaving play play_keys plot readme record replay robot ser2net servos \
    shell show sim sim_console stranger teach trace wireshark)
LEFT_OUT_WHY := Windows has no pseudo-terminals, signals, file modes or links as it wants them
LEFT_OUT := $(filter-out $(PORTABLE),$(wildcard tests/link/test_*.c tests/cli/*.sh)) \
    $(addprefix tests/,unit/test_motion_links.c fault/test_serial_io.c export/examples.sh \
    export/install.sh support/line.c support/spy.c support/far_robot.c support/guarded.c \
    support/nobody.c support/leash.c support/classic_kit.c support/frame_words.c)
