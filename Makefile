# SPDX-License-Identifier: MIT
# The only build file. `make help` lists the targets; it reads the ## comments below.

.DEFAULT_GOAL := all
.DELETE_ON_ERROR:
.SUFFIXES:

# ---- what a caller may set -----------------------------------------------------------------

# CROSS=arm64 takes the tools, libraries and emulator of tools/cross/arm64.mk; `make cross` and
# `make check-cross` set it after they brought what that needs.
CROSS ?=
CROSS_DIR ?= build/cross/$(CROSS)
$(if $(CROSS),$(eval include tools/cross/$(CROSS).mk))

BUILD ?= build
# make splits names at blanks: a folder whose name has some is used by another name, a link.
ifneq ($(word 2,$(BUILD)),)
SPACED := $(BUILD)
override BUILD := build/.link-$(shell printf %s "$(SPACED)" | cksum | tr -cd 0-9)
ifneq ($(shell mkdir -p build "$(SPACED)" && ln -sfn "$$(cd "$(SPACED)" && pwd)" $(BUILD) && echo yes),yes)
$(error no folder can be made at "$(SPACED)")
endif
endif

# What is not given to `make install` is as it was given to the build before.
REMEMBERED := CC AR CPPFLAGS CFLAGS LDFLAGS SAN WERROR
last = $(shell sed -n 's/^$(1) = //p' $(BUILD)/.flags)
remember = $(if $(filter default undefined,$(origin $(1))),$(eval $(1) := $$(call last,$(1))))
ifneq ($(and $(filter install install-lib,$(MAKECMDGOALS)),$(wildcard $(BUILD)/.flags)),)
$(foreach v,$(REMEMBERED),$(call remember,$(v)))
endif

PREFIX ?= /usr/local
LIBDIR ?= $(PREFIX)/lib
INCLUDEDIR ?= $(PREFIX)/include
BINDIR ?= $(PREFIX)/bin
DATADIR ?= $(PREFIX)/share
DESTDIR ?=
CROSS_COMPILE ?=
SAN ?=
PORT ?= posix
EXE ?=
ALSO ?=
EMULATOR ?=
RING ?= unit engine link fault port cli fuzz lint export
CFLAGS ?= -O2 -g
PKG_CONFIG ?= $(CROSS_COMPILE)pkg-config
FUZZ_CC ?= clang
TIDY ?= clang-tidy-14
FUZZ_S ?= 60
# Who builds this may have compilers and libraries that are not known yet: a warning is an error in
# .ci/run alone, which sets WERROR=-Werror.
WERROR ?=
SONAME ?= libgrobo.so.1
LINK_NAME ?= libgrobo.so
# zig knows the one for all symbols alone, which is the same: no data is exported.
SYMBOLIC ?= -Wl,-Bsymbolic-functions
SHARED_FLAGS ?= -Wl,-soname,$(SONAME) -Wl,--version-script=src/libgrobo.map $(SYMBOLIC) $(if $(SAN),,-Wl,-z,defs)
OS_FLAGS ?= -D_DEFAULT_SOURCE -D_XOPEN_SOURCE=700 -D_FILE_OFFSET_BITS=64 -pthread
OS_LIBS ?= -lm -pthread
ifeq ($(origin CC),default)
CC := $(CROSS_COMPILE)gcc
endif
ifeq ($(origin AR),default)
AR := $(CROSS_COMPILE)ar
endif
Q := $(if $(filter 1,$(V)),,@)
# A file by its whole name; abspath would split the name of this folder at blanks.
whole = $(if $(filter /%,$(1)),$(1),$(CURDIR)/$(1))
say = $(if $(filter 1,$(V)),@:,@printf '  %-5s %s\n')

# ---- flags ---------------------------------------------------------------------------------

WARNINGS := -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wshadow \
    -Wstrict-prototypes -Wmissing-prototypes -Wswitch-enum -Wvla $(WERROR)
SAN_FLAGS := $(if $(SAN),-fsanitize=$(SAN) -fno-sanitize-recover=all -fno-omit-frame-pointer)
# All slots, joints and queues are walked through to assert (src/base/assert.h): WALKS=-DGROBO_WALKS.
WALKS ?=
# Behind CFLAGS, of the library alone.
SRC_CFLAGS ?=
ALL_CPPFLAGS = -Iinclude -Iports/$(PORT)/include $(WALKS) $(CPPFLAGS)
# Calls within the library are its own, though all functions of the headers are exported.
OWN_CALLS ?= -fno-semantic-interposition
ALL_CFLAGS = -std=c11 $(WARNINGS) $(TARGET_CFLAGS) -fvisibility=hidden -fPIC $(OWN_CALLS) $(SAN_FLAGS) $(CFLAGS) $(COV_FLAGS)
# Without a number of jobs gcc warns at each link.
LTO_FLAGS = $(if $(filter -flto,$(CFLAGS)),-flto=auto)
ALL_LDFLAGS = $(SAN_FLAGS) $(if $(COVERAGE),--coverage $(COUNTED)) $(LTO_FLAGS) $(LDFLAGS)

# pkg-config is asked when a recipe needs the answer, and then once: set-up may install a library
# after make began.
once = $(eval $(1) := $(2))$($(1))
flags = $(if $(shell $(PKG_CONFIG) --exists $(2) && echo yes),$(shell $(PKG_CONFIG) $(1) $(2)),$(error \
    not all of "$(2)" is here; tools/setup.sh installs what is missing))
YAML_CFLAGS = $(call once,YAML_CFLAGS,$(call flags,--cflags,yaml-0.1))
EVENT_CFLAGS = $(call once,EVENT_CFLAGS,$(call flags,--cflags,libevent_core))
# What its macros lack is no fault of ours, also where its header is not one of the system's.
CMOCKA_CFLAGS = $(call once,CMOCKA_CFLAGS,$(patsubst -I%,-isystem%,$(call flags,--cflags,cmocka)))
CMOCKA_LIBS = $(call once,CMOCKA_LIBS,$(call flags,--libs,cmocka))
JSON_CFLAGS = $(call once,JSON_CFLAGS,$(call flags,--cflags,jansson))
JSON_LIBS = $(call once,JSON_LIBS,$(call flags,--libs,jansson))
TOOL_LIBS = $(call once,TOOL_LIBS,$(BASE_LIBS) $(WEB_LIBS) $(MQTT_LIBS))
# Of grctl itself; the programs beside it have the others.
BASE_LIBS = $(call once,BASE_LIBS,$(JSON_LIBS) $(XML_LIBS) $(EDIT_LIBS) $(SCREEN_LIBS))
# The shell edits lines where libedit is there, else it reads them plainly.
EDIT := $(if $(shell $(PKG_CONFIG) --exists libedit 2>/dev/null && echo yes),libedit,plain)
EDIT_CFLAGS = $(if $(filter libedit,$(EDIT)),$(call once,EDIT_CFLAGS_FOUND,$(call flags,--cflags,libedit)))
EDIT_LIBS = $(if $(filter libedit,$(EDIT)),$(call flags,--libs,libedit))
# The monitor draws with ncurses where it is there, else it is a table that is printed again.
SCREEN := $(if $(shell $(PKG_CONFIG) --exists ncursesw 2>/dev/null && echo yes),ncurses,none)
SCREEN_CFLAGS = $(if $(filter ncurses,$(SCREEN)),$(call once,SCREEN_CFLAGS_FOUND,$(filter -I%,$(call flags,--cflags,ncursesw))))
# Fleets speak MQTT by libmosquitto where it is there.
MQTT := $(if $(shell $(PKG_CONFIG) --exists libmosquitto 2>/dev/null && echo yes),mosquitto,none)
MQTT_LIBS = $(if $(filter mosquitto,$(MQTT)),$(call flags,--libs,libmosquitto))
SCREEN_LIBS = $(if $(filter ncurses,$(SCREEN)),$(call flags,--libs,ncursesw))
# URDF is read by expat where it is there, else not at all.
XML := $(if $(shell $(PKG_CONFIG) --exists expat 2>/dev/null && echo yes),expat,none)
XML_CFLAGS = $(if $(filter expat,$(XML)),$(call once,XML_CFLAGS_FOUND,$(call flags,--cflags,expat)))
XML_LIBS = $(if $(filter expat,$(XML)),$(call flags,--libs,expat))
# The cockpit is served by evhttp where it is there, else a line says that it is not.
WEB := $(if $(shell $(PKG_CONFIG) --exists libevent_extra 2>/dev/null && echo yes),evhttp,none)
WEB_LIBS = $(if $(filter evhttp,$(WEB)),$(call flags,--libs,libevent_extra))
LIBS = $(call once,LIBS,$(call flags,--libs,yaml-0.1 libevent_core) $(OS_LIBS))

# ---- sources, by folder: a folder may be empty or missing ----------------------------------

