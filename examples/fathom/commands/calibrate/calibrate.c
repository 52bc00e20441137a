/* SPDX-License-Identifier: MIT */
#include "commands/calibrate/calibrate.h"

#include <errno.h>
#include <stdlib.h>

#include "cli/command.h"
#include "cli/rows.h"
#include "commands/commands.h"
#include "device/session.h"

/* fathom calibrate finds the distance offset of an HPS-167S with a target at a known distance. */

enum {
    SAMPLES = 25,
    MOST_SAMPLES = 200,
    SPREAD_MM = 20,
    LEAST_TOLERANCE_MM = 2,
    /* The slowest sensor measures six times a second (table 1), so one sample may come from before the write. */
    AFTER_WRITE_US = 1000000,
    /* If a filter has a time constant of 2 s, two batches that differ by 1 mm leave an error of 0.4 mm. */
    REST_US = 2000000,
    MOST_BATCHES = 10,
    MOST_FAILURES_IN_ROW = 5
};

typedef struct {
    session_settings_t session;
    uint32_t known_mm;
    uint32_t samples;   /* of a batch */
    uint32_t spread_mm; /* the largest difference that the samples of a batch may have */
    bool is_dry;
} calibrate_settings_t;

/* Table 1 of the datasheet: the range is 80 mm to 18 m. */
static const option_t rows[] = {
    {"known", "MM", "Set the true distance of the target", KIND_NUMBER, GROUP_COMMAND, .min = 80,
     .max = 18000, AT(calibrate_settings_t, known_mm), .is_required = true},
    {"samples", "N", "Measure with N samples (default 25)", KIND_NUMBER, GROUP_COMMAND, .min = 5,
     .max = MOST_SAMPLES, AT(calibrate_settings_t, samples)},
    {"spread", "MM", "Accept samples that differ by at most MM (default 20)", KIND_NUMBER, GROUP_COMMAND,
     .max = 1000, AT(calibrate_settings_t, spread_mm)},
    {"dry-run", .help = "Measure, and print the offset without writing it", .group = GROUP_COMMAND,
     AT(calibrate_settings_t, is_dry)},
    {.name = NULL},
};

static const option_table_t tables[] = {{rows, 0}, SESSION_TABLES, {session_format_rows, 0}, {NULL, 0}};

static session_t session;

/* ---- what follows from the measurements ---- */

int calibrate_tolerance_mm(int spread_mm)
{
    const int half_mm = spread_mm / 2 + spread_mm % 2;
    return half_mm > LEAST_TOLERANCE_MM ? half_mm : LEAST_TOLERANCE_MM;
}

static int last_mm(const calibration_t *run) { return run->measured_mm[run->measurements - 1]; }

/* Returns true if the last measurement is within T of a distance. */
static bool is_near(const calibration_t *run, int mm)
{
    return abs(last_mm(run) - mm) <= calibrate_tolerance_mm(run->spread_mm);
}

static calibrate_next_t propose(calibration_t *run, int offset_mm)
{
    run->offset_mm = offset_mm;
    return offset_mm < INT16_MIN || offset_mm > INT16_MAX ? CALIBRATE_TOO_LARGE : CALIBRATE_WRITE;
}

static calibrate_next_t judge_write(calibration_t *run)
{
    const bool is_right = is_near(run, run->known_mm);
    const bool is_unmoved = is_near(run, run->measured_mm[run->measurements - 2]);
    const bool is_second = run->writes == CALIBRATE_WRITES;
    const bool is_acknowledged = run->is_certain;
    if (is_unmoved && !(is_right && is_second && is_acknowledged)) {
        run->is_certain = false;
        if (is_right) return CALIBRATE_UNCLEAR;
        return is_acknowledged ? CALIBRATE_NOT_MOVED : CALIBRATE_NOT_SEEN;
    }
    if (is_second && !is_right) {
        run->replaces = false; /* something else moved the first measurement */
        return CALIBRATE_UNEXPECTED;
    }
    run->is_certain = true;
    if (is_right) return CALIBRATE_RIGHT;
    run->replaces = true;
    return propose(run, run->written_mm[0] + run->known_mm - last_mm(run));
}

calibrate_next_t calibrate_measured(calibration_t *run, int median_mm, int spread_mm)
{
    if (spread_mm > run->spread_mm) run->spread_mm = spread_mm;
    run->measured_mm[run->measurements++] = median_mm;
    if (run->writes != 0) return judge_write(run);
    return is_near(run, run->known_mm) ? CALIBRATE_RIGHT : propose(run, run->known_mm - median_mm);
}

