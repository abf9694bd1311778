/* SPDX-License-Identifier: MIT */
/* A guard, seen from the program: started, given a port, ended. */
#include <string.h>

#include "src/base/sized.h"
#include "src/link/guard/guard.h"
#include "src/link/serial/loop.h"

/* Longest the guard may take to come up, and to end, where it does not stop the robot first. */
#define READY_US INT64_C(2000000)
#define END_US INT64_C(1000000)

_Static_assert(ATOMIC_INT_LOCK_FREE == 2, "two processes may use what is lock-free only");

/* ---- starting and ending ------------------------------------------------------------------ */

static int await_hello(const grobo_guard *guard)
{
    guard_hello hello;
    size_t have = 0;
    int64_t end_us = grobo_now_us() + READY_US;

    while (have < sizeof hello) {
        int64_t left_us = end_us - grobo_now_us();
        int r = left_us > 0 ? grobo_port_wait(guard->process.socket, GROBO_PORT_READABLE, left_us)
                            : GROBO_ERR_TIMEOUT;

        if (r >= 0) {
            r = grobo_i_guard_receive(guard->process.socket, (char *)&hello + have,
                                      sizeof hello - have, NULL);
        }
        if (r < 0) {
            return r == GROBO_ERR_CLOSED ? GROBO_ERR_MISMATCH : r;
        }
        have += (size_t)r;
    }
    return hello.magic == GUARD_MAGIC && hello.message_bytes == sizeof(guard_message)
               ? GROBO_OK
               : GROBO_ERR_MISMATCH;
}

/* Gives the guard the memory that both have. Where there is none, it watches for the program's
 * death and for a stop only. */
static int share(grobo_guard *guard)
{
    guard_message message;
    grobo_handle handle;
    void *at;
    int r = grobo_i_guard_share(sizeof *guard->shared, &at, &handle);

    if (r < 0) {
        return r == GROBO_ERR_UNSUPPORTED ? GROBO_OK : r;
    }
    guard->shared = at;
    memset(&message, 0, sizeof message);
    message.magic = GUARD_MAGIC;
    message.kind = GUARD_SHARE;
    r = grobo_i_guard_send(guard->process.socket, &message, sizeof message, handle);
    grobo_i_guard_drop(handle);
    return r;
}

static void unshare(grobo_guard *guard)
{
    if (guard->shared != &guard->own) {
        grobo_i_guard_unmap(guard->shared, sizeof *guard->shared);
    }
}

int grobo_guard_new(const grobo_guard_config *config, grobo_guard **guard)
{
    static const char *const word[] = {"guard", NULL};
    grobo_guard_config from;
    grobo_guard *made;
    int r;

    if (guard == NULL || grobo_i_sized_take(&from, sizeof from, config) < 0) {
        return GROBO_ERR_ARG;
    }
    made = grobo_i_new(from.mem, sizeof *made);
    if (made == NULL) {
        return GROBO_ERR_NOMEM;
    }
    made->mem = from.mem;
    made->shared = &made->own;
    r = grobo_i_guard_spawn(from.program != NULL ? from.program : grobo_i_guard_default(),
                            from.arguments != NULL ? from.arguments : word, &made->process);
    if (r >= 0) {
        r = await_hello(made);
        if (r >= 0) {
            r = share(made);
        }
        if (r < 0) {
            grobo_i_guard_end(&made->process, 0);
        }
    }
    if (r < 0) {
        unshare(made);
        grobo_i_free(from.mem, made, sizeof *made);
        return r;
    }
    *guard = made;
    return GROBO_OK;
}

void grobo_guard_free(grobo_guard *guard)
{
    if (guard != NULL) {
        grobo_i_guard_release(guard);
        bool stops = guard->taken || atomic_load(&guard->shared->line) == GUARD_LINE_GUARD;

        grobo_i_guard_end(&guard->process, END_US + (stops ? GROBO_GUARD_BOUND_US : 0));
        unshare(guard);
        grobo_i_free(guard->mem, guard, sizeof *guard);
    }
}

int grobo_guard_pid(const grobo_guard *guard)
{
    if (guard == NULL) {
        return GROBO_ERR_ARG;
    }
    return guard->ended ? 0 : guard->process.pid;
}

/* ---- what is said ------------------------------------------------------------------------- */

