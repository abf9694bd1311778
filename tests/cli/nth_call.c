/* SPDX-License-Identifier: MIT */
/*
 * Runs a program of which one call to the system goes wrong (tests/cli/calls.sh): Linux, x86-64.
 *
 * usage: nth_call COUNT_FILE KIND FATE N PROGRAM ARGUMENTS...
 *   KIND   a name of the table below
 *   FATE   a name of the other table: an error, or `short`: the call is given one byte to read or
 *          write, or `end`: what is read is at its end
 *   N      which of the calls of this kind, of the program and of all that it starts, without those
 *          of the loader, which nobody can help; 0 none
 * It exits as the program does, 128 and the signal's number where one ended it. How many calls
 * there were is written to COUNT_FILE. The program and what it started are killed with it.
 *
 * A filter stops at calls of this kind alone, so that the others take no longer than ever.
 */
#include <errno.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <signal.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/user.h>
#include <sys/wait.h>
#include <unistd.h>

enum { CALLS_MAX = 8, FAILS_ITSELF = 125 };

struct kind {
    const char *name;
    int n;
    long calls[CALLS_MAX];
};
static const struct kind kinds[] = {
    {"open", 2, {SYS_openat, SYS_open}},
    {"read", 4, {SYS_read, SYS_readv, SYS_recvfrom, SYS_recvmsg}},
    {"write", 5, {SYS_write, SYS_writev, SYS_sendto, SYS_sendmsg, SYS_pwrite64}},
    {"sync", 2, {SYS_fsync, SYS_fdatasync}},
    {"name", 6, {SYS_rename, SYS_renameat2, SYS_link, SYS_unlink, SYS_mkdir, SYS_ftruncate}},
    {"wait",
     7,
     {SYS_epoll_wait, SYS_epoll_pwait, SYS_poll, SYS_ppoll, SYS_select, SYS_pselect6,
      SYS_clock_nanosleep}},
    {"ioctl", 1, {SYS_ioctl}},
    {"control", 3, {SYS_flock, SYS_epoll_ctl, SYS_setsockopt}},
    {"handle",
     8,
     {SYS_pipe2, SYS_eventfd2, SYS_timerfd_create, SYS_epoll_create1, SYS_socket, SYS_socketpair,
      SYS_inotify_init1, SYS_dup}},
    {"socket", 4, {SYS_bind, SYS_listen, SYS_connect, SYS_accept4}},
    {"start", 4, {SYS_clone, SYS_clone3, SYS_fork, SYS_vfork}},
    {"memory", 2, {SYS_mmap, SYS_mremap}},
    {"look", 5, {SYS_stat, SYS_newfstatat, SYS_lstat, SYS_fstat, SYS_getdents64}},
};

enum { SHORT = -1, END = -2 };
static const struct fate {
    const char *name;
    int number;
} fates[] = {
    {"EIO", EIO},       {"EINTR", EINTR},   {"ENOSPC", ENOSPC}, {"EMFILE", EMFILE},
    {"EACCES", EACCES}, {"ENOENT", ENOENT}, {"EAGAIN", EAGAIN}, {"ENOMEM", ENOMEM},
    {"EPIPE", EPIPE},   {"ENOTTY", ENOTTY}, {"short", SHORT},   {"end", END},
};

static int give_up(const char *what)
{
    fprintf(stderr, "nth_call: %s: %s\n", what, strerror(errno));
    exit(FAILS_ITSELF);
}

static void filter(const struct kind *kind)
{
    struct sock_filter code[2 * CALLS_MAX + 2];
    unsigned short n = 0;
    code[n++] =
        (struct sock_filter)BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr));
    for (int i = 0; i < kind->n; i++) {
        code[n++] =
            (struct sock_filter)BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, (unsigned)kind->calls[i], 0, 1);
        code[n++] = (struct sock_filter)BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRACE);
    }
    code[n++] = (struct sock_filter)BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
    struct sock_fprog program = {n, code};
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 ||
        prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) != 0) {
        give_up("filter");
    }
}

