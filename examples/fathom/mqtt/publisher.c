/* SPDX-License-Identifier: MIT */
#include "mqtt/publisher.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "mqtt/discovery.h"

/* Failures in a row after which a sensor is away; the least time between two messages about the publisher; the time from
 * one message with the counters of the sensors to the next. */
enum { FAILURES = 3, NEWS_US = 1000000, COUNTERS_US = 60000000 };

static uint64_t now_us(const publisher_t *publisher) { return publisher->host->now_us(publisher->host->ctx); }

static void print(void *ctx, const char *text)
{
    (void)ctx;
    (void)fprintf(stderr, "fathom: %s\n", text);
}

/* ---- retained messages ---- */

static void send_retained(publisher_t *publisher, stream_t *stream, const char *payload)
{
    if (!broker_send(&publisher->broker, stream->topic, payload, true)) return;
    stream->is_due = false;
    stream->is_known = true;
}

static void send_deletion(publisher_t *publisher, stream_t *stream)
{
    if (!broker_send(&publisher->broker, stream->topic, "", true)) return;
    stream->is_known = false;
    stream->is_due = true;
}

static void send_discovery(publisher_t *publisher, stream_t *stream)
{
    char payload[DISCOVERY_TEXT];
    discovery_payload(publisher->settings, stream->sensor, stream->bit, payload);
    send_retained(publisher, stream, payload);
}

static void send_availability(publisher_t *publisher, stream_t *stream)
{
    const publisher_sensor_t *const sensor = &publisher->sensors[stream->sensor->number];
    send_retained(publisher, stream, sensor->is_available ? "online" : "offline");
}

static void send_counters(publisher_t *publisher, stream_t *stream)
{
    const uint64_t utc_us = publisher->host->utc_us(publisher->host->ctx);
    char payload[COUNTERS_TEXT];
    state_of_counters(publisher->sensors[stream->sensor->number].sensor, utc_us, publisher->boot, payload);
    send_retained(publisher, stream, payload);
}

static void print_dropped(publisher_t *publisher, uint64_t dropped)
{
    (void)fprintf(stderr,
                  "fathom: the queue was full: %" PRIu64 " messages were dropped, %" PRIu64
                  " since the start.\n",
                  dropped - publisher->printed_dropped, dropped);
    publisher->printed_dropped = dropped;
}

static bool has_news(const publisher_t *publisher)
{
    const bool is_due = publisher->sent_us == 0 || now_us(publisher) - publisher->sent_us >= NEWS_US;
    return is_due && publisher->queue.dropped != publisher->sent_dropped;
}

static bool send_news(publisher_t *publisher)
{
    char payload[STATE_TEXT];
    const publisher_state_t state = {publisher->boot,
                                     publisher->host->utc_us(publisher->host->ctx),
                                     now_us(publisher) - publisher->start_us,
                                     publisher->queue.dropped,
                                     publisher->queue.count,
                                     publisher->sensor_count};
    state_of_publisher(&state, payload);
    if (!broker_send(&publisher->broker, publisher->news->topic, payload, true)) return false;
    publisher->news->is_known = true;
    if (state.dropped > publisher->printed_dropped) print_dropped(publisher, state.dropped);
    publisher->sent_dropped = state.dropped;
    publisher->sent_us = now_us(publisher);
    return true;
}

/* ---- one message after another ---- */

/* True: a message was sent, or will be. */
static bool send_fact(publisher_t *publisher)
{
    const streams_t *const streams = &publisher->streams;
    stream_t *stream = NULL;
    if (publisher->has_facts && (stream = streams_due(streams, STREAM_STATUS)) != NULL)
        send_retained(publisher, stream, "online");
    else if (publisher->has_facts && (stream = streams_gone(streams)) != NULL)
        send_deletion(publisher, stream);
    else if (has_news(publisher) && send_news(publisher))
        return true;
    else if (publisher->has_facts && (stream = streams_due(streams, STREAM_DISCOVERY)) != NULL)
        send_discovery(publisher, stream);
    else if (publisher->has_facts && (stream = streams_due(streams, STREAM_AVAILABILITY)) != NULL)
        send_availability(publisher, stream);
    else if (publisher->has_facts && (stream = streams_due(streams, STREAM_COUNTERS)) != NULL)
        send_counters(publisher, stream);
    publisher->has_facts = stream != NULL;
    return publisher->has_facts;
}

