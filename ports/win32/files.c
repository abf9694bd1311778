/* SPDX-License-Identifier: MIT */
/*
 * grobo/files.h: files that are replaced whole, and paths that stay in a directory. Paths are in
 * the code page of the process, as fopen() takes them.
 */
#include <stdio.h>
#include <string.h>

#include <grobo/files.h>

#include "ports/win32/win32.h"

enum { TEMPORARIES_MAX = 100 }; /* names tried for one */

static int error_of(DWORD code)
{
    switch (code) {
    case ERROR_FILE_NOT_FOUND:
    case ERROR_PATH_NOT_FOUND:
    case ERROR_INVALID_NAME:
    case ERROR_BAD_PATHNAME:
    case ERROR_DIRECTORY:
        return GROBO_ERR_NOENT;
    case ERROR_ACCESS_DENIED:
    case ERROR_SHARING_VIOLATION:
    case ERROR_WRITE_PROTECT:
        return GROBO_ERR_PERM;
    case ERROR_FILE_EXISTS:
    case ERROR_ALREADY_EXISTS:
        return GROBO_ERR_EXISTS;
    case ERROR_FILENAME_EXCED_RANGE:
        return GROBO_ERR_SPACE;
    case ERROR_DISK_FULL:
    case ERROR_HANDLE_DISK_FULL:
        return GROBO_ERR_DISK;
    default:
        return GROBO_ERR_IO;
    }
}

static int last_error(void)
{
    return error_of(GetLastError());
}

/*
 * The true path of what is there, every link followed, without the \\?\ that the system puts before
 * it; GROBO_ERR_* where it cannot be told.
 */
static int true_path(const char *path, char *to, size_t size)
{
    char text[GROBO_PATH_MAX_BYTES];
    DWORD length = 0;
    HANDLE there = CreateFileA(path, 0, FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE,
                               NULL, OPEN_EXISTING, FILE_FLAG_BACKUP_SEMANTICS, NULL);

    if (there == INVALID_HANDLE_VALUE) {
        return last_error();
    }
    if (GetFileType(there) == FILE_TYPE_DISK) {
        length = GetFinalPathNameByHandleA(there, text, sizeof text, FILE_NAME_NORMALIZED);
    }
    CloseHandle(there);
    if (length == 0) {
        return GROBO_ERR_IO;
    }
    if (length >= sizeof text) {
        return GROBO_ERR_SPACE;
    }
    if (strncmp(text, "\\\\?\\UNC\\", 8) == 0) {
        text[6] = '\\';
        return grobo_i_port_copy(to, size, text + 6);
    }
    return grobo_i_port_copy(to, size, strncmp(text, "\\\\?\\", 4) == 0 ? text + 4 : text);
}

/* ---- writing ------------------------------------------------------------------------------ */

static HANDLE handle_of(const grobo_file *file)
{
    return (HANDLE)file->handle;
}

/* A new file beside path. */
static int open_temporary(grobo_file *file)
{
    for (int n = 0; n < TEMPORARIES_MAX; n++) {
        int length = snprintf(file->temporary, sizeof file->temporary, "%s.%lu-%d~", file->path,
                              GetCurrentProcessId(), n);
        if (length < 0 || (size_t)length >= sizeof file->temporary) {
            return GROBO_ERR_SPACE;
        }
        file->handle = (intptr_t)CreateFileA(file->temporary, GENERIC_WRITE, 0, NULL, CREATE_NEW,
                                             FILE_ATTRIBUTE_NORMAL, NULL);
        if (handle_of(file) != INVALID_HANDLE_VALUE) {
            return 0;
        }
        if (GetLastError() != ERROR_FILE_EXISTS) {
            return last_error();
        }
    }
    return GROBO_ERR_EXISTS;
}

/* A device or a pipe: true, and it is open or `result` says why not. */
static bool open_direct(grobo_file *file, int *result)
{
    HANDLE there = CreateFileA(file->path, GENERIC_WRITE, FILE_SHARE_READ | FILE_SHARE_WRITE, NULL,
                               OPEN_EXISTING, 0, NULL);

    if (there == INVALID_HANDLE_VALUE) {
        *result = last_error();
        return false;
    }
    if (GetFileType(there) == FILE_TYPE_DISK) {
        CloseHandle(there);
        *result = 0;
        return false;
    }
    file->handle = (intptr_t)there;
    file->direct = true;
    return true;
}

static int create(grobo_file *file, const char *path, bool exclusive)
{
    DWORD attributes = GetFileAttributesA(path);
    bool there = attributes != INVALID_FILE_ATTRIBUTES;
    int result;

    file->handle = (intptr_t)INVALID_HANDLE_VALUE;
    file->exclusive = exclusive;
    file->direct = false;
    if (there && exclusive) {
        return GROBO_ERR_EXISTS;
    }
    if (there && (attributes & FILE_ATTRIBUTE_DIRECTORY) != 0) {
        return GROBO_ERR_ISDIR;
    }
    result = grobo_i_port_copy(file->path, sizeof file->path, path);
    if (result < 0) {
        return result;
    }
    if (!exclusive && open_direct(file, &result)) {
        return 0;
    }
    /* Whoever may not write it may not replace it either. */
    if (there && result < 0) {
        return result;
    }
    if (there) {
        result = true_path(path, file->path, sizeof file->path);
    }
    return there && result < 0 ? result : open_temporary(file);
}

