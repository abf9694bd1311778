/* SPDX-License-Identifier: MIT */
/*
 * A GR001 that is a microcontroller: what a host writes to its UART goes to the simulated board and
 * servos, what they answer goes back. Nothing here knows which microcontroller it is.
 *
 * The wires' time is the simulator's business, since an emulated UART takes none. Between a UART
 * that does and real servos, the same loop moves bytes and asks nothing but the clock.
 */
#include <grobo/core/sim_static.h>

#include "mcu.h"

static grobo_sim sim;

static size_t smaller(size_t a, size_t b)
{
    return a < b ? a : b;
}

int main(void)
{
    uint8_t bytes[64];
    mcu_start();
    if (grobo_sim_init(&sim, NULL, mcu_now_us()) < 0) {
        return 1;
    }
    for (;;) {
        size_t n = mcu_uart_read(bytes, smaller(sizeof bytes, grobo_sim_rx_room(&sim)));
        (void)grobo_sim_rx(&sim, bytes, n, mcu_now_us());
        n = grobo_sim_tx(&sim, bytes, smaller(sizeof bytes, mcu_uart_room()), mcu_now_us());
        mcu_uart_write(bytes, n);
        mcu_wait_until(grobo_sim_deadline(&sim));
    }
}
