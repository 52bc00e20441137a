/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): explicit_bzero, getentropy */
#include "mqtt/broker.h"

#include <errno.h>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "mqtt/topics.h"
#include "output/words.h"

enum {
    FIRST_PAUSE_US = 500000,
    LONGEST_PAUSE_US = 60000000,
    STEADY_US = 10000000,
    /* Each of two clients with the same id lasts for the pause of the other one. */
    STEADY_CONTESTED_US = 2 * LONGEST_PAUSE_US,
    CLOSES = 2,
    GREETING_US = 20000000,
    LOOK_US = 1000000,
    READS = 16,
    QOS = 1
};

static uint64_t now_us(const broker_t *broker) { return broker->host->now_us(broker->host->ctx); }

/* ---- what is wrong ---- */

static bool is_contested(const broker_t *broker) { return broker->closes >= CLOSES; }

/* Ends the attempt or the connection. The first reason counts. */
__attribute__((format(printf, 2, 3))) static void lose(broker_t *broker, const char *format, ...)
{
    va_list arguments;
    if (broker->phase == BROKER_LOST) return;
    va_start(arguments, format);
    (void)vsnprintf(broker->reason, sizeof broker->reason, format, arguments);
    va_end(arguments);
    /* If the broker accepts the client and closes the connection again, as with two clients of the same id, the pauses grow
     * too. */
    if (broker->phase == BROKER_READY && now_us(broker) >= broker->until_us) broker->pause_us = 0;
    broker->phase = BROKER_LOST;
    broker->closes = 0;
}

/* The broker closed the connection after it accepted the client. */
static void lose_closed(broker_t *broker)
{
    const publish_settings_t *const settings = &broker->settings;
    const broker_settings_t *const its = &settings->broker;
    const bool has_id = its->id_line != 0;
    const bool has_site = settings->site_line != 0;
    const bool is_steady = broker->phase == BROKER_READY && now_us(broker) >= broker->until_us;
    const unsigned closes = is_steady ? 0 : broker->closes + 1;
    if (closes < CLOSES)
        lose(broker, "the connection is lost");
    else
        lose(
            broker,
            "%s:%u: it accepts the client %s and soon closes the connection, again and again. Another client "
            "probably has the same %s",
            settings->path,
            has_id     ? its->id_line
            : has_site ? settings->site_line
                       : its->line,
            its->client_id,
            has_id     ? "client-id; write another one"
            : has_site ? "site, from which this id is made; each computer needs its own"
                       : "host name, from which this id is made; rename one of the hosts, or write site:");
    broker->closes = closes;
}

static void lose_tls(broker_t *broker)
{
    const char *const path = broker->settings.path;
    const unsigned line = broker->settings.broker.tls_line;
    if (broker->tls.error != 0)
        lose(broker, "%s:%u: tls: its certificate is not accepted: %s", path, line, broker->tls.text);
    else
        lose(broker, "%s:%u: tls: no secure connection: %s", path, line,
             broker->log[0] != '\0' ? broker->log : "the broker has ended it; does this port speak TLS?");
}

/* Of a result of libmosquitto, and errno. Returns true if all is well. */
static bool check(broker_t *broker, int result, int error)
{
    const bool is_greeting = broker->phase != BROKER_ACCEPTED && broker->phase != BROKER_READY;
    const bool is_closed = result == MOSQ_ERR_CONN_LOST || result == MOSQ_ERR_TLS ||
                           (result == MOSQ_ERR_ERRNO && (error == ECONNRESET || error == EPIPE));
    if (result == MOSQ_ERR_SUCCESS) return true;
    if (result == MOSQ_ERR_EAI)
        lose(broker, "its name is not known: %s", gai_strerror(error));
    else if (is_closed && !is_greeting)
        lose_closed(broker);
    else if (result == MOSQ_ERR_TLS || (is_greeting && broker->settings.broker.has_tls))
        lose_tls(broker);
    else if (result == MOSQ_ERR_ERRNO)
        lose(broker, "%s", strerror(error));
    else if (result == MOSQ_ERR_CONN_LOST)
        lose(broker, "it closes the connection at once; does this port need tls: ?");
    else
        lose(broker, "%s", mosquitto_strerror(result));
    return false;
}

