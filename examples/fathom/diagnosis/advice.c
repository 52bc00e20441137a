/* SPDX-License-Identifier: MIT */
#include "diagnosis/advice.h"

#include "diagnosis/advice_words.h"

/* ---- evidence ---- */

enum {
    /* how the sensor is read: one of these */
    ASKED = 1 << 0,
    LISTENED = 1 << 1,  /* it sends automatically */
    TRIGGERED = 1 << 2, /* by a break on TX */
    PINS = 1 << 3,      /* lines of a GPIO chip */
    /* what is known */
    TCP = 1 << 4,
    LOST = 1 << 5,   /* the port */
    WAITS = 1 << 6,  /* for the lost port */
    PULSES = 1 << 7, /* the sensor sends pulses */
    SHORT = 1 << 8,  /* pulses that are too short */
    WORKED = 1 << 9, /* the sensor has responded in this run, so its settings are right */
    ADDRESS = 1 << 10,
    OTHERS = 1 << 11, /* others on this line respond */
    REQUEST = 1 << 12,
    SETTING = 1 << 13,
    /* what was received */
    SILENCE = 1 << 14,
    BYTES = 1 << 15,
    LATE = 1 << 16,
    MASTER = 1 << 17,      /* requests of another master */
    FOREIGN = 1 << 18,     /* frames of another address */
    IMPOSSIBLE = 1 << 19,  /* which the model cannot have */
    STREAM = 1 << 20,      /* automatic frames of another model, or of any if the sensor was asked */
    MODBUS = 1 << 21,      /* frames that are no measurement of a sensor that sends automatically */
    AMBIGUOUS = 1 << 22,   /* automatic frames whose start is not certain */
    OWN = 1 << 23,         /* frames of the address */
    UNSOLICITED = 1 << 24, /* so many of them that a request hardly fits between two */
    ECHO = 1 << 25,        /* only the tool's own request */
    OLD = 1 << 26,         /* bytes of unknown age */
    GATEWAY = 1 << 27,     /* an exception of the gateway */
    /* the refused response */
    UNEXPECTED = 1 << 28, /* it does not fit the request */
    REFUSED = 1 << 29,    /* a value of it was refused */
    CODE = 1 << 30        /* this value is a code without a meaning */
};

static bool is_only_echo(const evidence_t *heard)
{
    return heard->echoes != 0 && heard->rest == 0 && heard->own == 0 && heard->foreign == 0 &&
           heard->masters == 0;
}

static bool is_stream(const failure_t *failure, bool is_asked)
{
    const bool is_a05 = failure->evidence.streamed_a05 != 0;
    const bool is_a16 = failure->evidence.streamed_a16 != 0;
    if (is_asked || failure->mode->has_address) return is_asked && (is_a05 || is_a16);
    return failure->model->probes > 1 ? is_a16 && !is_a05 : is_a05 && !is_a16;
}

/* Unsolicited frames leave little time for a request, and none if the adapter delays them. */
static bool is_crowded(const failure_t *failure)
{
    enum { LEAST = 3 };
    return failure->port->kind != PORT_GATEWAY && mode_is_asked(failure->mode) &&
           failure->model->may_send_unasked && failure->evidence.own >= LEAST;
}

