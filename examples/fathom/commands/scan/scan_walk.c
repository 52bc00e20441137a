/* SPDX-License-Identifier: MIT */
/* Sends the requests of a scan, and evaluates the received bytes. */
#include <string.h>

#include "commands/scan/scan.h"

/* ---- the time of a scan ---- */

enum {
    /* An HPS-167S needs 2.5 to 20 ms, and a USB adapter may delay bytes by 16 ms. A later response arrives during the
     * request to the next address, and the scan sends that unit another request. */
    TIMEOUT_US = 100000,
    ANY_TIMEOUT_US = 300000,   /* of the request to any A05 */
    LATE_TIMEOUT_US = 1000000, /* of an address that responded late */
    REQUEST_BYTES = 8,
    LATENESS_US =
        5000 /* the system wakes a program late, and a USB adapter reports late that a request has left */
};

static uint32_t longer(uint32_t one_us, uint32_t other_us) { return one_us > other_us ? one_us : other_us; }

/* Returns true if these are the factory settings of the model. */
static bool is_of(const model_t *model, const fathom_line_settings_t *line)
{
    return line->baud == model->line.baud && line->parity == model->line.parity;
}

/* Returns the time-out of an address: the user's, or the longest of the models that have these factory settings. */
static uint32_t timeout_of(const scan_settings_t *settings, const fathom_line_settings_t *line)
{
    uint32_t longest_us = TIMEOUT_US;
    for (size_t i = 0; i != model_count; i++)
        if (model_is_at(&models[i], line)) longest_us = longer(longest_us, models[i].scan.timeout_us);
    return settings->timeout_us != 0 ? settings->timeout_us : longest_us;
}

static uint32_t once_us(const fathom_line_settings_t *line, uint32_t wait_us)
{
    const uint32_t bits = REQUEST_BYTES * (uint32_t)fathom_character_bits(line);
    return bits * 1000000u / line->baud + wait_us + LATENESS_US;
}

/* Returns the time for one silent address. The silence before the next request passes with the time-out. Before an address
 * gets another request, the scan waits another time-out, since the address may still respond. */
static uint32_t address_us(const scan_settings_t *settings, const fathom_line_settings_t *line)
{
    const uint32_t wait_us = timeout_of(settings, line);
    const uint32_t first_us = once_us(line, wait_us);
    return first_us + settings->retries * (first_us + wait_us);
}

/* Returns the model of which a unit responds at address 255 with these settings; NULL: there is none. */
static const model_t *with_any(const fathom_line_settings_t *line)
{
    for (size_t i = 0; i != model_count; i++)
        if (models[i].scan.has_any && model_is_at(&models[i], line)) return &models[i];
    return NULL;
}

/* Returns the register at which false friends respond to requests with these settings: that of a model's distance. 0:
 * none. */
static uint16_t false_friends_at(const fathom_line_settings_t *line)
{
    const model_t *const model = with_any(line);
    return model != NULL ? model->scan.second : 0;
}

/* False friends are other makers' devices, as an HPS-167S is. */
static uint32_t false_friends_us(const scan_settings_t *settings)
{
    return settings->timeout_us != 0 ? settings->timeout_us : TIMEOUT_US;
}

/* Returns the time for all addresses at these settings, for address 255, and for any A05. After the request to address 255
 * any unit may respond late, so it takes two time-outs. The request to any A05 waits until no unit may
 * respond late, and after it any unit may, so it takes three time-outs. */
static uint64_t line_us(const scan_settings_t *settings, const fathom_line_settings_t *line)
{
    const uint32_t count = settings->addresses.last - settings->addresses.first + 1u;
    const bool has_any = is_of(model_with(DECODE_DYP), line);
    const uint32_t wait_us = timeout_of(settings, line);
    return (uint64_t)count * address_us(settings, line) +
           (with_any(line) != NULL ? once_us(line, wait_us) + wait_us : 0) +
           (false_friends_at(line) != 0 ? (uint64_t)count * once_us(line, false_friends_us(settings)) : 0) +
           (has_any ? timeout_of(settings, line) + 2 * ANY_TIMEOUT_US + LATENESS_US : 0);
}

