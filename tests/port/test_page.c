/* SPDX-License-Identifier: MIT */
#include "suite.h"

#include "fathom/engine/modbus_client.h"
#include "fathom/engine/wait.h"
#include "fathom/sensor/a16_modbus.h"

/* What port/README.md shows, and its interrupts. */
void timer_interrupt(void);
void receive_interrupt(void);
void room_interrupt(void);
void sent_interrupt(void);
void byte_left_interrupt(void);
void pin_interrupt(void);
void port_begin(void);
void port_idle(void *ctx, uint32_t max_us);
fathom_capture_t port_capture(void);

#include "port_page.c" /* all blocks of C of port/README.md, cut out by support/cut.py */

/* The port of a chip whose transmit interrupt is an event. */
static const fathom_uart_t event_uart = {.read = port_read,
                                         .write = event_write,
                                         .sent = port_sent,
                                         .set_line = port_set_line,
                                         .leaves_in_us = port_leaves_in_us,
                                         .ctx = &serial};

/* The chip, and an A16 at the end of its line. */
enum { BIT_US = 104, CHARACTER_US = 1040, DEVICE_US = 50000, OUT = 32 };

/* A16 6(4), example 2: real-time value, 0x02EF = 751 mm. */
static const uint8_t request_frame[8] = {0x01, 0x03, 0x01, 0x01, 0x00, 0x01, 0xD4, 0x36};
static const uint8_t response_frame[7] = {0x01, 0x03, 0x02, 0x02, 0xEF, 0xF8, 0xA8};

static struct {
    uint32_t us;
    uint32_t slow_us; /* what each look at the timer takes */
    bool is_locked, has_wrapped;

    bool on_room, on_sent, driver, is_register_full, is_shifting;
    uint8_t in_register, in_shifter;
    uint32_t shift_left_us;
    uint8_t out[OUT], sent;
    bool is_event; /* its transmit interrupt: a byte has left */
    bool has_left;
    uint32_t divider;
    uint8_t parity, stop_bits;
    unsigned undriven;      /* us of a character without the driver */
    uint32_t last_us;       /* the end of the last stop bit */
    uint32_t driver_off_us; /* when it was let go */
    uint32_t driver_on_us, first_start_us;

    bool has_byte;
    uint8_t byte, flags; /* that have come */
    uint32_t alarm_left_us;
    unsigned sleeps;
    uint32_t response_left_us;
    uint8_t answered;

    bool pin;
} chip;

uint32_t chip_lock(void)
{
    const bool was_locked = chip.is_locked;
    chip.is_locked = true;
    return was_locked;
}

static void interrupt_timer(void)
{
    if (chip.has_wrapped && !chip.is_locked) timer_interrupt();
}

static bool has_room(void) { return chip.on_room && !chip.is_register_full; }

static bool has_sent(void) { return chip.on_sent && !chip.is_register_full && !chip.is_shifting; }

/* The interrupts of the UART that are pending and not masked. */
static void interrupt_uart(void)
{
    if (chip.is_locked) return;
    if (chip.has_byte) {
        chip.has_byte = false;
        receive_interrupt();
    }
    if (chip.has_left) {
        chip.has_left = false;
        byte_left_interrupt();
    }
    if (has_room()) room_interrupt();
    if (has_sent()) sent_interrupt();
}

void chip_unlock(uint32_t before)
{
    chip.is_locked = before != 0;
    interrupt_timer();
    interrupt_uart();
}

static void tick(uint32_t us)
{
    for (; us != 0; us--)
        if ((++chip.us & UINT16_MAX) == 0) chip.has_wrapped = true;
    interrupt_timer();
}

uint16_t chip_timer(void)
{
    const uint16_t count = (uint16_t)chip.us;
    tick(chip.slow_us);
    return count;
}

bool chip_timer_wrapped(void) { return chip.has_wrapped; }
void chip_timer_clear(void) { chip.has_wrapped = false; }
uint8_t chip_uart_flags(void) { return chip.flags; }

uint8_t chip_uart_take(void)
{
    chip.flags = 0; /* as on STM32: they are gone with the byte */
    return chip.byte;
}

void chip_uart_put(uint8_t byte)
{
    assert_false(chip.is_register_full);
    chip.in_register = byte;
    chip.is_register_full = true;
}

void chip_uart_on_room(bool on) { chip.on_room = on; }
void chip_uart_on_sent(bool on) { chip.on_sent = on; }