static unsigned evidence_of(const failure_t *failure)
{
    const reader_facts_t facts = reader_facts(failure->reader);
    const model_mode_t *const mode = failure->mode;
    const port_t *const port = failure->port;
    const bool has_pins = port->kind == PORT_PINS;
    const evidence_t *const heard = &failure->evidence;
    const counters_t *const counters = failure->counters;
    const uint64_t *const line = counters->attempt.line;
    const uint64_t *const stream = counters->attempt.stream;
    const bool is_asked = mode_is_asked(mode) && !has_pins;
    const uint32_t own = mode->has_address ? heard->own : 0;
    const struct {
        bool is_known;
        int evidence;
    } rows[] = {
        {is_asked, ASKED},
        {!is_asked && !mode->is_triggered && !has_pins, LISTENED},
        {mode->is_triggered && !has_pins, TRIGGERED},
        {has_pins, PINS},
        {port->kind == PORT_GATEWAY, TCP},
        {port->error == PORT_LOST, LOST},
        {failure->waits, WAITS},
        {mode->has_pulses, PULSES},
        {failure->noises != 0, SHORT},
        {counters->readings + counters->total.unit[UNIT_RESPONSES] != 0, WORKED},
        {mode->has_address, ADDRESS},
        {failure->others_answer, OTHERS},
        {failure->is_request, REQUEST},
        {failure->is_setting, SETTING},
        {heard->bytes == 0, SILENCE},
        {heard->bytes != 0, BYTES},
        {line[FATHOM_LINE_LATE_RESPONSES] != 0, LATE},
        {heard->masters != 0, MASTER},
        {heard->foreign != 0, FOREIGN},
        {heard->foreign_address > failure->model->max_address, IMPOSSIBLE},
        {is_stream(failure, is_asked), STREAM},
        {heard->masters + heard->foreign + own != 0, MODBUS},
        {stream[FATHOM_STREAM_AMBIGUOUS] + stream[FATHOM_STREAM_UNSURE] != 0, AMBIGUOUS},
        {heard->own != 0, OWN},
        {is_crowded(failure), UNSOLICITED},
        {is_only_echo(heard), ECHO},
        {line[FATHOM_LINE_OLD_BYTES] != 0, OLD},
        {port->gateway_exception != NULL && *port->gateway_exception != 0, GATEWAY},
        {facts.is_unexpected, UNEXPECTED},
        {facts.refused_probe != 0, REFUSED},
        {facts.refused_raw == 0 || facts.refused_raw >= 0xFFFD, CODE},
    };
    unsigned evidence = 0;
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++)
        if (rows[i].is_known) evidence |= (unsigned)rows[i].evidence;
    return evidence;
}

/* ---- causes ---- */

struct cause {
    unsigned statuses; /* bits AT(status): one of these, ... */
    unsigned evidence; /* ... and all of this */
    const char *why;
    const char *advice; /* NULL: `why` has it */
};

#define AT(status) (1u << -(int)(status))

enum {
    PORT = AT(FATHOM_ERR_PORT),
    UNSUPPORTED = AT(FATHOM_ERR_UNSUPPORTED),
    CANCELLED = AT(FATHOM_ERR_CANCELLED),
    NO_RESPONSE = AT(FATHOM_ERR_NO_RESPONSE),
    CHECKSUM = AT(FATHOM_ERR_CHECKSUM),
    EXCEPTION = AT(FATHOM_ERR_EXCEPTION),
    MALFORMED = AT(FATHOM_ERR_MALFORMED),
    STALE = AT(FATHOM_ERR_STALE),
    LINE_BUSY = AT(FATHOM_ERR_LINE_BUSY),
    OTHER_MASTER = AT(FATHOM_ERR_OTHER_MASTER)
};

#define SAME_EFFECT "Swapped wires A and B and noise have the same effect"
#define DISTURBANCE                                                                                          \
    "Check the screw terminals, the cable, its termination and ground, and keep it away from motors"
#define NO_MASTER "Disconnect the other master or stop its program"
#define PULSE_WIRES                                                                                          \
    "Check the supply and ground of the sensor, the wires from trigger to its RX and from its TX to echo, "  \
    "that these are line numbers of the chip (gpioinfo lists them) and not of the header's pins, and that "  \
    "the sensor is the PWM variant. 5 V or RS232 destroy a pin for 3.3 V"