# The core needs no C library but memcpy() and its like, and mathematics.
CORE_FOLDERS := base model play bus servo servo/* robot robots sim sim/servo
HEAP := src/base/memory.c
# What frames say, for those who read along: firmware has none of it.
WORDS := src/servo/words/%.c $(wildcard src/servo/*/words.c src/servo/*/words_*.c)
CORE_SRCS := $(filter-out $(HEAP) $(WORDS),$(sort $(wildcard $(CORE_FOLDERS:%=src/%/*.c))))
OTHER_SRCS := $(sort $(HEAP) $(filter-out src/servo/words/%,$(WORDS)) $(wildcard src/servo/words/*.c) $(wildcard src/team/*.c src/sim/physics/*.c) $(wildcard src/motion/*/*.c src/robots/file/*.c src/body/*.c src/link/*/*.c ports/common/*.c \
    ports/$(PORT)/*.c))
CHOSEN := $(patsubst %,tools/grctl/%.c,term/libedit term/plain term/ncurses term/no_screen robot/expat robot/no_xml \
    fleet/mosquitto fleet/no_mqtt) tools/grctl/web/%
TOOL_SRCS := $(if $(wildcard tools/grctl/main.c),$(sort $(filter-out $(CHOSEN),\
    $(wildcard tools/grctl/*.c tools/grctl/*/*.c tools/grctl/os/$(PORT)/*.c)) tools/grctl/term/$(EDIT).c \
    tools/grctl/term/$(SCREEN:none=no_screen).c tools/grctl/robot/$(XML:none=no_xml).c \
    tools/grctl/fleet/$(MQTT:none=no_mqtt).c \
    $(if $(filter none,$(WEB)),tools/grctl/web/none.c tools/grctl/web/run.c,\
    $(filter-out tools/grctl/web/none.c,$(wildcard tools/grctl/web/*.c)))))
# LEFT_OUT, of a target: tests that its system cannot run, and what only they use. WITHOUT: tests that
# a caller has no use for.
WITHOUT ?=
LEFT_OUT := $(LEFT_OUT) $(WITHOUT)
LEFT_OUT_WHY := $(or $(LEFT_OUT_WHY),it repeats other tests)
SUPPORT_SRCS := $(sort $(filter-out %/replay_main.c %/counted.c $(LEFT_OUT),$(wildcard tests/support/*.c)) \
    tests/support/os/$(PORT).c)
# Tests of one port's own are named after it.
OTHER_PORTS := $(filter-out tests/port/test_$(PORT)_%,$(foreach p,posix win32,$(wildcard tests/port/test_$(p)_*.c)))
# What needs evhttp.
WEB_TESTS := tests/fuzz/fuzz_serve.c $(wildcard tests/unit/test_web_*.c)
TEST_SRCS := $(sort $(filter-out $(LEFT_OUT) $(OTHER_PORTS) $(if $(filter none,$(WEB)),$(WEB_TESTS)),\
    $(foreach ring,unit engine link fault port,$(wildcard tests/$(ring)/test_*.c))))
# Built wherever they can be, run by check-drivers.
DRIVER_SRCS := $(if $(filter posixLinux,$(PORT)$(shell uname)),$(sort $(wildcard tests/drivers/test_*.c)))
TEST_SCRIPTS := $(sort $(filter-out $(LEFT_OUT),\
    $(foreach ring,cli lint export wine,$(wildcard tests/$(ring)/*.sh))))
FUZZ_SRCS := $(sort $(filter-out $(if $(filter none,$(WEB)),$(WEB_TESTS)),$(wildcard tests/fuzz/fuzz_*.c)))
BENCH_SRCS := $(sort $(wildcard tests/bench/bench_*.c))
EXAMPLE_SRCS := $(sort $(wildcard docs/examples/*.c docs/examples/classic/*.c))

objects = $(patsubst %.c,$(BUILD)/%.o,$(1))
CORE_OBJS := $(call objects,$(CORE_SRCS))
LIB_OBJS := $(CORE_OBJS) $(call objects,$(OTHER_SRCS))
PAGE_OBJ := $(if $(filter evhttp,$(WEB)),$(BUILD)/tools/grctl/web/page_files.o)
TOOL_OBJS := $(call objects,$(TOOL_SRCS)) $(if $(TOOL_SRCS),$(PAGE_OBJ))
# The command's texts in other languages: a catalogue becomes a table.
CATALOGUES := $(if $(TOOL_SRCS),$(wildcard tools/grctl/lang/*.po))
TOOL_OBJS += $(CATALOGUES:%.po=$(BUILD)/%.o)
TOOL_LIB := $(BUILD)/libgrctl.a
SUPPORT_OBJS := $(call objects,$(SUPPORT_SRCS))
TEST_PROGRAMS := $(patsubst %.c,$(BUILD)/%$(EXE),$(TEST_SRCS))
DRIVER_PROGRAMS := $(patsubst %.c,$(BUILD)/%$(EXE),$(DRIVER_SRCS)) $(filter \
    %/test_conformance$(EXE) %/test_serial_open$(EXE) %/test_serial_sync$(EXE) \
    %/test_serial_async$(EXE),$(TEST_PROGRAMS))
FUZZ_REPLAYS := $(patsubst %.c,$(BUILD)/%$(EXE),$(FUZZ_SRCS))
FUZZERS := $(patsubst %.c,$(BUILD)/%.fuzzer,$(FUZZ_SRCS))
BENCHES := $(patsubst %.c,$(BUILD)/%$(EXE),$(BENCH_SRCS))
PLANT_PIPE := $(BUILD)/tests/physics/plant_pipe$(EXE)
WEIGHT_TABLE := $(BUILD)/tests/engine/test_sim_weight_table$(EXE)
EXAMPLES := $(patsubst %.c,$(BUILD)/%$(EXE),$(EXAMPLE_SRCS))

STATIC_LIB := $(BUILD)/libgrobo.a
CORE_LIB := $(BUILD)/libgrobo-core.a
# The classes of the reference document, a program for the library; on Windows static alone.
CLASSIC_SRCS := $(sort $(wildcard src/classic/*.c))
CLASSIC_OBJS := $(call objects,$(CLASSIC_SRCS))
CLASSIC_LIB := $(BUILD)/libgrobo-classic.a
CLASSIC_SONAME := $(if $(IMPORT_LIB),,$(subst libgrobo,libgrobo-classic,$(SONAME)))
CLASSIC_LINK_NAME := $(subst libgrobo,libgrobo-classic,$(LINK_NAME))
CLASSIC_SHARED := $(if $(CLASSIC_SONAME),$(BUILD)/$(CLASSIC_SONAME))
SHARED_LIB := $(if $(SONAME),$(BUILD)/$(SONAME))
PC_FILES := $(BUILD)/grobo.pc $(BUILD)/grobo-path.pc $(BUILD)/grobo-core.pc $(BUILD)/grobo-classic.pc
CMAKE_FILES := $(BUILD)/cmake/grobo-config.cmake $(BUILD)/cmake/grobo-config-version.cmake
GRCTL := $(if $(TOOL_SRCS),$(BUILD)/grctl$(EXE))
# What `grctl serve`, `grctl agent` and `grctl fleet` are. WHOLE_GRCTL: they are in grctl itself, where a
# program cannot become another one, or is to be one file.
WHOLE_GRCTL := $(if $(EMULATOR)$(filter win32,$(PORT))$(filter -static,$(LDFLAGS)),yes)
BESIDE := $(if $(TOOL_SRCS),$(if $(WHOLE_GRCTL),,$(BUILD)/grctl-serve$(EXE) $(BUILD)/grctl-fleet$(EXE)))
# What runs on this machine: grctl, or a script that gives it to the emulator.
GRCTL_RUN := $(if $(EMULATOR),$(BUILD)/run/grctl,$(GRCTL))
BARE := $(if $(TOOL_SRCS),$(BUILD)/bare/grctl$(EXE))
SUPPORT_LIB := $(BUILD)/libsupport.a
ROBOTS := $(BUILD)/tools/robots/robots
SERVOS := $(BUILD)/tools/servos/servos
PICTURE := $(BUILD)/tools/picture/picture$(EXE)

VERSION = $(shell sed -n 's/.*GROBO_VERSION_STRING "\(.*\)"/\1/p' include/grobo/version.h)

include tools/baremetal/baremetal.mk

# ---- targets -------------------------------------------------------------------------------

# Simulated robots of the tests have no weight, but where a test says so.
export GRCTL_PHYSICS ?= off

.PHONY: help all lib demo cockpit check compile_commands robots servos servo-models shelves messages lint lint-quick format test check-san check-san-cli check-tsan check-memcheck install uninstall
.PHONY: clean analyse analyzer tidy fuzz soak dist bench bench-peers bench-count bench-realtime bench-pump plots captures cross check-cross check-drivers
.PHONY: check-physics check-bodies bodies-soak bodies-pictures balance-table check-fleet check-abi sources wrap deb check-deb release check-families check-cockpit check-api cockpit-soak check-ports nightly check-scan check-coverage coverage check-mutants check-sequences check-model check-areas check-map check-asserts install-lib FORCE
.PHONY: firmware size check-firmware picture site check-site

help: ## this list
	@awk -F ':.*## ' '/^[a-z_-]+:.*## / { printf "  make %-16s %s\n", $$1, $$2 }' Makefile
	@echo 'Variables: BUILD=build CC= AR= CROSS_COMPILE= CFLAGS= SAN=address,undefined'
	@echo '  ONLY=joints RING="unit engine" (for test) PREFIX=/usr/local DESTDIR= V=1'
	@echo '  TARGET=one of $(TARGETS) (for cross)'

all: lib $(GRCTL) $(BESIDE) $(GRCTL_RUN) $(ALSO) ## libraries and grctl, in build/

lib: $(STATIC_LIB) $(CORE_LIB) $(SHARED_LIB) $(CLASSIC_LIB) $(CLASSIC_SHARED) $(PC_FILES) $(CMAKE_FILES) ## the libraries alone: libevent and libyaml are enough

MOTION ?= motions/greet.pseq
demo: ## play MOTION=motions/greet.pseq on a simulated robot behind a pty
	@tools/setup.sh --demo
	@$(MAKE) --no-print-directory $(BUILD)/grctl
	@tools/demo.sh $(BUILD)/grctl $(MOTION)

cockpit: ## the cockpit of a simulated robot: a link for the browser
	@tools/setup.sh --demo
	@$(MAKE) --no-print-directory $(BUILD)/grctl $(BUILD)/grctl-serve
	@$(BUILD)/grctl -d sim serve motions

check: ## set up what is missing, build, lint, run every test
	@tools/setup.sh --check
	@$(MAKE) --no-print-directory all
	@$(MAKE) --no-print-directory lint
	@echo 'left out: other machines, firmware and real drivers (make check-ports)'
	@$(MAKE) --no-print-directory bench-count; counted=$$?; \
	    $(MAKE) --no-print-directory test && exit $$counted

lint: all $(ROBOTS) $(SERVOS) ## check the rules of the house: sources, objects, headers, symbols
	@tools/lint/run.sh --all $(BUILD)

lint-quick: ## the rules that sources alone can break; takes two seconds
	@tools/lint/run.sh --quick $(BUILD)

compile_commands: ## compile_commands.json, for language servers: how each file is compiled
	@$(MAKE) --no-print-directory -nB V=1 all $(TEST_PROGRAMS) $(DRIVER_PROGRAMS) $(FUZZ_REPLAYS) \
	    $(BENCHES) $(EXAMPLES) $(ROBOTS) $(SERVOS) $(PICTURE) | \
	    awk -v folder="$(CURDIR)" -f tools/compile_commands.awk >compile_commands.json

servos: $(SERVOS) ## make the tables of servo models from src/servo/models
	@tools/servos/make.sh $(SERVOS)

shelves: ## the functions of each shelf of headers, and how many they are
	@tools/shelves.sh

servo-models: $(SERVOS) ## the table of docs/servo-models.md: models, and their sources
	@sed '/^|---|---|---|---|---|---|---|---|---|$$/q' docs/servo-models.md >$(BUILD)/servo-models.md
	@for f in src/servo/models/*/table.yaml; do $(SERVOS) --document "$${f%/table.yaml}" || exit 1; done \
	    >>$(BUILD)/servo-models.md
	@mv $(BUILD)/servo-models.md docs/servo-models.md

