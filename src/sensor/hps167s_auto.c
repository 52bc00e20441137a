/* SPDX-License-Identifier: MIT */
#include "fathom/sensor/hps167s_auto.h"

#include "fathom/codec/crc16.h"
#include "fathom/sensor/hps167s_info.h"
#include "hps167s_internal.h"

enum { ADDRESS = 0, FUNCTION = 1, SIZE = 2, DATA = 3, LENGTH = FATHOM_HPS167S_FRAME_LENGTH };
enum { DATA_SIZE = 8 };

#define STALE_US 2000000uL

/* Can what has come be a frame, or the beginning of one? */
static bool fits(const fathom_hps167s_auto_t *sensor)
{
    const uint8_t *const bytes = sensor->bytes;
    if (bytes[ADDRESS] != *sensor->from) return false;
    if ((sensor->have > FUNCTION) && (bytes[FUNCTION] != FATHOM_MODBUS_READ_HOLDING_REGISTERS)) return false;
    if ((sensor->have > SIZE) && (bytes[SIZE] != DATA_SIZE)) return false;
    return (sensor->have != LENGTH) || (fathom_crc16(bytes, LENGTH) == 0u);
}

/* The first byte begins nothing: the next may. volatile: or compilers make it a call of memmove. */
static void slip(fathom_hps167s_auto_t *sensor)
{
    volatile uint8_t *to = sensor->bytes;
    const uint8_t *from = sensor->bytes;
    sensor->have--;
    for (uint8_t left = sensor->have; left != 0u; left--) {
        from++;
        *to = *from;
        to++;
    }
}

static void take(fathom_hps167s_auto_t *sensor, uint32_t time_us)
{
    const uint8_t *at = &sensor->bytes[DATA];
    uint16_t registers[4];
    for (uint8_t i = 0; i != 4u; i++) {
        registers[i] = (uint16_t)((at[0] * 256u) + at[1]);
        at += 2;
    }
    sensor->have = 0;
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
    (void)after_gap; /* the CRC decides */
    if (length == 0u) sensor->have = 0;
    for (; length != 0u; length--) {
        sensor->bytes[sensor->have] = *bytes;
        sensor->have++;
        bytes++;
        while ((sensor->have != 0u) && !fits(sensor)) slip(sensor);
        if (sensor->have == LENGTH) take(sensor, time_us);
    }
}

fathom_status_t fathom_hps167s_auto_init(fathom_hps167s_auto_t *sensor,
                                         const fathom_hps167s_auto_config_t *config)
{
    if ((config->line == NULL) || (config->address > FATHOM_HPS167S_MAX_ADDRESS)) return FATHOM_ERR_ARGUMENT;
    clear(sensor, sizeof *sensor);
    sensor->listener.receive = receive;
    sensor->line = config->line;
    sensor->stale_us = or_default(config->stale_us, STALE_US);
    sensor->left_us = sensor->stale_us;
    sensor->polled_us = clock_us(sensor->line->config->clock);
    sensor->address = (config->address != 0u) ? config->address : 1u;
    sensor->from = &sensor->address;
    fathom_line_listen(sensor->line, &sensor->listener);
    return FATHOM_READY;
}

void fathom_hps167s_auto_beside(fathom_hps167s_auto_t *sensor, fathom_hps167s_t *driver)
{
    sensor->driver = driver;
    sensor->heard = fathom_hps167s_heard;
    sensor->from = &driver->unit.address;
}

fathom_status_t fathom_hps167s_auto_use_limits(fathom_hps167s_auto_t *sensor, fathom_hps167s_limits_t *limits)
{
    const fathom_status_t status = fathom_hps167s_complete_limits(limits);
    if (status == FATHOM_READY) sensor->limits = limits;
    return status;
}

void fathom_hps167s_auto_deinit(fathom_hps167s_auto_t *sensor)
{
    if (sensor->line->listener == &sensor->listener) fathom_line_listen(sensor->line, NULL);
}

static fathom_status_t poll(void *ctx, fathom_sample_t *sample)
{
    fathom_hps167s_auto_t *const sensor = ctx;
    const fathom_status_t port = fathom_line_poll(sensor->line);
    const uint32_t now = clock_us(sensor->line->config->clock);
    const bool is_stale = fathom_count_down(&sensor->left_us, fathom_elapsed_us(now, sensor->polled_us));
    sensor->polled_us = now;
    if (sensor->is_new) {
        sensor->is_new = false;
        const fathom_status_t status =
            fathom_hps167s_decode_within(sensor->limits, sensor->registers, sample);
        if (status != FATHOM_READY) {
            count_one(&sensor->implausible);
            return status;
        }
        sensor->left_us = sensor->stale_us;
        sample->time_us = sensor->time_us;
        sensor->sequence++;
        sample->sequence = sensor->sequence;
        sample->model = FATHOM_HPS167S;
        sample->address = sensor->frame_address;
        sample->probe = 1;
        return FATHOM_READY;
    }
    if (port < 0) return port;
    if (!is_stale) return FATHOM_PENDING;
    sensor->left_us = sensor->stale_us;
    return FATHOM_ERR_STALE;
}

static uint32_t due_us(void *ctx)
{
    const fathom_hps167s_auto_t *const sensor = ctx;
    const uint32_t line_us = fathom_line_due_us(sensor->line);
    const uint32_t passed_us = fathom_elapsed_us(clock_us(sensor->line->config->clock), sensor->polled_us);
    return sensor->is_new ? 0u : least_us(line_us, rest_us(sensor->left_us, passed_us));
}

fathom_sensor_t fathom_hps167s_auto_sensor(fathom_hps167s_auto_t *sensor)
{
    return sensor_of(poll, due_us, sensor);
}
