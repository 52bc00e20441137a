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
 * A connection to the MQTT broker, in a loop beside the ports. It comes to stand in a thread of its own, since looking a name
 * up waits, and so does libmosquitto's connect; from then on all is done by the loop, and the thread has ended. Where it is
 * lost, or the broker refuses it, it is tried again after a pause that grows from 0.5 s to a minute, by a random part shorter.
 *
 * Up to BROKER_WINDOW messages are under way, QoS 1. When the connection was lost, all that were not acknowledged are sent
 * again, in their order and before any other one: some may come twice, none comes for the first time after a later one.
 * Nothing is subscribed to.
 */

typedef struct {
    void (*connected)(void *ctx);               /* the broker accepted the client */
    void (*acknowledged)(void *ctx);            /* the broker has one more message, or several */
    void (*print)(void *ctx, const char *text); /* a line for the user */
} broker_user_t;

typedef enum { BROKER_PAUSE, BROKER_CONNECTING, BROKER_GREETING, BROKER_READY } broker_phase_t;

/* With a round trip of 30 ms they are 500 messages a second. libmosquitto has up to 20 under way. */
enum { BROKER_TEXT = 512, BROKER_PAYLOAD = 3072, BROKER_WINDOW = 16 };

/* A message that is under way. */
typedef struct {
    int number; /* libmosquitto's */
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
    broker_source_t thread; /* told by it that it has ended */
    fathom_loop_t *loop;
    const host_t *host;
    const broker_settings_t *settings;
    const char *file; /* that has the settings, for messages */
    const broker_user_t *user;
    void *ctx;
    struct mosquitto *mosq;
    pthread_t connecting;
    int connect_result; /* the thread's */
    int connect_errno;
    broker_phase_t phase;
    uint64_t next_us;                 /* when it is tried again */
    uint64_t began_us;                /* when it was tried last */
    uint32_t pause_us;                /* the last one */
    char connect_host[SETTINGS_HOST]; /* for the thread, which may outlive a config */
    int connect_port;
    int keep_alive_s;
    broker_sent_t sent[BROKER_WINDOW];
    unsigned first;   /* of them, the oldest; the others follow, round the end, */
    unsigned count;   /* so many */
    bool has_changed; /* the config: the client is to be another one, ... */
    bool is_other;    /* ... and is, than the one that was connected last */
    bool is_lost;     /* for `reason` */
    bool thread_has_ended;
    bool is_told;  /* that it is away, for `told_reason` */
    int tls_error; /* what is wrong with its certificate; 0: nothing that is known */
    char will[SETTINGS_PATH];
    char reason[BROKER_TEXT];
    char told_reason[BROKER_TEXT];
    char log[BROKER_TEXT]; /* libmosquitto's last error */
};

/* Begins to connect; config stays where it is. will: the topic at which "offline" stands when it is lost. False after saying why.
 */
bool broker_begin(broker_t *broker, const host_t *host, fathom_loop_t *loop,
                  const broker_settings_t *settings, const char *file, const char *will,
                  const broker_user_t *user, void *ctx);

/* From outside of the loop's steps, before each sleep. Returns how long that may take. */
uint32_t broker_tick(broker_t *broker);

/* The config is another one, and so may the will be: connects anew. */
void broker_change(broker_t *broker, const char *will);

/* Is it connected, and may one more message be sent? Is it connected, with none under way? */
bool broker_is_free(const broker_t *broker);
bool broker_is_idle(const broker_t *broker);
bool broker_is_connected(const broker_t *broker);

/* Sends it. False: it could not be; that is no loss, it may be sent again when it is free. */
bool broker_send(broker_t *broker, const char *topic, const char *payload, bool is_retained);

/* Goes on for so long at most, without the loop: until something has happened. False: it is not connected. */
bool broker_wait(broker_t *broker, uint32_t max_us);

/* Also without broker_begin(). Ends the connection; the will is not told then. */
void broker_end(broker_t *broker);

/* ---- for broker.c: the client that the config asks for ---- */

/* NULL after saying why in broker->reason. */
struct mosquitto *broker_client(broker_t *broker);

/* The password, read anew each time. False after saying why in broker->reason. */
bool broker_login(broker_t *broker);

/* Why a connection did not come to stand, or was lost: what libmosquitto has returned, and errno then. */
void broker_explain(broker_t *broker, int result, int error);

/* Why the broker did not accept the client: the return code of MQTT 3.1.1. */
void broker_explain_refusal(broker_t *broker, int code);

/* Secures the client as the config says. *error has what is wrong with the certificate of the far end, whenever that is found
 * out. False, with what is wrong with the files. */
bool tls_set(struct mosquitto *mosq, const broker_settings_t *settings, int *error, char *reason,
             size_t capacity);

/* In words; "" where it is not known. */
const char *tls_reason(int error);

#endif