robots: $(ROBOTS) ## make the tables of src/robots from its files
	@tools/robots/make.sh $(ROBOTS)

messages: ## write the texts of the sources into the catalogues of grctl, for translation
	@tools/lint/lang.sh --update

format: ## write sources as clang-format 14 does; FILES="src/bus/bus.c" chooses
	@tools/lint/format.sh --fix $(or $(FILES),$(shell find include src ports tools tests docs -name '*.[ch]'))

# They take longest, of those that mostly wait and of the others: `make test` tells the slowest.
TEST_FIRST := every_model fleet_stops estop replay json serve paused estop_users robot doctor deaths guide_robots \
    robot_files robot_new fleet_leader fleet_strangers standing test_play_line test_runner_motion test_guard \
    python packaging fetch_content meson build_systems
# The programs and scripts of the chosen rings, as tests/run.sh wants them.
in_rings = $(foreach ring,$(RING),$(filter $(1)tests/$(ring)/%,$(2)))
# What tests of a build for another machine must know.
cross_env = $(if $(CROSS),$(foreach v,CROSS EMULATOR SYSROOT CXX,$(v)="$($(v))") \
    TEST_WRAPPER="$(or $(TEST_EMULATOR),$(EMULATOR))" TEST_TIMEOUT_S=600)

left_out = $(if $(strip $(call in_rings,,$(LEFT_OUT))),$(BUILD)/left_out.sh)
# Those left out are counted as skipped, with the target's reason.
$(BUILD)/left_out.sh: FORCE
	@printf '%s\n' '. tests/support/tap.sh' $(foreach t,$(call in_rings,,$(LEFT_OUT)),'test_case $(t)' 'skip $(t) "$(LEFT_OUT_WHY)"') \
	    done_testing >$@

# ONLY=WORD: what may hold a test that is called so, in all rings; tests/run.sh asks it.
ONLY ?=
FOUND = $(call once,FOUND,$(shell tests/only.sh '$(ONLY)' $(TEST_SRCS) $(FUZZ_SRCS) $(TEST_SCRIPTS)))
may = $(if $(ONLY),$(filter $(FOUND) $(patsubst %.c,$(BUILD)/%$(EXE),$(filter %.c,$(FOUND))),$(1)),$(1))
test_programs = $(call may,$(call in_rings,$(BUILD)/,$(TEST_PROGRAMS)))
test_replays = $(if $(filter fuzz,$(RING)),$(call may,$(FUZZ_REPLAYS)))
test_scripts = $(call may,$(call in_rings,,$(TEST_SCRIPTS)))
corpora = $(foreach f,$(test_replays),$(f)@tests/fuzz/corpus/$(patsubst fuzz_%,%,$(notdir $(f))))
chosen = $(test_programs) $(test_replays) $(if $(ONLY),,$(if $(filter port,$(RING)),$(DRIVER_PROGRAMS))) \
    $(if $(filter tests/export/%,$(test_scripts)),$(EXAMPLES) $(PICTURE) $(BARE))
test: all $(chosen) $(CROSS_TOOLS) $(left_out) ## the tests alone; ONLY=joints or RING="unit engine" chooses
	@$(TEST_BEGIN) GRCTL="$(call whole,$(GRCTL_RUN))" BUILD="$(BUILD)" CC="$(CC)" TEST_LOGS="$(BUILD)/logs" TEST_FIRST="$(TEST_FIRST)" EDIT=$(EDIT) SCREEN=$(SCREEN) XML=$(XML) \
	    TEST_ONLY="$(ONLY)" $(cross_env) tests/run.sh \
	    $(test_programs) $(test_scripts) $(corpora) $(if $(ONLY),,$(left_out)) $(TEST_END)

# What runs long is the library: it is optimised. Lines are enough for what a sanitizer says.
SAN_BUILD = BUILD=$(BUILD)/san SAN=address,undefined CFLAGS='-O1 -g1' SRC_CFLAGS=-O2 WALKS=-DGROBO_WALKS
check-san: ## the tests of our own code under AddressSanitizer and UBSan
	@TEST_WAITERS=2 GROBO_BLOCKED_MINUTES=1 LSAN_OPTIONS="suppressions=$(CURDIR)/tests/support/leaks:print_suppressions=0" \
	    $(MAKE) --no-print-directory test $(SAN_BUILD) \
	    RING='$(filter-out lint export,$(RING))'

# The command in check-san's build: scripts that together reach its parsers, files, requests, registers
# and texts, and wait little. What a sanitizer says of a program that a script starts in the background
# may be seen by nobody: it is a file, and one fails this.
SAN_CLI ?= budget calibrate check completion config convert coupled decode doctor doctor_ways fall help imu \
    japanese json legs line_limits line_traces own_models play plot record registers_dynamixel \
    registers_feetech replay robot robot_configured robot_export robot_files robot_import robot_lines \
    robot_new scan_families serve serve_motions setup shell show sim_console sim_state sim_strict \
    two_lines units weight
