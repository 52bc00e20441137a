/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "sensors/hps167s/hps167s.h"

/* What a scan asks of an HPS-167S, and tells of it: #1, #2 and #3. */

/* Registers of #2 and of #5, whose responses have one shape. */
enum { FOUR = FATHOM_HPS167S_CONFIGURATION_COUNT };

enum { NEXT_CENTURY = 2100 };

/* True: the values are in four, too. */
static bool ask_four(inquiry_t *inquiry, uint16_t first, uint16_t four[FOUR])
{
    if (!inquiry->ask(inquiry, first, FOUR, INQUIRY_MEASURE_US, 2)) return false;
    memcpy(four, inquiry->values, FOUR * sizeof *four);
    return true;
}

/* The response of #2 has the shape of a measurement (#5), which may come unasked: so two have to agree, and to differ
 * from a measurement between them. */
static bool ask_configuration(inquiry_t *inquiry)
{
    uint16_t configuration[FOUR];
    uint16_t again[FOUR];
    uint16_t measured[FOUR];
    if (!ask_four(inquiry, FATHOM_HPS167S_CONFIGURATION, configuration) ||
        !ask_four(inquiry, FATHOM_HPS167S_MEASUREMENT, measured) ||
        !ask_four(inquiry, FATHOM_HPS167S_CONFIGURATION, again) ||
        memcmp(configuration, again, sizeof configuration) != 0 ||
        memcmp(configuration, measured, sizeof configuration) == 0 ||
        !fathom_hps167s_may_be_configuration(configuration))
        return false;
    fathom_hps167s_configuration_t is;
    fathom_hps167s_decode_configuration(configuration, false, &is);
    inquiry->finding->has_termination = is.termination;
    return true;
}

bool hps167s_identify(inquiry_t *inquiry)
{
    scan_finding_t *const finding = inquiry->finding;
    fathom_hps167s_version_t *const version = &finding->interface;
    if (inquiry->status == FATHOM_ERR_MALFORMED)
        (void)inquiry->ask(inquiry, FATHOM_HPS167S_VERSION, FATHOM_HPS167S_VERSION_COUNT, INQUIRY_MEASURE_US,
                           2);
    if (inquiry->status != FATHOM_OK) return false;
    fathom_hps167s_decode_version(inquiry->values, version);
    finding->has_interface =
        version->year < NEXT_CENTURY && fathom_hps167s_is_date(version->month, version->day);
    if (inquiry->ask(inquiry, FATHOM_HPS167S_DETAILS, FATHOM_HPS167S_DETAILS_COUNT, INQUIRY_MEASURE_US, 2)) {
        fathom_hps167s_decode_details(inquiry->values, &finding->details);
        finding->has_details = fathom_hps167s_may_be_details(inquiry->values);
    }
    finding->has_config = ask_configuration(inquiry);
    return finding->has_interface && (finding->has_details || finding->has_config);
}

/* What #1 and #3 tell of a part of the device. */
typedef struct {
    uint16_t year;
    uint8_t month;
    uint8_t day;
    char version[16];
} part_t;

static part_t part_of_interface(const fathom_hps167s_version_t *is)
{
    part_t part = {.year = is->year, .month = is->month, .day = is->day};
    (void)snprintf(part.version, sizeof part.version, "%u.%u.%u", is->major, is->minor, is->revision);
    return part;
}

static part_t part_of_sensor(const fathom_hps167s_details_t *is)
{
    part_t part = {.year = is->year, .month = is->month, .day = is->day};
    (void)snprintf(part.version, sizeof part.version, "%u.%u", is->major, is->minor);
    return part;
}

static void print_part(FILE *to, const char *gap, const char *what, part_t part)
{
    (void)fprintf(to, "%s%s %s of %u-%02u-%02u", gap, what, part.version, part.year, part.month, part.day);
}

void hps167s_print_finding(FILE *to, const model_t *model, const scan_finding_t *finding)
{
    (void)model;
    if (finding->has_interface) print_part(to, "", "interface", part_of_interface(&finding->interface));
    if (finding->has_details)
        print_part(to, finding->has_interface ? ", " : "", "sensor", part_of_sensor(&finding->details));
    if (finding->has_config) (void)fprintf(to, ", termination %s", finding->has_termination ? "on" : "off");
    if (!finding->has_interface && !finding->has_details && !finding->has_config)
        (void)fputs("sends responses unasked", to);
}

static void print_part_json(FILE *to, const char *name, part_t part)
{
    (void)fprintf(to, ",\"%s_version\":\"%s\",\"%s_date\":\"%u-%02u-%02u\"", name, part.version, name,
                  part.year, part.month, part.day);
}

void hps167s_print_finding_json(FILE *to, const scan_finding_t *finding)
{
    if (finding->has_interface) print_part_json(to, "interface", part_of_interface(&finding->interface));
    if (finding->has_details) {
        print_part_json(to, "sensor", part_of_sensor(&finding->details));
        (void)fputs(",\"uuid\":\"", to);
        for (size_t i = 0; i != sizeof finding->details.uuid; i++)
            (void)fprintf(to, "%02x", finding->details.uuid[i]);
        (void)fputs("\"", to);
    }
    if (finding->has_config)
        (void)fprintf(to, ",\"termination\":%s", finding->has_termination ? "true" : "false");
}