uint64_t scan_plan_us(const scan_settings_t *settings)
{
    uint64_t sum_us = settings->listen_us;
    for (uint8_t i = 0; i != settings->line_count; i++) sum_us += line_us(settings, &settings->lines[i]);
    return sum_us;
}

uint64_t scan_now_us(const scan_t *scan) { return scan->port.host->now_us(scan->port.host->ctx); }

static void show_progress(scan_t *scan)
{
    const uint64_t now_us = scan_now_us(scan);
    uint64_t done_us = now_us - scan->progress.start_us;
    char doing[LINE_TEXT + 16] = "listens";
    if (scan->line != NULL) {
        char line[LINE_TEXT];
        (void)snprintf(doing, sizeof doing, "%s address %u", line_text(scan->line, line), scan->read.address);
        done_us = scan->done_us;
    }
    progress_show(&scan->progress, now_us, done_us, doing);
}

/* ---- listening ---- */

/* Fewer bytes than two frames of an A16 are noise. */
enum { LEAST_BYTES = 2 * FATHOM_DYP_A16_LENGTH, OTHER_RATE_US = 1000000 };

/* Listens with these settings for `us`. FATHOM_ERR_UNSUPPORTED: the port does not have them. */
static fathom_status_t hear(scan_t *scan, const fathom_line_settings_t *line, uint32_t us)
{
    enum { SLICE_US = 100000, SET_LINE_POLL_US = 1000 };
    const fathom_uart_t *const uart = scan->port.parts.uart;
    int is_set = 0;
    fathom_status_t status = FATHOM_OK;
    while (status == FATHOM_OK && is_set == 0) {
        if (!port_has_settings(scan->port.kind) && line == &scan->port.options.line)
            is_set = 1; /* those of the converter */
        else
            is_set = uart->set_line != NULL ? uart->set_line(uart->ctx, line) : -1;
        if (is_set == 0) status = port_wait(&scan->port, SET_LINE_POLL_US);
    }
    if (is_set < 0) return FATHOM_ERR_UNSUPPORTED;
    listener_forget(&scan->port.listener);
    for (uint32_t heard_us = 0; status == FATHOM_OK && heard_us < us; heard_us += SLICE_US) {
        show_progress(scan);
        status = port_listen(&scan->port, us - heard_us < SLICE_US ? us - heard_us : SLICE_US);
    }
    return status;
}

/* Identifies the sender of the bytes that were received with these settings. Returns false if it is unknown. */
static bool understand(scan_t *scan, const fathom_line_settings_t *line)
{
    evidence_t evidence;
    scan_finding_t sender = {.line = *line, .kind = SCAN_SENSOR, .mode = SCAN_AUTO};
    listener_judge(&scan->port.listener, 0, &evidence);
    const bool is_a05 = evidence.streamed_a05 > evidence.streamed_a16;
    const uint8_t length = is_a05 ? FATHOM_DYP_A05_LENGTH : FATHOM_DYP_A16_LENGTH;
    const listener_t *const listener = &scan->port.listener;
    for (size_t i = 0; i != model_count; i++) {
        if (models[i].scan.is_alike == NULL || !models[i].scan.is_alike(listener->window, listener->have))
            continue;
        scan->sender = (scan_finding_t){.kind = SCAN_ALIKE, .line = *line, .perhaps = models[i].scan.alike};
        return true;
    }
    for (size_t i = 0; i != model_count && evidence.streamed_a05 + evidence.streamed_a16 != 0; i++)
        if (models[i].scan.frame_length == length) sender.model = &models[i];
    if (sender.model == NULL && evidence.masters != 0) {
        sender.kind = SCAN_MASTER;
        sender.address = evidence.masters_address;
    } else if (sender.model == NULL) {
        /* Responses without a request: tables 12, #10 and #15 of the HPS-167S describe continuous output. */
        if (evidence.foreign == 0) return false;
        sender.address = evidence.foreign_address;
        sender.mode = SCAN_MODBUS;
        for (size_t i = 0; i != model_count; i++)
            if (models[i].may_send_unasked && model_has_rate(&models[i], line->baud))
                sender.model = &models[i];
        if (sender.model == NULL) sender.kind = SCAN_SENDER;
    }
    scan->sender = sender;
    return true;
}

