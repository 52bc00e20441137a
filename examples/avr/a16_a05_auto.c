/* SPDX-License-Identifier: MIT */
/*
 * ATmega328P at 16 MHz, which has one UART, with an A16 and an A05 of automatic UART output: a two-way multiplexer
 * gives RXD to the one and then to the other.
 *
 *   A16 pin 4 (TX)   input 0 of a 74HC4053 or the like; its RX pin stays open: processed values
 *   A05 TX           input 1; its RX pin stays open
 *   PD4, Arduino 4   the select: low is the A16, high the A05
 *   PD0 (RXD)        the output of the multiplexer
 *   PD1 (TXD)        text at 9600 8N1, as RX and TX share the rate: "A16 1234 mm", "A05 2 nothing in range"
 *
 * Each sensor is listened to until a frame of it has come, or for LISTEN_US, which is longer than the two frame periods
 * that it takes at worst: the first one may begin before the turn. Frames that come meanwhile from the other are not
 * heard. So a sensor is stale only when nothing good of it has come for STALE_US, in which it has its turn at least
 * twice, also beside one that is dead.
 */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/pgmspace.h>

#include "channel.h"
#include "fathom/sensor/a05_auto.h"
#include "fathom/sensor/a16_auto.h"
#include "fathom_avr.h"
#include "text.h"

#define LISTEN_US 1000000ul
#define STALE_US  4000000ul
#define BUSY_US   1000u

enum { A16 = 0, A05 = 1, SENSORS = 2, PROBES = 4 };

static const fathom_avr_pin_t select_at = {&PORTD, _BV(PD4)};

static uint8_t sending[TEXT_SIZE];
static const fathom_avr_usart_config_t usart = {
    .request = sending, .request_size = sizeof sending, .line = {9600, FATHOM_PARITY_NONE, 1}};

/* A sensor that is listened to: its channel, and the line on it. */
typedef struct {
    channel_t channel;
    fathom_uart_t uart;
    uint8_t frame[8]; /* the least that a line takes; nothing is requested here */
    fathom_line_parts_t parts;
    fathom_line_t line;
} receiver_t;

static receiver_t receivers[SENSORS];
static fathom_a16_auto_t a16;
static fathom_a05_auto_t a05;
static fathom_sensor_t sensors[SENSORS];
static fathom_pin_t select;
static uint8_t selected; /* A16 or A05 */
static uint32_t turned_us;

static uint32_t now_us(void) { return fathom_avr_clock.now_us(fathom_avr_clock.ctx); }

static bool begin_receiver(receiver_t *receiver)
{
    receiver->channel.uart = &fathom_avr_usart0;
    receiver->uart = channel_uart(&receiver->channel);
    receiver->parts.uart = &receiver->uart;
    receiver->parts.clock = &fathom_avr_clock;
    receiver->parts.frame = receiver->frame;
    receiver->parts.frame_size = sizeof receiver->frame;
    receiver->parts.marks = fathom_line_marks;
    return fathom_line_init_listening(&receiver->line, &receiver->parts) == FATHOM_OK;
}

static void turn_to(uint8_t next)
{
    channel_turn(&receivers[selected].channel, &receivers[next].channel, &select, next == A05);
    selected = next;
    turned_us = now_us();
}

static bool begin(void)
{
    fathom_avr_clock_init();
    select = fathom_avr_output(&select_at);
    if (!fathom_avr_usart0_init(&usart)) return false;
    sei();
    if (!begin_receiver(&receivers[A16]) || !begin_receiver(&receivers[A05])) return false;
    const fathom_a16_auto_config_t one = {.stale_us = STALE_US};
    const fathom_a05_auto_config_t four = {.stale_us = STALE_US};
    if (fathom_a16_auto_init(&a16, &receivers[A16].line, &one) != FATHOM_OK) return false;
    if (fathom_a05_auto_init(&a05, &receivers[A05].line, &four) != FATHOM_OK) return false;
    sensors[A16] = fathom_a16_auto_sensor(&a16);
    sensors[A05] = fathom_a05_auto_sensor(&a05);
    turn_to(A16);
    return true;
}

typedef enum { NOTHING, MORE, ALL } printed_t;

/* One line of text, if this sensor has news; ALL: this was the last line of its frame. */
static printed_t print(text_t *text, uint8_t which)
{
    fathom_sample_t sample;
    const fathom_status_t status = fathom_poll(&sensors[which], &sample);
    if (status == FATHOM_PENDING) return NOTHING;
    text_say(text, which == A16 ? PSTR("A16 ") : PSTR("A05 "));
    if (status == FATHOM_OK) {
        if (which == A05) {
            text_number(text, sample.probe);
            text_say(text, PSTR(" "));
        }
        text_sample(text, &sample);
    } else {
        text_error(text, status);
    }
    text_say(text, PSTR("\r\n"));
    return status == FATHOM_OK && which == A05 && sample.probe != PROBES ? MORE : ALL;
}

/* How long nothing but a byte can bring anything. */
static uint32_t idle_us(void)
{
    const uint32_t passed_us = fathom_elapsed_us(now_us(), turned_us);
    const uint32_t left_us = passed_us < LISTEN_US ? LISTEN_US - passed_us : 0;
    const uint32_t due_us = fathom_due_us(sensors, SENSORS);
    return due_us < left_us ? due_us : left_us;
}

int main(void)
{
    if (!begin()) return 1;
    text_t text = {0};
    for (;;) {
        if (!text_send(&text, &fathom_avr_usart0)) {
            /* The line of text before is still leaving; the next one waits. An A05 has four at a time. */
            fathom_line_poll(&receivers[selected].line);
            fathom_avr_idle(NULL, BUSY_US);
            continue;
        }
        const uint8_t other = (uint8_t)(1 - selected);
        const printed_t printed = print(&text, selected);
        const bool is_long = fathom_elapsed_us(now_us(), turned_us) >= LISTEN_US;
        if (printed == ALL || (printed == NOTHING && is_long))
            turn_to(other);
        else if (printed == NOTHING && print(&text, other) == NOTHING) /* STALE, or a frame more */
            fathom_avr_idle(NULL, idle_us());
    }
}
