/* SPDX-License-Identifier: MIT */
/* Serial ports by termios. */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include "ports/common/guard.h"
#include "ports/posix/posix.h"

/* On the wire, with start, parity and stop bits. */
enum { BITS_A_BYTE = 12 };

#define GRACE_US INT64_C(100000)

static int refuse_busy(const char *device, grobo_os_cause *cause)
{
    char name[64];
    int pid = grobo_port_owner(device, name, sizeof name);

    return grobo_i_port_refuse_busy(cause, EBUSY, pid, name);
}

/* Looks before opening: to open something that is no terminal may have consequences. */
static int check_kind(const char *device, struct stat *st, grobo_os_cause *cause)
{
    if (stat(device, st) != 0) {
        return grobo_i_posix_fail(cause, errno, "stat");
    }
    if (S_ISDIR(st->st_mode)) {
        return grobo_i_port_refuse(cause, GROBO_ERR_ISDIR, "a directory");
    }
    if (!S_ISCHR(st->st_mode)) {
        return grobo_i_port_refuse(cause, GROBO_ERR_TYPE, "not a character device");
    }
    return GROBO_OK;
}

/* flock keeps out programs that ask for it, root's too; TIOCEXCL the others, but not root's. */
static int take(int fd, const struct stat *st, grobo_os_cause *cause)
{
    if (isatty(fd) == 0) {
        return errno == EIO ? grobo_i_posix_fail(cause, EIO, "isatty")
                            : grobo_i_port_refuse(cause, GROBO_ERR_TYPE, "not a serial port");
    }
    if (flock(fd, LOCK_EX | LOCK_NB) != 0) {
        return errno == EWOULDBLOCK ? GROBO_ERR_BUSY : grobo_i_posix_fail(cause, errno, "flock");
    }
    if (!grobo_i_posix_exclusive_sticks(st->st_rdev) && ioctl(fd, TIOCEXCL) != 0) {
        return grobo_i_posix_fail(cause, errno, "TIOCEXCL");
    }
    return GROBO_OK;
}

/*
 * The lock goes with the last descriptor of this opening, TIOCEXCL with the last one of the
 * terminal: a guard, or a process forked meanwhile, may still have one.
 */
static void let_others(int fd)
{
    (void)ioctl(fd, TIOCNXCL);
    (void)flock(fd, LOCK_UN);
}

int grobo_i_posix_make_raw(int fd, grobo_os_cause *cause)
{
    struct termios tio;

    if (tcgetattr(fd, &tio) != 0) {
        return grobo_i_posix_fail(cause, errno, "tcgetattr");
    }
    tio.c_iflag = IGNBRK;
    tio.c_oflag = 0;
    tio.c_lflag = 0;
    tio.c_cflag &= (tcflag_t) ~(CSIZE | CSTOPB | PARENB | CRTSCTS);
    tio.c_cflag |= CS8 | CREAD | CLOCAL;
    /* With O_NONBLOCK and VMIN 0 a read of nothing would look like a hang-up. */
    tio.c_cc[VMIN] = 1;
    tio.c_cc[VTIME] = 0;
    return tcsetattr(fd, TCSANOW, &tio) == 0 ? GROBO_OK
                                             : grobo_i_posix_fail(cause, errno, "tcsetattr");
}

