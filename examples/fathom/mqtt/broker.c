/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): getentropy */
#include "mqtt/broker.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <poll.h>
#include <signal.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

enum {
    FIRST_PAUSE_US = 500000,
    LONGEST_PAUSE_US = 60000000,
    STEADY_US = 10000000,
    GREETING_US = 20000000,
    LOOK_US = 1000000, /* from one check of the keep-alive to the next */
    READS = 16,
    QOS = 1
};

static uint64_t now_us(const broker_t *broker) { return broker->host->now_us(broker->host->ctx); }

/* ---- callbacks of libmosquitto ---- */

static void on_connect(struct mosquitto *mosq, void *ctx, int code)
{
    broker_t *const broker = ctx;
    (void)mosq;
    if (code == 0) {
        broker->phase = BROKER_READY;
        return;
    }
    broker_explain_refusal(broker, code);
    broker->is_lost = true;
}

/* Returns an unacknowledged message; 0: the oldest one. */
static broker_sent_t *sent_at(broker_t *broker, unsigned number)
{
    return &broker->sent[(broker->first + number) % BROKER_WINDOW];
}

static void on_publish(struct mosquitto *mosq, void *ctx, int number)
{
    broker_t *const broker = ctx;
    (void)mosq;
    for (unsigned i = 0; i != broker->count; i++)
        if (sent_at(broker, i)->number == number) sent_at(broker, i)->is_acknowledged = true;
    while (broker->count != 0 && sent_at(broker, 0)->is_acknowledged) {
        broker->first = (broker->first + 1) % BROKER_WINDOW;
        broker->count--;
    }
}

static void on_log(struct mosquitto *mosq, void *ctx, int level, const char *text)
{
    broker_t *const broker = ctx;
    (void)mosq;
    if (level == MOSQ_LOG_ERR && broker->log[0] == '\0')
        (void)snprintf(broker->log, sizeof broker->log, "%.*s", (int)strcspn(text, "\n"), text);
}

/* ---- the socket ---- */

static broker_t *broker_of(fathom_loop_source_t *source) { return ((broker_source_t *)source)->broker; }

static int source_fd(const fathom_loop_source_t *source) { return ((const broker_source_t *)source)->fd; }

static short socket_events(const fathom_loop_source_t *source)
{
    const broker_t *const broker = ((const broker_source_t *)source)->broker;
    return mosquitto_want_write(broker->mosq) ? POLLIN | POLLOUT : POLLIN;
}

static void check(broker_t *broker, int result)
{
    const int error = errno;
    if (result == MOSQ_ERR_SUCCESS || broker->is_lost) return;
    broker_explain_result(broker, result, error);
    broker->is_lost = true;
}

/* Reads everything that was received, since the loop reports each event once. */
static void read_all(broker_t *broker)
{
    for (unsigned turn = 0; turn != READS && !broker->is_lost; turn++) {
        errno = 0;
        const int result = mosquitto_loop_read(broker->mosq, 1);
        const bool is_all = errno == EAGAIN || errno == EWOULDBLOCK;
        check(broker, result);
        if (is_all) return;
    }
}

/* False: libmosquitto does not accept the message. What it accepted it sends, and repeats, by itself. */
static bool submit(broker_t *broker, broker_sent_t *sent)
{
    const int result = mosquitto_publish(broker->mosq, &sent->number, sent->topic, (int)strlen(sent->payload),
                                         sent->payload, QOS, sent->is_retained);
    return result != MOSQ_ERR_INVAL && result != MOSQ_ERR_NOMEM && result != MOSQ_ERR_PAYLOAD_SIZE &&
           result != MOSQ_ERR_MALFORMED_UTF8;
}

