/* SPDX-License-Identifier: MIT */
#include "diagnosis/advice.h"

#include <assert.h>
#include <inttypes.h>
#include <string.h>

/* ---- facts ---- */

static bool is_asked(const failure_t *failure)
{
    return mode_is_asked(failure->mode) && failure->port->kind != PORT_PINS;
}

static bool is_only_echo(const evidence_t *heard)
{
    return heard->echoes != 0 && heard->rest == 0 && heard->own == 0 && heard->foreign == 0 &&
           heard->masters == 0;
}

/* Returns true if automatic frames of another model were received, or of any model in a mode with requests. */
static bool is_stream(const failure_t *failure)
{
    const bool is_a05 = failure->evidence.streamed_a05 != 0;
    const bool is_a16 = failure->evidence.streamed_a16 != 0;
    if (is_asked(failure)) return is_a05 || is_a16;
    if (failure->mode->has_address) return false;
    return failure->model->probes > 1 ? is_a16 && !is_a05 : is_a05 && !is_a16;
}

/* Unsolicited frames leave little time for a request, and none if the adapter delays them. */
static bool is_crowded(const failure_t *failure)
{
    enum { LEAST = 3 };
    return port_has_bytes(failure->port->kind) && mode_is_asked(failure->mode) &&
           failure->model->may_send_unasked && failure->evidence.own >= LEAST;
}

/* Returns the fact of a failure with this name, a number; 0: it is not true. */
static uint64_t fact(const failure_t *failure, const char *name, size_t length)
{
    const reader_facts_t facts = reader_facts(failure->reader);
    const model_t *const model = failure->model;
    const model_mode_t *const mode = failure->mode;
    const port_t *const port = failure->port;
    const evidence_t *const heard = &failure->evidence;
    const counters_t *const counters = failure->counters;
    const uint64_t *const line = counters->attempt.line;
    const uint64_t *const stream = counters->attempt.stream;
    const bool has_pins = port->kind == PORT_PINS;
    const struct {
        const char *name;
        uint64_t value;
    } rows[] = {
        /* how the sensor is read: one of these */
        {"asked", is_asked(failure)},
        {"listened", !mode_is_asked(mode) && !mode->is_triggered && !has_pins}, /* it sends automatically */
        {"triggered", mode->is_triggered && !has_pins},                         /* by a break on TX */
        {"pins", has_pins},                                                     /* lines of a GPIO chip */
        {"relative", mode->row != NULL},        /* its modes are those of its name alone */
        {"forms", model_form(mode, 0) != NULL}, /* the table has other forms of it */
        /* what is known */
        {"tcp", port->kind == PORT_GATEWAY},
        {"converter", port->kind == PORT_RAW},
        {"tty", port->kind == PORT_SERIAL},
        {"network", port->connection != NULL},
        {"connecting", port_due_us(port) != FATHOM_NO_DEADLINE},
        {"lost", port->error == PORT_LOST},
        {"waits", failure->waits}, /* for the lost port */
        {"ends", !failure->waits},
        {"may-wait", !failure->waits && !failure->is_scan && !failure->is_setting && !failure->is_request},
        /* another program at the port */
        {"holder", failure->holder.program},
        {"hidden", failure->holder.is_hidden},
        {"console", failure->holder.is_console},
        {"changed", failure->holder.is_changed},
        {"hung-up", failure->holder.is_hung_up},
        {"taken", failure->holder.is_hung_up || failure->holder.is_changed}, /* a lost port that is there */
        {"pulses", mode->has_pulses},
        {"noises", failure->noises}, /* pulses that are too short */
        /* the sensor has responded in this run, so its settings are right */
        {"worked", counters->readings + counters->total.unit[UNIT_RESPONSES]},
        {"unproven",
         counters->readings + counters->total.unit[UNIT_RESPONSES] == 0 && !failure->others_answer},
        {"addressed", mode->has_address},
        {"address", failure->address},
        {"others", failure->others_answer}, /* on this line */
        {"request", failure->is_request},
        {"not-request", !failure->is_request},
        {"setting", failure->is_setting},
        {"scan", failure->is_scan},
        {"not-scan", !failure->is_scan},
        {"reads", !failure->is_scan && !failure->is_setting && !failure->is_request},
        {"damaged", counters->failures[-FATHOM_ERR_CHECKSUM]}, /* attempts */
        {"share", failure->damaged},
        {"attempts", counters->attempts + 1},
        /* what was received */
        {"silence", heard->bytes == 0},
        {"bytes", heard->bytes},
        {"zeros", heard->is_zeros && !is_asked(failure)}, /* bytes 00 and no others */
        {"automatic", facts.is_automatic},                /* frames without a trigger */
        /* A line over TCP assigns no response to an earlier request. */
        {"late", line[FATHOM_LINE_LATE_RESPONSES] + (port->kind == PORT_GATEWAY ? heard->fitting : 0u)},
        {"took", heard->slowest_us / 1000u},
        {"timeout", (heard->slowest_us / 500u + 99u) / 100u * 100u}, /* twice the time, in steps of 100 ms */
        {"masters", heard->masters},                                 /* requests of another master, ... */
        {"asked-address", heard->masters_address},                   /* ... to this unit */
        {"headless", heard->headless},                               /* a response without its first bytes */
        {"foreign", heard->foreign},                                 /* frames of another address */
        {"foreign-address", heard->foreign_address},
        {"impossible", heard->foreign_address > model->max_address}, /* which the model cannot have */
        {"stream", is_stream(failure)},
        /* frames that are no measurement of a sensor that sends automatically */
        {"modbus", heard->masters + heard->foreign + (mode->has_address ? heard->own : 0)},
        /* automatic frames whose start is not certain */
        {"ambiguous", stream[FATHOM_STREAM_AMBIGUOUS] + stream[FATHOM_STREAM_UNSURE]},
        {"dropped", stream[FATHOM_STREAM_DROPPED_BYTES]},
        {"damaged-frames", stream[FATHOM_STREAM_DAMAGED]},
        {"own", heard->own}, /* frames of the address */
        {"crowded", is_crowded(failure)},
        {"only-echo", is_only_echo(heard)},
        {"old", line[FATHOM_LINE_OLD_BYTES]}, /* of unknown age */
        {"gateway", heard->word},
        {"gateway-busy", heard->word == 5 || heard->word == 6},
        /* responded instead of the unit of the request, and not to refuse it for that unit */
        {"other-unit", port->gateway.has_other_unit && heard->word == 0},
        {"unit", port->gateway.other_unit},
        {"other-identifier", port->gateway.has_other_identifier},
        {"rtu", port->gateway.is_rtu},
        {"incomplete", port->gateway.is_incomplete},
        {"closed", port->gateway.is_closed},
        {"mbap", heard->is_mbap},
        {"part", heard->part},
        {"pieces", heard->pieces_us / 1000u},
        /* the refused response */
        {"unexpected", facts.is_unexpected}, /* it does not fit the request */
        {"refused", facts.refused_probe},    /* a value of it was refused */
        {"probe", model->probes > 1 ? facts.refused_probe : 0u},
        {"raw", facts.refused_raw},
        {"code", facts.refused_raw == 0 || facts.refused_raw >= 0xFFFD}, /* this value has no meaning */
        {"min", facts.min_mm},
        {"max", facts.max_mm},
        {"whole", failure->is_whole},
    };
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++)
        if (strncmp(rows[i].name, name, length) == 0 && rows[i].name[length] == '\0') return rows[i].value;
    assert(false); /* Only this file has names of facts. */
    return 0;
}

