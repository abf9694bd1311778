/* SPDX-License-Identifier: MIT */
#include <windows.h>
#include <errno.h>
#include <fcntl.h>
#include <io.h>
#include <shlobj.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <timeapi.h>

#include "tools/grctl/os/os.h"

/* ---- the process ---------------------------------------------------------------------------- */

/* Patterns of names are for the program to fill in: the C library does, when this asks it to. */
extern int _dowildcard;
int _dowildcard = -1;

static HANDLE handle_of(FILE *stream)
{
    return (HANDLE)_get_osfhandle(_fileno(stream));
}

/* Characters that move and colour, as on any other terminal. */
static void understand_escapes(FILE *stream)
{
    DWORD mode;
    if (GetConsoleMode(handle_of(stream), &mode)) {
        SetConsoleMode(handle_of(stream), mode | ENABLE_VIRTUAL_TERMINAL_PROCESSING);
    }
}

static void end_tick(void)
{
    timeEndPeriod(1);
}

void os_start(void)
{
    FILE *streams[] = {stdin, stdout, stderr};
    for (int i = 0; i < 3; i++) {
        if (_fileno(streams[i]) < 0 && !freopen("NUL", i == 0 ? "r" : "w", streams[i])) {
            exit(EXIT_FAILURE);
        }
        _setmode(_fileno(streams[i]), _O_BINARY);
    }
    SetConsoleOutputCP(CP_UTF8);
    understand_escapes(stdout);
    understand_escapes(stderr);
    /*
     * Unbuffered, the C library writes to a console byte by byte, and half a character is shown as
     * one that is none. There is no line buffering here: whoever says something flushes it.
     */
    setvbuf(stdout, NULL, _IOFBF, BUFSIZ);
    setvbuf(stderr, NULL, _IOFBF, BUFSIZ);
    /* Also for a robot in the same process, where no port asks for it. */
    if (timeBeginPeriod(1) == TIMERR_NOERROR) {
        atexit(end_tick);
    }
}

bool os_is_terminal(FILE *stream)
{
    DWORD mode;
    return GetConsoleMode(handle_of(stream), &mode);
}

/* There is nothing else that may be wrong with a pipe. */
int os_write_cause(FILE *stream, int cause)
{
    return GetFileType(handle_of(stream)) == FILE_TYPE_PIPE ? EPIPE : cause;
}

int os_columns(FILE *stream)
{
    CONSOLE_SCREEN_BUFFER_INFO info;
    if (!GetConsoleScreenBufferInfo(handle_of(stream), &info)) {
        return 80;
    }
    return info.srWindow.Right - info.srWindow.Left + 1;
}

void os_host_name(char *name, size_t capacity)
{
    DWORD size = (DWORD)capacity;
    if (!GetComputerNameA(name, &size)) {
        *name = '\0';
    }
}

bool os_shows_utf8(void)
{
    return GetConsoleOutputCP() == CP_UTF8;
}

/* tmpfile() makes its files in C:\, where only administrators may. */
FILE *os_temporary(void)
{
    char folder[MAX_PATH], path[MAX_PATH];
    if (!GetTempPathA(sizeof folder, folder) || !GetTempFileNameA(folder, "grc", 0, path)) {
        return NULL;
    }
    HANDLE made = CreateFileA(path, GENERIC_READ | GENERIC_WRITE | DELETE, 0, NULL, CREATE_ALWAYS,
                              FILE_ATTRIBUTE_TEMPORARY | FILE_FLAG_DELETE_ON_CLOSE, NULL);
    if (made == INVALID_HANDLE_VALUE) {
        return NULL;
    }
    int fd = _open_osfhandle((intptr_t)made, _O_RDWR | _O_BINARY);
    FILE *file = fd < 0 ? NULL : _fdopen(fd, "w+b");
    if (!file && fd >= 0) {
        _close(fd);
    } else if (!file) {
        CloseHandle(made);
    }
    return file;
}

char *os_printed(void (*print)(FILE *to))
{
    FILE *file = os_temporary();
    char *text = NULL;
    long size = -1;
    if (!file) {
        return NULL;
    }
    print(file);
    if (fseek(file, 0, SEEK_END) == 0) {
        size = ftell(file);
    }
    rewind(file);
    if (size >= 0) {
        text = calloc(1, (size_t)size + 1);
    }
    if (text && fread(text, 1, (size_t)size, file) != (size_t)size) {
        free(text);
        text = NULL;
    }
    fclose(file);
    return text;
}

