/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "commands/scan/scan.h"
#include "ports/line_text.h"
#include "sensors/models.h"

/* What the scan knows of an address at the present settings. */
enum { NOT_ASKED = 0, SILENT, ANSWERED, LATE, GARBLED, DAMAGED, BUSY };

/* After a damaged response the scan asks again DAMAGED_REPEATS times. After FEW_GARBLED addresses it asks again once. */
enum { DAMAGED_REPEATS = 3, FEW_GARBLED = 3 };

/* If a busy line or another master ended a request, the scan repeats it BUSY_REPEATS times. After BUSY_LINE addresses in a
 * row that could not be asked, it repeats once. */
enum { BUSY_REPEATS = 2, BUSY_LINE = 4 };

/* The time-out of an address that responded late. */
enum { LATE_TIMEOUT_US = 1000000 };

/* Notes what was heard of other units. */
static void note(scan_t *scan, const evidence_t *evidence)
{
    const scan_plan_t *const plan = &scan->plan;
    scan_heard_t *const heard = &scan->heard;
    const uint8_t other = evidence->foreign_address;
    heard->echoes += evidence->echoes;
    heard->bytes += evidence->rest;
    if (evidence->masters != 0) {
        heard->has_master = true;
        heard->master_address = evidence->masters_address;
    }
    if (evidence->foreign == 0) return;
    if (other < plan->addresses.first || other > plan->addresses.last)
        heard->outside = other;
    else if (scan->states[other] == SILENT)
        scan->states[other] = LATE;
}

/* Returns true if the response was damaged, or if bytes arrived that are neither a frame nor an echo. */
static bool is_troubled(const scan_response_t *response)
{
    return response->status == FATHOM_ERR_CHECKSUM || response->evidence.rest != 0;
}

/* How the requests to one address ended. */
typedef struct {
    uint8_t timeouts;
    uint8_t troubles; /* damaged responses, and bytes that are neither a frame nor an echo */
    uint8_t busy;     /* a busy line, or another master */
    bool has_checksum;
} attempts_t;

/* Counts a request without a whole response. Returns true if the address gets another request. */
static bool count_failure(scan_t *scan, attempts_t *attempts, const scan_response_t *response)
{
    if (scan_is_of_line(response->status)) {
        if (response->status == FATHOM_ERR_OTHER_MASTER) scan->heard.has_other_master = true;
        return ++attempts->busy <= (scan->busy_in_row < BUSY_LINE ? BUSY_REPEATS : 1);
    }
    if (response->status == FATHOM_ERR_CHECKSUM) attempts->has_checksum = true;
    if (is_troubled(response))
        attempts->troubles++;
    else
        attempts->timeouts++;
    const bool is_hopeless = scan->has_sender || scan->garbled >= FEW_GARBLED;
    const unsigned repeats = attempts->troubles == 0 ? scan->plan.repeats : is_hopeless ? 1 : DAMAGED_REPEATS;
    return attempts->timeouts + attempts->troubles <= repeats;
}

/* A single damaged response may be noise. If a device sends automatically, the others may be its frames. */
static uint8_t conclude(const scan_t *scan, const attempts_t *attempts)
{
    if (attempts->troubles < 2 || scan->has_sender) return SILENT;
    return attempts->has_checksum ? DAMAGED : GARBLED;
}

/* Asks one address until its state is known. Returns FATHOM_OK unless the scan has to end or the port does not have the
 * settings. */
static fathom_status_t probe(scan_t *scan, const scan_request_t *request, scan_response_t *response)
{
    uint8_t *const state = &scan->states[request->address];
    attempts_t attempts = {0};
    do {
        scan_ask(scan, request, response);
        if (scan_has_ended(response->status) || response->status == FATHOM_ERR_UNSUPPORTED)
            return response->status;
        note(scan, &response->evidence);
        *state = scan_is_answered(response->status) ? ANSWERED : BUSY;
        if (*state == ANSWERED) return FATHOM_OK;
        if (!scan_is_of_line(response->status)) scan->busy_in_row = 0;
    } while (count_failure(scan, &attempts, response));
    if (scan_is_of_line(response->status)) {
        scan->busy_in_row++;
        return FATHOM_OK;
    }
    *state = conclude(scan, &attempts);
    if (*state == GARBLED) scan->garbled++;
    return FATHOM_OK;
}

static fathom_status_t identify(scan_t *scan, const scan_request_t *request, const scan_response_t *response)
{
    scan_finding_t finding;
    const fathom_status_t status = scan_identify(scan, request, response, &finding);
    if (status != FATHOM_OK) return status;
    scan->found_baud[request->address] = request->line->baud;
    if (finding.kind == SCAN_SENSOR && finding.model == model_with(DECODE_DYP)) scan->has_dyp = true;
    scan_report(scan, &finding);
    return FATHOM_OK;
}

