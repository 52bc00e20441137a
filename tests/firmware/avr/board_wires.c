/* SPDX-License-Identifier: MIT */
#include <simavr/avr_ioport.h>

#include "board_inside.h"

/* ATmega328P 36, in data space: PINB, DDRB, PORTB, and three on for C and for D. */
static uint16_t ddr_of(char port) { return (uint16_t)(0x24 + 3 * (port - 'B')); }
static uint16_t port_of(char port) { return (uint16_t)(0x25 + 3 * (port - 'B')); }

/* ---- output pins ---- */

static void look(board_watch_t *watch, uint8_t ddr)
{
    const avr_t *const avr = board.avr;
    const bool high = (ddr >> watch->bit & 1) != 0 ? (avr->data[port_of(watch->port)] >> watch->bit & 1) != 0
                                                   : watch->idle_high;
    if (high == watch->high) return;
    watch->high = high;
    watch->changed(watch->ctx, high);
}

static void on_port(avr_irq_t *irq, uint32_t value, void *param)
{
    board_watch_t *const watch = (board_watch_t *)param;
    look(watch, board.avr->data[ddr_of(watch->port)]);
}

/* Comes before the register is written. */
static void on_direction(avr_irq_t *irq, uint32_t ddr, void *param)
{
    look((board_watch_t *)param, (uint8_t)ddr);
}

board_watch_t *board_watch(char port, uint8_t bit, bool idle_high, void (*changed)(void *ctx, bool high),
                           void *ctx)
{
    if (board.watching == BOARD_WATCHES) return NULL;
    board_watch_t *const watch = &board.watches[board.watching++];
    const board_watch_t fresh = {changed, ctx, port, bit, idle_high, idle_high};
    *watch = fresh;
    const uint32_t ioctl = (uint32_t)AVR_IOCTL_IOPORT_GETIRQ(port);
    avr_irq_register_notify(avr_io_getirq(board.avr, ioctl, IOPORT_IRQ_REG_PORT), on_port, watch);
    avr_irq_register_notify(avr_io_getirq(board.avr, ioctl, IOPORT_IRQ_DIRECTION_ALL), on_direction, watch);
    look(watch, board.avr->data[ddr_of(port)]);
    return watch;
}

/* ---- input pins ---- */

/* simavr gives an input with a pull-up its high level back at each write to its port, unless it is told of what
 * drives it. */
void board_drive(char port, uint8_t bit, bool high)
{
    const int at = port - 'B';
    const uint8_t mask = (uint8_t)(1U << bit);
    board.driven[at] |= mask;
    board.levels[at] = (uint8_t)(high ? board.levels[at] | mask : board.levels[at] & ~mask);
    avr_ioport_external_t external = {.mask = board.driven[at], .value = board.levels[at]};
    avr_ioctl(board.avr, (uint32_t)AVR_IOCTL_IOPORT_SET_EXTERNAL(port), &external);
    avr_raise_irq(avr_io_getirq(board.avr, (uint32_t)AVR_IOCTL_IOPORT_GETIRQ(port), bit), high);
}

static avr_cycle_count_t drive_planned(avr_t *avr, avr_cycle_count_t when, void *param)
{
    board_planned_t *const planned = (board_planned_t *)param;
    planned->waits = false;
    board_drive(planned->port, planned->bit, planned->high);
    return 0;
}

void board_drive_at(char port, uint8_t bit, bool high, uint64_t cycle)
{
    board_planned_t *planned = board.planned;
    while (planned->waits)
        if (++planned == board.planned + BOARD_PLANNED)
            board_give_up("more edges are planned than there is room for");
    const board_planned_t fresh = {port, bit, high, true};
    *planned = fresh;
    avr_cycle_timer_register(board.avr, cycle - board.avr->cycle, drive_planned, planned);
}

/* ---- the pins of a device ---- */

static void on_trigger(void *ctx, bool high)
{
    const fathom_pin_t pin = fathom_sim_rx_pin(board.joined.pins);
    board_sync();
    pin.set(pin.ctx, high);
    board_plan();
}

static void on_edge(void *ctx, bool high, uint32_t time_us)
{
    for (uint8_t i = 0; i < board.joined.inputs; i++)
        board_drive(board.joined.port[i], board.joined.bit[i], high);
}

static void join_input(const char *input)
{
    if (input == NULL) return;
    const uint8_t at = board.joined.inputs++;
    board.joined.port[at] = input[0];
    board.joined.bit[at] = (uint8_t)(input[1] - '0');
    board_drive(input[0], board.joined.bit[at], board.joined.pins->high);
}

void board_join_pins(fathom_sim_pins_t *pins, const char *trigger, const char *input, const char *input_too)
{
    board.joined.pins = pins;
    join_input(input);
    join_input(input_too);
    pins->on_edge = on_edge;
    if (trigger != NULL) board_watch(trigger[0], (uint8_t)(trigger[1] - '0'), true, on_trigger, NULL);
    board_plan();
}

/* ---- the UART ---- */

