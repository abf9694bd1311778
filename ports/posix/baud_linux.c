/* SPDX-License-Identifier: MIT */
/*
 * Linux: any speed, by termios2. In a file of its own because the kernel's header of termios2
 * and the C library's <termios.h> cannot be included together. The other systems' answer is at
 * the end.
 */
#include <errno.h>

#include "ports/posix/posix.h"

#ifdef __linux__
#include <asm/ioctls.h>
#include <asm/termbits.h>
#include <sys/ioctl.h>
#endif

#if defined(TCGETS2) && defined(BOTHER)

int grobo_i_posix_set_custom_baud(int fd, int baud_bps, grobo_os_cause *cause)
{
    struct termios2 tio;

    if (ioctl(fd, TCGETS2, &tio) != 0) {
        return grobo_i_posix_fail(cause, errno, "TCGETS2");
    }
    /* No input speed of its own (B0 in its bits): it is the output speed. */
    tio.c_cflag &= ~(tcflag_t)(CBAUD | CIBAUD);
    tio.c_cflag |= BOTHER;
    tio.c_ospeed = (speed_t)baud_bps;
    tio.c_ispeed = (speed_t)baud_bps;
    return ioctl(fd, TCSETS2, &tio) == 0 ? GROBO_OK : grobo_i_posix_fail(cause, errno, "TCSETS2");
}

int grobo_i_posix_custom_baud(int fd)
{
    struct termios2 tio;

    return ioctl(fd, TCGETS2, &tio) == 0 ? (int)tio.c_ospeed : 0;
}

#else

int grobo_i_posix_set_custom_baud(int fd, int baud_bps, grobo_os_cause *cause)
{
    (void)fd;
    (void)baud_bps;
    return grobo_i_port_refuse(cause, GROBO_ERR_UNSUPPORTED, "standard speeds only here");
}

int grobo_i_posix_custom_baud(int fd)
{
    (void)fd;
    return 0;
}

#endif