static void start_sending(broker_t *broker)
{
    char text[BROKER_TEXT];
    (void)snprintf(text, sizeof text, "broker %s port %u: connected", broker->settings->host,
                   broker->settings->port);
    if (broker->is_reported) broker->user->print(broker->ctx, text);
    broker->is_reported = false;
    /* A new client does not know the messages of the client before. */
    for (unsigned i = 0; broker->is_new && i != broker->count; i++)
        if (!sent_at(broker, i)->is_acknowledged) (void)submit(broker, sent_at(broker, i));
    broker->is_new = false;
    broker->user->connected(broker->ctx);
}

static bool poll_socket(fathom_loop_source_t *source)
{
    broker_t *const broker = broker_of(source);
    const unsigned count = broker->count;
    const bool was_ready = broker->phase == BROKER_READY;
    if (broker->is_lost) return true;
    if (source->is_readable) read_all(broker);
    if (!broker->is_lost && mosquitto_want_write(broker->mosq)) {
        errno = 0;
        check(broker, mosquitto_loop_write(broker->mosq, 1));
    }
    if (!broker->is_lost) check(broker, mosquitto_loop_misc(broker->mosq));
    /* libmosquitto does not notice that the broker ended a TLS handshake. */
    if (broker->phase == BROKER_GREETING && source->is_hung_up) check(broker, MOSQ_ERR_CONN_LOST);
    if (broker->is_lost) return true;
    if (!was_ready && broker->phase == BROKER_READY) start_sending(broker);
    if (broker->count < count) broker->user->acknowledged(broker->ctx);
    return true;
}

static uint32_t socket_due_us(fathom_loop_source_t *source)
{
    (void)source;
    return LOOK_US;
}

/* A duplicate of libmosquitto's descriptor, which may be closed at any time while the loop waits for it. */
static bool add_socket(broker_t *broker)
{
    static const fathom_loop_kind_t kind = {
        .fd = source_fd, .events = socket_events, .poll = poll_socket, .due_us = socket_due_us};
    const int fd = fcntl(mosquitto_socket(broker->mosq), F_DUPFD_CLOEXEC, 0);
    if (fd < 0) return false;
    broker->socket = (broker_source_t){.source.kind = &kind, .broker = broker, .fd = fd};
    fathom_loop_add(broker->loop, &broker->socket.source);
    return true;
}

static void remove_socket(broker_t *broker)
{
    if (broker->socket.source.loop == NULL) return;
    fathom_loop_remove(&broker->socket.source);
    (void)shutdown(broker->socket.fd, SHUT_RDWR);
    (void)close(broker->socket.fd);
}

/* ---- the thread ---- */

static void *connect_in_thread(void *ctx)
{
    broker_t *const broker = ctx;
    const uint64_t one = 1;
    errno = 0;
    broker->connect_result =
        mosquitto_connect(broker->mosq, broker->connect_host, broker->connect_port, broker->keep_alive_s);
    broker->connect_errno = errno;
    if (write(broker->thread.fd, &one, sizeof one) < 0) broker->connect_errno = errno;
    return NULL;
}

/* Signals must reach the thread that sleeps. */
static int start_thread(broker_t *broker)
{
    sigset_t all;
    sigset_t before;
    (void)sigfillset(&all);
    (void)pthread_sigmask(SIG_SETMASK, &all, &before);
    const int error = pthread_create(&broker->connecting, NULL, connect_in_thread, broker);
    (void)pthread_sigmask(SIG_SETMASK, &before, NULL);
    return error;
}

static bool poll_thread(fathom_loop_source_t *source)
{
    broker_t *const broker = broker_of(source);
    uint64_t count;
    if (read(broker->thread.fd, &count, sizeof count) == (ssize_t)sizeof count)
        broker->thread_has_ended = true;
    return true;
}

/* ---- connecting again ---- */

/* Returns between half and all of it, so that the clients of a broker that is back do not connect all at once. */
static uint32_t part_of(uint32_t pause_us)
{
    uint32_t random = 0;
    if (getentropy(&random, sizeof random) != 0) random = 0;
    return pause_us / 2 + (uint32_t)((uint64_t)random * (pause_us - pause_us / 2) >> 32);
}