void calibrate_wrote(calibration_t *run, bool is_acknowledged)
{
    run->written_mm[run->writes++] = run->offset_mm;
    run->is_certain = is_acknowledged;
}

/* Adds the possible offsets of a sensor that has accepted the first `writes` writes. */
static size_t add_offsets(const calibration_t *run, size_t writes, calibrate_offset_t *offsets)
{
    calibrate_offset_t *end = offsets;
    int sum_mm = 0;
    for (size_t i = 0; i != writes; i++) sum_mm += run->written_mm[i];
    if (writes != 0) *end++ = (calibrate_offset_t){run->written_mm[writes - 1], false};
    if (!run->replaces || writes == 0) *end++ = (calibrate_offset_t){sum_mm, true};
    return (size_t)(end - offsets);
}

size_t calibrate_offsets(const calibration_t *run, calibrate_offset_t offsets[CALIBRATE_OFFSETS])
{
    const size_t count = add_offsets(run, run->writes, offsets);
    if (run->writes == 0 || run->is_certain) return count;
    return count + add_offsets(run, run->writes - 1, &offsets[count]);
}

/* ---- measuring ---- */

typedef struct {
    bool is_usable;
    int median_mm;
    int spread_mm;
} batch_t;

/* Reads a sample and repeats a failed read. Returns false after printing why there is none. */
static bool read_sample(fathom_sample_t *sample)
{
    fathom_status_t status = FATHOM_PENDING;
    for (unsigned i = 0; i != MOST_FAILURES_IN_ROW; i++) {
        status = session_measure(&session, sample);
        if (status == FATHOM_OK) return true;
        if (status == FATHOM_ERR_CANCELLED || status == FATHOM_ERR_PORT) break;
    }
    return session_fail(&session, status, "cannot measure");
}

static int compare(const void *one, const void *other) { return *(const int *)one - *(const int *)other; }

/* Returns why a sample is no distance; NULL: it is one. */
static const char *fault_of(const fathom_sample_t *sample)
{
    if (sample->kind == FATHOM_TARGET) return NULL;
    if (sample->kind == FATHOM_NO_TARGET)
        return "no target in range. Aim the sensor at a flat, light target at a right angle";
    if (sample->kind == FATHOM_FAULT)
        return "the sensor reports a fault. Wait until it has warmed up, or power-cycle it";
    return "the distance is below the range, 80 mm. Place the target farther away";
}

enum { WHY = 200 };

/* Reads a batch. If it is not usable, `why` is the reason. Returns false after printing why a sample cannot be read. */
static bool read_batch(const calibrate_settings_t *settings, batch_t *batch, char why[WHY])
{
    int distances[MOST_SAMPLES] = {0};
    const size_t count = settings->samples;
    batch->is_usable = false;
    for (size_t i = 0; i != count; i++) {
        fathom_sample_t sample;
        if (!read_sample(&sample)) return false;
        distances[i] = sample.distance_mm;
        const char *const fault = fault_of(&sample);
        if (fault == NULL) continue;
        (void)snprintf(why, WHY, "%s", fault);
        return true;
    }
    qsort(distances, count, sizeof distances[0], compare);
    batch->median_mm = distances[count / 2];
    batch->spread_mm = distances[count - 1] - distances[0];
    batch->is_usable = batch->spread_mm <= (int)settings->spread_mm;
    if (!batch->is_usable)
        (void)snprintf(why, WHY,
                       "the samples differ by %d mm, more than --spread %d. Hold the sensor and the target "
                       "still, use a flat, light target at a right angle, or raise --spread",
                       batch->spread_mm, (int)settings->spread_mm);
    return true;
}

/*
 * Measures until the medians of two consecutive batches, 2 s apart, differ by at most half their tolerance: a sensor
 * with a filter settles slowly. A batch with a sample that is no distance, or with a larger spread, is discarded.
 * Returns false after printing why there are no two such batches.
 */
