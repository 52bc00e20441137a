/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): gethostname */
#include "cli/config.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/command.h"
#include "cli/options.h"

enum {
    PORT = 1883,
    PORT_WITH_TLS = 8883,
    KEEP_ALIVE_S = 30,
    MAX_KEEP_ALIVE_S = 3600,
    MESSAGES = 10000,
    MAX_MESSAGES = 1000000,
    BYTES = 4194304,
    MIN_BYTES = 4096,
    MAX_BYTES = 1073741824
};

/* What is being read. */
typedef struct {
    publish_settings_t *config;
    config_file_t *file;
    const char *command;
} reading_t;

/* The text of a key, NULL where it is not there; what is wrong with it stands there. */
static const char *text_of(const reading_t *reading, const config_values_t *values, config_key_t key)
{
    if (values->at[key] == NULL) return NULL;
    config_file_at(reading->file, values->at[key]);
    return config_file_text(values->at[key]);
}

static bool refuse(const reading_t *reading, config_key_t key, const char *value)
{
    (void)usage_error(reading->command, "%s: takes %s; not '%.60s'%s", config_rows[key].name,
                      config_rows[key].takes, value, strlen(value) > 60 ? ", and so on" : "");
    return false;
}

static bool take_number(const reading_t *reading, const config_values_t *values, config_key_t key,
                        uint32_t min, uint32_t max, uint32_t *number)
{
    const char *const text = text_of(reading, values, key);
    return text == NULL || number_parse(text, min, max, number) || refuse(reading, key, text);
}

/* ---- names ---- */

bool config_name(char text[SETTINGS_NAME], const char *value, bool slashes)
{
    static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_./";
    const size_t length = strlen(value);
    if (length == 0 || length >= SETTINGS_NAME || strspn(value, letters) != length) return false;
    if (value[0] == '/' || value[length - 1] == '/' || strstr(value, "//") != NULL) return false;
    if (!slashes && strpbrk(value, "/.") != NULL) return false;
    memcpy(text, value, length + 1);
    return true;
}

static bool take_site(const reading_t *reading, const config_values_t *values)
{
    char *const site = reading->config->site;
    char host[SETTINGS_NAME] = "";
    const char *const text = text_of(reading, values, CONFIG_SITE);
    if (text != NULL) return config_name(site, text, true) || refuse(reading, CONFIG_SITE, text);
    if (gethostname(host, sizeof host - 1) == 0 && config_name(site, host, false)) return true;
    if (config_name(site, host, true)) return true;
    (void)usage_error(reading->command,
                      "site: is missing, and the host's name '%s' cannot stand for it; it takes %s", host,
                      config_rows[CONFIG_SITE].takes);
    return false;
}

static bool take_names(const reading_t *reading, const config_values_t *values)
{
    publish_settings_t *const config = reading->config;
    const char *const prefix = text_of(reading, values, CONFIG_PREFIX);
    if (!config_name(config->prefix, prefix != NULL ? prefix : "fathom", true))
        return refuse(reading, CONFIG_PREFIX, prefix);
    const char *const discovery = text_of(reading, values, CONFIG_DISCOVERY);
    const bool is_off = discovery != NULL && strcmp(discovery, "off") == 0;
    if (!is_off && !config_name(config->discovery, discovery != NULL ? discovery : "homeassistant", true))
        return refuse(reading, CONFIG_DISCOVERY, discovery);
    return take_site(reading, values);
}

/* ---- the broker ---- */

/* A path, of a file that can be read. Without a value it stays "". */
static bool take_file(const reading_t *reading, const config_values_t *values, config_key_t key,
                      char path[SETTINGS_PATH])
{
    const char *const text = text_of(reading, values, key);
    if (text == NULL) return true;
    if (strlen(text) >= SETTINGS_PATH) return refuse(reading, key, text);
    memcpy(path, text, strlen(text) + 1);
    if (access(path, R_OK) == 0) return true;
    (void)usage_error(reading->command, "%s: %s cannot be read: %s", config_rows[key].name, path,
                      strerror(errno));
    return false;
}

static bool take_tls(const reading_t *reading, const yaml_node_t *map)
{
    broker_settings_t *const broker = &reading->config->broker;
    config_values_t values;
    broker->has_tls = map != NULL;
    if (map == NULL) return true;
    if (!config_take(reading->file, reading->command, map, SECTION_TLS, &values) ||
        !take_file(reading, &values, TLS_CA_FILE, broker->ca_file) ||
        !take_file(reading, &values, TLS_CERTIFICATE_FILE, broker->certificate_file) ||
        !take_file(reading, &values, TLS_KEY_FILE, broker->key_file))
        return false;
    broker->tls_line = config_file_line(values.at[TLS_CA_FILE] != NULL ? values.at[TLS_CA_FILE] : map);
    if ((broker->certificate_file[0] != '\0') == (broker->key_file[0] != '\0')) return true;
    config_file_at(reading->file, map);
    (void)usage_error(reading->command,
                      "certificate-file: and key-file: belong together; one of them is missing");
    return false;
}

