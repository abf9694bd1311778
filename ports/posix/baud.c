/* SPDX-License-Identifier: MIT */
/* Speeds that have a B constant; the others are the business of baud_linux.c. */
#include <errno.h>
#include <termios.h>

#include "ports/posix/posix.h"

typedef struct {
    int bps;
    speed_t code;
} rate;

/* POSIX demands the first few; the rest where the system has them. */
static const rate rates[] = {
    {50, B50},           {75, B75},     {110, B110},   {134, B134},     {150, B150},
    {200, B200},         {300, B300},   {600, B600},   {1200, B1200},   {1800, B1800},
    {2400, B2400},       {4800, B4800}, {9600, B9600}, {19200, B19200}, {38400, B38400},
#ifdef B57600
    {57600, B57600},
#endif
#ifdef B115200
    {115200, B115200},
#endif
#ifdef B230400
    {230400, B230400},
#endif
#ifdef B460800
    {460800, B460800},
#endif
#ifdef B500000
    {500000, B500000},
#endif
#ifdef B576000
    {576000, B576000},
#endif
#ifdef B921600
    {921600, B921600},
#endif
#ifdef B1000000
    {1000000, B1000000},
#endif
#ifdef B1152000
    {1152000, B1152000},
#endif
#ifdef B1500000
    {1500000, B1500000},
#endif
#ifdef B2000000
    {2000000, B2000000},
#endif
#ifdef B2500000
    {2500000, B2500000},
#endif
#ifdef B3000000
    {3000000, B3000000},
#endif
#ifdef B3500000
    {3500000, B3500000},
#endif
#ifdef B4000000
    {4000000, B4000000},
#endif
};

static const rate *rate_of_bps(int bps)
{
    for (size_t i = 0; i < sizeof rates / sizeof rates[0]; i++) {
        if (rates[i].bps == bps) {
            return &rates[i];
        }
    }
    return NULL;
}

static int apply(int fd, int baud_bps, grobo_os_cause *cause)
{
    const rate *standard = rate_of_bps(baud_bps);
    struct termios tio;

    if (standard == NULL) {
        return grobo_i_posix_set_custom_baud(fd, baud_bps, cause);
    }
    if (tcgetattr(fd, &tio) != 0) {
        return grobo_i_posix_fail(cause, errno, "tcgetattr");
    }
    /* A build by headers of glibc 2.42 or later: their constants are refused by an older one. */
    if (cfsetispeed(&tio, standard->code) != 0 || cfsetospeed(&tio, standard->code) != 0) {
        return grobo_i_posix_set_custom_baud(fd, baud_bps, cause);
    }
    return tcsetattr(fd, TCSANOW, &tio) == 0 ? GROBO_OK
                                             : grobo_i_posix_fail(cause, errno, "set speed");
}

int grobo_i_posix_get_baud(int fd, grobo_os_cause *cause)
{
    struct termios tio;
    speed_t code;

    if (tcgetattr(fd, &tio) != 0) {
        return grobo_i_posix_fail(cause, errno, "tcgetattr");
    }
    code = cfgetospeed(&tio);
    for (size_t i = 0; i < sizeof rates / sizeof rates[0]; i++) {
        if (rates[i].code == code) {
            return rates[i].bps;
        }
    }
    return grobo_i_posix_custom_baud(fd);
}

int grobo_i_posix_set_baud(int fd, int baud_bps, grobo_os_cause *cause)
{
    int before = grobo_i_posix_get_baud(fd, cause);
    int r = before < 0 ? before : apply(fd, baud_bps, cause);

    if (r < 0) {
        return r;
    }
    r = grobo_i_posix_get_baud(fd, cause);
    if (r > 0) {
        r = grobo_i_posix_divided_baud(fd, r);
    }
    if (r >= 0) {
        r = grobo_i_port_check_baud(baud_bps, r, cause);
        if (r < 0) {
            grobo_os_cause ignored;

            (void)apply(fd, before, &ignored);
        }
    }
    return r;
}