/* Listens with these settings, if the port has them. Returns true if the sender is known, or if the scan ends. */
static bool hears(scan_t *scan, const fathom_line_settings_t *line)
{
    const fathom_status_t status = hear(scan, line, OTHER_RATE_US);
    if (status != FATHOM_ERR_UNSUPPORTED) scan->status = status;
    return status != FATHOM_ERR_UNSUPPORTED && (status != FATHOM_OK || understand(scan, line));
}

/* An A16 and an A05 send at 9600 8N1, with which the port was opened. Bytes that are not understood may have another
 * rate, so the scan then listens at each rate to which a sensor can be set, and at that of the relatives. */
void scan_listen(scan_t *scan)
{
    const fathom_line_settings_t *const first = &scan->port.options.line;
    scan->status = hear(scan, first, scan->settings->listen_us);
    if (scan->status != FATHOM_OK || scan->port.listener.bytes < LEAST_BYTES || understand(scan, first))
        return;
    for (size_t i = model_count; i-- != 0;) {
        for (const uint32_t *rate = models[i].rates; rate != NULL && *rate != 0; rate++)
            if (hears(scan, &(fathom_line_settings_t){*rate, models[i].line.parity, 1})) return;
    }
    if (hears(scan, &model_with(DECODE_STREAM_ONE)->relatives_line)) return;
    scan->sender = (scan_finding_t){.kind = SCAN_SENDER, .line = *first};
}

/* ---- one request ---- */

/* Returns true if a device responded: with a value, an exception or a malformed frame. */
static bool is_answered(fathom_status_t status)
{
    return status == FATHOM_OK || status == FATHOM_ERR_EXCEPTION || status == FATHOM_ERR_MALFORMED;
}

/* Returns true if the line was busy or another master sent the same unit a request. Neither proves anything about the unit. */
static bool is_of_line(fathom_status_t status)
{
    return status == FATHOM_ERR_LINE_BUSY || status == FATHOM_ERR_OTHER_MASTER;
}

static bool is_harmless(const scan_read_t *read)
{
    if (read->is_dyp) return read->address != FATHOM_LINE_ALL_UNITS;
    return read->count <= SCAN_REGISTERS && models_allow_read(read->address, read->first, read->count);
}

void scan_ask(scan_t *scan)
{
    scan_read_t *const read = &scan->read;
    port_t *const port = &scan->port;
    fathom_modbus_request_t pending = {
        .transaction = {.timeout_us = read->timeout_us,
                        .line_settings = port_has_settings(port->kind) ? read->line : NULL}};
    read->status = is_harmless(read) ? scan->status : FATHOM_ERR_ARGUMENT;
    if (read->status != FATHOM_OK) return;
    fathom_modbus_read_holding_registers(&pending.message, read->address, read->first, read->count,
                                         read->values);
    listener_forget(&port->listener);
    read->status = read->is_dyp ? fathom_dyp_client_submit(&port->line, &pending)
                                : port->modbus.submit(&port->line, &pending);
    if (read->status == FATHOM_PENDING) read->status = port_finish(port, &pending.transaction);
    read->responder = pending.message.head[0];
    if (is_answered(read->status) && read->linger_us != 0) {
        const fathom_status_t heard = port_listen(port, read->linger_us);
        if (heard != FATHOM_OK) read->status = heard;
    }
    listener_judge(&port->listener, read->address, &read->evidence);
    if (read->status == FATHOM_ERR_CANCELLED || read->status == FATHOM_ERR_PORT ||
        read->status == FATHOM_ERR_UNSUPPORTED)
        scan->status = read->status;
}

