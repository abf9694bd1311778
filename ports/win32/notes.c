/* SPDX-License-Identifier: MIT */
/*
 * Notes between the programs of one user, in the user's AppData: its access list keeps other users
 * out. The processes that left them; the one name of a device.
 */
#include <shlobj.h>
#include <stdio.h>
#include <string.h>

#include "ports/common/notes.h"
#include "ports/win32/win32.h"

enum { PATH_BYTES = NOTE_FOLDER_BYTES + NOTE_NAME_BYTES + 32 };

/* ---- notes -------------------------------------------------------------------------------- */

/* There is one directory. */
static bool find_folder(bool make, char *path)
{
    char data[MAX_PATH];

    if (SHGetFolderPathA(NULL, CSIDL_LOCAL_APPDATA | CSIDL_FLAG_CREATE, NULL, SHGFP_TYPE_CURRENT,
                         data) != S_OK) {
        return false;
    }
    int n = snprintf(path, NOTE_FOLDER_BYTES, "%s\\grobo", data);
    return n > 0 && n < NOTE_FOLDER_BYTES &&
           (!make || CreateDirectoryA(path, NULL) || GetLastError() == ERROR_ALREADY_EXISTS);
}

void grobo_i_note_folders_find(grobo_i_note_folders *folders)
{
    memset(folders, 0, sizeof *folders);
    if (!find_folder(false, folders->path[0])) {
        folders->path[0][0] = '\0';
    }
}

static bool join(const char *in, const char *name, char *path)
{
    int n = in[0] != '\0' ? snprintf(path, PATH_BYTES, "%s\\%s", in, name) : -1;

    return n > 0 && n < PATH_BYTES;
}

static bool place(const char *name, bool make, char *path)
{
    char in[NOTE_FOLDER_BYTES];

    return find_folder(make, in) && join(in, name, path);
}

int grobo_i_note_write(const char *name, const char *text, grobo_os_cause *cause)
{
    char path[PATH_BYTES];
    char next[PATH_BYTES + 16];
    DWORD size = (DWORD)strlen(text);
    DWORD put = 0;
    HANDLE file;
    BOOL whole;

    if (!place(name, true, path)) {
        return grobo_i_port_refuse(cause, GROBO_ERR_PERM, "no AppData directory of this user");
    }
    snprintf(next, sizeof next, "%s~%lu", path, GetCurrentProcessId());
    file = CreateFileA(next, GENERIC_WRITE, 0, NULL, CREATE_ALWAYS, FILE_ATTRIBUTE_NORMAL, NULL);
    if (file == INVALID_HANDLE_VALUE) {
        return grobo_i_win32_fail(cause, GetLastError(), path);
    }
    whole = WriteFile(file, text, size, &put, NULL) && put == size;
    whole = CloseHandle(file) && whole;
    if (!whole || !MoveFileExA(next, path, MOVEFILE_REPLACE_EXISTING)) {
        int r = grobo_i_win32_fail(cause, GetLastError(), path);

        DeleteFileA(next);
        return r;
    }
    return 1;
}

int grobo_i_note_read(const grobo_i_note_folders *in, int folder, const char *name, char *text,
                      size_t text_bytes)
{
    char path[PATH_BYTES];
    DWORD got = 0;
    HANDLE file;

    if (!join(in->path[folder], name, path) ||
        GetFileAttributesA(path) == INVALID_FILE_ATTRIBUTES) {
        return GROBO_ERR_NOENT;
    }
    file = CreateFileA(path, GENERIC_READ, FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE,
                       NULL, OPEN_EXISTING, FILE_ATTRIBUTE_NORMAL, NULL);
    if (file != INVALID_HANDLE_VALUE) {
        if (!ReadFile(file, text, (DWORD)text_bytes - 1, &got, NULL)) {
            got = 0;
        }
        CloseHandle(file);
    }
    text[got] = '\0';
    return GROBO_OK;
}

/* For guards, of which there are none here. */
uint64_t grobo_i_note_stamp(const grobo_i_note_folders *in, int folder, const char *name)
{
    (void)in;
    (void)folder;
    (void)name;
    return 0;
}

int grobo_i_note_remove(const char *name, grobo_os_cause *cause)
{
    char path[PATH_BYTES];

    if (!place(name, false, path) || DeleteFileA(path) || GetLastError() == ERROR_FILE_NOT_FOUND ||
        GetLastError() == ERROR_PATH_NOT_FOUND) {
        return GROBO_OK;
    }
    return grobo_i_win32_fail(cause, GetLastError(), path);
}

/* ---- processes ---------------------------------------------------------------------------- */

static uint64_t start_of(HANDLE process)
{
    FILETIME made, ended, in_kernel, in_user;

    if (!GetProcessTimes(process, &made, &ended, &in_kernel, &in_user)) {
        return 0;
    }
    return (uint64_t)made.dwHighDateTime << 32 | made.dwLowDateTime;
}

void grobo_i_process_self(grobo_i_process *self)
{
    self->pid = (int)GetCurrentProcessId();
    self->started = start_of(GetCurrentProcess());
}

/* No process is stopped here, but by a debugger: there is nothing to wake. */
int grobo_i_process_look(const grobo_i_process *process, bool wake)
{
    HANDLE handle = OpenProcess(PROCESS_QUERY_LIMITED_INFORMATION, FALSE, (DWORD)process->pid);
    DWORD status = 0;
    bool alive;

    (void)wake;
    if (handle == NULL) {
        return GetLastError() == ERROR_ACCESS_DENIED ? GROBO_ERR_PERM : GROBO_ERR_NOENT;
    }
    alive = GetExitCodeProcess(handle, &status) && status == STILL_ACTIVE &&
            (process->started == 0 || start_of(handle) == process->started);
    CloseHandle(handle);
    return alive ? 0 : GROBO_ERR_NOENT;
}

int grobo_i_holders_find(const char *device, grobo_i_holder *holders, int max)
{
    (void)device;
    (void)holders;
    (void)max;
    return GROBO_ERR_UNSUPPORTED;
}

int grobo_i_holder_end(const char *device, const grobo_i_holder *holder)
{
    (void)device;
    (void)holder;
    return GROBO_ERR_UNSUPPORTED;
}

grobo_socket grobo_i_note_watch_open(void)
{
    return GROBO_SOCKET_NULL; /* what tells of a directory here is no socket */
}

void grobo_i_note_watch_close(grobo_socket watch)
{
    (void)watch;
}

grobo_i_note_news grobo_i_note_watch_read(grobo_socket watch, const char *prefix)
{
    (void)watch;
    (void)prefix;
    return NOTE_NEWS_NONE;
}

bool grobo_i_is_root(void)
{
    return false;
}

int grobo_i_note_user_begin(unsigned user, unsigned group)
{
    (void)user;
    (void)group;
    return GROBO_ERR_UNSUPPORTED;
}

void grobo_i_note_user_end(void)
{
}

/* ---- names of a device -------------------------------------------------------------------- */

void grobo_i_device_names_find(const char *device, grobo_i_device_names *names)
{
    grobo_i_tcp_name at;
    grobo_os_cause cause;
    int n = -1;

    names->passing = -1;
    if (strncmp(device, "tcp:", 4) != 0) {
        names->n = grobo_port_identity(device, names->name[0], sizeof names->name[0]) == GROBO_OK;
        return;
    }
    if (grobo_i_tcp_split(device, true, &at, &cause) == GROBO_OK) {
        n = snprintf(names->name[0], sizeof names->name[0], "tcp:%s:%s", at.host, at.port);
    }
    names->n = n > 0 && n < (int)sizeof names->name[0];
}
