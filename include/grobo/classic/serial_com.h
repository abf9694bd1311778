/* SPDX-License-Identifier: MIT */
/**
 * @file serial_com.h
 * @brief SerialCom of the reference document: a serial port, 8N1, that waits.
 *
 * The classic shelf (`-lgrobo-classic`, pkg-config grobo-classic) has the classes of the original
 * C++ library by their own names: `a.b(c)` of a C++ program is `Class_b(&a, c)` here. Overloads
 * have a suffix, which classic.h lists. Members of the document are fields with the same names.
 * Each function is some statements over the main library, which knows more; the functions here are
 * in the order of the document, and have its units and return values.
 *
 * A SerialCom belongs to one thread. Its bytes go to the device as they are: nothing judges them.
 * That of a robot (SerialRobot.com) sends nothing by itself: SerialRobot_sendCommand() does, and
 * its frames are judged.
 * NULL where something must be gives the return value of a failure; nothing happens then.
 */
#ifndef GROBO_CLASSIC_SERIAL_COM_H
#define GROBO_CLASSIC_SERIAL_COM_H

#include <grobo/core/port.h>
#include <grobo/core/serial.h>

GROBO_BEGIN_DECLS

struct SerialRobot;

/** A serial port. Fields that are not the document's are private. */
typedef struct SerialCom {
    const char *device;  /**< name, or NULL; set by SerialCom_setDevPort() */
    int baudrate;        /**< in bits per second, or a B constant of Linux's termios.h */
    int mode;            /**< 1: SerialCom_Read() does not wait; else it does */
    grobo_handle handle; /**< GROBO_HANDLE_NULL when closed */
    /* private */
    grobo_serial *serial;
    struct SerialRobot *robot;
} SerialCom;

/** SerialCom(): a port without a device, 115200 bps, mode 0. @return 0, or -1: no memory. */
GROBO_CLASSIC_API int SerialCom_init(SerialCom *com);
/** SerialCom(devname): the same with a device. @return 0, or -1: no memory, a name too long. */
GROBO_CLASSIC_API int SerialCom_init_devname(SerialCom *com, const char *devname);
/** ~SerialCom(): closes. */
GROBO_CLASSIC_API void SerialCom_deinit(SerialCom *com);
/** new SerialCom(devname); devname may be NULL. @return NULL where SerialCom_init_devname() fails;
 *  freed with SerialCom_delete(). */
GROBO_CLASSIC_API SerialCom *SerialCom_new(const char *devname);
/** delete com. NULL is fine. */
GROBO_CLASSIC_API void SerialCom_delete(SerialCom *com);

/** Sets the device's name (copied). @return 0, or -1: the port is open. */
GROBO_CLASSIC_API int SerialCom_setDevPort(SerialCom *com, const char *devname);
/** Opens the device with the speed of `baudrate`, for this process alone. @return the handle as an
 *  int, -1 on failure. */
GROBO_CLASSIC_API int SerialCom_openPort(SerialCom *com);
/** Closes; `handle` is GROBO_HANDLE_NULL then. */
GROBO_CLASSIC_API void SerialCom_closePort(SerialCom *com);
/** Low-level read: what is there, at most len bytes. In mode 0 it waits for the first byte, 100 ms
 *  and not for ever. @return bytes read, 0: none came, -1 on failure. */
GROBO_CLASSIC_API int SerialCom_Read(SerialCom *com, char *data, int len);
/** Low-level write. @return bytes written, which may be fewer than len, -1 on failure. */
GROBO_CLASSIC_API int SerialCom_Write(SerialCom *com, const char *data, int len);
/** Receives exactly len bytes within 100 ms in all; where fewer are there by then, they are
 *  dropped. @return len, -1 on failure. */
GROBO_CLASSIC_API int SerialCom_recieveData(SerialCom *com, char *data, int len);
/** Sends all len bytes. @return len; -1 on failure, with a message on standard error. */
GROBO_CLASSIC_API int SerialCom_sendData(SerialCom *com, const char *data, int len);
/** Bytes received and not read yet. @return their number, -1 on failure. */
GROBO_CLASSIC_API int SerialCom_chkBuffer(SerialCom *com);
/** Drops the bytes received and not read yet. @return their number, -1 on failure. The original
 *  fails where there are any. */
GROBO_CLASSIC_API int SerialCom_clearBuffer(SerialCom *com);
/** Prints data in hexadecimal, a line on standard error. */
GROBO_CLASSIC_API void SerialCom_printPacket(const SerialCom *com, const char *data, int len);
/** The speed: `baudrate`. */
GROBO_CLASSIC_API int SerialCom_getBaudrate(const SerialCom *com);
/** Sets the speed, of an open port at once. @return rate, -1 where the device refuses it: then the
 *  speed stays. */
GROBO_CLASSIC_API int SerialCom_setBaudrate(SerialCom *com, int rate);
/** The mode. */
GROBO_CLASSIC_API int SerialCom_getMode(const SerialCom *com);
/** Sets the mode of a closed port. @return the mode: where the port is open the one it has, with a
 *  message on standard error. */
GROBO_CLASSIC_API int SerialCom_setMode(SerialCom *com, int m);
/** @return 1 while the port is open, else -1. */
GROBO_CLASSIC_API int SerialCom_isConnected(const SerialCom *com);

GROBO_END_DECLS

#endif