/* ---- which model it is ---- */

/* The function inquiry_t.ask. */
static bool ask(inquiry_t *inquiry, uint16_t first, uint8_t count, uint32_t timeout_us, uint8_t silence_tries)
{
    enum { DAMAGED_TRIES = 4 };
    scan_t *const scan = (scan_t *)inquiry;
    scan_read_t *const read = &scan->read;
    read->first = first;
    read->count = count;
    read->linger_us = 0;
    read->timeout_us = longer(read->timeout_us, timeout_us);
    for (uint8_t tries = DAMAGED_TRIES; tries != 0 && scan->status == FATHOM_OK; tries--) {
        scan_ask(scan);
        inquiry->status = read->status;
        if (read->status == FATHOM_OK || read->status == FATHOM_ERR_EXCEPTION)
            return read->status == FATHOM_OK;
        const bool is_damaged = read->status == FATHOM_ERR_CHECKSUM || read->status == FATHOM_ERR_MALFORMED;
        if (!is_of_line(read->status) && !is_damaged && --silence_tries == 0) break;
    }
    return false;
}

/* Returns the model that this device is, of those that share this first read. NULL: it responds like none of them, or like
 * several. */
static const model_t *tell_apart(inquiry_t *inquiry, uint16_t first)
{
    enum { ROUNDS = 3, SLOW_ROUND = 2 };
    const model_t *found = NULL;
    unsigned count = 0;
    for (unsigned round = 0; round != ROUNDS && count == 0; round++) {
        const uint32_t timeout_us = round == SLOW_ROUND ? INQUIRY_SLOW_US : INQUIRY_MEASURE_US;
        for (size_t i = model_count; i-- != 0;) {
            const model_t *const model = &models[i];
            const uint16_t own = round == SLOW_ROUND ? model->scan.slow_own : model->scan.own;
            if (model->scan.first != first || own == 0 || !ask(inquiry, own, 1, timeout_us, 1)) continue;
            inquiry->finding->value = inquiry->values[0];
            inquiry->finding->has_value = true;
            inquiry->own = own;
            found = model;
            count++;
        }
    }
    return count == 1 ? found : NULL;
}

/* Returns the model that is most likely at an address. Its first read finds the other models too: they respond to it with
 * a value, with an exception, or not at all. */
static const model_t *likely(const fathom_line_settings_t *line, uint8_t address)
{
    const model_t *const any = with_any(line);
    if (any != NULL) return any;
    for (size_t i = model_count; i-- != 0;)
        if (models[i].scan.count != 0 && model_has_rate(&models[i], line->baud) &&
            model_has_address(&models[i], address))
            return &models[i];
    return &models[0];
}

/*
 * Returns the model of the device that responded to its first read, by registers that only one model has:
 *
 *   HPS-167S  #1 has a date, #3 begins with the acknowledge byte B0, #2 has two switches and is the same before and
 *             after a measurement
 *   A05       0x0200 is its address, it responds to 0x0106 (probe 1) and not to 0x0101
 *   A16       0x0200 is its address, it responds to 0x0101 or 0x0100 (distance) and not to 0x0106
 *
 * A device that responds to all of these, or to none, is another Modbus device: NULL.
 */
static const model_t *find_model(scan_t *scan)
{
    const uint8_t address = scan->read.address;
    inquiry_t *const inquiry = &scan->inquiry;
    const model_t *model = likely(scan->line, address);
    if (model->scan.is_it != NULL) {
        if (model->scan.is_it(inquiry)) return model;
        model = &models[0];
        if (!ask(inquiry, model->scan.first, model->scan.count, INQUIRY_MEASURE_US, 1)) return NULL;
    }
    /* The models with a register of their own share a first read that returns the address. */
    if (inquiry->status != FATHOM_OK || inquiry->values[0] != address) return NULL;
    return tell_apart(inquiry, model->scan.first);
}

