/* SPDX-License-Identifier: MIT */
/*
 * Two serial ports for wine, joined by a null-modem cable: two pseudo-terminals with links to them
 * in wine's dosdevices. Linux only.
 *
 * usage: nullmodem DOSDEVICES COMMAND [ARGUMENT]...
 *   runs the command with GROBO_TEST_SERIAL=COM10,COM11 (or the next that are free) and with
 *   GROBO_TEST_NO_PARITY, which a pseudo-terminal has not, and ends as it does; signals are handed
 *   on to it.
 */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

/* wine itself names the ports up to COM9 after those of the machine. */
enum { ENDS = 2, FIRST_COM = 10, LAST_COM = 99, BLOCK_BYTES = 4096 };

typedef struct end {
    int master, slave;
    int com;
    char link[1024];
    char held[BLOCK_BYTES]; /* from the other end, not yet taken */
    size_t used;
} end;

static volatile sig_atomic_t child;

static void hand_on(int number)
{
    if (child > 0) {
        kill(child, number);
    }
}

static void die(const char *what)
{
    perror(what);
    exit(1);
}

static void open_end(end *e)
{
    struct termios tio;
    const char *name;
    e->master = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    if (e->master < 0 || grantpt(e->master) != 0 || unlockpt(e->master) != 0 ||
        (name = ptsname(e->master)) == NULL) {
        die("posix_openpt");
    }
    /* Held open: a program that closes its end does not hang the cable up. */
    e->slave = open(name, O_RDWR | O_NOCTTY);
    if (e->slave < 0 || tcgetattr(e->slave, &tio) != 0) {
        die(name);
    }
    cfmakeraw(&tio);
    tcsetattr(e->slave, TCSANOW, &tio);
    fcntl(e->master, F_SETFD, FD_CLOEXEC);
    fcntl(e->slave, F_SETFD, FD_CLOEXEC);
}

/* The first free name, so that several may run side by side. */
static void name_end(end *e, const char *folder, int from)
{
    for (e->com = from; e->com <= LAST_COM; e->com++) {
        snprintf(e->link, sizeof e->link, "%s/com%d", folder, e->com);
        if (symlink(ptsname(e->master), e->link) == 0) {
            return;
        }
        if (errno != EEXIST) {
            die(e->link);
        }
    }
    fprintf(stderr, "nullmodem: no free name in %s\n", folder);
    exit(1);
}

/* Takes from one end what the other has room for. */
static void carry(end *from, end *to)
{
    ssize_t n;
    if (to->used == 0) {
        n = read(from->master, to->held, sizeof to->held);
        to->used = n > 0 ? (size_t)n : 0;
    }
    n = to->used > 0 ? write(to->master, to->held, to->used) : 0;
    if (n > 0) {
        to->used -= (size_t)n;
        memmove(to->held, to->held + n, to->used);
    }
}

static void carry_until_over(end ends[ENDS], int over)
{
    struct pollfd all[ENDS + 1] = {[ENDS] = {.fd = over, .events = POLLIN}};
    for (;;) {
        for (int i = 0; i < ENDS; i++) {
            carry(&ends[1 - i], &ends[i]);
            all[i].fd = ends[i].master;
        }
        for (int i = 0; i < ENDS; i++) {
            all[i].events =
                (short)((ends[1 - i].used == 0 ? POLLIN : 0) | (ends[i].used > 0 ? POLLOUT : 0));
        }
        if (poll(all, ENDS + 1, -1) < 0 && errno != EINTR) {
            die("poll");
        }
        if ((all[ENDS].revents & (POLLIN | POLLHUP)) != 0) {
            return;
        }
    }
}

/* Returns the reading end of a pipe that is closed when the command has ended. */
static int run(char **words)
{
    int alive[2];
    if (pipe(alive) != 0) {
        die("pipe");
    }
    fcntl(alive[0], F_SETFD, FD_CLOEXEC);
    child = fork();
    if (child < 0) {
        die("fork");
    }
    if (child == 0) {
        /* Of us two alone: wine's server outlives the command. */
        pid_t its = fork();
        int status = 127;
        if (its == 0) {
            close(alive[1]);
            execvp(words[0], words);
            _exit(127);
        }
        child = its;
        while (waitpid(its, &status, 0) < 0 && errno == EINTR) {
        }
        _exit(WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status));
    }
    close(alive[1]);
    return alive[0];
}

int main(int argc, char **argv)
{
    static const int numbers[] = {SIGINT, SIGTERM, SIGHUP};
    static end ends[ENDS];
    char pair[32];
    int status = 0;
    int over;
    if (argc < 3) {
        fputs("usage: nullmodem DOSDEVICES COMMAND [ARGUMENT]...\n", stderr);
        return 2;
    }
    for (int i = 0; i < ENDS; i++) {
        open_end(&ends[i]);
        name_end(&ends[i], argv[1], FIRST_COM);
    }
    snprintf(pair, sizeof pair, "COM%d,COM%d", ends[0].com, ends[1].com);
    setenv("GROBO_TEST_SERIAL", pair, 1);
    setenv("GROBO_TEST_NO_PARITY", "1", 1);
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        signal(numbers[i], hand_on);
    }
    over = run(argv + 2);
    carry_until_over(ends, over);
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    for (int i = 0; i < ENDS; i++) {
        unlink(ends[i].link);
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}