/* The first row that fits is the cause. */
static const cause_t causes[] = {
    {PORT, LOST | WAITS, "{port-error}", "Waiting until it is back"},
    {PORT, LOST | TCP, "{port-error}", "Start again[reads:. With --reconnect, fathom connects again]"},
    {PORT, LOST, "{port-error}",
     "Connect it again and start again[reads:. With --reconnect, fathom waits for it]"},
    {PORT, 0, "{path}: the port did not send the request", "Check the adapter"},
    {UNSUPPORTED, 0, "the port does not support this, and nothing was sent",
     "Choose other line settings or another adapter"},
    {CANCELLED, 0, "the command ended before the response arrived", NULL},

    {NO_RESPONSE, PINS | SHORT,
     "no pulse of the sensor, but {noises} shorter ones: noise on the wire of echo",
     "Keep this wire away from motors and from the wire of trigger. " PULSE_WIRES},
    {NO_RESPONSE, PINS, "no pulse was received", PULSE_WIRES},
    {MALFORMED, PINS, "a pulse is no distance from {min} to {max} mm (--window)",
     "Check for noise, and that nothing is nearer than 50 cm"},
    {STALE, PINS | PULSES, "the pulse was read more than 2.5 s after its end",
     "The computer is too busy, or it was asleep"},
    {STALE, PINS, "the level is not stable",
     "Check for a loose wire or a worn contact, that something pulls the input to one side (bias=up, "
     "bias=down or a resistor), and that this is a line number of the chip (gpioinfo lists them)"},

    {NO_RESPONSE, TRIGGERED, "nothing followed the trigger",
     "Check the supply, the wires from the adapter's TX (or the line trigger=) to the sensor's RX and back, "
     "that the adapter can send a break, and that the sensor is the UART controlled variant (if not: --mode "
     "auto or --mode "
     "modbus)"},
    {CHECKSUM, TRIGGERED, "the bytes after the trigger form no frame",
     "Check {settings}, and look for noise"},

    {STALE | CHECKSUM, LISTENED | SILENCE | WORKED, "no byte was received. Earlier readings were good",
     "Check the power and the wires of the sensor"},
    {STALE | CHECKSUM, LISTENED | SILENCE | ADDRESS, "no byte was received",
     "Check the power and whether A and B are swapped. If the sensor does not send automatically, use "
     "--mode modbus. To find its address, run 'fathom scan'"},
    {STALE | CHECKSUM, LISTENED | SILENCE, "no byte was received",
     "Check the power and the wire of the sensor's TX. If the sensor does not send automatically, use "
     "--mode modbus. If it has an address, name it with its address, such as {model}:7; 'fathom scan' finds "
     "it"},
    {STALE | CHECKSUM, LISTENED | STREAM, "frames of {streamed} in automatic mode were received",
     "Try 'fathom read {streamed} --mode auto'"},
    {STALE | CHECKSUM, LISTENED | ADDRESS | FOREIGN, "the line works, but address {foreign} sends",
     "Try {other}"},
    {STALE | CHECKSUM, LISTENED | MODBUS, "Modbus frames were received, but no measurement of {sensor}",
     "If the sensor does not send automatically, use --mode modbus"},
    {STALE | CHECKSUM, LISTENED | AMBIGUOUS,
     "the bytes look like frames of {model}, but the start of a frame is not certain[dropped: (damaged "
     "frames: {damaged-frames}, bytes in no frame: {dropped})]",
     "Check that nothing else sends on this line, and look for noise"},
    {STALE | CHECKSUM, LISTENED | WORKED,
     "the bytes form no frame[dropped: (damaged frames: {damaged-frames}, bytes in no frame: {dropped})]. "
     "Earlier readings were good, so the settings are right",
     DISTURBANCE},
    {STALE | CHECKSUM, LISTENED,
     "the bytes form no frame of {model}[dropped: (damaged frames: {damaged-frames}, bytes in no frame: "
     "{dropped})]",
     "Check {settings}, and that the sensor is {model}. " SAME_EFFECT},

    {EXCEPTION, 0, "exception {exception}", NULL},

    {NO_RESPONSE, ASKED | LATE, "the response arrived after the time-out[took: (it took {took} ms)]",
     "Try a longer --timeout[took:, such as --timeout {timeout}]"},
    {NO_RESPONSE | CHECKSUM | LINE_BUSY, ASKED | MASTER,
     "another master sends requests on this line (to address {asked})", NO_MASTER},
    {NO_RESPONSE | CHECKSUM | LINE_BUSY, ASKED | FOREIGN | IMPOSSIBLE,
     "the line works, but address {foreign} responds, which no {model} can have",
     "Check which sensor is connected"},
    {NO_RESPONSE | CHECKSUM | LINE_BUSY, ASKED | FOREIGN, "the line works, but address {foreign} responds",
     "Try {other}"},
    {NO_RESPONSE | CHECKSUM | LINE_BUSY, ASKED | STREAM,
     "frames of {streamed} in automatic mode were received", "Try 'fathom read {streamed} --mode auto'"},
    {NO_RESPONSE | CHECKSUM | LINE_BUSY | MALFORMED, ASKED | UNSOLICITED,
     "the sensor sends measurements without a request ({own} received), and a request has to fit between two "
     "of them",
     "[latency:The adapter delays bytes by {latency} ms. ]If an adapter delays bytes, run 'setserial {path} "
     "low_latency'. Else try again"},

    {NO_RESPONSE, ASKED | GATEWAY, "the gateway responds with exception {exception}",
     "Check {option}, and the line and the supply behind the gateway"},
    {NO_RESPONSE, ASKED | TCP | BYTES, "the response does not fit the request",
     "Check that the server speaks Modbus TCP"},
    {NO_RESPONSE, ASKED | TCP, "the connection is open, but nothing was received",
     "Check {option} and the line and supply of the sensor, and try a --timeout longer than the gateway's"},
    {CHECKSUM, ASKED | TCP, "the response has a wrong length", "Check that the server speaks Modbus TCP"},
    {LINE_BUSY, ASKED | TCP, "the server sends without a pause",
     "Check that the server speaks Modbus TCP, and restart it"},

    {NO_RESPONSE, ASKED | ECHO,
     "only the tool's own request was received: the adapter works and echoes, but no sensor responds behind "
     "it",
     "Check the wires behind the adapter (A, B, ground), the supply, and {option}"},
    {NO_RESPONSE, ASKED | OLD, "{old} bytes of unknown age were received and dropped",
     "The computer was busy or asleep, or the adapter delays bytes. Try again, or try a longer --timeout"},
    {NO_RESPONSE, ASKED | OWN, "frames of this address were received, but no response",
     "Check that no other master asks, and that only one sensor has this address"},
    {NO_RESPONSE, ASKED | BYTES | WORKED,
     "bytes were received, but no {protocol} frame. Earlier responses were good, so the settings are right",
     DISTURBANCE},
    {NO_RESPONSE, ASKED | BYTES, "bytes were received, but no {protocol} frame",
     "Check {settings}. " SAME_EFFECT},
    {NO_RESPONSE, ASKED | WORKED,
     "no byte was received. Earlier responses were good, so the settings are right",
     "Check the power and the wires of the sensor"},
    {NO_RESPONSE, ASKED | OTHERS, "no byte was received, but other sensors on this line respond",
     "Check the power, the wires, the address and the settings of this sensor"},
    {NO_RESPONSE, ASKED, "no byte was received",
     "Check the power, whether A and B (or RX and TX) are swapped, {option}, and --baud and "
     "--parity[not-scan:, or run 'fathom scan']"},

    {CHECKSUM, ASKED | WORKED,
     "earlier responses were good, so the settings are right and the line is disturbed[damaged: ({damaged} "
     "of {attempts} attempts)]",
     DISTURBANCE},
    {CHECKSUM, ASKED, "its checksum is wrong",
     "Check --parity, the cable and its termination, and that no other sensor has this address"},

    {LINE_BUSY, ASKED | OWN, "frames of this address fill the line", "Let the sensor send less often"},
    {LINE_BUSY, ASKED | WORKED, "the line was never silent", DISTURBANCE},
    {LINE_BUSY, ASKED, "the line was never silent, and the bytes form no frames",
     "Check the bias and termination resistors and the wires (A, B, ground), disconnect other devices one by "
     "one, and check {settings}"},

    {OTHER_MASTER, REQUEST,
     "another master asked this unit at the same time, or the unit acknowledged another write of function 06",
     NO_MASTER ", or try again"},
    {OTHER_MASTER, 0, "another master asked this sensor at the same time", NO_MASTER ", or try again"},

    {MALFORMED, UNEXPECTED, "the response does not fit the request",
     "Check that the sensor is {model}, and the only one at address {address}"},
    {MALFORMED, SETTING, "the response has a value that this setting cannot have",
     "Check that the sensor is {model}, and the only one at address {address}"},
    {MALFORMED, REFUSED | CODE,
     "[probe:probe {probe}: ]{raw} (hex {hex}) has no known meaning[whole:. The other probes of this frame "
     "may "
     "be damaged and are refused too]",
     "If you know it, use --means {hex}=MEANING. [probe:If this probe is not fitted, leave it out with "
     "--probes. ]Check that the sensor is {model}, and look for "
     "noise"},
    {MALFORMED, REFUSED,
     "[probe:probe {probe}: ]{raw} is no distance from {min} to {max} mm[whole:. The other probes of this "
     "frame may be damaged and are refused too]",
     "[probe:If this probe is not fitted, leave it out with --probes. ]Check that the sensor is {model}, and "
     "look for noise"},
    {MALFORMED, 0, "the values cannot be a distance: {values}",
     "Check that the sensor is {model}, and look for noise"},

    {~0u, 0, "{library}", NULL},
};