/* The program has the line no more, unless the guard has. */
static void withdraw(grobo_guard *guard)
{
    unsigned had = GUARD_LINE_PROGRAM;

    if (!atomic_compare_exchange_strong(&guard->shared->line, &had, GUARD_LINE_NOBODY)) {
        guard->taken = guard->taken || had == GUARD_LINE_GUARD;
    }
}

/*
 * One that does not listen must not take the robot later: it is ended. But where it is this program
 * that has lost its descriptors, the guard finds them closed, takes the line, and must live.
 */
static void give_up(grobo_guard *guard, int error)
{
    guard->ended = true;
    if (error == GROBO_ERR_IO) {
        guard->taken = guard->has_port;
        guard->process.socket = GROBO_SOCKET_NULL; /* what is closed, or somebody else's */
        return;
    }
    if (guard->has_port) {
        withdraw(guard);
    }
    grobo_i_guard_kill(&guard->process);
    guard->has_port = guard->taken;
    atomic_store(&guard->shared->line, guard->taken ? GUARD_LINE_GUARD : GUARD_LINE_PROGRAM);
}

static bool can_be_told(const grobo_guard *guard)
{
    return !guard->ended && grobo_i_guard_is_owner(&guard->process);
}

static void send(grobo_guard *guard, const void *bytes, size_t size, grobo_handle handle)
{
    int r = grobo_i_guard_send(guard->process.socket, bytes, size, handle);

    if (r < 0) {
        give_up(guard, r);
    }
}

void grobo_i_guard_take(grobo_guard *guard, const guard_message *message, const void *data,
                        grobo_handle handle)
{
    struct {
        guard_message message;
        uint8_t data[GROBO_GUARD_DATA_BYTES];
    } all;

    if (!can_be_told(guard)) {
        return;
    }
    memset(&all, 0, sizeof all);
    all.message = *message;
    if (message->data_bytes > 0) {
        memcpy(all.data, data, message->data_bytes);
    }
    guard->message = *message;
    guard->taken = guard->refused = false;
    guard->has_port = true;
    atomic_store(&guard->shared->line, GUARD_LINE_PROGRAM);
    send(guard, &all, sizeof all.message + message->data_bytes, handle);
}

void grobo_i_guard_more(grobo_guard *guard, bool connection, grobo_handle handle)
{
    guard_message message;

    if (can_be_told(guard)) {
        memset(&message, 0, sizeof message);
        message.magic = GUARD_MAGIC;
        message.kind = GUARD_MORE;
        message.connection = connection;
        send(guard, &message, sizeof message, handle);
    }
}

void grobo_i_guard_tell(grobo_guard *guard, guard_policy policy, bool moves)
{
    guard_message *told = &guard->message;

    atomic_fetch_add_explicit(&guard->shared->beats, 1, memory_order_relaxed);
    if (!can_be_told(guard) || !guard->has_port ||
        (told->policy == (uint32_t)policy && told->moves == (uint32_t)moves)) {
        return;
    }
    told->kind = GUARD_STATE;
    told->policy = (uint32_t)policy;
    told->moves = moves;
    told->data_bytes = 0;
    send(guard, told, sizeof *told, GROBO_HANDLE_NULL);
}

void grobo_i_guard_release(grobo_guard *guard)
{
    grobo_i_guard_hear(guard);
    if (can_be_told(guard) && guard->has_port) {
        withdraw(guard);
        guard->has_port = false;
        if (guard->taken) {
            return; /* it has released it already, or will */
        }
        guard->message.kind = GUARD_RELEASE;
        guard->message.data_bytes = 0;
        send(guard, &guard->message, sizeof guard->message, GROBO_HANDLE_NULL);
    }
}

void grobo_i_guard_hear(grobo_guard *guard)
{
    char words[16];
    int got = can_be_told(guard)
                  ? grobo_i_guard_receive(guard->process.socket, words, sizeof words, NULL)
                  : 0;

    for (int i = 0; i < got; i++) {
        guard->taken = guard->taken || (words[i] == GUARD_TAKEN && guard->has_port);
        guard->refused = guard->refused || words[i] == GUARD_REFUSED;
    }
    guard->taken =
        guard->taken || (guard->has_port && atomic_load(&guard->shared->line) == GUARD_LINE_GUARD);
    if (guard->taken) {
        atomic_store(&guard->shared->line, GUARD_LINE_GUARD); /* where the memory is not shared */
    }
    if (got < 0) {
        give_up(guard, got);
    }
}