SAN_REPORTS = $(call whole,$(BUILD)/san/reports)
SAN_OPTIONS = exitcode=99:log_path=$(SAN_REPORTS)/of
check-san-cli: ## the command under these sanitizers, by scripts that wait little; SAN_CLI="decode" chooses
	@rm -rf "$(SAN_REPORTS)" && mkdir -p "$(SAN_REPORTS)"
	@ASAN_OPTIONS="$(SAN_OPTIONS)" UBSAN_OPTIONS="$(SAN_OPTIONS)" \
	    LSAN_OPTIONS="suppressions=$(CURDIR)/tests/support/leaks:print_suppressions=0" \
	    $(MAKE) --no-print-directory test $(SAN_BUILD) RING=cli TEST_SCRIPTS='$(SAN_CLI:%=tests/cli/%.sh)'; status=$$?; \
	    for report in "$(SAN_REPORTS)"/*; do \
	        [ ! -e "$$report" ] || { cat "$$report"; status=1; }; \
	    done; exit $$status

FAMILY_CLIENTS := dynamixel-sdk==4.1.0 rustypot==1.13.1 feetech-servo-sdk==1.0.0 feetech-cli==0.1.8 \
    deepdiff draccus tqdm numpy huggingface-hub cffi
# Its motors and robots alone: the rest of it wants torch.
FAMILY_LEROBOT := lerobot==0.4.4
# A Python with MuJoCo, where it can be had; $(call with_mujoco,COMMANDS) runs them there, behind the
# package, or says that it is skipped.
GET_MUJOCO = python3 -m venv $(BUILD)/physics && $(BUILD)/physics/bin/pip install -q \
    --disable-pip-version-check mujoco numpy cffi || true
with_mujoco = if $(BUILD)/physics/bin/python -c 'import mujoco, numpy, cffi' 2>/dev/null; then \
    $(MAKE) --no-print-directory python PYTHON="$(call whole,$(BUILD)/physics/bin/python)" && $(1); \
    else echo '$@: skipped: MuJoCo cannot be had for this python3'; fi

check-physics: all $(PLANT_PIPE) $(WEIGHT_TABLE) ## simulated servos in front of bodies of MuJoCo (from PyPI)
	@$(GET_MUJOCO)
	@+$(call with_mujoco, \
	    $(BUILD)/physics/bin/python tests/physics/mujoco_plant.py $(PLANT_PIPE) && \
	    $(BUILD)/physics/bin/python tests/physics/mujoco_plant.py $(PLANT_PIPE) $(WEIGHT_TABLE) && \
	    $(BUILD)/physics/bin/python tests/physics/exported.py "$(call whole,$(GRCTL_RUN))" \
	        $(PLANT_PIPE) gr001 so101 ./tests/physics/hexapod.yaml && \
	    GRCTL="$(call whole,$(GRCTL_RUN))" PYTHONPATH="$(abspath $(PYTHON_DIR))" \
	    $(BUILD)/physics/bin/python tests/package/python/test_physics.py)

balance-table: all ## the table of docs/guide/whole-body.md: COUNT=300 variants, SEED=1; in build/balance.md
	@$(GET_MUJOCO)
	@+$(call with_mujoco, \
	    PYTHONPATH="$(abspath $(PYTHON_DIR))" $(BUILD)/physics/bin/python tests/physics/balance.py \
	        "$(call whole,$(GRCTL_RUN))" motions/*.pseq --count $(or $(COUNT),300) --seed $(or $(SEED),1) \
	        --table $(BUILD)/balance.md)

# For programs that drive bodies: two Pythons, one with MuJoCo, one with the clients.
check-bodies: all $(BUILD)/docs/examples/balance$(EXE) ## programs of others drive bodies of MuJoCo, and what these cost (from PyPI)
	@$(GET_MUJOCO)
	@python3 -m venv $(BUILD)/families && $(BUILD)/families/bin/pip install -q \
	    --disable-pip-version-check $(FAMILY_CLIENTS) pylx16a==1.1.1 dicot==0.1.0 || true
	@$(BUILD)/families/bin/pip install -q --disable-pip-version-check --no-deps $(FAMILY_LEROBOT) || true
	@+$(call with_mujoco, \
	    export PYTHONPATH="$(abspath $(PYTHON_DIR))" && \
	    $(BUILD)/physics/bin/python tests/physics/clients.py "$(call whole,$(GRCTL_RUN))" \
	        $(BUILD)/families/bin/python && \
	    $(BUILD)/physics/bin/python tests/physics/lean.py "$(call whole,$(GRCTL_RUN))" \
	        $(BUILD)/docs/examples/balance$(EXE) && \
	    $(BUILD)/physics/bin/python tests/physics/teleoperation.py "$(call whole,$(GRCTL_RUN))" \
	        $(BUILD)/families/bin/python && \
	    $(BUILD)/physics/bin/python tests/physics/cube.py "$(call whole,$(GRCTL_RUN))" && \
	    $(BUILD)/physics/bin/python tests/physics/cost.py "$(call whole,$(GRCTL_RUN))")

bodies-soak: all ## GR001 on a body that is pushed and falls, in virtual time: MINUTES=60, SEED=1
	@$(GET_MUJOCO)
	@+$(call with_mujoco, \
	    PYTHONPATH="$(abspath $(PYTHON_DIR))" $(BUILD)/physics/bin/python tests/physics/soak.py \
	        "$(call whole,$(GRCTL_RUN))" motions/*.pseq --minutes $(or $(MINUTES),60) \
	        --seed $(or $(SEED),1))

bodies-pictures: all ## the strips of docs/guide/body.md, in build/pictures; MUJOCO_GL=egl without a display
	@$(GET_MUJOCO)
	@+$(call with_mujoco, \
	    mkdir -p $(BUILD)/pictures && PYTHONPATH="$(abspath $(PYTHON_DIR))" \
	    $(BUILD)/physics/bin/python tests/physics/pictures.py "$(call whole,$(GRCTL_RUN))" \
	        $(BUILD)/pictures)

check-families: all ## clients of other servos (from PyPI) against the simulator
	@python3 -m venv $(BUILD)/families && $(BUILD)/families/bin/pip install -q --disable-pip-version-check $(FAMILY_CLIENTS)
	@$(BUILD)/families/bin/pip install -q --disable-pip-version-check --no-deps $(FAMILY_LEROBOT) || true
	-@$(MAKE) --no-print-directory python PYTHON="$(call whole,$(BUILD)/families/bin/python)"
	@GRCTL="$(call whole,$(GRCTL_RUN))" PYTHON=$(BUILD)/families/bin/python BUILD="$(BUILD)" \
	    PYTHONPATH="$(abspath $(PYTHON_DIR))" \
	    TEST_LOGS="$(BUILD)/logs" tests/run.sh tests/families/clients.sh

check-fleet: all ## a crowd of simulated robots at a real broker; HOSTS=4 EACH=25 RUNS=12, TIMES=assert
	-@tools/setup.sh --check
	@GRCTL="$(call whole,$(GRCTL_RUN))" BUILD="$(BUILD)" TEST_TIMEOUT_S=1200 TEST_LOGS="$(BUILD)/logs/fleet" \
	    tests/run.sh $(sort $(wildcard tests/cli/fleet*.sh)) tests/fleet/crowd.sh; \
	    status=$$?; sed -n 's/^# /  /p' $(BUILD)/logs/fleet/*.log; exit $$status

COCKPIT_CLIENT := playwright==1.65.0
COCKPIT_AXE := axe-core@4.10.3
check-cockpit: all ## the cockpit's page in Chromium (Playwright from PyPI, axe-core from npm); PICTURES=DIR keeps pictures
	-@tools/setup.sh --cockpit
	-@python3 -m venv $(BUILD)/cockpit && $(BUILD)/cockpit/bin/pip install -q --disable-pip-version-check $(COCKPIT_CLIENT)
	-@! command -v npm >/dev/null || npm install --silent --no-fund --no-audit --prefix $(BUILD)/cockpit $(COCKPIT_AXE)
	@GRCTL="$(abspath $(GRCTL))" PYTHON=$(BUILD)/cockpit/bin/python PICTURES="$(PICTURES)" \
	    AXE=$(BUILD)/cockpit/node_modules/axe-core/axe.min.js BUILD="$(BUILD)" TEST_TIMEOUT_S=1200 \
	    TEST_LOGS="$(BUILD)/logs/cockpit" tests/run.sh tests/cockpit/page.sh

check-api: all ## what serve answers against docs/serve.openapi.json, by schemathesis (from PyPI)
	-@python3 -m venv $(BUILD)/api && $(BUILD)/api/bin/pip install -q --disable-pip-version-check schemathesis==4.32.5
	@GRCTL="$(abspath $(GRCTL))" SCHEMATHESIS="$(abspath $(BUILD)/api/bin/schemathesis)" BUILD="$(BUILD)" \
	    TEST_TIMEOUT_S=1200 TEST_LOGS="$(BUILD)/logs/api" tests/run.sh tests/cockpit/api.sh

cockpit-soak: all ## grctl serve with good and bad clients for MINUTES=60: its memory stays flat
	@GRCTL="$(abspath $(GRCTL))" python3 tests/cockpit/soak.py $(or $(MINUTES),60)

# But for those that judge when frames leave, by the clock of a machine that is not slowed down.
check-tsan: ## the tests of what threads share under ThreadSanitizer
	@TEST_JOBS=2 $(MAKE) --no-print-directory test BUILD=$(BUILD)/tsan SAN=thread CFLAGS='-O1 -g1' \
	    WITHOUT='tests/link/test_classic_frames.c tests/link/test_play_line.c' \
	    RING='link port'

check-memcheck: ## those of check-san but the command's, under valgrind
	@TEST_WRAPPER='valgrind -q --leak-check=full --error-exitcode=99' TEST_TIMEOUT_S=900 \
	    $(MAKE) --no-print-directory test RING='$(filter-out cli lint export,$(RING))'

TARGETS := $(filter-out linux static zig,$(patsubst tools/cross/%.mk,%,$(wildcard tools/cross/*.mk)))
cross_make = $(if $(filter $(TARGETS),$(TARGET)),,$(error TARGET= is one of $(TARGETS)))$(MAKE) \
    --no-print-directory CROSS=$(TARGET) BUILD=$(BUILD)/$(TARGET)
cross: ## build for another machine, in build/arm64 for TARGET=arm64
	@$(if $(filter $(TARGETS),$(TARGET)),tools/cross/libs.sh $(TARGET))
	+@$(cross_make) all

check-cross: cross ## the tests of that build, under an emulator; RING= chooses
	+@$(cross_make) test

nightly: all ## what .ci/run has no time for: hours; STAGES="fuzz map" chooses; a page in build/nightly.md
	@BUILD="$(BUILD)" tools/nightly.sh $(STAGES)

check-scan: all ## a scan of a bus on all lines that scans promise something for
	@GRCTL="$(call whole,$(GRCTL_RUN))" BUILD="$(BUILD)" SCAN_MATRIX=all SCAN_RUNS=20 TEST_TIMEOUT_S=14400 \
	    TEST_LOGS="$(BUILD)/logs/scan" tests/run.sh tests/cli/scan.sh

check-ports: ## build and test for every machine that can be had here; PORTS="arm64 musl" chooses
	-@tools/setup.sh --ports
	@BUILD="$(BUILD)" MINUTES=$(MINUTES) tools/ports.sh $(PORTS)

check-drivers: ## the serial port's tests on real drivers, of a Debian kernel in a virtual machine
	-@tools/setup.sh --drivers
	@$(MAKE) --no-print-directory $(GRCTL) $(DRIVER_PROGRAMS)
	@GRCTL="$(call whole,$(GRCTL))" BUILD="$(BUILD)" TEST_TIMEOUT_S=300 TEST_LOGS="$(BUILD)/logs/drivers" \
	    DRIVER_PROGRAMS="$(DRIVER_PROGRAMS)" tests/run.sh tests/drivers/boot.sh

firmware: ## the core and two examples for Cortex-M0 and M4, in build/bare
	@tools/setup.sh --cross baremetal
	+@$(MAKE) --no-print-directory $(FIRMWARES)

size: ## what the core and these examples take there, against the limits; UPDATE=1 keeps the figures
	@tools/setup.sh --cross baremetal
	+@$(MAKE) --no-print-directory $(BARE_LIBS) $(BARE_RAM) $(FIRMWARES)
	@PREFIX=$(BARE_PREFIX) UPDATE=$(UPDATE) tools/baremetal/size.sh $(BARE_DIR) $(BARE_SIZES)

check-firmware: $(GRCTL) ## these examples in QEMU, grctl or a simulated robot at their UART
	-@tools/setup.sh --cross baremetal
	+@if command -v $(BARE_PREFIX)gcc >/dev/null; then $(MAKE) --no-print-directory $(FIRMWARES); fi
	@GRCTL="$(call whole,$(GRCTL))" FIRMWARE="$(BARE_DIR)" BARE_PREFIX=$(BARE_PREFIX) \
	    TEST_TIMEOUT_S=300 TEST_LOGS="$(BUILD)/logs/firmware" tests/run.sh tests/firmware/machines.sh

bench: $(BENCHES) $(GRCTL) ## speed beside peers and floors, in build/bench.json too; below 4 minutes
	@GRCTL="$(call whole,$(GRCTL))" CXX="$(CXX)" tests/bench/run.sh $(BUILD)

bench-peers: ## bring libmodbus, rustypot, dynamixel-sdk, pyserial and yaml-cpp into build/peers
	@tests/bench/peers.sh $(BUILD)/peers

bench-realtime: $(BUILD)/tests/bench/bench_play ## lateness at 50 to 1000 Hz with every core busy, with and without a priority
	@$< realtime

# Work whose instructions are counted is compiled as everybody does it.
bench-count: $(BUILD)/tests/bench/bench_work $(BUILD)/tests/bench/bench_line ## instructions against tests/bench/instructions; UPDATE=1 keeps them
	@CC="$(CC)" FLAGS="$(CFLAGS) $(SAN)" tests/bench/count.sh $(BUILD) $(if $(UPDATE),--update,--gate)

bench-pump: ## instructions of the engine on a Cortex-M0 and M4, counted by QEMU
	-@tools/setup.sh --cross baremetal
	+@if command -v $(BARE_PREFIX)gcc >/dev/null; then $(MAKE) --no-print-directory $(PUMPS); fi
	@tests/bench/pump.sh $(BARE_DIR)

plots: $(BUILD)/grctl ## draw motions/plots/*.svg again
	@tools/plots.sh "$(call whole,$(BUILD)/grctl)"

site: ## the reference of headers and documents in build/site/html, man pages in build/site/man
	@tools/site/make.sh "$(BUILD)/site"

check-site: all ## that site and its links, and the blocks of code of all documents; part of make check
	@BUILD="$(BUILD)" CC="$(CC)" TEST_LOGS="$(BUILD)/logs/site" tests/run.sh tests/export/site.sh \
	    tests/export/blocks.sh tests/export/original.sh

picture: $(PICTURE) ## draw docs/robot.svg again: a simulated GR001 plays
	@tools/picture.sh "$(call whole,$(PICTURE))"

captures: $(BUILD)/grctl ## make the screens of docs/guide/tour.md and the table of safety.md again
	@GRCTL="$(call whole,$(GRCTL))" TOUR_WRITE=yes sh tests/cli/tour.sh
	@GRCTL="$(call whole,$(GRCTL))" TOUR_WRITE=yes sh tests/cli/deaths.sh

analyse: ## shellcheck of scripts, ruff and mypy (from PyPI) of Python, tsc (from npm) of the page
	-@! command -v apt-get >/dev/null || command -v shellcheck >/dev/null || tools/setup.sh --ci
	-@python3 -m venv $(BUILD)/ruff && $(BUILD)/ruff/bin/pip install -q --disable-pip-version-check ruff mypy cffi mcap
	-@command -v npm >/dev/null && npm install -s --no-audit --no-fund --prefix $(BUILD)/tsc typescript >/dev/null
	@RUFF="$(abspath $(BUILD)/ruff/bin/ruff)" MYPY="$(abspath $(BUILD)/ruff/bin/mypy)" \
	    TSC="$(abspath $(BUILD)/tsc/node_modules/.bin/tsc)" BUILD="$(BUILD)" TEST_LOGS="$(BUILD)/logs/analyse" \
	    tests/run.sh tools/lint/analyse.sh

analyzer: ## gcc -fanalyzer of library, ports and command, but what tools/lint/reviewed has
	+@MAKE="$(MAKE)" sh tools/lint/analyzer.sh $(BUILD)/analyzer

tidy: ## clang-tidy over the library and the command; advice, not a gate
	@status=0; for file in $(CORE_SRCS) $(OTHER_SRCS) $(TOOL_SRCS); do \
	    $(TIDY) --quiet $$file -- -std=c11 -Iinclude -Iports/$(PORT)/include -I. $(OS_FLAGS) \
	        2>/dev/null || status=1; \
	done; exit $$status

fuzz: ## libFuzzer on each target for FUZZ_S=60 seconds, two at a time; finds stay in build/fuzz
	@command -v $(FUZZ_CC) >/dev/null || \
	    { echo 'fuzz: needs clang with libFuzzer (tools/setup.sh --ci installs it)' >&2; exit 1; }
	+@$(MAKE) --no-print-directory $(patsubst $(BUILD)/%,$(BUILD)/fuzz/%,$(FUZZERS)) BUILD=$(BUILD)/fuzz \
	    CC=$(FUZZ_CC) SAN=address,undefined,fuzzer-no-link CFLAGS='-O1 -g'
	@tests/fuzz/run.sh $(BUILD)/fuzz $(FUZZ_S) $(patsubst fuzz_%.fuzzer,%,$(notdir $(FUZZERS)))

SEEDS ?= 6
FROM ?= 0
# All of them: RS30x by the one program, the other families by the other.
SOAKS := $(filter-out $(if $(filter rs30x,$(FAMILY)),%_family_soak,$(if $(FAMILY),%_robot_soak)),\
    $(BUILD)/tests/engine/test_robot_soak $(BUILD)/tests/engine/test_family_soak) \
    $(if $(FAMILY)$(LINE),,$(BUILD)/tests/engine/test_halt_matrix $(BUILD)/tests/engine/test_blocked)
soak: $(SOAKS) ## all stops, and half an hour of virtual time on each bad line, SEEDS=6 FROM=0; FAMILY=, LINE=, MINUTES= choose
	@for program in $(SOAKS); do \
	    GROBO_HALT=all GROBO_BLOCKED_MINUTES=60 GROBO_SOAK=$(SEEDS) \
	    GROBO_SOAK_FROM=$(FROM) GROBO_SOAK_LINE=$(LINE) \
	    GROBO_SOAK_MINUTES=$(MINUTES) GROBO_SOAK_FAMILY=$(FAMILY) $$program || exit 1; done

# Sabotages, each of which a test should notice (tests/mutants/). The folder is its own.
SEED ?= 1
COUNT ?=
CAP_S ?= 0
MUTANT_DIR := $(BUILD)/mutants
MUTANT_TESTS := $(patsubst %.c,$(MUTANT_DIR)/%.o,$(filter tests/engine/%,$(TEST_SRCS)) \
    $(filter-out tests/unit/test_body% tests/unit/test_motion% tests/unit/test_pcapng%,$(filter \
    tests/unit/%,$(TEST_SRCS))))
MUTANT_LIBS := $(patsubst %,$(MUTANT_DIR)/lib%.a,support grctl grobo-classic grobo)
check-mutants: ## sabotage the core in COUNT=300 ways that SEED=1 chooses: a test must notice each
	-@tools/setup.sh --mutants
	@$(MAKE) --no-print-directory BUILD=$(MUTANT_DIR) CFLAGS=-O2 WALKS=-DGROBO_WALKS \
	    $(MUTANT_TESTS) $(MUTANT_LIBS)
	@nice python3 tests/mutants/run.py --seed $(SEED) --count $(or $(COUNT),300) $(if $(ONLY),--only $(ONLY)) --cap-s $(CAP_S) \
	    --work $(MUTANT_DIR)/work --sources "$(CORE_SRCS)" --tests "$(MUTANT_TESTS)" \
	    --compile '$(CC) $(ALL_CPPFLAGS) -DGROBO_WALKS $(SRC_INCLUDE) -std=c11 -fPIC -O2' --link '$(CC)' \
	    --libs '$(MUTANT_LIBS) $(CMOCKA_LIBS) $(TOOL_LIBS) $(LIBS)' \
	    --scope tests/mutants/scope --survivors tests/mutants/survivors --named tests/mutants/named

# Each sabotage of tests/mutants/sequences by the sequences of three events, then all of DEPTH.
SEQUENCES := $(MUTANT_DIR)/tests/engine/test_sequences.o
check-sequences: $(BUILD)/tests/engine/test_sequences ## all sequences of DEPTH=3 requests and line events, each family; sabotages first
	-@tools/setup.sh --mutants
	@$(MAKE) --no-print-directory -s BUILD=$(MUTANT_DIR) CFLAGS=-O2 WALKS=-DGROBO_WALKS $(SEQUENCES) $(MUTANT_LIBS)
	@GROBO_SEQUENCES=3 nice python3 tests/mutants/run.py --only $(or $(ONLY),named) \
	    --work $(MUTANT_DIR)/sequences --sources "$(CORE_SRCS)" --tests "$(SEQUENCES)" \
	    --compile '$(CC) $(ALL_CPPFLAGS) -DGROBO_WALKS $(SRC_INCLUDE) -std=c11 -fPIC -O2' --link '$(CC)' \
	    --libs '$(MUTANT_LIBS) $(CMOCKA_LIBS) $(TOOL_LIBS) $(LIBS)' \
	    --scope tests/mutants/scope --named tests/mutants/sequences
	@GROBO_SEQUENCES=$(or $(DEPTH),3) $(BUILD)/tests/engine/test_sequences

# Areas outside the core, by the tests that tests/mutants/areas names.
check-areas: ## sabotage each area outside the core in COUNT=300 ways: AREA="link motion"; a table in build/mutants/areas.md
	-@tools/setup.sh --mutants
	@$(MAKE) --no-print-directory -s BUILD=$(MUTANT_DIR) CFLAGS=-O2 WALKS=-DGROBO_WALKS $(MAP_TESTS) $(MUTANT_LIBS)
	@nice python3 tests/mutants/areas.py --seed $(SEED) --count $(or $(COUNT),300) $(if $(ONLY),--only $(ONLY)) \
	    --cap-s $(CAP_S) --areas tests/mutants/areas --objects $(MUTANT_DIR) --work $(MUTANT_DIR)/areas \
	    --report $(MUTANT_DIR)/areas.md --link '$(CC)' --libs '$(MUTANT_LIBS) $(CMOCKA_LIBS) $(TOOL_LIBS) $(LIBS)' \
	    --compile '$(CC) $(ALL_CPPFLAGS) -DGROBO_WALKS $(SRC_INCLUDE) $(TOOL_INCLUDE) $(OS_FLAGS) $(EVENT_CFLAGS) $(YAML_CFLAGS) -DGROBO_GUARD_PROGRAM=\"grctl\" -std=c11 -fPIC -O2' \
	    $(AREA)

check-model: ## search the model of stops between programs with Spin, and its sabotages
	@CC="$(CC)" TEST_LOGS="$(BUILD)/logs/model" tests/run.sh tests/model/model.sh

ASSERT_TESTS := $(MUTANT_TESTS) $(patsubst %.c,$(MUTANT_DIR)/%.o,$(filter tests/link/test_runner% \
    tests/link/test_session% tests/link/test_serial% tests/link/test_virtual%,$(TEST_SRCS)))
check-asserts: ## sabotage what the assertions of bus, sequencer, engine and loop state: each must end a test
	-@tools/setup.sh --mutants
	@$(MAKE) --no-print-directory -s BUILD=$(MUTANT_DIR) CFLAGS=-O2 WALKS=-DGROBO_WALKS $(ASSERT_TESTS) $(MUTANT_LIBS)
	@nice python3 tests/mutants/asserts.py $(if $(ONLY),--only "$(ONLY)") --rows tests/mutants/asserts \
	    --of "src/bus/ src/play/ src/robot/ src/link/" --work $(MUTANT_DIR)/work \
	    --sources "$(CORE_SRCS) $(OTHER_SRCS)" --tests "$(ASSERT_TESTS)" \
	    --compile '$(CC) $(ALL_CPPFLAGS) -DGROBO_WALKS $(SRC_INCLUDE) $(OS_FLAGS) $(EVENT_CFLAGS) $(YAML_CFLAGS) -std=c11 -fPIC -O2' \
	    --link '$(CC)' --libs '$(MUTANT_LIBS) $(CMOCKA_LIBS) $(TOOL_LIBS) $(LIBS)' $(if $(JOBS),--jobs $(JOBS))

MAP_TESTS := $(patsubst %.c,$(MUTANT_DIR)/%.o,$(filter tests/unit/% tests/engine/% \
    tests/link/% tests/port/%,$(TEST_SRCS)))
check-map: ## sabotage the function of each row of docs/seed-map.md; COUNT=40 rows that SEED=1 chooses
	-@tools/setup.sh --mutants
	@$(MAKE) --no-print-directory -s BUILD=$(MUTANT_DIR) CFLAGS=-O2 WALKS=-DGROBO_WALKS $(MAP_TESTS) $(MUTANT_LIBS)
	@nice python3 tests/mutants/rows.py --seed $(SEED) --count $(or $(COUNT),0) $(if $(ONLY),--only "$(ONLY)") \
	    --map docs/seed-map.md --rows tests/mutants/rows --work $(MUTANT_DIR)/work \
	    --sources "$(CORE_SRCS) $(OTHER_SRCS) $(CLASSIC_SRCS)" --objects $(MUTANT_DIR)/tests \
	    --compile '$(CC) $(ALL_CPPFLAGS) $(SRC_INCLUDE) $(OS_FLAGS) $(EVENT_CFLAGS) $(YAML_CFLAGS) -std=c11 -fPIC -O2' \
	    --link '$(CC)' --libs '$(MUTANT_LIBS) $(CMOCKA_LIBS) $(TOOL_LIBS) $(LIBS)' $(if $(JOBS),--jobs $(JOBS))

ABI_TAG ?= $(shell git describe --tags --abbrev=0 2>/dev/null)
check-abi: ## compare the shared library with that of the last tag, by abidiff
	@MAKE='$(MAKE)' BUILD='$(call whole,$(BUILD))/abi' tools/check-abi.sh '$(ABI_TAG)'

coverage: ## which lines the tests reach, by file
	@$(MAKE) --no-print-directory check-coverage FILES=yes

# Percent of the lines of each part of the tree.
GATES ?= src=97 ports=85 tools=93
FILES ?=
# Whether the tests pass is judged by a build without counters, which is quicker at its exit. Left out
# is what runs again what other tests run.
check-coverage: ## that the tests reach 97 % of the lines of src, 85 % of ports, 93 % of tools
	@mkdir -p $(BUILD)/cov
	@find $(BUILD)/cov -name '*.gcda' -delete
	@TEST_WAITERS=2 $(MAKE) --no-print-directory test BUILD=$(BUILD)/cov COVERAGE=yes CFLAGS='-O1 -g1' \
	    WITHOUT='tests/cli/memcheck.sh tests/engine/test_family_soak.c tests/engine/test_robot_soak.c' \
	    RING='$(filter-out lint export,$(RING))' >$(BUILD)/cov/log || \
	    grep -q '^[0-9]* passed, ' $(BUILD)/cov/log
	@sed -n 's/^FAIL  /not to its end with counters, which make check judges without: /p' $(BUILD)/cov/log
	@GCOV=$(CROSS_COMPILE)gcov FILES=$(FILES) sh tests/coverage.sh $(BUILD)/cov $(GATES)

DIST = libgrobo-$(VERSION)
dist: ## a tarball of the last commit, in build/
	@[ -e .git ] && git rev-parse -q --verify HEAD >/dev/null || \
	    { echo 'dist: not a git checkout: a tarball is made of a commit' >&2; exit 1; }
	@mkdir -p $(BUILD)
	git -c tar.umask=0022 archive --prefix=$(DIST)/ -o $(BUILD)/$(DIST).tar HEAD
	@gzip -nf $(BUILD)/$(DIST).tar
	@$(MAKE) --no-print-directory wrap

TARBALL ?= $(BUILD)/$(DIST).tar.gz
wrap: ## build/subprojects, for the Meson projects that take TARBALL=build/libgrobo-....tar.gz along
	@mkdir -p $(BUILD)/subprojects/packagefiles/grobo
	@cp $(TARBALL) $(BUILD)/subprojects/packagefiles/$(DIST).tar.gz
	@cp tools/package/meson/meson.build $(BUILD)/subprojects/packagefiles/grobo
	@sed -e 's|@VERSION@|$(VERSION)|' -e "s|@SHA256@|$$(sha256sum <$(TARBALL) | cut -d ' ' -f 1)|" \
	    tools/package/meson/grobo.wrap.in >$(BUILD)/subprojects/grobo.wrap

.PHONY: sbom sources wrap python wheel check-wheel deb deb-source check-deb check-roots release
# The Python package as it is used from here (PYTHONPATH=build/python) and packed.
PYTHON ?= python3
PYTHON_DIR := $(BUILD)/python
python: $(SHARED_LIB) $(PYTHON_DIR)/grobo/_abi.py ## the Python package, in build/python
	@cp -R tools/python/. $(PYTHON_DIR)
	@cp $(SHARED_LIB) $(PYTHON_DIR)/grobo
	@echo "VERSION = '$(VERSION)'" >$(PYTHON_DIR)/grobo/_version.py

$(PYTHON_DIR)/grobo/_abi.py: tools/python/generate.py src/libgrobo.map $(wildcard include/grobo/*.h include/grobo/core/*.h)
	@mkdir -p $(@D)
	@$(PYTHON) tools/python/generate.py . "$(CC)" $@ >/dev/null

wheel: ## a wheel with library and grctl, for x86_64 or PROCESSOR=aarch64, macos, win64, in build/wheel
	@tools/python/wheel.sh "$(BUILD)" $(PROCESSOR)

check-wheel: ## the wheels; this machine's is installed and plays a motion
	-@tools/setup.sh --cross musl
	@BUILD="$(BUILD)" TEST_TIMEOUT_S=3600 TEST_LOGS="$(BUILD)/logs/wheel" tests/run.sh tests/package/wheel.sh

ARCH ?=
deb: ## Debian packages in build/deb, for this machine or ARCH=arm64
	@tools/setup.sh --packages
	@tools/package/deb.sh "$(BUILD)" $(ARCH)

deb-source: ## the Debian source package of the last commit, in build/deb/source
	@tools/package/deb_source.sh "$(BUILD)"

check-deb: ## these for amd64 and arm64: lintian, and installed and purged in fresh Debian and Ubuntu roots
	-@tools/setup.sh --packages
	@BUILD="$(BUILD)" TEST_TIMEOUT_S=3600 TEST_LOGS="$(BUILD)/logs/deb" tests/run.sh tests/package/deb.sh

check-roots: ## README's commands, packages, CMake, Meson and pip in fresh Debian and Ubuntu roots
	-@tools/setup.sh --packages
	@BUILD="$(BUILD)" TEST_TIMEOUT_S=10800 TEST_LOGS="$(BUILD)/logs/roots" tests/run.sh tests/package/roots.sh

sbom: dist ## the bill of materials of the last commit's tarball, SPDX 2.3
	@tools/package/sbom.sh $(BUILD)/$(DIST).tar.gz >$(BUILD)/$(DIST).spdx.json
	@echo $(BUILD)/$(DIST).spdx.json

release: ## refuse where a step of a release is missing, else make the tarball
	@GRCTL="$(GRCTL)" BUILD="$(BUILD)" tools/package/release.sh

# What grctl prints of itself: FILE=ARGUMENTS. It takes a grctl that runs on this machine. What is
# below man/ja is in Japanese, whatever the language of who installs it.
GRCTL_HERE ?= $(if $(CROSS_COMPILE),,$(GRCTL_RUN))
PAGES := man/man1/grctl.1=help,--man man/ja/man1/grctl.1=help,--man bash-completion/completions/grctl=completion,bash \
    zsh/site-functions/_grctl=completion,zsh fish/vendor_completions.d/grctl.fish=completion,fish
JSON_PAGE := $(BUILD)/grctl-json.5
comma := ,
define install_page
install -d "$(DESTDIR)$(DATADIR)/$(dir $(firstword $(subst =, ,$(page))))"
	LC_ALL=$(if $(filter man/ja/%,$(page)),ja.UTF-8,C) $(GRCTL_HERE) $(subst $(comma), ,$(lastword $(subst =, ,$(page)))) \
	    >"$(DESTDIR)$(DATADIR)/$(firstword $(subst =, ,$(page)))"

endef

$(JSON_PAGE): docs/grctl-json.md tools/json_page.awk
	@mkdir -p $(@D)
	@awk -f tools/json_page.awk $< >$@

define install_shared
install -m 755 $(SHARED_LIB) "$(DESTDIR)$(if $(IMPORT_LIB),$(BINDIR),$(LIBDIR))"
	$(if $(IMPORT_LIB),install -m 644 $(BUILD)/$(IMPORT_LIB),ln -sf $(SONAME)) \
	    "$(DESTDIR)$(LIBDIR)/$(or $(IMPORT_LIB),$(LINK_NAME))"
endef

# For pkg-config --static: a link, or a copy where the system may have none.
define install_static
$(if $(IMPORT_LIB),install -m 644 $(BUILD)/$(file),ln -sf ../../$(file)) "$(DESTDIR)$(LIBDIR)/grobo/static/$(file)"

endef

install-lib: lib ## headers, libraries and what finds them: pkg-config, CMake
	install -d "$(DESTDIR)$(LIBDIR)/pkgconfig" "$(DESTDIR)$(LIBDIR)/cmake/grobo" "$(DESTDIR)$(INCLUDEDIR)/grobo" \
	    $(if $(IMPORT_LIB),"$(DESTDIR)$(BINDIR)")
	install -m 644 include/grobo/*.h "$(DESTDIR)$(INCLUDEDIR)/grobo"
	install -d "$(DESTDIR)$(INCLUDEDIR)/grobo/core" "$(DESTDIR)$(INCLUDEDIR)/grobo/classic"
	install -m 644 include/grobo/core/*.h ports/$(PORT)/include/grobo/core/*.h "$(DESTDIR)$(INCLUDEDIR)/grobo/core"
	install -m 644 include/grobo/classic/*.h "$(DESTDIR)$(INCLUDEDIR)/grobo/classic"
	install -m 644 $(STATIC_LIB) $(CORE_LIB) $(CLASSIC_LIB) "$(DESTDIR)$(LIBDIR)"
	install -d "$(DESTDIR)$(LIBDIR)/grobo/static"
	$(foreach file,$(notdir $(STATIC_LIB) $(CLASSIC_LIB)),$(install_static))
	$(if $(SHARED_LIB),$(install_shared))
	$(if $(CLASSIC_SHARED),install -m 755 $(CLASSIC_SHARED) "$(DESTDIR)$(LIBDIR)")
	$(if $(CLASSIC_SHARED),ln -sf $(CLASSIC_SONAME) "$(DESTDIR)$(LIBDIR)/$(CLASSIC_LINK_NAME)")
	install -m 644 $(PC_FILES) "$(DESTDIR)$(LIBDIR)/pkgconfig"
	install -m 644 $(CMAKE_FILES) "$(DESTDIR)$(LIBDIR)/cmake/grobo"

# Guides and examples; those of firmware need a board, and are in the sources.
DOCDIR ?= $(DATADIR)/doc/grobo
DOC_FOLDERS := docs docs/guide docs/examples docs/examples/classic docs/examples/robots motions/plots
define install_documents
install -m 644 $(wildcard $(folder)/*.*) "$(DESTDIR)$(DOCDIR)/$(folder)"

endef

install: all install-lib $(JSON_PAGE) ## into $(DESTDIR)$(PREFIX)
	install -d "$(DESTDIR)$(BINDIR)"
	$(if $(GRCTL),install -m 755 $(GRCTL) "$(DESTDIR)$(BINDIR)")
	$(if $(BESIDE),install -d "$(DESTDIR)$(PREFIX)/libexec/grctl")
	$(if $(BESIDE),install -m 755 $(BESIDE) "$(DESTDIR)$(PREFIX)/libexec/grctl")
	$(if $(GRCTL_HERE),$(foreach page,$(PAGES),$(install_page)))
	install -d "$(DESTDIR)$(DATADIR)/man/man5" "$(DESTDIR)$(DATADIR)/grobo/udev" "$(DESTDIR)$(DATADIR)/grobo/systemd" \
	    "$(DESTDIR)$(DATADIR)/grobo/wireshark"
	install -m 644 $(JSON_PAGE) "$(DESTDIR)$(DATADIR)/man/man5"
	install -m 644 docs/grctl.schema.json docs/robot.schema.json docs/serve.openapi.json docs/serve-fleet.openapi.json docs/fleet.schema.json "$(DESTDIR)$(DATADIR)/grobo"
	install -m 644 tools/systemd/grctl-agent@.service "$(DESTDIR)$(DATADIR)/grobo/systemd"
	install -m 644 tools/udev/60-grobo.rules "$(DESTDIR)$(DATADIR)/grobo/udev"
	install -m 644 tools/wireshark/grobo.lua "$(DESTDIR)$(DATADIR)/grobo/wireshark"
	install -d $(foreach folder,$(DOC_FOLDERS),"$(DESTDIR)$(DOCDIR)/$(folder)") "$(DESTDIR)$(DATADIR)/grobo/motions"
	install -m 644 $(filter-out %/README.md,$(wildcard motions/*.*)) "$(DESTDIR)$(DATADIR)/grobo/motions"
	$(foreach folder,$(DOC_FOLDERS),$(install_documents))
	install -m 644 README.md CHANGELOG.md LICENSE "$(DESTDIR)$(DOCDIR)"

uninstall: ## take out what install put in
	rm -rf "$(DESTDIR)$(INCLUDEDIR)/grobo" "$(DESTDIR)$(LIBDIR)/cmake/grobo" "$(DESTDIR)$(LIBDIR)/grobo"
	rm -f $(foreach file,libgrobo.a libgrobo-core.a libgrobo-classic.a $(CLASSIC_LINK_NAME) $(CLASSIC_SONAME) $(LINK_NAME) $(SONAME) $(IMPORT_LIB) \
	    $(patsubst $(BUILD)/%,pkgconfig/%,$(PC_FILES)),"$(DESTDIR)$(LIBDIR)/$(file)")
	rm -rf "$(DESTDIR)$(PREFIX)/libexec/grctl"
	rm -f $(foreach file,grctl$(EXE) $(if $(IMPORT_LIB),$(SONAME)),"$(DESTDIR)$(BINDIR)/$(file)")
	rm -f $(foreach page,$(PAGES),"$(DESTDIR)$(DATADIR)/$(firstword $(subst =, ,$(page)))")
	rm -f "$(DESTDIR)$(DATADIR)/man/man5/grctl-json.5"
	rm -rf "$(DESTDIR)$(DATADIR)/grobo" "$(DESTDIR)$(DOCDIR)"

# tools/package has build files for programs that take the source along; this is what they ask for.
sources: ## version, flags and files of the libraries, for other build systems
	@printf '%s\n' 'version=$(VERSION)' 'soname=$(SONAME)' 'flags=$(OS_FLAGS)' 'libs=$(OS_LIBS)' \
	    'guard=$(BINDIR)/grctl' 'core=$(CORE_SRCS)' 'other=$(OTHER_SRCS)' 'classic=$(CLASSIC_SRCS)'

clean: ## remove $(BUILD)
	rm -rf $(BUILD)$(if $(SPACED), "$(SPACED)")

# ---- rules ---------------------------------------------------------------------------------

# keep TEXT: a recipe that writes it to the target where it is not there yet.
quote = '$(subst ','\'',$(1))'
keep = @mkdir -p $(@D); printf '%s\n' $(1) >$@.new; \
    if cmp -s $@.new $@; then rm $@.new; else mv $@.new $@; fi

# Objects depend on the compiler and the flags they were built with; `make install` reads them.
$(BUILD)/.flags: FORCE
	$(call keep,$(call quote,$(ALL_CPPFLAGS) $(ALL_CFLAGS) $(SRC_CFLAGS) $(ALL_LDFLAGS)) \
	    $(foreach v,$(REMEMBERED),$(call quote,$(v) = $($(v)))))

# $(call compile,FOLDER,VARIABLE...): how the files of a folder are compiled.
define compile
$(BUILD)/$(1)/%.o: $(1)/%.c $(BUILD)/.flags
	$$(say) CC $$<
	@mkdir -p $$(@D)
	$$(Q)$$(CC) $$(ALL_CPPFLAGS) $(foreach v,$(2),$$($(v))) $$(ALL_CFLAGS) \
	    $(if $(filter src src/%,$(1)),$$(SRC_CFLAGS)) -MMD -MP -c -o $$@ $$<
endef

# Where an interface has two sides (Windows), the library is one and who links it whole the other.
SRC_INCLUDE := -I. -DGROBO_BUILDING
WHOLE := -DGROBO_STATIC
TOOL_INCLUDE := -I. $(WHOLE)
TEST_INCLUDE := -I. $(WHOLE)
# COVERAGE=yes counts the lines of the library and the command, not those of tests. Threads count at
# the same time where there are threads; the core is several times slower with counters for these.
# A process that is about to become another program counts no more: it would say on standard error
# where it cannot.
COVERAGE ?=
COUNTED := $(BUILD)/tests/support/counted.o
NO_COUNT_AT_EXEC := $(patsubst %,-fno-builtin-%,execl execle execlp execv execve execvp)
ifneq ($(COVERAGE),)
$(BUILD)/src/% $(BUILD)/tools/%: private override COV_FLAGS := --coverage $(NO_COUNT_AT_EXEC)
$(BUILD)/src/link/% $(BUILD)/ports/%: private override COV_FLAGS := --coverage $(NO_COUNT_AT_EXEC) \
    -fprofile-update=atomic
$(STATIC_LIB): | $(COUNTED)
endif
$(eval $(call compile,src,SRC_INCLUDE))
$(eval $(call compile,src/motion,SRC_INCLUDE YAML_CFLAGS))
$(eval $(call compile,src/robots/file,SRC_INCLUDE YAML_CFLAGS))
$(eval $(call compile,src/link,SRC_INCLUDE OS_FLAGS EVENT_CFLAGS))
$(eval $(call compile,src/classic,TOOL_INCLUDE))
$(eval $(call compile,ports/common,SRC_INCLUDE))
$(eval $(call compile,ports/$(PORT),SRC_INCLUDE OS_FLAGS))
$(eval $(call compile,tools/robots,TOOL_INCLUDE))
$(eval $(call compile,tools/servos,TOOL_INCLUDE YAML_CFLAGS))
$(eval $(call compile,tools/picture,TOOL_INCLUDE))
$(eval $(call compile,tools/grctl,TOOL_INCLUDE OS_FLAGS EVENT_CFLAGS YAML_CFLAGS JSON_CFLAGS EDIT_CFLAGS SCREEN_CFLAGS XML_CFLAGS))
$(eval $(call compile,docs/examples,WHOLE OS_FLAGS EVENT_CFLAGS))
$(eval $(call compile,tests,TEST_INCLUDE OS_FLAGS EVENT_CFLAGS YAML_CFLAGS CMOCKA_CFLAGS JSON_CFLAGS))

# The page of the cockpit, inside the command.
PAGE_FILES := $(wildcard tools/grctl/web/page/* tools/grctl/web/page/*/*)
$(BUILD)/tools/grctl/web/page_files.c: tools/grctl/web/embed.sh $(PAGE_FILES)
	@mkdir -p $(@D)
	@tools/grctl/web/embed.sh tools/grctl/web/page >$@
