/* SPDX-License-Identifier: MIT */
/*
 * Linux: any speed, by termios2. In a file of its own because the kernel's header of termios2
 * and the C library's <termios.h> cannot be included together. And the speed that a chip makes of
 * it. The other systems' answers are at the end of each part.
 */
#include <errno.h>

#include "ports/posix/posix.h"

#ifdef __linux__
#include <asm/ioctls.h>
#include <asm/termbits.h>
#include <linux/serial.h>
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

#ifdef __linux__

/* The driver tells a PC's UART the whole number next to base / speed, and says that it set the
 * speed. Chips on other buses may divide by fractions: those are believed. */
int grobo_i_posix_divided_baud(int fd, int baud_bps)
{
    struct serial_struct chip;
    int divisor;

    if (ioctl(fd, TIOCGSERIAL, &chip) != 0 || chip.type < PORT_8250 || chip.type > PORT_16550A ||
        chip.io_type != SERIAL_IO_PORT || chip.baud_base <= 0 || baud_bps <= 0) {
        return baud_bps;
    }
    divisor = (chip.baud_base + baud_bps / 2) / baud_bps;
    return divisor > 0 ? chip.baud_base / divisor : chip.baud_base;
}

#else

int grobo_i_posix_divided_baud(int fd, int baud_bps)
{
    (void)fd;
    return baud_bps;
}

#endif
