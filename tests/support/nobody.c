/* SPDX-License-Identifier: MIT */
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/nobody.h"
#include "tests/support/test.h"

enum { NOBODY = 65534, NOT_ANOTHER = 100 };

int as_nobody(int (*do_it)(void *ctx), void *ctx)
{
    int status;
    pid_t pid;

    if (geteuid() != 0) {
        print_message("only root can become another user\n");
        skip();
    }
    pid = fork();
    assert_true(pid >= 0);
    if (pid == 0) {
        _exit(setgid(NOBODY) == 0 && setuid(NOBODY) == 0 ? -do_it(ctx) : NOT_ANOTHER);
    }
    assert_int_equal(waitpid(pid, &status, 0), pid);
    assert_true(WIFEXITED(status));
    assert_int_not_equal(WEXITSTATUS(status), NOT_ANOTHER);
    return -WEXITSTATUS(status);
}
