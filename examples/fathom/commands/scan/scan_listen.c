/* SPDX-License-Identifier: MIT */
#include "commands/scan/scan.h"
#include "sensors/models.h"

enum { LEAST_BYTES = 2 * FATHOM_DYP_A16_LENGTH, OTHER_RATE_US = 1000000 };

static bool name_sensor(scan_finding_t *finding, const model_t *model, scan_mode_t mode)
{
    finding->kind = SCAN_SENSOR;
    finding->model = model;
    finding->mode = (uint8_t)mode;
    return true;
}

/* Returns the model whose automatic frames were heard. */
static const model_t *find_sender(const evidence_t *evidence)
{
    const bool is_a05 = evidence->streamed_a05 > evidence->streamed_a16;
    const uint8_t length = is_a05 ? FATHOM_DYP_A05_LENGTH : FATHOM_DYP_A16_LENGTH;
    for (size_t i = 0; i != model_count && evidence->streamed_a05 + evidence->streamed_a16 != 0; i++)
        if (models[i].scan.frame_length == length) return &models[i];
    return NULL;
}

/* Finds out what was heard with these settings. Returns false if nothing of it has a name. */
static bool understand(scan_t *scan, const fathom_line_settings_t *line)
{
    scan_finding_t *const finding = &scan->sender;
    evidence_t evidence;
    listener_judge(&scan->port.listener, 0, &evidence);
    finding->line = *line;
    const model_t *const sender = find_sender(&evidence);
    if (sender != NULL) return name_sensor(finding, sender, SCAN_AUTO);
    if (evidence.masters != 0) {
        finding->kind = SCAN_MASTER;
        finding->address = evidence.masters_address;
        return true;
    }
    if (evidence.foreign == 0) return false;
    /* Responses without a request: tables 12, #10 and #15 of the HPS-167S describe continuous output. */
    finding->kind = SCAN_SENDER;
    finding->address = evidence.foreign_address;
    for (size_t i = 0; i != model_count; i++)
        if (models[i].may_send_unasked && model_has_rate(&models[i], line->baud))
            return name_sensor(finding, &models[i], SCAN_MODBUS);
    return true;
}

/* Listens at each rate to which a sensor can be set. */
static fathom_status_t try_rates(scan_t *scan)
{
    for (size_t i = 0; i != model_count; i++) {
        for (const uint32_t *rate = models[i].rates; rate != NULL && *rate != 0; rate++) {
            const fathom_line_settings_t line = {*rate, models[i].line.parity, 1};
            const fathom_status_t status = scan_hear(scan, &line, OTHER_RATE_US);
            if (status == FATHOM_ERR_UNSUPPORTED) continue;
            if (status != FATHOM_OK || understand(scan, &line)) return status;
        }
    }
    scan->sender.kind = SCAN_SENDER;
    scan->sender.line = *scan_listen_line();
    return FATHOM_OK;
}

fathom_status_t scan_listen(scan_t *scan)
{
    const fathom_status_t status = scan_hear(scan, scan_listen_line(), scan->plan.listen_us);
    scan->has_sender = scan->port.listener.bytes >= LEAST_BYTES;
    if (status != FATHOM_OK || !scan->has_sender || understand(scan, scan_listen_line())) return status;
    return try_rates(scan);
}