static void log_byte(uint64_t begin_cycle, uint64_t end_cycle, uint8_t byte, uint8_t flags, bool from_here)
{
    const board_byte_t entry = {begin_cycle, end_cycle, byte, flags, from_here};
    board.bytes[board.bytes_seen++ % BOARD_BYTES] = entry;
}

static bool may_drive(void) { return !board.has_driver || board.driver_on; }

static void byte_begins(uint8_t byte, uint64_t begin_cycle, uint64_t end_cycle)
{
    log_byte(begin_cycle, end_cycle, byte, 0, true);
    if (!may_drive()) board.cut_bytes++;
    if (board.line == NULL || !may_drive()) return;
    board_sync();
    fathom_sim_receive(board.line, &byte, 1, board.clock.now_us);
    board_plan();
}

void board_arrived(uint8_t byte, uint8_t flags, uint32_t ago_us)
{
    const uint64_t end_cycle = (board.avr->cycle / BOARD_CYCLES_PER_US - ago_us) * BOARD_CYCLES_PER_US;
    const uint64_t begin_cycle = end_cycle - usart_character_cycles(&board.usart);
    const bool echo = board.line->echo && board.driver_on;
    if (board.has_driver && !echo && (board.driver_on || board.driver_off_cycle > begin_cycle)) {
        board.talked_over++;
        byte = (uint8_t)~byte;
        flags |= FATHOM_RX_FRAMING;
    }
    flags &= FATHOM_RX_PARITY | FATHOM_RX_FRAMING | FATHOM_RX_OVERRUN;
    log_byte(begin_cycle, end_cycle, byte, flags, false);
    usart_arrive(&board.usart, byte, flags);
}

static avr_cycle_count_t feed(avr_t *avr, avr_cycle_count_t when, void *param)
{
    const uint8_t flags = board.fed.marks != NULL ? *board.fed.marks++ : 0;
    const uint8_t byte = *board.fed.bytes++;
    log_byte(when - board.fed.cycles, when, byte, flags, false);
    usart_arrive(&board.usart, byte, flags);
    return --board.fed.left == 0 ? 0 : when + board.fed.cycles;
}

void board_feed(const uint8_t *bytes, const uint8_t *marks, uint16_t count, uint64_t at_cycle,
                uint32_t cycles)
{
    board.fed.bytes = bytes;
    board.fed.marks = marks;
    board.fed.left = count;
    board.fed.cycles = cycles != 0 ? cycles : usart_character_cycles(&board.usart);
    avr_cycle_timer_register(board.avr, at_cycle + board.fed.cycles - board.avr->cycle, feed, NULL);
}

/* TXD is high or talks while the transmitter has it; then it is a port pin. */
static void look_at_break(void)
{
    const avr_t *const avr = board.avr;
    const bool low = !usart_has_txd(&board.usart) && (avr->data[ddr_of('D')] & 2) != 0 &&
                     (avr->data[port_of('D')] & 2) == 0 && may_drive();
    if (board.line == NULL || low == board.in_break) return;
    board.in_break = low;
    board_sync();
    fathom_sim_break(board.line, low, board.clock.now_us);
    board_plan();
}

static void on_txd(void *ctx, bool high) { look_at_break(); }

static void configured(void)
{
    const fathom_line_settings_t settings = usart_settings(&board.usart);
    if (board.line != NULL && settings.baud >= 1200 &&
        (settings.baud != board.settings.baud || settings.parity != board.settings.parity ||
         settings.stop_bits != board.settings.stop_bits)) {
        board.settings = settings;
        board_sync();
        fathom_sim_set_line(board.line, &settings, board.clock.now_us);
        board_plan();
    }
    look_at_break();
}

void board_wire(void)
{
    board.usart.byte_begins = byte_begins;
    board.usart.configured = configured;
    board_watch('D', 1, true, on_txd, NULL);
}

void board_join_line(fathom_sim_line_t *line)
{
    board_sync();
    board.line = line;
    board.settings.baud = 0;
    fathom_sim_clock_add(&board.clock, line);
    configured();
    board_plan();
}

void board_attach(fathom_sim_line_t *line, fathom_sim_device_t *device, bool full_duplex)
{
    fathom_sim_line_init(line, &device->settings, board.clock.now_us);
    line->full_duplex = full_duplex;
    fathom_sim_attach(line, device, board.clock.now_us);
}

/* ---- RS-485 ---- */

static void on_driver(void *ctx, bool high)
{
    const board_edge_t edge = {board.avr->cycle, high};
    board.driver_edges[board.driver_edges_seen++ % BOARD_EDGES] = edge;
    board.driver_on = high;
    if (!high) board.driver_off_cycle = edge.cycle;
    if (!high && board.usart.shifting && board.usart.end_cycle > edge.cycle) {
        board.cut_bytes++;
        if (board.line != NULL) board.line->host.corrupted = true;
    }
    look_at_break();
}

void board_join_driver(char port, uint8_t bit)
{
    board.has_driver = true;
    board.driver_on = board_watch(port, bit, false, on_driver, NULL)->high;
}
