/* SPDX-License-Identifier: MIT */
#include "diagnosis/advice.h"

#include <inttypes.h>
#include <string.h>

#include "diagnosis/advice_pins.h"
#include "ports/line_text.h"
#include "sensors/modbus_exception.h"

/* "--baud and --parity (now 9600 8E1; ...)": and which others to try. */
static void print_settings(FILE *to, const failure_t *failure)
{
    const fathom_line_settings_t *const now = failure->line;
    const fathom_line_settings_t *const factory = &failure->model->line;
    const uint64_t *const port = failure->counters->attempt.port;
    char text[LINE_TEXT];
    (void)fprintf(to, "check --baud and --parity (now %s)", line_text(now, text));
    if (now->baud != factory->baud || now->parity != factory->parity || now->stop_bits != factory->stop_bits)
        (void)fprintf(to, ", try without them (%s, as from the factory)", line_text(factory, text));
    else if (failure->model->other_settings != NULL)
        (void)fprintf(to, ", try %s", failure->model->other_settings);
    if (port[PORT_FRAMING] != 0)
        (void)fputs("; the port saw characters without an end, so most likely --baud", to);
    else if (port[PORT_PARITY] != 0)
        (void)fputs("; the port saw wrong parity, so most likely --parity", to);
}

static bool is_only_echo(const evidence_t *evidence)
{
    return evidence->echoes != 0 && evidence->rest == 0 && evidence->own == 0 && evidence->foreign == 0 &&
           evidence->masters == 0;
}

static void print_late(FILE *to, uint32_t slowest_us)
{
    /* Twice as long as it took, in steps of 100 ms. */
    const uint32_t try_ms = (slowest_us / 500u + 99u) / 100u * 100u;
    (void)fprintf(to, "it answers, but too late; try a longer --timeout");
    if (slowest_us != 0)
        (void)fprintf(to, ": it took %" PRIu32 " ms, so --timeout %" PRIu32, slowest_us / 1000u, try_ms);
}

/* By what the user tells the address. */
static const char *address_word(const failure_t *failure)
{
    return failure->is_request ? "UNIT" : "--address";
}

/* What else is on the line, if that explains why nothing was understood. */
static bool print_others(FILE *to, const failure_t *failure)
{
    const evidence_t *const evidence = &failure->evidence;
    if (evidence->masters != 0)
        (void)fprintf(to,
                      "requests of another master were heard (it asked address %u), so two ask on this line; "
                      "disconnect the other one or stop its program",
                      evidence->masters_address);
    else if (evidence->foreign_address > failure->model->max_address)
        (void)fprintf(to, "the line works, but it was address %u that was heard, which no %s can have",
                      evidence->foreign_address, failure->model->name);
    else if (evidence->foreign != 0)
        (void)fprintf(to, "the line works, but it was address %u that was heard; try %s%s%u",
                      evidence->foreign_address,
                      failure->shared != NULL ? failure->model->name : address_word(failure),
                      failure->shared != NULL ? ":" : " ", evidence->foreign_address);
    else if (evidence->streamed_a05 != 0 || evidence->streamed_a16 != 0)
        (void)fprintf(to, "frames of %s that sends by itself were heard; try: fathom read %s --mode auto",
                      evidence->streamed_a05 != 0 ? "an a05" : "an a16",
                      evidence->streamed_a05 != 0 ? "a05" : "a16");
    else
        return false;
    return true;
}

/* Nothing was understood, over TCP. */
static void print_tcp(FILE *to, const failure_t *failure)
{
    const uint8_t exception = port_gateway_exception(failure->channel);
    if (exception != 0)
        (void)fprintf(to, "the gateway says exception %02u (%s); check %s, and there the line and the supply",
                      exception, modbus_exception(exception).name, address_word(failure));
    else if (failure->evidence.bytes != 0)
        (void)fputs("a response came that does not fit; check that the server is one of Modbus TCP", to);
    else
        (void)fprintf(to,
                      "the connection stands, but nothing came back; check %s, the sensor's line and "
                      "supply, and try a --timeout that is longer than the gateway's own",
                      address_word(failure));
}

