/* SPDX-License-Identifier: MIT */
#include "drivers.h"

fathom_status_t checked_poll(const fathom_sensor_t *sensor, fathom_sample_t *last)
{
    fathom_sample_t sample;
    memset(&sample, GUARD, sizeof sample);
    const fathom_status_t status = fathom_poll(sensor, &sample);
    if (status == FATHOM_OK)
        *last = sample;
    else
        assert_guard(&sample, sizeof sample);
    return status;
}

void assert_sample(const fathom_sample_t *is, fathom_sample_t should)
{
    assert_int_equal(is->time_us, should.time_us);
    assert_int_equal(is->magnitude, should.magnitude);
    assert_int_equal(is->raw, should.raw);
    assert_int_equal(is->sequence, should.sequence);
    assert_int_equal(is->distance_mm, should.distance_mm);
    assert_int_equal(is->precision, should.precision);
    assert_int_equal(is->kind, should.kind);
    assert_int_equal(is->model, should.model);
    assert_int_equal(is->address, should.address);
    assert_int_equal(is->probe, should.probe);
    assert_int_equal(is->ambient, should.ambient);
    assert_int_equal(is->interference, should.interference);
}

void assert_guard(const void *object, size_t size)
{
    const uint8_t *byte = object;
    while (size != 0 && *byte == GUARD) byte++, size--; /* quick: it is done after each poll */
    assert_int_equal(size, 0);
}