static bool send_message(publisher_t *publisher)
{
    message_t *const message = queue_take(&publisher->queue);
    char text[STATE_TEXT];
    if (message == NULL) return false;
    stream_t *const stream = message->stream;
    (void)snprintf(text, sizeof text, "%s", message->text);
    state_finish(text, now_us(publisher) - message->time_us, stream->dropped);
    /* A deleted topic must not come back. */
    if (stream->is_retained && !stream->is_wanted) {
        free(message);
    } else if (broker_send(&publisher->broker, stream->topic, text, stream->is_retained)) {
        stream->is_known = true;
        free(message);
    } else {
        queue_drop(&publisher->queue, message);
    }
    return true;
}

/* As many as the broker accepts. */
static void send_next(publisher_t *publisher)
{
    for (unsigned turn = 0; turn != BROKER_WINDOW && broker_is_free(&publisher->broker); turn++)
        if (!send_fact(publisher) && !send_message(publisher)) return;
}

static void send_news_soon(publisher_t *publisher)
{
    publisher->sent_us = 0;
    publisher->sent_dropped = UINT64_MAX;
}

static void on_connected(void *ctx)
{
    publisher_t *const publisher = ctx;
    streams_repeat(&publisher->streams);
    publisher->has_facts = true;
    send_news_soon(publisher);
}

static void on_acknowledged(void *ctx) { send_next(ctx); }

/* ---- readings ---- */

static void put(publisher_t *publisher, const reading_t *reading, topic_t topic, uint8_t probe)
{
    char text[QUEUE_TEXT];
    stream_t *const stream = publisher->sensors[reading->sensor->number].streams[probe - 1][topic];
    if (stream == NULL) return;
    state_begin(reading, topic, publisher->boot, ++stream->seq, text);
    queue_put(&publisher->queue, stream, publisher->start_us + reading->time_us, text);
    send_next(publisher);
}

/* Returns true if that is new. */
static bool set_away(publisher_t *publisher, publisher_sensor_t *sensor, bool is_away)
{
    const bool is_new = sensor->is_away != is_away;
    sensor->is_away = is_away;
    if (sensor->is_available != is_away) return is_new;
    sensor->is_available = !is_away;
    sensor->availability->is_due = true;
    publisher->has_facts = true;
    send_next(publisher);
    return is_new;
}

static void put_reading(publisher_t *publisher, publisher_sensor_t *sensor, const reading_t *reading)
{
    const uint8_t probe = topic_has_probes(reading->sensor) ? reading->result->sample.probe : 1;
    if (reading->result->alarm != 0) {
        put(publisher, reading, TOPIC_ALARM, probe);
        return;
    }
    sensor->failures = 0;
    (void)set_away(publisher, sensor, false);
    put(publisher, reading, TOPIC_STATE, probe);
    put(publisher, reading, TOPIC_LEVEL, probe);
}

/* A sensor that sends by itself and whose frames are all damaged sent no reading within its time-out. */
static bool is_grave(const reading_t *reading)
{
    return reading->status == FATHOM_ERR_PORT || reading->status == FATHOM_ERR_STALE ||
           (reading->status == FATHOM_ERR_CHECKSUM && !mode_is_asked(reading->sensor->mode));
}

