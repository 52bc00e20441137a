/* SPDX-License-Identifier: MIT */
#include "usart.h"

#include <string.h>

/* ATmega328P 20.11, 36: addresses in data space, and bits. */
enum { UCSR0A = 0xC0, UCSR0B = 0xC1, UCSR0C = 0xC2, UBRR0L = 0xC4, UBRR0H = 0xC5, UDR0 = 0xC6 };
enum { RXC = 0x80, TXC = 0x40, UDRE = 0x20, FE = 0x10, DOR = 0x08, UPE = 0x04, U2X = 0x02, MPCM = 0x01 };
enum { RXCIE = 0x80, TXCIE = 0x40, UDRIE = 0x20, RXEN = 0x10, TXEN = 0x08 };
enum { UPM = 0x30, UPM_EVEN = 0x20, UPM_ODD = 0x30, UCSZ_8 = 0x06, USBS = 0x08 };

static bool is_set(const usart_t *usart, uint16_t address, uint8_t bit)
{
    return (usart->avr->data[address] & bit) != 0;
}

/* ---- interrupts ---- */

/* Receive complete and data register empty stand as long as their cause. */
static void follow(usart_t *usart, avr_int_vector_t *vector, bool flag, uint8_t enable)
{
    if (flag && is_set(usart, UCSR0B, enable)) {
        if (!vector->pending) avr_raise_interrupt(usart->avr, vector);
    } else if (vector->pending) {
        avr_clear_interrupt(usart->avr, vector);
    }
}

void usart_refresh(usart_t *usart)
{
    uint8_t *const state = &usart->avr->data[UCSR0A];
    *state = (uint8_t)((*state & (TXC | U2X | MPCM)) | (usart->waiting != 0 ? RXC : 0) |
                       (usart->buffered ? 0 : UDRE) | (usart->waiting != 0 ? usart->frames[0].state : 0));
    follow(usart, &usart->simavr->rxc, usart->waiting != 0, RXCIE);
    follow(usart, &usart->simavr->udrc, !usart->buffered && is_set(usart, UCSR0B, TXEN), UDRIE);
}

static void on_return(avr_irq_t *irq, uint32_t running, void *param)
{
    if (running == 0) usart_refresh((usart_t *)param);
}

/* ---- transmitter ---- */

static uint32_t bit_cycles(const usart_t *usart)
{
    const uint8_t *const data = usart->avr->data;
    const uint32_t divisor = (uint32_t)(data[UBRR0L] | (data[UBRR0H] & 0x0F) << 8) + 1;
    return divisor * (is_set(usart, UCSR0A, U2X) ? 8 : 16);
}

uint32_t usart_character_cycles(const usart_t *usart)
{
    const uint8_t format = usart->avr->data[UCSR0C];
    const uint32_t bits = 10U + ((format & UPM) != 0 ? 1U : 0U) + ((format & USBS) != 0 ? 1U : 0U);
    return bits * bit_cycles(usart);
}

static void shift_out(usart_t *usart, uint8_t byte, uint64_t at_cycle)
{
    usart->shifting = true;
    usart->shift = byte;
    usart->begin_cycle = at_cycle;
    usart->end_cycle = at_cycle + usart_character_cycles(usart);
    usart->byte_begins(byte, usart->begin_cycle, usart->end_cycle);
}

static avr_cycle_count_t shifted_out(avr_t *avr, avr_cycle_count_t when, void *param)
{
    usart_t *const usart = (usart_t *)param;
    usart->shifting = false;
    if (usart->buffered) {
        usart->buffered = false;
        shift_out(usart, usart->buffer, when);
        usart_refresh(usart);
        return usart->end_cycle;
    }
    avr->data[UCSR0A] |= TXC;
    avr_raise_interrupt(avr, &usart->simavr->txc);
    usart->configured();
    return 0;
}

bool usart_hurry(usart_t *usart)
{
    avr_t *const avr = usart->avr;
    if (!usart->shifting) return false;
    avr_cycle_timer_cancel(avr, shifted_out, usart);
    usart->end_cycle = avr->cycle;
    const avr_cycle_count_t next = shifted_out(avr, avr->cycle, usart);
    if (next != 0) avr_cycle_timer_register(avr, next - avr->cycle, shifted_out, usart);
    return true;
}

static void write_data(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param)
{
    usart_t *const usart = (usart_t *)param;
    /* 20.6: nothing is taken by a transmitter that is off or whose buffer is full. */
    if (!is_set(usart, UCSR0B, TXEN) || usart->buffered) return;
    if (usart->shifting) {
        usart->buffered = true;
        usart->buffer = value;
    } else {
        shift_out(usart, value, avr->cycle);
        avr_cycle_timer_register(avr, usart->end_cycle - avr->cycle, shifted_out, usart);
    }
    usart_refresh(usart);
}

/* ---- receiver ---- */

