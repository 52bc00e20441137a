/* SPDX-License-Identifier: MIT */
/*
 * The listener for an HPS-167S that sends without a request. It searches the received bytes for frames of one address
 * and returns each as a sample.
 */
#include "fathom/sensor/hps167s_auto.h"

#include "fathom/codec/crc16.h"
#include "fathom/sensor/hps167s_info.h"
#include "hps167s_internal.h"

enum { ADDRESS = 0, FUNCTION = 1, SIZE = 2, DATA = 3, LENGTH = FATHOM_HPS167S_FRAME_LENGTH };
enum { DATA_SIZE = 8 };

/* ---- Received bytes ---- */

/* Returns true if the held bytes can be the beginning of a frame. */
static bool has_head(const fathom_hps167s_auto_t *sensor)
{
    const uint8_t *const bytes = sensor->bytes;
    const uint8_t held_count = sensor->held_count;
    if (bytes[ADDRESS] != *sensor->from) return false;
    if ((held_count > FUNCTION) && (bytes[FUNCTION] != FATHOM_MODBUS_READ_HOLDING_REGISTERS)) return false;
    return (held_count <= SIZE) || (bytes[SIZE] == DATA_SIZE);
}

/* Drops the first held byte, because the next one may begin a frame. Without volatile, compilers replace the loop by a
 * call of memmove(), which costs more flash. */
static void drop_first(fathom_hps167s_auto_t *sensor)
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

/* Stores the held bytes as the newest frame, unless the driver of the same unit refuses it. */
static void take(fathom_hps167s_auto_t *sensor, uint32_t time_us)
{
    const uint8_t *at = &sensor->bytes[DATA];
    uint16_t registers[4];
    for (uint8_t i = 0; i != 4u; i++) {
        registers[i] = (uint16_t)((at[0] * 256u) + at[1]);
        at += 2;
    }
    sensor->held_count = 0;
    if ((sensor->driver != NULL) && !sensor->heard(sensor->driver, registers, time_us)) {
        count_one(&sensor->implausible);
        return;
    }
    if (sensor->is_new) count_one(&sensor->missed);
    copy_4(sensor->registers, registers);
    sensor->is_new = true;
    sensor->frame_address = sensor->bytes[ADDRESS];
    sensor->time_us = time_us;
}

static void receive(fathom_listener_t *listener, const uint8_t *bytes, uint8_t length, bool after_gap,
                    uint32_t time_us)
{
    fathom_hps167s_auto_t *const sensor = (fathom_hps167s_auto_t *)listener;
    (void)after_gap; /* The CRC decides what is a frame. */
    sensor->is_heard = true;
    if (length == 0u) /* Bytes were lost: no frame reaches across this place. */
        while (sensor->held_count != 0u) drop_first(sensor);
    for (; length != 0u; length--) {
        sensor->bytes[sensor->held_count] = *bytes;
        sensor->held_count++;
        bytes++;
        if ((sensor->held_count == LENGTH) && (fathom_crc16(sensor->bytes, LENGTH) != 0u)) {
            count_one(&sensor->damaged);
            drop_first(sensor);
        }
        while ((sensor->held_count != 0u) && !has_head(sensor)) drop_first(sensor);
        if (sensor->held_count == LENGTH) take(sensor, time_us);
    }
}

/* ---- Initialisation ---- */

/* Returns true if each member is inside its range. */
static bool is_in_range(const fathom_line_t *line, const fathom_hps167s_auto_config_t *config)
{
    return (line != NULL) && (line->parts != NULL) && (line->parts->frame_size >= LENGTH) &&
           (config->address <= FATHOM_HPS167S_MAX_ADDRESS) && (config->stale_us <= FATHOM_MAX_DURATION_US);
}

static void stop_listening(fathom_hps167s_auto_t *sensor)
{
    fathom_line_t *const line = sensor->line;
    if (line != NULL) fathom_line_unlisten(line, &sensor->listener);
}