static bool measure(const calibration_t *run, const calibrate_settings_t *settings, batch_t *result)
{
    const host_t *const host = session.port.host;
    char why[WHY] = "";
    batch_t last = {.is_usable = false};
    uint32_t rest_us = run->writes != 0 ? AFTER_WRITE_US : 0;
    session_begin_task(&session, "measuring");
    for (unsigned i = 0; i != MOST_BATCHES; i++, rest_us = REST_US) {
        const uint64_t end_us = host->now_us(host->ctx) + rest_us;
        fathom_sample_t discarded;
        batch_t batch;
        while (host->now_us(host->ctx) < end_us)
            if (!read_sample(&discarded)) return false;
        if (!read_batch(settings, &batch, why)) return false;
        if (batch.is_usable && last.is_usable) {
            *result = batch;
            if (last.spread_mm > batch.spread_mm) result->spread_mm = last.spread_mm;
            if (abs(last.median_mm - batch.median_mm) <= calibrate_tolerance_mm(result->spread_mm) / 2) {
                session_end_task(&session);
                return true;
            }
            (void)snprintf(why, WHY, "the median does not settle. Hold the sensor and the target still");
        }
        last = batch;
    }
    return session_fail(&session, FATHOM_OK, "cannot measure: %s", why);
}

/* ---- writing ---- */

/* Announces the write: with JSON on stderr. Returns false if the output failed. */
static bool announce(const calibration_t *run)
{
    FILE *const to = session.is_json ? stderr : stdout;
    errno = 0;
    (void)fprintf(to, "%s%s: writing offset %d mm to flash (write %zu of at most %d)\n",
                  session.is_json ? "fathom: " : "", session.sensor->name, run->offset_mm, run->writes + 1,
                  CALIBRATE_WRITES);
    return session.is_json ? fflush(to) == 0 : output_flush() == 0;
}

/* Returns false if the sensor has certainly not accepted the offset, after printing why. */
static bool write_offset(calibration_t *run)
{
    const setting_t *const setting =
        setting_of(session.sensor->model->settings, session.sensor->model->offset);
    if (!announce(run)) return false;
    const fathom_status_t status = session_set(&session, setting, run->offset_mm);
    const reader_facts_t facts = reader_facts(session.sensor->reader);
    /* The sensor itself refused the write (1 to 3). Any other exception leaves the result open: the sensor failed (4), or a
     * gateway lost the request or the response (10, 11). */
    const bool is_refused =
        status == FATHOM_ERR_EXCEPTION && facts.exception <= FATHOM_MODBUS_ILLEGAL_DATA_VALUE;
    if (status == FATHOM_OK || (facts.is_written && !is_refused)) {
        calibrate_wrote(run, status == FATHOM_OK);
        return true;
    }
    return session_fail(&session, status, "offset %d mm was not written", run->offset_mm);
}

/* Prints a measurement, unless the output is JSON. Returns false if the output failed. */
static bool print_measurement(const calibration_t *run, const batch_t *batch, size_t samples)
{
    const int off_mm = batch->median_mm - run->known_mm;
    if (session.is_json) return true;
    errno = 0;
    (void)printf("%s: measured %d mm (median of %zu, spread %d mm), known %d mm", session.sensor->name,
                 batch->median_mm, samples, batch->spread_mm, run->known_mm);
    if (off_mm != 0) (void)printf(": %d mm too %s", abs(off_mm), off_mm < 0 ? "near" : "far");
    (void)fputs("\n", stdout);
    return output_flush() == 0;
}

static calibrate_next_t calibrate(calibration_t *run, const calibrate_settings_t *settings)
{
    for (;;) {
        batch_t batch = {.is_usable = false};
        if (!measure(run, settings, &batch) || !print_measurement(run, &batch, settings->samples))
            return CALIBRATE_NOT_MEASURED;
        const calibrate_next_t next = calibrate_measured(run, batch.median_mm, batch.spread_mm);
        if (next != CALIBRATE_WRITE || settings->is_dry) return next;
        if (!write_offset(run)) return CALIBRATE_REFUSED;
    }
}

/* ---- the result ---- */

static void print_offsets(FILE *to, const calibration_t *run)
{
    calibrate_offset_t offsets[CALIBRATE_OFFSETS];
    const size_t count = calibrate_offsets(run, offsets);
    for (size_t i = 0; i != count; i++) {
        const int mm = offsets[i].mm;
        (void)fputs(i == 0 ? "" : i == count - 1 ? " or " : ", ", to);
        if (!offsets[i].is_added)
            (void)fprintf(to, "%d mm", mm);
        else if (mm == 0)
            (void)fputs("the old offset", to);
        else
            (void)fprintf(to, "the old offset %s %d mm", mm < 0 ? "minus" : "plus", abs(mm));
    }
}

