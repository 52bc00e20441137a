/* SPDX-License-Identifier: MIT */
/* The configuration file of `fathom publish`: the tree of YAML is read by the same rows as options. */
#define _GNU_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): gethostname, open_memstream */
#include "cli/config.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <yaml.h>

#include "cli/rows.h"

/* ---- the keys ---- */

/* What the top of the file and the maps in it fill. */
typedef struct {
    publish_settings_t settings;
    char credential[SETTINGS_NAME]; /* of systemd; "": none */
    reader_settings_t reader;       /* of sensors without their own */
    const void *lines;              /* a node: a list */
} top_t;

static bool is_topic(const char *text, void *member)
{
    static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_./";
    const size_t length = strlen(text);
    (void)member;
    return length != 0 && strspn(text, letters) == length && text[0] != '/' && text[length - 1] != '/' &&
           strstr(text, "//") == NULL;
}

static bool is_id(const char *text, void *member)
{
    return is_topic(text, member) && strpbrk(text, "/.") == NULL;
}

static bool is_credential(const char *text, void *member)
{
    return is_topic(text, member) && text[0] != '.' && strchr(text, '/') == NULL;
}

static bool is_host(const char *text, void *member)
{
    (void)member;
    return strpbrk(text, " /@") == NULL;
}

static bool check_tls(void *structure, const origin_t *origin)
{
    const broker_settings_t *const broker = &((const top_t *)structure)->settings.broker;
    if ((broker->certificate_file[0] != '\0') == (broker->key_file[0] != '\0')) return true;
    return reject(origin, "certificate-file and key-file belong together. One of them is missing.");
}

#define TOPICS      "letters, digits, '-', '_' and '.', at most 100, with / between levels"
#define TOP(member) AT(top_t, member)
#define SET(member) AT(top_t, settings.member)

static const option_t tls_keys[] = {
    {"ca-file", "FILE", "Certificates of the trusted authorities", KIND_STRING, .is_path = true,
     SET(broker.ca_file)},
    {"certificate-file", "FILE", "Certificate of this client", KIND_STRING, .is_path = true,
     SET(broker.certificate_file)},
    {"key-file", "FILE", "Its private key, without a passphrase", KIND_STRING, .is_path = true,
     SET(broker.key_file)},
    {.name = NULL},
};

static const option_t broker_keys[] = {
    {"host", "HOST", "Name or address of the broker", KIND_STRING, .parse = is_host, SET(broker.host),
     .takes = "a name or an address", .is_required = true},
    {"port", "N", "Port of the broker (1883, with tls 8883)", KIND_NUMBER, .min = 1, .max = UINT16_MAX,
     SET(broker.port)},
    {"client-id", "ID", "Identity of this client (from prefix and site)", KIND_STRING, .parse = is_id,
     .takes = "at most 100 letters, digits, '-' and '_'", SET(broker.client_id)},
    {"user", "NAME", "User to log in with", KIND_STRING, SET(broker.user)},
    {"password-file", "FILE", "File whose first line is the password", KIND_STRING, .is_path = true,
     SET(broker.password_file)},
    {"password-credential", "NAME", "Credential of systemd with the password", KIND_STRING,
     .parse = is_credential, .takes = "the name of a systemd credential", TOP(credential)},
    {"keep-alive", "S", "Time without messages until the connection is tested (30)", KIND_NUMBER, .min = 5,
     .max = 3600, SET(broker.keep_alive_s)},
    {"tls", "MAP", "Use TLS; {} trusts the authorities of the system", KIND_MAP, .keys = tls_keys,
     .takes = "a map, such as {} or {ca-file: FILE}", .check = check_tls,
     HAS(top_t, settings.broker.has_tls)},
    {.name = NULL},
};

static const option_t queue_keys[] = {
    {"messages", "N", "Most messages to keep (10000)", KIND_NUMBER, .min = 1, .max = 1000000,
     SET(queue_messages)},
    {"bytes", "N", "Most bytes to keep (4194304)", KIND_NUMBER, .min = 4096, .max = 1073741824,
     SET(queue_bytes)},
    {.name = NULL},
};