fathom_status_t fathom_hps167s_auto_init(fathom_hps167s_auto_t *sensor, fathom_line_t *line,
                                         const fathom_hps167s_auto_config_t *config)
{
    fathom_status_t status = FATHOM_ERR_ARGUMENT;
    fathom_hps167s_auto_config_t zeroed;
    clear(sensor, sizeof *sensor);
    config = config_or_zeroed(config, &zeroed, sizeof zeroed);
    sensor->listener.receive = receive;
    sensor->line = line;
    sensor->listener.stale_us = or_default(config->stale_us, FATHOM_HPS167S_AUTO_DEFAULT_STALE_US);
    sensor->address = (config->address != 0u) ? config->address : 1u;
    sensor->from = &sensor->address;
    if (is_in_range(line, config)) {
        sensor->since_us = clock_us(line->parts->clock);
        status = fathom_line_listen(line, &sensor->listener);
    }
    if (status != FATHOM_OK) {
        stop_listening(sensor);
        clear(sensor, sizeof *sensor);
    }
    return status;
}

void fathom_hps167s_auto_follow(fathom_hps167s_auto_t *sensor, fathom_hps167s_t *driver)
{
    sensor->driver = driver;
    sensor->heard = fathom_hps167s_accept_unsolicited;
    sensor->from = &driver->unit.address;
}

fathom_status_t fathom_hps167s_auto_set_limits(fathom_hps167s_auto_t *sensor, fathom_hps167s_limits_t *limits)
{
    const fathom_status_t status = fathom_hps167s_complete_limits(limits);
    if (status == FATHOM_OK) sensor->limits = limits;
    return status;
}

void fathom_hps167s_auto_deinit(fathom_hps167s_auto_t *sensor) { stop_listening(sensor); }

/* ---- Polling ---- */

static fathom_status_t return_frame(fathom_hps167s_auto_t *sensor, fathom_sample_t *sample, uint32_t now_us)
{
    const fathom_status_t status = fathom_hps167s_decode_within(sensor->limits, sensor->registers, sample);
    if (status != FATHOM_OK) {
        count_one(&sensor->implausible);
        return status;
    }
    sensor->since_us = now_us;
    sensor->is_heard = sensor->held_count != 0u;
    sample->time_us = sensor->time_us;
    sensor->sequence++;
    sample->sequence = sensor->sequence;
    sample->model = FATHOM_HPS167S;
    sample->address = sensor->frame_address;
    sample->probe = 1;
    return FATHOM_OK;
}

fathom_status_t fathom_hps167s_auto_sensor_poll(void *ctx, fathom_sample_t *sample)
{
    fathom_hps167s_auto_t *const sensor = ctx;
    if (sensor->line == NULL) return FATHOM_ERR_ARGUMENT; /* init did not run, or failed */
    const fathom_status_t port = fathom_line_poll(sensor->line);
    const uint32_t now_us = clock_us(sensor->line->parts->clock);
    const uint32_t stale_us = sensor->listener.stale_us;
    if (sensor->is_new) {
        sensor->is_new = false;
        if (rest_us(time_since_us(now_us, sensor->time_us), FATHOM_LINE_LATE_US) <= stale_us)
            return return_frame(sensor, sample, now_us);
        count_one(&sensor->missed);
        sensor->is_heard = false; /* What arrived is too old, and no damage. */
    }
    if (port < 0) return port;
    if (time_since_us(now_us, sensor->since_us) < stale_us) return FATHOM_PENDING;
    const fathom_status_t status = sensor->is_heard ? FATHOM_ERR_CHECKSUM : FATHOM_ERR_STALE;
    sensor->since_us = now_us;
    sensor->is_heard = false;
    return status;
}

uint32_t fathom_hps167s_auto_sensor_due_us(void *ctx)
{
    const fathom_hps167s_auto_t *const sensor = ctx;
    if (sensor->line == NULL) return 0;
    const uint32_t line_us = fathom_line_due_us(sensor->line);
    const uint32_t passed_us = time_since_us(clock_us(sensor->line->parts->clock), sensor->since_us);
    return sensor->is_new ? 0u : least_us(line_us, rest_us(sensor->listener.stale_us, passed_us));
}
