/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): getentropy, open_memstream */
#include "mqtt/publisher.h"

#include <inttypes.h>
#include <stdio_ext.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "fathom/version.h"
#include "output/words.h"
#include "reading/fields.h"

/* Failures in a row after which a sensor is away; the least time between two messages about dropped messages; the time from
 * one message with the counters of the sensors to the next; after a connect, the longest time until the broker sends the
 * publisher's own message back, and until it sends retained messages, which a broker of several machines may send later. */
enum { FAILURES = 3, NEWS_US = 1000000, COUNTERS_US = 60000000, HEAR_US = 2000000, LISTEN_US = 5000000 };

static uint64_t now_us(const publisher_t *publisher) { return publisher->host->now_us(publisher->host->ctx); }

/* ---- topics ---- */

/* Where the topic of this name is, or where it belongs. */
static topic_t **find_topic(publisher_t *publisher, const char *name)
{
    topic_t **at = &publisher->topics;
    while (*at != NULL && strcmp((*at)->name, name) != 0) at = &(*at)->next;
    return at;
}

static topic_t *add_topic(topic_t **at, topic_kind_t kind, const char *name)
{
    topic_t *const topic = *at != NULL ? *at : allocate(sizeof **at + strlen(name) + 1);
    *at = topic;
    (void)strcpy(topic->name, name);
    topic->kind = kind;
    return topic;
}

/* Marks a topic as wanted, and adds the topic if there is none. */
static topic_t *want_topic(publisher_t *publisher, topic_kind_t kind, sensor_t *sensor, uint8_t probe)
{
    char name[TOPIC_NAME];
    topic_name(publisher->settings, kind, sensor, probe, name);
    topic_t *const topic = add_topic(find_topic(publisher, name), kind, name);
    topic->has_other_sensor = topic->sensor != sensor;
    topic->sensor = sensor;
    topic->probe = probe;
    topic->is_wanted = topic->is_due = true;
    return topic;
}

/* All topics of a probe, or of a sensor (probe 0), or of the publisher (of NULL). */
static void want_topics(publisher_t *publisher, publisher_sensor_t *of, uint8_t probe)
{
    sensor_t *const sensor = of != NULL ? of->sensor : NULL;
    for (topic_kind_t kind = 0; kind != TOPICS; kind++) {
        if (!topic_is_there(publisher->settings, kind, sensor, probe)) continue;
        topic_t *const topic = want_topic(publisher, kind, sensor, probe);
        if (probe != 0 && kind >= TOPIC_STATE) of->topics[probe - 1][kind - TOPIC_STATE] = topic;
    }
}

static void put_alarm(publisher_t *publisher, topic_t *topic);

/* Names all topics again. Then all retained messages are due. */
static void set_sensors(publisher_t *publisher, const site_t *site)
{
    publisher_sensor_t *const before = publisher->sensors;
    const size_t count = publisher->sensor_count;
    publisher->sensors = allocate(site->sensor_count * sizeof *before);
    publisher->sensor_count = site->sensor_count;
    publisher->has_due = true;
    for (topic_t *topic = publisher->topics; topic != NULL; topic = topic->next) topic->is_wanted = false;
    want_topics(publisher, NULL, 0);
    for (size_t i = 0; i != site->sensor_count; i++) {
        publisher_sensor_t *const sensor = &publisher->sensors[i];
        sensor->sensor = site->sensors[i];
        for (size_t j = 0; j != count; j++) {
            if (strcmp(before[j].sensor->name, sensor->sensor->name) != 0) continue;
            sensor->failures = before[j].failures;
            sensor->presence = before[j].presence;
        }
        for (uint8_t probe = 1; probe <= FATHOM_DYP_PROBES; probe++) want_topics(publisher, sensor, probe);
        want_topics(publisher, sensor, 0);
    }
    for (topic_t *topic = publisher->topics; topic != NULL; topic = topic->next) {
        if (topic->is_wanted && topic->kind == TOPIC_ALARM && topic->has_other_sensor)
            put_alarm(publisher, topic);
        if (topic->is_wanted) continue;
        free(topic->kept);
        topic->kept = NULL;
        topic->sensor = NULL;
    }
    free(before);
}