static const option_t top_keys[] = {
    {"site", "NAME", "Second level of all topics (the host's name)", KIND_STRING, .parse = is_topic,
     .takes = TOPICS, SET(site)},
    {"prefix", "NAME", "First level of all topics (fathom)", KIND_STRING, .parse = is_topic, .takes = TOPICS,
     SET(prefix)},
    {"discovery", "NAME", "Discovery prefix of Home Assistant, or off (homeassistant)", KIND_STRING,
     .parse = is_topic, .takes = TOPICS ", or off", SET(discovery)},
    {"broker", "MAP", "The MQTT broker", KIND_MAP, .keys = broker_keys, .takes = "a map with at least host",
     .is_required = true},
    {"queue", "MAP", "Messages to keep while the broker is not connected", KIND_MAP, .keys = queue_keys,
     .takes = "a map with messages or bytes"},
    {"lines", "LIST", "The lines of the site", KIND_NODE,
     .takes = "a list of maps, each with port and sensors", .is_required = true, TOP(lines)},
    {.name = NULL},
};

static const option_table_t top_tables[] = {{top_keys, 0},
                                            {interval_rows, offsetof(top_t, reader)},
                                            {request_rows, offsetof(top_t, reader)},
                                            {NULL, 0}};

typedef struct {
    const char *port;
    port_keys_t keys;
    const void *sensors; /* a node: a list */
} line_keys_t;

/* Without the keys of its port. */
static const option_t line_keys[] = {
    {"port", "PORT", "Serial port, tcp:HOST[:PORT], or GPIO chip", KIND_TEXT, .is_required = true,
     .takes = "a serial port, tcp:HOST[:PORT], or a GPIO chip", AT(line_keys_t, port)},
    {"sensors", "LIST", "The sensors on the line", KIND_NODE, .is_required = true,
     .takes = "a list of maps, each with name and sensor", AT(line_keys_t, sensors)},
    {.name = NULL},
};

typedef struct {
    const char *name;
    char *sensor;
    reader_settings_t reader;
    results_config_t results;
    option_given_t given;
    const yaml_node_t *map;  /* which has these keys, */
    const yaml_node_t *line; /* and that of its line */
} sensor_keys_t;

static const option_t sensor_keys[] = {
    {"name", "NAME", "Level of the sensor in the topics", KIND_TEXT, .is_required = true,
     .takes = "at most 31 letters, digits, '-', '_' and '.', the first a letter or a digit",
     AT(sensor_keys_t, name)},
    {"sensor", "SENSOR", "SENSOR[:ADDRESS][:MODE], such as hps167s:7", KIND_TEXT, .is_required = true,
     .takes = "SENSOR[:ADDRESS][:MODE], such as hps167s:7", AT(sensor_keys_t, sensor)},
    {.name = NULL},
};

static const option_table_t sensor_tables[] = {
    {sensor_keys, 0},
    {interval_rows, offsetof(sensor_keys_t, reader)},
    {request_rows, offsetof(sensor_keys_t, reader)},
    {reading_rows, offsetof(sensor_keys_t, reader)},
    {result_rows, offsetof(sensor_keys_t, results)},
    {NULL, 0},
};

static void print_keys(FILE *to, const char *head, const option_t *rows)
{
    if (head != NULL) (void)fprintf(to, "\n  %s:\n", head);
    for (; rows->name != NULL; rows++) {
        char label[80];
        (void)snprintf(label, sizeof label, "%s%s: %s", head != NULL ? "  " : "", rows->name, rows->value);
        (void)fprintf(to, "  %-26s  %s\n", label, rows->help);
    }
}