static int write_all(grobo_file *file, const void *data, size_t size)
{
    const char *from = data;

    while (size > 0) {
        DWORD most = size < INT32_MAX ? (DWORD)size : INT32_MAX;
        DWORD put = 0;

        if (!WriteFile(handle_of(file), from, most, &put, NULL)) {
            return last_error();
        }
        from += put;
        size -= put;
    }
    return 0;
}

static int put_in_place(grobo_file *file)
{
    /* With its rights and attributes, which a new file would not have. */
    if (!file->exclusive && ReplaceFileA(file->path, file->temporary, NULL, 0, NULL, NULL)) {
        return 0;
    }
    return MoveFileExA(file->temporary, file->path,
                       MOVEFILE_WRITE_THROUGH |
                           (file->exclusive ? 0 : (DWORD)MOVEFILE_REPLACE_EXISTING))
               ? 0
               : last_error();
}

static void discard(grobo_file *file)
{
    if (handle_of(file) != INVALID_HANDLE_VALUE) {
        CloseHandle(handle_of(file));
        file->handle = (intptr_t)INVALID_HANDLE_VALUE;
    }
    if (!file->direct) {
        (void)DeleteFileA(file->temporary);
    }
}

static int commit(grobo_file *file)
{
    int result = 0;

    /* A pipe or a console has nothing to be flushed. */
    if (!FlushFileBuffers(handle_of(file)) && !file->direct) {
        result = last_error();
    }
    if (!CloseHandle(handle_of(file)) && result == 0) {
        result = last_error();
    }
    file->handle = (intptr_t)INVALID_HANDLE_VALUE;
    if (file->direct) {
        return result;
    }
    if (result == 0) {
        result = put_in_place(file);
    }
    if (result < 0) {
        discard(file);
    }
    return result;
}

/* ---- paths -------------------------------------------------------------------------------- */

static int inside(const char *directory, const char *name, char *path, size_t path_bytes)
{
    char joined[GROBO_PATH_MAX_BYTES];
    char folder[GROBO_PATH_MAX_BYTES];
    char real[GROBO_PATH_MAX_BYTES];
    size_t size;
    DWORD attributes;
    int length = snprintf(joined, sizeof joined, "%s\\%s", directory, name);
    int result = true_path(directory, folder, sizeof folder);

    if (result == 0 && (length < 0 || (size_t)length >= sizeof joined)) {
        result = GROBO_ERR_SPACE;
    }
    if (result == 0) {
        result = true_path(joined, real, sizeof real);
    }
    if (result < 0) {
        return result;
    }
    size = strlen(folder);
    size -= size > 0 && folder[size - 1] == '\\' ? 1 : 0;
    /* The system has spelt both, so they differ where the files do. */
    if (strncmp(real, folder, size) != 0 || real[size] != '\\') {
        return GROBO_ERR_OUTSIDE;
    }
    attributes = GetFileAttributesA(real);
    if (attributes == INVALID_FILE_ATTRIBUTES) {
        return last_error();
    }
    return (attributes & FILE_ATTRIBUTE_DIRECTORY) != 0 ? GROBO_ERR_ISDIR
                                                        : grobo_i_port_copy(path, path_bytes, real);
}

static bool holds(const char *path)
{
    BY_HANDLE_FILE_INFORMATION is;
    HANDLE there = CreateFileA(path, 0, FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE,
                               NULL, OPEN_EXISTING, FILE_FLAG_BACKUP_SEMANTICS, NULL);

    if (there == INVALID_HANDLE_VALUE) {
        return false;
    }
    bool full = GetFileType(there) == FILE_TYPE_DISK && GetFileInformationByHandle(there, &is) &&
                (is.dwFileAttributes & FILE_ATTRIBUTE_DIRECTORY) == 0 &&
                (is.nFileSizeHigh != 0 || is.nFileSizeLow != 0);
    CloseHandle(there);
    return full;
}

int grobo_i_port_regular(const char *path)
{
    BY_HANDLE_FILE_INFORMATION is;
    HANDLE there = CreateFileA(path, 0, FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE,
                               NULL, OPEN_EXISTING, FILE_FLAG_BACKUP_SEMANTICS, NULL);

    if (there == INVALID_HANDLE_VALUE) {
        return GetLastError() == ERROR_ACCESS_DENIED ? GROBO_ERR_PERM : GROBO_ERR_NOENT;
    }
    bool on_disk = GetFileType(there) == FILE_TYPE_DISK && GetFileInformationByHandle(there, &is);
    bool folder = on_disk && (is.dwFileAttributes & FILE_ATTRIBUTE_DIRECTORY) != 0;
    CloseHandle(there);
    return folder ? GROBO_ERR_ISDIR : on_disk ? GROBO_OK : GROBO_ERR_UNSUPPORTED;
}

const grobo_files *grobo_files_os(void)
{
    static const grobo_files files = {create, write_all, commit, discard, inside, holds};

    return &files;
}
