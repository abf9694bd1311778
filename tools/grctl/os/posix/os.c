/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <fcntl.h>
#include <langinfo.h>
#include <limits.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tools/grctl/os/os.h"

extern char **environ;

/* ---- the process ---------------------------------------------------------------------------- */

void os_start(void)
{
    /* Reading from and writing to those filled in fails as with closed ones. */
    static const int wrong_way[] = {O_WRONLY, O_RDONLY, O_RDONLY};
    for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; fd++) {
        if (fcntl(fd, F_GETFD) < 0 && open("/dev/null", wrong_way[fd]) != fd) {
            _exit(EXIT_FAILURE);
        }
    }
    signal(SIGXFSZ, SIG_IGN); /* a file that may not grow is an error of writing it, not the end */
}

const char *os_own_program(const char *argv0)
{
    /* Of Linux: this very file, though another has its name by now. */
    static const char self[] = "/proc/self/exe";
    return access(self, X_OK) == 0 ? self : argv0;
}

static bool is_beside(const char *own, size_t folder, const char *where, const char *name,
                      char *path, size_t capacity)
{
    int n = snprintf(path, capacity, "%.*s%s/%s", (int)folder, own, where, name);
    return n > 0 && (size_t)n < capacity && access(path, X_OK) == 0;
}

bool os_beside(const char *argv0, const char *name, char *path, size_t capacity)
{
    char *own = realpath(os_own_program(argv0), NULL);
    const char *slash = own ? strrchr(own, '/') : NULL;
    size_t folder = slash ? (size_t)(slash - own) : 0;
    bool found = slash && (is_beside(own, folder, "", name, path, capacity) ||
                           is_beside(own, folder, "/../libexec/grctl", name, path, capacity));
    free(own);
    return found;
}

enum { WORDS_MAX = 1024 };

void os_become(const char *path, char *const *words)
{
    char *given[WORDS_MAX] = {(char *)(uintptr_t)path}; /* it does not write to it */
    int n = 1;
    while (words[0] && words[n] && n < WORDS_MAX - 1) {
        given[n] = words[n];
        n++;
    }
    fflush(NULL);
    if (!words[0] || !words[n]) {
        execv(path, given);
    }
}

void os_host_name(char *name, size_t capacity)
{
    if (gethostname(name, capacity) != 0) {
        *name = '\0';
    }
    name[capacity - 1] = '\0';
}

bool os_is_terminal(FILE *stream)
{
    return isatty(fileno(stream)) == 1;
}

bool os_takes_line(FILE *stream)
{
    struct pollfd one = {.fd = fileno(stream), .events = POLLOUT};
    return poll(&one, 1, 0) == 1 && (one.revents & POLLOUT) && !(one.revents & POLLERR);
}

bool os_takes_bytes(FILE *stream)
{
    struct pollfd one = {.fd = fileno(stream), .events = POLLOUT};
    return poll(&one, 1, 0) != 0; /* an error is for the write to find */
}

int os_write(FILE *stream, const void *bytes, size_t size)
{
    const char *from = bytes;
    struct pollfd one = {.fd = fileno(stream), .events = POLLOUT};
    while (size > 0) {
        ssize_t n = write(one.fd, from, size);
        if (n < 0 && errno == EAGAIN) { /* by another program that has it too */
            poll(&one, 1, -1);
        } else if (n < 0 && errno != EINTR) {
            return errno;
        }
        from += n > 0 ? n : 0;
        size -= n > 0 ? (size_t)n : 0;
    }
    return 0;
}

int os_write_cause(FILE *stream, int cause)
{
    (void)stream;
    return cause;
}

