/* SPDX-License-Identifier: MIT */
/* A stranger's program, C11 and C++11 alike: it knows the installed headers and the library. */
#include <stdio.h>
#include <string.h>

#include <grobo/error.h>
#include <grobo/version.h>

int main(void)
{
    if (strcmp(grobo_version(), GROBO_VERSION_STRING) != 0 ||
        grobo_version_number() != GROBO_VERSION_NUMBER) {
        fprintf(stderr, "headers are %s, library is %s\n", GROBO_VERSION_STRING, grobo_version());
        return 1;
    }
    puts(grobo_error_text(GROBO_ERR_TIMEOUT));
    return 0;
}