static void report_away(broker_t *broker)
{
    char text[2 * BROKER_TEXT];
    if (broker->is_reported && strcmp(broker->reported, broker->reason) == 0) return;
    broker->is_reported = true;
    memcpy(broker->reported, broker->reason, sizeof broker->reported);
    (void)snprintf(text, sizeof text, "broker %s port %u: %s; it is tried again and again",
                   broker->settings->host, broker->settings->port, broker->reason);
    broker->user->print(broker->ctx, text);
}

/* broker->reason says why. */
static void pause_connecting(broker_t *broker)
{
    const bool was_ready = broker->phase == BROKER_READY;
    remove_socket(broker);
    /* A broker that accepts the client and ends the connection again, as with two clients of the same id, gets pauses that
     * grow too. */
    if (was_ready && now_us(broker) - broker->began_us >= STEADY_US) broker->pause_us = 0;
    broker->pause_us = broker->pause_us == 0 ? FIRST_PAUSE_US : broker->pause_us * 2;
    if (broker->pause_us > LONGEST_PAUSE_US) broker->pause_us = LONGEST_PAUSE_US;
    broker->next_us = now_us(broker) + part_of(broker->pause_us);
    broker->phase = BROKER_PAUSE;
    broker->is_lost = false;
    report_away(broker);
}

static void make_client(broker_t *broker)
{
    if (broker->mosq != NULL && !broker->has_changed) return;
    if (broker->mosq != NULL) mosquitto_destroy(broker->mosq);
    broker->is_new = true;
    broker->has_changed = false;
    broker->mosq = broker_client(broker);
    if (broker->mosq == NULL) return;
    mosquitto_connect_callback_set(broker->mosq, on_connect);
    mosquitto_publish_callback_set(broker->mosq, on_publish);
    mosquitto_log_callback_set(broker->mosq, on_log);
}

static void connect_again(broker_t *broker)
{
    const broker_settings_t *const settings = broker->settings;
    (void)snprintf(broker->connect_host, sizeof broker->connect_host, "%s", settings->host);
    broker->connect_port = settings->port;
    broker->keep_alive_s = settings->keep_alive_s;
    broker->reason[0] = broker->log[0] = '\0';
    broker->is_lost = false;
    broker->tls_error = 0;
    broker->began_us = now_us(broker);
    make_client(broker);
    if (broker->mosq == NULL || !broker_login(broker)) {
        pause_connecting(broker);
        return;
    }
    const int error = start_thread(broker);
    broker->phase = BROKER_CONNECTING;
    if (error == 0) return;
    broker_explain(broker, "%s", strerror(error));
    pause_connecting(broker);
}

static void end_connecting(broker_t *broker)
{
    broker->thread_has_ended = false;
    (void)pthread_join(broker->connecting, NULL);
    if (broker->has_changed) {
        connect_again(broker);
        return;
    }
    broker->phase = BROKER_GREETING;
    broker->began_us = now_us(broker);
    if (broker->connect_result != MOSQ_ERR_SUCCESS)
        broker_explain_result(broker, broker->connect_result, broker->connect_errno);
    else if (!add_socket(broker))
        broker_explain(broker, "%s", strerror(errno));
    else
        return;
    pause_connecting(broker);
}

uint32_t broker_tick(broker_t *broker)
{
    const uint64_t now = now_us(broker);
    if (broker->phase == BROKER_PAUSE && now >= broker->next_us) connect_again(broker);
    if (broker->phase == BROKER_CONNECTING && broker->thread_has_ended) end_connecting(broker);
    if (broker->phase == BROKER_GREETING && !broker->is_lost && now > broker->began_us + GREETING_US) {
        broker_explain(broker, "it accepts the connection and does not respond; is it an MQTT broker?");
        broker->is_lost = true;
    }
    if (broker->is_lost) pause_connecting(broker);
    if (broker->phase == BROKER_PAUSE) return broker->next_us > now ? (uint32_t)(broker->next_us - now) : 0;
    return broker->phase == BROKER_GREETING ? LOOK_US : FATHOM_NO_DEADLINE;
}