/* ---- programs ------------------------------------------------------------------------------- */

/* No word of ours has a quote in it. */
static bool join_words(const char *const *words, char *line, size_t capacity)
{
    size_t used = 0;
    for (int i = 0; words[i] && used < capacity; i++) {
        used += (size_t)snprintf(line + used, capacity - used, "%s\"%s\"", i ? " " : "", words[i]);
    }
    return used < capacity;
}

/* A stream's handle as a child may have it. */
static HANDLE lend(FILE *stream)
{
    HANDLE lent = NULL, self = GetCurrentProcess();
    if (!DuplicateHandle(self, handle_of(stream), self, &lent, 0, TRUE, DUPLICATE_SAME_ACCESS)) {
        return NULL;
    }
    return lent;
}

intptr_t os_begin(const char *const *words, FILE *in, FILE *out, FILE *err)
{
    STARTUPINFOA start = {.cb = sizeof start, .dwFlags = STARTF_USESTDHANDLES};
    PROCESS_INFORMATION child;
    char line[4096];
    BOOL begun = FALSE;
    start.hStdInput = lend(in ? in : stdin);
    start.hStdOutput = lend(out);
    start.hStdError = lend(err ? err : stderr);
    if (start.hStdInput && start.hStdOutput && join_words(words, line, sizeof line)) {
        begun = CreateProcessA(NULL, line, NULL, NULL, TRUE, 0, NULL, NULL, &start, &child);
    }
    if (begun) {
        CloseHandle(child.hThread);
    }
    CloseHandle(start.hStdInput);
    CloseHandle(start.hStdOutput);
    CloseHandle(start.hStdError);
    return begun ? (intptr_t)child.hProcess : -1;
}

int os_wait(intptr_t program)
{
    HANDLE child = (HANDLE)program;
    DWORD status = 128;
    WaitForSingleObject(child, INFINITE);
    GetExitCodeProcess(child, &status);
    CloseHandle(child);
    return (int)(status & 0x7fffffff);
}

/* ---- signals -------------------------------------------------------------------------------- */

/* Of Ctrl-C; of Ctrl-Break; of a console that is closed, a log-out and a shut-down; no fourth. */
const int os_endings[] = {SIGINT, SIGTERM, SIGBREAK, SIGBREAK};
const int os_n_endings = sizeof os_endings / sizeof os_endings[0];
const int os_suspension = 0;

static void (*on_ending)(int number);

static BOOL WINAPI on_console(DWORD event)
{
    switch (event) {
    case CTRL_C_EVENT:
        raise(os_endings[OS_INTERRUPT]);
        return TRUE;
    case CTRL_BREAK_EVENT:
        raise(os_endings[OS_TERMINATE]);
        return TRUE;
    default:
        /* The process ends when this returns: not before main() has left the robot as it should. */
        raise(os_endings[OS_HANGUP]);
        Sleep(INFINITE);
        return TRUE;
    }
}

FILE *os_create(const char *path, bool waits)
{
    (void)waits;
    return fopen(path, "wb");
}

FILE *os_create_new(const char *path)
{
    int fd =
        _open(path, _O_RDWR | _O_CREAT | _O_EXCL | _O_BINARY | _O_NOINHERIT, _S_IREAD | _S_IWRITE);
    FILE *file = fd >= 0 ? _fdopen(fd, "w+b") : NULL;
    if (fd >= 0 && !file) {
        _close(fd);
    }
    return file;
}

int os_cut(FILE *file, long size)
{
    bool ok = _chsize(_fileno(file), size) == 0 && _lseek(_fileno(file), size, SEEK_SET) == size;
    return ok ? 0 : errno;
}

int os_sync(FILE *file)
{
    return _commit(_fileno(file)) == 0 ? 0 : errno;
}

void os_sync_folder(const char *path)
{
    (void)path; /* the file has its name by then */
}

bool os_takes_bytes(FILE *stream)
{
    (void)stream; /* nothing tells: the writer's thread waits */
    return true;
}

int os_write(FILE *stream, const void *bytes, size_t size)
{
    const char *from = bytes;
    while (size > 0) {
        int n = _write(_fileno(stream), from, (unsigned)size);
        if (n <= 0) {
            return n < 0 ? errno : EIO;
        }
        from += n;
        size -= (size_t)n;
    }
    return 0;
}