/* All topics of this kind are due, or of TOPICS all kinds; sensor: those of this one alone. They are sent as soon as `after`
 * messages left the queue. */
static void make_due(publisher_t *publisher, topic_kind_t kind, const sensor_t *sensor, uint64_t after)
{
    publisher->has_due = true;
    for (topic_t *topic = publisher->topics; topic != NULL; topic = topic->next)
        if ((kind == TOPICS || topic->kind == kind) && (sensor == NULL || topic->sensor == sensor)) {
            topic->is_due = true;
            topic->after = after;
        }
}

/* ---- what an earlier run left ---- */

/* The counters of a sensor are sent first and deleted last. So no topic of a sensor remains without its counters. */
static void on_received(void *ctx, const char *name, const char *payload, bool is_retained)
{
    publisher_t *const publisher = ctx;
    char counters[TOPIC_NAME] = "";
    if (!is_retained) {
        if (strstr(payload, publisher->boot) != NULL) publisher->is_heard = true;
        return;
    }
    const topic_kind_t kind = topic_of_site(publisher->settings, name, payload, counters);
    if (kind == TOPICS) return;
    const bool has_counters =
        kind == TOPIC_COUNTERS || topic_is_entity(kind) || *find_topic(publisher, counters) != NULL;
    topic_t *topic = *find_topic(publisher, name);
    if (!has_counters || (topic != NULL && topic->is_wanted)) return;
    if (topic == NULL) {
        topic_t *const others = publisher->topics;
        publisher->topics = NULL;
        topic = add_topic(&publisher->topics, kind, name);
        topic->next = others;
    }
    topic->is_known = publisher->has_due = true;
}

static void subscribe(publisher_t *publisher, bool is_wanted)
{
    char filter[TOPIC_NAME];
    for (unsigned i = 0; topic_filter(publisher->settings, i, filter); i++)
        broker_subscribe(&publisher->broker, filter, is_wanted);
    publisher->is_subscribed = is_wanted;
}

/* The broker accepted the client, and can have what any earlier run sent. */
static void greet(publisher_t *publisher, uint64_t now)
{
    publisher->greetings = publisher->broker.greetings;
    publisher->greeted_us = now;
    publisher->is_heard = false;
    subscribe(publisher, true);
    make_due(publisher, TOPICS, NULL, 0);
    make_due(publisher, TOPIC_STATUS, NULL, publisher->queue.left + publisher->queue.count);
}

static void listen(publisher_t *publisher, uint64_t now)
{
    if (!publisher->is_heard && now - publisher->greeted_us >= HEAR_US) {
        publisher->is_heard = true;
        if (!publisher->is_deaf_reported)
            (void)fprintf(stderr,
                          "fathom: broker %s port %u: it does not send back what this client published, so "
                          "messages of earlier sensors stay there. Let the user read %s/%s/# and the "
                          "discovery messages.\n",
                          publisher->settings->broker.host, publisher->settings->broker.port,
                          publisher->settings->prefix, publisher->settings->site);
        publisher->is_deaf_reported = true;
    }
    if (publisher->is_subscribed && now - publisher->greeted_us >= LISTEN_US) subscribe(publisher, false);
}

/* ---- the queue ---- */

static void free_message(queue_t *queue, message_t *message, bool is_dropped)
{
    if (is_dropped) {
        message->topic->dropped++;
        queue->dropped++;
    }
    free(message);
}

/* Takes the oldest message out of the queue; it was sent, is dropped, or is kept. */
static void remove_message(publisher_t *publisher, bool is_dropped)
{
    queue_t *const queue = &publisher->queue;
    message_t *const message = queue->first;
    topic_t *const topic = message->topic;
    queue->first = message->next;
    queue->bytes -= message->size;
    queue->count--;
    queue->left++;
    if (!topic_is_retained(topic->kind) || !topic->is_wanted) {
        free_message(queue, message, is_dropped);
        return;
    }
    if (topic->kept != NULL) free_message(queue, topic->kept, !topic->kept->is_sent);
    topic->kept = message;
    topic->is_due = !message->is_sent;
    publisher->has_due |= topic->is_due;
}

