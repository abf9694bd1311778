/* SPDX-License-Identifier: MIT */
/*
 * Rates with headers of glibc 2.42 and later before an older one: there B9600 is the number 9600,
 * which the older cfsetispeed() refuses. So zig builds the wheel.
 */
#include <fcntl.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#undef B9600
#undef B115200
#undef B1000000
#define B9600 9600
#define B115200 115200
#define B1000000 1000000

#include "ports/posix/baud.c"
#include "tests/support/test.h"

TEST(a_rate_is_set_where_headers_and_library_name_it_otherwise)
{
    static const int bps[] = {9600, 115200, 1000000, 19200, 1250000, 115200};
    grobo_os_cause cause;
    int master = posix_openpt(O_RDWR | O_NOCTTY);
    assert_true(master >= 0);
    assert_int_equal(grantpt(master), 0);
    assert_int_equal(unlockpt(master), 0);
    int fd = open(ptsname(master), O_RDWR | O_NOCTTY);
    assert_true(fd >= 0);
    for (size_t i = 0; i < sizeof bps / sizeof bps[0]; i++) {
        assert_true(grobo_i_posix_set_baud(fd, bps[i], &cause) >= 0);
        assert_int_equal(grobo_i_posix_get_baud(fd, &cause), bps[i]);
    }
    close(fd);
    close(master);
}
