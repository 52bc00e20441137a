/* SPDX-License-Identifier: MIT */
#include "commands/scan/scan_walk.h"

#include <string.h>

#include "commands/scan/scan_identify.h"
#include "fathom/engine/dyp_client.h"

/* What is known of an address at the present settings. */
enum { NOT_ASKED = 0, SILENT, ANSWERED, LATE, GARBLED, DAMAGED, BUSY };

/* A damaged response is asked for again so often; once only, where most addresses are answered like that. */
enum { DAMAGED_REPEATS = 3, FEW_GARBLED = 3 };

/* If a busy line or another master ended a request, the scan repeats it BUSY_REPEATS times. After BUSY_LINE addresses in a
 * row that could not be asked, it repeats once. */
enum { BUSY_REPEATS = 2, BUSY_LINE = 4 };

/* For those that have been late. */
enum { LATE_TIMEOUT_US = 1000000 };

static bool has_ended(fathom_status_t status)
{
    return status == FATHOM_ERR_CANCELLED || status == FATHOM_ERR_PORT;
}

/* Sets aside what the listener has heard of others. */
static void note(scan_walk_t *walk, const evidence_t *evidence)
{
    const scan_plan_t *const plan = walk->plan;
    scan_heard_t *const heard = &walk->heard;
    const uint8_t other = evidence->foreign_address;
    heard->echoes += evidence->echoes;
    heard->bytes += evidence->rest;
    if (evidence->masters != 0) {
        heard->has_master = true;
        heard->master_address = evidence->masters_address;
    }
    if (evidence->foreign == 0) return;
    if (other < plan->first || other > plan->last)
        heard->outside = other;
    else if (walk->states[other] == SILENT)
        walk->states[other] = LATE;
}

/* Something came that is neither a frame nor an echo, or what began as the response was damaged. */
static bool is_troubled(const scan_response_t *response)
{
    if (response->status == FATHOM_ERR_CHECKSUM) return true;
    return response->evidence.rest != 0;
}

/* The line was busy, or another master asked the same unit: that proves nothing about the address. */
static bool is_of_line(fathom_status_t status)
{
    return status == FATHOM_ERR_LINE_BUSY || status == FATHOM_ERR_OTHER_MASTER;
}

/* Returns how often an address is asked again after this number of damaged responses. */
static uint8_t repeats(const scan_walk_t *walk, uint8_t troubles)
{
    if (troubles == 0) return walk->plan->repeats;
    return walk->has_sender || walk->garbled >= FEW_GARBLED ? 1 : DAMAGED_REPEATS;
}

/* What the requests to one address have ended with. */
typedef struct {
    uint8_t timeouts;
    uint8_t troubles; /* damaged responses, and bytes that are neither a frame nor an echo */
    uint8_t busy;     /* a busy line, or another master */
    bool has_checksum;
} attempts_t;

/* The line was busy. Returns true if the address gets no further request. */
static bool is_too_busy(scan_walk_t *walk, attempts_t *attempts, const scan_response_t *response)
{
    if (response->status == FATHOM_ERR_OTHER_MASTER) walk->heard.has_other_master = true;
    attempts->busy++;
    if (attempts->busy <= (walk->busy_in_row < BUSY_LINE ? BUSY_REPEATS : 1)) return false;
    walk->busy_in_row++;
    return true;
}

/* The unit did not respond well. Returns true if the address gets no further request. */
static bool is_silent(scan_walk_t *walk, attempts_t *attempts, const scan_response_t *response)
{
    walk->busy_in_row = 0;
    if (!is_troubled(response)) {
        attempts->timeouts++;
    } else {
        attempts->troubles++;
        if (response->status == FATHOM_ERR_CHECKSUM) attempts->has_checksum = true;
    }
    return attempts->timeouts + attempts->troubles > repeats(walk, attempts->troubles);
}

/* One piece of trouble may be noise, and more may be what a device sends by itself. */
static uint8_t conclude(const scan_walk_t *walk, const attempts_t *attempts)
{
    if (attempts->troubles < 2 || walk->has_sender) return SILENT;
    return attempts->has_checksum ? DAMAGED : GARBLED;
}

/* Asks one address until its state is clear. Returns FATHOM_OK unless the scan is over or the port cannot. */
static fathom_status_t probe(scan_walk_t *walk, const scan_request_t *request, scan_response_t *response)
{
    uint8_t *const state = &walk->states[request->address];
    attempts_t attempts = {0};
    bool is_over = false;
    while (!is_over) {
        scan_ask(walk->wire, request, response);
        const fathom_status_t status = response->status;
        if (has_ended(status) || status == FATHOM_ERR_UNSUPPORTED) return status;
        note(walk, &response->evidence);
        *state = ANSWERED;
        if (scan_is_answered(status)) return FATHOM_OK;
        if (is_of_line(status)) {
            *state = BUSY;
            if (is_too_busy(walk, &attempts, response)) return FATHOM_OK;
        } else {
            is_over = is_silent(walk, &attempts, response);
        }
    }
    *state = conclude(walk, &attempts);
    if (*state == GARBLED) walk->garbled++;
    return FATHOM_OK;
}