/* ---- start, send, end ---- */

bool broker_begin(broker_t *broker, const host_t *host, fathom_loop_t *loop,
                  const broker_settings_t *settings, const char *file, const char *will,
                  const broker_user_t *user, void *ctx)
{
    static const fathom_loop_kind_t kind = {.fd = source_fd, .poll = poll_thread};
    memset(broker, 0, sizeof *broker);
    broker->host = host;
    broker->loop = loop;
    broker->settings = settings;
    broker->file = file;
    broker->user = user;
    broker->ctx = ctx;
    (void)snprintf(broker->will, sizeof broker->will, "%s", will);
    broker->thread.fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (broker->thread.fd < 0 || mosquitto_lib_init() != MOSQ_ERR_SUCCESS) {
        user->print(ctx, "the system has no descriptor or no memory left; end other programs");
        return false;
    }
    broker->thread.broker = broker;
    broker->thread.source.kind = &kind;
    fathom_loop_add(loop, &broker->thread.source);
    return true;
}

bool broker_is_connected(const broker_t *broker) { return broker->phase == BROKER_READY && !broker->is_lost; }

bool broker_is_free(const broker_t *broker)
{
    return broker_is_connected(broker) && broker->count != BROKER_WINDOW;
}

bool broker_is_idle(const broker_t *broker) { return broker_is_connected(broker) && broker->count == 0; }

bool broker_send(broker_t *broker, const char *topic, const char *payload, bool is_retained)
{
    broker_sent_t *const sent = sent_at(broker, broker->count);
    sent->is_acknowledged = false;
    sent->is_retained = is_retained;
    (void)snprintf(sent->topic, sizeof sent->topic, "%s", topic);
    (void)snprintf(sent->payload, sizeof sent->payload, "%s", payload);
    if (!submit(broker, sent)) return false;
    broker->count++;
    if (mosquitto_want_write(broker->mosq)) fathom_loop_wake(&broker->socket.source);
    return true;
}

void broker_change(broker_t *broker, const char *will)
{
    (void)snprintf(broker->will, sizeof broker->will, "%s", will);
    broker->has_changed = true;
    broker->is_reported = false;
    if (broker->phase == BROKER_CONNECTING) return;
    if (broker->phase == BROKER_READY) (void)mosquitto_disconnect(broker->mosq);
    remove_socket(broker);
    broker->phase = BROKER_PAUSE;
    broker->is_lost = false;
    broker->pause_us = 0;
    broker->next_us = now_us(broker);
}

bool broker_wait(broker_t *broker, uint32_t max_us)
{
    if (!broker_is_connected(broker)) return false;
    struct pollfd entry = {broker->socket.fd, socket_events(&broker->socket.source), 0};
    broker->socket.source.is_readable = poll(&entry, 1, (int)(max_us / 1000)) > 0;
    (void)poll_socket(&broker->socket.source);
    return broker_is_connected(broker);
}

void broker_end(broker_t *broker)
{
    if (broker->loop == NULL) return;
    if (broker->phase == BROKER_CONNECTING) {
        (void)pthread_detach(broker->connecting); /* it may wait for minutes */
        return;
    }
    if (broker->phase == BROKER_READY) (void)mosquitto_disconnect(broker->mosq);
    remove_socket(broker);
    if (broker->thread.source.loop != NULL) fathom_loop_remove(&broker->thread.source);
    if (broker->thread.fd >= 0) (void)close(broker->thread.fd);
    if (broker->mosq != NULL) mosquitto_destroy(broker->mosq);
    broker->mosq = NULL;
    (void)mosquitto_lib_cleanup();
}
