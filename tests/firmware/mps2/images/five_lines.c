/* SPDX-License-Identifier: MIT */
/*
 * Five sensors, each on a UART of its own and each in its own way, served by one loop:
 *
 *   UART 0  A16, Modbus, address 1                 9600 8N1
 *   UART 1  A05, Modbus, address 1                 9600 8N1
 *   UART 2  HPS-167S, Modbus, address 1           19200 8N1: these UARTs have no parity (fathom_mps2.h)
 *   UART 3  A16 that sends by itself               9600 8N1
 *   UART 4  A05 with 55 AA, address 1              9600 8N1
 *
 *   qemu-system-arm -M mps2-an385 -kernel five_lines.elf -display none -monitor none \
 *       -semihosting-config enable=on,target=native,arg=five_lines,arg=20,arg=23 \
 *       -chardev serial,id=a,path=/dev/pts/3 -serial chardev:a -serial null ...
 *
 * prints each reading and each error, and ends with status 0 when each of some lines has had some readings. The
 * words tell how many, 1..9999 (else 10), and which: the sum of 1 for UART 0, 2, 4, 8, 16 (else 31, all of them).
 */
#include "fathom/fathom.h"
#include "fathom_mps2.h"
#include "semihosting.h"
#include "start.h"
#include "tell.h"

enum { TANK = 0, BUMPER = 1, GATE = 2, SILO = 3, REAR = 4, LINES = 5, ALL = (1 << LINES) - 1 };

static const char *const names[LINES] = {"tank", "bumper", "gate", "silo", "rear"};

typedef struct {
    uint8_t request[8];
    uint8_t frame[32];
    fathom_uart_t uart;
    fathom_line_parts_t config;
    fathom_line_t line;
    fathom_modbus_t modbus;
} lane_t;

/* All memory; nothing is allocated. */
static fathom_mps2_uart_t uarts[LINES];
static lane_t lanes[LINES];
static fathom_a16_modbus_t tank;
static fathom_a05_modbus_t bumper;
static fathom_hps167s_t gate;
static fathom_a16_auto_t silo;
static fathom_a05_dyp_t rear;

void uart0_interrupt(void) { fathom_mps2_uart_interrupt(&uarts[0]); }
void uart1_interrupt(void) { fathom_mps2_uart_interrupt(&uarts[1]); }
void uart2_interrupt(void) { fathom_mps2_uart_interrupt(&uarts[2]); }
void uart3_interrupt(void) { fathom_mps2_uart_interrupt(&uarts[3]); }
void uart4_interrupt(void) { fathom_mps2_uart_interrupt(&uarts[4]); }
void timer0_interrupt(void) { fathom_mps2_timer0_interrupt(); }

static bool begin_line(uint8_t number, uint32_t baud)
{
    lane_t *const lane = &lanes[number];
    const fathom_mps2_uart_config_t config = {
        .request = lane->request,
        .request_size = sizeof lane->request,
        .number = number,
        .line = {baud, FATHOM_PARITY_NONE, 1},
    };
    if (!fathom_mps2_uart_begin(&uarts[number], &config)) return false;
    lane->uart = fathom_mps2_uart(&uarts[number]);
    lane->config = (fathom_line_parts_t){
        .uart = &lane->uart,
        .clock = &fathom_mps2_clock,
        .frame = lane->frame,
        .frame_size = sizeof lane->frame,
        .echo = FATHOM_LINE_ECHO_OFF,
        .marks = fathom_line_marks,
        .silence_us = baud == 9600 ? FATHOM_T3_5_US(9600, 10) : FATHOM_T3_5_US(19200, 10),
        /* QEMU's far end is a program of an operating system, which pauses as it likes; on a wire: 0, the default. */
        .gap_us = 25000,
    };
    if (fathom_line_init(&lane->line, &lane->config) != FATHOM_OK) return false;
    lane->modbus = fathom_modbus_client(&lane->line);
    return true;
}

static bool begin(fathom_sensor_t sensors[LINES])
{
    for (uint8_t i = 0; i != LINES; i++)
        if (!begin_line(i, i == GATE ? 19200 : 9600)) return false;
    const fathom_a16_modbus_config_t tank_config = {.value = FATHOM_REAL_TIME};
    /* No period is printed; this one is known to send ten times a second. */
    const fathom_a16_auto_config_t silo_config = {.stale_us = 2000000, .gap_us = 25000};
    const fathom_a05_dyp_config_t rear_config = {.probes = 1};
    if (fathom_a16_modbus_init(&tank, &lanes[TANK].modbus, &tank_config) != FATHOM_OK ||
        fathom_a05_modbus_init(&bumper, &lanes[BUMPER].modbus, NULL) != FATHOM_OK ||
        fathom_hps167s_init(&gate, &lanes[GATE].modbus, NULL) != FATHOM_OK ||
        fathom_a16_auto_init(&silo, &lanes[SILO].line, &silo_config) != FATHOM_OK ||
        fathom_a05_dyp_init(&rear, &lanes[REAR].line, &rear_config) != FATHOM_OK)
        return false;
    sensors[TANK] = fathom_a16_modbus_sensor(&tank);
    sensors[BUMPER] = fathom_a05_modbus_sensor(&bumper);
    sensors[GATE] = fathom_hps167s_sensor(&gate);
    sensors[SILO] = fathom_a16_auto_sensor(&silo);
    sensors[REAR] = fathom_a05_dyp_sensor(&rear);
    return true;
}

/* The number that stands at *text, and what is behind it; 0 if there is none. */
static unsigned number(const char **text)
{
    unsigned value = 0;
    while (**text == ' ') (*text)++;
    for (; **text >= '0' && **text <= '9' && value < 1000; (*text)++)
        value = value * 10 + (unsigned)(**text - '0');
    return value;
}

int main(void)
{
    static fathom_sensor_t sensors[LINES];
    static char words[64];
    static fathom_mps2_idle_t idle = {uarts, LINES};
    unsigned readings[LINES] = {0};
    unsigned waiting;

    semihosting_words(words, sizeof words);
    const char *text = words;
    while (*text != '\0' && *text != ' ') text++; /* the name of the program */
    unsigned wanted = number(&text);
    waiting = number(&text) & ALL;
    if (wanted == 0) wanted = 10;
    if (waiting == 0) waiting = ALL;

    fathom_mps2_clock_begin();
    if (!begin(sensors)) return 2;
    while (waiting != 0) {
        bool is_idle = true;
        for (unsigned i = 0; i != LINES; i++) {
            fathom_sample_t sample;
            const fathom_status_t status = fathom_poll(&sensors[i], &sample);
            if (status == FATHOM_PENDING) continue;
            is_idle = false;
            if (status < 0) {
                tell_error(names[i], status);
                continue;
            }
            tell_sample(names[i], &sample);
            /* An A05's response is as many samples as there are probes, of which the last may not be fitted. */
            if (sample.probe == 1 && ++readings[i] == wanted) waiting &= ~(1u << i);
        }
        if (is_idle) fathom_mps2_idle(&idle, fathom_due_us(sensors, LINES));
    }
    return 0;
}