void config_print_keys(FILE *to)
{
    print_keys(to, NULL, top_keys);
    print_keys(to, NULL, interval_rows);
    print_keys(to, NULL, request_rows);
    print_keys(to, "broker", broker_keys);
    print_keys(to, "tls", tls_keys);
    print_keys(to, "queue", queue_keys);
    print_keys(to, "lines", line_keys);
    (void)fputs("    and the keys of ports (fathom help ports)\n", to);
    print_keys(to, "sensors", sensor_keys);
    (void)fputs("    and interval, timeout, retries, as above\n", to);
    const option_table_t tables[] = {{reading_rows, 0}, {result_rows, 0}, {NULL, 0}};
    for (option_walk_t walk = {.table = tables}; option_next(&walk);)
        (void)fprintf(to, "    %s: %s, as --%s of fathom read\n", walk.row->name, walk.row->value,
                      walk.row->name);
}

/* ---- the file ---- */

typedef struct {
    origin_t origin; /* the first line */
    yaml_document_t document;
    top_t top;
    sensor_keys_t sensors[MAX_SENSORS];
    sensor_word_t words[MAX_SENSORS]; /* of the sensors */
    int count;
} config_t;

/* libyaml counts lines from 0. */
static origin_t at_mark(const config_t *config, const yaml_mark_t *mark)
{
    origin_t origin = config->origin;
    origin.line = (unsigned)mark->line + 1;
    return origin;
}

static origin_t at_node(const config_t *config, const yaml_node_t *node)
{
    return at_mark(config, &node->start_mark);
}

static bool reject_yaml(const config_t *config, const yaml_parser_t *parser)
{
    const origin_t origin =
        at_mark(config, parser->error == YAML_READER_ERROR ? &parser->mark : &parser->problem_mark);
    return reject(&origin, "this is no YAML: %s%s%s. Check the indent (spaces, no tabs) and the quotes.",
                  parser->problem != NULL ? parser->problem : "no memory", parser->context != NULL ? " " : "",
                  parser->context != NULL ? parser->context : "");
}

/* A second document in the same file would be ignored silently. */
static bool is_last(const config_t *config, yaml_parser_t *parser)
{
    yaml_document_t more;
    if (!yaml_parser_load(parser, &more)) return reject_yaml(config, parser);
    const bool is_there = yaml_document_get_root_node(&more) != NULL;
    const origin_t origin = at_mark(config, &more.start_mark);
    yaml_document_delete(&more);
    return !is_there ||
           reject(&origin, "a second document begins. Write all into one, without a line of ---.");
}

/* Messages print texts of the file, which may not drive a terminal. In UTF-8, which libyaml has checked, it is driven by
 * C0, DEL, and C1, which is U+0080 to U+009F. */
static bool are_printable(const config_t *config)
{
    for (const yaml_node_t *node = config->document.nodes.start; node != config->document.nodes.top; node++) {
        const origin_t origin = at_node(config, node);
        const unsigned char *const text = node->data.scalar.value;
        for (size_t i = 0; node->type == YAML_SCALAR_NODE && i != node->data.scalar.length; i++)
            if (text[i] < ' ' || text[i] == 0x7F || (text[i] == 0xC2 && text[i + 1] < 0xA0))
                return reject(&origin,
                              "a text has a character that cannot be printed, such as a tab. Leave it out.");
    }
    return true;
}

static bool parse_file(config_t *config, FILE *stream)
{
    yaml_parser_t parser;
    if (!yaml_parser_initialize(&parser)) end_without_memory();
    yaml_parser_set_input_file(&parser, stream);
    const bool is_good = (yaml_parser_load(&parser, &config->document) || reject_yaml(config, &parser)) &&
                         (yaml_document_get_root_node(&config->document) == NULL ||
                          (is_last(config, &parser) && are_printable(config)));
    yaml_parser_delete(&parser);
    return is_good;
}

/* ---- nodes ---- */

static const yaml_node_t *node_at(config_t *config, int number)
{
    return yaml_document_get_node(&config->document, number);
}

