/* SPDX-License-Identifier: MIT */
/*
 * Linux: the serial ports of sysfs, or without it the adapters in /dev. The other systems' answer
 * is at the end.
 */
#define _GNU_SOURCE /* versionsort: ttyUSB2 before ttyUSB10 */
#include <stdio.h>
#include <string.h>

#include "ports/posix/posix.h"

#ifdef __linux__

#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

/* Joins two parts of a path; false where it does not fit. */
static bool join(char *path, size_t path_bytes, const char *a, const char *b)
{
    int n = snprintf(path, path_bytes, "%s/%s", a, b);

    return n >= 0 && (size_t)n < path_bytes;
}

/* Reads the first line of a small file of sysfs; false, and text untouched, where there is none. */
static bool read_line(const char *folder, const char *name, char *text, size_t text_bytes)
{
    char path[PATH_MAX];
    FILE *file = join(path, sizeof path, folder, name) ? fopen(path, "re") : NULL;
    bool ok = file != NULL && fgets(text, (int)text_bytes, file) != NULL;

    if (file != NULL) {
        (void)fclose(file);
    }
    if (ok) {
        text[strcspn(text, "\n")] = '\0';
    }
    return ok;
}

static int read_number(const char *folder, const char *name, int base, int missing)
{
    char text[32];

    return read_line(folder, name, text, sizeof text) ? (int)strtol(text, NULL, base) : missing;
}

static void copy_base_name(char *to, size_t to_bytes, const char *path)
{
    const char *slash = strrchr(path, '/');
    const char *name = slash != NULL ? slash + 1 : path;
    size_t size = strnlen(name, to_bytes - 1);

    memcpy(to, name, size);
    to[size] = '\0';
}

/* Looks upwards from the port's folder for the USB device it is a part of. */
static void add_usb(char *folder, grobo_port_info *info)
{
    char *slash;

    while ((slash = strrchr(folder, '/')) != NULL && slash != folder) {
        info->usb_vendor = read_number(folder, "idVendor", 16, -1);
        if (info->usb_vendor >= 0) {
            info->usb_product = read_number(folder, "idProduct", 16, -1);
            (void)read_line(folder, "manufacturer", info->manufacturer, sizeof info->manufacturer);
            (void)read_line(folder, "product", info->product, sizeof info->product);
            (void)read_line(folder, "serial", info->serial_number, sizeof info->serial_number);
            return;
        }
        *slash = '\0';
    }
}

/* The link in dev/serial/by-id that leads to a device; `found` is left alone where none does. */
static void find_by_id(const char *dev, const char *device, char *found, size_t found_bytes)
{
    char folder[PATH_MAX];
    struct stat node;
    struct stat target;
    const struct dirent *entry;
    DIR *links = join(folder, sizeof folder, dev, "serial/by-id") ? opendir(folder) : NULL;

    if (links == NULL) {
        return;
    }
    while (stat(device, &node) == 0 && (entry = readdir(links)) != NULL) {
        char path[PATH_MAX];

        if (entry->d_name[0] != '.' && join(path, sizeof path, folder, entry->d_name) &&
            stat(path, &target) == 0 && target.st_dev == node.st_dev &&
            target.st_ino == node.st_ino && strlen(path) < found_bytes) {
            snprintf(found, found_bytes, "%s", path);
            break;
        }
    }
    (void)closedir(links);
}

static void add_access(grobo_port_info *info)
{
    bool locked;

    info->owner_pid =
        grobo_i_posix_owner(info->path, info->owner_name, sizeof info->owner_name, &locked);
    if (locked) {
        info->open_result = GROBO_ERR_BUSY;
    } else if (access(info->path, R_OK | W_OK) != 0) {
        info->open_result = errno == EACCES ? GROBO_ERR_PERM : GROBO_ERR_NOENT;
    }
}

/* Is the name a word of /proc/consoles, or the value of a console= of the kernel's command line? */
static bool is_console(const char *proc, const char *name)
{
    static const char option[] = "console=";
    size_t size = strlen(name);
    char path[PATH_MAX];
    char line[4096];
    bool found = false;
    FILE *consoles = join(path, sizeof path, proc, "consoles") ? fopen(path, "re") : NULL;

    while (consoles != NULL && !found && fgets(line, sizeof line, consoles) != NULL) {
        found = strncmp(line, name, size) == 0 && (line[size] == ' ' || line[size] == '\n');
    }
    if (consoles != NULL) {
        (void)fclose(consoles);
    }
    if (found || !read_line(proc, "cmdline", line, sizeof line)) {
        return found;
    }
    for (const char *at = line; !found && (at = strstr(at, option)) != NULL;) {
        bool whole = at == line || at[-1] == ' ';

        at += sizeof option - 1;
        found = whole && strncmp(at, name, size) == 0 && strchr(", ", at[size]) != NULL;
    }
    return found;
}

