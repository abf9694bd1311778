#!/bin/sh
# SPDX-License-Identifier: MIT
# The commands of the first hour, in English and Japanese, do what these say.
. tests/support/guide.sh

guides_work "the commands of the first hour" docs/guide/first-hour.md docs/README.ja.md \
    docs/guide/first-hour.ja.md
done_testing