/* ---- causes ---- */

/* A row fits a failure with one of these statuses if all of these facts are not 0. */
typedef struct {
    unsigned statuses; /* bits AT(status) */
    const char *facts;
    const char *text;   /* what failed, or why */
    const char *advice; /* NULL: there is none */
} row_t;

#define AT(status) (1u << -(int)(status))
enum {
    GOOD = AT(FATHOM_OK),
    PORT = AT(FATHOM_ERR_PORT),
    UNSUPPORTED = AT(FATHOM_ERR_UNSUPPORTED),
    CANCELLED = AT(FATHOM_ERR_CANCELLED),
    NO_RESPONSE = AT(FATHOM_ERR_NO_RESPONSE),
    CHECKSUM = AT(FATHOM_ERR_CHECKSUM),
    EXCEPTION = AT(FATHOM_ERR_EXCEPTION),
    MALFORMED = AT(FATHOM_ERR_MALFORMED),
    STALE = AT(FATHOM_ERR_STALE),
    LINE_BUSY = AT(FATHOM_ERR_LINE_BUSY),
    OTHER_MASTER = AT(FATHOM_ERR_OTHER_MASTER),
    NO_MATCH = NO_RESPONSE | CHECKSUM | LINE_BUSY,
    ANY = INT32_MAX
};

#define SAME_EFFECT "Swapped wires A and B and noise have the same effect"
#define DISTURBANCE                                                                                          \
    "Check the screw terminals, the cable, its termination and ground, and keep it away from motors"
#define UNSEEN "[hidden:. To see whether another program has the port open, run 'sudo fuser -v {path}']"
#define TAKEN                                                                                                \
    "{path}: the device is there, but another program [hung-up:has hung up the port][changed:has changed "   \
    "the "                                                                                                   \
    "settings of the port]"