/* systemd hands credentials over as files of a folder that it names. */
static bool take_credential(const reading_t *reading, const config_values_t *values)
{
    broker_settings_t *const broker = &reading->config->broker;
    char name[SETTINGS_NAME];
    const char *const text = text_of(reading, values, BROKER_PASSWORD_CREDENTIAL);
    const char *const folder =
        getenv("CREDENTIALS_DIRECTORY"); /* NOLINT(concurrency-mt-unsafe): one thread */
    if (text == NULL) return true;
    if (!config_name(name, text, true) || strchr(name, '/') != NULL || name[0] == '.')
        return refuse(reading, BROKER_PASSWORD_CREDENTIAL, text);
    if (values->at[BROKER_PASSWORD_FILE] != NULL)
        (void)usage_error(reading->command,
                          "password-credential: and password-file: say the same; leave one of them out");
    else if (folder == NULL)
        (void)usage_error(reading->command,
                          "password-credential: no CREDENTIALS_DIRECTORY is set; the unit needs a line "
                          "LoadCredential=%s:/path/to/the/password, or write password-file: here",
                          name);
    else if (snprintf(broker->password_file, SETTINGS_PATH, "%s/%s", folder, name) < SETTINGS_PATH &&
             access(broker->password_file, R_OK) == 0)
        return true;
    else
        (void)usage_error(reading->command,
                          "password-credential: %s cannot be read: %s; the unit needs a line "
                          "LoadCredential=%s:/path/to/the/password",
                          broker->password_file, strerror(errno), name);
    return false;
}

static bool take_login(const reading_t *reading, const config_values_t *values)
{
    broker_settings_t *const broker = &reading->config->broker;
    const char *const user = text_of(reading, values, BROKER_USER);
    if (user != NULL && strlen(user) >= sizeof broker->user) return refuse(reading, BROKER_USER, user);
    if (user != NULL) memcpy(broker->user, user, strlen(user) + 1);
    if (!take_file(reading, values, BROKER_PASSWORD_FILE, broker->password_file) ||
        !take_credential(reading, values))
        return false;
    if (broker->password_file[0] == '\0' || user != NULL) return true;
    (void)usage_error(reading->command, "a password stands here, and no user: beside it");
    return false;
}

/* One broker knows a client by its id: two with the same one would end each other's connection for ever. */
static bool take_client_id(const reading_t *reading, const config_values_t *values)
{
    const publish_settings_t *const config = reading->config;
    char *const id = reading->config->broker.client_id;
    const char *const text = text_of(reading, values, BROKER_CLIENT_ID);
    if (text != NULL) return config_name(id, text, false) || refuse(reading, BROKER_CLIENT_ID, text);
    (void)snprintf(id, SETTINGS_NAME, "%.49s-%.49s", config->prefix, config->site);
    for (char *at = id; *at != '\0'; at++)
        if (*at == '/' || *at == '.') *at = '-';
    return true;
}

static bool take_broker(const reading_t *reading, const yaml_node_t *map)
{
    broker_settings_t *const broker = &reading->config->broker;
    config_values_t values;
    uint32_t keep_alive_s = KEEP_ALIVE_S;
    if (!config_take(reading->file, reading->command, map, SECTION_BROKER, &values)) return false;
    const char *const host = text_of(reading, &values, BROKER_HOST);
    if (strlen(host) >= sizeof broker->host || strpbrk(host, " /@") != NULL)
        return refuse(reading, BROKER_HOST, host);
    memcpy(broker->host, host, strlen(host) + 1);
    uint32_t port = values.at[BROKER_TLS] != NULL ? PORT_WITH_TLS : PORT;
    if (!take_number(reading, &values, BROKER_PORT, 1, UINT16_MAX, &port) ||
        !take_number(reading, &values, BROKER_KEEP_ALIVE, 5, MAX_KEEP_ALIVE_S, &keep_alive_s) ||
        !take_client_id(reading, &values) || !take_login(reading, &values) ||
        !take_tls(reading, values.at[BROKER_TLS]))
        return false;
    broker->port = (uint16_t)port;
    broker->keep_alive_s = (uint16_t)keep_alive_s;
    broker->line = config_file_line(values.at[values.at[BROKER_USER] != NULL ? BROKER_USER : BROKER_HOST]);
    return true;
}

/* ---- all of it ---- */

static bool take_queue(const reading_t *reading, const yaml_node_t *map)
{
    publish_settings_t *const config = reading->config;
    config_values_t values;
    config->queue_messages = MESSAGES;
    config->queue_bytes = BYTES;
    return map == NULL ||
           (config_take(reading->file, reading->command, map, SECTION_QUEUE, &values) &&
            take_number(reading, &values, QUEUE_MESSAGES, 1, MAX_MESSAGES, &config->queue_messages) &&
            take_number(reading, &values, QUEUE_BYTES, MIN_BYTES, MAX_BYTES, &config->queue_bytes));
}

static bool take_all(const reading_t *reading, site_t *site)
{
    config_values_t values;
    const yaml_node_t *const top = config_file_top(reading->file);
    if (top == NULL) {
        (void)usage_error(reading->command,
                          "%s is empty; it takes at least broker: and lines:", reading->file->path);
        return false;
    }
    return config_take(reading->file, reading->command, top, SECTION_TOP, &values) &&
           take_names(reading, &values) && take_broker(reading, values.at[CONFIG_BROKER]) &&
           take_queue(reading, values.at[CONFIG_QUEUE]) &&
           config_sensors(site, reading->file, reading->command, &values);
}

bool config_load(publish_settings_t *settings, site_t *site, const char *command, const char *path)
{
    config_file_t file;
    const reading_t reading = {settings, &file, command};
    memset(settings, 0, sizeof *settings);
    if (strlen(path) >= sizeof settings->path) {
        (void)usage_error(command, "the path of the file is too long");
        return false;
    }
    memcpy(settings->path, path, strlen(path) + 1);
    if (!config_file_load(&file, command, path)) return false;
    const bool is_good = take_all(&reading, site);
    usage_at(NULL);
    config_file_free(&file);
    if (!is_good) site_free(site);
    return is_good;
}
