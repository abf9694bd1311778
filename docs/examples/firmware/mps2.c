/* SPDX-License-Identifier: MIT */
/*
 * ARM's MPS2 boards, as QEMU emulates them (mps2-an385: Cortex-M3, mps2-an386: Cortex-M4): UART 0,
 * timer 0 as the clock, timer 1 as the alarm, and the start. Application note AN385; the CMSDK
 * peripherals are in the Cortex-M System Design Kit Technical Reference Manual.
 */
#include <stdbool.h>

#include "mcu.h"

enum {
    CLOCK_MHZ = 25,
    BAUD_BPS = 115200,
    RING_BYTES = 512, /* a power of two: longer than two frames of 20 joints */
    RING_MASK = RING_BYTES - 1,
    CPU_VECTORS = 16,
    UART_RX_IRQ = 0,
    UART_TX_IRQ = 1,
    CLOCK_IRQ = 8,
    ALARM_IRQ = 9,
    IRQS
};

typedef struct uart_registers {
    volatile uint32_t data, state, control, interrupt, divider;
} uart_registers;

typedef struct timer_registers {
    volatile uint32_t control, value, reload, interrupt;
} timer_registers;

#define UART ((uart_registers *)0x40004000u)
#define CLOCK ((timer_registers *)0x40000000u)
#define ALARM ((timer_registers *)0x40001000u)
#define NVIC_ENABLE (*(volatile uint32_t *)0xE000E100u)

/* Bits of the registers. */
enum {
    UART_TX_FULL = 0x1,
    UART_RX_FULL = 0x2,
    UART_ON = 0x1 | 0x2 | 0x4 | 0x8, /* both directions, both interrupts */
    UART_TX_DONE = 0x1,
    UART_RX_DONE = 0x2,
    TIMER_ON = 0x1 | 0x8, /* counts, interrupts */
    TIMER_DONE = 0x1
};

/* One side puts, the other takes; the counts run freely. */
typedef struct ring {
    volatile uint32_t put, taken;
    uint8_t byte[RING_BYTES];
} ring;

static ring received, to_send;
static volatile bool sending;
static volatile uint32_t clock_wraps;

static void mask_interrupts(void)
{
    __asm__ volatile("cpsid i" ::: "memory");
}

static void unmask_interrupts(void)
{
    __asm__ volatile("cpsie i" ::: "memory");
}

static bool is_full(const ring *r)
{
    return r->put - r->taken == RING_BYTES;
}

static void put(ring *r, uint8_t byte)
{
    r->byte[r->put & RING_MASK] = byte;
    r->put++;
}

static uint8_t take(ring *r)
{
    uint8_t byte = r->byte[r->taken & RING_MASK];
    r->taken++;
    return byte;
}

/* ---- UART ---------------------------------------------------------------------------------- */

/* A byte that finds the ring full is lost, as on any line: the protocol's timeouts deal with it. */
static void on_received(void)
{
    UART->interrupt = UART_RX_DONE; /* before the look, or the next byte's is lost */
    while ((UART->state & UART_RX_FULL) != 0) {
        uint8_t byte = (uint8_t)UART->data;
        if (!is_full(&received)) {
            put(&received, byte);
        }
    }
}

static void on_sent(void)
{
    UART->interrupt = UART_TX_DONE;
    sending = to_send.put != to_send.taken;
    if (sending) {
        UART->data = take(&to_send);
    }
}

size_t mcu_uart_read(uint8_t *bytes, size_t cap)
{
    size_t n = 0;
    while (n < cap && received.put != received.taken) {
        bytes[n++] = take(&received);
    }
    return n;
}

size_t mcu_uart_room(void)
{
    return RING_BYTES - (to_send.put - to_send.taken);
}

void mcu_uart_write(const uint8_t *bytes, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        put(&to_send, bytes[i]);
    }
    mask_interrupts();
    if (!sending && n > 0) {
        sending = true;
        UART->data = take(&to_send);
    }
    unmask_interrupts();
}

/* ---- time ---------------------------------------------------------------------------------- */

static void on_clock_wrap(void)
{
    CLOCK->interrupt = TIMER_DONE;
    clock_wraps++;
}

static void on_alarm(void)
{
    ALARM->control = 0;
    ALARM->interrupt = TIMER_DONE;
}

int64_t mcu_now_us(void)
{
    mask_interrupts();
    uint64_t wraps = clock_wraps;
    uint32_t left = CLOCK->value;
    if ((CLOCK->interrupt & TIMER_DONE) != 0) { /* not counted yet */
        wraps++;
        left = CLOCK->value;
    }
    unmask_interrupts();
    return (int64_t)((wraps << 32 | (UINT32_MAX - left)) / CLOCK_MHZ);
}

void mcu_wait_until(int64_t at_us)
{
    int64_t wait_us = at_us - mcu_now_us();
    if (wait_us <= 0) {
        return;
    }
    mask_interrupts(); /* one that comes from here on ends the sleep all the same */
    if (wait_us < UINT32_MAX / CLOCK_MHZ) {
        ALARM->control = 0;
        ALARM->reload = (uint32_t)wait_us * CLOCK_MHZ;
        ALARM->value = (uint32_t)wait_us * CLOCK_MHZ;
        ALARM->control = TIMER_ON;
    } /* else the clock's wrap wakes us before */
    if (received.put == received.taken) {
        __asm__ volatile("wfi");
    }
    unmask_interrupts();
}

/* ---- start --------------------------------------------------------------------------------- */

void mcu_start(void)
{
    UART->divider = CLOCK_MHZ * 1000000u / BAUD_BPS;
    UART->control = UART_ON;
    CLOCK->reload = UINT32_MAX;
    CLOCK->value = UINT32_MAX;
    CLOCK->control = TIMER_ON;
    NVIC_ENABLE = 1u << UART_RX_IRQ | 1u << UART_TX_IRQ | 1u << CLOCK_IRQ | 1u << ALARM_IRQ;
}

int main(void);

/* From mps2.ld. */
extern uint32_t ld_stack_top[], ld_data_load[], ld_data[], ld_data_end[], ld_bss_end[];

static void stop(void)
{
    for (;;) {
    }
}

static void reset(void)
{
    const uint32_t *from = ld_data_load;
    uint32_t *to = ld_data;
    while (to < ld_data_end) {
        *to++ = *from++;
    }
    while (to < ld_bss_end) {
        *to++ = 0;
    }
    (void)main();
    stop();
}

/* The first vector is the stack, the others are functions. */
typedef union vector {
    uint32_t *stack;
    void (*handler)(void);
} vector;

extern const vector vectors[];
const vector vectors[CPU_VECTORS + IRQS] __attribute__((section(".vectors"))) = {
    [0] = {.stack = ld_stack_top},
    [1] = {.handler = reset},
    [2] = {.handler = stop}, /* NMI */
    [3] = {.handler = stop}, /* hard fault */
    [CPU_VECTORS + UART_RX_IRQ] = {.handler = on_received},
    [CPU_VECTORS + UART_TX_IRQ] = {.handler = on_sent},
    [CPU_VECTORS + CLOCK_IRQ] = {.handler = on_clock_wrap},
    [CPU_VECTORS + ALARM_IRQ] = {.handler = on_alarm},
};