/* NULL: the node is no text, or an empty one without quotes. */
static char *text_of(const yaml_node_t *node)
{
    if (node->type != YAML_SCALAR_NODE) return NULL;
    if (node->data.scalar.length == 0 && node->data.scalar.style == YAML_PLAIN_SCALAR_STYLE) return NULL;
    return (char *)node->data.scalar.value;
}

static const char *shape_of(const yaml_node_t *node)
{
    if (node->type == YAML_SEQUENCE_NODE) return "a list";
    if (node->type == YAML_MAPPING_NODE) return "a map";
    return text_of(node) != NULL ? "a text" : "empty";
}

static const yaml_node_t *find(config_t *config, const yaml_node_t *map, const char *key)
{
    if (map->type != YAML_MAPPING_NODE) return NULL;
    for (const yaml_node_pair_t *pair = map->data.mapping.pairs.start; pair != map->data.mapping.pairs.top;
         pair++) {
        const char *const text = text_of(node_at(config, pair->key));
        if (text != NULL && strcmp(text, key) == 0) return node_at(config, pair->value);
    }
    return NULL;
}

/* Where the first of two keys that is there stands, or else the map. */
static origin_t at_key(config_t *config, const yaml_node_t *map, const char *key, const char *other)
{
    const yaml_node_t *node = find(config, map, key);
    if (node == NULL) node = find(config, map, other);
    return at_node(config, node != NULL ? node : map);
}

/* Prints what the node has, without its lists. NOLINTNEXTLINE(misc-no-recursion): as deep as the rows */
static void print_node(config_t *config, const yaml_node_t *node, FILE *to)
{
    if (node->type == YAML_SCALAR_NODE) (void)fputs((const char *)node->data.scalar.value, to);
    if (node->type != YAML_MAPPING_NODE) return;
    for (const yaml_node_pair_t *pair = node->data.mapping.pairs.start; pair != node->data.mapping.pairs.top;
         pair++) {
        print_node(config, node_at(config, pair->key), to);
        (void)fputc('=', to);
        print_node(config, node_at(config, pair->value), to);
        (void)fputc(';', to);
    }
}

/* ---- maps by rows ---- */

static bool read_map(config_t *config, const yaml_node_t *map, const option_table_t *tables, void *structure,
                     const char *within, option_given_t *given);

/* NOLINTNEXTLINE(misc-no-recursion): as deep as the rows */
static bool read_value(config_t *config, const option_t *row, const yaml_node_t *node, char *structure,
                       const origin_t *origin)
{
    const bool is_map = node->type == YAML_MAPPING_NODE;
    char *const text = text_of(node);
    if (row->kind == KIND_NODE && node->type == YAML_SEQUENCE_NODE) {
        const void *const list = node;
        memcpy(structure + row->at, &list, sizeof list);
        return true;
    }
    if (is_map && (row->kind == KIND_MAP || row->kind == KIND_KEYS)) {
        const option_table_t tables[] = {{row->keys, 0}, {NULL, 0}};
        option_given_t given = {{0}};
        origin_t its = at_node(config, node);
        its.within = row->name;
        if (!read_map(config, node, tables, structure + row->at, row->name, &given)) return false;
        if (row->has != 0) *(bool *)(structure + row->has - 1) = true;
        return row->check == NULL || row->check(structure + row->at, &its);
    }
    if (text == NULL || row->kind == KIND_MAP || row->kind == KIND_NODE)
        return reject(origin, "%s is %s. It takes %s.", row->name, shape_of(node), option_takes(row));
    if (!option_set(row, text, structure, origin)) return false;
    if (!row->is_path || access(text, R_OK) == 0) return true;
    return reject(origin, "%s: cannot read %s: %s.", row->name, text, strerror(errno));
}

/* Each key stores its value in the structure. `within` names the map in messages; NULL: the file.
 * NOLINTNEXTLINE(misc-no-recursion): as deep as the rows */