/* Of the return code of MQTT 3.1.1 with which the broker refused the client. 4 and 5 are about the login. */
static void lose_refused(broker_t *broker, int code)
{
    const broker_settings_t *const settings = &broker->settings.broker;
    if (code != 4 && code != 5)
        lose(broker, "it refuses the client %s: %s", settings->client_id, mosquitto_connack_string(code));
    else if (settings->user[0] == '\0')
        lose(broker, "%s:%u: it refuses a client without a name; write user: and password-file:",
             broker->settings.path, settings->line);
    else
        lose(broker,
             "%s:%u: it refuses the user %s with the password of %s; mend that, or the broker's password "
             "file",
             broker->settings.path, settings->line, settings->user,
             settings->password_file[0] != '\0' ? settings->password_file
                                                : "no file, since password-file: is missing");
}

/* ---- callbacks of libmosquitto ---- */

static void on_connect(struct mosquitto *mosq, void *ctx, int code)
{
    broker_t *const broker = ctx;
    (void)mosq;
    if (code == 0)
        broker->phase = BROKER_ACCEPTED;
    else
        lose_refused(broker, code);
}

static void forget(broker_t *broker, broker_sent_t **at)
{
    broker_sent_t *const sent = *at;
    *at = sent->next;
    broker->sent_count--;
    free(sent);
}

static void on_publish(struct mosquitto *mosq, void *ctx, int number)
{
    broker_t *const broker = ctx;
    broker_sent_t **at = &broker->sent;
    (void)mosq;
    while (*at != NULL && (*at)->number != number) at = &(*at)->next;
    if (*at != NULL) forget(broker, at);
}

/* The payload has no NUL at its end. */
static void on_message(struct mosquitto *mosq, void *ctx, const struct mosquitto_message *message)
{
    const broker_t *const broker = ctx;
    char *const payload = allocate((size_t)message->payloadlen + 1);
    (void)mosq;
    if (message->payloadlen != 0) memcpy(payload, message->payload, (size_t)message->payloadlen);
    broker->received(broker->received_ctx, message->topic, payload, message->retain);
    free(payload);
}

static void on_log(struct mosquitto *mosq, void *ctx, int level, const char *text)
{
    broker_t *const broker = ctx;
    (void)mosq;
    if (level == MOSQ_LOG_ERR && broker->log[0] == '\0')
        (void)snprintf(broker->log, sizeof broker->log, "%.*s", (int)strcspn(text, "\n"), text);
}

/* ---- the socket ---- */

static int socket_fd(const fathom_loop_source_t *source) { return ((const broker_t *)source)->fd; }

static short socket_events(const fathom_loop_source_t *source)
{
    return mosquitto_want_write(((const broker_t *)source)->mosq) ? POLLIN | POLLOUT : POLLIN;
}

/* Reads up to READS packets. The loop reports each event once, so broker_tick() has the rest read. */
static void read_next(broker_t *broker)
{
    broker->has_more = true;
    for (unsigned turn = 0; turn != READS && broker->has_more && broker->phase != BROKER_LOST; turn++) {
        errno = 0;
        const int result = mosquitto_loop_read(broker->mosq, 1);
        broker->has_more = errno != EAGAIN && errno != EWOULDBLOCK;
        (void)check(broker, result, errno);
    }
}

static bool poll_socket(fathom_loop_source_t *source)
{
    broker_t *const broker = (broker_t *)source;
    if (source->is_readable) read_next(broker);
    if (broker->phase != BROKER_LOST && mosquitto_want_write(broker->mosq)) {
        const int result = mosquitto_loop_write(broker->mosq, 1);
        (void)check(broker, result, errno);
    }
    /* libmosquitto does not notice that the broker ended a TLS handshake. */
    if (broker->phase == BROKER_GREETING && source->is_hung_up) (void)check(broker, MOSQ_ERR_CONN_LOST, 0);
    return true;
}