#define TAKEN_ADVICE                                                                                         \
    "[ends:, then start again][may-wait:. With --reconnect, fathom opens the port again][waits:. Waiting "   \
    "until "                                                                                                 \
    "the port can be opened]"
#define OTHER_FORM "[forms:. If the module is another form, read it as that: {forms}]"
#define NO_MASTER  "Disconnect the other master or stop its program"
#define PULSE_WIRES                                                                                          \
    "Check the supply and ground of the sensor, the wires from trigger to its RX and from its TX to echo, "  \
    "that these are line numbers of the chip (gpioinfo lists them) and not of the header's pins, and that "  \
    "the sensor is the PWM variant. 5 V or RS232 destroy a pin for 3.3 V"

/* The first row that fits is the cause. */
static const row_t causes[] = {
    {PORT, "lost taken holder", TAKEN ". {holder} has it open", "{stop}" TAKEN_ADVICE},
    {PORT, "lost taken", TAKEN, "Stop this program ('sudo fuser -v {path}' may name it)" TAKEN_ADVICE},
    {PORT, "lost waits", "{port-error}", "Waiting until it is back"},
    {PORT, "lost network", "{port-error}", "Start again[reads:. With --reconnect, fathom connects again]"},
    {PORT, "lost", "{port-error}",
     "Connect it again and start again[reads:. With --reconnect, fathom waits for it]"},
    {PORT, "connecting", "{path}: the far end closed the connection, and there is no new one after a second",
     "Check the network and the far end"},
    {PORT, "", "{path}: the port did not send the request in time",
     "Check the adapter, and whether the computer was asleep or too busy"},
    {UNSUPPORTED, "", "the port does not support this, and nothing was sent",
     "Choose other line settings or another adapter"},
    {CANCELLED, "", "the command ended before the response arrived", NULL},

    {GOOD | NO_MATCH | STALE | MALFORMED | OTHER_MASTER, "holder",
     "{holder} has {path} open too. Two programs at one port lose bytes to each other",
     "{stop}, then try again"},
    {GOOD | NO_MATCH | STALE | MALFORMED | OTHER_MASTER, "changed",
     "another program has changed the settings of {path}",
     "Stop this program ('sudo fuser -v {path}' may name it), then start again"},
    {NO_MATCH | STALE | MALFORMED, "console bytes",
     "{path} is the console of the kernel, whose messages and login are on the same line",
     "Switch the console off; 'fathom help trouble' says how"},

    {GOOD, "", "{share} of 100 frames are damaged. The others are right, so the baud rate is right",
     "Check for a long cable at TTL level, a missing common ground and noise, and whether a microcontroller "
     "passes "
     "the bytes on that it receives by SoftwareSerial: use one of its UARTs" UNSEEN},

    {NO_RESPONSE, "pins noises",
     "no pulse of the sensor, but {noises} shorter ones: noise on the wire of echo",
     "Keep this wire away from motors and from the wire of trigger. " PULSE_WIRES},
    {NO_RESPONSE, "pins", "no pulse was received", PULSE_WIRES},
    {MALFORMED, "pins", "a pulse is no distance from {min} to {max} mm (--window)",
     "Check for noise, and that no target is nearer than 50 cm"},
    {STALE, "pins pulses", "the pulse was read more than 2.5 s after its end",
     "The computer is too busy, or it was asleep"},
    {STALE, "pins", "the level is not stable",
     "Check for a loose wire or a worn contact, that something pulls the input to one side (bias=up, "
     "bias=down or a resistor), and that this is a line number of the chip (gpioinfo lists them)"},

    {NO_RESPONSE | CHECKSUM, "triggered automatic",
     "frames are received without a trigger, so the module is the automatic form ({automatic})",
     "Try '{read-automatic}'" UNSEEN},
    {NO_RESPONSE | CHECKSUM | STALE, "zeros",
     "no byte but 00 was received: the line is low for a long time, as by the pulses of a module",
     "If the module is the pulse form (M), read it at lines of a GPIO chip. Else check for the levels of "
     "RS232, and whether TX and RX are swapped" OTHER_FORM UNSEEN},
    {NO_RESPONSE | CHECKSUM, "triggered bytes", "the bytes after the trigger form no frame",
     "Check {settings}, and look for noise" UNSEEN},
    {NO_RESPONSE | CHECKSUM, "triggered relative", "no frame followed the trigger in time",
     "Check the supply and the wires from the adapter's TX to the sensor's RX and back" OTHER_FORM UNSEEN},
    {NO_RESPONSE | CHECKSUM, "triggered", "nothing followed the trigger",
     "Check the supply, the wires from the adapter's TX (or the line trigger=) to the sensor's RX and back, "
     "that the adapter can send a break, and that the sensor is the UART controlled variant (if not: --mode "
     "auto or --mode modbus)" UNSEEN},

    {NO_RESPONSE, "asked other-unit", "the server responds as unit {unit}, and not as unit {address}",
     "If the sensor is unit {unit}, read it with this address. Else check which units the gateway serves"},
    {NO_RESPONSE, "asked late", "the response arrived after the time-out[took: (it took {took} ms)]",
     "Try a longer --timeout[took:, such as --timeout {timeout}]"},
    {NO_MATCH, "asked converter mbap", "the response has the header of Modbus TCP", "Use {modbus-tcp}"},
    {NO_MATCH, "asked tty pieces", "the response came in pieces, {pieces} ms apart",
     "Try --pieces, with which a response may arrive in pieces until its time-out"},
    {NO_MATCH, "asked headless",
     "the first bytes of the response are missing or damaged, and the others are right, so the settings are "
     "right: the "
     "adapter or the gateway switches from sending to receiving too late (driver enable, DE and RE)",
     "[request:Try again][not-request:Try --retries 2], and use an adapter or a setting that releases the "
     "line "
     "sooner"},
    {NO_MATCH, "asked masters", "another master sends requests on this line (to address {asked-address})",
     NO_MASTER},
    {NO_MATCH, "asked foreign impossible",
     "the line works, but address {foreign-address} responds, which no {model} can have",
     "Check which sensor is connected"},
    {NO_MATCH, "asked foreign", "the line works, but address {foreign-address} responds", "Try {other}"},
    {NO_MATCH | STALE, "stream", "frames of {streamed} in automatic mode were received",
     "Try 'fathom read {streamed} --mode auto'"},

    {STALE | CHECKSUM, "listened silence worked", "no byte was received. Earlier readings were good",
     "Check the power and the wires of the sensor" UNSEEN},
    {STALE | CHECKSUM, "listened silence addressed", "no byte was received",
     "Check the power and whether A and B are swapped. If the sensor does not send automatically, use --mode "
     "modbus. To find its address, run 'fathom scan --port {path}'" UNSEEN},
    {STALE | CHECKSUM, "listened silence relative", "no byte was received",
     "Check the power and the wire of the sensor's TX" OTHER_FORM UNSEEN},
    {STALE | CHECKSUM, "listened silence", "no byte was received",
     "Check the power and the wire of the sensor's TX. A Modbus request ends the automatic output: switch "
     "the sensor off and on, or use --mode modbus. If it has an address, name it with its address, such as "
     "{model}:7; 'fathom scan --port {path}' finds it" UNSEEN},
    {STALE | CHECKSUM, "listened addressed foreign", "the line works, but address {foreign-address} sends",
     "Try {other}"},
    {STALE | CHECKSUM, "listened modbus relative",
     "Modbus frames were received, but no measurement of {sensor}",
     "Check that the module is an automatic form (U)" OTHER_FORM},
    {STALE | CHECKSUM, "listened modbus", "Modbus frames were received, but no measurement of {sensor}",
     "If the sensor does not send automatically, use --mode modbus"},
    {STALE | CHECKSUM, "listened ambiguous",
     "the bytes look like frames of {model}, but the start of a frame is not certain[dropped: (damaged "
     "frames: {damaged-frames}, bytes in no frame: {dropped})]",
     "Check that no other device sends on this line, and look for noise"},
    {STALE | CHECKSUM, "listened worked",
     "the bytes form no frame[dropped: (damaged frames: {damaged-frames}, bytes in no frame: {dropped})]. "
     "Earlier readings were good, so the settings are right",
     DISTURBANCE UNSEEN},
    {STALE | CHECKSUM, "listened",
     "the bytes form no frame of {model}[dropped: (damaged frames: {damaged-frames}, bytes in no frame: "
     "{dropped})]",
     "Check {settings}, and that the sensor is {model}. " SAME_EFFECT UNSEEN},

    {EXCEPTION, "", "exception {exception}", NULL},

    {NO_MATCH | MALFORMED, "asked crowded",
     "the sensor sends measurements without a request ({own} received), and a request has to fit between two "
     "of them",
     "{delay}[tty:If an adapter delays bytes, run 'setserial {path} low_latency'. Else try][converter:Try] "
     "again"},

    {NO_RESPONSE, "asked closed", "the far end closed the connection before it responded",
     "Try again. Some serve one program at a time, so check whether another one is connected"},
    {NO_RESPONSE, "asked gateway-busy", "the gateway responds with exception {exception}",
     "It serves another request. Try --retries 2, and a longer --interval, also in other programs that use "
     "it"},
    {NO_RESPONSE, "asked gateway", "the gateway responds with exception {exception}",
     "Check {option}, and the line and the supply behind the gateway"},
    {NO_RESPONSE, "asked other-identifier",
     "the server responds with another transaction identifier than that of the request",
     "Restart the gateway, and look for a newer firmware of it"},
    {NO_RESPONSE, "asked rtu",
     "the response is a frame of Modbus RTU without the header of Modbus TCP: the converter passes raw bytes",
     "Use rtu-{path}, or switch the converter to Modbus TCP"},
    {NO_RESPONSE, "asked incomplete",
     "only a part of a response was received: its header announces more bytes",
     "Try a longer --timeout. If the rest never arrives, look for a newer firmware of the gateway"},
    {NO_RESPONSE, "asked tcp bytes", "the response does not fit the request",
     "Check that the server speaks Modbus TCP"},
    {NO_RESPONSE, "asked tcp worked",
     "the connection is open, but nothing was received. Earlier responses were good, so the settings are "
     "right",
     "Check the line and the supply of the sensor. A gateway that waits for another unit responds too late: "
     "try a "
     "longer --timeout"},
    {NO_RESPONSE, "asked tcp", "the connection is open, but nothing was received",
     "Check {option} and the line and supply of the sensor, and try a --timeout longer than the gateway's"
     "[unproven:. If the converter passes raw bytes, which is the factory setting of many, use rtu-{path}]"},
    {CHECKSUM, "asked tcp", "the response has a wrong length", "Check that the server speaks Modbus TCP"},
    {LINE_BUSY, "asked tcp", "the server sends without a pause",
     "Check that the server speaks Modbus TCP, and restart it"},

    {NO_RESPONSE, "asked only-echo",
     "only the tool's own request was received: the adapter works and echoes, but no sensor responds behind "
     "it",
     "Check the wires behind the adapter (A, B, ground), the supply, and {option}"},
    {NO_RESPONSE, "asked old", "{old} bytes of unknown age were received and dropped",
     "The computer was busy or asleep, the adapter delays bytes, or a device sends without a request. Try "
     "again, or try a longer --timeout"},
    {NO_RESPONSE, "asked own", "frames of this address were received, but no response",
     "Check that no other master asks, and that only one sensor has this address"},
    {NO_RESPONSE, "asked bytes worked",
     "bytes were received, but no {protocol} frame. Earlier responses were good, so the settings are right",
     DISTURBANCE UNSEEN},
    {NO_RESPONSE, "asked bytes", "bytes were received, but no {protocol} frame",
     "Check {settings}. Swapped wires A and B, noise and two sensors at one address have the same "
     "effect" UNSEEN},
    {NO_RESPONSE, "asked worked",
     "no byte was received. Earlier responses were good, so the settings are right",
     "Check the power and the wires of the sensor" UNSEEN},
    {NO_RESPONSE, "asked others", "no byte was received, but other sensors on this line respond",
     "Check the power, the wires, the address and the settings of this sensor" UNSEEN},
    {NO_RESPONSE, "asked", "no byte was received",
     "Check the power, whether A and B (or RX and TX) are swapped, {option}, and {rates}[not-scan:, or run "
     "'fathom scan --port {path}'][converter:. If it speaks Modbus TCP, use {modbus-tcp}]" UNSEEN},

    {CHECKSUM, "asked tty part", "the response broke off after {part} bytes",
     "If the rest may arrive later, as over a network or Bluetooth, try --pieces. " DISTURBANCE},
    {CHECKSUM, "asked worked",
     "earlier responses were good, so the settings are right and the line is disturbed[damaged: ({damaged} "
     "of {attempts} attempts)]",
     DISTURBANCE UNSEEN},
    {CHECKSUM, "asked", "its checksum is wrong",
     "Check {parity}, the cable and its termination, and that no other sensor has this address" UNSEEN},

    {LINE_BUSY, "asked own", "frames of this address fill the line", "Let the sensor send less often"},
    {LINE_BUSY, "asked worked", "the line was never silent", DISTURBANCE},
    {LINE_BUSY, "asked", "the line was never silent, and the bytes form no frames",
     "Check the bias and termination resistors and the wires (A, B, ground), disconnect other devices one by "
     "one, and check {settings}"},

    {OTHER_MASTER, "request",
     "another master asked this unit at the same time, or the unit acknowledged another write of function 06",
     NO_MASTER ", or try again"},
    {OTHER_MASTER, "", "another master asked this sensor at the same time", NO_MASTER ", or try again"},

    {MALFORMED, "unexpected", "the response does not fit the request",
     "Check that the sensor is {model}, and the only one at address {address}"},
    {MALFORMED, "setting", "the response has a value that this setting cannot have",
     "Check that the sensor is {model}, and the only one at address {address}"},
    {MALFORMED, "refused code",
     "[probe:probe {probe}: ]{raw} (hex {hex}) has no known meaning[whole:. The other probes of this frame "
     "may be damaged and are refused too]",
     "If you know it, use --means {hex}=MEANING. [probe:If this probe is not fitted, leave it out with "
     "--probes. ]Check that the sensor is {model}, and look for noise"},
    {MALFORMED, "refused",
     "[probe:probe {probe}: ]{raw} is no distance from {min} to {max} mm[whole:. The other probes of this "
     "frame may be damaged and are refused too]",
     "[probe:If this probe is not fitted, leave it out with --probes. ]Check that the sensor is {model}, and "
     "look for noise"},
    {MALFORMED, "", "the values cannot be a distance: {values}",
     "Check that the sensor is {model}, and look for noise"},

    {ANY, "", "{library}", NULL},
};