bool publisher_reading(publisher_t *publisher, const reading_t *reading)
{
    publisher_sensor_t *const sensor = &publisher->sensors[reading->sensor->number];
    const uint8_t probe = reading->result->sample.probe; /* 0: the failure is of all probes */
    if (reading->failure == NULL) {
        put_reading(publisher, sensor, reading);
        return false;
    }
    if (sensor->failures != FAILURES) sensor->failures++;
    const bool is_away = is_grave(reading) || sensor->failures == FAILURES;
    const bool is_new = is_away && set_away(publisher, sensor, true);
    for (uint8_t i = 1; i <= FATHOM_DYP_PROBES; i++) {
        if (!sensor_has_probe(reading->sensor, i)) continue;
        if (probe != 0 && topic_has_probes(reading->sensor) && probe != i) continue;
        put(publisher, reading, TOPIC_STATE, i);
        put(publisher, reading, TOPIC_LEVEL, i);
    }
    return is_new;
}

/* ---- the sensors ---- */

static stream_t *want_of_site(publisher_t *publisher, const char *word, stream_kind_t kind)
{
    char topic[TOPIC];
    topic_of_site(publisher->settings, word, topic);
    return streams_want(&publisher->streams, topic, kind, NULL);
}

static bool want_readings(publisher_t *publisher, publisher_sensor_t *sensor)
{
    for (uint8_t probe = 1; probe <= FATHOM_DYP_PROBES; probe++)
        for (topic_t topic = 0; topic != TOPICS; topic++) {
            char text[TOPIC];
            if (!sensor_has_probe(sensor->sensor, probe) || !topic_is_there(sensor->sensor, topic)) continue;
            topic_of_probe(publisher->settings, sensor->sensor, probe, topic, text);
            stream_t *const stream = streams_want(&publisher->streams, text, STREAM_READINGS, sensor->sensor);
            if (stream == NULL) return false;
            stream->is_retained = topic == TOPIC_ALARM;
            sensor->streams[probe - 1][topic] = stream;
        }
    return true;
}

static bool want_discovery(publisher_t *publisher, const sensor_t *sensor)
{
    const uint32_t all = discovery_all(publisher->settings, sensor);
    for (unsigned bit = 0; bit != DISCOVERY_BITS; bit++) {
        char topic[DISCOVERY_TOPIC];
        if ((all >> bit & 1) == 0) continue;
        discovery_topic(publisher->settings, sensor, bit, topic);
        stream_t *const stream = streams_want(&publisher->streams, topic, STREAM_DISCOVERY, sensor);
        if (stream == NULL) return false;
        stream->bit = bit;
    }
    return true;
}

/* before: what was known of the sensor with this name; NULL: nothing. */
static bool want_sensor(publisher_t *publisher, publisher_sensor_t *sensor, const publisher_sensor_t *before)
{
    char topic[TOPIC];
    if (before != NULL) {
        sensor->failures = before->failures;
        sensor->is_available = before->is_available;
        sensor->is_away = before->is_away;
    }
    (void)snprintf(sensor->name, sizeof sensor->name, "%s", sensor->sensor->name);
    topic_of_sensor(publisher->settings, sensor->sensor, "availability", topic);
    sensor->availability = streams_want(&publisher->streams, topic, STREAM_AVAILABILITY, sensor->sensor);
    topic_of_sensor(publisher->settings, sensor->sensor, "counters", topic);
    return sensor->availability != NULL &&
           streams_want(&publisher->streams, topic, STREAM_COUNTERS, sensor->sensor) != NULL &&
           want_readings(publisher, sensor) && want_discovery(publisher, sensor->sensor);
}

static const publisher_sensor_t *find(const publisher_sensor_t *sensors, size_t count, const char *name)
{
    for (size_t i = 0; i != count; i++)
        if (strcmp(sensors[i].name, name) == 0) return &sensors[i];
    return NULL;
}

/* Names all streams anew. */
static bool set_sensors(publisher_t *publisher, const site_t *site)
{
    publisher_sensor_t *const before = publisher->sensors;
    const size_t count = publisher->sensor_count;
    publisher_sensor_t *const sensors = calloc(site->sensor_count, sizeof *sensors);
    bool is_good = true;
    if (sensors == NULL) return false;
    publisher->sensors = sensors;
    publisher->sensor_count = site->sensor_count;
    streams_forget(&publisher->streams);
    publisher->news = want_of_site(publisher, "publisher", STREAM_PUBLISHER);
    publisher->status = want_of_site(publisher, "status", STREAM_STATUS);
    is_good = publisher->news != NULL && publisher->status != NULL;
    for (size_t i = 0; i != site->sensor_count && is_good; i++) {
        sensors[i].sensor = site->sensors[i];
        is_good = want_sensor(publisher, &sensors[i], find(before, count, site->sensors[i]->name));
    }
    streams_clean(&publisher->streams);
    free(before);
    publisher->has_facts = true;
    return is_good;
}

