/* SPDX-License-Identifier: MIT */
/* The serial ports of this machine: names from the registry, what they are from SetupAPI. */
#include <initguid.h>
#include <windows.h>
#include <devguid.h>
#include <setupapi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ports/win32/win32.h"

enum { PORTS_MAX = 256, NAME_BYTES = 32 };

typedef struct {
    char name[PORTS_MAX][NAME_BYTES];
    int count;
} names;

/* ---- what is there ------------------------------------------------------------------------ */

/* COM9 before COM10. */
static int by_number(const void *left, const void *right)
{
    size_t left_size = strlen(left);
    size_t right_size = strlen(right);

    if (left_size != right_size) {
        return left_size < right_size ? -1 : 1;
    }
    return strcmp(left, right);
}

static bool find_names(names *found)
{
    HKEY key;
    LSTATUS status = RegOpenKeyExA(HKEY_LOCAL_MACHINE, "HARDWARE\\DEVICEMAP\\SERIALCOMM", 0,
                                   KEY_QUERY_VALUE, &key);

    found->count = 0;
    /* The key is made with the first port. */
    if (status != ERROR_SUCCESS) {
        return status == ERROR_FILE_NOT_FOUND;
    }
    for (DWORD i = 0; status == ERROR_SUCCESS && found->count < PORTS_MAX; i++) {
        char driver[GROBO_DEVICE_MAX_BYTES];
        char *name = found->name[found->count];
        DWORD driver_size = sizeof driver;
        DWORD size = NAME_BYTES - 1;
        DWORD type;

        memset(name, 0, NAME_BYTES);
        status = RegEnumValueA(key, i, driver, &driver_size, NULL, &type, (BYTE *)name, &size);
        if (status == ERROR_SUCCESS && type == REG_SZ && name[0] != '\0') {
            found->count++;
        }
    }
    RegCloseKey(key);
    qsort(found->name, (size_t)found->count, NAME_BYTES, by_number);
    return true;
}

/* ---- what it is --------------------------------------------------------------------------- */

/* A value of the device's "Device Parameters"; false where there is none of this size. */
static bool parameter(HDEVINFO set, SP_DEVINFO_DATA *device, const char *name, void *value,
                      DWORD size)
{
    HKEY key = SetupDiOpenDevRegKey(set, device, DICS_FLAG_GLOBAL, 0, DIREG_DEV, KEY_QUERY_VALUE);
    LSTATUS status;

    if (key == INVALID_HANDLE_VALUE) {
        return false;
    }
    status = RegQueryValueExA(key, name, NULL, NULL, value, &size);
    RegCloseKey(key);
    return status == ERROR_SUCCESS;
}

static void property(HDEVINFO set, SP_DEVINFO_DATA *device, DWORD which, char *text, size_t size)
{
    memset(text, 0, size);
    if (!SetupDiGetDeviceRegistryPropertyA(set, device, which, NULL, (BYTE *)text, (DWORD)size - 1,
                                           NULL)) {
        text[0] = '\0';
    }
}

/* The four hexadecimal digits behind a mark, or -1. */
static int number_behind(const char *id, const char *mark)
{
    const char *at = strstr(id, mark);
    char digits[5] = "";

    if (at == NULL) {
        return -1;
    }
    snprintf(digits, sizeof digits, "%s", at + strlen(mark));
    return (int)strtol(digits, NULL, 16);
}

/*
 * USB\VID_2341&PID_0043\75330303235351F01A18, FTDIBUS\VID_0403+PID_6001+A1B2C3D4A\0000: the part
 * with the serial number; one that Windows made up itself has an & in it.
 */
static void take_id(const char *id, grobo_port_info *info)
{
    bool is_ftdi = strncmp(id, "FTDIBUS\\", 8) == 0;
    const char *begin = is_ftdi ? strrchr(id, '+') : strrchr(id, '\\');
    size_t size = begin != NULL ? strcspn(begin + 1, "\\") : 0;

    info->usb_vendor = number_behind(id, "VID_");
    info->usb_product = number_behind(id, "PID_");
    if (info->usb_vendor < 0 || begin == NULL || size >= sizeof info->serial_number ||
        memchr(begin + 1, '&', size) != NULL) {
        return;
    }
    /* FTDI's driver appends the letter of the channel. */
    snprintf(info->serial_number, sizeof info->serial_number, "%.*s",
             (int)(is_ftdi && size > 0 ? size - 1 : size), begin + 1);
}

static void describe(HDEVINFO set, SP_DEVINFO_DATA *device, grobo_port_info *info)
{
    char id[GROBO_DEVICE_MAX_BYTES] = "";
    DWORD latency_ms;

    property(set, device, SPDRP_SERVICE, info->driver, sizeof info->driver);
    property(set, device, SPDRP_MFG, info->manufacturer, sizeof info->manufacturer);
    property(set, device, SPDRP_DEVICEDESC, info->product, sizeof info->product);
    if (SetupDiGetDeviceInstanceIdA(set, device, id, sizeof id, NULL)) {
        take_id(id, info);
    }
    if (parameter(set, device, "LatencyTimer", &latency_ms, sizeof latency_ms)) {
        info->latency_ms = (int)latency_ms;
    }
}

/* Finds the device that has this name and is plugged in. */
static void find_device(HDEVINFO set, grobo_port_info *info)
{
    SP_DEVINFO_DATA device = {.cbSize = sizeof device};

    for (DWORD i = 0; SetupDiEnumDeviceInfo(set, i, &device); i++) {
        char name[NAME_BYTES] = "";

        if (parameter(set, &device, "PortName", name, sizeof name - 1) &&
            _stricmp(name, info->path) == 0) {
            describe(set, &device, info);
            return;
        }
    }
}

/* ---- the list ----------------------------------------------------------------------------- */

int grobo_port_list(int (*visit)(void *ctx, const grobo_port_info *info), void *ctx)
{
    if (visit == NULL) {
        return GROBO_ERR_ARG;
    }
    names found;
    HDEVINFO set;
    int r = 0;

    if (!find_names(&found)) {
        return GROBO_ERR_IO;
    }
    set = SetupDiGetClassDevsA(&GUID_DEVCLASS_PORTS, NULL, NULL, DIGCF_PRESENT);
    for (int i = 0; i < found.count && r == 0; i++) {
        grobo_port_info info = {.usb_vendor = -1, .usb_product = -1, .latency_ms = -1};

        memcpy(info.path, found.name[i], NAME_BYTES);
        memcpy(info.by_id, found.name[i], NAME_BYTES);
        if (set != INVALID_HANDLE_VALUE) {
            find_device(set, &info);
        }
        info.owner_pid = grobo_port_owner(info.path, info.owner_name, sizeof info.owner_name);
        info.open_result = info.owner_pid != 0 ? GROBO_ERR_BUSY : GROBO_OK;
        r = visit(ctx, &info);
    }
    if (set != INVALID_HANDLE_VALUE) {
        SetupDiDestroyDeviceInfoList(set);
    }
    return r != 0 ? r : found.count;
}