/* What failed; "": the cause has it. The first row that fits is right. */
static const row_t failures[] = {
    {ANY, "scan", "no sensor was found{place}: ", NULL},
    {PORT | CANCELLED, "", "", NULL},
    {UNSUPPORTED, "", "cannot set {path} to {line}: ", NULL},
    {NO_RESPONSE | STALE, "pins", "no reading from {sensor}{place}: ", NULL},
    {NO_RESPONSE | STALE, "listened", "no frame from {sensor}{place}: ", NULL},
    {NO_RESPONSE | STALE, "", "no response from {sensor}{place}: ", NULL},
    {CHECKSUM, "listened", "no valid frame from {sensor}{place}: ", NULL},
    {CHECKSUM, "", "damaged response from {sensor}{place}: ", NULL},
    {EXCEPTION, "", "{sensor}{place} refused the request: ", NULL},
    {MALFORMED, "", "unusable response from {sensor}{place}: ", NULL},
    {LINE_BUSY, "", "cannot send a request to {sensor}{place}: ", NULL},
    {OTHER_MASTER, "", "cannot assign the response of {sensor}{place}: ", NULL},
    {ANY, "", "{sensor}{place} failed: ", NULL},
};

static bool fits(const row_t *row, const failure_t *failure)
{
    /* A damaged response that is only the tool's own request is no response. */
    const bool is_echo =
        failure->status == FATHOM_ERR_CHECKSUM && is_asked(failure) && is_only_echo(&failure->evidence);
    if ((row->statuses & (is_echo ? AT(FATHOM_ERR_NO_RESPONSE) : AT(failure->status))) == 0) return false;
    for (const char *name = row->facts; *name != '\0';) {
        const size_t length = strcspn(name, " ");
        if (fact(failure, name, length) == 0) return false;
        name += length + strspn(name + length, " ");
    }
    return true;
}

