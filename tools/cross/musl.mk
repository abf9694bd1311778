# SPDX-License-Identifier: MIT
# This machine's processor.

include tools/cross/static.mk