/* Drops the oldest messages, so that `count` more of `size` bytes keep the bounds. */
static void make_room(publisher_t *publisher, uint32_t count, size_t size)
{
    queue_t *const queue = &publisher->queue;
    while (queue->count != 0 && (queue->count + count > publisher->settings->queue_messages ||
                                 queue->bytes + size > publisher->settings->queue_bytes))
        remove_message(publisher, true);
}

static void put_message(publisher_t *publisher, topic_t *topic, uint64_t time_us, const char *text)
{
    queue_t *const queue = &publisher->queue;
    const size_t size = sizeof(message_t) + strlen(text) + 1;
    message_t *const message = allocate(size);
    make_room(publisher, 1, size);
    *message = (message_t){.topic = topic, .time_us = time_us, .seq = topic->seq, .size = size};
    (void)strcpy(message->text, text);
    if (queue->first == NULL)
        queue->first = message;
    else
        queue->last->next = message;
    queue->last = message;
    queue->bytes += size;
    queue->count++;
}

/* ---- payloads ---- */

static json_t begin_payload(const publisher_t *publisher)
{
    rewind(publisher->to);
    return (json_t){.to = publisher->to};
}

static const char *end_payload(publisher_t *publisher)
{
    (void)fputc('\0', publisher->to);
    return fflush(publisher->to) == 0 ? publisher->payload : "";
}

/* Null if the clock was not set. */
static void json_utc(const publisher_t *publisher, json_t *json, uint64_t age_us)
{
    const host_t *const host = publisher->host;
    char utc[UTC_TEXT];
    json_string(json, "utc", utc_text(utc_before(host->utc_us(host->ctx), age_us), utc));
}

/* The present state under a retained topic. */
static const char *payload_of(publisher_t *publisher, const topic_t *topic)
{
    json_t json = begin_payload(publisher);
    if (topic->kind == TOPIC_STATUS || topic->kind == TOPIC_AVAILABILITY) {
        const bool is_online = topic->kind == TOPIC_STATUS
                                   ? !publisher->is_ending
                                   : publisher->sensors[topic->sensor->number].presence == SENSOR_AVAILABLE;
        (void)fputs(is_online ? "online" : "offline", json.to);
        return end_payload(publisher);
    }
    json_begin(&json, NULL, '{');
    if (topic_is_entity(topic->kind)) {
        topic_json_entity(&json, publisher->settings, topic->kind, topic->sensor, topic->probe);
    } else {
        json_utc(publisher, &json, 0);
        if (topic->kind == TOPIC_PUBLISHER) json_string(&json, "version", FATHOM_VERSION_STRING);
        json_string(&json, "boot", publisher->boot);
    }
    if (topic->kind == TOPIC_COUNTERS) stats_json_of_sensor(&json, topic->sensor);
    if (topic->kind == TOPIC_PUBLISHER) {
        json_value(&json, "uptime_s", "%" PRIu64, (now_us(publisher) - publisher->start_us) / 1000000);
        json_value(&json, "sensors", "%zu", publisher->sensor_count);
        json_value(&json, "queued", "%" PRIu32, publisher->queue.count);
        json_value(&json, "dropped", "%" PRIu64, publisher->queue.dropped);
    }
    json_end(&json, '}');
    return end_payload(publisher);
}

static const char *payload_of_message(publisher_t *publisher, const message_t *message)
{
    const uint64_t age_us = now_us(publisher) - message->time_us;
    json_t json = begin_payload(publisher);
    json_begin(&json, NULL, '{');
    json_utc(publisher, &json, age_us);
    (void)fprintf(json.to, ",%s,\"age_ms\":%" PRIu64 ",\"dropped\":%" PRIu64 "}", message->text,
                  age_us / 1000, message->topic->dropped);
    return end_payload(publisher);
}

/* ---- one message after another ---- */

/* The order of messages after a connect. Counters are the first, so a broker that has any retained message of a sensor has
 * its counters. The status validates all messages before it. */
