/* SPDX-License-Identifier: MIT */
#include "scan/scan_identify.h"

#include <string.h>

#include "fathom/hps167s_registers.h"
#include "scan/scan_plan.h"

/* Registers of #2 and of #5, whose answers have one shape. */
enum { FOUR = FATHOM_HPS167S_CONFIGURATION_COUNT };

enum { NEXT_CENTURY = 2100 };

/* A16 6(3), A05 3(3) */
enum { PROCESSED = 0x0100, REALTIME = 0x0101, FIRST_PROBE = 0x0106, ADDRESS = 0x0200 };

/* An A16 answers 0x0101 in about 120 ms and 0x0100 in up to 520, an A05 takes about 100 ms a probe. */
enum { MEASURE_US = 300000, PROCESSED_US = 1000000 };

/* A second answer to one request is there by then: two units differ by a few milliseconds. */
enum { LINGER_US = 40000 };

enum { DAMAGED_TRIES = 4, ROUNDS = 2 };

void scan_first_request(const fathom_line_settings_t *line, uint8_t address, scan_request_t *request)
{
    const bool may_be_hps167s =
        scan_is_hps167s_rate(line->baud) && address != 0 && address <= FATHOM_HPS167S_MAX_ADDRESS;
    memset(request, 0, sizeof *request);
    request->line = line;
    request->linger_us = LINGER_US;
    request->first = may_be_hps167s ? FATHOM_HPS167S_VERSION : ADDRESS;
    request->count = may_be_hps167s ? FATHOM_HPS167S_VERSION_COUNT : 1;
    request->address = address;
}

typedef struct {
    const scan_wire_t *wire;
    const scan_request_t *request; /* the first one: whom, with which settings */
    scan_finding_t *finding;
    scan_answer_t answer;
    fathom_status_t failed; /* FATHOM_READY, or why it cannot go on */
} inquiry_t;

/* Reads; what is damaged, is another answer (perhaps a measurement that came unasked) or, silence_tries > 1, silent is
 * asked again. True: the values are in inquiry->answer. */
static bool ask(inquiry_t *inquiry, uint16_t first, uint8_t count, uint32_t timeout_us, uint8_t silence_tries)
{
    scan_request_t request = *inquiry->request;
    request.first = first;
    request.count = count;
    request.linger_us = 0;
    if (request.timeout_us < timeout_us) request.timeout_us = timeout_us;
    for (uint8_t tries = DAMAGED_TRIES; tries != 0 && inquiry->failed == FATHOM_READY; tries--) {
        scan_ask(inquiry->wire, &request, &inquiry->answer);
        const fathom_status_t status = inquiry->answer.status;
        if (status == FATHOM_READY || status == FATHOM_ERR_EXCEPTION) return status == FATHOM_READY;
        if (status == FATHOM_ERR_CANCELLED || status == FATHOM_ERR_PORT) inquiry->failed = status;
        if (status != FATHOM_ERR_CHECKSUM && status != FATHOM_ERR_MALFORMED && --silence_tries == 0) break;
    }
    return false;
}

/* ---- HPS-167S ---- */

/* True: the values are in four, too. */
static bool ask_four(inquiry_t *inquiry, uint16_t first, uint16_t four[FOUR])
{
    if (!ask(inquiry, first, FOUR, MEASURE_US, 2)) return false;
    memcpy(four, inquiry->answer.values, FOUR * sizeof *four);
    return true;
}

/* The answer of #2 has the shape of a measurement (#5), which may come unasked: so two have to agree, and to differ from
 * a measurement between them. */
static bool ask_configuration(inquiry_t *inquiry)
{
    uint16_t told[FOUR];
    uint16_t again[FOUR];
    uint16_t measured[FOUR];
    if (!ask_four(inquiry, FATHOM_HPS167S_CONFIGURATION, told) ||
        !ask_four(inquiry, FATHOM_HPS167S_MEASUREMENT, measured) ||
        !ask_four(inquiry, FATHOM_HPS167S_CONFIGURATION, again) || memcmp(told, again, sizeof told) != 0 ||
        memcmp(told, measured, sizeof told) == 0 || !fathom_hps167s_may_be_configuration(told))
        return false;
    fathom_hps167s_configuration_t is;
    fathom_hps167s_decode_configuration(told, false, &is);
    inquiry->finding->has_termination = is.termination;
    return true;
}

