/* SPDX-License-Identifier: MIT */
/*
 * The driver of an HPS-167 or HPS-166 with a UART. Its requests are Modbus reads of a unit, whose register is the command;
 * the protocol below turns them into frames. So pace, back-off, retries and commands are those of the Modbus drivers.
 */
#include "fathom/sensor/hps167_uart.h"

#include "fathom/codec/hps167s_registers.h"
#include "hps167s_internal.h"

#define MEASURE_TIMEOUT_US 500000uL
#define DEFAULT_STALE_US   2000000uL
#define DEFAULT_START_US   5000000uL

/* Every frame begins with START, which stands for the address of the one unit on the wire. */
enum { START = 0x0A, COMMAND = 3, LENGTH = FATHOM_HPS167_MEASUREMENT_LENGTH };

/* ---- Requests and responses ---- */

static uint8_t command_of(const fathom_transaction_t *transaction)
{
    return ((const fathom_modbus_request_t *)transaction)->message.head[COMMAND];
}

static uint8_t encode(const fathom_transaction_t *transaction, uint8_t *frame)
{
    return fathom_hps167_encode_request(frame, command_of(transaction));
}

static uint16_t check(const uint8_t *frame, uint8_t length) { return !fathom_hps167_is_valid(frame, length); }

static bool is_request(const fathom_transaction_t *transaction, const uint8_t *frame, uint8_t have)
{
    return (frame[0] == START) && ((have < 2u) || (frame[1] == command_of(transaction)));
}

static fathom_status_t parse_response(fathom_transaction_t *transaction, const uint8_t *frame)
{
    const fathom_modbus_message_t *const message = &((fathom_modbus_request_t *)transaction)->message;
    const uint8_t length = fathom_hps167_frame_length(frame, 2);
    if (length != fathom_hps167_response_length(command_of(transaction))) return FATHOM_ERR_MALFORMED;
    fathom_hps167_decode(frame, message->values);
    return FATHOM_OK;
}

/* No command of hps167_frames.h changes a setting, and a CRC of 16 bits protects them. */
static bool may_collide(const fathom_transaction_t *transaction)
{
    (void)transaction;
    return true;
}

static const fathom_protocol_t protocol = {.encode = encode,
                                           .length = fathom_hps167_frame_length,
                                           .check = check,
                                           .is_request = is_request,
                                           .parse_response = parse_response,
                                           .may_collide = may_collide};

static fathom_status_t submit_frame(fathom_line_t *line, fathom_modbus_request_t *request)
{
    request->transaction.protocol = &protocol;
    request->transaction.address = START;
    return fathom_line_submit(line, &request->transaction);
}

static fathom_status_t ask_once(fathom_hps167_uart_t *sensor, uint8_t command)
{
    fathom_modbus_unit_request_t request;
    request.values = &sensor->result;
    request.first = command;
    request.last = 1;
    request.function = FATHOM_MODBUS_READ_HOLDING_REGISTERS;
    request.id = fathom_hps167s_id(command);
    return fathom_modbus_command(&sensor->unit, &request);
}

/* ---- The continuous output ---- */

/* Returns true if the held bytes can be the beginning of a measurement. */
static bool has_head(const fathom_hps167_uart_t *sensor)
{
    const uint8_t length = fathom_hps167_frame_length(sensor->bytes, sensor->held_count);
    return (length == LENGTH) || ((sensor->held_count == 1u) && (length != 0u));
}

/* Drops the first held byte, because the next one may begin a frame. Volatile for the same reason as in clear(). */
static void drop_first(fathom_hps167_uart_t *sensor)
{
    volatile uint8_t *to = sensor->bytes;
    const uint8_t *from = sensor->bytes;
    sensor->held_count--;
    for (uint8_t left = sensor->held_count; left != 0u; left--) {
        from++;
        *to = *from;
        to++;
    }
    count_one(&sensor->dropped_bytes);
}

/* Keeps the newest frame of the continuous output. */
static void take(fathom_hps167_uart_t *sensor, uint32_t time_us)
{
    sensor->held_count = 0;
    if (sensor->is_new) count_one(&sensor->missed);
    fathom_hps167_decode(sensor->bytes, sensor->registers);
    sensor->is_new = true;
    sensor->time_us = time_us;
}

/* A measurement is the only frame that this function looks for. Its buffer is as long as that, so a measurement is
 * complete with its own last byte, however many bytes of other origin stand before it. */