/* Reports a device that responded. */
static void report_found(scan_t *scan, scan_finding_t *finding)
{
    finding->kind = finding->model != NULL ? SCAN_SENSOR : SCAN_OTHER;
    if (finding->model == NULL) finding->has_value = false;
    if (finding->model == NULL && finding->perhaps == NULL) models_name_other(&scan->inquiry);
    if (scan->status != FATHOM_OK) return;
    scan->found_baud[finding->address] = scan->line->baud;
    if (finding->model == model_with(DECODE_DYP)) scan->has_dyp = true;
    scan->report(scan, finding);
}

/* Identifies and reports the device that responded. has_first: to the first read of a model, and not to a later one. */
static void identify(scan_t *scan, bool has_first)
{
    const uint8_t address = scan->read.address;
    scan_finding_t finding = {.line = *scan->line,
                              .address = address,
                              .mode = SCAN_MODBUS,
                              .is_certain = scan->any == address,
                              .is_double = scan->read.evidence.fitting >= 2};
    scan->inquiry = (inquiry_t){
        .ask = ask, .status = scan->read.status, .values = scan->read.values, .finding = &finding};
    if (has_first) finding.model = find_model(scan);
    if (finding.model != NULL && finding.model->scan.confirm != NULL &&
        !finding.model->scan.confirm(&scan->inquiry, finding.model))
        finding.model = NULL;
    report_found(scan, &finding);
    scan->inquiry.finding = NULL; /* it ends here */
}

/* ---- one address ---- */

/* The state of an address at the present settings. */
enum { NOT_ASKED = 0, SILENT, ANSWERED, LATE, GARBLED, DAMAGED, BUSY };

/* Stores the evidence of other units. */
static void note(scan_t *scan, const evidence_t *evidence)
{
    const uint8_t other = evidence->foreign_address;
    scan->heard.echoes += evidence->echoes;
    scan->heard.bytes += evidence->rest;
    scan->heard.masters += evidence->masters;
    if (evidence->masters != 0) scan->heard.masters_address = evidence->masters_address;
    if (evidence->foreign == 0) return;
    if (other < scan->settings->addresses.first || other > scan->settings->addresses.last)
        scan->outside = other;
    else if (scan->states[other] == SILENT)
        scan->states[other] = LATE;
}

/* How the requests to one address ended. */
typedef struct {
    uint8_t timeouts;
    uint8_t troubles; /* damaged responses, and bytes that are neither a frame nor an echo */
    uint8_t busy;     /* a busy line, or another master */
    bool has_checksum;
} attempts_t;

/* Counts a request without a whole response. Returns true if the scan sends the address another request. After addresses
 * with the same trouble, there are fewer of these. */
static bool count_failure(scan_t *scan, attempts_t *attempts)
{
    enum { DAMAGED_REPEATS = 3, FEW_GARBLED = 3, BUSY_REPEATS = 2, BUSY_LINE = 4 };
    const fathom_status_t status = scan->read.status;
    if (is_of_line(status)) {
        if (status == FATHOM_ERR_OTHER_MASTER) scan->has_other_master = true;
        return ++attempts->busy <= (scan->busy_in_row < BUSY_LINE ? BUSY_REPEATS : 1);
    }
    scan->busy_in_row = 0;
    if (status == FATHOM_ERR_CHECKSUM) attempts->has_checksum = true;
    if (status != FATHOM_ERR_CHECKSUM && scan->read.evidence.rest == 0)
        attempts->timeouts++;
    else
        attempts->troubles++;
    unsigned repeats = scan->sender.kind != 0 || scan->garbled >= FEW_GARBLED ? 1 : DAMAGED_REPEATS;
    if (attempts->troubles == 0) repeats = scan->settings->retries;
    return attempts->timeouts + attempts->troubles <= repeats;
}

