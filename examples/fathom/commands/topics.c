/* SPDX-License-Identifier: MIT */
#include "commands/commands.h"

#include "cli/config.h"
#include "cli/rows.h"
#include "device/session.h"
#include "ports/port_options.h"
#include "reading/fields.h"

/* Prints the keys of an option of some rows. */
static void print_keys(FILE *to, const option_t *rows, const char *name)
{
    const option_table_t tables[] = {{rows, 0}, {NULL, 0}};
    option_walk_t walk;
    if (option_find(&walk, tables, name)) help_print_keys(to, walk.row->keys);
}

static void print_mode(FILE *to, const model_mode_t *mode)
{
    const char *const text = mode->is_contact     ? "Read a switch or a relay contact on a GPIO line"
                             : mode->has_pulses   ? "Trigger and measure pulses on GPIO lines"
                             : mode->is_triggered ? "Trigger each measurement by a break or a GPIO line"
                                                  : "Receive what the sensor sends automatically";
    (void)fprintf(to, "  :%-11s ", mode->name);
    if (mode_is_asked(mode))
        (void)fprintf(to, "Send requests (%s)", mode->protocol);
    else
        (void)fputs(text, to);
    (void)fprintf(to, " [%s]\n", mode->section);
}

static void print_sensors(FILE *to)
{
    (void)fputs("A sensor is written [NAME=]SENSOR[:ADDRESS][:MODE][@PORT[,KEY=VALUE...]].\n\n", to);
    for (size_t i = 0; i != model_count; i++) {
        char line[LINE_TEXT];
        (void)fprintf(to, "%s, %s, %s, addresses 1 to %u\n", models[i].name, models[i].what,
                      line_text(&models[i].line, line), models[i].max_address);
        for (size_t m = 0; m != MODEL_MODES && models[i].modes[m].name != NULL; m++)
            print_mode(to, &models[i].modes[m]);
    }
    (void)fputs("\nIn brackets: the section of the datasheet.\n\n"
                "Without :MODE, a sensor is read in its first mode. If it has an address or\n"
                "shares its port, it is read in the first mode that sends requests.\n\n"
                "Without :ADDRESS, the address is 1, the factory setting. An a16 or a05 can also\n"
                "have address 0.\n\n"
                "NAME stands in the output. Without it, the name is SENSOR:ADDRESS.\n\n"
                "Sensors that receive requests can share a line, also with different line\n"
                "settings. If a sensor does not respond three times in succession, it is read\n"
                "less often, so that it does not delay the others.\n\n"
                "The first Modbus request stops the automatic output of an A16 or A05. An A05\n"
                "resumes it only after a power cycle.\n",
                to);
}

static void print_ports(FILE *to)
{
    (void)fputs("--port PORT is the port of all sensors without @PORT. Without it, the\n"
                "environment variable FATHOM_PORT names the port. PORT is one of:\n\n"
                "  /dev/ttyUSB0          a serial port, or the link of 'fathom sim'\n"
                "  tcp:HOST[:TCPPORT]    a Modbus TCP server or gateway, for mode modbus;\n"
                "                        TCPPORT is 502 if it is left out; tcp:[IPV6]:TCPPORT\n"
                "  gpiochip0             a GPIO chip, for modes on pins (fathom help pins)\n\n"
                "Keys behind @PORT apply to this port, and before the options. They apply to all\n"
                "sensors at the port. A port over TCP has none. Keys of a serial port:\n\n",
                to);
    help_print_keys(to, serial_keys);
    (void)fputs("\nKeys of a GPIO chip:\n\n", to);
    help_print_keys(to, chip_keys);
    (void)fputs("\necho: an RS485 adapter with local echo returns the bytes that it sends. 'auto'\n"
                "finds this out.\n\n"
                "--reconnect: a USB adapter is found again by its serial number, also as another\n"
                "/dev/ttyUSB. If it has no serial number, or if another adapter has or may have\n"
                "the same one (0001), it is found in the same USB socket only, and a message\n"
                "names the socket. Other ports are found again by their path.\n",
                to);
}

