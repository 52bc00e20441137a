/* SPDX-License-Identifier: MIT */
/* The port's functions, called one by one by a test that writes what it wants into `remote`: see ../remote.h. */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <util/delay_basic.h>

#include "../remote_calls.h"
#include "fathom_avr.h"

volatile remote_t remote;

static uint8_t request[REMOTE_REQUEST];
static fathom_avr_usart_config_t configs[2]; /* the one that the port has, and one to try */
static uint8_t used;
static const fathom_avr_pin_t pd4 = {&PORTD, _BV(PORTD4)};
static fathom_pin_t output;

static fathom_line_settings_t settings(void)
{
    const fathom_line_settings_t line = {remote.baud, remote.parity, remote.stop_bits};
    return line;
}

static int16_t begin(void)
{
    fathom_avr_usart_config_t *const config = &configs[used ^ 1];
    config->request = request;
    config->request_size = remote.length;
    config->driver.port = remote.flags != 0 ? &PORTD : NULL;
    config->driver.mask = _BV(PORTD3);
    config->line = settings();
    if (!fathom_avr_usart0_init(config)) return 0;
    used ^= 1;
    return 1;
}

static int16_t receive(void)
{
    uint8_t bytes[REMOTE_BYTES];
    fathom_rx_t rx = {0, 0};
    GPIOR1 = REMOTE_MARK; /* what the test times by: the read begins now */
    const int count = fathom_avr_usart0.read(NULL, bytes, remote.length, &rx);
    for (int i = 0; i < count; i++) remote.bytes[i] = bytes[i];
    remote.flags = rx.flags;
    return (int16_t)count;
}

static int16_t send(void)
{
    uint8_t bytes[REMOTE_BYTES];
    for (uint8_t i = 0; i < remote.length; i++) bytes[i] = remote.bytes[i];
    const int taken = fathom_avr_usart0.write(NULL, bytes, remote.length);
    for (uint8_t i = 0; i < sizeof bytes; i++) bytes[i] = 0xEE; /* the port may not keep the pointer */
    __asm__ volatile("" : : "r"(bytes) : "memory");
    return (int16_t)taken;
}

static int16_t call(uint8_t what)
{
    const fathom_line_settings_t line = settings();
    switch (what) {
    case REMOTE_BEGIN:
        return begin();
    case REMOTE_READ:
        return receive();
    case REMOTE_WRITE:
        return send();
    case REMOTE_SENT:
        return fathom_avr_usart0.sent(NULL);
    case REMOTE_LEAVES:
        remote.time_us = fathom_avr_usart0.leaves_in_us(NULL);
        return 0;
    case REMOTE_SET_LINE:
        return (int16_t)fathom_avr_usart0.set_line(NULL, &line);
    case REMOTE_SET_BREAK:
        return (int16_t)fathom_avr_usart0.set_break(NULL, remote.flags != 0);
    case REMOTE_PIN:
        GPIOR1 = REMOTE_MARK;
        output.set(output.ctx, remote.flags != 0);
        return 0;
    case REMOTE_IDLE:
        fathom_avr_idle(NULL, remote.time_us);
        return 0;
    default:
        break;
    }
    return -100;
}

/* The clock, over and over, each time after `length` * 1024 cycles with interrupts off; 0: they stay on. */
static void watch_clock(void)
{
    while (remote.call == REMOTE_CLOCK) {
        if (remote.length != 0) {
            cli();
            _delay_loop_2(remote.length * 256U);
        }
        GPIOR1 = REMOTE_MARK;
        const uint32_t us = fathom_avr_clock.now_us(NULL);
        sei();
        GPIOR0 = (uint8_t)us;
        GPIOR0 = (uint8_t)(us >> 8);
        GPIOR0 = (uint8_t)(us >> 16);
        GPIOR0 = (uint8_t)(us >> 24);
        GPIOR1 = REMOTE_CLOCK;
    }
}

int main(void)
{
    fathom_avr_clock_init();
    output = fathom_avr_output(&pd4);
    sei();
    GPIOR1 = REMOTE_READY;
    for (;;) {
        const uint8_t what = remote.call;
        if (what == REMOTE_CLOCK) watch_clock();
        if (what == 0 || what == REMOTE_CLOCK) continue;
        remote.result = call(what);
        remote.call = 0;
    }
}
