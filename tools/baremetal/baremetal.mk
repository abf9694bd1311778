# SPDX-License-Identifier: MIT
# The core for a Cortex-M0 and a Cortex-M4: `make firmware`, `make size`, `make check-firmware`.

BARE_PREFIX ?= arm-none-eabi-
BARE_CPUS := cortex-m0 cortex-m4
# The longest frame of RS30x.
BARE_FRAME := -DGROBO_FRAME_MAX_BYTES=148 -DGROBO_ROBOT_SLOTS=12 -DGROBO_SIM_INDIRECTS=1 -DGROBO_TABLES_FIXED=1 \
    -DGROBO_SIM_REGISTER_BYTES=160 -DGROBO_SIM_BACKUP_BYTES=1
# The caps of limits.h for a robot of 20 RS30x servos.
BARE_CAPS ?= $(BARE_FRAME) -DGROBO_JOINTS_MAX=20 -DGROBO_DRIVERS_PLAIN=1 -DGROBO_QUEUE_MAX=2 -DGROBO_SIM_WIRE_BYTES=256 \
    -DGROBO_SIM_FIFO_BYTES=256 -DGROBO_SIM_TALK_BYTES=148 -DGROBO_SIM_TALKS_MAX=12
# An assertion would bring the C library's way of printing it.
BARE_FLAGS := -std=c11 -DNDEBUG $(WARNINGS) -mthumb -Os -ffunction-sections -fdata-sections -fstack-usage \
    -Iinclude -I.
# What is measured: each processor with these caps, and the smallest with those of limits.h but for
# the frame.
BARE_SIZES := $(BARE_CPUS) cortex-m0-default
BARE_DIR := $(BUILD)/bare
FIRMWARE_DIR := docs/examples/firmware
FIRMWARES := $(foreach cpu,$(BARE_CPUS),$(BARE_DIR)/$(cpu)/gr001.elf $(BARE_DIR)/$(cpu)/player.elf)
PUMPS := $(BARE_CPUS:%=$(BARE_DIR)/%/pump.elf)
BARE_LIBS := $(BARE_SIZES:%=$(BARE_DIR)/%/libgrobo-core.a)
BARE_RAM := $(BARE_SIZES:%=$(BARE_DIR)/%/tools/baremetal/ram.o)

.SECONDARY: $(foreach cpu,$(BARE_CPUS),$(patsubst %.c,$(BARE_DIR)/$(cpu)/%.o,$(wildcard $(FIRMWARE_DIR)/*.c)))

# $(call bare,FOLDER,CPU,CAPS)
define bare
$(BARE_DIR)/$(1)/%.o: %.c tools/baremetal/baremetal.mk
	$$(say) CC '$$< ($(1))'
	@mkdir -p $$(@D)
	$$(Q)$(BARE_PREFIX)gcc -mcpu=$(2) $$(BARE_FLAGS) $(3) -MMD -MP -c -o $$@ $$<

$(BARE_DIR)/$(1)/libgrobo-core.a: $(CORE_SRCS:%.c=$(BARE_DIR)/$(1)/%.o)
	$$(say) AR $$@
	@rm -f $$@
	$$(Q)$(BARE_PREFIX)ar rcs $$@ $$^

$(BARE_DIR)/$(1)/%.elf: $(BARE_DIR)/$(1)/$(FIRMWARE_DIR)/%.o \
    $(BARE_DIR)/$(1)/$(FIRMWARE_DIR)/mps2.o $(BARE_DIR)/$(1)/libgrobo-core.a $(FIRMWARE_DIR)/mps2.ld
	$$(say) LD $$@
	$$(Q)$(BARE_PREFIX)gcc -mcpu=$(2) -mthumb --specs=nano.specs -nostartfiles -Wl,--gc-sections \
	    -Wl,-Map=$$(@:.elf=.map) -T $(FIRMWARE_DIR)/mps2.ld -o $$@ $$(filter %.o %.a,$$^) -lm

# The engine and a simulated robot in one: more than a small microcontroller has room for.
$(BARE_DIR)/$(1)/pump.elf: $(BARE_DIR)/$(1)/tests/bench/pump.o \
    $(BARE_DIR)/$(1)/$(FIRMWARE_DIR)/mps2.o $(BARE_DIR)/$(1)/libgrobo-core.a $(FIRMWARE_DIR)/mps2.ld
	$$(say) LD $$@
	@sed 's/LENGTH = .*/LENGTH = 1M/; s/^stack_bytes = .*/stack_bytes = 64K;/' \
	    $(FIRMWARE_DIR)/mps2.ld >$$(@D)/pump.ld
	$$(Q)$(BARE_PREFIX)gcc -mcpu=$(2) -mthumb --specs=nano.specs -nostartfiles -Wl,--gc-sections \
	    -T $$(@D)/pump.ld -o $$@ $$(filter %.o %.a,$$^) -lm
endef
$(foreach cpu,$(BARE_CPUS),$(eval $(call bare,$(cpu),$(cpu),$(BARE_CAPS))))
$(eval $(call bare,cortex-m0-default,cortex-m0,$(BARE_FRAME)))
