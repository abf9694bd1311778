/* SPDX-License-Identifier: MIT */
/* What a form of bytes does to a terminal, by termios; and RS-485 where the driver has none. */
#include <termios.h>

#include "ports/posix/posix.h"
#include "tests/support/test.h"

TEST(stop_bits_and_parity_reach_the_terminal)
{
    const grobo_port_ops *serial = grobo_port_serial_ops();
    const grobo_port_ops *pty = grobo_port_pty_ops();
    grobo_line_format format = {.stop_bits = 2};
    grobo_port far, near;
    grobo_os_cause cause;
    struct termios tio;
    char path[64];

    assert_int_equal(pty->open(&far, "", 1000000, &cause), GROBO_OK);
    assert_int_equal(grobo_port_pty_path(&far, path, sizeof path), GROBO_OK);
    assert_int_equal(serial->open(&near, path, 3000000, &cause), GROBO_OK);
    assert_int_equal(serial->set_format(&near, &format, &cause), GROBO_OK);
    assert_int_equal(tcgetattr(near.fd, &tio), 0);
    assert_true((tio.c_cflag & CSTOPB) != 0);
    assert_true((tio.c_cflag & CSIZE) == CS8);
    format = (grobo_line_format){.parity = GROBO_PARITY_EVEN};
    assert_int_equal(serial->set_format(&near, &format, &cause), GROBO_OK);
    assert_int_equal(tcgetattr(near.fd, &tio), 0);
    assert_true((tio.c_cflag & CSTOPB) == 0);
    assert_true((tio.c_iflag & (INPCK | IGNPAR)) == (INPCK | IGNPAR));
    assert_int_equal(serial->set_baud(&near, 1250000, &cause), 1250000); /* ICS */
    assert_int_equal(serial->set_baud(&near, 4000000, &cause), 4000000);
    format.rs485 = true;
    assert_int_equal(serial->set_format(&near, &format, &cause), GROBO_ERR_UNSUPPORTED);
    serial->close(&near);
    pty->close(&far);
}
