/* SPDX-License-Identifier: MIT */
/* Linux: the driver switches an RS-485 line's transmitter by RTS. Other systems cannot. */
#include <errno.h>

#include "ports/posix/posix.h"

#ifdef __linux__
#include <linux/serial.h>
#include <sys/ioctl.h>
#endif

#if defined(TIOCSRS485) && defined(SER_RS485_ENABLED)

int grobo_i_posix_set_rs485(int fd, grobo_os_cause *cause)
{
    struct serial_rs485 rs485 = {.flags = SER_RS485_ENABLED | SER_RS485_RTS_ON_SEND};

    if (ioctl(fd, TIOCSRS485, &rs485) == 0) {
        return GROBO_OK;
    }
    if (errno == EIO || errno == ENXIO) {
        return grobo_i_posix_fail(cause, errno, "TIOCSRS485");
    }
    return grobo_i_port_refuse(cause, GROBO_ERR_UNSUPPORTED,
                               "its driver does not switch an RS-485 line");
}

#else

int grobo_i_posix_set_rs485(int fd, grobo_os_cause *cause)
{
    (void)fd;
    return grobo_i_port_refuse(cause, GROBO_ERR_UNSUPPORTED, "no RS-485 control here");
}

#endif
