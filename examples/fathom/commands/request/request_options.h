/* SPDX-License-Identifier: MIT */
#ifndef REQUEST_OPTIONS_H
#define REQUEST_OPTIONS_H

#include "cli/command.h"
#include "sensors/models.h"

/* Where it stands in a request. */
enum { REQUEST_UNIT = 0, REQUEST_FUNCTION = 1, REQUEST_FIRST = 2, REQUEST_COUNT = 4, REQUEST_VALUE = 4 };

enum { REQUEST_READ = 3, REQUEST_READ_INPUT = 4, REQUEST_WRITE = 6, REQUEST_WRITE_MANY = 16 };

/* What is to be sent, and how. */
typedef struct {
    const char *path;
    const model_t *model; /* NULL: not told */
    fathom_line_settings_t line;
    uint32_t timeout_us;
    uint8_t echo; /* fathom_line_parts_t.echo */
    bool rs485;   /* the kernel's driver is to drive the transceiver */
    bool is_json;
    bool is_confirmed;  /* --yes */
    uint8_t frame[255]; /* with its CRC */
    uint8_t length;
} request_t;

/* Reads the words and the options. False after rejecting what is wrong. */
bool request_options(request_t *request, const arguments_t *arguments);

/* command_t.start */
int request_start(const host_t *host, const arguments_t *arguments);

/* The register or the number that stands there in the request. */
uint16_t request_word(const request_t *request, size_t at);

/* Functions 01 to 04, which change nothing by the standard. */
bool request_is_read(const request_t *request);

/* One that no unit answers. (A read of unit 0 may be answered: A16 and A05 can have that address.) */
bool request_is_broadcast(const request_t *request);

#endif