bool os_takes_line(FILE *stream)
{
    (void)stream;
    return true;
}

void os_suspend(void)
{
}

const char *os_own_program(const char *argv0)
{
    return argv0;
}

/* Here the command is one program (Makefile, WHOLE). */
bool os_beside(const char *argv0, const char *name, char *path, size_t capacity)
{
    (void)argv0;
    (void)name;
    (void)path;
    (void)capacity;
    return false;
}

void os_become(const char *path, char *const *words)
{
    (void)path;
    (void)words;
}

void os_take_signals(void)
{
    static bool taken;
    if (!taken) {
        taken = SetConsoleCtrlHandler(on_console, TRUE);
    }
}

/* The C library takes a handler back when it calls it. */
static void again(int number)
{
    signal(number, again);
    on_ending(number);
}

void os_catch_endings(void (*handler)(int number))
{
    on_ending = handler;
    os_take_signals();
    for (int i = 0; i < os_n_endings; i++) {
        signal(os_endings[i], again);
    }
}

bool os_is_ignored(int number)
{
    (void)number; /* nobody can say so */
    return false;
}

/* ---- files ---------------------------------------------------------------------------------- */

bool os_is_folder(const char *path)
{
    DWORD attributes = GetFileAttributesA(path);
    return attributes != INVALID_FILE_ATTRIBUTES && (attributes & FILE_ATTRIBUTE_DIRECTORY) != 0;
}

int os_lock_file(os_lock *lock, const char *path)
{
    char full[MAX_PATH];
    DWORD size = GetFullPathNameA(path, sizeof full, full, NULL);
    if (size == 0 || size >= sizeof full) {
        return ENAMETOOLONG;
    }
    snprintf(lock->path, sizeof lock->path, "%s.lock", full);
    HANDLE handle = CreateFileA(lock->path, GENERIC_WRITE, 0, NULL, OPEN_ALWAYS,
                                FILE_ATTRIBUTE_NORMAL | FILE_FLAG_DELETE_ON_CLOSE, NULL);
    if (handle == INVALID_HANDLE_VALUE) {
        switch (GetLastError()) {
        case ERROR_SHARING_VIOLATION:
        case ERROR_DELETE_PENDING:
            return EWOULDBLOCK;
        case ERROR_PATH_NOT_FOUND:
            return ENOENT;
        default:
            return EACCES;
        }
    }
    lock->handle = (intptr_t)handle;
    return 0;
}

void os_unlock_file(os_lock *lock)
{
    CloseHandle((HANDLE)lock->handle); /* and it is gone */
}

static bool known_folder(int which, char *path)
{
    return SHGetFolderPathA(NULL, which | CSIDL_FLAG_CREATE, NULL, SHGFP_TYPE_CURRENT, path) ==
           S_OK;
}

bool os_state_path(const char *name, char *path, size_t capacity)
{
    char folder[MAX_PATH];
    if (!known_folder(CSIDL_LOCAL_APPDATA, folder)) {
        return false;
    }
    int n = snprintf(path, capacity, "%s\\grctl", folder);
    if (n < 0 || (size_t)n >= capacity ||
        (!CreateDirectoryA(path, NULL) && GetLastError() != ERROR_ALREADY_EXISTS)) {
        return false;
    }
    n = snprintf(path, capacity, "%s\\grctl\\%s", folder, name);
    return n > 0 && (size_t)n < capacity;
}

bool os_make_folders(char *path)
{
    for (char *slash = path; (slash = strpbrk(slash + 1, "/\\")) != NULL;) {
        char kept = *slash;
        *slash = '\0';
        bool made = slash[-1] == ':' || CreateDirectoryA(path, NULL) ||
                    GetLastError() == ERROR_ALREADY_EXISTS;
        *slash = kept;
        if (!made) {
            return false;
        }
    }
    return true;
}

bool os_config_path(int which, char *path, size_t capacity)
{
    const char *config = getenv("XDG_CONFIG_HOME"); /* of a shell that came from elsewhere */
    char folder[MAX_PATH];
    int n;
    if (which == 0 && config && *config) {
        n = snprintf(path, capacity, "%s/grctl/config.yaml", config);
    } else if (known_folder(which == 1 ? CSIDL_COMMON_APPDATA : CSIDL_APPDATA, folder)) {
        n = snprintf(path, capacity, "%s\\grctl\\config.yaml", folder);
    } else {
        return false;
    }
    return n > 0 && (size_t)n < capacity;
}