/* Sends an address requests until its state is known, and identifies the device there. */
static void visit(scan_t *scan, uint8_t address, uint32_t timeout_us)
{
    enum { LINGER_US = 40000 }; /* a second unit with the address responds within a few milliseconds */
    const model_t *const model = likely(scan->line, address);
    uint8_t *const state = &scan->states[address];
    attempts_t attempts = {0};
    scan->read = (scan_read_t){.line = scan->line,
                               .timeout_us = timeout_us,
                               .linger_us = LINGER_US,
                               .first = model->scan.first,
                               .count = model->scan.count,
                               .address = address};
    scan->asked++;
    do {
        scan_ask(scan);
        if (scan->status != FATHOM_OK) return;
        note(scan, &scan->read.evidence);
        if (is_answered(scan->read.status)) {
            *state = ANSWERED;
            identify(scan, true);
            return;
        }
    } while (count_failure(scan, &attempts));
    *state = SILENT;
    if (is_of_line(scan->read.status)) {
        *state = BUSY;
        scan->busy_in_row++;
    } else if (attempts.troubles >= 2 && scan->sender.kind == 0) {
        /* A single damaged response may be noise, and those beside a sender may be its frames. */
        *state = attempts.has_checksum ? DAMAGED : GARBLED;
        if (*state == GARBLED) scan->garbled++;
    }
}

/* Returns true if a device was found at this address at the present rate; behind a converter, at its only settings. */
static bool is_found(const scan_t *scan, uint8_t address)
{
    const uint32_t found = scan->found_baud[address];
    return found != 0 && (!port_has_settings(scan->port.kind) || found == scan->line->baud);
}

/* Reads the register of false friends at an address that was silent at the first register of a model. */
static void visit_again(scan_t *scan, uint8_t address, uint32_t timeout_us)
{
    const uint16_t first = false_friends_at(scan->line);
    if (first == 0 || scan->states[address] != SILENT || is_found(scan, address)) return;
    scan->read = (scan_read_t){
        .line = scan->line, .timeout_us = timeout_us, .first = first, .count = 1, .address = address};
    scan_ask(scan);
    if (scan->status != FATHOM_OK) return;
    note(scan, &scan->read.evidence);
    if (!is_answered(scan->read.status)) return;
    scan->states[address] = ANSWERED;
    identify(scan, false);
}

/* ---- all addresses ---- */

static void report_damaged(scan_t *scan, uint8_t kind, uint8_t address)
{
    scan->report(
        scan, &(scan_finding_t){.line = *scan->line, .kind = kind, .mode = SCAN_MODBUS, .address = address});
}

/* Reports what follows from the states of all addresses. */
static void conclude(scan_t *scan)
{
    const bool is_other_protocol = 2 * scan->garbled > scan->asked;
    if (is_other_protocol) report_damaged(scan, SCAN_NOT_MODBUS, 0);
    for (unsigned address = 0; address != SCAN_ADDRESSES; address++) {
        const uint8_t state = scan->states[address];
        if (state == BUSY) scan->not_asked++;
        if (state == DAMAGED || (state == GARBLED && !is_other_protocol))
            report_damaged(scan, SCAN_DAMAGED, (uint8_t)address);
    }
}

/* A sensor with frames 55 AA responds to this request at any address. Several respond at once and damage each other's
 * responses. */
static void ask_any_dyp(scan_t *scan)
{
    const model_t *const model = model_with(DECODE_DYP);
    scan->read = (scan_read_t){.line = &model->line,
                               .timeout_us = ANY_TIMEOUT_US,
                               .first = FATHOM_DYP_FIRST_REGISTER,
                               .count = 1,
                               .address = FATHOM_LINE_ANY_UNIT,
                               .is_dyp = true};
    scan_ask(scan);
    if (is_of_line(scan->read.status)) scan->not_asked++;
    if (scan->read.status == FATHOM_OK)
        scan->report(scan, &(scan_finding_t){.line = model->line,
                                             .kind = SCAN_SENSOR,
                                             .model = model,
                                             .mode = SCAN_DYP,
                                             .address = scan->read.responder,
                                             .has_value = true,
                                             .value = scan->read.values[0],
                                             .is_certain = true});
}

