/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "commands/scan/scan.h"
#include "sensors/models.h"

/* A second response to one request arrives within this time: two units differ by a few milliseconds. */
enum { LINGER_US = 40000 };

enum { DAMAGED_TRIES = 4, ROUNDS = 2 };

/* Returns the model that is most likely at an address. Its first read finds the other models too. */
static const model_t *likely(const fathom_line_settings_t *line, uint8_t address)
{
    for (size_t i = model_count; i-- != 0;)
        if (models[i].scan.count != 0 && model_has_rate(&models[i], line->baud) &&
            model_has_address(&models[i], address))
            return &models[i];
    return &models[0];
}

void scan_first_request(const fathom_line_settings_t *line, uint8_t address, scan_request_t *request)
{
    const model_t *const model = likely(line, address);
    memset(request, 0, sizeof *request);
    request->line = line;
    request->linger_us = LINGER_US;
    request->first = model->scan.first;
    request->count = model->scan.count;
    request->address = address;
}

typedef struct {
    inquiry_t base; /* first, so that ask() gets from it to the rest */
    scan_t *scan;
    const scan_request_t *request; /* the first one: its address and settings are those of all */
    scan_response_t response;
    fathom_status_t failed; /* FATHOM_OK, or why the scan has to end */
} identification_t;

static bool ask(inquiry_t *inquiry, uint16_t first, uint8_t count, uint32_t timeout_us, uint8_t silence_tries)
{
    identification_t *const identification = (identification_t *)inquiry;
    scan_request_t request = *identification->request;
    request.first = first;
    request.count = count;
    request.linger_us = 0;
    if (request.timeout_us < timeout_us) request.timeout_us = timeout_us;
    for (uint8_t tries = DAMAGED_TRIES; tries != 0 && identification->failed == FATHOM_OK; tries--) {
        scan_ask(identification->scan, &request, &identification->response);
        const fathom_status_t status = identification->response.status;
        inquiry->status = status;
        inquiry->values = identification->response.values;
        if (status == FATHOM_OK || status == FATHOM_ERR_EXCEPTION) return status == FATHOM_OK;
        if (scan_has_ended(status)) identification->failed = status;
        const bool is_damaged = status == FATHOM_ERR_CHECKSUM || status == FATHOM_ERR_MALFORMED;
        if (!scan_is_of_line(status) && !is_damaged && --silence_tries == 0) break;
    }
    return false;
}

static bool ask_value(inquiry_t *inquiry, uint16_t address, uint32_t timeout_us)
{
    if (!inquiry->ask(inquiry, address, 1, timeout_us, 1)) return false;
    inquiry->finding->value = inquiry->values[0];
    inquiry->finding->has_value = true;
    return true;
}

/* Returns the model that this device is, of those that share this first read. NULL: it responds like none of them, or like
 * several. */
static const model_t *tell_apart(inquiry_t *inquiry, uint16_t first)
{
    for (uint8_t round = 0; round != ROUNDS; round++) {
        const model_t *found = NULL;
        bool has_answered = false;
        for (size_t i = model_count; i-- != 0;) {
            const model_t *const model = &models[i];
            if (model->scan.first != first || !ask_value(inquiry, model->scan.own, INQUIRY_MEASURE_US))
                continue;
            found = has_answered ? NULL : model;
            has_answered = true;
        }
        if (has_answered) return found;
    }
    for (size_t i = model_count; i-- != 0;) {
        const model_t *const model = &models[i];
        if (model->scan.first == first && model->scan.slow_own != 0 &&
            ask_value(inquiry, model->scan.slow_own, INQUIRY_SLOW_US))
            return model;
    }
    return NULL;
}

static const model_t *find_model(identification_t *identification)
{
    const scan_request_t *const request = identification->request;
    inquiry_t *const inquiry = &identification->base;
    const model_t *model = likely(request->line, request->address);
    if (model->scan.is_it != NULL) {
        if (model->scan.is_it(inquiry)) return model;
        model = &models[0];
        if (!ask(inquiry, model->scan.first, model->scan.count, INQUIRY_MEASURE_US, 1)) return NULL;
    }
    /* The models with a register of their own share a first read that returns the address. A device that returns another
     * value is none of them. */
    if (inquiry->status != FATHOM_OK || inquiry->values[0] != request->address) return NULL;
    return tell_apart(inquiry, model->scan.first);
}

fathom_status_t scan_identify(scan_t *scan, const scan_request_t *request, const scan_response_t *first,
                              scan_finding_t *finding)
{
    identification_t identification = {
        .base = {.ask = ask, .status = first->status, .values = first->values, .finding = finding},
        .scan = scan,
        .request = request,
        .failed = FATHOM_OK};
    memset(finding, 0, sizeof *finding);
    finding->line = *request->line;
    finding->address = request->address;
    finding->mode = SCAN_MODBUS;
    finding->is_double = first->evidence.fitting >= 2;
    const model_t *const model = find_model(&identification);
    finding->kind = model != NULL ? SCAN_SENSOR : SCAN_OTHER;
    finding->model = model;
    return identification.failed;
}