static bool read_map(config_t *config, const yaml_node_t *map, const option_table_t *tables, void *structure,
                     const char *within, option_given_t *given)
{
    origin_t origin = at_node(config, map);
    origin.within = within;
    if (map->type != YAML_MAPPING_NODE)
        return reject(&origin, "this is %s. It takes a map, with a line for each key.", shape_of(map));
    for (const yaml_node_pair_t *pair = map->data.mapping.pairs.start; pair != map->data.mapping.pairs.top;
         pair++) {
        const yaml_node_t *const key = node_at(config, pair->key);
        const char *const name = text_of(key);
        origin_t its = at_node(config, key);
        option_walk_t walk;
        its.within = within;
        if (name == NULL) return reject(&its, "a key is %s. It takes a word.", shape_of(key));
        if (tables->rows == broker_keys && strcmp(name, "password") == 0)
            return reject(&its, "a password does not belong in this file. Write it to a file that only this "
                                "user can read, and here password-file: /etc/fathom/password.");
        if (!option_find(&walk, tables, name)) return option_reject_unknown(tables, "key", name, &its);
        unsigned *const line = &given->line[walk.number];
        if (*line != 0) return reject(&its, "%s is given twice, in line %u too.", name, *line);
        *line = its.line;
        if (!read_value(config, walk.row, node_at(config, pair->value), (char *)structure + walk.table->at,
                        &its))
            return false;
    }
    return option_check_given(tables, given, &origin);
}

/* ---- the broker ---- */

/* systemd passes credentials as files in a folder. */
static bool set_credential(const config_t *config, broker_settings_t *broker, const origin_t *origin)
{
    const char *const name = config->top.credential;
    const char *const folder =
        getenv("CREDENTIALS_DIRECTORY"); /* NOLINT(concurrency-mt-unsafe): one thread */
    char reason[SETTINGS_PATH + 100] = "CREDENTIALS_DIRECTORY is not set";
    if (name[0] == '\0') return true;
    if (broker->password_file[0] != '\0')
        return reject(origin,
                      "password-credential and password-file name two passwords. Leave one of them out.");
    if (folder != NULL) {
        const bool fits =
            snprintf(broker->password_file, SETTINGS_PATH, "%s/%s", folder, name) < SETTINGS_PATH;
        if (fits && access(broker->password_file, R_OK) == 0) return true;
        (void)snprintf(reason, sizeof reason, "cannot read %s: %s", broker->password_file, strerror(errno));
    }
    return reject(origin,
                  "password-credential: %s. The unit needs a line LoadCredential=%s:/path/to/the/password.",
                  reason, name);
}

/* A broker ends the connection of a client when another one with its id comes. So the id is the same exactly if the topics are
 * the same: with ids of their own, two computers would publish under one topic, and no message would say so. The id is the same
 * after a restart, so that the broker then ends a connection that broke off, before this client is online. */
static void set_client_id(publish_settings_t *settings)
{
    char *const id = settings->broker.client_id;
    if (id[0] != '\0') return;
    (void)snprintf(id, SETTINGS_NAME, "%.49s-%.49s", settings->prefix, settings->site);
    for (char *at = id; *at != '\0'; at++)
        if (*at == '/' || *at == '.') *at = '-';
}

static bool set_broker(config_t *config, const yaml_node_t *top)
{
    enum { PORT = 1883, PORT_WITH_TLS = 8883 };
    broker_settings_t *const broker = &config->top.settings.broker;
    const yaml_node_t *const map = find(config, top, "broker");
    if (map == NULL) return false; /* read_map() has rejected that */
    const yaml_node_t *const tls = find(config, map, "tls");
    const origin_t origin = at_key(config, map, "password-credential", "password-file");
    broker->line = at_key(config, map, "user", "host").line;
    if (broker->client_id[0] != '\0') broker->id_line = at_key(config, map, "client-id", "client-id").line;
    if (tls != NULL) broker->tls_line = at_key(config, tls, "ca-file", "ca-file").line;
    if (broker->port == 0) broker->port = broker->has_tls ? PORT_WITH_TLS : PORT;
    set_client_id(&config->top.settings);
    return set_credential(config, broker, &origin) &&
           (broker->password_file[0] == '\0' || broker->user[0] != '\0' ||
            reject(&origin, "there is a password, but no user beside it."));
}

