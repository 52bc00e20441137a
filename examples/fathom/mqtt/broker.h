/* SPDX-License-Identifier: MIT */
#ifndef BROKER_H
#define BROKER_H

#include <mosquitto.h>
#include <pthread.h>

#include "fathom_loop.h"
#include "mqtt/settings.h"
#include "ports/host.h"

/*
 * A connection to an MQTT broker, in a loop with the ports. A thread connects, since the look-up of a name and
 * libmosquitto's connect wait; afterwards the loop does everything. If the connection is lost, or the broker refuses the
 * client, the client tries again after a pause that grows from 0.5 s to a minute, shortened by a random part.
 *
 * A broker closes the connection of a client when another one with its id comes. If it does that twice soon after it
 * accepted the client, the connection is contested. The pause grows then until a connection lasts for two minutes, and a
 * client that has nothing to publish does not connect. MQTT 3.1.1 has no message for this, and MQTT 5 is not spoken by each
 * broker.
 *
 * Up to BROKER_WINDOW messages with QoS 1 are unacknowledged. After a loss libmosquitto sends them again, in their order
 * and before any other message: the broker may get a message twice, but never for the first time after a later one.
 */

/* Why the broker's certificate is not accepted. The text of an error stays until another one, so that it is reported once. */
typedef struct {
    int error; /* of OpenSSL, in the present attempt; 0: none */
    int error_of_text;
    char text[256];
} tls_verdict_t;

/* With a round trip of 30 ms the window allows 500 messages a second. libmosquitto sends up to 20. */
enum { BROKER_WINDOW = 16, BROKER_TEXT = 512 };

typedef enum {
    BROKER_PAUSE,      /* until until_us */
    BROKER_CONNECTING, /* a thread uses `settings` and `mosq` */
    BROKER_GREETING,   /* connected; the broker must accept the client before until_us */
    BROKER_ACCEPTED,   /* the broker did */
    BROKER_READY,
    BROKER_LOST /* `reason` has the cause; broker_tick() does the rest */
} broker_phase_t;

/* An unacknowledged message, for another client. */
typedef struct broker_sent {
    struct broker_sent *next;
    const char *topic;
    bool is_retained;
    int number; /* of libmosquitto; 0: the client does not know the message */
    char payload[];
} broker_sent_t;

/* A message that the client subscribed to. The texts are valid during the call. */
typedef void broker_received_t(void *ctx, const char *topic, const char *payload, bool is_retained);

typedef struct {
    fathom_loop_source_t source; /* first: the loop passes it */
    int fd;
    fathom_loop_t *loop;
    const host_t *host;
    const publish_settings_t *wanted;
    publish_settings_t settings; /* of the present attempt */
    broker_received_t *received;
    void *received_ctx;
    struct mosquitto *mosq;
    pthread_t thread;
    bool thread_has_ended; /* atomic; with this result: */
    int connect_result;
    int connect_errno;
    broker_phase_t phase;
    uint64_t until_us;   /* BROKER_READY: when the connection is steady */
    uint32_t pause_us;   /* the latest one; 0: none yet */
    unsigned closes;     /* soon after the broker accepted the client, in succession */
    bool is_new;         /* the user does not know of the connection */
    bool yields;         /* there is nothing to publish: do not contest the connection of another client */
    uint32_t greetings;  /* how often the broker accepted the client */
    broker_sent_t *sent; /* the oldest first */
    unsigned sent_count;
    bool has_more;    /* to read */
    bool has_changed; /* the settings: a new client is needed */
    tls_verdict_t tls;
    char reason[BROKER_TEXT];   /* why the broker is away, */
    char reported[BROKER_TEXT]; /* as the user knows it; "": the user knows of none */
    char log[BROKER_TEXT];      /* the latest error of libmosquitto */
} broker_t;

/* The first broker_tick() connects. *settings must stay valid. `received` gets what the client subscribed to. When the client is lost, the broker publishes "offline" as the status. */
void broker_begin(broker_t *broker, const host_t *host, fathom_loop_t *loop,
                  const publish_settings_t *settings, broker_received_t *received, void *ctx);

/* Call it before each sleep, outside of a step of the loop. Returns the longest time to sleep in us. */
uint32_t broker_tick(broker_t *broker);

/* Connects again, since *settings changed. The broker that was connected publishes "offline" as the former status. */
void broker_change(broker_t *broker);

/* Returns true if the client is connected and one more message can be sent. */
bool broker_is_free(const broker_t *broker);

/* Sends a message; `topic` must stay valid. False: libmosquitto does not accept the message. */
bool broker_send(broker_t *broker, const char *topic, const char *payload, bool is_retained);

/* Subscribes to a filter with QoS 0, or ends that. A subscription ends with its connection. */
void broker_subscribe(broker_t *broker, const char *filter, bool is_wanted);

/* While they are held, messages wait for others, with which they leave in one segment. */
void broker_hold(broker_t *broker, bool is_held);

/* Goes on without the loop until something happened, at most max_us. False: the broker is not connected. */
bool broker_wait(broker_t *broker, uint32_t max_us);

/* Ends the connection; the broker does not publish the will. */
void broker_end(broker_t *broker);

/* Secures the client. *verdict gets what is wrong with the broker's certificate, also later. False: `text` says why not. */
bool tls_set(struct mosquitto *mosq, const broker_settings_t *settings, tls_verdict_t *verdict, char *text,
             size_t capacity);

#endif
