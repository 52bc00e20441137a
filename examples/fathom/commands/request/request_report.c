/* SPDX-License-Identifier: MIT */
#include <inttypes.h>
#include <stdio.h>

#include "commands/request/request.h"
#include "diagnosis/advice.h"

enum { CODE = 2, DATA = 3, REGISTER_TEXT = 3 };

bool request_is_good(const request_ask_t *ask)
{
    return ask->outcome == REQUEST_ANSWERED || ask->outcome == REQUEST_SENT || ask->outcome == REQUEST_ECHO;
}

static bool has_registers(const request_ask_t *ask)
{
    const uint8_t function = ask->request->frame[REQUEST_FUNCTION];
    return ask->outcome == REQUEST_ANSWERED && (function == REQUEST_READ || function == REQUEST_READ_INPUT);
}

static bool is_printable(uint8_t byte) { return byte >= 0x20 && byte <= 0x7E; }

/* Writes the two characters of a register; "" if one of them cannot be printed. */
static const char *ascii(uint16_t value, char text[REGISTER_TEXT])
{
    const uint8_t bytes[] = {(uint8_t)(value >> 8), (uint8_t)value};
    const bool is_text = is_printable(bytes[0]) && is_printable(bytes[1]);
    (void)snprintf(text, REGISTER_TEXT, "%c%c", is_text ? bytes[0] : '\0', is_text ? bytes[1] : '\0');
    return text;
}

static int value_signed(uint16_t value)
{
    return value > INT16_MAX ? (int)value - UINT16_MAX - 1 : (int)value;
}

/* ---- text ---- */

static void print_bytes(const char *name, const uint8_t *bytes, size_t count)
{
    if (count == 0) return;
    (void)printf("%-9s", name);
    for (size_t i = 0; i != count; i++) (void)printf(" %02X", bytes[i]);
    (void)puts("");
}

static void print_registers(const request_ask_t *ask)
{
    uint16_t at = request_word(ask->request, REQUEST_FIRST);
    for (uint8_t i = 0; i != ask->response[CODE] / 2u; i++, at++) {
        const uint16_t value = decode_get16(ask->response + DATA + (size_t)2 * i);
        char text[REGISTER_TEXT];
        (void)printf("0x%04X    unsigned %5u  signed %6d  hex %04X", at, value, value_signed(value), value);
        if (ascii(value, text)[0] != '\0') (void)printf("  ascii \"%s\"", text);
        (void)puts("");
    }
}

static void print_text(const request_ask_t *ask, const port_t *port, const decode_frame_t *frame)
{
    const bool was_sent = port->listener.request_length != 0;
    if (was_sent) print_bytes("sent", ask->request->frame, ask->request->length);
    if (ask->length != 0)
        print_bytes("received", ask->response, ask->length);
    else if (was_sent)
        print_bytes("heard", port->listener.window, port->listener.have);
    if (has_registers(ask)) print_registers(ask);
    for (uint8_t i = 0; i != frame->meanings; i++) decoding_put_text(stdout, &frame->meaning[i]);
}

/* ---- JSON ---- */

static void put_registers(json_t *json, const request_ask_t *ask)
{
    uint16_t at = request_word(ask->request, REQUEST_FIRST);
    json_begin(json, "registers", '[');
    for (uint8_t i = 0; i != ask->response[CODE] / 2u; i++, at++) {
        const uint16_t value = decode_get16(ask->response + DATA + (size_t)2 * i);
        char text[REGISTER_TEXT];
        (void)ascii(value, text);
        json_begin(json, NULL, '{');
        json_value(json, "register", "\"0x%04X\"", at);
        json_value(json, "unsigned", "%u", value);
        json_value(json, "signed", "%d", value_signed(value));
        json_value(json, "hex", "\"%04X\"", value);
        json_string(json, "ascii", text[0] != '\0' ? text : NULL);
        json_end(json, '}');
    }
    json_end(json, ']');
}

static void put_exception(json_t *json, uint8_t code)
{
    json_begin(json, "exception", '{');
    json_value(json, "code", "%u", code);
    json_string(json, "name", modbus_exception(code).name);
    json_end(json, '}');
}