static bool set_site(config_t *config, const yaml_node_t *top)
{
    char *const site = config->top.settings.site;
    if (site[0] != '\0') config->top.settings.site_line = at_key(config, top, "site", "site").line;
    if (site[0] != '\0' || (gethostname(site, SETTINGS_NAME - 1) == 0 && is_topic(site, NULL))) return true;
    return reject(&config->origin, "site is missing, and the host's name '%s' cannot be used.", site);
}

/* ---- lines and sensors ---- */

/* Of a site a/b, b can be a sensor of a site a, and 1 to 4 a probe of that sensor. */
static bool is_probe_elsewhere(const publish_settings_t *settings, const char *name)
{
    const bool has_levels = strchr(settings->prefix, '/') != NULL || strchr(settings->site, '/') != NULL;
    return has_levels && name[0] >= '1' && name[0] <= '0' + FATHOM_DYP_PROBES && name[1] == '\0';
}

static bool read_sensor(config_t *config, const line_keys_t *line, const yaml_node_t *line_map,
                        const yaml_node_t *map)
{
    origin_t origin = at_node(config, map);
    if (config->count == MAX_SENSORS)
        return reject(&origin, "this is sensor %d. At most %d can be named.", MAX_SENSORS + 1, MAX_SENSORS);
    sensor_keys_t *const sensor = &config->sensors[config->count];
    sensor_word_t *const word = &config->words[config->count++];
    *sensor = (sensor_keys_t){.reader = config->top.reader, .map = map, .line = line_map};
    sensor->results.has_readings = true;
    if (!read_map(config, map, sensor_tables, sensor, "sensors", &sensor->given)) return false;
    origin = at_key(config, map, "sensor", "sensor");
    if (strpbrk(sensor->sensor, "@=") != NULL)
        return reject(&origin, "sensor is '%s'. Write its name and its port in keys of their own.",
                      sensor->sensor);
    if (!sensor_word_parse(word, sensor->sensor, &origin)) return false;
    word->port = line->port;
    word->keys = line->keys;
    origin = at_key(config, map, "name", "name");
    if (!sensor_name_is_good(sensor->name, strlen(sensor->name)))
        return reject(&origin, "name is '%s'. It takes %s.", sensor->name, sensor_keys[0].takes);
    if (is_probe_elsewhere(&config->top.settings, sensor->name))
        return reject(&origin,
                      "name is '%s'. In %s/%s it has the topics of a probe of another site's sensor. Take "
                      "another name, such as s%s.",
                      sensor->name, config->top.settings.prefix, config->top.settings.site, sensor->name);
    (void)snprintf(word->name, sizeof word->name, "%s", sensor->name);
    return true;
}

static bool read_line(config_t *config, const yaml_node_t *map)
{
    static const option_t none[] = {{.name = NULL}};
    const yaml_node_t *const node = find(config, map, "port");
    const char *const port = node != NULL && text_of(node) != NULL ? text_of(node) : "";
    const option_t *const port_keys = port_kind(port) == PORT_PINS ? chip_keys : serial_keys;
    const option_table_t tables[] = {
        {line_keys, 0},
        {port_kind(port) == PORT_GATEWAY || port_kind(port) == PORT_RAW ? none : port_keys,
         offsetof(line_keys_t, keys)},
        {NULL, 0}};
    line_keys_t line = {.port = NULL};
    option_given_t given = {{0}};
    if (!read_map(config, map, tables, &line, "lines", &given)) return false;
    const origin_t origin = at_key(config, map, "port", "port");
    if (strchr(port, ',') != NULL)
        return reject(&origin, "port is '%s'. Write keys in lines of their own, such as baud: 9600.", port);
    const yaml_node_t *const list = line.sensors;
    /* NOLINTNEXTLINE(clang-analyzer-core.NullDereference): the key is required */
    for (const int *item = list->data.sequence.items.start; item != list->data.sequence.items.top; item++)
        if (!read_sensor(config, &line, map, node_at(config, *item))) return false;
    return true;
}

