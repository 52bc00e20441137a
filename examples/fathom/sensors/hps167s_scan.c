/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "sensors/hps167s.h"

/* What a scan reads from an HPS-167S and reports: #1, #2 and #3. */

/* Registers of #2 and of #5, whose responses have one shape. */
enum { FOUR = FATHOM_HPS167S_CONFIGURATION_COUNT };

enum { NEXT_CENTURY = 2100 };

/* Reads four registers into `four`. Returns false if it cannot. */
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

void hps167s_interface_text(char *text, size_t capacity, const fathom_hps167s_version_t *version)
{
    (void)snprintf(text, capacity, "%u.%u.%u of %04u-%02u-%02u", version->major, version->minor,
                   version->revision, version->year, version->month, version->day);
}

void hps167s_sensor_text(char *text, size_t capacity, const fathom_hps167s_details_t *details)
{
    (void)snprintf(text, capacity, "%u.%u of %04u-%02u-%02u", details->major, details->minor, details->year,
                   details->month, details->day);
}

void hps167s_uuid_text(char *text, size_t capacity, const fathom_hps167s_details_t *details)
{
    for (size_t i = 0; i != FATHOM_HPS167S_UUID_LENGTH; i++)
        (void)snprintf(text + 2 * i, capacity - 2 * i, "%02x", details->uuid[i]);
}

void hps167s_describe(const model_t *model, const scan_finding_t *finding, finding_facts_t *facts)
{
    (void)model;
    if (finding->has_interface)
        hps167s_interface_text(facts->interface_version, sizeof facts->interface_version,
                               &finding->interface);
    if (finding->has_details) {
        hps167s_sensor_text(facts->sensor_version, sizeof facts->sensor_version, &finding->details);
        hps167s_uuid_text(facts->uuid, sizeof facts->uuid, &finding->details);
    }
    if (finding->has_config) facts->termination = finding->has_termination;
}