static int serial_open(grobo_port *port, const char *device, int baud_bps, grobo_os_cause *cause)
{
    struct stat st;
    int fd;
    int r = check_kind(device, &st, cause);

    if (r < 0) {
        return r;
    }
    do {
        fd = open(device, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    } while (fd < 0 && errno == EINTR);
    if (fd < 0) {
        return errno == EBUSY ? refuse_busy(device, cause)
                              : grobo_i_posix_fail(cause, errno, "open");
    }
    r = take(fd, &st, cause);
    if (r < 0) {
        (void)close(fd);
        return r == GROBO_ERR_BUSY ? refuse_busy(device, cause) : r;
    }
    r = grobo_i_posix_make_raw(fd, cause);
    if (r >= 0) {
        r = grobo_i_posix_set_baud(fd, baud_bps, cause);
    }
    /* What came while nobody had it open is of no use to the one who opens it. */
    if (r >= 0 && tcflush(fd, TCIFLUSH) != 0) {
        r = grobo_i_posix_fail(cause, errno, "tcflush");
    }
    if (r < 0) {
        let_others(fd);
        (void)close(fd);
        return r;
    }
    port->fd = fd;
    port->abandoned = false;
    return GROBO_OK;
}

/*
 * close() waits until what was written has left: 30 s on a line that takes nothing. The bytes get
 * the time that they need, and GRACE_US; what is there then never leaves.
 */
static void let_leave(int fd)
{
    grobo_os_cause cause;
    int baud_bps = grobo_i_posix_get_baud(fd, &cause);
    int left = 0;
    int64_t end_us;

    if (baud_bps <= 0 || ioctl(fd, TIOCOUTQ, &left) != 0) {
        return;
    }
    end_us = grobo_now_us() + GRACE_US + (int64_t)left * BITS_A_BYTE * 1000000 / baud_bps;
    while (left > 0 && grobo_now_us() < end_us) {
        (void)poll(NULL, 0, 1);
        if (ioctl(fd, TIOCOUTQ, &left) != 0) {
            return;
        }
    }
    if (left > 0) {
        (void)tcflush(fd, TCOFLUSH);
    }
}

void grobo_i_port_lend(grobo_port *port)
{
    if (isatty(port->fd) == 1) {
        let_leave(port->fd);
        let_others(port->fd);
    }
}

int grobo_i_port_reclaim(grobo_port *port)
{
    struct stat st;
    grobo_os_cause cause;

    if (isatty(port->fd) != 1) {
        return GROBO_OK;
    }
    return fstat(port->fd, &st) == 0 ? take(port->fd, &st, &cause) : GROBO_ERR_IO;
}

static void serial_close(grobo_port *port)
{
    if (!port->abandoned) {
        let_leave(port->fd);
        let_others(port->fd);
    }
    grobo_i_posix_close(port);
}

static void serial_discard_output(grobo_port *port)
{
    (void)tcflush(port->fd, TCOFLUSH);
}

static int serial_set_baud(grobo_port *port, int baud_bps, grobo_os_cause *cause)
{
    return grobo_i_posix_set_baud(port->fd, baud_bps, cause);
}

/* True for the flags that were asked for, or where the device is none that could have them. */
static bool took(int fd, tcflag_t asked)
{
    const tcflag_t form = PARENB | PARODD | CSTOPB;
    struct termios tio;
    struct stat st;

    if (tcgetattr(fd, &tio) != 0 || fstat(fd, &st) != 0) {
        return false;
    }
    return (tio.c_cflag & form) == asked || grobo_i_posix_exclusive_sticks(st.st_rdev);
}

static int serial_set_format(grobo_port *port, const grobo_line_format *format,
                             grobo_os_cause *cause)
{
    tcflag_t asked = (format->parity != GROBO_PARITY_NONE ? PARENB : 0u) |
                     (format->parity == GROBO_PARITY_ODD ? PARODD : 0u) |
                     (format->stop_bits == 2 ? CSTOPB : 0u);
    struct termios tio;

    if ((unsigned)format->parity > GROBO_PARITY_ODD || format->stop_bits < 0 ||
        format->stop_bits > 2) {
        return GROBO_ERR_ARG;
    }
    if (tcgetattr(port->fd, &tio) != 0) {
        return grobo_i_posix_fail(cause, errno, "tcgetattr");
    }
    tio.c_cflag &= (tcflag_t) ~(PARENB | PARODD | CSTOPB);
    tio.c_cflag |= asked;
    tio.c_iflag &= (tcflag_t) ~(INPCK | IGNPAR);
    tio.c_iflag |= (asked & PARENB) != 0 ? (tcflag_t)(INPCK | IGNPAR) : 0u;
    /* A pseudo-terminal drops the parity, and then glibc says EINVAL: look at what it took. */
    if (tcsetattr(port->fd, TCSANOW, &tio) != 0 && errno != EINVAL) {
        return grobo_i_posix_fail(cause, errno, "tcsetattr");
    }
    if (!took(port->fd, asked)) {
        return grobo_i_port_refuse(cause, GROBO_ERR_UNSUPPORTED, "no such parity or stop bits");
    }
    return format->rs485 ? grobo_i_posix_set_rs485(port->fd, cause) : GROBO_OK;
}

static int serial_set_low_latency(grobo_port *port, grobo_os_cause *cause)
{
    return grobo_i_posix_set_low_latency(port->fd, cause);
}

const grobo_port_ops *grobo_port_serial_ops(void)
{
    static const grobo_port_ops ops = {
        .name = "serial",
        .size_bytes = sizeof(grobo_port),
        .open = serial_open,
        .close = serial_close,
        .ready = grobo_i_port_ready,
        .read = grobo_i_posix_read,
        .write = grobo_i_posix_write,
        .waiting = grobo_i_posix_waiting,
        .discard_output = serial_discard_output,
        .set_baud = serial_set_baud,
        .set_format = serial_set_format,
        .set_low_latency = serial_set_low_latency,
        .socket = grobo_i_posix_socket,
        .handle = grobo_i_posix_handle,
        .unsent = grobo_i_posix_unsent,
    };

    return &ops;
}