enum { RANK_DELETED = 3, RANK_STATUS = 6, RANK_NONE = 8 };
static const uint8_t ranks[TOPICS] = {
    [TOPIC_COUNTERS] = 1,     [TOPIC_AVAILABILITY] = 2,  [ENTITY_DISTANCE] = 4,
    [ENTITY_TEMPERATURE] = 4, [ENTITY_LEVEL] = 4,        [ENTITY_FILLED] = 4,
    [ENTITY_ALARM] = 4,       [TOPIC_ALARM] = 5,         [TOPIC_STATUS] = RANK_STATUS,
    [TOPIC_PUBLISHER] = 7,    [TOPIC_STATE] = RANK_NONE, [TOPIC_LEVEL] = RANK_NONE,
};

/* Returns the rank of the retained message of a topic. RANK_NONE: no message is due. A message is not sent again while a
 * newer message of its topic waits. */
static unsigned rank_of(const topic_t *topic)
{
    const message_t *const kept = topic->kept;
    if (!topic->is_wanted)
        return topic_is_retained(topic->kind) && topic->is_known ? RANK_DELETED : RANK_NONE;
    if (!topic->is_due) return RANK_NONE;
    if (topic->kind == TOPIC_ALARM && (kept == NULL || (kept->is_sent && kept->seq != topic->seq)))
        return RANK_NONE;
    return ranks[topic->kind];
}

/* The first retained message that is due and may be sent; NULL: none may. While the availability of a sensor waits for
 * messages in the queue, the status waits too. */
static topic_t *next_due(publisher_t *publisher)
{
    topic_t *first = NULL;
    unsigned bound = publisher->is_heard ? RANK_NONE : RANK_DELETED;
    publisher->has_due = false;
    for (topic_t *topic = publisher->topics; topic != NULL; topic = topic->next) {
        const unsigned rank = rank_of(topic);
        if (rank != RANK_NONE) publisher->has_due = true;
        if (rank >= bound) continue;
        if (topic->after <= publisher->queue.left) {
            bound = rank;
            first = topic;
        } else if (bound >= RANK_STATUS) {
            bound = RANK_STATUS;
            first = NULL;
        }
    }
    return first;
}

static void report_dropped(publisher_t *publisher)
{
    const uint64_t dropped = publisher->queue.dropped;
    if (dropped > publisher->sent_dropped)
        (void)fprintf(stderr,
                      "fathom: the queue was full: %" PRIu64 " messages were dropped, %" PRIu64
                      " since the start.\n",
                      dropped - publisher->sent_dropped, dropped);
    publisher->sent_dropped = dropped;
    publisher->sent_us = now_us(publisher);
}

static void send_topic(publisher_t *publisher, topic_t *topic)
{
    const char *const payload = !topic->is_wanted     ? ""
                                : topic->kept != NULL ? payload_of_message(publisher, topic->kept)
                                                      : payload_of(publisher, topic);
    topic->is_known = broker_send(&publisher->broker, topic->name, payload, true) && topic->is_wanted;
    if (topic->kept != NULL) topic->kept->is_sent = true;
    topic->is_due = false;
    if (topic->kind == TOPIC_PUBLISHER && topic->is_wanted) report_dropped(publisher);
}

static bool send_retained(publisher_t *publisher)
{
    topic_t *const topic = publisher->has_due ? next_due(publisher) : NULL;
    if (topic != NULL) send_topic(publisher, topic);
    return topic != NULL;
}

static bool send_message(publisher_t *publisher)
{
    message_t *const message = publisher->queue.first;
    if (message == NULL) return false;
    topic_t *const topic = message->topic;
    const bool is_retained = topic_is_retained(topic->kind);
    /* A deleted topic must not be published again. */
    const bool is_obsolete = is_retained && !topic->is_wanted;
    message->is_sent = !is_obsolete && broker_send(&publisher->broker, topic->name,
                                                   payload_of_message(publisher, message), is_retained);
    if (message->is_sent) topic->is_known = true;
    remove_message(publisher, !message->is_sent && !is_obsolete);
    return true;
}

