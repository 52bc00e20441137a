/* SPDX-License-Identifier: MIT */
#include "sensors/a05.h"

/* An A05 samples its RX in the first second after power-on: high selects processed values, low real-time values
 * (A05 1(1)). The reader holds the port's TX at this level until the frames of the sensor stop and start again. It reports
 * no measurement before that. */

/* A longer pause between two frames means that the sensor was off. No period is printed, but a "response time" of 1.5 s
 * (A05 1). */
#define OFF_US 2000000u

/* The driver holds RX low for another 1.5 s and then lets it go high. */
static fathom_status_t go_on(reader_t *reader)
{
    driver_selection_t *const selection = &reader->selection;
    const fathom_status_t status =
        fathom_a05_auto_select(&reader->driver.a05_auto, (fathom_dyp_value_t)selection->value);
    if (status != FATHOM_OK) return status == FATHOM_ERR_BUSY ? FATHOM_PENDING : status;
    reader->sensor = selection->listening;
    reader->remark = "it has been switched on: readings begin";
    return FATHOM_PENDING;
}

static fathom_status_t poll(void *ctx, fathom_sample_t *sample)
{
    reader_t *const reader = ctx;
    driver_selection_t *const selection = &reader->selection;
    fathom_sample_t unselected;
    (void)sample;
    const fathom_status_t status = fathom_poll(&selection->listening, &unselected);
    const uint32_t now = driver_now_us(reader);
    /* Bytes that form no frame may be noise of a module without power. */
    const bool is_silent =
        status == FATHOM_PENDING || status == FATHOM_ERR_STALE || status == FATHOM_ERR_CHECKSUM;
    if (status == FATHOM_ERR_PORT) return status;
    if (fathom_elapsed_us(now, selection->heard_us) >= OFF_US) selection->has_been_off = true;
    if (is_silent) return FATHOM_PENDING;
    selection->heard_us = now;
    return selection->has_been_off ? go_on(reader) : FATHOM_PENDING;
}

static uint32_t due_us(void *ctx)
{
    const reader_t *const reader = ctx;
    const driver_selection_t *const selection = &reader->selection;
    const uint32_t passed_us = fathom_elapsed_us(driver_now_us(reader), selection->heard_us);
    const uint32_t listening_us = fathom_due_us(&selection->listening, 1);
    if (selection->has_been_off || passed_us >= OFF_US) return listening_us;
    return OFF_US - passed_us < listening_us ? OFF_US - passed_us : listening_us;
}

static fathom_status_t end(reader_t *reader)
{
    const fathom_status_t status = fathom_a05_auto_deinit(&reader->driver.a05_auto);
    return status == FATHOM_OK ? fathom_output_set(&reader->selection.rx, FATHOM_OUTPUT_FREE) : status;
}

bool a05_select(reader_t *reader, port_t *port, uint8_t value)
{
    driver_selection_t *const selection = &reader->selection;
    const bool is_low = value == FATHOM_REAL_TIME;
    if (is_low && !driver_has_break(reader, port)) return false;
    driver_end_break(port);
    selection->rx = fathom_output_line_break(reader->line);
    if (is_low && fathom_output_set(&selection->rx, FATHOM_OUTPUT_LOW) != FATHOM_OK) return false;
    selection->listening = reader->sensor;
    selection->value = value;
    selection->heard_us = driver_now_us(reader);
    reader->sensor = (fathom_sensor_t){poll, due_us, reader};
    reader->end = end;
    reader->remark =
        is_low ? "its RX is held low, which selects real-time values when it is switched on: switch its "
                 "supply off for 3 seconds and on"
               : "its RX is high, which selects processed values when it is switched on: switch its "
                 "supply off for 3 seconds and on";
    return true;
}