static const row_t *find(const row_t *row, const failure_t *failure)
{
    while (!fits(row, failure)) row++;
    return row;
}

/* ---- words that are more than a number ---- */

static void print_place(FILE *to, const failure_t *failure)
{
    (void)fprintf(to, " at %s", failure->port->name);
    if (failure->line != NULL && failure->port->kind == PORT_SERIAL) {
        char text[LINE_TEXT];
        (void)fprintf(to, " (%s)", line_text(failure->line, text));
    }
}

/* Where the line settings are chosen. */
static const char *rates_of(const failure_t *failure)
{
    return failure->port->kind == PORT_RAW ? "the baud rate and parity of the converter"
                                           : "--baud and --parity";
}

/* "--baud and --parity (now 9600 8N1; ...)" */
static void print_settings(FILE *to, const failure_t *failure)
{
    const fathom_line_settings_t *const now = failure->line;
    const fathom_line_settings_t *const factory = &failure->model->line;
    const uint64_t *const port = failure->counters->attempt.port;
    char text[LINE_TEXT];
    (void)fputs(rates_of(failure), to);
    if (port_has_bytes(failure->port->kind) && !port_has_settings(failure->port->kind) && factory->baud != 0)
        (void)fprintf(to, " (with factory settings %s)", line_text(factory, text));
    if (now == NULL || !port_has_settings(failure->port->kind)) return;
    (void)fprintf(to, " (now %s", line_text(now, text));
    if (factory->baud != 0 && (now->baud != factory->baud || now->parity != factory->parity ||
                               now->stop_bits != factory->stop_bits))
        (void)fprintf(to, "; with factory settings %s", line_text(factory, text));
    else if (failure->model->other_settings != NULL)
        (void)fprintf(to, "; try %s", failure->model->other_settings);
    if (port[PORT_FRAMING] + port[PORT_PARITY] != 0)
        (void)fprintf(to, "; the port counts %s",
                      port[PORT_FRAMING] != 0 ? "framing errors, so most likely --baud"
                                              : "parity errors, so most likely --parity");
    (void)fputs(")", to);
}