failure_t failure_of_request(fathom_status_t status, const port_t *port)
{
    static const model_t model = {.name = "the one that you expect", .max_address = UINT8_MAX};
    static const model_mode_t mode = {.protocol = "Modbus", .is_modbus = true};
    static const counters_t counters;
    return (failure_t){.status = status, .model = &model, .mode = &mode, .port = port, .counters = &counters};
}

/* A damaged response that is only the tool's own request is no response. */
static fathom_status_t status_of(const failure_t *failure, unsigned evidence)
{
    const bool is_echo =
        failure->status == FATHOM_ERR_CHECKSUM && (evidence & (ASKED | ECHO)) == (ASKED | ECHO);
    return is_echo ? FATHOM_ERR_NO_RESPONSE : failure->status;
}

const cause_t *diagnose(const failure_t *failure)
{
    const unsigned evidence = evidence_of(failure);
    const fathom_status_t status = status_of(failure, evidence);
    const cause_t *cause = causes;
    while ((cause->statuses & AT(status)) == 0 || (cause->evidence & ~evidence) != 0) cause++;
    return cause;
}

void advice_print_cause(FILE *to, const failure_t *failure)
{
    const cause_t *const cause = diagnose(failure);
    advice_print_template(to, cause->why, failure);
    if (cause->advice == NULL) return;
    (void)fputs(". ", to);
    advice_print_template(to, cause->advice, failure);
}