static void print_pins(FILE *to)
{
    (void)fputs("Some modes use lines of a GPIO chip of this board (Linux 5.10 or later). Lines\n"
                "are numbered from 0; gpioinfo lists them.\n\n"
                "  a16:pwm@gpiochip0,trigger=17,echo=27\n"
                "      trigger is an output to the sensor's RX. echo receives the pulses of its\n"
                "      TX. The sensor measures every 221 ms.\n"
                "  a16:controlled@/dev/ttyUSB0,trigger=gpiochip0/17\n"
                "      trigger is an output to the sensor's RX. The serial port receives the\n"
                "      responses. Without trigger, a break of the serial port triggers.\n"
                "  a16:switch@gpiochip0,in=5\n"
                "      in is the sensor's TX. It is high if a target is nearer than the\n"
                "      threshold; write near=low for the other polarity. near or far is printed\n"
                "      at first and at each change, and with --interval repeatedly.\n"
                "  a05:relay@gpiochip0,in=5,bias=up\n"
                "      in is the normally open contact, to ground with bias=up or to 3.3 V with\n"
                "      bias=down. For the normally closed contact, write near=high with bias=up\n"
                "      and near=low with bias=down.\n\n"
                "Only the trigger line is driven. A broken wire of a switch or a relay looks like\n"
                "a valid state: choose the bias so that it reads as the safe one.\n\n"
                "Pins of most boards take 3.3 V. 5 V or RS232 levels destroy them. The TX of an\n"
                "A16 is 3 V high, and its RX accepts 5 V.\n\n"
                "The accuracy of a pulse depends on the time at which the kernel stamps an edge:\n"
                "on the load, on sleep states, and on the chip's driver. 1 us is 0.17 mm. To\n"
                "measure it, keep the target still and run 'fathom read ... --stats=10'.\n",
                to);
}

static void print_values(FILE *to)
{
    (void)fputs("--window MIN-MAX: distances outside are rejected. Defaults: 1-16350 (a16),\n"
                "1-6000 (a05), 80-30000 (hps167s). An hps167s that is nearer reports 'unknown'.\n\n"
                "--means KEYS: meanings of the values of a16 and a05 that are no distance, such\n"
                "as --means 0=no-target,ffff=unknown:\n\n",
                to);
    print_keys(to, reading_rows, "means");
    (void)fputs("\n"
                "  MEANING is unknown, no-target, interference, too-near, fault or refused.\n\n"
                "--value: 'processed' is steady and follows slowly; 'real-time' is the last\n"
                "measurement. In mode modbus, requests select it (default: processed). In mode\n"
                "auto, the sensor samples its RX pin. For real-time values, fathom holds the\n"
                "port's TX low until it ends, so the serial port must support a break. An a16\n"
                "with automatic UART output follows within 0.5 s, and back within 2.5 to 7.5 s.\n"
                "An a16 with RS232 does not: use 'fathom set a16 automatic-value'. An a05\n"
                "samples its RX pin only at power-on: fathom asks for a power cycle, and prints\n"
                "nothing before.\n\n"
                "--probes LIST: an a05 has four probes. In mode dyp a single probe is measured\n"
                "alone, in 0.1 s instead of 0.25 s.\n\n"
                "--temperature[=S]: the temperature is read between measurements. It is null if\n"
                "it is not known, or older than three times S.\n\n"
                "--timeout: default 500 to 1000 ms for a response, 10 s for a good frame of a\n"
                "sensor that sends automatically (hps167s: 2 s).\n",
                to);
}

static void print_output(FILE *to)
{
    (void)fputs("Readings go to standard output, messages and --stats to standard error. 'No\n"
                "target' and a fault that the sensor reports are readings. In json and csv, a\n"
                "failed attempt is a row too, with its reason in 'status'. json is one object a\n"
                "line.\n\n"
                "--output FILE appends to FILE. If FILE ends in .csv, .json or .jsonl, --format may\n"
                "be left out. csv has a header line if FILE is empty.\n"
                "--rotate day: log.csv becomes log-2026-11-23.csv.\n",
                to);
    reading_help(to);
}

