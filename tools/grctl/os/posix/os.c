/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <fcntl.h>
#include <langinfo.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "../../os.h"

extern char **environ;

/* ---- the process ---------------------------------------------------------------------------- */

void os_start(void)
{
    /* Reading from and writing to those filled in fails as with closed ones. */
    static const int wrong_way[] = {O_WRONLY, O_RDONLY, O_RDONLY};
    for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; fd++)
        if (fcntl(fd, F_GETFD) < 0 && open("/dev/null", wrong_way[fd]) != fd)
            _exit(EXIT_FAILURE);
}

bool os_is_terminal(FILE *stream)
{
    return isatty(fileno(stream)) == 1;
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

FILE *os_temporary(void)
{
    return tmpfile();
}

char *os_printed(void (*print)(FILE *to))
{
    char *text = NULL;
    size_t size = 0;
    FILE *memory = open_memstream(&text, &size);
    if (!memory)
        return NULL;
    print(memory);
    return fclose(memory) == 0 ? text : NULL;
}

int os_run(const char *const *words, FILE *in, FILE *out)
{
    posix_spawn_file_actions_t actions;
    pid_t child;
    int status = -1, error;
    if (posix_spawn_file_actions_init(&actions) != 0)
        return -1;
    error = posix_spawn_file_actions_adddup2(&actions, fileno(in), STDIN_FILENO);
    if (!error)
        error = posix_spawn_file_actions_adddup2(&actions, fileno(out), STDOUT_FILENO);
    if (!error) /* it does not write to the words */
        error =
            posix_spawnp(&child, words[0], &actions, NULL, (char *const *)(intptr_t)words, environ);
    posix_spawn_file_actions_destroy(&actions);
    if (error)
        return -1;
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR)
            return -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

/* ---- signals -------------------------------------------------------------------------------- */

const int os_endings[OS_ENDINGS] = {SIGINT, SIGTERM, SIGHUP, SIGQUIT};

void os_catch_endings(void (*handler)(int number))
{
    struct sigaction action = {.sa_handler = handler};
    for (int i = 0; i < OS_ENDINGS; i++)
        sigaction(os_endings[i], &action, NULL);
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

/* ---- files ---------------------------------------------------------------------------------- */

bool os_is_folder(const char *path)
{
    struct stat s;
    return stat(path, &s) == 0 && S_ISDIR(s.st_mode);
}

bool os_config_path(int which, char *path, size_t capacity)
{
    const char *config = getenv("XDG_CONFIG_HOME"), *home = getenv("HOME");
    int n;
    if (which == 1)
        n = snprintf(path, capacity, "/etc/grctl/config.yaml");
    else if (config && *config == '/')
        n = snprintf(path, capacity, "%s/grctl/config.yaml", config);
    else if (home && *home == '/')
        n = snprintf(path, capacity, "%s/.config/grctl/config.yaml", home);
    else
        return false;
    return n > 0 && (size_t)n < capacity;
}

/*
 * That of the session, which a service or a job of cron has not, and one for all. Made with mode
 * 700, and believed only if it is the user's own.
 */
bool os_private_folder(int which, char *path, size_t capacity)
{
    const char *run = getenv("XDG_RUNTIME_DIR");
    struct stat s;
    int n;
    if (which == 0 && !(run && *run == '/'))
        return false;
    n = which == 0 ? snprintf(path, capacity, "%s/grctl", run)
                   : snprintf(path, capacity, "/tmp/grctl-%lu", (unsigned long)geteuid());
    if (n < 0 || (size_t)n >= capacity)
        return false;
    if (mkdir(path, 0700) < 0 && errno != EEXIST)
        return false;
    return lstat(path, &s) == 0 && S_ISDIR(s.st_mode) && s.st_uid == geteuid();
}

bool os_true_path(const char *device, char *path, size_t capacity)
{
    char *real = realpath(device, NULL);
    int n = real ? snprintf(path, capacity, "%s", real) : -1;
    free(real);
    return n >= 0 && (size_t)n < capacity;
}

bool os_mark(const char *path)
{
    int fd = open(path, O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
    return fd >= 0 && close(fd) == 0;
}

bool os_unmark(const char *path)
{
    return unlink(path) == 0 || errno == ENOENT;
}

bool os_is_marked(const char *path)
{
    struct stat s;
    return lstat(path, &s) == 0;
}