/* What failed. "": the cause has it. */
static const char *what(const failure_t *failure)
{
    const unsigned evidence = evidence_of(failure);
    if (failure->is_scan) return "no sensor was found{place}";
    switch (status_of(failure, evidence)) {
    case FATHOM_ERR_PORT:
    case FATHOM_ERR_CANCELLED:
        return "";
    case FATHOM_ERR_UNSUPPORTED:
        return "cannot set {path} to {line}";
    case FATHOM_ERR_NO_RESPONSE:
    case FATHOM_ERR_STALE:
        return (evidence & PINS) != 0       ? "no reading from {sensor}{place}"
               : (evidence & LISTENED) != 0 ? "no frame from {sensor}{place}"
                                            : "no response from {sensor}{place}";
    case FATHOM_ERR_CHECKSUM:
        return (evidence & LISTENED) != 0 ? "no valid frame from {sensor}{place}"
                                          : "damaged response from {sensor}{place}";
    case FATHOM_ERR_EXCEPTION:
        return "{sensor}{place} refused the request";
    case FATHOM_ERR_MALFORMED:
        return "unusable response from {sensor}{place}";
    case FATHOM_ERR_LINE_BUSY:
        return "cannot send a request to {sensor}{place}";
    case FATHOM_ERR_OTHER_MASTER:
        return "cannot assign the response of {sensor}{place}";
    default:
        return "{sensor}{place} failed";
    }
}

void advice_print(FILE *to, const failure_t *failure)
{
    const char *const text = what(failure);
    advice_print_template(to, text, failure);
    if (text[0] != '\0') (void)fputs(": ", to);
    advice_print_cause(to, failure);
}
