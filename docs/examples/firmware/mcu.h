/* SPDX-License-Identifier: MIT */
/* What the firmware asks of its microcontroller: a clock, a UART, sleep. */
#ifndef MCU_H
#define MCU_H

#include <stddef.h>
#include <stdint.h>

void mcu_start(void);

/* Since the start, never backwards. */
int64_t mcu_now_us(void);

/* Bytes received since the last call, at most cap. */
size_t mcu_uart_read(uint8_t *bytes, size_t cap);

/* Bytes that mcu_uart_write takes now. */
size_t mcu_uart_room(void);

/* Sends n <= mcu_uart_room() bytes, without waiting. */
void mcu_uart_write(const uint8_t *bytes, size_t n);

/* Sleeps until a byte has come or it is so late. */
void mcu_wait_until(int64_t at_us);

#endif
