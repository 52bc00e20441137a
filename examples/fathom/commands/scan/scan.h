/* SPDX-License-Identifier: MIT */
#ifndef SCAN_H
#define SCAN_H

#include "cli/command.h"
#include "output/progress.h"
#include "ports/port.h"
#include "sensors/models.h"

/* ---- what to ask ---- */

enum { SCAN_RATES = 6, SCAN_PARITIES = 3, SCAN_SETTINGS = SCAN_RATES * SCAN_PARITIES };

/* Rates, each once, in the order in which they are tried. */
typedef struct {
    uint8_t count;
    uint32_t baud[SCAN_RATES];
} scan_rates_t;

typedef struct {
    uint8_t first;
    uint8_t last;
} scan_addresses_t;

/* The options. */
typedef struct {
    const char *port; /* NULL: none */
    scan_addresses_t addresses;
    bool has_addresses;
    scan_rates_t rates; /* count 0: those of the factory */
    uint8_t parities;   /* bits 1 << FATHOM_PARITY_...; 0: those of the factory */
    uint8_t stop_bits;  /* 0: 1 */
    uint32_t timeout_us;
    uint8_t retries;
    uint32_t listen_us; /* 0: the default */
    bool wake;
    bool estimate;
    bool is_json;
} scan_settings_t;

extern const option_table_t scan_tables[];

/* The order is: each line setting in turn, and each address at it. */
typedef struct {
    fathom_line_settings_t settings[SCAN_SETTINGS];
    uint32_t timeout_us; /* of every probe; 0: the defaults below */
    uint32_t listen_us;  /* before the first request */
    uint8_t setting_count;
    scan_addresses_t addresses;
    uint8_t repeats; /* of a request to a silent address */
} scan_plan_t;

void scan_make_plan(scan_plan_t *plan, const scan_settings_t *settings);

/* Adds a rate that is not there yet. */
void scan_add_rate(scan_rates_t *rates, uint32_t baud);

/* Returns the factory settings of the sensors that send automatically. */
const fathom_line_settings_t *scan_listen_line(void);

/* Returns true if these are the factory settings of a sensor with frames 55 AA. */
bool scan_has_dyp(const fathom_line_settings_t *line);

/*
 * Returns the time-out of an address: that of the plan, the longest of the models that have these factory settings
 * (model_t.scan), or the default. An HPS-167S needs 2.5 to 20 ms, and a USB adapter may delay bytes by 16 ms. A later
 * response is heard while the next address is asked, and its sender is asked again.
 */
enum { SCAN_TIMEOUT_US = 100000 };
uint32_t scan_timeout_us(const scan_plan_t *plan, const fathom_line_settings_t *line);

/* The silence before a request, of the slowest line of the plan, since a slower unit has to recognise it too. */
uint16_t scan_silence_us(const scan_plan_t *plan);

/* Time for one silent address, and for the whole plan if no unit responds. A device that responds adds at most
 * SCAN_FOUND_US. */
enum { SCAN_FOUND_US = 1500000 };
uint32_t scan_probe_us(const scan_plan_t *plan, const fathom_line_settings_t *line);
uint64_t scan_plan_us(const scan_plan_t *plan);

uint32_t scan_address_count(const scan_plan_t *plan);

/* Time for the request to any A05 by 55 AA on the line of A16 and A05. It waits until no unit may respond late, and
 * after it any unit may, so it takes three time-outs. */
enum { SCAN_ANY_TIMEOUT_US = 300000 };
uint32_t scan_any_us(const scan_plan_t *plan);

/* ---- the scan ---- */

enum { SCAN_ADDRESSES = 256 };

/* What the scan heard beside the responses to its requests. */
typedef struct {
    uint32_t bytes;         /* that belong to no frame and no echo */
    uint32_t echoes;        /* of the scan's own requests */
    uint8_t outside;        /* an address beyond the plan that sent a frame; 0: none */
    bool has_master;        /* requests of another master were heard */
    uint8_t master_address; /* with `has_master`: the address that it asked */
    /* Addresses, counted at each line setting, that the scan could not ask: the line was busy, or another master asked
     * the same address at the same time. */
    uint32_t not_asked;
    bool has_other_master; /* another master asked one of these addresses */
} scan_heard_t;

typedef struct {
    const scan_settings_t *settings;
    scan_plan_t plan;
    port_t port;
    progress_t progress;
    uint64_t start_us;
    uint64_t done_us; /* part of scan_plan_us() that is done */
    int output_error; /* errno */

    bool has_sender;       /* a device sends automatically: unsolicited bytes do not prove another device */
    scan_finding_t sender; /* with `has_sender` */
    scan_heard_t heard;
    uint32_t sensors;                    /* found */
    uint32_t terminations;               /* sensors whose termination resistor is on */
    const model_t *terminated;           /* model of these sensors */
    uint32_t awakened;                   /* sensors of the model that sent automatically */
    bool has_dyp;                        /* a sensor that can have frames 55 AA was found */
    uint32_t found_baud[SCAN_ADDRESSES]; /* of the device that was found at an address; 0: none */

    const fathom_line_settings_t *line; /* that the scan asks at present; NULL: it listens */
    uint8_t address;                    /* that it asks at present */

    /* at these settings */
    uint8_t states[SCAN_ADDRESSES];
    uint16_t busy_in_row; /* addresses in a row that a busy line kept the scan from asking */
    uint16_t garbled;     /* addresses whose responses were garbled */
    uint16_t asked;       /* addresses */
} scan_t;

