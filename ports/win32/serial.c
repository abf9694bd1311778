/* SPDX-License-Identifier: MIT */
/* Serial ports: opening, speed, and the near end of the pump's socket pair. */
#include <stdio.h>
#include <string.h>

#include "ports/win32/win32.h"

/* ---- speed -------------------------------------------------------------------------------- */

static int get_state(HANDLE com, DCB *dcb, grobo_os_cause *cause)
{
    memset(dcb, 0, sizeof *dcb);
    dcb->DCBlength = sizeof *dcb;
    if (!GetCommState(com, dcb)) {
        return grobo_i_win32_fail(cause, GetLastError(), "GetCommState");
    }
    return GROBO_OK;
}

static int set_state(HANDLE com, DCB *dcb, grobo_os_cause *cause)
{
    DWORD code;
    int r;

    if (SetCommState(com, dcb)) {
        return GROBO_OK;
    }
    code = GetLastError();
    r = grobo_i_win32_fail(cause, code, "SetCommState");
    return code == ERROR_INVALID_PARAMETER ? GROBO_ERR_UNSUPPORTED : r;
}

/* Sets a speed, and all that makes a line raw; reads back what speed it is. */
static int set_line(HANDLE com, int baud_bps, const grobo_line_format *format,
                    grobo_os_cause *cause)
{
    DCB dcb;
    DWORD before;
    int r = get_state(com, &dcb, cause);

    if (r < 0) {
        return r;
    }
    before = dcb.BaudRate;
    memset(&dcb, 0, sizeof dcb);
    dcb.DCBlength = sizeof dcb;
    dcb.BaudRate = (DWORD)baud_bps;
    dcb.ByteSize = 8;
    dcb.Parity = format->parity == GROBO_PARITY_NONE   ? NOPARITY
                 : format->parity == GROBO_PARITY_EVEN ? EVENPARITY
                                                       : ODDPARITY;
    dcb.fParity = format->parity != GROBO_PARITY_NONE;
    dcb.StopBits = format->stop_bits == 2 ? TWOSTOPBITS : ONESTOPBIT;
    dcb.fBinary = TRUE;
    dcb.fDtrControl = DTR_CONTROL_ENABLE;
    dcb.fRtsControl = format->rs485 ? RTS_CONTROL_TOGGLE : RTS_CONTROL_ENABLE;
    r = set_state(com, &dcb, cause);
    if (r >= 0) {
        DCB now;

        r = get_state(com, &now, cause);
        if (r >= 0) {
            r = grobo_i_port_check_baud(baud_bps, (int)now.BaudRate, cause);
        }
        if (r >= 0) {
            return r;
        }
    }
    /* Some drivers keep half of what they refuse. */
    dcb.BaudRate = before;
    (void)SetCommState(com, &dcb);
    return r;
}

static int serial_set_baud(grobo_port *port, int baud_bps, grobo_os_cause *cause)
{
    return set_line(port->com, baud_bps, &port->format, cause);
}

static int serial_set_format(grobo_port *port, const grobo_line_format *format,
                             grobo_os_cause *cause)
{
    DCB dcb;
    int r;

    if ((unsigned)format->parity > GROBO_PARITY_ODD || format->stop_bits < 0 ||
        format->stop_bits > 2) {
        return GROBO_ERR_ARG;
    }
    r = get_state(port->com, &dcb, cause);
    if (r >= 0) {
        r = set_line(port->com, (int)dcb.BaudRate, format, cause);
    }
    if (r >= 0) {
        port->format = *format;
        r = GROBO_OK;
    }
    return r;
}

/* ---- opening ------------------------------------------------------------------------------ */

static int refuse_busy(const char *device, DWORD code, grobo_os_cause *cause)
{
    char name[64];
    int pid = grobo_port_owner(device, name, sizeof name);

    return grobo_i_port_refuse_busy(cause, (int)code, pid, name);
}

/* A path of a file: CreateFile() would open it. */
static int check_kind(const char *path, grobo_os_cause *cause)
{
    DWORD attributes;

    if (strncmp(path, "\\\\.\\", 4) == 0) {
        return GROBO_OK;
    }
    attributes = GetFileAttributesA(path);
    if (attributes == INVALID_FILE_ATTRIBUTES) {
        (void)grobo_i_win32_fail(cause, GetLastError(), "open");
        return GROBO_ERR_NOENT;
    }
    return (attributes & FILE_ATTRIBUTE_DIRECTORY) != 0
               ? grobo_i_port_refuse(cause, GROBO_ERR_ISDIR, "a directory")
               : grobo_i_port_refuse(cause, GROBO_ERR_TYPE, "not a serial port");
}

/* True when the system says that there is no line behind a handle; a lost one is another matter. */
static bool is_no_line(HANDLE com)
{
    static const DWORD codes[] = {ERROR_INVALID_FUNCTION, ERROR_INVALID_HANDLE,
                                  ERROR_INVALID_PARAMETER, ERROR_NOT_SUPPORTED};
    DCB dcb = {.DCBlength = sizeof dcb};
    DWORD code = GetCommState(com, &dcb) ? ERROR_SUCCESS : GetLastError();

    for (size_t i = 0; i < sizeof codes / sizeof codes[0]; i++) {
        if (code == codes[i]) {
            return true;
        }
    }
    return GetFileType(com) != FILE_TYPE_CHAR;
}