$(BUILD)/%.c: %.po tools/grctl/lang/po.awk
	@mkdir -p $(@D)
	@LC_ALL=C awk -f tools/grctl/lang/po.awk $< >$@
$(PAGE_OBJ) $(CATALOGUES:%.po=$(BUILD)/%.o): %.o: %.c $(BUILD)/.flags
	$(say) CC $<
	$(Q)$(CC) $(ALL_CPPFLAGS) $(TOOL_INCLUDE) $(ALL_CFLAGS) -MMD -MP -c -o $@ $<

$(STATIC_LIB): $(LIB_OBJS)
$(CORE_LIB): $(CORE_OBJS)
$(CLASSIC_LIB): $(CLASSIC_OBJS)
$(SUPPORT_LIB): $(SUPPORT_OBJS)
# The command without its main: tests link parts of it.
BESIDE_OBJS := $(call objects,$(patsubst %,tools/grctl/%.c,broker_main web/run fleet/run_agent fleet/run_fleet))
$(TOOL_LIB): $(filter-out %/main.o $(BESIDE_OBJS),$(TOOL_OBJS))
$(STATIC_LIB) $(CORE_LIB) $(CLASSIC_LIB) $(SUPPORT_LIB) $(TOOL_LIB): $(BUILD)/.flags
	$(say) AR $@
	@rm -f $@
	$(Q)$(AR) rcs $@ $(filter %.o,$^)

