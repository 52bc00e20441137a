/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): explicit_bzero */
#include <errno.h>
#include <netdb.h>
#include <stdarg.h>
#include <string.h>

#include "mqtt/broker.h"

enum { PASSWORD = 1024 };

void broker_explain(broker_t *broker, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(broker->reason, sizeof broker->reason, format, arguments);
    va_end(arguments);
}

static const char *or_null(const char *text) { return text[0] != '\0' ? text : NULL; }

static bool set_tls(broker_t *broker, struct mosquitto *mosq)
{
    const broker_settings_t *const settings = broker->settings;
    char reason[BROKER_TEXT / 2];
    if (!settings->has_tls || tls_set(mosq, settings, &broker->tls_error, reason, sizeof reason)) return true;
    broker_explain(broker, "%s:%u: tls: %s", broker->file, settings->tls_line, reason);
    return false;
}

struct mosquitto *broker_client(broker_t *broker)
{
    static const char offline[] = "offline";
    struct mosquitto *const mosq = mosquitto_new(broker->settings->client_id, true, broker);
    if (mosq == NULL) {
        broker_explain(broker, "no client can be made: %s", strerror(errno));
        return NULL;
    }
    (void)mosquitto_int_option(mosq, MOSQ_OPT_TCP_NODELAY, 1);
    const int result = mosquitto_will_set(mosq, broker->will, sizeof offline - 1, offline, 1, true);
    if (result != MOSQ_ERR_SUCCESS)
        broker_explain(broker, "%s: %s", broker->will, mosquitto_strerror(result));
    if (result == MOSQ_ERR_SUCCESS && set_tls(broker, mosq)) return mosq;
    mosquitto_destroy(mosq);
    return NULL;
}

bool broker_login(broker_t *broker)
{
    const broker_settings_t *const settings = broker->settings;
    char password[PASSWORD] = "";
    const char *const path = or_null(settings->password_file);
    if (settings->user[0] == '\0') return true;
    FILE *const file = path != NULL ? fopen(path, "r") : NULL;
    if (path != NULL && file == NULL) {
        broker_explain(broker, "%s cannot be read: %s", path, strerror(errno));
        return false;
    }
    if (file != NULL) {
        (void)setvbuf(file, NULL, _IONBF, 0); /* no other memory keeps the password */
        if (fgets(password, sizeof password, file) == NULL) password[0] = '\0';
        password[strcspn(password, "\r\n")] = '\0';
        (void)fclose(file);
    }
    const int result =
        mosquitto_username_pw_set(broker->mosq, settings->user, path != NULL ? password : NULL);
    explicit_bzero(password, sizeof password);
    if (result == MOSQ_ERR_SUCCESS) return true;
    broker_explain(broker, "%s", mosquitto_strerror(result));
    return false;
}

/* ---- reasons ---- */

static void explain_tls(broker_t *broker)
{
    const broker_settings_t *const settings = broker->settings;
    const char *const reason = tls_reason(broker->tls_error);
    if (reason[0] != '\0')
        broker_explain(
            broker,
            "%s:%u: tls: its certificate is not accepted: %s; the broker needs another one, or ca-file: "
            "the authority "
            "that has signed it, or host: the name that it is for",
            broker->file, settings->tls_line, reason);
    else
        broker_explain(broker, "%s:%u: tls: no secure connection: %s", broker->file, settings->tls_line,
                       broker->log[0] != '\0' ? broker->log
                                              : "the broker has ended it; does this port speak TLS?");
}

void broker_explain_result(broker_t *broker, int result, int error)
{
    if (result == MOSQ_ERR_EAI)
        broker_explain(broker, "its name is not known: %s", gai_strerror(error));
    else if (result == MOSQ_ERR_TLS || (broker->phase == BROKER_GREETING && broker->settings->has_tls))
        explain_tls(broker);
    else if (result == MOSQ_ERR_ERRNO)
        broker_explain(broker, "%s", strerror(error));
    else if (result == MOSQ_ERR_CONN_LOST && broker->phase == BROKER_GREETING)
        broker_explain(broker, "it ends the connection at once%s",
                       broker->settings->has_tls ? "" : "; does this port want tls: ?");
    else if (result == MOSQ_ERR_CONN_LOST)
        broker_explain(broker, "the connection is lost");
    else
        broker_explain(broker, "%s", mosquitto_strerror(result));
}

void broker_explain_refusal(broker_t *broker, int code)
{
    const broker_settings_t *const settings = broker->settings;
    if (code != 4 && code != 5)
        broker_explain(broker, "it refuses the client %s: %s", settings->client_id,
                       mosquitto_connack_string(code));
    else if (settings->user[0] == '\0')
        broker_explain(broker, "%s:%u: it refuses a client without a name; write user: and password-file:",
                       broker->file, settings->line);
    else
        broker_explain(
            broker,
            "%s:%u: it refuses the user %s with the password of %s; mend that, or the broker's password file",
            broker->file, settings->line, settings->user,
            settings->password_file[0] != '\0' ? settings->password_file
                                               : "no file, since password-file: is missing");
}
