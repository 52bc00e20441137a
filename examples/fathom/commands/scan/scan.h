/* SPDX-License-Identifier: MIT */
#ifndef SCAN_H
#define SCAN_H

#include "cli/command.h"
#include "output/progress.h"
#include "ports/port.h"
#include "sensors/models.h"

enum { SCAN_RATES = 6, SCAN_PARITIES = 3, SCAN_LINES = SCAN_RATES * SCAN_PARITIES, SCAN_ADDRESSES = 256 };

typedef struct {
    uint8_t first;
    uint8_t last;
} scan_addresses_t;

/* The options, and the plan that follows from them: at each line setting, each address. */
typedef struct {
    const char *port; /* NULL: none */
    scan_addresses_t addresses;
    bool has_addresses;
    uint32_t rates[SCAN_RATES + 1]; /* each once, in the order in which they are tried; a 0 ends them */
    uint8_t parities;               /* bits 1 << FATHOM_PARITY_...; 0: those of the factory */
    uint8_t stop_bits;
    uint32_t timeout_us; /* 0: the defaults of scan_walk.c */
    uint32_t listen_us;  /* before the first request */
    uint8_t retries;     /* of a request to a silent address */
    bool wake;
    bool estimate;
    bool is_one; /* the first sensor ends the scan */
    bool is_json;
    bool is_default; /* the user chose neither the addresses nor the line settings */
    uint8_t line_count;
    fathom_line_settings_t lines[SCAN_LINES];
} scan_settings_t;

enum { SCAN_REGISTERS = 11 }; /* of the longest response: HPS-167S #3 */

/* A read, the only request of a scan, and its response. */
typedef struct {
    const fathom_line_settings_t *line;
    uint32_t timeout_us;
    uint32_t linger_us; /* time to listen for a second response after a response */
    uint16_t first;     /* register */
    uint8_t count;
    uint8_t address;
    bool is_dyp;            /* by 55 AA; `first` and `count` as in dyp_client.h */
    fathom_status_t status; /* FATHOM_ERR_ARGUMENT: the scan may not send this request */
    uint8_t responder;      /* of FATHOM_OK */
    uint16_t values[SCAN_REGISTERS];
    evidence_t evidence; /* received since the request */
} scan_read_t;

typedef struct scan scan_t;
struct scan {
    inquiry_t inquiry; /* Invariant: the first member, so that its function finds the scan. */
    /* Prints a finding at once. If that fails, no further request is sent. */
    void (*report)(scan_t *scan, const scan_finding_t *finding);
    const scan_settings_t *settings;
    port_t port;
    progress_t progress;
    uint64_t done_us;       /* part of scan_plan_us() that is done */
    fathom_status_t status; /* FATHOM_OK, or why no further request is sent */
    int output_error;       /* errno */

    /* What was found. */
    scan_finding_t
        sender; /* it sends without requests, so unsolicited bytes prove no other device; kind 0: none */
    uint32_t sensors;          /* found */
    uint32_t terminations;     /* sensors whose termination resistor is on */
    const model_t *terminated; /* model of these sensors */
    uint32_t awakened;         /* sensors of the sender's model */
    bool has_responses;        /* of a device that was reported and is no sensor, so the line works */
    bool has_dyp;              /* a sensor that can have frames 55 AA */
    int any; /* address of the unit that responded at address 255 with these settings; -1: none */
    uint32_t found_baud[SCAN_ADDRESSES]; /* of the device at an address; 0: none */
    evidence_t heard;                    /* echoes, masters, and `bytes` of neither a frame nor an echo */
    uint8_t outside;                     /* an address beyond the plan that sent a frame; 0: none */
    uint32_t
        not_asked; /* addresses, counted at each line setting: the line was busy, or another master asked them */
    bool left_out[SCAN_LINES]; /* line settings that the port does not have */
    uint8_t left_out_count;
    bool has_other_master; /* another master sent one of these a request */

    /* At the present line setting. NULL: the scan listens. */
    const fathom_line_settings_t *line;
    scan_read_t read;
    uint8_t states[SCAN_ADDRESSES];
    uint16_t busy_in_row; /* addresses in a row to which the scan could send no request */
    uint16_t garbled;     /* addresses whose responses were garbled */
    uint16_t asked;       /* addresses */
};

/* Returns the time of the whole plan if no unit responds. A device that responds adds at most 1.5 s. */
uint64_t scan_plan_us(const scan_settings_t *settings);

/* Listens, and sets scan->sender. Sends nothing, because even a read ends the automatic output of an A16 or A05. */
void scan_listen(scan_t *scan);

/*
 * Asks each address of the plan at each line setting of the plan, and identifies each device that responds. With
 * scan->settings->is_one, the first sensor ends the scan.
 *
 *  - At the line settings of A16 and A05 and their relatives, the scan first reads the address at address 255. A whole
 *    response is the address of one unit, which the scan identifies, unless it is not among those that the user named.
 *    Others may have been silent.
 *  - Other devices may be silent there, but respond where an A16 has its distance. So the scan then reads this register at
 *    each silent address. The device is SCAN_OTHER, with what it could be.
 *  - A late response arrives during the request to another address. The scan sends its sender another request, with a
 *    long time-out.
 *  - After bytes that are no frame, or a damaged frame, the scan repeats the request. If each response is damaged, the address is
 *    SCAN_DAMAGED. If more than half of the addresses are, and no response was whole, the line is SCAN_NOT_MODBUS.
 *  - If a busy line or another master ends a request, the scan repeats it. If the repetitions fail too, nothing is known about
 *    the address.
 *  - At an address where a device was found, other parities of the same rate are not tried.
 *  - On the line of A16 and A05, if no A05 was found, the scan sends a request 55 AA to any A05. It finds an A05 with an address
 *    beyond the plan, if it is the only one.
 */
void scan_walk(scan_t *scan);

/*
 * Sends scan->read and waits for its response. Sets scan->status if no further request can follow.
 *
 * Invariant: no request of a scan changes a device. There is no write. This function refuses register 0x0009, the
 * factory reset of an HPS-167S (#6), with any count, and unit 0, the broadcast.
 */
void scan_ask(scan_t *scan);

/* Returns the time of the clock. */
uint64_t scan_now_us(const scan_t *scan);

#endif
