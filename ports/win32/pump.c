/* SPDX-License-Identifier: MIT */
/*
 * A thread that moves bytes between a serial port, by overlapped I/O, and one end of a socket pair:
 * an event loop can wait on the other end, and not on a COM port.
 */
#include <string.h>

#include "ports/win32/win32.h"

/* How long close() lets bytes leave that were written before it. */
enum { DRAIN_MS = 500, DISCARD_MS = 200 };

static bool failed(const grobo_i_win32_pump *p)
{
    return p->failure != 0;
}

static void fail(grobo_i_win32_pump *p, DWORD code)
{
    if (!failed(p)) {
        InterlockedExchange(&p->failure, (LONG)(code != 0 ? code : ERROR_GEN_FAILURE));
    }
}

/* What became of an operation that was begun: true, or false where it is still under way. */
static bool is_over(grobo_i_win32_pump *p, grobo_i_win32_way *way, DWORD *moved)
{
    if (!way->busy) {
        return false;
    }
    if (GetOverlappedResult(p->com, &way->io, moved, FALSE)) {
        way->busy = false;
    } else if (GetLastError() != ERROR_IO_INCOMPLETE) {
        way->busy = false;
        fail(p, GetLastError());
    }
    if (!way->busy) {
        ResetEvent(way->io.hEvent);
    }
    return !way->busy && !failed(p);
}

/* ---- received bytes: port to socket ------------------------------------------------------- */

/* Bytes that the driver holds; 0 also where it does not say. */
static DWORD queued(grobo_i_win32_pump *p)
{
    COMSTAT status = {0};
    DWORD errors;

    return ClearCommError(p->com, &errors, &status) ? status.cbInQue : 0;
}

/*
 * Asks for what is there, or for one byte and so for the moment when something comes: the timeouts
 * that return what is there (MAXDWORD) are not understood by every driver, nor by wine.
 */
static void begin_read(grobo_i_win32_pump *p, DWORD wanted)
{
    grobo_i_win32_way *rx = &p->rx;
    DWORD room = sizeof rx->bytes - rx->used;

    wanted = wanted == 0 ? 1 : wanted > room ? room : wanted;
    rx->busy = true;
    if (!ReadFile(p->com, rx->bytes + rx->used, wanted, NULL, &rx->io) &&
        GetLastError() != ERROR_IO_PENDING) {
        rx->busy = false;
        fail(p, GetLastError());
    }
}

/* Gives the socket what it takes. What is left waits for room, and so does the port. */
static void forward(grobo_i_win32_pump *p)
{
    grobo_i_win32_way *rx = &p->rx;

    while (rx->at < rx->used) {
        int put = send(p->far_socket, rx->bytes + rx->at, (int)(rx->used - rx->at), 0);

        if (put == SOCKET_ERROR) {
            /* Nobody reads any more: close() is under way. */
            if (WSAGetLastError() != WSAEWOULDBLOCK) {
                rx->at = rx->used;
            }
            break;
        }
        rx->at += (DWORD)put;
    }
    if (rx->at == rx->used && !rx->busy) {
        rx->at = 0;
        rx->used = 0;
    }
}

static void receive(grobo_i_win32_pump *p)
{
    grobo_i_win32_way *rx = &p->rx;
    DWORD got;

    while (is_over(p, rx, &got)) {
        DWORD more;

        if (got == 0) {
            /* Reads here have no timeout: the end of the line. */
            fail(p, ERROR_HANDLE_EOF);
            break;
        }
        rx->used += got;
        more = queued(p);
        if (more == 0 || rx->used == sizeof rx->bytes) {
            break;
        }
        begin_read(p, more);
    }
    forward(p);
    if (!rx->busy && rx->used == 0 && !failed(p)) {
        begin_read(p, queued(p));
    }
}

/* ---- bytes to send: socket to port -------------------------------------------------------- */

static void begin_write(grobo_i_win32_pump *p)
{
    grobo_i_win32_way *tx = &p->tx;

    tx->busy = true;
    if (!WriteFile(p->com, tx->bytes + tx->at, tx->used - tx->at, NULL, &tx->io) &&
        GetLastError() != ERROR_IO_PENDING) {
        tx->busy = false;
        fail(p, GetLastError());
    }
}

/* Takes bytes from the socket; false when there are none now. */
static bool fetch(grobo_i_win32_pump *p)
{
    grobo_i_win32_way *tx = &p->tx;
    int got = p->near_gone ? SOCKET_ERROR : recv(p->far_socket, tx->bytes, sizeof tx->bytes, 0);

    if (got == 0 || (got < 0 && WSAGetLastError() != WSAEWOULDBLOCK)) {
        p->near_gone = true;
    }
    tx->at = 0;
    tx->used = got > 0 ? (DWORD)got : 0;
    return got > 0;
}

