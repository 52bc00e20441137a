/* SPDX-License-Identifier: MIT */
#include "scan_identify.h"

#include <string.h>

#include "fathom/hps167s.h"
#include "scan_plan.h"

/* HPS-167S #1 to #3, and #5 */
enum { VERSION = 0x0001, CONFIGURATION = 0x0002, DETAILS = 0x0003, MEASUREMENT = 0x0008 };
enum { VERSION_COUNT = 3, DETAILS_COUNT = 11, ACK = 0xB0, FOUR_REGISTERS = 8 };

/* A16 6(3), A05 3(3) */
enum { PROCESSED = 0x0100, REALTIME = 0x0101, FIRST_PROBE = 0x0106, ADDRESS = 0x0200 };

/* An A16 answers 0x0101 in about 120 ms and 0x0100 in up to 520, an A05 takes about 100 ms a probe. */
enum { MEASURE_US = 300000, PROCESSED_US = 1000000 };

/* A second answer to one question is there by then: two units differ by a few milliseconds. */
enum { LINGER_US = 40000 };

enum { DAMAGED_TRIES = 4, ROUNDS = 2 };

void scan_first_question(const fathom_line_settings_t *line, uint8_t address, scan_question_t *question)
{
    const bool may_be_hps167s =
        scan_is_hps167s_rate(line->baud) && address != 0 && address <= FATHOM_HPS167S_MAX_ADDRESS;
    memset(question, 0, sizeof *question);
    question->line = line;
    question->linger_us = LINGER_US;
    question->first = may_be_hps167s ? VERSION : ADDRESS;
    question->count = may_be_hps167s ? VERSION_COUNT : 1;
    question->address = address;
}

typedef struct {
    const scan_wire_t *wire;
    const scan_question_t *question; /* the first one: whom, with which settings */
    scan_finding_t *finding;
    scan_answer_t answer;
    fathom_status_t failed; /* FATHOM_READY, or why it cannot go on */
} inquiry_t;

/* Reads; what is damaged, is another answer (perhaps a measurement that came unasked) or, silence_tries > 1, silent is
 * asked again. True: the values are in inquiry->answer. */
static bool ask(inquiry_t *inquiry, uint16_t first, uint8_t count, uint32_t timeout_us, uint8_t silence_tries)
{
    scan_question_t question = *inquiry->question;
    question.first = first;
    question.count = count;
    question.linger_us = 0;
    if (question.timeout_us < timeout_us) question.timeout_us = timeout_us;
    for (uint8_t tries = DAMAGED_TRIES; tries != 0 && inquiry->failed == FATHOM_READY; tries--) {
        scan_ask(inquiry->wire, &question, &inquiry->answer);
        const fathom_status_t status = inquiry->answer.status;
        if (status == FATHOM_READY || status == FATHOM_ERR_EXCEPTION) return status == FATHOM_READY;
        if (status == FATHOM_ERR_CANCELLED || status == FATHOM_ERR_PORT) inquiry->failed = status;
        if (status != FATHOM_ERR_CHECKSUM && status != FATHOM_ERR_MALFORMED && --silence_tries == 0) break;
    }
    return false;
}

/* ---- HPS-167S ---- */

/* Registers are pairs of bytes here. */
static void get_bytes(const uint16_t *registers, uint8_t count, uint8_t *bytes)
{
    for (uint8_t i = 0; i != count; i++) {
        bytes[2 * i] = (uint8_t)(registers[i] >> 8);
        bytes[2 * i + 1] = (uint8_t)registers[i];
    }
}

static bool is_date(const uint8_t *date)
{
    return date[0] < 100 && date[1] >= 1 && date[1] <= 12 && date[2] >= 1 && date[2] <= 31;
}

static bool is_switch(uint8_t byte) { return byte == 0x00 || byte == 0xFF; }

static bool ask_four(inquiry_t *inquiry, uint16_t first, uint8_t bytes[FOUR_REGISTERS])
{
    if (!ask(inquiry, first, FOUR_REGISTERS / 2, MEASURE_US, 2)) return false;
    get_bytes(inquiry->answer.values, FOUR_REGISTERS / 2, bytes);
    return true;
}

/* The answer of #2 has the shape of a measurement (#5), which may come unasked: so two have to agree, and to differ from
 * a measurement between them. */
static bool ask_configuration(inquiry_t *inquiry)
{
    enum { TERMINATION = 0, OUTPUT = 1 };
    uint8_t config[FOUR_REGISTERS];
    uint8_t again[FOUR_REGISTERS];
    uint8_t measured[FOUR_REGISTERS];
    if (!ask_four(inquiry, CONFIGURATION, config) || !ask_four(inquiry, MEASUREMENT, measured) ||
        !ask_four(inquiry, CONFIGURATION, again) || memcmp(config, again, sizeof config) != 0 ||
        memcmp(config, measured, sizeof config) == 0 || !is_switch(config[TERMINATION]) ||
        !is_switch(config[OUTPUT]))
        return false;
    inquiry->finding->has_termination = config[TERMINATION] != 0x00;
    return true;
}

static bool is_hps167s(inquiry_t *inquiry, const scan_answer_t *first)
{
    scan_finding_t *const finding = inquiry->finding;
    if (first->status == FATHOM_ERR_MALFORMED && ask(inquiry, VERSION, VERSION_COUNT, MEASURE_US, 2))
        first = &inquiry->answer;
    if (first->status != FATHOM_READY) return false;
    get_bytes(first->values, VERSION_COUNT, finding->interface);
    finding->has_interface = is_date(finding->interface);
    if (ask(inquiry, DETAILS, DETAILS_COUNT, MEASURE_US, 2)) {
        get_bytes(inquiry->answer.values, DETAILS_COUNT, finding->details);
        finding->has_details = finding->details[0] == ACK;
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
    const bool has_version = inquiry->question->first == VERSION;
    if (has_version && is_hps167s(inquiry, first)) return FATHOM_HPS167S;
    if (inquiry->failed != FATHOM_READY) return 0;
    if (has_version && !ask(inquiry, ADDRESS, 1, MEASURE_US, 1)) return 0;
    const scan_answer_t *const answer = has_version ? &inquiry->answer : first;
    /* 0x0200 is the address, in the low byte; so who answers something else is no A16 or A05. */
    if (answer->status != FATHOM_READY || answer->values[0] != inquiry->question->address) return 0;
    return ask_dyp(inquiry);
}

fathom_status_t scan_identify(const scan_wire_t *wire, const scan_question_t *question,
                              const scan_answer_t *first, scan_finding_t *finding)
{
    inquiry_t inquiry = {.wire = wire, .question = question, .finding = finding, .failed = FATHOM_READY};
    memset(finding, 0, sizeof *finding);
    finding->line = *question->line;
    finding->address = question->address;
    finding->mode = SCAN_MODBUS;
    finding->is_double = first->evidence.fitting >= 2;
    finding->model = find_model(&inquiry, first);
    finding->kind = finding->model != 0 ? SCAN_SENSOR : SCAN_OTHER;
    return inquiry.failed;
}
