/* SPDX-License-Identifier: MIT */
/*
 * UART0 and UART1: reception by interrupt and by the main loop, sending, and the driver enable of an RS-485
 * transceiver. The registers are set up in uart_setup.c.
 */
#include "fathom_rp2040.h"
#include "internal/alarm.h"
#include "rp2040.h"

enum {
    RECEIVE = RP2040_UART_INT_RX | RP2040_UART_INT_RT,
    FRAMING = RP2040_UART_DR_FE | RP2040_UART_DR_BE, /* a break sets both */
    ERRORS = FRAMING | RP2040_UART_DR_PE | RP2040_UART_DR_OE,
    TIME_OUT_BITS = 32, /* 4.2.6.3 */
    US_PER_S = 1000000
};

static rp2040_uart_t *hardware_of(const fathom_rp2040_uart_t *uart)
{
    return RP2040_UART(uart->config.wiring.number);
}

static void drive(const fathom_rp2040_uart_t *uart, bool high)
{
    const uint32_t bit = UINT32_C(1) << uart->config.wiring.driver;
    if (!uart->config.wiring.has_driver) return;
    if (high)
        RP2040_SIO_GPIO_OUT_SET = bit;
    else
        RP2040_SIO_GPIO_OUT_CLR = bit;
}

static uint32_t time_us(const fathom_rp2040_uart_t *uart, uint32_t bits)
{
    return bits * US_PER_S / uart->line.baud;
}

/* Keeps plain loads and stores before this point before the volatile ones after it, and the other way round. */
static void keep_order(void) { __asm__ volatile("" ::: "memory"); }

static void tell(const fathom_rp2040_uart_t *uart)
{
    if (uart->config.idle != NULL) uart->config.idle->has_news = true;
}

/* ---- Receiving. The main loop masks RECEIVE here, so the main loop and the interrupt never run this at once. ---- */

/* Moves bytes from the FIFO of the hardware to the ring. Bytes without space stay in the FIFO. Returns false if the
 * ring is full. */
static bool gather(fathom_rp2040_uart_t *uart)
{
    rp2040_uart_t *const hardware = hardware_of(uart);
    const uint8_t taken = uart->taken;
    uint8_t written = uart->written;
    while (((hardware->fr & RP2040_UART_FR_RXFE) == 0u) &&
           ((uint8_t)(written - taken) != FATHOM_RP2040_RX_RING)) {
        uart->ring[written % FATHOM_RP2040_RX_RING] = (uint16_t)hardware->dr;
        written++;
    }
    uart->written = written;
    return (uint8_t)(written - taken) != FATHOM_RP2040_RX_RING;
}

/* Notes the receive time-out: the newest byte ended TIME_OUT_BITS ago. */
static void note_silence(fathom_rp2040_uart_t *uart)
{
    uart->silent_at = uart->written;
    uart->is_silent =
        uart->silent_at != uart->taken; /* If it is false, the main loop has read the byte already. */
    uart->silent_us = RP2040_TIMER_RAWL - time_us(uart, TIME_OUT_BITS);
}

static void count(uint16_t *counter, bool is_so)
{
    if (is_so && (*counter != UINT16_MAX)) (*counter)++;
}

static uint8_t flags_of(fathom_rp2040_uart_t *uart, unsigned errors)
{
    const bool parity = (errors & RP2040_UART_DR_PE) != 0u;
    const bool framing = (errors & FRAMING) != 0u;
    /* The flag does not concern this byte: other bytes were lost before it (PL011 TRM 2.4.2). */
    const bool overrun = (errors & RP2040_UART_DR_OE) != 0u;
    count(&uart->parity, parity);
    count(&uart->framing, framing);
    count(&uart->overruns, overrun);
    return (uint8_t)((parity ? FATHOM_RX_PARITY : 0) | (framing ? FATHOM_RX_FRAMING : 0) |
                     (overrun ? FATHOM_RX_OVERRUN : 0));
}

static int uart_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    fathom_rp2040_uart_t *const uart = ctx;
    rp2040_uart_t *const hardware = hardware_of(uart);
    uint8_t taken = uart->taken;
    /* The FIFO is checked first, because an interrupt moves its bytes to the ring. */
    if (((hardware->fr & RP2040_UART_FR_RXFE) != 0u) && (taken == uart->written)) return 0;
    rp2040_clear(&hardware->imsc, RECEIVE);
    keep_order();
    (void)gather(uart);
    const uint8_t end = uart->written;
    int n = 0;
    while ((taken != end) && ((size_t)n < capacity)) {
        const unsigned entry = uart->ring[taken % FATHOM_RP2040_RX_RING];
        const unsigned errors = entry & ERRORS;
        if ((errors != 0u) && (n != 0)) break;
        bytes[n] = (uint8_t)entry;
        n++;
        taken++;
        rx->flags = flags_of(uart, errors);
        if (uart->is_silent && (taken == uart->silent_at)) {
            rx->flags |= FATHOM_RX_TIMED;
            rx->last_us = uart->silent_us;
            uart->is_silent = false;
            break;
        }
        if (errors != 0u) break;
    }
    uart->taken = taken;
    keep_order();
    rp2040_set(&hardware->imsc, RECEIVE);
    return n;
}

/* ---- sending ---- */

static void feed(fathom_rp2040_uart_t *uart)
{
    rp2040_uart_t *const hardware = hardware_of(uart);
    const uint8_t length = uart->length;
    uint8_t given = uart->given;
    while ((given != length) && ((hardware->fr & RP2040_UART_FR_TXFF) == 0u)) {
        hardware->dr = uart->config.request[given];
        given++;
    }
    uart->given = given;
    if (given == length)
        rp2040_clear(&hardware->imsc, RP2040_UART_INT_TX);
    else
        rp2040_set(&hardware->imsc, RP2040_UART_INT_TX);
}