int os_columns(FILE *stream)
{
    struct winsize size;
    return ioctl(fileno(stream), TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

bool os_shows_utf8(void)
{
    return strcmp(nl_langinfo(CODESET), "UTF-8") == 0;
}

FILE *os_create(const char *path, bool waits)
{
    int flags = O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC;
    int fd = open(path, flags | (waits ? 0 : O_NONBLOCK), 0666);
    FILE *file = NULL;
    if (fd >= 0 && (waits || fcntl(fd, F_SETFL, O_WRONLY) == 0)) {
        file = fdopen(fd, "wb");
    }
    if (fd >= 0 && !file) {
        int cause = errno;
        close(fd);
        errno = cause;
    }
    return file;
}

FILE *os_create_new(const char *path)
{
    int fd = open(path, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    FILE *file = fd >= 0 ? fdopen(fd, "w+b") : NULL;
    if (fd >= 0 && !file) {
        int cause = errno;
        close(fd);
        errno = cause;
    }
    return file;
}

int os_cut(FILE *file, long size)
{
    bool ok = ftruncate(fileno(file), size) == 0 && lseek(fileno(file), size, SEEK_SET) == size;
    return ok ? 0 : errno;
}

/* What is no file of a disk cannot be synced, and need not be. */
int os_sync(FILE *file)
{
    return fsync(fileno(file)) == 0 || errno == EINVAL || errno == EROFS ? 0 : errno;
}

void os_sync_folder(const char *path)
{
    char folder[PATH_MAX];
    const char *slash = strrchr(path, '/');
    int length = slash == path ? 1 : slash ? (int)(slash - path) : 0;
    snprintf(folder, sizeof folder, "%.*s", length, path);
    int fd = open(length ? folder : ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (fd >= 0) {
        (void)fsync(fd);
        close(fd);
    }
}

FILE *os_temporary(void)
{
    return tmpfile();
}

char *os_printed(void (*print)(FILE *to))
{
    char *text = NULL;
    size_t size = 0;
    FILE *memory = open_memstream(&text, &size);
    if (!memory) {
        return NULL;
    }
    print(memory);
    return fclose(memory) == 0 ? text : NULL;
}

intptr_t os_begin(const char *const *words, FILE *in, FILE *out, FILE *err)
{
    FILE *const streams[] = {in, out, err};
    posix_spawn_file_actions_t actions;
    pid_t child;
    if (posix_spawn_file_actions_init(&actions) != 0) {
        return -1;
    }
    int error = 0;
    for (int fd = STDIN_FILENO; fd <= STDERR_FILENO && !error; fd++) {
        if (streams[fd]) {
            error = posix_spawn_file_actions_adddup2(&actions, fileno(streams[fd]), fd);
        }
    }
    if (!error) { /* it does not write to the words */
        error =
            posix_spawnp(&child, words[0], &actions, NULL, (char *const *)(intptr_t)words, environ);
    }
    posix_spawn_file_actions_destroy(&actions);
    return error ? -1 : child;
}

int os_wait(intptr_t program)
{
    int status = -1;
    while (waitpid((pid_t)program, &status, 0) < 0) {
        if (errno != EINTR) {
            return -1;
        }
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

/* ---- signals -------------------------------------------------------------------------------- */

const int os_endings[] = {SIGINT,  SIGTERM, SIGHUP,    SIGQUIT, SIGALRM,
                          SIGUSR1, SIGUSR2, SIGVTALRM, SIGPROF, SIGXCPU};
const int os_n_endings = sizeof os_endings / sizeof os_endings[0];
const int os_suspension = SIGTSTP;

void os_catch_endings(void (*handler)(int number))
{
    struct sigaction action = {.sa_handler = handler};
    for (int i = 0; i < os_n_endings; i++) {
        sigaction(os_endings[i], &action, NULL);
    }
}

bool os_is_ignored(int number)
{
    struct sigaction old;
    return sigaction(number, NULL, &old) == 0 && old.sa_handler == SIG_IGN;
}

void os_take_signals(void)
{
    signal(SIGPIPE, SIG_IGN);
}

void os_suspend(void)
{
    raise(SIGSTOP);
}

/* ---- files ---------------------------------------------------------------------------------- */

bool os_is_folder(const char *path)
{
    struct stat s;
    return stat(path, &s) == 0 && S_ISDIR(s.st_mode);
}

/* The lock must be that of the file of this name still: its last owner removes it. */
static int try_lock(os_lock *lock)
{
    struct stat ours, named;
    int fd = open(lock->path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (fd < 0) {
        return errno;
    }
    if (flock(fd, LOCK_EX | LOCK_NB) == 0) {
        if (fstat(fd, &ours) == 0 && lstat(lock->path, &named) == 0 &&
            ours.st_ino == named.st_ino && ours.st_dev == named.st_dev) {
            lock->handle = fd;
            return 0;
        }
        errno = EAGAIN;
    }
    int cause = errno;
    close(fd);
    return cause == EAGAIN ? EWOULDBLOCK : cause;
}

int os_lock_file(os_lock *lock, const char *path)
{
    char *real = realpath(path, NULL); /* not there yet: as it is */
    int n = snprintf(lock->path, sizeof lock->path, "%s.lock", real ? real : path);
    free(real);
    return n < 0 || (size_t)n >= sizeof lock->path ? ENAMETOOLONG : try_lock(lock);
}

void os_unlock_file(os_lock *lock)
{
    (void)unlink(lock->path);
    close((int)lock->handle);
}

/* A file of the user's, below the folder of a variable, or the usual one at home. */
static bool user_path(const char *variable, const char *usual, const char *name, char *path,
                      size_t capacity)
{
    const char *folder = getenv(variable), *home = getenv("HOME");
    int n = -1;
    if (folder && *folder == '/') {
        n = snprintf(path, capacity, "%s/grctl/%s", folder, name);
    } else if (home && *home == '/') {
        n = snprintf(path, capacity, "%s/%s/grctl/%s", home, usual, name);
    }
    return n > 0 && (size_t)n < capacity;
}

bool os_make_folders(char *path)
{
    for (char *slash = strchr(path + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        if (mkdir(path, 0700) < 0 && errno != EEXIST) {
            return false;
        }
        *slash = '/';
    }
    return true;
}

bool os_state_path(const char *name, char *path, size_t capacity)
{
    return user_path("XDG_STATE_HOME", ".local/state", name, path, capacity) &&
           os_make_folders(path);
}

bool os_config_path(int which, char *path, size_t capacity)
{
    if (which == 0) {
        return user_path("XDG_CONFIG_HOME", ".config", "config.yaml", path, capacity);
    }
    return (size_t)snprintf(path, capacity, "/etc/grctl/config.yaml") < capacity;
}