static void print_exception(FILE *to, const failure_t *failure)
{
    const uint8_t gateway = failure->evidence.word;
    const uint8_t number = gateway != 0 ? gateway : reader_facts(failure->reader).exception;
    const modbus_exception_t exception = modbus_exception(number);
    (void)fprintf(to, "%02u (%s)", number, exception.name);
    if (gateway == 0) (void)fprintf(to, ": %s", exception.meaning);
    if (gateway == 0 && exception.is_other_sensor)
        (void)fprintf(to, ". Check that the sensor is %s", failure->model->name);
}

static void print_values(FILE *to, const failure_t *failure)
{
    const reader_facts_t facts = reader_facts(failure->reader);
    for (uint8_t i = 0; i != facts.value_count; i++)
        (void)fprintf(to, "%s%u", i != 0 ? " " : "", facts.values[i]);
}

/* Adapters delay received bytes. */
static void print_delay(FILE *to, const failure_t *failure)
{
    const unsigned ms = adapter_latency_ms(failure->port->name);
    if (ms != 0) (void)fprintf(to, "The adapter delays bytes by %u ms. ", ms);
}

/* "a02yytw (T, controlled), aj-sr04m::pwm (R19 open, or 300k)" */
static void print_forms(FILE *to, const failure_t *failure)
{
    const fathom_model_description_t *form = NULL;
    for (size_t n = 0; (form = model_form(failure->mode, n)) != NULL; n++) {
        if (n != 0) (void)fputs(", ", to);
        model_form_print(to, failure->mode, form);
    }
}