void chip_uart_set(uint32_t divider, uint8_t parity, uint8_t stop_bits)
{
    chip.divider = divider;
    chip.parity = parity;
    chip.stop_bits = stop_bits;
}

void chip_driver(bool on)
{
    if (on)
        chip.driver_on_us = chip.us;
    else
        chip.driver_off_us = chip.us;
    chip.driver = on;
}

bool chip_pin(void) { return chip.pin; }
void chip_pin_clear(void) {}

static void come(uint8_t byte, uint8_t flags)
{
    chip.byte = byte;
    chip.flags = flags;
    receive_interrupt();
}

static void shift(void)
{
    if (chip.is_shifting) {
        if (!chip.driver) chip.undriven++;
        if (--chip.shift_left_us != 0) return;
        chip.is_shifting = false;
        chip.last_us = chip.us;
        chip.has_left = chip.is_event;
        chip.out[chip.sent++ % OUT] = chip.in_shifter;
        if (chip.sent == sizeof request_frame) chip.response_left_us = DEVICE_US;
    }
    if (!chip.is_register_full) return;
    if (chip.sent == 0) chip.first_start_us = chip.us;
    chip.in_shifter = chip.in_register;
    chip.is_register_full = false;
    chip.is_shifting = true;
    chip.shift_left_us = CHARACTER_US;
}

/* The A16 answers what it has been asked, if it was that. */
static void device(void)
{
    if (chip.response_left_us == 0 || --chip.response_left_us != 0) return;
    if (memcmp(chip.out, request_frame, sizeof request_frame) != 0) return;
    assert_false(chip.has_byte); /* or it would be lost */
    chip.byte = response_frame[chip.answered++];
    chip.has_byte = true;
    if (chip.answered < sizeof response_frame) chip.response_left_us = CHARACTER_US;
}

static void step(void)
{
    tick(1);
    shift();
    device();
}

static void run(uint32_t us)
{
    for (; us != 0; us--) {
        step();
        interrupt_uart();
    }
}

void chip_alarm(uint16_t us)
{
    assert_int_not_equal(us, 0); /* it would come one round later */
    chip.alarm_left_us = us;
}

void chip_sleep(void)
{
    assert_true(chip.is_locked);
    chip.sleeps++;
    while (!chip.has_byte && !chip.has_left && !has_room() && !has_sent() && !chip.has_wrapped &&
           chip.alarm_left_us != 0) {
        step();
        chip.alarm_left_us--;
    }
}

static int start(void **state)
{
    memset(&chip, 0, sizeof chip);
    wraps = 0;
    settings = (fathom_line_settings_t){9600, FATHOM_PARITY_NONE, 1};
    chip.driver = true; /* the pin has not been set */
    port_begin();
    return 0;
}

static const suite_t suite = {.set_up = start};
static const suite_t plain;

static void begin_at(uint32_t us)
{
    chip.us = us;
    wraps = (uint16_t)(us >> 16);
    chip.has_wrapped = false;
}

static uint32_t now(void) { return port_clock.now_us(port_clock.ctx); }

TEST(the_clock_is_right_wherever_the_timer_wraps_while_it_is_read)
{
    static const uint32_t around[] = {0x00010000, 0x80000000, 0x00000000};
    for (unsigned i = 0; i != 3; i++)
        for (uint32_t early = 0; early != 12; early++)
            for (chip.slow_us = 0; chip.slow_us != 6; chip.slow_us++)
                for (int locked = 0; locked != 2; locked++) {
                    begin_at(around[i] - early);
                    chip.is_locked = locked != 0; /* as within another interrupt */
                    const uint32_t from = chip.us, read = now();
                    assert_in_range(fathom_elapsed_us(read, from), 0, fathom_elapsed_us(chip.us, from));
                    assert_int_equal(chip.is_locked, locked != 0);
                    chip.is_locked = false;
                    interrupt_timer();
                    const uint32_t slow_us = chip.slow_us;
                    chip.slow_us = 0;
                    assert_int_equal(now(), chip.us); /* the interrupt has counted */
                    chip.slow_us = slow_us;
                }
}

static int read_port(uint8_t *bytes, size_t capacity, uint8_t *flags)
{
    fathom_rx_t rx = {0, 0};
    const int n = port_uart.read(port_uart.ctx, bytes, capacity, &rx);
    *flags = rx.flags;
    return n;
}