void usart_arrive(usart_t *usart, uint8_t byte, uint8_t flags)
{
    if (!is_set(usart, UCSR0B, RXEN)) return;
    if ((flags & FATHOM_RX_OVERRUN) != 0) usart->lost = true;
    if (usart->waiting ==
        USART_BUFFER) { /* the start bit of this one has thrown out what could not be buffered */
        usart->waiting--;
        usart->overruns++;
        usart->lost = true;
    }
    usart_frame_t *const frame = &usart->frames[usart->waiting++];
    frame->byte = byte;
    frame->state = (uint8_t)(((flags & FATHOM_RX_FRAMING) != 0 ? FE : 0) | (usart->lost ? DOR : 0) |
                             ((flags & FATHOM_RX_PARITY) != 0 && is_set(usart, UCSR0C, UPM) ? UPE : 0));
    usart->lost = false;
    usart_refresh(usart);
}

static uint8_t read_data(avr_t *avr, avr_io_addr_t address, void *param)
{
    usart_t *const usart = (usart_t *)param;
    const uint8_t byte = usart->frames[0].byte; /* the last one again where none waits */
    if (usart->waiting > 1)
        memmove(usart->frames, usart->frames + 1, (usart->waiting - 1U) * sizeof usart->frames[0]);
    if (usart->waiting != 0) usart->waiting--;
    usart_refresh(usart);
    avr->data[UDR0] = byte;
    return byte;
}

/* ---- registers ---- */

static void write_state(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param)
{
    usart_t *const usart = (usart_t *)param;
    if ((value & TXC) != 0) { /* 20.11.2: a one clears it */
        avr->data[address] &= (uint8_t)~TXC;
        avr_clear_interrupt(avr, &usart->simavr->txc);
    }
    avr->data[address] = (uint8_t)((avr->data[address] & ~(U2X | MPCM)) | (value & (U2X | MPCM)));
    usart_refresh(usart);
    usart->configured();
}

static void write_control(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param)
{
    usart_t *const usart = (usart_t *)param;
    avr->data[address] = value;
    if ((value & RXEN) == 0) usart->waiting = 0; /* 20.7.5: flushed */
    if ((value & TXCIE) != 0 && is_set(usart, UCSR0A, TXC)) avr_raise_interrupt(avr, &usart->simavr->txc);
    usart_refresh(usart);
    usart->configured();
}

static void write_format(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param)
{
    usart_t *const usart = (usart_t *)param;
    avr->data[address] = value;
    usart->configured();
}

fathom_line_settings_t usart_settings(const usart_t *usart)
{
    const uint8_t format = usart->avr->data[UCSR0C];
    const uint32_t cycles = bit_cycles(usart);
    const fathom_line_settings_t settings = {
        (usart->avr->frequency + cycles / 2) / cycles,
        (format & UPM) == UPM_EVEN  ? FATHOM_PARITY_EVEN
        : (format & UPM) == UPM_ODD ? FATHOM_PARITY_ODD
                                    : FATHOM_PARITY_NONE,
        (format & USBS) != 0 ? 2 : 1,
    };
    return settings;
}

/* 20.6.5: switched off, it goes on until the last byte is out. */
bool usart_has_txd(const usart_t *usart) { return is_set(usart, UCSR0B, TXEN) || usart->shifting; }

static void own(usart_t *usart, uint8_t address, avr_io_write_t write, avr_io_read_t read)
{
    avr_t *const avr = usart->avr;
    avr->io[AVR_DATA_TO_IO(address)].w.c = write;
    avr->io[AVR_DATA_TO_IO(address)].w.param = usart;
    avr->io[AVR_DATA_TO_IO(address)].r.c = read;
    avr->io[AVR_DATA_TO_IO(address)].r.param = usart;
}

bool usart_begin(usart_t *usart, avr_t *avr)
{
    memset(usart, 0, sizeof *usart);
    usart->avr = avr;
    for (avr_io_t *io = avr->io_port; io != NULL; io = io->next)
        if (strcmp(io->kind, "uart") == 0) usart->simavr = (avr_uart_t *)io;
    if (usart->simavr == NULL || usart->simavr->r_udr != UDR0) return false;
    avr->data[UCSR0A] = 0;
    avr->data[UCSR0B] = 0; /* simavr has the transmitter on from the start */
    avr->data[UCSR0C] = UCSZ_8;
    own(usart, UDR0, write_data, read_data);
    own(usart, UCSR0A, write_state, NULL);
    own(usart, UCSR0B, write_control, NULL);
    own(usart, UCSR0C, write_format, NULL);
    own(usart, UBRR0L, write_format, NULL);
    own(usart, UBRR0H, write_format, NULL);
    avr_irq_register_notify(usart->simavr->rxc.irq + AVR_INT_IRQ_RUNNING, on_return, usart);
    avr_irq_register_notify(usart->simavr->udrc.irq + AVR_INT_IRQ_RUNNING, on_return, usart);
    usart_refresh(usart);
    return true;
}