/* Of a sensor without an address: a break on our TX is its trigger. */
static void print_untriggered(FILE *to, const failure_t *failure)
{
    if (failure->status == FATHOM_ERR_CHECKSUM) {
        (void)fputs("what came after the trigger is no frame; ", to);
        print_settings(to, failure);
        (void)fputs(", and for noise", to);
    } else {
        (void)fputs(
            "no response to the trigger; check the supply, the wires from the adapter's TX to the module's "
            "RX "
            "and back, that the adapter can send a break, and that the module is a UART-controlled one (if "
            "not: --mode auto or modbus)",
            to);
    }
}

/* A device that sends by itself leaves little room, and none at all where its frames are known late. */
static bool print_unasked(FILE *to, const failure_t *failure)
{
    enum { LEAST = 3, LITTLE_MS = 2 };
    const char *const path = port_name(failure->channel);
    if (port_has_gateway(failure->channel) || !mode_is_asked(failure->mode) ||
        !failure->model->may_send_unasked || failure->evidence.own < LEAST)
        return false;
    const unsigned latency_ms = port_latency_ms(failure->channel);
    (void)fprintf(to,
                  "it sends measurements by itself, %" PRIu32
                  " were heard, and a request has to fit between two of them; ",
                  failure->evidence.own);
    if (latency_ms != 0 && latency_ms < LITTLE_MS)
        (void)fputs("try again", to);
    else if (latency_ms != 0)
        (void)fprintf(to, "the adapter keeps them back for %u ms: `setserial %s low_latency` ends that",
                      latency_ms, path);
    else
        (void)fprintf(to, "if the adapter keeps them back, as USB adapters do: `setserial %s low_latency`",
                      path);
    return true;
}

static void print_no_response(FILE *to, const failure_t *failure)
{
    const evidence_t *const evidence = &failure->evidence;
    (void)fprintf(to, "no response from address %u: ", failure->address);
    if (failure->counters->attempt.line[FATHOM_LINE_LATE_RESPONSES] != 0) {
        print_late(to, evidence->slowest_us);
    } else if (print_others(to, failure) || print_unasked(to, failure)) {
        return;
    } else if (port_has_gateway(failure->channel)) {
        print_tcp(to, failure);
    } else if (is_only_echo(evidence)) {
        (void)fprintf(to,
                      "only the tool's own request came back, so the adapter works and echoes, but no sensor "
                      "answers behind it; check the wiring behind the adapter (A, B, ground), the sensor's "
                      "supply, and %s",
                      address_word(failure));
    } else if (evidence->own != 0) {
        (void)fputs("frames of this address were heard, but none that answers; check that no other master "
                    "asks, and that only one sensor has this address",
                    to);
    } else if (evidence->bytes != 0) {
        (void)fprintf(to, "bytes were heard, but no %s frame; ", failure->mode->protocol);
        print_settings(to, failure);
        (void)fputs("; A and B swapped and noise look like this too", to);
    } else if (failure->others_answer) {
        char settings[LINE_TEXT];
        (void)fprintf(
            to,
            "nothing was heard of it, while others on this line answer; check its supply, its wires, "
            "its address and its settings (asked at %s)",
            line_text(failure->line, settings));
    } else {
        char settings[LINE_TEXT];
        (void)fprintf(to,
                      "nothing was heard at all; check the supply, A and B (or RX and TX) swapped, %s, and "
                      "--baud and --parity (now %s)",
                      address_word(failure), line_text(failure->line, settings));
    }
}

/* The line was never silent: says nothing about the unit, only about what was heard. */
static void print_line_busy(FILE *to, const failure_t *failure)
{
    const evidence_t *const evidence = &failure->evidence;
    (void)fprintf(to, "no request to address %u could be sent safely: the line was never silent; ",
                  failure->address);
    if (port_has_gateway(failure->channel)) {
        (void)fputs(
            "the server sends without a pause; check that the server is one of Modbus TCP, and restart it",
            to);
        return;
    }
    if (print_unasked(to, failure) || print_others(to, failure)) return;
    if (evidence->own != 0) {
        (void)fprintf(to, "frames of address %u were heard all the time; let it send less often",
                      failure->address);
        return;
    }
    (void)fputs(
        "the bytes form no frames; check the bias and termination resistors and the wiring (A, B, ground), "
        "disconnect other devices one by one, and ",
        to);
    print_settings(to, failure);
}