static bool uart_sent(void *ctx)
{
    const fathom_rp2040_uart_t *const uart = ctx;
    return (uart->given == uart->length) && ((hardware_of(uart)->fr & RP2040_UART_FR_BUSY) == 0u);
}

static uint32_t uart_leaves_in_us(void *ctx)
{
    const fathom_rp2040_uart_t *const uart = ctx;
    const uint32_t left_us = uart->end_us - RP2040_TIMER_RAWL;
    return (uart_sent(ctx) || (left_us > (UINT32_MAX / 2u))) ? 0u : left_us;
}

static int uart_write(void *ctx, const uint8_t *bytes, size_t length)
{
    fathom_rp2040_uart_t *const uart = ctx;
    if ((length == 0u) || (length > uart->config.request_size)) return -1;
    if (uart->is_break || !uart_sent(uart)) return 0;
    for (size_t i = 0; i < length; i++) uart->config.request[i] = bytes[i];
    keep_order();
    /* The order matters: if the alarm of the previous request comes now, it finds this request unsent and leaves the
     * driver enabled. */
    uart->given = 0;
    uart->length = (uint8_t)length;
    drive(uart, true);
    feed(uart);
    const uint32_t us = time_us(uart, (uint32_t)length * fathom_character_bits(&uart->line));
    if (uart->config.wiring.has_driver) fathom_rp2040_alarm_set(uart->config.wiring.alarm, us);
    uart->end_us =
        RP2040_TIMER_RAWL + us +
        time_us(uart, 1); /* One bit more, because the request begins with a tick of the divider. */
    return (int)length;
}

void fathom_rp2040_uart_alarm(fathom_rp2040_uart_t *uart)
{
    const unsigned alarm = uart->config.wiring.alarm;
    fathom_rp2040_alarm_clear(alarm);
    if (uart->is_break) return;
    if (!uart_sent(uart)) {
        fathom_rp2040_alarm_set(alarm, time_us(uart, 1));
        return;
    }
    drive(uart, false);
    tell(uart);
}

static int uart_set_line(void *ctx, const fathom_line_settings_t *settings)
{
    fathom_rp2040_uart_t *const uart = ctx;
    const fathom_line_settings_t *const line = &uart->line;
    if ((line->baud == settings->baud) && (line->parity == settings->parity) &&
        (line->stop_bits == settings->stop_bits))
        return 1;
    if (uart->is_break || !uart_sent(uart)) return 0;
    if (!fathom_rp2040_uart_set_line(&uart->config.wiring, settings)) return -1;
    uart->line = *settings;
    return 1;
}

static int uart_set_break(void *ctx, bool on)
{
    fathom_rp2040_uart_t *const uart = ctx;
    rp2040_uart_t *const hardware = hardware_of(uart);
    if (!uart_sent(uart)) return 0;
    uart->is_break = on; /* Set before the driver is enabled: an alarm that comes now leaves the driver. */
    drive(uart, on);
    if (on)
        rp2040_set(&hardware->lcr_h, RP2040_UART_LCR_H_BRK);
    else
        rp2040_clear(&hardware->lcr_h, RP2040_UART_LCR_H_BRK);
    return 1;
}

/* ---- Interrupt and initialisation ---- */

void fathom_rp2040_uart_interrupt(fathom_rp2040_uart_t *uart)
{
    rp2040_uart_t *const hardware = hardware_of(uart);
    const uint32_t pending = hardware->mis;
    if ((pending & RECEIVE) != 0u) {
        hardware->icr =
            RP2040_UART_INT_RT; /* The main loop may empty the FIFO without ending this interrupt. */
        /* If the ring is full, the bytes wait in the hardware, and `read` enables the interrupt again. */
        const bool has_room = gather(uart);
        if (!has_room) rp2040_clear(&hardware->imsc, RECEIVE);
        if (has_room && ((pending & RP2040_UART_INT_RT) != 0u)) note_silence(uart);
        tell(uart);
    }
    if ((pending & RP2040_UART_INT_TX) != 0u) feed(uart);
}

bool fathom_rp2040_uart_init(fathom_rp2040_uart_t *uart, const fathom_rp2040_uart_config_t *config)
{
    if ((config->request == NULL) || (config->request_size == 0u)) return false;
    uart->config = *config;
    uart->line = config->line;
    uart->parity = 0;
    uart->framing = 0;
    uart->overruns = 0;
    uart->written = 0;
    uart->taken = 0;
    uart->length = 0;
    uart->given = 0;
    uart->is_silent = false;
    uart->is_break = false;
    if (!fathom_rp2040_uart_setup(&config->wiring, &config->line)) return false;
    if (config->wiring.has_driver) fathom_rp2040_alarm_enable(config->wiring.alarm);
    rp2040_set(&hardware_of(uart)->imsc, RECEIVE);
    RP2040_NVIC_ISER = UINT32_C(1) << (RP2040_IRQ_UART0 + config->wiring.number);
    return true;
}

fathom_uart_t fathom_rp2040_uart(fathom_rp2040_uart_t *uart)
{
    fathom_uart_t hal;
    hal.read = uart_read;
    hal.write = uart_write;
    hal.sent = uart_sent;
    hal.set_line = uart_set_line;
    hal.set_break = uart_set_break;
    hal.leaves_in_us = uart_leaves_in_us;
    hal.ctx = uart;
    return hal;
}