/* Returns the automatic form of a module with a trigger; NULL: it is not known. */
static const fathom_model_description_t *automatic_form(const failure_t *failure)
{
    const fathom_model_description_t *form = NULL;
    for (size_t n = 0; (form = model_form(failure->mode, n)) != NULL && form->mode != FATHOM_MODE_AUTO;) n++;
    return form;
}

/* Prints what selects the automatic form: the letter of its name, or the resistor of a board. */
static void print_automatic(FILE *to, const failure_t *failure)
{
    const fathom_model_description_t *const form = automatic_form(failure);
    const bool has_note = form != NULL && strcmp(form->name, failure->mode->row->name) == 0;
    (void)fputs(has_note ? form->note : "U", to);
}

static void print_read_automatic(FILE *to, const failure_t *failure)
{
    const fathom_model_description_t *const form = automatic_form(failure);
    const model_t *const model = form != NULL ? model_find(form->name) : model_with(DECODE_STREAM_ONE);
    read_command_print(to, model, "auto", -1, failure->line != NULL ? failure->line : &model->line,
                       failure->port->name);
}

static void print_word(FILE *to, const char *name, const failure_t *failure)
{
    const char *const model = failure->model->name;
    const bool is_request = failure->is_request;
    const char *const option = is_request ? "UNIT" : "--address";
    char sensor[64];
    char other[64];
    char line[LINE_TEXT] = "";
    char hex[8];
    if (is_request)
        (void)snprintf(sensor, sizeof sensor, "unit %u", failure->address);
    else
        (void)snprintf(sensor, sizeof sensor, failure->mode->has_address ? "%s:%u" : "%s", model,
                       failure->address);
    /* how the user enters the address that was received */
    (void)snprintf(other, sizeof other, "%s%s%u", failure->shared != NULL ? model : option,
                   failure->shared != NULL ? ":" : " ", failure->evidence.foreign_address);
    (void)snprintf(hex, sizeof hex, "%X", reader_facts(failure->reader).refused_raw);
    if (failure->line != NULL) (void)line_text(failure->line, line);
    const struct {
        const char *name;
        const char *text;
        void (*print)(FILE *to, const failure_t *failure);
    } words[] = {
        {"sensor", sensor, NULL},
        {"other", other, NULL},
        {"line", line, NULL},
        {"hex", hex, NULL},
        {"model", model, NULL},
        {"path", failure->port->name, NULL},
        {"holder", failure->holder.who, NULL},
        {"stop", failure->holder.stop, NULL},
        {"modbus-tcp", strstr(failure->port->name, "tcp:"), NULL},
        {"rates", rates_of(failure), NULL},
        {"parity", failure->port->kind == PORT_RAW ? "the parity of the converter" : "--parity", NULL},
        {"protocol", failure->mode->protocol, NULL},
        {"option", option, NULL},
        {"streamed", failure->evidence.streamed_a05 != 0 ? "a05" : "a16", NULL},
        {"port-error", failure->port->error_text, NULL},
        {"library", fathom_status_advice(failure->status), NULL},
        {"place", NULL, print_place},
        {"settings", NULL, print_settings},
        {"exception", NULL, print_exception},
        {"values", NULL, print_values},
        {"delay", NULL, print_delay},
        {"forms", NULL, print_forms},
        {"automatic", NULL, print_automatic},
        {"read-automatic", NULL, print_read_automatic},
    };
    for (size_t i = 0; i != sizeof words / sizeof words[0]; i++) {
        if (strcmp(words[i].name, name) != 0) continue;
        if (words[i].print != NULL)
            words[i].print(to, failure);
        else
            (void)fputs(words[i].text, to);
        return;
    }
    (void)fprintf(to, "%" PRIu64, fact(failure, name, strlen(name)));
}