static void print_right(const calibration_t *run)
{
    (void)printf("%s: right within %d mm: measured %d mm, known %d mm; ", session.sensor->name,
                 calibrate_tolerance_mm(run->spread_mm), last_mm(run), run->known_mm);
    if (run->writes == 0) {
        (void)puts("nothing was written");
        return;
    }
    (void)fputs("offset: ", stdout);
    print_offsets(stdout, run);
    (void)printf("; flash writes: %zu%s\n", run->writes,
                 run->replaces ? "; #12 replaces the old offset" : "");
}

/* Prints why the calibration ended, unless that was printed when it occurred. */
static void print_why(const calibration_t *run, calibrate_next_t why)
{
    const int offset_mm = run->writes != 0 ? run->written_mm[run->writes - 1] : 0;
    if (why == CALIBRATE_NOT_MOVED)
        (void)session_fail(&session, FATHOM_OK,
                           "offset %d mm was acknowledged, but the sensor still measures %d mm. The offset "
                           "takes effect at the next power-on, or the sensor had this offset already, or it "
                           "did not accept it",
                           offset_mm, last_mm(run));
    else if (why == CALIBRATE_NOT_SEEN)
        (void)session_fail(&session, FATHOM_OK,
                           "offset %d mm was not acknowledged, and the sensor still measures %d mm",
                           offset_mm, last_mm(run));
    else if (why == CALIBRATE_UNCLEAR)
        (void)session_fail(&session, FATHOM_OK,
                           "the distance before offset %d mm and the known distance are within %d mm of each "
                           "other, so %d mm does not show whether the sensor accepted the offset",
                           offset_mm, calibrate_tolerance_mm(run->spread_mm), last_mm(run));
    else if (why == CALIBRATE_UNEXPECTED)
        (void)session_fail(
            &session, FATHOM_OK,
            "%d mm after offset %d mm is not possible unless the sensor or the target has moved",
            last_mm(run), offset_mm);
    else if (why == CALIBRATE_TOO_LARGE)
        (void)session_fail(&session, FATHOM_OK,
                           "the required offset does not fit into #12, -32768 to 32767 mm");
}

/* If the first write takes effect only at the next power-on: a sensor that adds is right then. A sensor that replaces
 * lacks its old offset then, and another calibration would only restore the old state. */
static void print_advice(const calibration_t *run, calibrate_next_t why)
{
    if (run->replaces) {
        (void)fputs("fathom: #12 replaces the old offset, so you can calibrate again.\n", stderr);
        return;
    }
    (void)fputs("fathom: before you calibrate again, switch the power off and on, and measure.\n", stderr);
    if (why == CALIBRATE_NOT_MOVED || why == CALIBRATE_NOT_SEEN)
        (void)fprintf(stderr,
                      "fathom: if the sensor then measures as before, set distance-offset to 0, switch the "
                      "power off and on, and calibrate again.\n"
                      "fathom: if it measures another wrong distance X, #12 replaces the old offset, and the "
                      "right offset is %d - X.\n",
                      run->written_mm[0] + run->known_mm);
}

static void print_failure(const calibration_t *run, calibrate_next_t why)
{
    print_why(run, why);
    if (run->writes == 0) {
        (void)session_fail(&session, FATHOM_OK, "nothing was written.");
        return;
    }
    (void)fprintf(stderr, "fathom: %s: flash writes: %zu; the offset is now, or from the next power-on: ",
                  session.sensor->name, run->writes);
    print_offsets(stderr, run);
    (void)fputs("\n", stderr);
    print_advice(run, why);
}

static void print_list(json_t *json, const char *key, const int *values, size_t count)
{
    json_begin(json, key, '[');
    for (size_t i = 0; i != count; i++) json_value(json, NULL, "%d", values[i]);
    json_end(json, ']');
}