static void receive(fathom_listener_t *listener, const uint8_t *bytes, uint8_t length, bool after_gap,
                    uint32_t time_us)
{
    fathom_hps167_uart_t *const sensor = (fathom_hps167_uart_t *)listener;
    (void)after_gap; /* The CRC decides what is a frame. */
    sensor->is_heard = true;
    if (length == 0u) /* Bytes were lost: no frame reaches across this place. */
        while (sensor->held_count != 0u) drop_first(sensor);
    for (; length != 0u; length--) {
        sensor->bytes[sensor->held_count] = *bytes;
        sensor->held_count++;
        bytes++;
        if ((sensor->held_count == LENGTH) && !fathom_hps167_is_valid(sensor->bytes, LENGTH)) {
            count_one(&sensor->damaged);
            drop_first(sensor);
        }
        while ((sensor->held_count != 0u) && !has_head(sensor)) drop_first(sensor);
        if (sensor->held_count == LENGTH) take(sensor, time_us);
    }
}

static void forget_output(fathom_hps167_uart_t *sensor)
{
    sensor->is_started = false;
    sensor->is_new = false;
    sensor->held_count = 0;
}

/* ---- Initialisation ---- */

static bool is_usable(const fathom_modbus_t *transport, const fathom_hps167_uart_config_t *config)
{
    return (config->modbus.address == 0u) && !config->modbus.address_zero &&
           (config->start_us <= FATHOM_MAX_DURATION_US) && (config->stale_us <= FATHOM_MAX_DURATION_US) &&
           fathom_modbus_unit_has_room(transport, LENGTH);
}

fathom_status_t fathom_hps167_uart_init(fathom_hps167_uart_t *sensor, fathom_line_t *line,
                                        const fathom_hps167_uart_config_t *config)
{
    const fathom_modbus_t transport = {.line = line, .submit = submit_frame};
    fathom_hps167_uart_config_t zeroed;
    fathom_status_t status = fathom_modbus_unit_begin(&sensor->unit, &transport, sensor, sizeof *sensor);
    if (status < 0) return status;
    fathom_line_unlisten(line, &sensor->listener); /* of a driver that was initialised again */
    config = config_or_zeroed(config, &zeroed, sizeof zeroed);
    if (!is_usable(&transport, config)) return FATHOM_ERR_ARGUMENT;
    status = fathom_modbus_unit_init(&sensor->unit, &transport, &config->modbus, MEASURE_TIMEOUT_US,
                                     FATHOM_HPS167_UART_PERIOD_US);
    sensor->listener.receive = receive;
    sensor->listener.stale_us = or_default(config->stale_us, DEFAULT_STALE_US);
    sensor->start_us = or_default(config->start_us, DEFAULT_START_US);
    sensor->since_us = clock_us(line->parts->clock);
    sensor->is_continuous = config->continuous;
    if ((status == FATHOM_OK) && config->continuous) status = fathom_line_listen(line, &sensor->listener);
    if (status < 0) clear(sensor, sizeof *sensor);
    return status;
}

fathom_status_t fathom_hps167_uart_set_limits(fathom_hps167_uart_t *sensor, fathom_hps167s_limits_t *limits)
{
    const fathom_status_t status = fathom_hps167s_complete_limits(limits);
    if (status == FATHOM_OK) sensor->limits = limits;
    return status;
}

void fathom_hps167_uart_cancel(fathom_hps167_uart_t *sensor) { fathom_modbus_unit_cancel(&sensor->unit); }

/* Sends the command to stop without a transaction, whose memory would have to outlive the driver. It needs no silence,
 * because the sensor has the two wires to itself. If the port is busy or broken, the command is lost. */
static void send_stop(const fathom_line_t *line)
{
    const fathom_uart_t *const uart = line->parts->uart;
    uint8_t frame[FATHOM_HPS167_REQUEST_LENGTH];
    const uint8_t length = fathom_hps167_encode_request(frame, FATHOM_HPS167_STOP);
    (void)uart->write(uart->ctx, frame, length);
}

void fathom_hps167_uart_deinit(fathom_hps167_uart_t *sensor)
{
    fathom_line_t *const line = sensor->unit.transport.line;
    fathom_hps167_uart_cancel(sensor);
    if (line == NULL) return;
    fathom_line_unlisten(line, &sensor->listener);
    if (sensor->is_started) send_stop(line);
    forget_output(sensor);
}

void fathom_hps167_uart_power_on(fathom_hps167_uart_t *sensor)
{
    fathom_modbus_unit_power_on(&sensor->unit, sensor->start_us);
    forget_output(sensor);
}

/* ---- Commands ---- */

fathom_status_t fathom_hps167_uart_stop(fathom_hps167_uart_t *sensor)
{
    fathom_modbus_unit_poll(&sensor->unit);
    const fathom_status_t status = ask_once(sensor, FATHOM_HPS167_STOP);
    if (status != FATHOM_OK) return status;
    if (sensor->result != (uint16_t)FATHOM_HPS167_DONE) return FATHOM_ERR_EXCEPTION;
    forget_output(sensor);
    return FATHOM_OK;
}

fathom_status_t fathom_hps167_uart_get_temperature(fathom_hps167_uart_t *sensor, uint16_t *temperature)
{
    fathom_modbus_unit_poll(&sensor->unit);
    const fathom_status_t status = ask_once(sensor, FATHOM_HPS167_TEMPERATURE);
    if (status == FATHOM_OK) *temperature = sensor->result;
    return status;
}