/* Prints a text. {word} is replaced by a word or a fact. [fact:text] is printed only if the fact is not 0. */
static void print(FILE *to, const char *text, const failure_t *failure)
{
    char name[20];
    while (*text != '\0') {
        const char mark = *text++;
        const size_t length = mark == '{' ? strcspn(text, "}") : mark == '[' ? strcspn(text, ":") : 0;
        if (length == 0) {
            if (mark != ']') (void)fputc(mark, to);
            continue;
        }
        (void)snprintf(name, sizeof name, "%.*s", (int)length, text);
        text += length + 1;
        if (mark == '{')
            print_word(to, name, failure);
        else if (fact(failure, name, length) == 0)
            text += strcspn(text, "]");
    }
}

/* ---- messages ---- */

failure_t failure_of_request(fathom_status_t status, const port_t *port)
{
    static const model_t model = {.name = "the one that you expect", .max_address = UINT8_MAX};
    static const model_mode_t mode = {.protocol = "Modbus", .is_modbus = true};
    static const counters_t counters;
    return (failure_t){.status = status, .model = &model, .mode = &mode, .port = port, .counters = &counters};
}

uint32_t advice_at_opening(char *text, size_t size, const port_t *port)
{
    holder_t holder;
    holder_find(&holder, &port->serial, port->name);
    if (holder.program != 0)
        (void)snprintf(text, size, "%s has the port open too, and two programs lose bytes to each other. %s",
                       holder.who, holder.stop);
    else if (holder.is_console)
        (void)snprintf(
            text, size,
            "the port is the console of the kernel, whose messages and login disturb the sensor. Switch the "
            "console off; 'fathom help trouble' says how");
    return holder.program != 0 ? holder.program : holder.is_console;
}

void advice_print_opening(const port_t *port)
{
    char text[384];
    if (advice_at_opening(text, sizeof text, port) != 0)
        (void)fprintf(stderr, "fathom: %s: %s.\n", port->name, text);
}

static void print_cause(FILE *to, const failure_t *failure)
{
    const row_t *const cause = find(causes, failure);
    print(to, cause->text, failure);
    if (cause->advice == NULL) return;
    (void)fputs(". ", to);
    print(to, cause->advice, failure);
}

static failure_t with_holder(const failure_t *failure)
{
    failure_t whole = *failure;
    holder_find(&whole.holder, &failure->port->serial, failure->port->name);
    return whole;
}

void advice_print_cause(FILE *to, const failure_t *failure)
{
    const failure_t whole = with_holder(failure);
    print_cause(to, &whole);
}

void advice_print(FILE *to, const failure_t *failure)
{
    print(to, find(failures, failure)->text, failure);
    advice_print_cause(to, failure);
}

void advice_print_new(FILE *to, const failure_t *shown, reported_t *reported)
{
    const failure_t whole = with_holder(shown);
    const failure_t *const failure = &whole;
    const reader_facts_t facts = reader_facts(failure->reader);
    const uint64_t *const port = failure->counters->attempt.port;
    const uint8_t parts[] = {(uint8_t)(find(causes, failure) - causes),
                             failure->evidence.foreign_address,
                             failure->evidence.masters_address,
                             failure->evidence.word,
                             failure->port->gateway.other_unit,
                             facts.exception,
                             facts.refused_probe,
                             port[PORT_FRAMING] != 0  ? 1
                             : port[PORT_PARITY] != 0 ? 2
                                                      : 0};
    uint64_t cause = facts.refused_probe != 0 && fact(failure, "code", 4) != 0 ? facts.refused_raw : 0;
    for (size_t i = 0; i != sizeof parts; i++) cause = cause * UINT64_C(1099511628211) + parts[i];
    cause += failure->holder.program;
    const bool is_new =
        reported->times == 0 || reported->cause != cause || failure->status == FATHOM_ERR_PORT;
    *reported = (reported_t){cause, is_new ? 1 : reported->times + 1};
    print(to, find(failures, failure)->text, failure);
    if (is_new)
        print_cause(to, failure);
    else
        (void)fprintf(to, "the same cause as before, %" PRIu64 " times in a row", reported->times);
}
