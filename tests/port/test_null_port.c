/* SPDX-License-Identifier: MIT */
/* What a port makes of the system refuses NULL for each thing that must be there. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <grobo/core/port.h>

#include "tests/support/test.h"

#define REFUSES(call) assert_int_equal(call, GROBO_ERR_ARG)

static uint8_t bytes[256];
static char text[] = "CHEST";
static int ints[64];
static grobo_os_cause cause;
static grobo_thread thread;
static grobo_mutex mutex;
static grobo_cond cond;
static grobo_port *port;
static grobo_socket socket_made;

static GROBO_THREAD_FUNC thread_main(void *arg)
{
    (void)arg;
    GROBO_THREAD_RETURN;
}

static int set_up(void)
{
    port = calloc(1, grobo_port_serial_ops()->size_bytes);
    assert_non_null(port);
    assert_int_equal(grobo_mutex_init(&mutex), GROBO_OK);
    assert_int_equal(grobo_cond_init(&cond), GROBO_OK);
    return 0;
}

static int tear_down(void)
{
    grobo_cond_deinit(&cond);
    grobo_mutex_deinit(&mutex);
    free(port);
    return 0;
}

TEST(port_refuses_null)
{
    REFUSES(grobo_thread_start(NULL, thread_main, NULL));
    REFUSES(grobo_thread_start(&thread, NULL, NULL));
    REFUSES(grobo_thread_realtime(NULL));
    REFUSES(grobo_mutex_init(NULL));
    grobo_mutex_lock(NULL);
    grobo_mutex_unlock(NULL);
    grobo_mutex_deinit(NULL);
    REFUSES(grobo_cond_init(NULL));
    grobo_cond_wait(NULL, &mutex, 1000);
    grobo_cond_wait(&cond, NULL, 1000);
    grobo_cond_wake_all(NULL);
    grobo_cond_deinit(NULL);
    REFUSES(grobo_port_resolve(NULL, text, sizeof bytes, &cause));
    REFUSES(grobo_port_resolve(text, NULL, sizeof bytes, &cause));
    REFUSES(grobo_port_resolve(text, text, sizeof bytes, NULL));
    REFUSES(grobo_port_pty_path(NULL, text, sizeof bytes));
    REFUSES(grobo_port_pty_path(port, NULL, sizeof bytes));
    REFUSES(grobo_port_pty_baud(NULL));
    assert_false(grobo_port_pty_in_use(NULL));
    REFUSES(grobo_port_listen(NULL, &socket_made, ints, &cause));
    REFUSES(grobo_port_listen(text, NULL, ints, &cause));
    REFUSES(grobo_port_listen(text, &socket_made, NULL, &cause));
    REFUSES(grobo_port_listen(text, &socket_made, ints, NULL));
    REFUSES(grobo_port_accept(GROBO_SOCKET_NULL, NULL, &cause));
    REFUSES(grobo_port_accept(GROBO_SOCKET_NULL, port, NULL));
    REFUSES(grobo_port_list(NULL, NULL));
    REFUSES(grobo_port_identity(NULL, text, sizeof bytes));
    REFUSES(grobo_port_identity(text, NULL, sizeof bytes));
    REFUSES(grobo_port_owner(NULL, text, sizeof bytes));
    REFUSES(grobo_port_owner(text, NULL, sizeof bytes));
}

TESTS_BETWEEN(set_up, tear_down)