static void transmit(grobo_i_win32_pump *p)
{
    grobo_i_win32_way *tx = &p->tx;
    DWORD put;

    if (is_over(p, tx, &put)) {
        tx->at += put;
    }
    while (!tx->busy && !failed(p) && (tx->at < tx->used || fetch(p))) {
        begin_write(p);
        if (is_over(p, tx, &put)) {
            tx->at += put;
        }
    }
}

/* Takes an operation back, and waits until the system has let go of its buffer. */
static void cancel(grobo_i_win32_pump *p, grobo_i_win32_way *way)
{
    DWORD moved;

    if (way->busy) {
        (void)CancelIoEx(p->com, &way->io);
        (void)GetOverlappedResult(p->com, &way->io, &moved, TRUE);
        way->busy = false;
    }
}

static void drop_output(grobo_i_win32_pump *p)
{
    cancel(p, &p->tx);
    (void)PurgeComm(p->com, PURGE_TXABORT | PURGE_TXCLEAR);
    while (fetch(p)) {
    }
    p->tx.at = 0;
    p->tx.used = 0;
    SetEvent(p->discarded);
}

/* ---- the thread --------------------------------------------------------------------------- */

/* Everything is tried whenever anything happens: which it was need not be known. */
static GROBO_THREAD_FUNC run(void *arg)
{
    grobo_i_win32_pump *p = arg;
    const HANDLE happenings[] = {p->stop, p->discard, p->rx.io.hEvent, p->tx.io.hEvent, p->moved};
    const DWORD count = sizeof happenings / sizeof happenings[0];
    DWORD which = WAIT_TIMEOUT;

    while (which != WAIT_OBJECT_0 && !failed(p) && !(p->near_gone && !p->tx.busy)) {
        WSANETWORKEVENTS seen;

        if (which == WAIT_OBJECT_0 + 1) {
            drop_output(p);
        }
        /* Before what they tell is used up, so that none is lost. */
        (void)WSAEnumNetworkEvents(p->far_socket, p->moved, &seen);
        receive(p);
        transmit(p);
        if (!failed(p) && !(p->near_gone && !p->tx.busy)) {
            which = WaitForMultipleObjects(count, happenings, FALSE, INFINITE);
            if (which == WAIT_FAILED) {
                fail(p, GetLastError());
            }
        }
    }
    cancel(p, &p->rx);
    cancel(p, &p->tx);
    /* The other end reads what came before, and then that it is over. */
    (void)shutdown(p->far_socket, SD_SEND);
    GROBO_THREAD_RETURN;
}

/* ---- for serial.c ------------------------------------------------------------------------- */

static void close_events(grobo_i_win32_pump *p)
{
    HANDLE all[] = {p->stop, p->discard, p->discarded, p->rx.io.hEvent, p->tx.io.hEvent, p->moved};

    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        if (all[i] != NULL) {
            CloseHandle(all[i]);
        }
    }
}

static bool make_events(grobo_i_win32_pump *p)
{
    HANDLE *all[] = {&p->stop,         &p->discard,      &p->discarded,
                     &p->rx.io.hEvent, &p->tx.io.hEvent, &p->moved};

    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        /* Of an operation: stays set until the next begins, so that it is not missed. */
        bool manual = all[i] == &p->rx.io.hEvent || all[i] == &p->tx.io.hEvent;

        *all[i] = CreateEventA(NULL, manual, FALSE, NULL);
        if (*all[i] == NULL) {
            return false;
        }
    }
    return WSAEventSelect(p->far_socket, p->moved, FD_READ | FD_WRITE | FD_CLOSE) == 0;
}

int grobo_i_win32_pump_start(grobo_port *port, grobo_os_cause *cause)
{
    grobo_i_win32_pump *p = &port->pump;
    SOCKET pair[2];
    int r = grobo_i_win32_socket_pair(pair, cause);

    if (r < 0) {
        return r;
    }
    memset(p, 0, sizeof *p);
    p->com = port->com;
    p->far_socket = pair[1];
    port->socket = pair[0];
    r = make_events(p) ? grobo_thread_start(&p->thread, run, p) : GROBO_ERR_NOMEM;
    if (r < 0) {
        close_events(p);
        closesocket(pair[0]);
        closesocket(pair[1]);
        return grobo_i_port_refuse(cause, r, "no thread or event for the port");
    }
    return GROBO_OK;
}

void grobo_i_win32_pump_stop(grobo_port *port)
{
    grobo_i_win32_pump *p = &port->pump;

    (void)shutdown(port->socket, SD_SEND);
    if (WaitForSingleObject(p->thread, DRAIN_MS) != WAIT_OBJECT_0) {
        SetEvent(p->stop);
    }
    (void)grobo_thread_join(p->thread);
    close_events(p);
    closesocket(p->far_socket);
    closesocket(port->socket);
    port->socket = INVALID_SOCKET;
}

void grobo_i_win32_pump_discard(grobo_port *port)
{
    const HANDLE either[] = {port->pump.discarded, port->pump.thread};

    SetEvent(port->pump.discard);
    (void)WaitForMultipleObjects(2, either, FALSE, DISCARD_MS);
}