/* A duplicate of libmosquitto's descriptor, which may be closed at any time while the loop waits for it. */
static bool add_socket(broker_t *broker)
{
    static const fathom_loop_kind_t kind = {.fd = socket_fd, .events = socket_events, .poll = poll_socket};
    broker->fd = fcntl(mosquitto_socket(broker->mosq), F_DUPFD_CLOEXEC, 0);
    if (broker->fd < 0) return false;
    broker->source = (fathom_loop_source_t){.kind = &kind};
    fathom_loop_add(broker->loop, &broker->source);
    return true;
}

static void disconnect(broker_t *broker)
{
    if (broker->phase == BROKER_ACCEPTED || broker->phase == BROKER_READY)
        (void)mosquitto_disconnect(broker->mosq);
    if (broker->source.loop == NULL) return;
    fathom_loop_remove(&broker->source);
    (void)shutdown(broker->fd, SHUT_RDWR);
    (void)close(broker->fd);
}

/* ---- messages ---- */

/* Returns false if libmosquitto does not accept the message. Accepted messages it sends, and repeats, itself. */
static bool submit(broker_t *broker, broker_sent_t *sent)
{
    const int result = mosquitto_publish(broker->mosq, &sent->number, sent->topic, (int)strlen(sent->payload),
                                         sent->payload, QOS, sent->is_retained);
    return result != MOSQ_ERR_INVAL && result != MOSQ_ERR_NOMEM && result != MOSQ_ERR_PAYLOAD_SIZE &&
           result != MOSQ_ERR_MALFORMED_UTF8;
}

bool broker_send(broker_t *broker, const char *topic, const char *payload, bool is_retained)
{
    broker_sent_t *const sent = allocate(sizeof *sent + strlen(payload) + 1);
    broker_sent_t **end = &broker->sent;
    sent->topic = topic;
    sent->is_retained = is_retained;
    (void)strcpy(sent->payload, payload);
    if (!submit(broker, sent)) {
        free(sent);
        return false;
    }
    while (*end != NULL) end = &(*end)->next;
    *end = sent;
    broker->sent_count++;
    if (mosquitto_want_write(broker->mosq)) fathom_loop_wake(&broker->source);
    return true;
}

void broker_subscribe(broker_t *broker, const char *filter, bool is_wanted)
{
    if (is_wanted)
        (void)mosquitto_subscribe(broker->mosq, NULL, filter, 0);
    else
        (void)mosquitto_unsubscribe(broker->mosq, NULL, filter);
}

void broker_hold(broker_t *broker, bool is_held)
{
    const int value = is_held;
    if (broker->phase == BROKER_READY)
        (void)setsockopt(broker->fd, IPPROTO_TCP, TCP_CORK, &value, sizeof value);
}

static void start_sending(broker_t *broker)
{
    for (broker_sent_t *sent = broker->sent; sent != NULL; sent = sent->next)
        if (sent->number == 0) (void)submit(broker, sent);
    broker->phase = BROKER_READY;
    broker->until_us = now_us(broker) + (is_contested(broker) ? STEADY_CONTESTED_US : STEADY_US);
    broker->greetings++;
    broker->is_new = true;
}

/* A contested connection is not reported before it is steady. */
static void report_connected(broker_t *broker)
{
    const broker_settings_t *const settings = &broker->settings.broker;
    if (now_us(broker) >= broker->until_us) broker->closes = 0;
    if (!broker->is_new || is_contested(broker)) return;
    broker->is_new = false;
    broker->reported[0] = '\0';
    (void)fprintf(stderr, "fathom: broker %s port %u: connected.\n", settings->host, settings->port);
}

/* ---- the client ---- */