/* ---- start and end ---- */

bool publisher_init(publisher_t *publisher, const host_t *host, const publish_settings_t *settings,
                    const site_t *site, uint64_t start_us)
{
    memset(publisher, 0, sizeof *publisher);
    publisher->host = host;
    publisher->settings = settings;
    publisher->start_us = publisher->counted_us = start_us;
    state_boot(publisher->boot);
    queue_set_bounds(&publisher->queue, settings->queue_messages, settings->queue_bytes);
    if (set_sensors(publisher, site)) return true;
    print(NULL, "no memory left");
    return false;
}

bool publisher_connect(publisher_t *publisher, fathom_loop_t *loop)
{
    static const broker_user_t user = {on_connected, on_acknowledged, print};
    return broker_begin(&publisher->broker, publisher->host, loop, &publisher->settings->broker,
                        publisher->settings->path, publisher->status->topic, &user, publisher);
}

bool publisher_change(publisher_t *publisher, const site_t *site, bool has_other_broker)
{
    const publish_settings_t *const settings = publisher->settings;
    if (!set_sensors(publisher, site)) return false;
    queue_set_bounds(&publisher->queue, settings->queue_messages, settings->queue_bytes);
    send_news_soon(publisher);
    if (has_other_broker) broker_change(&publisher->broker, publisher->status->topic);
    return true;
}

uint32_t publisher_tick(publisher_t *publisher)
{
    const uint32_t broker_us = broker_tick(&publisher->broker);
    if (now_us(publisher) - publisher->counted_us >= COUNTERS_US) {
        publisher->counted_us = now_us(publisher);
        streams_make_due(&publisher->streams, STREAM_COUNTERS);
        publisher->has_facts = true;
    }
    send_next(publisher);
    return broker_us < NEWS_US ? broker_us : NEWS_US;
}

void publisher_status(const publisher_t *publisher, char *text, size_t capacity)
{
    size_t away = 0;
    for (size_t i = 0; i != publisher->sensor_count; i++)
        if (publisher->sensors[i].is_away) away++;
    (void)snprintf(text, capacity, "%zu sensors, %zu away; broker %s %s; dropped %" PRIu64,
                   publisher->sensor_count, away, publisher->settings->broker.host,
                   broker_is_connected(&publisher->broker) ? "connected" : "away", publisher->queue.dropped);
}

static bool wait_until_sent(publisher_t *publisher, uint64_t until_us)
{
    enum { TURN_US = 100000 };
    broker_t *const broker = &publisher->broker;
    while (now_us(publisher) < until_us && !broker_is_idle(broker))
        if (!broker_wait(broker, TURN_US)) return false;
    return broker_is_connected(broker);
}

/* Sends what still waits, within END_US, and at last that the publisher is offline. */
static void send_last(publisher_t *publisher)
{
    enum { END_US = 2000000 };
    const uint64_t until_us = now_us(publisher) + END_US;
    send_next(publisher);
    if (!wait_until_sent(publisher, until_us)) return;
    if (!broker_send(&publisher->broker, publisher->status->topic, "offline", true)) return;
    /* Nothing more is sent when that is acknowledged. */
    publisher->has_facts = false;
    publisher->sent_us = now_us(publisher);
    (void)wait_until_sent(publisher, until_us);
}

void publisher_deinit(publisher_t *publisher)
{
    send_last(publisher);
    broker_end(&publisher->broker);
    queue_free(&publisher->queue);
    streams_free(&publisher->streams);
    free(publisher->sensors);
    publisher->sensors = NULL;
}