/* Each of these returns FATHOM_OK, FATHOM_ERR_CANCELLED if the user or the reader of the output ended the scan, or
 * FATHOM_ERR_PORT. */

/*
 * Listens and sends nothing, because even a read ends the automatic output of an A16 RS232 or an A05 UART.
 *
 * An A16 and an A05 send at 9600 8N1, so the scan listens there for plan.listen_us. Bytes that it does not understand
 * may have another rate, so it then listens for a second at each rate of an HPS-167S. Fewer bytes than two frames of an
 * A16 are noise.
 */
fathom_status_t scan_listen(scan_t *scan);

/*
 * Asks each address of the plan at each line setting of the plan, and identifies each device that responds.
 *
 *  - A late response arrives while the scan asks another address. The scan asks its sender again with a long time-out.
 *  - After bytes that are no frame, or a damaged frame, the scan asks again. If each response is damaged, the address is
 *    SCAN_DAMAGED. If more than half of the addresses are, and no response was whole, the line is SCAN_NOT_MODBUS.
 *  - If a busy line or another master ends a request, the scan repeats it. If that goes on, the address is counted in
 *    heard.not_asked: nothing is known about it.
 *  - At an address where a device was found, other parities of the same rate are not tried.
 *  - On the line of A16 and A05, if no A05 was found, the scan asks any A05 by 55 AA. That finds an A05 with an address
 *    beyond the plan, if it is the only one.
 */
fathom_status_t scan_walk(scan_t *scan);

/* ---- one request ---- */

enum { SCAN_REGISTERS = 11 }; /* of the longest response: HPS-167S #3 */

/* A read, the only request of a scan. */
typedef struct {
    const fathom_line_settings_t *line;
    uint32_t timeout_us;
    uint32_t linger_us; /* time to listen for a second response after a response */
    uint16_t first;     /* register */
    uint8_t count;
    uint8_t address;
    bool is_dyp; /* by 55 AA; `first` and `count` as in dyp_client.h */
} scan_request_t;

typedef struct {
    /* As fathom_transaction_t.status. FATHOM_ERR_ARGUMENT: the scan may not send this request. */
    fathom_status_t status;
    uint8_t address; /* of FATHOM_OK: the unit that responded */
    uint16_t values[SCAN_REGISTERS];
    evidence_t evidence; /* heard since the request */
} scan_response_t;

/*
 * Sends a request and waits for its response.
 *
 * Invariant: no request of a scan changes a device. There is no write. This function refuses register 0x0009, the
 * factory reset of an HPS-167S (#6), with any count, and unit 0, the broadcast.
 */
void scan_ask(scan_t *scan, const scan_request_t *request, scan_response_t *response);

/* Returns true if a device responded, in whatever way. */
bool scan_is_answered(fathom_status_t status);

/* Returns true if the status ends the scan. */
bool scan_has_ended(fathom_status_t status);

/* Returns true if the line was busy or another master asked the same unit, which proves nothing about the unit. */
bool scan_is_of_line(fathom_status_t status);

/* Listens with these settings for `us`. FATHOM_ERR_UNSUPPORTED: the port does not have them. */
fathom_status_t scan_hear(scan_t *scan, const fathom_line_settings_t *line, uint32_t us);

/* Fills in the first request to an address: model_t.scan.first of the model that is most likely there. Devices of other
 * kinds respond to it with a value, with an exception, or not at all. */
void scan_first_request(const fathom_line_settings_t *line, uint8_t address, scan_request_t *request);

/*
 * Identifies the device that responded to the first request, by registers that only one model has:
 *
 *   HPS-167S  #1 has a date, #3 begins with the acknowledge byte B0, #2 has two switches and is the same before and
 *             after a measurement
 *   A05       0x0200 is its address, it responds to 0x0106 (probe 1) and not to 0x0101
 *   A16       0x0200 is its address, it responds to 0x0101 or 0x0100 (distance) and not to 0x0106
 *
 * A device that responds to all of these, or to none, is another Modbus device. The requests wait at least 300 ms, since
 * an ultrasonic sensor has to measure.
 */
fathom_status_t scan_identify(scan_t *scan, const scan_request_t *request, const scan_response_t *first,
                              scan_finding_t *finding);

/* ---- the output ---- */

/* Reports a finding. Called at once, except for what follows from all addresses of a line setting. */
void scan_report(scan_t *scan, const scan_finding_t *finding);

void scan_show_progress(scan_t *scan);

/* Returns the time of the clock. */
uint64_t scan_now_us(const scan_t *scan);

/* Prints the result of a scan that went to its end, and what to check, on stderr. */
void scan_print_result(const scan_t *scan);

/* Prints why the port failed. */
void scan_print_port_failure(const scan_t *scan);

#endif