static fathom_status_t identify(scan_walk_t *walk, const scan_request_t *request,
                                const scan_response_t *response)
{
    scan_finding_t finding;
    const fathom_status_t status = scan_identify(walk->wire, request, response, &finding);
    if (status != FATHOM_OK) return status;
    walk->found_baud[request->address] = request->line->baud;
    if (finding.model == FATHOM_A05) walk->has_a05 = true;
    walk->tell->found(walk->tell->ctx, &finding);
    return FATHOM_OK;
}

/* Asks an address, and who is there. timeout_us: 0, or longer than the plan's. */
static fathom_status_t visit(scan_walk_t *walk, const fathom_line_settings_t *line, uint8_t address,
                             uint32_t timeout_us)
{
    scan_request_t request;
    scan_response_t response;
    scan_first_request(line, address, &request);
    request.timeout_us = scan_timeout_us(walk->plan, line);
    if (request.timeout_us < timeout_us) request.timeout_us = timeout_us;
    walk->asked++;
    const fathom_status_t status = probe(walk, &request, &response);
    if (status != FATHOM_OK || walk->states[address] != ANSWERED) return status;
    return identify(walk, &request, &response);
}

static void tell_damaged(const scan_walk_t *walk, const fathom_line_settings_t *line, uint8_t kind,
                         uint8_t address)
{
    const scan_finding_t finding = {.line = *line, .kind = kind, .mode = SCAN_MODBUS, .address = address};
    walk->tell->found(walk->tell->ctx, &finding);
}

/* All addresses have been asked: what do the damaged responses mean? */
static void judge_damaged(const scan_walk_t *walk, const fathom_line_settings_t *line)
{
    const bool is_other_protocol = 2 * walk->garbled > walk->asked;
    if (is_other_protocol) tell_damaged(walk, line, SCAN_NOT_MODBUS, 0);
    for (unsigned address = walk->plan->first; address <= walk->plan->last; address++) {
        const uint8_t state = walk->states[address];
        if (state == DAMAGED || (state == GARBLED && !is_other_protocol))
            tell_damaged(walk, line, SCAN_DAMAGED, (uint8_t)address);
    }
}

/* One A05 that speaks 55 AA answers this whatever its address is. Several answer at once, and damage each other. */
static fathom_status_t ask_any_a05(scan_walk_t *walk)
{
    const scan_request_t request = {.line = &scan_dyp_line,
                                    .timeout_us = SCAN_ANY_TIMEOUT_US,
                                    .first = FATHOM_DYP_FIRST_REGISTER,
                                    .count = 1,
                                    .address = FATHOM_LINE_ANY_UNIT,
                                    .is_dyp = true};
    scan_finding_t finding = {
        .line = scan_dyp_line, .kind = SCAN_SENSOR, .model = FATHOM_A05, .mode = SCAN_DYP, .has_value = true};
    scan_response_t response;
    scan_ask(walk->wire, &request, &response);
    if (has_ended(response.status)) return response.status;
    finding.address = response.address;
    finding.value = response.values[0];
    if (is_of_line(response.status)) walk->heard.not_asked++;
    if (response.status != FATHOM_OK) return FATHOM_OK;
    walk->has_a05 = true;
    walk->tell->found(walk->tell->ctx, &finding);
    return FATHOM_OK;
}

static fathom_status_t walk_line(scan_walk_t *walk, const fathom_line_settings_t *line)
{
    const scan_plan_t *const plan = walk->plan;
    fathom_status_t status = FATHOM_OK;
    memset(walk->states, NOT_ASKED, sizeof walk->states);
    walk->garbled = 0;
    walk->asked = 0;
    for (unsigned address = plan->first; address <= plan->last && status == FATHOM_OK; address++) {
        walk->tell->progress(walk->tell->ctx, walk->done_us, line, (uint8_t)address);
        if (walk->found_baud[address] != line->baud) status = visit(walk, line, (uint8_t)address, 0);
        walk->done_us += scan_probe_us(plan, line);
    }
    for (unsigned address = plan->first; address <= plan->last && status == FATHOM_OK; address++)
        if (walk->states[address] == LATE) status = visit(walk, line, (uint8_t)address, LATE_TIMEOUT_US);
    if (status != FATHOM_OK) return status;
    for (unsigned address = plan->first; address <= plan->last; address++)
        if (walk->states[address] == BUSY) walk->heard.not_asked++;
    judge_damaged(walk, line);
    if (!scan_is_dyp_line(line)) return FATHOM_OK;
    if (!walk->has_a05) status = ask_any_a05(walk);
    walk->done_us += scan_any_us(plan);
    return status;
}

fathom_status_t scan_walk(scan_walk_t *walk)
{
    const scan_plan_t *const plan = walk->plan;
    for (uint8_t i = 0; i != plan->setting_count; i++) {
        const fathom_line_settings_t *const line = &plan->settings[i];
        const uint64_t began_us = walk->done_us;
        const fathom_status_t status = walk_line(walk, line);
        if (has_ended(status)) return status;
        if (status != FATHOM_OK) {
            walk->tell->unsupported(walk->tell->ctx, line);
            walk->done_us = began_us + (uint64_t)scan_probe_us(plan, line) * scan_addresses(plan);
        }
    }
    return FATHOM_OK;
}
