/* SPDX-License-Identifier: MIT */
#include "mqtt/broker.h"

/* Without OpenSSL's headers libmosquitto's own settings, and its own words, have to do. */

static const char authorities[] = "/etc/ssl/certs";

static const char *or_null(const char *text) { return text[0] != '\0' ? text : NULL; }

/* NOLINTNEXTLINE(readability-non-const-parameter): tls.c writes it */
bool tls_set(struct mosquitto *mosq, const broker_config_t *config, int *error, char *reason, size_t capacity)
{
    const char *const ca_file = or_null(config->ca_file);
    const int result = mosquitto_tls_set(mosq, ca_file, ca_file == NULL ? authorities : NULL,
                                         or_null(config->certificate_file), or_null(config->key_file), NULL);
    (void)error;
    (void)snprintf(reason, capacity, "%s",
                   result == MOSQ_ERR_INVAL ? "one of the files cannot be read" : mosquitto_strerror(result));
    return result == MOSQ_ERR_SUCCESS;
}

const char *tls_reason(int error)
{
    (void)error;
    return "";
}
