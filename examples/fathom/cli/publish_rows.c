/* SPDX-License-Identifier: MIT */
#include "cli/publish_rows.h"

#include <string.h>

#include "cli/command.h"

bool topic_name_is_good(const char *text, bool has_slashes)
{
    static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_./";
    const size_t length = strlen(text);
    if (length == 0 || length >= SETTINGS_NAME || strspn(text, letters) != length) return false;
    if (text[0] == '/' || text[length - 1] == '/' || strstr(text, "//") != NULL) return false;
    return has_slashes || strpbrk(text, "/.") == NULL;
}

static bool parse_topic(const char *text, void *member)
{
    if (!topic_name_is_good(text, true)) return false;
    memcpy(member, text, strlen(text) + 1);
    return true;
}

static bool parse_id(const char *text, void *member)
{
    if (!topic_name_is_good(text, false)) return false;
    memcpy(member, text, strlen(text) + 1);
    return true;
}

static bool parse_credential(const char *text, void *member)
{
    return text[0] != '.' && strchr(text, '/') == NULL && parse_topic(text, member);
}

static bool parse_host(const char *text, void *member)
{
    const size_t length = strlen(text);
    if (length == 0 || length >= SETTINGS_HOST || strpbrk(text, " /@") != NULL) return false;
    memcpy(member, text, length + 1);
    return true;
}

#define LETTERS "letters, digits, '-', '_' and '.', at most 100"
#define TOPICS  LETTERS ", with / between levels"

#define TLS(member) AT(broker_settings_t, member)
const option_t publish_tls_keys[] = {
    {"ca-file", "FILE", "Certificates of the trusted authorities", KIND_STRING, .is_path = true,
     TLS(ca_file)},
    {"certificate-file", "FILE", "Certificate of this client", KIND_STRING, .is_path = true,
     TLS(certificate_file)},
    {"key-file", "FILE", "Its private key, without a passphrase", KIND_STRING, .is_path = true,
     TLS(key_file)},
    {.name = NULL},
};

static bool check_tls(void *structure, const origin_t *origin)
{
    const broker_settings_t *const broker = structure;
    if ((broker->certificate_file[0] != '\0') == (broker->key_file[0] != '\0')) return true;
    return reject(origin, "certificate-file and key-file belong together. One of them is missing.");
}

#define BROKER(member) AT(publish_broker_t, settings.member)
const option_t publish_broker_keys[] = {
    {"host", "HOST", "Name or address of the broker", KIND_CUSTOM, .parse = parse_host, BROKER(host),
     .takes = "a name or an address", .is_required = true},
    {"port", "N", "Port of the broker (1883, with tls 8883)", KIND_NUMBER, .min = 1, .max = UINT16_MAX,
     BROKER(port)},
    {"client-id", "ID", "Identity of this client (from prefix and site)", KIND_CUSTOM, .parse = parse_id,
     .takes = "at most 100 letters, digits, '-' and '_'", BROKER(client_id)},
    {"user", "NAME", "User to log in with", KIND_STRING, BROKER(user)},
    {"password-file", "FILE", "File whose first line is the password", KIND_STRING, .is_path = true,
     BROKER(password_file)},
    {"password-credential", "NAME", "Credential of systemd with the password", KIND_CUSTOM,
     .parse = parse_credential, .takes = "the name of a systemd credential",
     AT(publish_broker_t, credential)},
    {"keep-alive", "S", "Time without messages until the connection is tested (30)", KIND_NUMBER, .min = 5,
     .max = 3600, BROKER(keep_alive_s)},
    {"tls", "MAP", "Use TLS; {} trusts the authorities of the system", KIND_MAP, .keys = publish_tls_keys,
     .takes = "a map, such as {} or {ca-file: FILE}", .check = check_tls,
     .at = offsetof(publish_broker_t, settings), HAS(publish_broker_t, settings.has_tls)},
    {.name = NULL},
};

#define TOP(member) AT(publish_top_t, member)
static const option_t queue_keys[] = {
    {"messages", "N", "Most messages to keep (10000)", KIND_NUMBER, .min = 1, .max = 1000000,
     TOP(queue_messages)},
    {"bytes", "N", "Most bytes to keep (4194304)", KIND_NUMBER, .min = 4096, .max = 1073741824,
     TOP(queue_bytes)},
    {.name = NULL},
};