/* Asks an address and identifies the device there. timeout_us: 0, or longer than that of the plan. */
static fathom_status_t visit(scan_t *scan, const fathom_line_settings_t *line, uint8_t address,
                             uint32_t timeout_us)
{
    scan_request_t request;
    scan_response_t response;
    scan_first_request(line, address, &request);
    request.timeout_us = scan_timeout_us(&scan->plan, line);
    if (request.timeout_us < timeout_us) request.timeout_us = timeout_us;
    scan->asked++;
    const fathom_status_t status = probe(scan, &request, &response);
    if (status != FATHOM_OK || scan->states[address] != ANSWERED) return status;
    return identify(scan, &request, &response);
}

static void report_damaged(scan_t *scan, const fathom_line_settings_t *line, uint8_t kind, uint8_t address)
{
    const scan_finding_t finding = {.line = *line, .kind = kind, .mode = SCAN_MODBUS, .address = address};
    scan_report(scan, &finding);
}

/* Finds out what the damaged responses of all addresses mean. */
static void judge_damaged(scan_t *scan, const fathom_line_settings_t *line)
{
    const bool is_other_protocol = 2 * scan->garbled > scan->asked;
    if (is_other_protocol) report_damaged(scan, line, SCAN_NOT_MODBUS, 0);
    for (unsigned address = scan->plan.addresses.first; address <= scan->plan.addresses.last; address++) {
        const uint8_t state = scan->states[address];
        if (state == DAMAGED || (state == GARBLED && !is_other_protocol))
            report_damaged(scan, line, SCAN_DAMAGED, (uint8_t)address);
    }
}

/* A sensor with frames 55 AA responds to this request at any address. Several respond at once and damage each other's
 * responses. */
static fathom_status_t ask_any_dyp(scan_t *scan)
{
    const model_t *const model = model_with(DECODE_DYP);
    const scan_request_t request = {.line = &model->line,
                                    .timeout_us = SCAN_ANY_TIMEOUT_US,
                                    .first = FATHOM_DYP_FIRST_REGISTER,
                                    .count = 1,
                                    .address = FATHOM_LINE_ANY_UNIT,
                                    .is_dyp = true};
    scan_response_t response;
    scan_ask(scan, &request, &response);
    if (scan_has_ended(response.status)) return response.status;
    if (scan_is_of_line(response.status)) scan->heard.not_asked++;
    if (response.status != FATHOM_OK) return FATHOM_OK;
    const scan_finding_t finding = {.line = model->line,
                                    .kind = SCAN_SENSOR,
                                    .model = model,
                                    .mode = SCAN_DYP,
                                    .address = response.address,
                                    .has_value = true,
                                    .value = response.values[0]};
    scan_report(scan, &finding);
    return FATHOM_OK;
}

/* Asks all addresses at these settings. */
static fathom_status_t visit_all(scan_t *scan, const fathom_line_settings_t *line)
{
    const scan_plan_t *const plan = &scan->plan;
    fathom_status_t status = FATHOM_OK;
    memset(scan->states, NOT_ASKED, sizeof scan->states);
    scan->garbled = 0;
    scan->asked = 0;
    for (unsigned address = plan->addresses.first; address <= plan->addresses.last && status == FATHOM_OK;
         address++) {
        scan->address = (uint8_t)address;
        scan_show_progress(scan);
        if (scan->found_baud[address] != line->baud) status = visit(scan, line, scan->address, 0);
        scan->done_us += scan_probe_us(plan, line);
    }
    for (unsigned address = plan->addresses.first; address <= plan->addresses.last && status == FATHOM_OK;
         address++)
        if (scan->states[address] == LATE) status = visit(scan, line, (uint8_t)address, LATE_TIMEOUT_US);
    return status;
}

static fathom_status_t walk_line(scan_t *scan, const fathom_line_settings_t *line)
{
    const scan_plan_t *const plan = &scan->plan;
    fathom_status_t status = visit_all(scan, line);
    if (status != FATHOM_OK) return status;
    for (unsigned address = plan->addresses.first; address <= plan->addresses.last; address++)
        if (scan->states[address] == BUSY) scan->heard.not_asked++;
    judge_damaged(scan, line);
    if (!scan_has_dyp(line)) return FATHOM_OK;
    if (!scan->has_dyp) status = ask_any_dyp(scan);
    scan->done_us += scan_any_us(plan);
    return status;
}

fathom_status_t scan_walk(scan_t *scan)
{
    const scan_plan_t *const plan = &scan->plan;
    for (uint8_t i = 0; i != plan->setting_count; i++) {
        const uint64_t began_us = scan->done_us;
        scan->line = &plan->settings[i];
        const fathom_status_t status = walk_line(scan, scan->line);
        if (scan_has_ended(status)) return status;
        if (status == FATHOM_OK) continue;
        char settings[LINE_TEXT];
        progress_clear(&scan->progress);
        (void)fprintf(stderr, "fathom: this port does not have %s, so the scan leaves it out.\n",
                      line_text(scan->line, settings));
        scan->done_us = began_us + (uint64_t)scan_probe_us(plan, scan->line) * scan_address_count(plan);
    }
    return FATHOM_OK;
}