static bool ask_version(inquiry_t *inquiry)
{
    return ask(inquiry, FATHOM_HPS167S_VERSION, FATHOM_HPS167S_VERSION_COUNT, MEASURE_US, 2);
}

static bool is_hps167s(inquiry_t *inquiry, const scan_answer_t *first)
{
    scan_finding_t *const finding = inquiry->finding;
    fathom_hps167s_version_t *const version = &finding->interface;
    if (first->status == FATHOM_ERR_MALFORMED && ask_version(inquiry)) first = &inquiry->answer;
    if (first->status != FATHOM_READY) return false;
    fathom_hps167s_decode_version(first->values, version);
    finding->has_interface =
        version->year < NEXT_CENTURY && fathom_hps167s_is_date(version->month, version->day);
    if (ask(inquiry, FATHOM_HPS167S_DETAILS, FATHOM_HPS167S_DETAILS_COUNT, MEASURE_US, 2)) {
        fathom_hps167s_decode_details(inquiry->answer.values, &finding->details);
        finding->has_details = fathom_hps167s_may_be_details(inquiry->answer.values);
    }
    finding->has_config = ask_configuration(inquiry);
    return finding->has_interface && (finding->has_details || finding->has_config);
}

/* ---- A16 and A05 ---- */

static bool ask_value(inquiry_t *inquiry, uint16_t first, uint32_t timeout_us)
{
    if (!ask(inquiry, first, 1, timeout_us, 1)) return false;
    inquiry->finding->value = inquiry->answer.values[0];
    inquiry->finding->has_value = true;
    return true;
}

/* The model; 0: none of the two. */
static uint8_t ask_dyp(inquiry_t *inquiry)
{
    for (uint8_t round = 0; round != ROUNDS; round++) {
        const bool has_probe = ask_value(inquiry, FIRST_PROBE, MEASURE_US);
        const uint16_t probe = inquiry->finding->value;
        const bool has_distance = ask_value(inquiry, REALTIME, MEASURE_US);
        if (has_probe && has_distance) return 0;
        if (has_distance) return FATHOM_A16;
        inquiry->finding->value = probe;
        if (has_probe) return FATHOM_A05;
    }
    return ask_value(inquiry, PROCESSED, PROCESSED_US) ? FATHOM_A16 : 0;
}

static uint8_t find_model(inquiry_t *inquiry, const scan_answer_t *first)
{
    const bool has_version = inquiry->request->first == FATHOM_HPS167S_VERSION;
    if (has_version && is_hps167s(inquiry, first)) return FATHOM_HPS167S;
    if (inquiry->failed != FATHOM_READY) return 0;
    if (has_version && !ask(inquiry, ADDRESS, 1, MEASURE_US, 1)) return 0;
    const scan_answer_t *const answer = has_version ? &inquiry->answer : first;
    /* 0x0200 is the address, in the low byte; so who answers something else is no A16 or A05. */
    if (answer->status != FATHOM_READY || answer->values[0] != inquiry->request->address) return 0;
    return ask_dyp(inquiry);
}

fathom_status_t scan_identify(const scan_wire_t *wire, const scan_request_t *request,
                              const scan_answer_t *first, scan_finding_t *finding)
{
    inquiry_t inquiry = {.wire = wire, .request = request, .finding = finding, .failed = FATHOM_READY};
    memset(finding, 0, sizeof *finding);
    finding->line = *request->line;
    finding->address = request->address;
    finding->mode = SCAN_MODBUS;
    finding->is_double = first->evidence.fitting >= 2;
    finding->model = find_model(&inquiry, first);
    finding->kind = finding->model != 0 ? SCAN_SENSOR : SCAN_OTHER;
    return inquiry.failed;
}