/* As many as the broker accepts. */
static void send_next(publisher_t *publisher)
{
    const bool has_several = publisher->has_due || publisher->queue.count > 1;
    if (has_several) broker_hold(&publisher->broker, true);
    while (broker_is_free(&publisher->broker) && (send_retained(publisher) || send_message(publisher))) {
    }
    if (has_several) broker_hold(&publisher->broker, false);
}

/* ---- readings ---- */

static void put(publisher_t *publisher, const reading_t *reading, topic_t *topic)
{
    json_t json = begin_payload(publisher);
    reading_json(&json, reading, topic_columns(topic->kind, reading->sensor));
    json_string(&json, "boot", publisher->boot);
    json_value(&json, "seq", "%" PRIu64, ++topic->seq);
    put_message(publisher, topic, publisher->start_us + reading->time_us, end_payload(publisher));
}

/* The present state of an alarm, of which the loop reports only changes. It is unknown before the first distance. */
static void put_alarm(publisher_t *publisher, topic_t *topic)
{
    sensor_t *const sensor = topic->sensor;
    const fathom_alarm_t *const alarm = &sensor->probes[topic->probe - 1].alarm;
    const bool is_started = alarm->state != 0;
    const result_t result = {.sample = {.kind = FATHOM_UNKNOWN, .probe = topic->probe},
                             .alarm = is_started ? alarm->state : FATHOM_ALARM_UNKNOWN,
                             .is_on = is_started ? fathom_alarm_is_on(alarm)
                                                 : sensor->processing.alarm.if_unknown == FATHOM_ALARM_ON};
    const reading_t reading = {
        .sensor = sensor, .result = &result, .time_us = now_us(publisher) - publisher->start_us};
    put(publisher, &reading, topic);
}

/* Returns true if that is new. A sensor is available behind its reading, and away at once. */
static bool set_presence(publisher_t *publisher, publisher_sensor_t *sensor, presence_t presence)
{
    const queue_t *const queue = &publisher->queue;
    const bool is_available = presence == SENSOR_AVAILABLE;
    const presence_t before = sensor->presence;
    sensor->presence = presence;
    if ((before == SENSOR_AVAILABLE) != is_available)
        make_due(publisher, TOPIC_AVAILABILITY, sensor->sensor,
                 is_available ? queue->left + queue->count : 0);
    return before != presence;
}

/* A sensor that sends automatically and whose frames are all damaged sent no reading within its time-out. */
static bool is_grave(const reading_t *reading)
{
    return reading->status == FATHOM_ERR_PORT || reading->status == FATHOM_ERR_STALE ||
           (reading->status == FATHOM_ERR_CHECKSUM && !mode_is_asked(reading->sensor->mode));
}

bool publisher_reading(publisher_t *publisher, const reading_t *reading)
{
    publisher_sensor_t *const sensor = &publisher->sensors[reading->sensor->number];
    const bool is_failure = reading->failure != NULL;
    const bool is_alarm = !is_failure && reading->result->alarm != 0;
    const uint8_t probe = topic_has_probes(reading->sensor) ? reading->result->sample.probe : 0; /* 0: all */
    bool is_newly_away = false;
    if (is_failure && sensor->failures != FAILURES) sensor->failures++;
    if (is_failure && (is_grave(reading) || sensor->failures == FAILURES))
        is_newly_away = set_presence(publisher, sensor, SENSOR_AWAY);
    for (size_t i = 0; i != FATHOM_DYP_PROBES; i++)
        for (topic_kind_t kind = TOPIC_STATE; kind != TOPICS; kind++) {
            topic_t *const topic = sensor->topics[i][kind - TOPIC_STATE];
            const bool is_meant = topic != NULL && (probe == 0 || probe == i + 1);
            if (is_meant && (kind == TOPIC_ALARM) == is_alarm) put(publisher, reading, topic);
        }
    if (!is_failure && !is_alarm) {
        sensor->failures = 0;
        (void)set_presence(publisher, sensor, SENSOR_AVAILABLE);
    }
    return is_newly_away;
}

/* ---- start and end ---- */