/* Where the loader lies in a process: at most this much behind its AT_BASE. */
enum { LOADER_BYTES = 0x50000, AT_BASE_NUMBER = 7 };
static bool is_of_loader(pid_t pid)
{
    char path[64];
    unsigned long pair[2], base = 0;
    struct user_regs_struct regs;
    snprintf(path, sizeof path, "/proc/%ld/auxv", (long)pid);
    FILE *file = fopen(path, "rb");
    while (file && fread(pair, sizeof pair, 1, file) == 1) {
        base = pair[0] == AT_BASE_NUMBER ? pair[1] : base;
    }
    if (file) {
        fclose(file);
    }
    return ptrace(PTRACE_GETREGS, pid, 0, &regs) == 0 && regs.rip >= base &&
           regs.rip - base < LOADER_BYTES;
}

static void spoil(pid_t pid, int number)
{
    struct user_regs_struct regs;
    if (ptrace(PTRACE_GETREGS, pid, 0, &regs) != 0) {
        return;
    }
    /* The C library ends a program whose netlink has an end, which it has not. */
    if (number == END && regs.orig_rax == SYS_recvmsg) {
        return;
    }
    if (number == SHORT) {
        regs.rdx = regs.rdx > 1 ? 1 : regs.rdx;
    } else {
        regs.orig_rax = (unsigned long long)-1;
        regs.rax = number == END ? 0 : (unsigned long long)-number;
    }
    (void)ptrace(PTRACE_SETREGS, pid, 0, &regs);
}

static void tell(const char *path, long count)
{
    FILE *file = fopen(path, "w");
    if (!file || fprintf(file, "%ld\n", count) < 0 || fclose(file) != 0) {
        give_up(path);
    }
}

/* Until the program itself has ended; what it started may go on, and is watched too. */
static int watch(pid_t program, int fate, long which, const char *path)
{
    long count = 0;
    int status, end = -1;
    for (;;) {
        pid_t pid = waitpid(-1, &status, __WALL);
        if (pid < 0) {
            break;
        }
        if (WIFEXITED(status) || WIFSIGNALED(status)) {
            if (pid == program) {
                end = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
                tell(path, count);
            }
            continue;
        }
        int signal = WSTOPSIG(status);
        int event = status >> 16;
        if (event == PTRACE_EVENT_SECCOMP) {
            bool counts = !is_of_loader(pid);
            count += counts;
            if (counts && count == which) {
                spoil(pid, fate);
            }
        }
        if (event == PTRACE_EVENT_STOP && signal != SIGTRAP) { /* it is stopped, as by Ctrl-Z */
            (void)ptrace(PTRACE_LISTEN, pid, 0, 0);
            continue;
        }
        (void)ptrace(PTRACE_CONT, pid, 0, event || signal == SIGTRAP ? 0 : signal);
    }
    return end < 0 ? FAILS_ITSELF : end;
}

int main(int argc, char **argv)
{
    const struct kind *kind = NULL;
    const struct fate *fate = NULL;
    for (size_t i = 0; argc > 5 && i < sizeof kinds / sizeof *kinds; i++) {
        kind = strcmp(kinds[i].name, argv[2]) == 0 ? &kinds[i] : kind;
    }
    for (size_t i = 0; argc > 5 && i < sizeof fates / sizeof *fates; i++) {
        fate = strcmp(fates[i].name, argv[3]) == 0 ? &fates[i] : fate;
    }
    if (!kind || !fate) {
        fprintf(stderr, "usage: nth_call COUNT_FILE KIND FATE N PROGRAM ARGUMENTS...\n");
        return FAILS_ITSELF;
    }
    pid_t program = fork();
    if (program == 0) {
        raise(SIGSTOP);
        filter(kind);
        execv(argv[5], argv + 5);
        give_up(argv[5]);
    }
    int status;
    long options = PTRACE_O_TRACESECCOMP | PTRACE_O_TRACEFORK | PTRACE_O_TRACEVFORK |
                   PTRACE_O_TRACECLONE | PTRACE_O_TRACEEXEC | PTRACE_O_EXITKILL;
    if (program < 0 || waitpid(program, &status, WUNTRACED) != program ||
        ptrace(PTRACE_SEIZE, program, 0, options) != 0 || kill(program, SIGCONT) != 0) {
        return give_up("start");
    }
    return watch(program, fate->number, strtol(argv[4], NULL, 10), argv[1]);
}
