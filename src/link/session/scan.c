/* SPDX-License-Identifier: MIT */
/* Which serial ports GROBO_DEVICE_AUTO tries, in which order. */
#include <string.h>

#include "src/link/serial/loop.h"
#include "src/link/session/session.h"

static void add(session_scan *scan, const char *path)
{
    size_t size = strlen(path);

    if (scan->count < GROBO_SCAN_PORTS_MAX && size < GROBO_DEVICE_MAX_BYTES) {
        memcpy(scan->path[scan->count++], path, size + 1);
    }
}

typedef struct {
    session_scan *scan;
    bool usb; /* this round takes USB adapters, the other one the rest */
} round_of;

static int add_port(void *ctx, const grobo_port_info *info)
{
    const round_of *round = ctx;

    if (info->open_result == GROBO_OK && (info->usb_vendor >= 0) == round->usb) {
        add(round->scan, info->path);
    }
    return 0;
}

int grobo_i_session_scan_begin(grobo_session *session)
{
    const char *const *device = session->config.scan;
    session_scan *scan = grobo_i_new(session->config.mem, sizeof *scan);

    if (scan == NULL) {
        return GROBO_ERR_NOMEM;
    }
    session->scan = scan;
    if (device == NULL) {
        (void)grobo_port_list(add_port, &(round_of){scan, true});
        (void)grobo_port_list(add_port, &(round_of){scan, false});
    }
    while (device != NULL && *device != NULL) {
        add(scan, *device++);
    }
    if (scan->count == 0) {
        static const grobo_os_cause none = {0, "no serial port that may be opened"};

        session->cause = none;
        grobo_i_session_scan_end(session);
        return GROBO_ERR_NOTFOUND;
    }
    return GROBO_OK;
}

void grobo_i_session_scan_end(grobo_session *session)
{
    grobo_i_free(session->config.mem, session->scan, sizeof *session->scan);
    session->scan = NULL;
}