static void print_other_master(FILE *to, const failure_t *failure)
{
    (void)fprintf(to,
                  "another master sent a request to address %u at the same time, so the response cannot be "
                  "assigned; disconnect the other master or stop its program, or try again",
                  failure->address);
    if (failure->is_request)
        (void)fputs("; a unit that acknowledges another write of function 06 than it was sent looks the same",
                    to);
}

static void print_damaged(FILE *to, const failure_t *failure)
{
    const counters_t *const counters = failure->counters;
    (void)fprintf(to, "the response of address %u was damaged; ", failure->address);
    if (print_others(to, failure) || print_unasked(to, failure)) return;
    if (port_has_gateway(failure->channel))
        (void)fputs("its length is not what it says; check that the server is one of Modbus TCP", to);
    else if (counters->readings != 0)
        (void)fprintf(to,
                      "other responses were good, so the settings are right and it is the line: check the "
                      "screw terminals, the cable, its termination and its ground, and keep it away from "
                      "motors (%" PRIu64 " of %" PRIu64 " attempts damaged)",
                      counters->failures[-FATHOM_ERR_CHECKSUM], counters->attempts + 1);
    else
        (void)fputs("check --parity, the cable and its termination, and that no other unit has this address",
                    to);
}

/* Of a sensor that sends by itself: what the driver dropped in this attempt. */
static void print_dropped(FILE *to, const failure_t *failure)
{
    const uint64_t *const stream = failure->counters->attempt.stream;
    if (stream[FATHOM_STREAM_DROPPED_BYTES] == 0) return;
    (void)fprintf(to, " (damaged frames: %" PRIu64 "; bytes in no frame: %" PRIu64 ")",
                  stream[FATHOM_STREAM_DAMAGED], stream[FATHOM_STREAM_DROPPED_BYTES]);
}

/* Of a sensor that is heard at an address and not asked. */
static void print_unheard(FILE *to, const failure_t *failure)
{
    const evidence_t *const evidence = &failure->evidence;
    if (evidence->bytes == 0)
        (void)fputs(
            "nothing was heard at all; check the supply, A and B swapped, and that it sends by itself (if "
            "not: --mode modbus)",
            to);
    else if (evidence->foreign != 0)
        (void)print_others(to, failure);
    else if (evidence->masters + evidence->own != 0)
        (void)fprintf(
            to,
            "Modbus was heard on this line, and no measurement of address %u; if it does not send by itself: "
            "--mode modbus",
            failure->address);
    else {
        (void)fprintf(to, "bytes were heard, but no frame of %s; ", failure->model->name);
        print_settings(to, failure);
        (void)fputs("; A and B swapped and noise look like this too", to);
        print_dropped(to, failure);
    }
}

static void print_stale(FILE *to, const failure_t *failure)
{
    const uint64_t *const stream = failure->counters->attempt.stream;
    const evidence_t *const evidence = &failure->evidence;
    const bool is_other =
        failure->model->probes > 1 ? evidence->streamed_a05 == 0 : evidence->streamed_a16 == 0;
    if (evidence->bytes == 0) {
        (void)fputs(
            "nothing was heard at all; check the supply, the wire from the sensor's TX, and that it sends by "
            "itself (if not: --mode modbus)",
            to);
    } else if (is_other && (evidence->streamed_a05 != 0 || evidence->streamed_a16 != 0)) {
        (void)print_others(to, failure);
    } else if (evidence->masters + evidence->foreign != 0) {
        (void)fputs(
            "Modbus was heard on this line, and no frame of a sensor that sends by itself; try --mode modbus",
            to);
    } else if (stream[FATHOM_STREAM_AMBIGUOUS] + stream[FATHOM_STREAM_UNSURE] != 0) {
        (void)fprintf(
            to,
            "bytes were heard that look like frames of %s, but not where one begins; check that nothing else "
            "sends on this line, and for noise",
            failure->model->name);
        print_dropped(to, failure);
    } else {
        (void)fprintf(to, "bytes were heard, but no frame of %s; ", failure->model->name);
        print_settings(to, failure);
        (void)fprintf(to, ", that it is an %s, and for noise", failure->model->name);
        print_dropped(to, failure);
    }
}

/* A sensor that sends by itself has sent no good frame. */
static void print_silence(FILE *to, const failure_t *failure)
{
    if (failure->mode->has_address)
        print_unheard(to, failure);
    else
        print_stale(to, failure);
}