static void print_level(FILE *to)
{
    (void)fputs("--level KEYS: the level in a tank, from the distance to its surface, for all\n"
                "sensors: level_mm, level_per_mille and volume. An example:\n\n"
                "  --level mounting=2300,height=2000,capacity=5000\n\n"
                "Its keys:\n\n",
                to);
    print_keys(to, result_rows, "level");
    (void)fputs("\n"
                "shape=table needs points= instead of capacity=, such as\n"
                "points=500:400/1500:4000/2000:5000. The last point is the full tank.\n\n"
                "--median N prints the median of the last N readings of each probe, nothing\n"
                "before there are N. It starts again after 5 s (or three intervals) without a\n"
                "reading. --gate MM drops a reading that is MM or more off the median; the third\n"
                "in succession counts, since the target has moved. --stats has the number of\n"
                "dropped readings.\n",
                to);
}

static void print_alarm(FILE *to)
{
    (void)fputs("--alarm KEYS: an alarm for each probe. Only its changes are printed. Quote it,\n"
                "since the shell uses < and >: --alarm 'near<500/600,unknown=on,no-response=on'\n\n",
                to);
    print_keys(to, result_rows, "alarm");
    (void)fputs("\n"
                "when= may be left out at the beginning. Without /OFF, the alarm switches off at\n"
                "the same distance. The first state is printed with the first distance that\n"
                "decides it, or after unknown-after (default 5 s, or three intervals).\n\n"
                "--until-alarm ends the command with exit status 3 when an alarm is on.\n",
                to);
}

static void print_picture(FILE *to)
{
    (void)fputs("'fathom watch' has a lane for each probe: the present value, readings a second,\n"
                "and the number of failed attempts. Time runs from left to right; a column is\n"
                "0.25 s or one --interval. A letter stands for a reading without a distance:\n\n"
                "  -  no target                   x  no response\n"
                "  ~  no target, interference     !  damaged, wrong or impossible response\n"
                "  ?  a value without a meaning   s  nothing for too long\n"
                "  n  nearer than it can measure  F  the sensor reports a fault\n"
                "  N  near (switch, relay)        P  the port is lost\n"
                "  _  far (switch, relay)\n\n"
                "NO_COLOR=1 switches colours off. Without UTF-8, bars are made of # and dots. In\n"
                "a pipe or a file, one line a second is printed instead.\n",
                to);
}

static void print_settings(FILE *to)
{
    (void)fputs("'fathom get SENSOR SETTING' reads and 'fathom set SENSOR SETTING VALUE' changes\n"
                "these settings. 'fathom get SENSOR --port PORT' lists their values.\n",
                to);
    for (size_t i = 0; i != model_count; i++) {
        (void)fprintf(to, "\n%s:\n", models[i].name);
        settings_print(to, models[i].settings);
    }
}

static void print_trouble(FILE *to)
{
    (void)fputs("Nothing responds? Work through these in this order:\n\n"
                "  1. Search with factory settings. The command listens first, then sends\n"
                "     requests to addresses 1 to 32:\n"
                "       fathom scan --port PORT\n"
                "  2. Is the port right? Without other adapters, 'ls /dev/ttyUSB*' names it. If\n"
                "     the port cannot be opened: add yourself to the group dialout, and end\n"
                "     other programs that use it.\n"
                "  3. Is the sensor powered? Measure the supply at the sensor.\n"
                "  4. Swap A and B (RS485), or TX and RX (UART, RS232). Connect the grounds.\n"
                "  5. Search with settings that were changed, in about 7 minutes:\n"
                "       fathom scan --port PORT --address 1-254 --baud all --parity all\n"
                "  6. Damaged frames: shorten the line, terminate both of its ends, and try a\n"
                "     lower rate. 'fathom read ... --stats' counts what fails, and names the\n"
                "     likely cause.\n"
                "  7. Two sensors with the same address respond at once. Connect one alone, and\n"
                "     give it another address: fathom set hps167s --port PORT address 7\n"
                "  8. Bytes that you do not understand: fathom decode HEX...\n",
                to);
}

