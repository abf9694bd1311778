/* SPDX-License-Identifier: MIT */
/* The lock of a serial port and its holder, by the port's name. */
#include <stdio.h>
#include <string.h>

#include "ports/win32/win32.h"

/*
 * A COM port is open once and Windows does not say by whom; under wine it opens as often as one
 * likes. A few bytes of shared memory by the port's name keep out those who look, and name us.
 */
static bool lock_name(const char *device, char *text, size_t text_bytes)
{
    char name[GROBO_DEVICE_MAX_BYTES];
    int n;

    if (grobo_i_win32_plain_name(device, name, sizeof name) < 0) {
        return false;
    }
    for (char *c = name; *c != '\0'; c++) {
        *c = *c == '\\' ? '/' : *c;
    }
    n = snprintf(text, text_bytes, "Local\\grobo-%s", name);
    return n > 0 && (size_t)n < text_bytes;
}

/* Writes our process id into the lock's memory, or reads the holder's. */
static DWORD pid_in(HANDLE lock, bool take)
{
    volatile DWORD *pid = MapViewOfFile(lock, take ? FILE_MAP_WRITE : FILE_MAP_READ, 0, 0, 0);
    DWORD holder = 0;

    if (pid != NULL) {
        if (take) {
            *pid = GetCurrentProcessId();
        }
        holder = *pid;
        UnmapViewOfFile((const void *)pid);
    }
    return holder;
}

HANDLE grobo_i_win32_lock(const char *device)
{
    char name[GROBO_DEVICE_MAX_BYTES + 16];
    HANDLE lock;

    if (!lock_name(device, name, sizeof name)) {
        return NULL;
    }
    lock = CreateFileMappingA(INVALID_HANDLE_VALUE, NULL, PAGE_READWRITE, 0, sizeof(DWORD), name);
    if (lock != NULL && GetLastError() == ERROR_ALREADY_EXISTS) {
        CloseHandle(lock);
        return NULL;
    }
    if (lock != NULL) {
        (void)pid_in(lock, true);
    }
    return lock;
}

void grobo_i_win32_unlock(HANDLE lock)
{
    CloseHandle(lock);
}

/* The file name of a process's program, cut to size. */
static void program_of(DWORD pid, char *name, size_t name_bytes)
{
    char path[MAX_PATH] = "";
    DWORD size = sizeof path;
    HANDLE process = OpenProcess(PROCESS_QUERY_LIMITED_INFORMATION, FALSE, pid);
    const char *slash;

    if (process == NULL || !QueryFullProcessImageNameA(process, 0, path, &size)) {
        path[0] = '\0';
    }
    if (process != NULL) {
        CloseHandle(process);
    }
    slash = strrchr(path, '\\');
    snprintf(name, name_bytes, "%s", slash != NULL ? slash + 1 : path);
}

int grobo_port_owner(const char *device, char *name, size_t name_bytes)
{
    if (device == NULL || name == NULL) {
        return GROBO_ERR_ARG;
    }
    char its[GROBO_DEVICE_MAX_BYTES + 16];
    HANDLE lock;
    DWORD pid;

    if (!lock_name(device, its, sizeof its)) {
        return 0;
    }
    lock = OpenFileMappingA(FILE_MAP_READ, FALSE, its);
    if (lock == NULL) {
        return 0;
    }
    pid = pid_in(lock, false);
    CloseHandle(lock);
    if (pid != 0) {
        program_of(pid, name, name_bytes);
    }
    return (int)pid;
}