/* A single unit responds to a read of its address at address 255 from its real address. Several units damage each other's
 * responses. */
static void ask_any(scan_t *scan, uint32_t timeout_us)
{
    const model_t *const model = with_any(scan->line);
    scan->any = -1;
    if (model == NULL) return;
    scan->read = (scan_read_t){.line = scan->line,
                               .timeout_us = timeout_us,
                               .first = model->scan.first,
                               .count = model->scan.count,
                               .address = FATHOM_LINE_ANY_UNIT};
    show_progress(scan);
    scan_ask(scan);
    scan->done_us += once_us(scan->line, timeout_us) + timeout_us;
    if (scan->read.status != FATHOM_OK) return;
    const uint16_t value = scan->read.values[0];
    const uint16_t from = scan->read.responder != FATHOM_LINE_ANY_UNIT ? scan->read.responder : value;
    if (from >= FATHOM_LINE_ANY_UNIT) return;
    if (value == scan->read.responder) scan->any = from;
    const scan_addresses_t *const plan = &scan->settings->addresses;
    if (scan->settings->has_addresses && (from < plan->first || from > plan->last))
        scan->outside = (uint8_t)from;
    else if (!is_found(scan, (uint8_t)from))
        visit(scan, (uint8_t)from, timeout_us);
}

/* Returns true if no further request follows. */
static bool has_ended(const scan_t *scan)
{
    return scan->status != FATHOM_OK || (scan->settings->is_one && scan->sensors != 0);
}

/* Asks all addresses at scan->line. */
static void walk_line(scan_t *scan)
{
    const scan_settings_t *const settings = scan->settings;
    const uint32_t timeout_us = timeout_of(settings, scan->line);
    const uint32_t again_us = false_friends_us(settings);
    const unsigned last = settings->addresses.last;
    memset(scan->states, NOT_ASKED, sizeof scan->states);
    scan->garbled = 0;
    scan->asked = 0;
    ask_any(scan, timeout_us);
    for (unsigned address = settings->addresses.first; address <= last && !has_ended(scan); address++) {
        scan->read.address = (uint8_t)address;
        show_progress(scan);
        if (!is_found(scan, (uint8_t)address)) visit(scan, (uint8_t)address, timeout_us);
        scan->done_us += address_us(settings, scan->line);
    }
    for (unsigned address = settings->addresses.first; address <= last && !has_ended(scan); address++) {
        scan->read.address = (uint8_t)address;
        show_progress(scan);
        visit_again(scan, (uint8_t)address, again_us);
        if (false_friends_at(scan->line) != 0) scan->done_us += once_us(scan->line, again_us);
    }
    for (unsigned address = 0; address <= last && !has_ended(scan); address++) {
        if (scan->states[address] != LATE) continue;
        visit(scan, (uint8_t)address, longer(timeout_us, LATE_TIMEOUT_US));
        if (!has_ended(scan)) visit_again(scan, (uint8_t)address, longer(timeout_us, LATE_TIMEOUT_US));
    }
    if (has_ended(scan)) return;
    conclude(scan);
    if (!scan->has_dyp && is_of(model_with(DECODE_DYP), scan->line)) ask_any_dyp(scan);
}

void scan_walk(scan_t *scan)
{
    const scan_settings_t *const settings = scan->settings;
    char line[LINE_TEXT];
    scan->done_us = settings->listen_us;
    for (uint8_t i = 0; i != settings->line_count && !has_ended(scan); i++) {
        const uint64_t began_us = scan->done_us;
        scan->line = &settings->lines[i];
        walk_line(scan);
        scan->done_us = began_us + line_us(settings, scan->line);
        if (scan->status != FATHOM_ERR_UNSUPPORTED) continue;
        scan->status = FATHOM_OK;
        scan->left_out[i] = true;
        scan->left_out_count++;
        progress_clear(&scan->progress);
        (void)fprintf(stderr, "fathom: this port does not have %s, so the scan leaves it out.\n",
                      line_text(scan->line, line));
    }
}
