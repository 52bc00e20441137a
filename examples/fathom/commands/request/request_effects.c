/* SPDX-License-Identifier: MIT */
#include "commands/request/request_effects.h"

#include <stdarg.h>
#include <stdio.h>

#include "commands/request/request_meaning.h"
#include "fathom/codec/hps167s_registers.h"
#include "fathom/codec/modbus_rtu.h"

static void say(const char *format, ...)
{
    va_list arguments;
    (void)fputs("fathom: ", stderr);
    va_start(arguments, format);
    (void)vfprintf(stderr, format, arguments);
    va_end(arguments);
    (void)fputs("\n", stderr);
}

static bool may_be_dyp(const request_t *request) { return request->model == NULL || request->model->is_dyp; }

/* What an HPS-167S is asked for by these, #3 and #5, is known; the range of each has 0x0009 in it. */
static bool is_harmless(uint16_t first, uint16_t count)
{
    return (first == FATHOM_HPS167S_DETAILS && count == FATHOM_HPS167S_DETAILS_COUNT) ||
           (first == FATHOM_HPS167S_MEASUREMENT && count == FATHOM_HPS167S_MEASUREMENT_COUNT);
}

/* A read of 0x0009 is its command #6. What it does with another count, from another register on or by function 4 is not
 * in the datasheet. */
static bool touches_reset(const request_t *request)
{
    const uint8_t function = request->frame[REQUEST_FUNCTION];
    const uint16_t first = request_word(request, REQUEST_FIRST);
    const uint16_t count = request_word(request, REQUEST_COUNT);
    if (function != REQUEST_READ && function != REQUEST_READ_INPUT) return false;
    return first <= FATHOM_HPS167S_RESET && (uint32_t)first + count > FATHOM_HPS167S_RESET &&
           !(function == REQUEST_READ && is_harmless(first, count));
}

/* What it sets, if one of the models is there. */
static void say_meanings(const request_t *request)
{
    decode_frame_t frame;
    decode_piece_t piece;
    request_mean(&frame, &piece, request, NULL, 0);
    for (uint8_t i = 0; i != frame.meanings; i++) {
        const decode_meaning_t *const meaning = &frame.meaning[i];
        const decode_field_t *const field = &meaning->fields[0];
        if (request_is_read(request)) continue;
        if (meaning->count == 0)
            say("if it is %s: %s", meaning->sensor, meaning->what);
        else
            say("if it is %s: %s: %s %s%s%s", meaning->sensor, meaning->what, field->name, field->value,
                field->unit[0] != '\0' ? " " : "", field->unit);
    }
    for (uint8_t i = 0; i != frame.notes; i++) say("%s", frame.note[i]);
}

static void say_write(const request_t *request)
{
    const uint8_t function = request->frame[REQUEST_FUNCTION];
    if (function == REQUEST_WRITE || function == REQUEST_WRITE_MANY) {
        say("the request writes: the unit may keep that in flash, which wears, and may move to another "
            "address or "
            "rate");
        return;
    }
    say("function %u (0x%02X) is in none of the datasheets; what it does is not known", function, function);
    if (function == 10) say("the function 10 that the datasheets print is in hex: 0x10, which is 16");
}

bool request_may_collide(const request_t *request)
{
    return request_is_read(request) && !touches_reset(request);
}

bool request_effects(const request_t *request)
{
    const uint8_t unit = request->frame[REQUEST_UNIT];
    const bool resets = touches_reset(request);
    if (may_be_dyp(request))
        say("the request ends the automatic output of an A16 with RS232 or an A05 with UART; `fathom set a16 "
            "automatic-output on` brings an A16's back, an A05 needs power off and on");
    if (resets)
        say("a read of 0x0009 resets an HPS-167S: address 1, 19200 8E1, warm-up and termination as from the "
            "factory");
    if (!request_is_read(request)) say_write(request);
    say_meanings(request);
    if (unit == FATHOM_MODBUS_BROADCAST)
        say(request_is_broadcast(request) ? "unit 0 is all units: all obey, and none answers"
                                          : "unit 0 is all units, or an A16 or A05 whose address is 0");
    if (unit == FATHOM_MODBUS_ANY_UNIT) say("unit 255: each A16 and A05 obeys it, whatever its address");
    return resets || !request_is_read(request) || unit == FATHOM_MODBUS_BROADCAST ||
           unit == FATHOM_MODBUS_ANY_UNIT;
}