static void print_json(const calibration_t *run, calibrate_next_t end)
{
    static const char *const words[] = {
        [CALIBRATE_WRITE] = "dry_run",
        [CALIBRATE_RIGHT] = "right",
        [CALIBRATE_REFUSED] = "not_written",
        [CALIBRATE_NOT_MEASURED] = "not_measured",
        [CALIBRATE_NOT_MOVED] = "without_effect",
        [CALIBRATE_NOT_SEEN] = "not_acknowledged",
        [CALIBRATE_UNCLEAR] = "ambiguous",
        [CALIBRATE_UNEXPECTED] = "impossible_distance",
        [CALIBRATE_TOO_LARGE] = "offset_too_large",
    };
    calibrate_offset_t offsets[CALIBRATE_OFFSETS];
    const size_t count = calibrate_offsets(run, offsets);
    json_t json = {.to = stdout};
    json_begin(&json, NULL, '{');
    sensor_json(&json, session.sensor);
    json_value(&json, "address", "%u", session.sensor->address);
    json_string(&json, "status", words[end]);
    json_value(&json, "known_mm", "%d", run->known_mm);
    print_list(&json, "measured_mm", run->measured_mm, run->measurements);
    json_value(&json, "spread_mm", "%d", run->spread_mm);
    json_value(&json, "tolerance_mm", "%d", calibrate_tolerance_mm(run->spread_mm));
    print_list(&json, "written_mm", run->written_mm, run->writes);
    if (end == CALIBRATE_WRITE) json_value(&json, "would_write_mm", "%d", run->offset_mm);
    json_begin(&json, "offsets", '[');
    for (size_t i = 0; i != count; i++) {
        json_begin(&json, NULL, '{');
        json_value(&json, "offset_mm", "%d", offsets[i].mm);
        json_flag(&json, "is_added", offsets[i].is_added);
        json_end(&json, '}');
    }
    json_end(&json, ']');
    json_end(&json, '}');
    (void)fputc('\n', stdout);
}

/* Prints the result. Returns the exit status. */
static int report(const calibration_t *run, calibrate_next_t end)
{
    errno = 0;
    if (session.is_json)
        print_json(run, end);
    else if (end == CALIBRATE_WRITE)
        (void)printf("%s: nothing was written; without --dry-run, offset %d mm would be\n",
                     session.sensor->name, run->offset_mm);
    else if (end == CALIBRATE_RIGHT)
        print_right(run);
    if (end != CALIBRATE_WRITE && end != CALIBRATE_RIGHT) print_failure(run, end);
    if (output_flush() == 0) return end == CALIBRATE_RIGHT ? STATUS_OK : STATUS_FAILED;
    (void)fprintf(stderr, "fathom: cannot write the output; flash writes: %zu.\n", run->writes);
    return STATUS_FAILED;
}

static int start(const host_t *host, const arguments_t *arguments)
{
    calibrate_settings_t *const settings = arguments->settings;
    const origin_t origin = {.command = arguments->command->name};
    calibration_t run = {.known_mm = (int)settings->known_mm};
    if (!arguments_have(arguments, "samples")) settings->samples = SAMPLES;
    if (!arguments_have(arguments, "spread")) settings->spread_mm = SPREAD_MM;
    if (!session_read(&session, arguments, 1, 0)) return STATUS_USAGE;
    if (session.sensor->model->offset == NULL) {
        (void)reject(&origin, "%s has no distance offset. Only an hps167s has one.",
                     session.sensor->model->name);
        return STATUS_USAGE;
    }
    if (!session_open(&session, host)) return STATUS_FAILED;
    const int status = report(&run, calibrate(&run, settings));
    session_close(&session);
    return status;
}

const command_t calibrate_command = {
    .name = "calibrate",
    .summary = "Find the distance offset of an hps167s by measuring",
    .usage = "hps167s[:ADDRESS][@PORT] --known MM [OPTIONS]",
    .about = "Use a flat, light target at a right angle, and let nothing move. The distance is\n"
             "measured before and after each write. It is right within half the spread, and\n"
             "at least 2 mm. Flash is written at most twice. If an offset was written since\n"
             "the last power-on, switch the power off and on first.\n",
    .tables = tables,
    .common = "port known samples spread dry-run",
    .examples = "  fathom calibrate hps167s --port /dev/ttyUSB0 --known 2000 --dry-run\n"
                "  fathom calibrate hps167s:7 --port /dev/ttyUSB0 --known 2000 --samples 100\n",
    .status = "Exit status: 0 the sensor is right, 1 it is not (also with --dry-run) or that is\n"
              "unknown, 2 wrong usage.\n",
    .topics = "calibration, settings, ports",
    .operands = OPERANDS_RESETTABLE,
    .settings_size = sizeof(calibrate_settings_t),
    .start = start,
};