/* The device tree has the chip as a node below the UART's. */
static bool has_bluetooth(const char *device)
{
    char path[PATH_MAX];

    return join(path, sizeof path, device, "of_node/bluetooth") && access(path, F_OK) == 0;
}

/* Fills info for a terminal of sysfs; false for one without a device behind it. */
static bool describe(const char *sys_tty, const char *dev, const char *name, grobo_port_info *info)
{
    char folder[PATH_MAX];
    char device[PATH_MAX];
    char driver[PATH_MAX];

    if (!join(folder, sizeof folder, sys_tty, name) ||
        !join(device, sizeof device, folder, "device") || access(device, F_OK) != 0) {
        return false;
    }
    /* The 8250 driver makes its nodes whether or not there is a chip: type 0 says there is not. */
    if (read_number(folder, "type", 10, -1) == 0) {
        return false;
    }
    *info = (grobo_port_info){.usb_vendor = -1, .usb_product = -1, .latency_ms = -1};
    if (!join(info->path, sizeof info->path, dev, name)) {
        return false;
    }
    info->latency_ms = read_number(device, "latency_timer", 10, -1);
    if (join(driver, sizeof driver, device, "driver") && realpath(driver, folder) != NULL) {
        copy_base_name(info->driver, sizeof info->driver, folder);
    }
    if (realpath(device, folder) != NULL) {
        add_usb(folder, info);
    }
    info->bluetooth = has_bluetooth(device);
    find_by_id(dev, info->path, info->by_id, sizeof info->by_id);
    add_access(info);
    return true;
}

/* Fills info for an adapter as its name tells; false for any other node. */
static bool describe_node(const char *dev, const char *name, grobo_port_info *info)
{
    static const char *const adapters[] = {"ttyUSB", "ttyACM"};
    bool adapter = false;

    for (size_t i = 0; i < sizeof adapters / sizeof adapters[0]; i++) {
        adapter = adapter || strncmp(name, adapters[i], strlen(adapters[i])) == 0;
    }
    *info = (grobo_port_info){.usb_vendor = -1, .usb_product = -1, .latency_ms = -1};
    if (!adapter || !join(info->path, sizeof info->path, dev, name)) {
        return false;
    }
    find_by_id(dev, info->path, info->by_id, sizeof info->by_id);
    add_access(info);
    return true;
}

int grobo_i_posix_list(const char *sys_tty, const char *proc, const char *dev,
                       int (*visit)(void *ctx, const grobo_port_info *info), void *ctx)
{
    struct dirent **names;
    int count = scandir(sys_tty, &names, NULL, versionsort);
    bool has_sysfs = count >= 0;
    int found = 0;
    int r = 0;

    if (!has_sysfs) {
        /* A container: who shares a device with it need not share /sys. */
        count = scandir(dev, &names, NULL, versionsort);
    }
    for (int i = 0; i < count; i++) {
        const char *name = names[i]->d_name;
        grobo_port_info info;

        if (r == 0 && name[0] != '.' &&
            (has_sysfs ? describe(sys_tty, dev, name, &info) : describe_node(dev, name, &info))) {
            found++;
            info.console = is_console(proc, name);
            r = visit(ctx, &info);
        }
        free(names[i]);
    }
    if (count >= 0) {
        free(names);
    }
    return r != 0 ? r : found;
}

#else

static void find_by_id(const char *dev, const char *device, char *found, size_t found_bytes)
{
    (void)dev;
    (void)device;
    (void)found;
    (void)found_bytes;
}

int grobo_i_posix_list(const char *sys_tty, const char *proc, const char *dev,
                       int (*visit)(void *ctx, const grobo_port_info *info), void *ctx)
{
    (void)sys_tty;
    (void)proc;
    (void)dev;
    (void)visit;
    (void)ctx;
    return GROBO_ERR_UNSUPPORTED;
}

#endif

int grobo_port_list(int (*visit)(void *ctx, const grobo_port_info *info), void *ctx)
{
    return visit == NULL ? GROBO_ERR_ARG
                         : grobo_i_posix_list("/sys/class/tty", "/proc", "/dev", visit, ctx);
}

int grobo_port_identity(const char *device, char *name, size_t name_bytes)
{
    char found[GROBO_DEVICE_MAX_BYTES] = "";
    const char *identity = found;

    if (device == NULL || name == NULL) {
        return GROBO_ERR_ARG;
    }
    find_by_id("/dev", device, found, sizeof found);
    if (found[0] == '\0') {
        identity = device;
    }
    return grobo_i_port_copy(name, name_bytes, identity);
}
