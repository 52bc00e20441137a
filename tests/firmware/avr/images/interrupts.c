/* SPDX-License-Identifier: MIT */
/* Each path of the port that an interrupt may break into, once when it is told to: ../../interrupts/README.md. Nothing
 * but the port's function stands between the reports of its begin and its end. */
#include <avr/interrupt.h>
#include <avr/io.h>

#include "../../interrupts/avr/calls.h"
#include "fathom_avr.h"

#define PATH(call)                                                                                           \
    do {                                                                                                     \
        GPIOR1 = CALLS_BEGIN;                                                                                \
        call;                                                                                                \
        GPIOR1 = CALLS_END;                                                                                  \
    } while (0)

volatile calls_t calls;

static uint8_t request[CALLS_REQUEST];
/* 8E1, so that parity is looked at; so slow that no character ends by itself while a path runs. */
static const fathom_avr_usart_config_t config = {
    request, sizeof request, {&PORTD, _BV(PORTD3)}, {1200, FATHOM_PARITY_EVEN, 1}};
static const fathom_avr_pin_t pd4 = {&PORTD, _BV(PORTD4)};
static const fathom_avr_pin_t edge_pins[2] = {{&PORTD, _BV(PORTD2)}, {&PORTB, _BV(PORTB0)}};
static fathom_pin_t output, inputs[2];
/* So far apart that both halves of their addresses differ. */
static struct {
    fathom_edges_t edges;
    uint8_t between[250];
} sides[2];
static fathom_capture_t captures[2];

static int16_t receive(void)
{
    uint8_t bytes[CALLS_BYTES];
    fathom_rx_t rx = {0, 0};
    const uint8_t capacity = calls.length;
    int count;
    PATH(count = fathom_avr_usart0.read(NULL, bytes, capacity, &rx));
    for (int i = 0; i < count; i++) calls.bytes[i] = bytes[i];
    calls.flags = rx.flags;
    return (int16_t)count;
}

static int16_t send(void)
{
    uint8_t bytes[CALLS_BYTES];
    const uint8_t length = calls.length;
    for (uint8_t i = 0; i < sizeof bytes; i++) bytes[i] = calls.bytes[i];
    int taken;
    PATH(taken = fathom_avr_usart0.write(NULL, bytes, length));
    return (int16_t)taken;
}

static int16_t set_line(void)
{
    const fathom_line_settings_t line = {calls.baud, calls.parity, calls.stop_bits};
    int result;
    PATH(result = fathom_avr_usart0.set_line(NULL, &line));
    return (int16_t)result;
}

static int16_t take(void)
{
    fathom_pulse_t pulse = {0, 0, false};
    const fathom_capture_t *const capture = &captures[calls.which];
    int result;
    PATH(result = capture->take(capture->ctx, &pulse));
    calls.time_us[0] = pulse.width_us;
    calls.time_us[1] = pulse.end_us;
    calls.is_high = pulse.is_high;
    return (int16_t)result;
}

static int16_t sleep(void)
{
    uint16_t gather_us = calls.gather_us;
    const uint32_t most_us = calls.time_us[0];
    PATH(fathom_avr_idle(gather_us != 0 ? &gather_us : NULL, most_us));
    return 0;
}

static int16_t call(uint8_t what)
{
    const fathom_capture_t *const capture = &captures[calls.which];
    const bool flag = calls.flags != 0;
    uint32_t first_us, second_us;
    int result = 0;
    switch (what) {
    case CALL_NOW: /* twice: it is monotonic */
        PATH(first_us = fathom_avr_clock.now_us(NULL); second_us = fathom_avr_clock.now_us(NULL));
        calls.time_us[0] = first_us;
        calls.time_us[1] = second_us;
        break;
    case CALL_READ:
        return receive();
    case CALL_WRITE:
        return send();
    case CALL_SENT:
        PATH(result = fathom_avr_usart0.sent(NULL));
        break;
    case CALL_LEAVES:
        PATH(first_us = fathom_avr_usart0.leaves_in_us(NULL));
        calls.time_us[0] = first_us;
        break;
    case CALL_SET_LINE:
        return set_line();
    case CALL_SET_BREAK:
        PATH(result = fathom_avr_usart0.set_break(NULL, flag));
        break;
    case CALL_ARM:
        PATH(capture->arm(capture->ctx));
        break;
    case CALL_TAKE:
        return take();
    case CALL_IDLE:
        return sleep();
    case CALL_PIN:
        PATH(output.set(output.ctx, flag));
        break;
    case CALL_ICP1_BEGIN: /* once more, for what int0 feeds too */
        PATH(fathom_avr_icp1_init(&sides[0].edges));
        break;
    case CALL_INT0_BEGIN: /* and the other way round */
        PATH(fathom_avr_int0_init(&sides[1].edges));
        break;
    default:
        return -100;
    }
    return (int16_t)result;
}

int main(void)
{
    fathom_avr_clock_init();
    output = fathom_avr_output(&pd4);
    for (uint8_t i = 0; i < 2; i++) {
        inputs[i] = fathom_avr_input(&edge_pins[i], false);
        fathom_edges_init(&sides[i].edges, &inputs[i]);
        captures[i] = fathom_edges_capture(&sides[i].edges);
    }
    if (!fathom_avr_usart0_init(&config)) GPIOR2 = 1;
    fathom_avr_int0_init(&sides[0].edges);
    fathom_avr_icp1_init(&sides[1].edges);
    sei();
    GPIOR1 = CALLS_READY;
    for (;;) {
        const uint8_t what = calls.call;
        if (what == 0) continue;
        if (calls.is_masked != 0) cli();
        while (calls.is_masked == CALLS_PENDING && (TIFR1 & _BV(TOV1)) == 0) continue;
        calls.result = call(what);
        sei();
        calls.call = 0;
    }
}
