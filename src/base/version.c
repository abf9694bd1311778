/* SPDX-License-Identifier: MIT */
#include <grobo/version.h>

const char *grobo_version(void)
{
    return GROBO_VERSION_STRING;
}