/* Sets the user and the password, which is read from its file each time. */
static void set_login(broker_t *broker)
{
    const broker_settings_t *const settings = &broker->settings.broker;
    const char *const path = settings->password_file;
    char password[1024] = "";
    if (settings->user[0] == '\0') return;
    if (path[0] != '\0') {
        FILE *const file = fopen(path, "r");
        if (file == NULL) {
            lose(broker, "%s cannot be read: %s", path, strerror(errno));
            return;
        }
        (void)setvbuf(file, NULL, _IONBF, 0); /* no other memory keeps the password */
        if (fgets(password, sizeof password, file) == NULL) password[0] = '\0';
        password[strcspn(password, "\r\n")] = '\0';
        (void)fclose(file);
    }
    const int result =
        mosquitto_username_pw_set(broker->mosq, settings->user, path[0] != '\0' ? password : NULL);
    explicit_bzero(password, sizeof password);
    (void)check(broker, result, errno);
}

static void end_client(broker_t *broker)
{
    if (broker->mosq != NULL) mosquitto_destroy(broker->mosq);
    broker->mosq = NULL;
    broker->has_changed = false;
    for (broker_sent_t *sent = broker->sent; sent != NULL; sent = sent->next) sent->number = 0;
}

static void make_client(broker_t *broker)
{
    static const char offline[] = "offline";
    const broker_settings_t *const settings = &broker->settings.broker;
    char will[TOPIC_NAME];
    char reason[BROKER_TEXT / 2];
    end_client(broker);
    broker->mosq = mosquitto_new(settings->client_id, true, broker);
    if (broker->mosq == NULL) end_without_memory();
    mosquitto_connect_callback_set(broker->mosq, on_connect);
    mosquitto_publish_callback_set(broker->mosq, on_publish);
    mosquitto_message_callback_set(broker->mosq, on_message);
    mosquitto_log_callback_set(broker->mosq, on_log);
    (void)mosquitto_int_option(broker->mosq, MOSQ_OPT_TCP_NODELAY, 1);
    topic_name(&broker->settings, TOPIC_STATUS, NULL, 0, will);
    (void)mosquitto_will_set(broker->mosq, will, sizeof offline - 1, offline, QOS, true);
    if (!settings->has_tls || tls_set(broker->mosq, settings, &broker->tls, reason, sizeof reason)) return;
    lose(broker, "%s:%u: tls: %s", broker->settings.path, settings->tls_line, reason);
    end_client(broker);
}

/* ---- connecting ---- */

static void *connect_in_thread(void *ctx)
{
    broker_t *const broker = ctx;
    const broker_settings_t *const settings = &broker->settings.broker;
    errno = 0;
    broker->connect_result =
        mosquitto_connect(broker->mosq, settings->host, settings->port, settings->keep_alive_s);
    broker->connect_errno = errno;
    __atomic_store_n(&broker->thread_has_ended, true, __ATOMIC_RELEASE);
    fathom_loop_stop(broker->loop); /* ends its sleep */
    return NULL;
}

static void start_connecting(broker_t *broker)
{
    sigset_t all;
    sigset_t before;
    broker->settings = *broker->wanted;
    broker->log[0] = '\0';
    broker->tls.error = 0;
    if (broker->mosq == NULL || broker->has_changed) make_client(broker);
    if (broker->phase != BROKER_LOST) set_login(broker);
    if (broker->phase == BROKER_LOST) return;
    broker->phase = BROKER_CONNECTING;
    __atomic_store_n(&broker->thread_has_ended, false, __ATOMIC_RELEASE);
    /* Signals must reach the thread that sleeps. */
    (void)sigfillset(&all);
    (void)pthread_sigmask(SIG_SETMASK, &all, &before);
    const int error = pthread_create(&broker->thread, NULL, connect_in_thread, broker);
    (void)pthread_sigmask(SIG_SETMASK, &before, NULL);
    if (error != 0) lose(broker, "%s", strerror(error));
}

static void end_connecting(broker_t *broker)
{
    (void)pthread_join(broker->thread, NULL);
    if (broker->has_changed) {
        start_connecting(broker);
        return;
    }
    broker->phase = BROKER_GREETING;
    broker->until_us = now_us(broker) + GREETING_US;
    if (check(broker, broker->connect_result, broker->connect_errno) && !add_socket(broker))
        lose(broker, "%s", strerror(errno));
}

static bool is_yielding(const broker_t *broker) { return is_contested(broker) && broker->yields; }

