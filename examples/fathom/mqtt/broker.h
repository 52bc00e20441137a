/* SPDX-License-Identifier: MIT */
#ifndef BROKER_H
#define BROKER_H

#include <mosquitto.h>
#include <pthread.h>
#include <stdio.h>

#include "fathom_loop.h"
#include "mqtt/settings.h"
#include "ports/host.h"

/*
 * A connection to an MQTT broker, in a loop with the ports. A thread connects, since the look-up of a name and
 * libmosquitto's connect wait; afterwards the loop does everything. If the connection is lost, or the broker refuses the
 * client, the client tries again after a pause that grows from 0.5 s to a minute, shortened by a random part.
 *
 * Up to BROKER_WINDOW messages with QoS 1 are unacknowledged. After a loss they are sent again, in their order and before
 * any other message: the broker may get a message twice, but never for the first time after a later one. The client
 * subscribes to nothing.
 */

typedef struct {
    void (*connected)(void *ctx);               /* the broker accepted the client */
    void (*acknowledged)(void *ctx);            /* the broker has one more message, or several */
    void (*print)(void *ctx, const char *text); /* a line for the user */
} broker_user_t;

typedef enum { BROKER_PAUSE, BROKER_CONNECTING, BROKER_GREETING, BROKER_READY } broker_phase_t;

/* With a round trip of 30 ms the window allows 500 messages a second. libmosquitto sends up to 20. */
enum { BROKER_TEXT = 512, BROKER_PAYLOAD = 3072, BROKER_WINDOW = 16 };

/* An unacknowledged message. */
typedef struct {
    int number; /* of libmosquitto */
    bool is_acknowledged;
    bool is_retained;
    char topic[BROKER_TEXT]; /* for another client */
    char payload[BROKER_PAYLOAD];
} broker_sent_t;

typedef struct broker broker_t;

typedef struct {
    fathom_loop_source_t source;
    broker_t *broker;
    int fd;
} broker_source_t;

struct broker {
    broker_source_t socket;
    broker_source_t thread; /* readable when the thread has ended */
    fathom_loop_t *loop;
    const host_t *host;
    const broker_settings_t *settings;
    const char *file; /* that has the settings, for messages */
    const broker_user_t *user;
    void *ctx;
    struct mosquitto *mosq;
    pthread_t connecting;
    int connect_result; /* of the thread */
    int connect_errno;
    broker_phase_t phase;
    uint64_t next_us;                 /* of the next attempt to connect */
    uint64_t began_us;                /* of the present one, or of the connection */
    uint32_t pause_us;                /* the latest one */
    char connect_host[SETTINGS_HOST]; /* for the thread, which may outlive the settings */
    int connect_port;
    int keep_alive_s;
    broker_sent_t sent[BROKER_WINDOW]; /* a ring */
    unsigned first;                    /* the oldest */
    unsigned count;
    bool has_changed; /* the settings: a new client is needed */
    bool is_new;      /* the client is not the one that was connected before */
    bool is_lost;     /* `reason` says why */
    bool thread_has_ended;
    bool is_reported; /* the user knows `reported`, the reason why the broker is away */
    int tls_error;    /* of OpenSSL, about the broker's certificate; 0: none */
    char will[SETTINGS_PATH];
    char reason[BROKER_TEXT];
    char reported[BROKER_TEXT];
    char log[BROKER_TEXT]; /* the latest error of libmosquitto */
};

/* Starts to connect. *settings must stay valid. will: the topic that gets "offline" when the client is lost. False: the
 * user knows why. */
bool broker_begin(broker_t *broker, const host_t *host, fathom_loop_t *loop,
                  const broker_settings_t *settings, const char *file, const char *will,
                  const broker_user_t *user, void *ctx);

/* Call it before each sleep, outside of a step of the loop. Returns the longest time to sleep in us. */
uint32_t broker_tick(broker_t *broker);

/* Connects again, with changed settings and a new will. */
void broker_change(broker_t *broker, const char *will);

bool broker_is_connected(const broker_t *broker);
bool broker_is_free(const broker_t *broker); /* and one more message can be sent */
bool broker_is_idle(const broker_t *broker); /* and all messages are acknowledged */

/* Sends a message. False: try again when the broker is free. */
bool broker_send(broker_t *broker, const char *topic, const char *payload, bool is_retained);

/* Goes on without the loop until something happened, at most max_us. False: the broker is not connected. */
bool broker_wait(broker_t *broker, uint32_t max_us);

/* Ends the connection; the broker does not publish the will. Also without broker_begin(). */
void broker_end(broker_t *broker);

/* ---- for broker.c: the client, and what is wrong with it or with the broker ---- */

/* NULL: broker->reason says why. */
struct mosquitto *broker_client(broker_t *broker);

/* Sets the user and the password, which is read from its file each time. False: broker->reason says why. */
bool broker_login(broker_t *broker);

/* Sets broker->reason: in words; from a result of libmosquitto and errno; from the return code of MQTT 3.1.1 with which
 * the broker refused the client. */
void broker_explain(broker_t *broker, const char *format, ...) __attribute__((format(printf, 2, 3)));
void broker_explain_result(broker_t *broker, int result, int error);
void broker_explain_refusal(broker_t *broker, int code);

/* Secures the client. *error gets what is wrong with the broker's certificate, also later. False: the files are wrong. */
bool tls_set(struct mosquitto *mosq, const broker_settings_t *settings, int *error, char *reason,
             size_t capacity);

/* In words; "" if unknown. */
const char *tls_reason(int error);

#endif
