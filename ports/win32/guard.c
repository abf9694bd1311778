/* SPDX-License-Identifier: MIT */
/* No guard here: a COM port cannot be handed to another process that outlives this one. */
#include "ports/common/guard.h"

const char *grobo_i_guard_default(void)
{
    return "";
}

int grobo_i_guard_spawn(const char *program, const char *const *arguments,
                        grobo_i_guard_process *process)
{
    (void)program;
    (void)arguments;
    (void)process;
    return GROBO_ERR_UNSUPPORTED;
}

bool grobo_i_guard_is_owner(const grobo_i_guard_process *process)
{
    (void)process;
    return false;
}

void grobo_i_guard_kill(grobo_i_guard_process *process)
{
    (void)process;
}

void grobo_i_guard_end(grobo_i_guard_process *process, int64_t patience_us)
{
    (void)process;
    (void)patience_us;
}

int grobo_i_guard_send(grobo_socket socket, const void *bytes, size_t size, grobo_handle handle)
{
    (void)socket;
    (void)bytes;
    (void)size;
    (void)handle;
    return GROBO_ERR_UNSUPPORTED;
}

int grobo_i_guard_receive(grobo_socket socket, void *bytes, size_t size, grobo_handle *handle)
{
    (void)socket;
    (void)bytes;
    (void)size;
    (void)handle;
    return GROBO_ERR_UNSUPPORTED;
}

int grobo_i_guard_share(size_t size, void **at, grobo_handle *handle)
{
    (void)size;
    (void)at;
    (void)handle;
    return GROBO_ERR_UNSUPPORTED;
}

int grobo_i_guard_map(grobo_handle handle, size_t size, void **at)
{
    (void)handle;
    (void)size;
    (void)at;
    return GROBO_ERR_UNSUPPORTED;
}

void grobo_i_guard_unmap(void *at, size_t size)
{
    (void)at;
    (void)size;
}

int grobo_i_guard_begin(grobo_i_guard_watch *watch)
{
    (void)watch;
    return GROBO_ERR_UNSUPPORTED;
}

void grobo_i_guard_cease(grobo_i_guard_watch *watch)
{
    (void)watch;
}

unsigned grobo_i_guard_await(grobo_i_guard_watch *watch, grobo_handle line, bool moves)
{
    (void)watch;
    (void)line;
    (void)moves;
    return GROBO_I_GUARD_DEAD;
}

void grobo_i_port_adopt(grobo_port *port, grobo_handle handle)
{
    (void)port;
    (void)handle;
}

void grobo_i_guard_drop(grobo_handle handle)
{
    (void)handle;
}

void grobo_i_port_abandon(grobo_port *port)
{
    (void)port;
}

void grobo_i_port_lend(grobo_port *port)
{
    (void)port;
}

int grobo_i_port_reclaim(grobo_port *port)
{
    (void)port;
    return GROBO_ERR_UNSUPPORTED;
}