/* The pause is shortened by up to a half, so that the clients of a broker that is back do not connect all at once. After the first quick close there is none:
 * a broker that was restarted does not accept a client at once, and one that accepted another client does. */
static void pause_connecting(broker_t *broker)
{
    const broker_settings_t *const settings = &broker->settings.broker;
    uint32_t random = 0;
    disconnect(broker);
    broker->phase = BROKER_PAUSE;
    broker->until_us = now_us(broker);
    if (broker->closes != 1) {
        broker->pause_us = broker->pause_us == 0 ? FIRST_PAUSE_US : broker->pause_us * 2;
        if (broker->pause_us > LONGEST_PAUSE_US) broker->pause_us = LONGEST_PAUSE_US;
        if (getentropy(&random, sizeof random) != 0) random = 0;
        broker->until_us += broker->pause_us - ((uint64_t)random * (broker->pause_us / 2) >> 32);
    }
    if (strcmp(broker->reported, broker->reason) == 0) return;
    (void)strcpy(broker->reported, broker->reason);
    (void)fprintf(stderr, "fathom: broker %s port %u: %s; it is tried again %s.\n", settings->host,
                  settings->port, broker->reason,
                  is_yielding(broker) ? "when a sensor responds" : "and again");
}

uint32_t broker_tick(broker_t *broker)
{
    const uint64_t now = now_us(broker);
    if (broker->phase == BROKER_PAUSE && now >= broker->until_us && !is_yielding(broker))
        start_connecting(broker);
    if (broker->phase == BROKER_CONNECTING && __atomic_load_n(&broker->thread_has_ended, __ATOMIC_ACQUIRE))
        end_connecting(broker);
    if (broker->phase == BROKER_GREETING && now > broker->until_us)
        lose(broker, "it accepts the connection and does not respond; is it an MQTT broker?");
    if (broker->phase == BROKER_ACCEPTED) start_sending(broker);
    if (broker->phase == BROKER_READY && broker->has_more) fathom_loop_wake(&broker->source);
    if (broker->phase == BROKER_READY) {
        const int result = mosquitto_loop_misc(broker->mosq); /* the keep-alive */
        if (check(broker, result, errno)) report_connected(broker);
    }
    if (broker->phase == BROKER_LOST) pause_connecting(broker);
    if (broker->phase == BROKER_PAUSE && !is_yielding(broker))
        return broker->until_us > now ? (uint32_t)(broker->until_us - now) : 0;
    return LOOK_US;
}

/* ---- start and end ---- */

void broker_begin(broker_t *broker, const host_t *host, fathom_loop_t *loop,
                  const publish_settings_t *settings, broker_received_t *received, void *ctx)
{
    memset(broker, 0, sizeof *broker);
    broker->host = host;
    broker->loop = loop;
    broker->wanted = settings;
    broker->received = received;
    broker->received_ctx = ctx;
    (void)mosquitto_lib_init();
}

bool broker_is_free(const broker_t *broker)
{
    return broker->phase == BROKER_READY && broker->sent_count < BROKER_WINDOW;
}

void broker_change(broker_t *broker)
{
    broker->has_changed = true;
    broker->reported[0] = '\0';
    if (broker->phase == BROKER_CONNECTING) return;
    broker->phase = BROKER_PAUSE; /* without a farewell, which would be the end of the will */
    disconnect(broker);
    broker->pause_us = 0;
    broker->until_us = 0;
}

bool broker_wait(broker_t *broker, uint32_t max_us)
{
    if (broker->phase != BROKER_READY) return false;
    struct pollfd entry = {broker->fd, socket_events(&broker->source), 0};
    broker->source.is_readable = poll(&entry, 1, (int)(max_us / 1000)) > 0;
    (void)poll_socket(&broker->source);
    return broker->phase == BROKER_READY;
}

void broker_end(broker_t *broker)
{
    if (broker->phase == BROKER_CONNECTING) {
        (void)pthread_detach(broker->thread); /* it may wait for minutes */
        return;
    }
    disconnect(broker);
    end_client(broker);
    while (broker->sent != NULL) forget(broker, &broker->sent);
    (void)mosquitto_lib_cleanup();
}
