/* SPDX-License-Identifier: MIT */
/* SerialCom of the classic shelf, on a grobo_serial; that of a robot asks its runner. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "src/classic/classic.h"

/* Where the speed is a constant of Linux's termios.h: B50 to B38400 are 1 to 15, the faster ones
 * follow 4096. No line has these speeds, so a number of bits per second is never meant. */
static int bps_of(int baudrate)
{
    static const int slow[] = {50,   75,   110,  134,  150,  200,   300,  600,
                               1200, 1800, 2400, 4800, 9600, 19200, 38400};
    static const int fast[] = {57600,   115200,  230400,  460800,  500000,
                               576000,  921600,  1000000, 1152000, 1500000,
                               2000000, 2500000, 3000000, 3500000, 4000000};
    const int count = (int)(sizeof slow / sizeof slow[0]);

    if (baudrate >= 1 && baudrate <= count) {
        return slow[baudrate - 1];
    }
    return baudrate > 4096 && baudrate <= 4096 + count ? fast[baudrate - 4097] : baudrate;
}

static bool is_open(const SerialCom *com)
{
    return com->robot != NULL ? grobo_runner_is_connected(com->robot->inside->runner)
                              : grobo_serial_is_open(com->serial);
}

/* True for a port that a program has to itself. */
static bool is_own(const SerialCom *com)
{
    return com != NULL && com->serial != NULL;
}

/* ---- making ------------------------------------------------------------------------------- */

int SerialCom_init(SerialCom *com)
{
    return SerialCom_init_devname(com, NULL);
}

int SerialCom_init_devname(SerialCom *com, const char *devname)
{
    if (com == NULL) {
        return -1;
    }
    const grobo_serial_config config = {GROBO_SERIAL_CONFIG_INIT, .device = devname};
    *com = (SerialCom){.baudrate = GROBO_BAUD_DEFAULT_BPS, .handle = GROBO_HANDLE_NULL};
    if (grobo_serial_new(&config, &com->serial) < 0) {
        return -1;
    }
    com->device = grobo_serial_device(com->serial);
    return 0;
}

void SerialCom_deinit(SerialCom *com)
{
    if (com != NULL) {
        grobo_serial_free(com->serial);
        *com = (SerialCom){.handle = GROBO_HANDLE_NULL};
    }
}

SerialCom *SerialCom_new(const char *devname)
{
    SerialCom *com = malloc(sizeof *com);

    if (com != NULL && SerialCom_init_devname(com, devname) < 0) {
        free(com);
        return NULL;
    }
    return com;
}

void SerialCom_delete(SerialCom *com)
{
    SerialCom_deinit(com);
    free(com);
}

/* ---- the port ----------------------------------------------------------------------------- */

int SerialCom_setDevPort(SerialCom *com, const char *devname)
{
    if (com != NULL && com->robot != NULL) {
        return SerialRobot_setDevice(com->robot, devname);
    }
    if (!is_own(com) || grobo_serial_set_device(com->serial, devname) < 0) {
        return -1;
    }
    com->device = grobo_serial_device(com->serial);
    return 0;
}

int SerialCom_openPort(SerialCom *com)
{
    if (com != NULL && com->robot != NULL) {
        return SerialRobot_openPort(com->robot);
    }
    if (!is_own(com) || grobo_serial_set_baud(com->serial, bps_of(com->baudrate)) < 0 ||
        grobo_serial_open(com->serial) < 0) {
        return -1;
    }
    com->handle = grobo_serial_handle(com->serial);
    return (int)(intptr_t)com->handle;
}

void SerialCom_closePort(SerialCom *com)
{
    if (com != NULL && com->robot != NULL) {
        (void)SerialRobot_closePort(com->robot);
    } else if (is_own(com)) {
        grobo_serial_close(com->serial);
        com->handle = GROBO_HANDLE_NULL;
    }
}

/* ---- bytes -------------------------------------------------------------------------------- */

int SerialCom_Read(SerialCom *com, char *data, int len)
{
    if (!is_own(com) || data == NULL || len < 0) {
        return -1;
    }
    int waiting = com->mode == 1 ? grobo_serial_waiting(com->serial) : 1;
    if (waiting > 0) {
        waiting = grobo_serial_read(com->serial, data, (size_t)len);
    }
    return waiting < 0 ? -1 : waiting;
}

int SerialCom_recieveData(SerialCom *com, char *data, int len)
{
    bool failed = !is_own(com) || data == NULL || len < 0 ||
                  grobo_serial_receive(com->serial, data, (size_t)len) < 0;

    return failed ? -1 : len;
}

int SerialCom_Write(SerialCom *com, const char *data, int len)
{
    if (!is_own(com) || data == NULL || len < 0) {
        return -1;
    }
    int sent = grobo_serial_write(com->serial, data, (size_t)len);
    return sent < 0 ? -1 : sent;
}

int SerialCom_sendData(SerialCom *com, const char *data, int len)
{
    int sent = is_own(com) && data != NULL && len >= 0
                   ? grobo_serial_send(com->serial, data, (size_t)len)
                   : GROBO_ERR_ARG;

    if (sent < 0) {
        fprintf(stderr, "SerialCom_sendData: %s\n", grobo_error_text(sent));
        return -1;
    }
    return sent;
}

int SerialCom_chkBuffer(SerialCom *com)
{
    int waiting = is_own(com) ? grobo_serial_waiting(com->serial) : -1;

    return waiting < 0 ? -1 : waiting;
}

int SerialCom_clearBuffer(SerialCom *com)
{
    int dropped = is_own(com) ? grobo_serial_discard(com->serial) : -1;

    return dropped < 0 ? -1 : dropped;
}

void SerialCom_printPacket(const SerialCom *com, const char *data, int len)
{
    (void)com;
    if (data != NULL && len > 0) {
        (void)grobo_hex_print(data, (size_t)len, stderr);
    }
}

/* ---- speed and mode ----------------------------------------------------------------------- */

int SerialCom_getBaudrate(const SerialCom *com)
{
    return com != NULL ? com->baudrate : -1;
}

int SerialCom_setBaudrate(SerialCom *com, int rate)
{
    if (!is_own(com) || grobo_serial_set_baud(com->serial, bps_of(rate)) < 0) {
        return -1;
    }
    com->baudrate = rate;
    return rate;
}

int SerialCom_getMode(const SerialCom *com)
{
    return com != NULL ? com->mode : -1;
}

int SerialCom_setMode(SerialCom *com, int m)
{
    if (com == NULL) {
        return -1;
    }
    if (SerialCom_isConnected(com) > 0) {
        fputs("SerialCom_setMode: the port is open: close it first\n", stderr);
    } else {
        com->mode = m;
    }
    return com->mode;
}

int SerialCom_isConnected(const SerialCom *com)
{
    return com != NULL && (com->robot != NULL || com->serial != NULL) && is_open(com) ? 1 : -1;
}