static void print_json(const request_ask_t *ask, const port_t *port, const decode_frame_t *frame)
{
    const request_t *const request = ask->request;
    const bool was_sent = port->listener.request_length != 0;
    json_t json = {.to = stdout};
    json_begin(&json, NULL, '{');
    json_value(&json, "address", "%u", request->frame[REQUEST_UNIT]);
    json_value(&json, "function", "%u", request->frame[REQUEST_FUNCTION]);
    json_string(&json, "status", request_outcomes[ask->outcome].name);
    if (was_sent) json_bytes(&json, "sent", request->frame, request->length);
    if (ask->length != 0)
        json_bytes(&json, "received", ask->response, ask->length);
    else if (was_sent)
        json_bytes(&json, "heard", port->listener.window, port->listener.have);
    if (has_registers(ask)) put_registers(&json, ask);
    if (ask->outcome == REQUEST_REFUSED) put_exception(&json, ask->response[CODE]);
    json_begin(&json, "meanings", '[');
    for (uint8_t i = 0; i != frame->meanings; i++) decoding_put_json(&json, &frame->meaning[i]);
    json_end(&json, ']');
    json_end(&json, '}');
    (void)puts("");
}

void request_print(const request_ask_t *ask, const port_t *port)
{
    decode_frame_t frame;
    decode_piece_t piece;
    frame.meanings = 0;
    if (ask->request->model != NULL && ask->outcome == REQUEST_ANSWERED && ask->length != 0)
        request_decode(&frame, &piece, ask->request, ask->response, ask->length);
    if (ask->request->is_json)
        print_json(ask, port, &frame);
    else
        print_text(ask, port, &frame);
}

/* ---- problems ---- */

static void print_refusal(const request_ask_t *ask)
{
    const uint8_t code = ask->response[CODE];
    const modbus_exception_t exception = modbus_exception(code);
    const model_t *const model = ask->request->model;
    (void)fprintf(stderr, "unit %u refused: exception %02u (%s): %s", ask->response[0], code, exception.name,
                  exception.meaning);
    if (model != NULL && model->exception_name != NULL && model->exception_name(code) != NULL)
        (void)fprintf(stderr, "; %s: %s", model->exception_source, model->exception_name(code));
    if (model != NULL && model->exception_name == NULL)
        (void)fprintf(stderr, "; the datasheet of %s has no exceptions", model->name);
}

static void print_advice(const request_ask_t *ask, const port_t *port, const counters_t *counters)
{
    const bool was_sent = port->listener.request_length != 0;
    const bool is_cancelled = ask->transaction.status == FATHOM_ERR_CANCELLED && port->error != PORT_LOST;
    failure_t failure =
        failure_of_request(is_cancelled ? FATHOM_ERR_CANCELLED : request_outcomes[ask->outcome].status, port);
    if (is_cancelled && !was_sent) {
        (void)fputs("the command ended before the line was silent, and nothing was sent", stderr);
        return;
    }
    if (ask->request->model != NULL) failure.model = ask->request->model;
    failure.counters = counters;
    failure.line = &ask->request->line;
    failure.evidence = ask->evidence;
    failure.address = ask->request->frame[REQUEST_UNIT];
    failure.is_request = true;
    advice_print(stderr, &failure);
}

static void print_more(const request_ask_t *ask)
{
    if (ask->more == 0) return;
    (void)fprintf(stderr, "fathom: %" PRIu32 " bytes arrived in addition to the response%s.\n", ask->more,
                  ask->evidence.own > 1        ? ": two units may have this address"
                  : ask->evidence.foreign != 0 ? ": another unit responded also"
                                               : "");
}

void request_print_problem(const request_ask_t *ask, const port_t *port, const counters_t *counters)
{
    const uint8_t unit = ask->request->frame[REQUEST_UNIT];
    print_more(ask);
    if (ask->outcome == REQUEST_ANSWERED) return;
    (void)fputs("fathom: ", stderr);
    if (ask->outcome == REQUEST_SENT)
        (void)fputs("the request was sent to all units. None of them responds, so its effect is unknown",
                    stderr);
    else if (ask->outcome == REQUEST_ECHO)
        (void)fprintf(
            stderr,
            "unit %u acknowledged the request, unless the adapter returned it: both have the same bytes. "
            "Read the register back, or use --echo off or on",
            unit);
    else if (ask->outcome == REQUEST_REFUSED)
        print_refusal(ask);
    else if (ask->outcome == REQUEST_UNEXPECTED)
        (void)fprintf(
            stderr,
            "unit %u: the response does not fit the request. Check that no other unit has this address",
            unit);
    else
        print_advice(ask, port, counters);
    (void)fputs("\n", stderr);
}