/* late_us: between the bytes, where the interrupt puts the next one after the one before has left. */
static void send_whole(const fathom_uart_t *uart, uint32_t late_us)
{
    assert_false(chip.driver);
    run(1000);
    assert_int_equal(uart->write(uart->ctx, request_frame, sizeof request_frame), sizeof request_frame);
    assert_int_equal(uart->leaves_in_us(uart->ctx),
                     8334); /* 8 characters of 10 bits at 9600 baud, rounded up */
    assert_int_equal(uart->write(uart->ctx, response_frame, sizeof response_frame), 0); /* busy */
    for (unsigned left = 2 * sizeof request_frame * CHARACTER_US; !uart->sent(uart->ctx); left--) {
        assert_int_not_equal(left, 0);
        run(1);
    }
    assert_int_equal(uart->leaves_in_us(uart->ctx), 0);
    assert_int_equal(chip.sent, sizeof request_frame);
    assert_memory_equal(chip.out, request_frame, sizeof request_frame);
    assert_int_equal(chip.undriven, 0);
    assert_true(chip.driver_on_us <= chip.first_start_us);
    assert_false(chip.driver);
    assert_in_range(chip.driver_off_us - chip.last_us, 0, BIT_US);
    assert_int_equal(chip.last_us - chip.first_start_us,
                     sizeof request_frame * CHARACTER_US + (sizeof request_frame - 1) * late_us);
    chip.sent = 0;
    assert_int_equal(uart->write(uart->ctx, response_frame, sizeof response_frame), sizeof response_frame);
}

TEST(a_request_leaves_whole_with_the_driver_on_until_its_last_stop_bit) { send_whole(&port_uart, 0); }

TEST(so_it_does_where_the_interrupt_is_an_event)
{
    chip.is_event = true;
    send_whole(&event_uart, 1);
}

TEST(where_the_interrupt_is_an_event_nothing_leaves_by_the_code_for_a_level)
{
    assert_int_equal(port_uart.write(port_uart.ctx, request_frame, sizeof request_frame),
                     sizeof request_frame);
    chip.on_room = false; /* there is no such interrupt */
    chip.is_event = true;
    run(1000000);
    assert_int_equal(chip.sent, 0);
}

TEST(an_event_of_what_was_sent_before_the_port_began_sends_nothing)
{
    chip.is_event = chip.has_left = true;
    run(1);
    assert_false(chip.is_register_full);
    assert_true(event_uart.sent(event_uart.ctx));
}

static void refuse_nine(const fathom_uart_t *uart)
{
    const uint8_t bytes[9] = {0};
    assert_true(uart->write(uart->ctx, bytes, sizeof bytes) < 0);
    run(10 * CHARACTER_US);
    assert_int_equal(chip.sent, 0);
    assert_false(chip.driver);
}

TEST(a_request_that_finds_no_memory_is_refused)
{
    refuse_nine(&port_uart);
    refuse_nine(&event_uart);
}

static int set_line(uint32_t baud, uint8_t parity)
{
    const fathom_line_settings_t line = {baud, parity, baud == 9600 ? 1 : 2};
    return port_uart.set_line(port_uart.ctx, &line);
}

/* 16 MHz / 19200 is 833.3, which is within 0.1 %. 969697 would be 16.5: 17 is off by 2.9 %. 1000001 would be less
 * than 16. */
TEST(settings_hold_at_once_or_when_the_bytes_have_left_or_are_refused)
{
    assert_int_equal(set_line(9600, FATHOM_PARITY_NONE), 1);
    assert_int_equal(chip.divider, 0); /* it had these */
    assert_int_equal(set_line(19200, FATHOM_PARITY_EVEN), 1);
    assert_int_equal(chip.divider, 833);
    assert_int_equal(chip.parity, FATHOM_PARITY_EVEN);
    assert_int_equal(chip.stop_bits, 2);
    assert_true(set_line(969697, FATHOM_PARITY_NONE) < 0);
    assert_true(set_line(1000001, FATHOM_PARITY_NONE) < 0);
    assert_int_equal(chip.divider, 833);
    come(7, 0);
    assert_int_equal(port_uart.write(port_uart.ctx, request_frame, sizeof request_frame),
                     sizeof request_frame);
    assert_int_equal(set_line(19200, FATHOM_PARITY_EVEN), 1);
    assert_int_equal(set_line(9600, FATHOM_PARITY_NONE), 0);
    assert_int_equal(chip.divider, 833);
    run(2 * sizeof request_frame * CHARACTER_US);
    assert_int_equal(set_line(9600, FATHOM_PARITY_NONE), 1);
    assert_int_equal(chip.divider, 1667);
    uint8_t byte = 0, flags;
    assert_int_equal(read_port(&byte, 1, &flags), 1); /* what was received is kept */
    assert_int_equal(byte, 7);
}