# The library knows where the command is installed, which is its guard's program.
$(BUILD)/ports/posix/guard.o: override CPPFLAGS += -DGROBO_GUARD_PROGRAM='"$(BINDIR)/grctl"'
$(BUILD)/ports/posix/guard.o: $(BUILD)/.bindir
$(BUILD)/.bindir: FORCE
	$(call keep,$(call quote,$(BINDIR)))

# Tests whose time is virtual, where the C library lets them (tests/support/virtual_clock.h).
HOST := $(if $(CROSS),,$(shell $(CC) -dumpmachine 2>/dev/null))
ifneq ($(filter %linux-gnu,$(filter x86_64-% aarch64-% riscv64-%,$(HOST))),)
$(patsubst %,$(BUILD)/tests/link/test_classic_%.o,frames kept null whole): override CPPFLAGS += -DGROBO_VIRTUAL_CLOCK
endif

# The command knows where its files are installed.
$(BUILD)/tools/grctl/os/posix/node.o: override CPPFLAGS += -DGRCTL_DATADIR='"$(DATADIR)"'
$(BUILD)/tools/grctl/os/posix/node.o: $(BUILD)/.datadir
$(BUILD)/.datadir: FORCE
	$(call keep,$(call quote,$(DATADIR)))

$(SHARED_LIB): $(LIB_OBJS) src/libgrobo.map
	$(say) LD $@
	$(Q)$(CC) -shared $(SHARED_FLAGS) $(ALL_LDFLAGS) -o $@ $(LIB_OBJS) $(LIBS)
	$(if $(IMPORT_LIB),,@ln -sf $(SONAME) $(BUILD)/$(LINK_NAME))