/* Raw, at this speed, reads that wait for as many bytes as they ask for, nothing received yet. */
static int make_raw(HANDLE com, int baud_bps, grobo_os_cause *cause)
{
    COMMTIMEOUTS forever = {0};
    int r;

    if (is_no_line(com)) {
        return grobo_i_port_refuse(cause, GROBO_ERR_TYPE, "not a serial port");
    }
    /* A hint; drivers choose. */
    (void)SetupComm(com, 16384, 4096);
    r = set_line(com, baud_bps, &(grobo_line_format){0}, cause);
    if (r < 0) {
        return r;
    }
    if (!SetCommTimeouts(com, &forever)) {
        return grobo_i_win32_fail(cause, GetLastError(), "SetCommTimeouts");
    }
    if (!PurgeComm(com, PURGE_RXABORT | PURGE_RXCLEAR | PURGE_TXABORT | PURGE_TXCLEAR)) {
        return grobo_i_win32_fail(cause, GetLastError(), "PurgeComm");
    }
    return GROBO_OK;
}

static int open_com(const char *device, int baud_bps, HANDLE *com, grobo_os_cause *cause)
{
    char path[GROBO_DEVICE_MAX_BYTES + 8];
    HANDLE made;
    int r = grobo_i_win32_path(device, path, sizeof path);

    if (r < 0) {
        return grobo_i_port_refuse(cause, GROBO_ERR_ARG, "not a name of a serial port");
    }
    r = check_kind(path, cause);
    if (r < 0) {
        return r;
    }
    made = CreateFileA(path, GENERIC_READ | GENERIC_WRITE, 0, NULL, OPEN_EXISTING,
                       FILE_FLAG_OVERLAPPED, NULL);
    if (made == INVALID_HANDLE_VALUE) {
        DWORD code = GetLastError();

        return code == ERROR_ACCESS_DENIED || code == ERROR_SHARING_VIOLATION
                   ? refuse_busy(device, code, cause)
                   : grobo_i_win32_fail(cause, code, "open");
    }
    r = make_raw(made, baud_bps, cause);
    if (r < 0) {
        CloseHandle(made);
        return r;
    }
    *com = made;
    return GROBO_OK;
}

static int serial_open(grobo_port *port, const char *device, int baud_bps, grobo_os_cause *cause)
{
    HANDLE lock = grobo_i_win32_lock(device);
    HANDLE com = INVALID_HANDLE_VALUE;
    char holder[64];
    int r;

    if (lock == NULL && grobo_port_owner(device, holder, sizeof holder) != 0) {
        return refuse_busy(device, ERROR_SHARING_VIOLATION, cause);
    }
    r = open_com(device, baud_bps, &com, cause);
    if (r >= 0) {
        port->com = com;
        port->format = (grobo_line_format){0};
        r = grobo_i_win32_pump_start(port, cause);
        if (r < 0) {
            CloseHandle(com);
        }
    }
    if (r < 0) {
        if (lock != NULL) {
            grobo_i_win32_unlock(lock);
        }
        return r;
    }
    port->lock = lock;
    grobo_i_win32_tick(true);
    return GROBO_OK;
}

static void serial_close(grobo_port *port)
{
    grobo_i_win32_pump_stop(port);
    CloseHandle(port->com);
    port->com = INVALID_HANDLE_VALUE;
    if (port->lock != NULL) {
        grobo_i_win32_unlock(port->lock);
    }
    grobo_i_win32_tick(false);
}

/* ---- bytes -------------------------------------------------------------------------------- */

/* The pump has hung up; it left its reason. */
static int fail_pump(grobo_port *port, const char *what, grobo_os_cause *cause)
{
    DWORD code = (DWORD)port->pump.failure;

    return grobo_i_win32_fail(cause, code != 0 ? code : ERROR_BROKEN_PIPE, what);
}

static int serial_read(grobo_port *port, void *buf, size_t size, grobo_os_cause *cause)
{
    int got = recv(port->socket, buf, size < INT32_MAX ? (int)size : INT32_MAX, 0);

    if (got > 0) {
        return got;
    }
    return got < 0 && WSAGetLastError() == WSAEWOULDBLOCK ? 0 : fail_pump(port, "read", cause);
}

static int serial_write(grobo_port *port, const void *buf, size_t size, grobo_os_cause *cause)
{
    int put;

    if (port->pump.failure != 0) {
        return fail_pump(port, "write", cause);
    }
    put = send(port->socket, buf, size < INT32_MAX ? (int)size : INT32_MAX, 0);
    if (put >= 0) {
        return put;
    }
    return WSAGetLastError() == WSAEWOULDBLOCK ? 0 : fail_pump(port, "write", cause);
}

static int serial_set_low_latency(grobo_port *port, grobo_os_cause *cause)
{
    (void)port;
    return grobo_i_port_refuse(cause, GROBO_ERR_UNSUPPORTED,
                               "set in the device manager: port settings, advanced, latency timer");
}

static grobo_handle serial_handle(const grobo_port *port)
{
    return port->com;
}

const grobo_port_ops *grobo_port_serial_ops(void)
{
    static const grobo_port_ops ops = {
        .name = "serial",
        .size_bytes = sizeof(grobo_port),
        .open = serial_open,
        .close = serial_close,
        .ready = grobo_i_port_ready,
        .read = serial_read,
        .write = serial_write,
        .waiting = grobo_i_win32_waiting,
        .discard_output = grobo_i_win32_pump_discard,
        .set_baud = serial_set_baud,
        .set_format = serial_set_format,
        .set_low_latency = serial_set_low_latency,
        .socket = grobo_i_win32_socket,
        .handle = serial_handle,
    };

    return &ops;
}