static const option_t top_rows[] = {
    {"site", "NAME", "Second level of all topics (the host's name)", KIND_CUSTOM, .parse = parse_topic,
     .takes = TOPICS, TOP(site)},
    {"prefix", "NAME", "First level of all topics (fathom)", KIND_CUSTOM, .parse = parse_topic,
     .takes = TOPICS, TOP(prefix)},
    {"discovery", "NAME", "Discovery prefix of Home Assistant, or off (homeassistant)", KIND_CUSTOM,
     .parse = parse_topic, .takes = TOPICS ", or off", TOP(discovery)},
    {"broker", "MAP", "The MQTT broker", KIND_MAP, .keys = publish_broker_keys,
     .takes = "a map with at least host", .is_required = true, TOP(broker)},
    {"queue", "MAP", "Messages to keep while the broker is not connected", KIND_MAP, .keys = queue_keys,
     .takes = "a map with messages or bytes"},
    {"lines", "LIST", "The lines of the site", KIND_NODE,
     .takes = "a list of maps, each with port and sensors", .is_required = true, TOP(lines)},
    {.name = NULL},
};

#define READER offsetof(publish_top_t, reader)
const option_table_t publish_top_tables[] = {
    {top_rows, 0}, {interval_rows, READER}, {request_rows, READER}, {NULL, 0}};

const option_t publish_line_keys[] = {
    {"port", "PORT", "Serial port, tcp:HOST[:PORT], or GPIO chip", KIND_TEXT, .is_required = true,
     .takes = "a serial port, tcp:HOST[:PORT], or a GPIO chip", AT(publish_line_t, port)},
    {"sensors", "LIST", "The sensors on the line", KIND_NODE, .is_required = true,
     .takes = "a list of maps, each with name and sensor", AT(publish_line_t, sensors)},
    {.name = NULL},
};

#define SENSOR(member) AT(publish_sensor_t, member)
static const option_t sensor_keys[] = {
    {"name", "NAME", "Level of the sensor in the topics", KIND_TEXT, .is_required = true,
     .takes = "at most 31 letters, digits, '-', '_' and '.', the first a letter or a digit", SENSOR(name)},
    {"sensor", "SENSOR", "SENSOR[:ADDRESS][:MODE], such as hps167s:7", KIND_TEXT, .is_required = true,
     .takes = "SENSOR[:ADDRESS][:MODE], such as hps167s:7", SENSOR(sensor)},
    {.name = NULL},
};

const option_table_t publish_sensor_tables[] = {
    {sensor_keys, 0},
    {interval_rows, offsetof(publish_sensor_t, reader)},
    {request_rows, offsetof(publish_sensor_t, reader)},
    {reading_rows, offsetof(publish_sensor_t, reader)},
    {result_rows, offsetof(publish_sensor_t, results)},
    {NULL, 0},
};

/* ---- help ---- */

static void print_rows(FILE *to, const char *head, const option_t *rows)
{
    if (head != NULL) (void)fprintf(to, "\n  %s:\n", head);
    for (; rows->name != NULL; rows++) {
        char label[80];
        (void)snprintf(label, sizeof label, "%s%s: %s", head != NULL ? "  " : "", rows->name,
                       rows->value != NULL ? rows->value : "");
        (void)fprintf(to, "  %-26s  %s\n", label, rows->help);
    }
}

void publish_print_keys(FILE *to)
{
    print_rows(to, NULL, top_rows);
    print_rows(to, NULL, interval_rows);
    print_rows(to, NULL, request_rows);
    print_rows(to, "broker", publish_broker_keys);
    print_rows(to, "tls", publish_tls_keys);
    print_rows(to, "queue", queue_keys);
    print_rows(to, "lines", publish_line_keys);
    (void)fputs("    and the keys of ports (fathom help ports)\n", to);
    print_rows(to, "sensors", sensor_keys);
    (void)fputs("    and interval, timeout, retries, as above\n", to);
    for (const option_t *row = reading_rows; row->name != NULL; row++)
        (void)fprintf(to, "    %s: %s, as --%s of fathom read\n", row->name, row->value, row->name);
    for (const option_t *row = result_rows; row->name != NULL; row++)
        (void)fprintf(to, "    %s: %s, as --%s of fathom read\n", row->name, row->value, row->name);
}