# It is linked with the shared library as any program is.
$(CLASSIC_SHARED): $(CLASSIC_OBJS) $(SHARED_LIB)
	$(say) LD $@
	$(Q)$(CC) -shared $(subst $(SONAME),$(CLASSIC_SONAME),$(filter-out %.map,$(SHARED_FLAGS))) $(ALL_LDFLAGS) -o $@ $(CLASSIC_OBJS) $(SHARED_LIB) $(OS_LIBS)
	@ln -sf $(CLASSIC_SONAME) $(BUILD)/$(CLASSIC_LINK_NAME)

$(BUILD)/grctl$(EXE): $(if $(WHOLE_GRCTL),$(BESIDE_OBJS),$(BUILD)/tools/grctl/main.o) $(TOOL_LIB) $(STATIC_LIB)
	$(say) LD $@
	$(Q)$(CC) $(ALL_LDFLAGS) -o $@ $^ $(if $(WHOLE_GRCTL),$(TOOL_LIBS),$(BASE_LIBS)) $(LIBS)

# What the archive has for grctl in their place (beside.c) is not taken: their objects come first.
$(BUILD)/grctl-serve$(EXE): $(filter %/broker_main.o %/web/run.o,$(BESIDE_OBJS))
$(BUILD)/grctl-fleet$(EXE): $(filter %/broker_main.o %/run_agent.o %/run_fleet.o,$(BESIDE_OBJS))
$(BESIDE): $(TOOL_LIB) $(STATIC_LIB)
	$(say) LD $@
	$(Q)$(CC) $(ALL_LDFLAGS) -o $@ $(filter %.o,$^) $(TOOL_LIB) $(STATIC_LIB) $(TOOL_LIBS) $(LIBS)

