/* SPDX-License-Identifier: MIT */
/* Linux: the low-latency flag of a serial driver. The other systems' answer is at the end. */
#include <errno.h>

#include "ports/posix/posix.h"

#ifdef __linux__

#include <linux/serial.h>
#include <sys/ioctl.h>

/* Drivers have three ways to say that they know no such thing. */
static int fail(grobo_os_cause *cause, int code, const char *what)
{
    int r = grobo_i_posix_fail(cause, code, what);

    return code == ENOTTY || code == EINVAL || code == EOPNOTSUPP ? GROBO_ERR_UNSUPPORTED : r;
}

int grobo_i_posix_set_low_latency(int fd, grobo_os_cause *cause)
{
    struct serial_struct serial;

    if (ioctl(fd, TIOCGSERIAL, &serial) != 0) {
        return fail(cause, errno, "TIOCGSERIAL");
    }
    if ((serial.flags & (int)ASYNC_LOW_LATENCY) != 0) {
        return GROBO_OK;
    }
    serial.flags |= (int)ASYNC_LOW_LATENCY;
    return ioctl(fd, TIOCSSERIAL, &serial) == 0 ? GROBO_OK : fail(cause, errno, "TIOCSSERIAL");
}

#else

int grobo_i_posix_set_low_latency(int fd, grobo_os_cause *cause)
{
    (void)fd;
    return grobo_i_port_refuse(cause, GROBO_ERR_UNSUPPORTED, "not known on this system");
}

#endif
