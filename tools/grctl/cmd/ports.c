/* SPDX-License-Identifier: MIT */
#include <grobo/core/port.h>

#include "tools/grctl/cli/app.h"
#include "tools/grctl/cmd/commands.h"

/* NULL is null. */
static json_t *text_or_null(const char *text)
{
    return *text ? app_json_text(text) : NULL;
}

static json_t *port_json(const grobo_port_info *info)
{
    bool usable = info->open_result == GROBO_OK;
    char usb_id[16] = "";
    json_t *owner = NULL;
    if (info->usb_vendor >= 0) {
        snprintf(usb_id, sizeof usb_id, "%04x:%04x", (unsigned)info->usb_vendor & 0xffff,
                 (unsigned)info->usb_product & 0xffff);
    }
    if (info->owner_pid) {
        owner =
            json_pack("{s:i,s:o}", "pid", info->owner_pid, "name", app_json_text(info->owner_name));
    }
    return json_pack("{s:o,s:o?,s:o?,s:o?,s:o?,s:o?,s:o?,s:o?,s:o?,s:b,s:b,s:b,s:o?}", "path",
                     app_json_text(info->path), "by_id", text_or_null(info->by_id), "driver",
                     text_or_null(info->driver), "manufacturer", text_or_null(info->manufacturer),
                     "product", text_or_null(info->product), "serial_number",
                     text_or_null(info->serial_number), "usb_id", text_or_null(usb_id),
                     "latency_ms", info->latency_ms >= 0 ? json_integer(info->latency_ms) : NULL,
                     "owner", owner, "console", info->console, "bluetooth", info->bluetooth,
                     "usable", usable, "reason",
                     usable ? NULL : app_json_code(grobo_error_name(info->open_result)));
}

/* What an adapter and a process call themselves is for them to say. */
static void print_port(grobo_port_info *info)
{
    app_make_one_line(info->product);
    app_make_one_line(info->owner_name);
    app_print("%-16s", info->path);
    if (info->open_result == GROBO_OK) {
        app_print("  free");
    } else {
        app_print("  %s", grobo_error_text(info->open_result));
    }
    if (info->console || info->bluetooth) {
        app_print(", the system's %s", info->console ? "console" : "Bluetooth");
    }
    if (info->owner_pid) {
        app_print(", open in %s (pid %d)", info->owner_name, info->owner_pid);
    }
    if (info->usb_vendor >= 0) {
        app_print("  USB %04x:%04x", (unsigned)info->usb_vendor & 0xffff,
                  (unsigned)info->usb_product & 0xffff);
    }
    if (*info->product) {
        app_print(" %s", info->product);
    }
    if (*info->driver) {
        app_print("  (%s)", info->driver);
    }
    app_print("\n");
    if (*info->by_id) {
        app_print("%-16s  %s\n", "", info->by_id);
    }
}

static int visit(void *ctx, const grobo_port_info *info)
{
    json_t *list = ctx;
    if (list) {
        json_array_append_new(list, port_json(info));
    } else {
        grobo_port_info shown = *info;
        print_port(&shown);
    }
    return 0;
}

static int run(app *a)
{
    json_t *list = a->json ? json_array() : NULL;
    int n = grobo_port_list(visit, list);
    if (n < 0) {
        json_decref(list);
        return app_fail_error(a, EXIT_ROBOT, n, "cannot list serial ports");
    }
    if (a->json) {
        app_print_json(json_pack("{s:o}", "ports", list));
    } else if (n == 0) {
        app_note(a, "no serial port on this machine; is the robot's cable plugged in?");
    }
    return EXIT_DONE;
}

const cli_command cmd_ports = {
    .name = "ports",
    .arguments = "",
    .summary = "list the serial ports of this machine",
    .details = "Lists every serial port: its path, the name under /dev/serial/by-id that stays\n"
               "when it is plugged in elsewhere, its USB ids, which program holds it and whether\n"
               "it may be opened. No port is opened for it.\n",
    .run = run,
};