# Of the reader alone: it makes the tables that the library has.
$(ROBOTS): $(BUILD)/tools/robots/main.o $(STATIC_LIB)
$(SERVOS): $(BUILD)/tools/servos/main.o $(STATIC_LIB)
$(PICTURE): $(BUILD)/tools/picture/main.o $(STATIC_LIB)
$(ROBOTS) $(SERVOS) $(PICTURE):
	$(say) LD $@
	$(Q)$(CC) $(ALL_LDFLAGS) -o $@ $^ $(LIBS)

# With none of the libraries that it can do without: tests/export/optional.sh.
$(BARE): $(BESIDE_OBJS) $(call objects,$(patsubst %,tools/grctl/%.c,term/plain term/no_screen robot/no_xml fleet/no_mqtt web/none)) \
    $(TOOL_LIB) $(STATIC_LIB)
	$(say) LD $@
	@mkdir -p $(@D)
	$(Q)$(CC) $(ALL_LDFLAGS) -o $@ $^ $(JSON_LIBS) $(LIBS)

$(BUILD)/run/grctl: $(GRCTL)
	@mkdir -p $(@D)
	@printf '#!/bin/sh\nexec %s "$$@"\n' '$(EMULATOR) $(abspath $<)' >$@
	@chmod +x $@

$(sort $(TEST_PROGRAMS) $(DRIVER_PROGRAMS)): $(BUILD)/%$(EXE): $(BUILD)/%.o $(SUPPORT_LIB) $(TOOL_LIB) $(CLASSIC_LIB) $(STATIC_LIB)
	$(say) LD $@
	$(Q)$(CC) $(ALL_LDFLAGS) -o $@ $^ $(CMOCKA_LIBS) $(TOOL_LIBS) $(LIBS)

# One looks at an engine in front of the far side of tests/support.
FUZZ_ENGINE := $(BUILD)/tests/fuzz/fuzz_replies$(EXE) $(BUILD)/tests/fuzz/fuzz_replies.fuzzer
$(FUZZ_ENGINE): $(SUPPORT_LIB)
$(FUZZ_ENGINE): FUZZ_LIBS = $(SUPPORT_LIB) $(STATIC_LIB) $(CMOCKA_LIBS)

$(FUZZ_REPLAYS): $(BUILD)/%$(EXE): $(BUILD)/%.o $(BUILD)/tests/support/replay_main.o $(TOOL_LIB) \
    $(STATIC_LIB)
	$(say) LD $@
	$(Q)$(CC) $(ALL_LDFLAGS) -o $@ $(filter-out $(SUPPORT_LIB),$^) $(FUZZ_LIBS) $(TOOL_LIBS) $(LIBS)

$(FUZZERS): %.fuzzer: %.o $(TOOL_LIB) $(STATIC_LIB)
	$(say) LD $@
	$(Q)$(CC) $(ALL_LDFLAGS) -fsanitize=fuzzer -o $@ $(filter-out $(SUPPORT_LIB),$^) $(FUZZ_LIBS) $(TOOL_LIBS) $(LIBS)

$(EXAMPLES): $(BUILD)/%$(EXE): $(BUILD)/%.o $(CLASSIC_LIB) $(STATIC_LIB)
$(BENCHES): $(BUILD)/%$(EXE): $(BUILD)/%.o $(SUPPORT_LIB) $(STATIC_LIB)
$(PLANT_PIPE): $(BUILD)/%$(EXE): $(BUILD)/%.o $(STATIC_LIB)
$(EXAMPLES) $(BENCHES) $(PLANT_PIPE):
	$(say) LD $@
	$(Q)$(CC) $(ALL_LDFLAGS) -o $@ $^ $(LIBS)

# A tree that is moved as a whole keeps working: below PREFIX all is relative to grobo.pc.
empty :=
up := $(empty) $(empty)
from_pc = $(subst $(up),,$(foreach part,$(subst /, ,$(LIBDIR:$(PREFIX)/%=%) pkgconfig),/..))
pc_prefix = $(if $(filter $(PREFIX)/%,$(LIBDIR)),$${pcfiledir}$(from_pc),$(PREFIX))
pc_path = $(patsubst $(PREFIX)/%,$${prefix}/%,$(1))
# $(call pkg_config,DESCRIPTION,CFLAGS,LIBRARY,LINES): the lines of the file that is the target.
pkg_config = 'prefix=$(pc_prefix)' 'libdir=$(call pc_path,$(LIBDIR))' \
    'includedir=$(call pc_path,$(INCLUDEDIR))' '' 'Name: $(basename $(@F))' 'Description: $(1)' \
    'Version: $(VERSION)' 'Cflags: -I$${includedir}$(2)' 'Libs: $(3)' $(4)
# With --static the directory that has static libraries alone is searched first: a linker takes the
# shared library where both lie side by side. So the other directory comes from a file of its own.
$(BUILD)/grobo.pc: FORCE
	$(call keep,$(call pkg_config,Drives serial command-servo robots,,-lgrobo,'Cflags.private: $(WHOLE)' \
	    'Requires: grobo-path' 'Requires.private: libevent_core yaml-0.1' \
	    'Libs.private: -L$${libdir}/grobo/static $(OS_LIBS)'))
$(BUILD)/grobo-path.pc: FORCE
	$(call keep,$(call pkg_config,Where libraries of grobo are,,-L$${libdir}))
$(BUILD)/grobo-classic.pc: FORCE
	$(call keep,$(call pkg_config,The classes of the original GROBO library in C,,-lgrobo-classic,'Requires: grobo'))
$(BUILD)/grobo-core.pc: FORCE
	$(call keep,$(call pkg_config,The engine of grobo for loops and firmware of your own, $(WHOLE),-L$${libdir} -lgrobo-core -lm))

# Its files are found from where it lies itself.
up_from = $(if $(filter $(PREFIX)/%,$(2)),$${grobo_libdir}$(subst $(up),,$(foreach part,$(subst /, \
    ,$(1:$(PREFIX)/%=%)),/..))/$(2:$(PREFIX)/%=%),$(2))
$(BUILD)/cmake/grobo-%.cmake: tools/package/grobo-%.cmake.in FORCE
	$(call keep,"$$(sed -e 's|@VERSION@|$(VERSION)|' -e 's|@INCLUDEDIR@|$(call up_from,$(LIBDIR),$(INCLUDEDIR))|' $<)")

-include $(shell find $(addprefix $(BUILD)/,src ports tools tests docs bare) -name '*.d' 2>/dev/null)