void publisher_init(publisher_t *publisher, const host_t *host, fathom_loop_t *loop,
                    const publish_settings_t *settings, const site_t *site, uint64_t start_us)
{
    uint64_t random = 0;
    memset(publisher, 0, sizeof *publisher);
    publisher->host = host;
    publisher->settings = settings;
    publisher->start_us = publisher->counted_us = start_us;
    if (getentropy(&random, sizeof random) != 0) random = start_us;
    (void)snprintf(publisher->boot, sizeof publisher->boot, "%016" PRIx64, random);
    publisher->to = open_memstream(&publisher->payload, &publisher->payload_size);
    if (publisher->to == NULL) end_without_memory();
    (void)__fsetlocking(publisher->to, FSETLOCKING_BYCALLER); /* no other thread has it */
    broker_begin(&publisher->broker, host, loop, settings, on_received, publisher);
    set_sensors(publisher, site);
}

void publisher_change(publisher_t *publisher, const site_t *site, bool has_other_broker)
{
    set_sensors(publisher, site);
    make_room(publisher, 0, 0);
    if (has_other_broker) broker_change(&publisher->broker);
}

static bool has_available(const publisher_t *publisher)
{
    for (size_t i = 0; i != publisher->sensor_count; i++)
        if (publisher->sensors[i].presence == SENSOR_AVAILABLE) return true;
    return false;
}

uint32_t publisher_tick(publisher_t *publisher)
{
    if (publisher->broker.phase != BROKER_READY) publisher->broker.yields = !has_available(publisher);
    const uint32_t broker_us = broker_tick(&publisher->broker);
    const uint64_t now = now_us(publisher);
    if (publisher->greetings != publisher->broker.greetings) greet(publisher, now);
    if (publisher->broker.phase == BROKER_READY) listen(publisher, now);
    if (publisher->queue.dropped != publisher->sent_dropped && now - publisher->sent_us >= NEWS_US)
        make_due(publisher, TOPIC_PUBLISHER, NULL, 0);
    if (now - publisher->counted_us >= COUNTERS_US) {
        publisher->counted_us = now;
        make_due(publisher, TOPIC_COUNTERS, NULL, 0);
    }
    send_next(publisher);
    return broker_us < NEWS_US ? broker_us : NEWS_US;
}

void publisher_status(const publisher_t *publisher, char *text, size_t capacity)
{
    const bool is_connected = publisher->broker.phase == BROKER_READY;
    size_t away = 0;
    for (size_t i = 0; i != publisher->sensor_count; i++)
        if (publisher->sensors[i].presence == SENSOR_AWAY) away++;
    (void)snprintf(text, capacity, "%zu sensors, %zu away; broker %s %s; dropped %" PRIu64,
                   publisher->sensor_count, away, publisher->settings->broker.host,
                   is_connected ? "connected" : "away", publisher->queue.dropped);
}

/* Waits for the acknowledgement of all that was sent. Sends what still waits, too, unless that is the last message. */
static void drain(publisher_t *publisher, uint64_t until_us)
{
    enum { TURN_US = 100000 };
    do {
        if (!publisher->is_ending) send_next(publisher);
    } while (publisher->broker.sent != NULL && now_us(publisher) < until_us &&
             broker_wait(&publisher->broker, TURN_US));
}

void publisher_end(publisher_t *publisher)
{
    enum { END_US = 2000000 };
    const uint64_t until_us = now_us(publisher) + END_US;
    char status[TOPIC_NAME];
    drain(publisher, until_us);
    publisher->is_ending = true;
    topic_name(publisher->settings, TOPIC_STATUS, NULL, 0, status);
    if (publisher->broker.phase == BROKER_READY) send_topic(publisher, *find_topic(publisher, status));
    drain(publisher, until_us);
    broker_end(&publisher->broker);
}

void publisher_deinit(publisher_t *publisher)
{
    while (publisher->queue.first != NULL) remove_message(publisher, false);
    while (publisher->topics != NULL) {
        topic_t *const topic = publisher->topics;
        publisher->topics = topic->next;
        free(topic->kept);
        free(topic);
    }
    free(publisher->sensors);
    if (publisher->to != NULL) (void)fclose(publisher->to);
    free(publisher->payload);
}