/* A line and a sensor on this port, from `us` on, in a loop of `round_us`; 0: that sleeps. */
static void read_sensor(const fathom_uart_t *uart, uint32_t us, uint32_t round_us)
{
    uint8_t frame[16];
    fathom_line_t line;
    const fathom_line_parts_t line_parts = {.uart = uart,
                                            .clock = &port_clock,
                                            .frame = frame,
                                            .frame_size = sizeof frame,
                                            .echo = FATHOM_LINE_ECHO_OFF,
                                            .silence_us = FATHOM_T3_5_US(9600, 10)};
    fathom_a16_modbus_t a16;
    (void)start(NULL);
    chip.is_event = uart == &event_uart;
    begin_at(us);
    assert_int_equal(fathom_line_init(&line, &line_parts), FATHOM_OK);
    const fathom_modbus_t modbus = fathom_modbus_client(&line);
    const fathom_a16_modbus_config_t config = {.value = FATHOM_REAL_TIME};
    assert_int_equal(fathom_a16_modbus_init(&a16, &modbus, &config), FATHOM_OK);
    const fathom_sensor_t sensor = fathom_a16_modbus_sensor(&a16);
    fathom_sample_t sample;
    fathom_status_t status = FATHOM_PENDING;
    if (round_us == 0) status = fathom_wait(&sensor, &sample, port_idle, NULL);
    for (unsigned rounds = 0; status == FATHOM_PENDING; rounds++) {
        assert_true(rounds < 200000 / round_us + 1);
        status = fathom_poll(&sensor, &sample);
        run(round_us);
    }
    assert_int_equal(status, FATHOM_OK);
    assert_int_equal(sample.kind, FATHOM_TARGET);
    assert_int_equal(sample.distance_mm, 751);
}

TEST_IN(plain, a_sensor_is_read_through_it_in_any_loop_and_across_the_wrap)
{
    static const uint32_t from_us[] = {0, 0x0000F000, UINT32_MAX - 1000, UINT32_MAX - 20000,
                                       UINT32_MAX - 60000};
    for (unsigned i = 0; i != 5; i++)
        for (int is_event = 0; is_event != 2; is_event++) {
            const fathom_uart_t *const uart = is_event != 0 ? &event_uart : &port_uart;
            read_sensor(uart, from_us[i], 100);
            read_sensor(uart, from_us[i], 20000);
            read_sensor(uart, from_us[i], 0);
            /* An interrupt a byte each way, and few alarms. */
            assert_in_range(chip.sleeps, sizeof response_frame,
                            2 * (sizeof request_frame + sizeof response_frame));
        }
}

TEST(a_sleep_ends_in_time_and_does_not_begin_when_a_byte_waits)
{
    port_idle(NULL, 1000);
    assert_int_equal(chip.us, 1000);
    port_idle(NULL, 0);
    assert_int_equal(chip.us, 1000);
    port_idle(NULL, FATHOM_NO_DEADLINE);
    assert_int_equal(chip.us, 65536); /* the timer's wrap has ended it */
    assert_int_equal(wraps, 1);
    assert_false(chip.is_locked);
    come(1, 0);
    port_idle(NULL, 1000);
    assert_int_equal(chip.us, 65536);
}

static void edge(bool high)
{
    chip.pin = high;
    pin_interrupt();
}

TEST(a_pulse_is_as_wide_as_it_was_also_across_the_wrap)
{
    fathom_pulse_t pulse;
    begin_at(UINT32_MAX - 5000);
    const fathom_capture_t capture = port_capture();
    capture.arm(capture.ctx);
    edge(true);
    assert_int_equal(capture.take(capture.ctx, &pulse), 0);
    assert_true(pulse.is_high);
    tick(10000);
    edge(false);
    assert_int_equal(capture.take(capture.ctx, &pulse), 1);
    assert_int_equal(pulse.width_us, 10000);
    assert_int_equal(pulse.end_us, 4999); /* -5001 + 10000 */
}