/* Which value of an A16 or A05 was refused and why, and what became of the other probes. */
static void print_refused(FILE *to, const failure_t *failure, const reader_facts_t *facts)
{
    const uint16_t raw = facts->refused_raw;
    const bool is_code = raw == 0 || raw >= 0xFFFD;
    const bool has_probes = failure->model->probes > 1;
    if (has_probes) (void)fprintf(to, "probe %u: ", facts->refused_probe);
    if (is_code)
        (void)fprintf(to, "%u (%X) is refused", raw, raw);
    else
        (void)fprintf(to, "%u is refused: no distance from %u to %u mm", raw, facts->min_mm, facts->max_mm);
    if (failure->is_whole)
        (void)fputs(", and with it the other probes of this frame, which may be damaged", to);
    if (is_code) (void)fprintf(to, "; --means %X=... says what it is", raw);
    if (has_probes) (void)fputs("; --probes leaves out a probe that is not fitted", to);
    (void)fprintf(to, "; check that the sensor is %s, and for noise", failure->model->name);
}

/* Which values of an HPS-167S were refused. */
static void print_values(FILE *to, const failure_t *failure, const reader_facts_t *facts)
{
    (void)fputs("a value that cannot be a distance:", to);
    for (uint8_t i = 0; i != facts->value_count; i++) (void)fprintf(to, " %u", facts->values[i]);
    (void)fprintf(to, "; check that the sensor is %s, and for noise", failure->model->name);
}

static void print_port(FILE *to, const failure_t *failure)
{
    const port_t *const port = failure->channel;
    if (!port_is_lost(port)) {
        (void)fprintf(to, "%s: the port did not send the request; check the adapter", port_name(port));
        return;
    }
    (void)fputs(port_error(port), to);
    if (!failure->waits && port_has_gateway(failure->channel))
        (void)fputs("; start again (with --reconnect it is connected again)", to);
    else if (!failure->waits)
        (void)fputs("; connect it again and start again (with --reconnect it is waited for)", to);
    else
        (void)fputs("; waiting until it is back", to);
}

void advice_print(FILE *to, const failure_t *failure)
{
    const reader_facts_t facts = reader_facts(failure->reader);
    if (port_has_pins(failure->channel) && advice_print_pins(to, failure, &facts)) return;
    if (failure->mode->is_triggered &&
        (failure->status == FATHOM_ERR_NO_RESPONSE || failure->status == FATHOM_ERR_CHECKSUM)) {
        print_untriggered(to, failure);
        return;
    }
    switch (failure->status) {
    case FATHOM_ERR_CHECKSUM:
        if (!mode_is_asked(failure->mode))
            print_silence(to, failure);
        else if (is_only_echo(&failure->evidence))
            print_no_response(to, failure);
        else
            print_damaged(to, failure);
        break;
    case FATHOM_ERR_STALE:
        print_silence(to, failure);
        break;
    case FATHOM_ERR_MALFORMED:
        if (print_unasked(to, failure)) break;
        if (facts.is_unexpected)
            (void)fprintf(to,
                          "address %u answered something else than was asked; check that it is %s, and alone "
                          "at this address",
                          failure->address, failure->model->name);
        else if (facts.refused_probe != 0)
            print_refused(to, failure, &facts);
        else
            print_values(to, failure, &facts);
        break;
    case FATHOM_ERR_EXCEPTION: {
        const modbus_exception_t text = modbus_exception(facts.exception);
        (void)fprintf(to, "address %u refused: exception %02u (%s): %s", failure->address, facts.exception,
                      text.name, text.meaning);
        if (text.is_other_sensor) (void)fprintf(to, "; check that it is %s", failure->model->name);
        break;
    }
    case FATHOM_ERR_PORT:
        print_port(to, failure);
        break;
    case FATHOM_ERR_UNSUPPORTED: {
        char settings[LINE_TEXT];
        (void)fprintf(to, "the port cannot be set to %s; nothing was sent",
                      line_text(failure->line, settings));
        break;
    }
    case FATHOM_ERR_LINE_BUSY:
        print_line_busy(to, failure);
        break;
    case FATHOM_ERR_OTHER_MASTER:
        print_other_master(to, failure);
        break;
    default: /* FATHOM_ERR_NO_RESPONSE, and that only the echo came */
        print_no_response(to, failure);
        break;
    }
}
