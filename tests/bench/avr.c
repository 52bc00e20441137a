/* SPDX-License-Identifier: MIT */
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>
#include <simavr/sim_io.h>

/*
 * Runs job.c and mcu.c on a simulated ATmega328P: plays the Modbus device behind the UART registers, moves
 * the timer on, and counts the cycles and the stack of each fathom_line_poll().
 *
 *     avr FIRMWARE POLL READ TIMER FIRST LAST ...
 *
 * POLL and READ are the addresses of fathom_line_poll() and of the library's first function in a read, TIMER
 * is that of the timer's four bytes, and FIRST LAST are ranges of code that belong to the user and do not
 * count. All are numbers as nm prints them. Prints for the second transaction, and for the deepest of all:
 *
 *     transaction CYCLES      from filling in the request to the poll that has the response; three polls
 *     idle CYCLES             a poll that waits for the response
 *     response CYCLES           the poll that gets it
 *     stack BYTES             below the call of fathom_line_poll(), its return address included
 */
enum { STATUS = 0x4B, DATA = 0x4A, RX_READY = 1, TX_BUSY = 2 }; /* GPIOR2 and GPIOR1 */
enum { SPL = 0x5D, SPH = 0x5E, RANGES = 32, POLL_US = 100, BETWEEN_US = 10000, FRAME = 32 };
enum { TRANSACTIONS = 12, MEASURED = 3 }; /* the fourth: a read like the first, with everything warmed up */

static avr_t *avr;
static uint32_t timer_at;
static struct {
    uint32_t first, last;
} user[RANGES];
static int ranges;

static uint8_t request[FRAME], response[FRAME];
static int asked, response_length, response_at;
static int polls; /* since the request left */
static int transactions;

static uint16_t crc16(const uint8_t *bytes, int length)
{
    uint16_t crc = 0xFFFF;
    while (length-- != 0) {
        crc ^= *bytes++;
        for (int i = 0; i < 8; i++) crc = (uint16_t)((crc & 1) != 0 ? crc >> 1 ^ 0xA001 : crc >> 1);
    }
    return crc;
}

/* What an ordinary device says; each seventh response is damaged and each fifth is an exception, for the stack. */
static void make_response(void)
{
    memcpy(response, request, 6);
    response_length = 6;
    if (request[1] == 3) {
        response[2] = (uint8_t)(2 * request[5]);
        response_length = 3 + response[2];
        for (int i = 3; i < response_length; i++) response[i] = (uint8_t)(i * 29);
    }
    if (transactions % 7 == 5) {
        response[1] |= 0x80;
        response[2] = 2;
        response_length = 3;
    }
    uint16_t crc = crc16(response, response_length);
    if (transactions % 7 == 6) crc ^= 1;
    response[response_length++] = (uint8_t)crc;
    response[response_length++] = (uint8_t)(crc >> 8);
    response_at = 0;
}

static bool device_has_byte(void) { return polls == 3 && response_at < response_length; }

static uint8_t read_status(avr_t *a, avr_io_addr_t address, void *ctx)
{
    return device_has_byte() ? RX_READY : 0;
}

static uint8_t read_data(avr_t *a, avr_io_addr_t address, void *ctx)
{
    return device_has_byte() ? response[response_at++] : 0;
}

static void write_data(avr_t *a, avr_io_addr_t address, uint8_t byte, void *ctx)
{
    if (polls != 0) asked = 0; /* the first of a frame */
    polls = 0;
    if (asked < FRAME) request[asked++] = byte;
    make_response();
}

static void add_to_timer(uint32_t us)
{
    uint32_t now_us;
    memcpy(&now_us, &avr->data[timer_at], sizeof now_us);
    now_us += us;
    memcpy(&avr->data[timer_at], &now_us, sizeof now_us);
}

static uint16_t stack_pointer(void) { return (uint16_t)(avr->data[SPL] | avr->data[SPH] << 8); }

static bool is_users(uint32_t pc)
{
    for (int i = 0; i < ranges; i++)
        if (pc >= user[i].first && pc <= user[i].last) return true;
    return false;
}

static uint32_t number(const char *text)
{
    char *end;
    const unsigned long value = strtoul(text, &end, 16);
    if (*text == 0 || *end != 0) {
        fprintf(stderr, "avr: %s is not a number\n", text);
        exit(2);
    }
    return (uint32_t)value;
}

int main(int argc, char **argv)
{
    elf_firmware_t firmware;
    memset(&firmware, 0, sizeof firmware);
    if (argc < 5 || argc % 2 != 1 || elf_read_firmware(argv[1], &firmware) != 0) return 2;
    const uint32_t poll_at = number(argv[2]), read_at = number(argv[3]);
    timer_at = number(argv[4]) & 0xFFFF;
    for (int i = 5; i < argc && ranges < RANGES; i += 2, ranges++) {
        user[ranges].first = number(argv[i]);
        user[ranges].last = number(argv[i + 1]);
    }
    avr = avr_make_mcu_by_name("atmega328p");
    if (avr == NULL) return 2;
    avr_init(avr);
    avr_load_firmware(avr, &firmware);
    avr_register_io_read(avr, STATUS, read_status, NULL);
    avr_register_io_read(avr, DATA, read_data, NULL);
    avr_register_io_write(avr, DATA, write_data, NULL);

    avr_cycle_count_t transaction = 0, poll = 0, idle = 0, answered = 0;
    unsigned stack = 0;
    uint16_t top = 0; /* of the stack where the present poll was called; 0 outside of one */
    while (transactions < TRANSACTIONS && avr->cycle < 10000000) {
        const uint32_t pc = avr->pc;
        const avr_cycle_count_t before = avr->cycle;
        const bool counts = !is_users(pc);
        if (pc == read_at) {
            add_to_timer(BETWEEN_US);
            transaction = 0;
        }
        if (pc == poll_at && top == 0) {
            top = (uint16_t)(stack_pointer() + 2);
            poll = 0;
            polls++;
            add_to_timer(POLL_US);
        }
        const int state = avr_run(avr);
        if (state == cpu_Done || state == cpu_Crashed) break;
        if (!counts) continue;
        transaction += avr->cycle - before;
        poll += avr->cycle - before;
        if (top == 0) continue;
        const uint16_t sp = stack_pointer();
        if (sp < top && (unsigned)(top - sp) > stack) stack = (unsigned)(top - sp);
        if (sp < top) continue;
        /* Back from the poll. */
        top = 0;
        if (polls == 2) {
            idle = poll;
            transaction -= poll;
        }
        if (polls == 3) {
            answered = poll;
            if (transactions == MEASURED)
                printf("transaction %llu\nidle %llu\nresponse %llu\n", (unsigned long long)transaction,
                       (unsigned long long)idle, (unsigned long long)answered);
            transactions++;
        }
    }
    if (transactions != TRANSACTIONS) {
        fprintf(stderr, "avr: the job stopped after %d transactions at %llu cycles\n", transactions,
                (unsigned long long)avr->cycle);
        return 1;
    }
    printf("stack %u\n", stack);
    return 0;
}