/* The text of a line is everything that the file has for its sensors: of the line, of each sensor, and of all. Two lines
 * with the same text are the same. */
static void add_text(config_t *config, const sensor_t *sensor, const sensor_keys_t *from, line_t *line)
{
    char *text = NULL;
    size_t size = 0;
    FILE *const memory = open_memstream(&text, &size);
    if (memory == NULL) end_without_memory();
    while (&line->settings != sensor->port) line = line->next;
    (void)fprintf(memory, "%u %u %u ", (unsigned)from->reader.period_us, (unsigned)from->reader.timeout_us,
                  from->reader.retries);
    print_node(config, from->line, memory);
    print_node(config, from->map, memory);
    (void)fputc('\n', memory);
    if (fclose(memory) != 0) end_without_memory();
    line_add_text(line, text);
    free(text);
}

static bool read_sensors(config_t *config, site_t *site)
{
    static const sensor_defaults_t none;
    const yaml_node_t *const list = config->top.lines;
    const origin_t origin = at_node(config, list);
    for (const int *item = list->data.sequence.items.start; item != list->data.sequence.items.top; item++)
        if (!read_line(config, node_at(config, *item))) return false;
    if (config->count == 0) return reject(&origin, "lines names no sensor.");
    if (!sensors_add(site, &none, config->words, config->count)) return false;
    for (size_t i = 0; i != site->sensor_count; i++) {
        sensor_t *const sensor = site->sensors[i];
        sensor_keys_t *const from = &config->sensors[i];
        const origin_t *const its = &config->words[i].origin;
        sensor->settings = from->reader;
        if (!options_suit(sensor_tables, &from->given, &sensor, 1, true, its) ||
            !results_finish(&from->results, from->reader.period_us, its))
            return false;
        results_config_copy(&sensor->processing, &from->results);
        add_text(config, sensor, from, site->lines);
    }
    site->reconnect = true;
    site->persists = true;
    return true;
}

/* ---- all of it ---- */

static bool read_file(config_t *config, site_t *site)
{
    const yaml_node_t *const top = yaml_document_get_root_node(&config->document);
    publish_settings_t *const settings = &config->top.settings;
    option_given_t given = {{0}};
    if (top == NULL) return reject(&config->origin, "the file is empty. It takes at least broker and lines.");
    *settings = (publish_settings_t){.prefix = "fathom",
                                     .discovery = "homeassistant",
                                     .broker.keep_alive_s = 30,
                                     .queue_messages = 10000,
                                     .queue_bytes = 4194304};
    config->top.reader.period_us = 1000000;
    if (!read_map(config, top, top_tables, &config->top, NULL, &given) || !set_site(config, top))
        return false;
    if (strcmp(settings->discovery, "off") == 0) settings->discovery[0] = '\0';
    return set_broker(config, top) && read_sensors(config, site);
}

bool config_load(publish_settings_t *settings, site_t *site, const char *command, const char *path)
{
    const origin_t origin = {.command = command};
    if (strlen(path) >= sizeof settings->path) return reject(&origin, "the path of the file is too long.");
    FILE *const stream = fopen(path, "rb");
    if (stream == NULL) return reject(&origin, "cannot read %s: %s.", path, strerror(errno));
    config_t *const config = allocate(sizeof *config);
    config->origin = (origin_t){.command = command, .file = path, .line = 1};
    const bool is_good = parse_file(config, stream) && read_file(config, site);
    if (!is_good) site_free(site);
    *settings = config->top.settings;
    (void)snprintf(settings->path, sizeof settings->path, "%s", path);
    yaml_document_delete(&config->document);
    (void)fclose(stream);
    free(config);
    return is_good;
}