static void print_config(FILE *to)
{
    (void)fputs("'fathom publish FILE' reads a YAML file:\n\n"
                "  site: mill\n"
                "  broker:\n"
                "    host: mqtt.example.org\n"
                "    user: mill\n"
                "    password-file: /etc/fathom/password\n"
                "  lines:\n"
                "    - port: /dev/ttyUSB0\n"
                "      sensors:\n"
                "        - name: tank\n"
                "          sensor: a16:1\n"
                "          level: {mounting: 2300, height: 2000, capacity: 5000}\n"
                "        - name: gate\n"
                "          sensor: hps167s:7\n"
                "          interval: 500\n\n"
                "Its keys:\n\n",
                to);
    config_print_keys(to);
    (void)fputs("\nTopics are PREFIX/SITE/status and publisher, and for each sensor\n"
                "PREFIX/SITE/NAME/state, availability, counters and, if it has them, level and\n"
                "alarm. SIGHUP reads the file again: lines that have not changed go on, others\n"
                "are opened again. While the broker is not connected, messages wait in memory.\n",
                to);
}

/* What each command prints with --format json. The kinds are those of schema.json. */
static const struct {
    const char *command;
    const char *what;
} records[] = {
    {"read", "A reading, a failed attempt, or the change of an alarm"},
    {"read --stats", "The counters of the run, and of pulses (on standard error)"},
    {"scan", "Something that was found on the line"},
    {"scan --estimate", "The duration of a scan"},
    {"info, get", "Settings and values; 'switch-threshold' is switch_threshold"},
    {"set, restore", "The change of a setting"},
    {"calibrate", "Measurements, and the offsets that were written"},
    {"commission", "A sensor with its new address"},
    {"request", "A request, its response, and the meaning"},
    {"decode", "A frame, or bytes that belong to no frame"},
    {"sim --counters", "What a simulated sensor received (on standard error)"},
    {"publish", "MQTT: state, level, alarm, counters, publisher, discovery"},
};

static void print_json(FILE *to)
{
    (void)fputs("One line is one JSON object. Keys are snake_case and end in their unit. A value\n"
                "that is not known is null. The file examples/fathom/schema.json (JSON Schema)\n"
                "defines each kind of object.\n\n"
                "One thing has one key in all commands:\n\n"
                "  name              Name of the sensor: tank, or a16:1 without a name\n"
                "  model             Model of the sensor: a16, a05 or hps167s\n"
                "  mode              Mode in which it is read\n"
                "  address           Address; null if there is none\n"
                "  time_us           Time since the start of the program\n"
                "  utc               Date and time\n"
                "  status            What happened, as one word (fathom help output)\n"
                "  distance_mm       Distance; null unless status is target\n\n"
                "Objects of each command:\n\n",
                to);
    for (size_t i = 0; i != sizeof records / sizeof records[0]; i++)
        (void)fprintf(to, "  %-17s %s\n", records[i].command, records[i].what);
    (void)fputs("\nFields of 'scan':\n\n", to);
    scan_help_fields(to);
}

const help_topic_t topics[] = {
    {"sensors", "Sensors, modes and addresses", NULL, print_sensors},
    {"ports", "Ports and their keys", NULL, print_ports},
    {"pins", "Modes on GPIO lines", NULL, print_pins},
    {"values", "What is a distance: window, means, value", NULL, print_values},
    {"output", "Fields of JSON and CSV", NULL, print_output},
    {"json", "Objects of JSON", NULL, print_json},
    {"level", "Level of a tank, and medians", NULL, print_level},
    {"alarm", "Alarms", NULL, print_alarm},
    {"picture", "The picture of fathom watch", NULL, print_picture},
    {"settings", "Settings of the sensors", NULL, print_settings},
    {"log", "A log that goes on for years", NULL, topic_log},
    {"config", "The configuration file of fathom publish", NULL, print_config},
    {"publishing", "Topics and messages of fathom publish", NULL, topic_publish},
    {"delivery", "What fathom publish loses, and what not", NULL, topic_delivery},
    {"boxes", "Several computers, Home Assistant, security", NULL, topic_boxes},
    {"service", "The service of systemd", NULL, topic_service},
    {"commissioning", "Addresses for new sensors", NULL, topic_commission},
    {"calibration", "The distance offset of an HPS-167S", NULL, topic_calibrate},
    {"backup", "Settings as a file: save and restore", NULL, topic_backup},
    {"requests", "A Modbus request by hand", NULL, topic_request},
    {"faults", "Traits and faults of simulated sensors", NULL, topic_faults},
    {"trouble", "What to do if nothing responds", NULL, print_trouble},
    {.name = NULL},
};