/* ---- Polling ---- */

static fathom_status_t measure(fathom_hps167_uart_t *sensor, uint8_t command)
{
    return fathom_modbus_unit_measure(&sensor->unit, command, FATHOM_HPS167S_MEASUREMENT_COUNT,
                                      sensor->values);
}

static fathom_status_t make_sample(fathom_hps167_uart_t *sensor, const uint16_t *registers, uint32_t time_us,
                                   fathom_sample_t *sample)
{
    const fathom_status_t status = fathom_hps167s_decode_within(sensor->limits, registers, sample);
    if (status != FATHOM_OK) {
        count_one(&sensor->implausible);
        return status;
    }
    sample->time_us = time_us;
    sensor->sequence++;
    sample->sequence = sensor->sequence;
    sample->model = FATHOM_HPS167S;
    sample->address = 0;
    sample->probe = 1;
    return FATHOM_OK;
}

/* Returns true if the output has to be requested, or if a request for it was not fetched yet: state 0 is no request. A
 * frame may arrive before the response to such a request. */
static bool needs_request(const fathom_hps167_uart_t *sensor)
{
    const fathom_modbus_unit_t *const unit = &sensor->unit;
    return !sensor->is_started ||
           ((unit->state != 0u) && (unit->current == (uint8_t)FATHOM_MODBUS_UNIT_MEASUREMENT));
}

/* The response to the request for the output is its first frame. A frame that waits already is kept, so that frames are
 * returned in the order of their times. */
static void take_response(fathom_hps167_uart_t *sensor)
{
    if (sensor->is_new) {
        count_one(&sensor->missed);
        return;
    }
    copy_4(sensor->registers, sensor->values);
    sensor->is_new = true;
    sensor->time_us = fathom_modbus_unit_heard_us(&sensor->unit);
}

static fathom_status_t end_output(fathom_hps167_uart_t *sensor, uint32_t now_us)
{
    const fathom_status_t status = sensor->is_heard ? FATHOM_ERR_CHECKSUM : FATHOM_ERR_STALE;
    sensor->is_started = false;
    sensor->is_heard = false;
    sensor->since_us = now_us;
    return status;
}

static fathom_status_t poll_output(fathom_hps167_uart_t *sensor, fathom_sample_t *sample)
{
    const uint32_t now_us = sensor->unit.polled_us;
    const uint32_t stale_us = sensor->listener.stale_us;
    if (needs_request(sensor)) {
        const fathom_status_t status = measure(sensor, FATHOM_HPS167_CONTINUOUS);
        if (status == FATHOM_OK)
            take_response(sensor);
        else if (status != FATHOM_PENDING)
            return status;
    }
    if (sensor->is_new) {
        sensor->is_new = false;
        sensor->is_started = true;
        sensor->is_heard = sensor->held_count != 0u;
        if (rest_us(time_since_us(now_us, sensor->time_us), FATHOM_LINE_LATE_US) <= stale_us) {
            sensor->since_us = now_us;
            return make_sample(sensor, sensor->registers, sensor->time_us, sample);
        }
        count_one(&sensor->missed);
    }
    if (sensor->unit.transport_status < 0) return (fathom_status_t)sensor->unit.transport_status;
    if (!sensor->is_started || (time_since_us(now_us, sensor->since_us) < stale_us)) return FATHOM_PENDING;
    return end_output(sensor, now_us);
}

fathom_status_t fathom_hps167_uart_sensor_poll(void *ctx, fathom_sample_t *sample)
{
    fathom_hps167_uart_t *const sensor = ctx;
    fathom_modbus_unit_poll(&sensor->unit);
    if (sensor->is_continuous) return poll_output(sensor, sample);
    const fathom_status_t status = measure(sensor, FATHOM_HPS167_SINGLE);
    if (status != FATHOM_OK) return status;
    return make_sample(sensor, sensor->values, fathom_modbus_unit_heard_us(&sensor->unit), sample);
}

uint32_t fathom_hps167_uart_sensor_due_us(void *ctx)
{
    const fathom_hps167_uart_t *const sensor = ctx;
    const fathom_line_t *const line = sensor->unit.transport.line;
    if (!sensor->is_continuous) return fathom_modbus_unit_due_us(&sensor->unit);
    if (sensor->is_new) return 0;
    uint32_t due_us = fathom_line_due_us(line);
    if (needs_request(sensor)) due_us = least_us(due_us, fathom_modbus_unit_due_us(&sensor->unit));
    if (!sensor->is_started) return due_us;
    const uint32_t passed_us = time_since_us(clock_us(line->parts->clock), sensor->since_us);
    return least_us(due_us, rest_us(sensor->listener.stale_us, passed_us));
}
