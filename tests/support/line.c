/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <termios.h>
#include <unistd.h>

#include "tests/support/line.h"
#include "tests/support/test.h"

/* Bytes of the test before may still be on their way. */
static void await_silence(test_line *line)
{
    struct pollfd one = {.fd = line->fd, .events = POLLIN};
    char rest[4096];

    while (poll(&one, 1, 20) > 0) {
        assert_true(read(line->fd, rest, sizeof rest) > 0);
    }
}

static void open_cable(test_line *line, const char *pair)
{
    size_t size = strcspn(pair, ",");
    struct termios tio;

    assert_true(size < sizeof line->device && pair[size] == ',');
    memcpy(line->device, pair, size);
    line->device[size] = '\0';
    line->fd = open(pair + size + 1, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    assert_true(line->fd >= 0);
    assert_int_equal(tcgetattr(line->fd, &tio), 0);
    cfmakeraw(&tio);
    tio.c_cflag |= CLOCAL | CREAD;
    tio.c_cc[VMIN] = 1;
    assert_int_equal(cfsetspeed(&tio, B115200), 0);
    assert_int_equal(tcsetattr(line->fd, TCSANOW, &tio), 0);
    await_silence(line);
}

void test_line_needs_pty(const char *what)
{
    if (getenv("GROBO_TEST_SERIAL") != NULL) {
        print_message("%s: with pseudo-terminals only\n", what);
        skip();
    }
}

void test_line_open(test_line *line)
{
    const char *pair = getenv("GROBO_TEST_SERIAL");
    const char *name;

    if (pair != NULL) {
        open_cable(line, pair);
        return;
    }
    line->fd = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    assert_true(line->fd >= 0);
    assert_int_equal(fcntl(line->fd, F_SETFD, FD_CLOEXEC), 0);
    assert_int_equal(grantpt(line->fd), 0);
    assert_int_equal(unlockpt(line->fd), 0);
    name = ptsname(line->fd);
    assert_non_null(name);
    assert_true(strlen(name) < sizeof line->device);
    memcpy(line->device, name, strlen(name) + 1);
}

grobo_serial *test_line_open_serial(test_line *line, int silence_ms)
{
    const grobo_serial_config config = {GROBO_SERIAL_CONFIG_INIT, .device = line->device,
                                        .silence_ms = silence_ms};
    grobo_serial *serial;

    test_line_open(line);
    assert_int_equal(grobo_serial_new(&config, &serial), GROBO_OK);
    assert_int_equal(grobo_serial_open(serial), GROBO_OK);
    return serial;
}

void test_line_close(test_line *line)
{
    if (line->fd >= 0) {
        assert_int_equal(close(line->fd), 0);
        line->fd = -1;
    }
}

static void await(const test_line *line, short events)
{
    struct pollfd one = {.fd = line->fd, .events = events};

    assert_int_equal(poll(&one, 1, 5000), 1);
}

void test_line_write(test_line *line, const void *bytes, size_t size)
{
    const char *from = bytes;

    while (size > 0) {
        ssize_t done = write(line->fd, from, size);

        if (done < 0) {
            assert_int_equal(errno, EAGAIN);
            await(line, POLLOUT);
        } else {
            from += done;
            size -= (size_t)done;
        }
    }
}

size_t test_line_write_some(test_line *line, const void *bytes, size_t size)
{
    ssize_t done = write(line->fd, bytes, size);

    return done > 0 ? (size_t)done : 0;
}

void test_line_await_arrival(test_line *line)
{
    struct pollfd one = {.fd = line->fd, .events = POLLIN};

    if (getenv("GROBO_TEST_SERIAL") != NULL) {
        /* Nothing comes back: this is a time. */
        assert_int_equal(poll(&one, 1, 50), 0);
    }
}

size_t test_line_read_some(test_line *line, void *bytes, size_t size)
{
    ssize_t got = read(line->fd, bytes, size);

    return got > 0 ? (size_t)got : 0;
}

void test_line_read(test_line *line, void *bytes, size_t size)
{
    char *to = bytes;

    while (size > 0) {
        size_t got;

        await(line, POLLIN);
        got = test_line_read_some(line, to, size);
        to += got;
        size -= got;
    }
}
