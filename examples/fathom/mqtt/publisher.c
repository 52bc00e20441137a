/* SPDX-License-Identifier: MIT */
#include "mqtt/publisher.h"

#include <inttypes.h>
#include <string.h>

#include "cli/command.h"
#include "mqtt/discovery.h"

enum { FAILURES = 3, NEWS_US = 1000000 };

static uint64_t now_us(const publisher_t *publisher) { return publisher->host->now_us(publisher->host->ctx); }

/* ---- what is retained ---- */

static bool send_status(publisher_t *publisher)
{
    char topic[TOPIC];
    topic_of_site(publisher->config, "status", topic);
    publisher->has_status = !broker_send(&publisher->broker, topic, "online", true);
    return true;
}

static bool send_deletion(publisher_t *publisher)
{
    char topic[DISCOVERY_TOPIC];
    (void)snprintf(topic, sizeof topic, "%s", publisher->gone->topic);
    if (broker_send(&publisher->broker, topic, "", true)) retained_remove(&publisher->gone, topic);
    return true;
}

static bool send_discovery(publisher_t *publisher, publisher_sensor_t *sensor)
{
    char topic[DISCOVERY_TOPIC];
    char payload[DISCOVERY_TEXT];
    unsigned bit = 0;
    if (sensor->undiscovered == 0) return false;
    while ((sensor->undiscovered >> bit & 1) == 0) bit++;
    discovery_topic(publisher->config, sensor->station, bit, topic);
    discovery_payload(publisher->config, sensor->station, bit, payload);
    if (broker_send(&publisher->broker, topic, payload, true)) sensor->undiscovered &= ~(UINT32_C(1) << bit);
    return true;
}

static bool send_availability(publisher_t *publisher, publisher_sensor_t *sensor)
{
    char topic[TOPIC];
    if (!sensor->has_news) return false;
    topic_of_sensor(publisher->config, sensor->station, "availability", topic);
    sensor->has_news =
        !broker_send(&publisher->broker, topic, sensor->is_available ? "online" : "offline", true);
    return true;
}

/* The first sensor that has one of these to be sent. */
static bool send_first(publisher_t *publisher,
                       bool (*send)(publisher_t *publisher, publisher_sensor_t *sensor))
{
    for (size_t slot = 0; slot != STATION_SLOTS; slot++)
        if (publisher->sensors[slot].station != NULL && send(publisher, &publisher->sensors[slot]))
            return true;
    return false;
}

static bool has_counters(const publisher_t *publisher)
{
    const bool is_due = publisher->told_us == 0 || now_us(publisher) - publisher->told_us >= NEWS_US;
    return is_due && publisher->queue.dropped != publisher->told_dropped;
}

static void tell_dropped(publisher_t *publisher, uint64_t dropped)
{
    (void)fprintf(stderr,
                  "fathom: the queue was full: %" PRIu64 " messages were dropped, %" PRIu64
                  " since the begin\n",
                  dropped - publisher->said_dropped, dropped);
    publisher->said_dropped = dropped;
}

static bool send_counters(publisher_t *publisher)
{
    char topic[TOPIC];
    char payload[STATE_TEXT];
    size_t sensors = 0;
    for (size_t slot = 0; slot != STATION_SLOTS; slot++)
        if (publisher->sensors[slot].station != NULL) sensors++;
    const publisher_state_t state = {publisher->boot,
                                     publisher->host->utc_us(publisher->host->ctx),
                                     now_us(publisher) - publisher->start_us,
                                     publisher->queue.dropped,
                                     publisher->queue.count,
                                     sensors};
    topic_of_site(publisher->config, "publisher", topic);
    state_of_publisher(&state, payload);
    if (!broker_send(&publisher->broker, topic, payload, true)) return false;
    if (state.dropped > publisher->said_dropped) tell_dropped(publisher, state.dropped);
    publisher->told_dropped = state.dropped;
    publisher->told_us = now_us(publisher);
    return true;
}

/* Who has just connected is told all of it, whatever the broker still knows. */
static void take_connected(void *ctx)
{
    publisher_t *const publisher = ctx;
    for (size_t slot = 0; slot != STATION_SLOTS; slot++) {
        publisher_sensor_t *const sensor = &publisher->sensors[slot];
        if (sensor->station == NULL) continue;
        sensor->has_news = true;
        sensor->undiscovered = sensor->discovered;
    }
    publisher->has_status = true;
    publisher->has_facts = true;
    publisher->told_us = 0;
    publisher->told_dropped = UINT64_MAX;
}

/* ---- one after another ---- */

static bool send_fact(publisher_t *publisher)
{
    if (publisher->has_status) return send_status(publisher);
    if (publisher->gone != NULL) return send_deletion(publisher);
    if (has_counters(publisher) && send_counters(publisher)) return true;
    if (!publisher->has_facts) return false;
    if (send_first(publisher, send_discovery) || send_first(publisher, send_availability)) return true;
    publisher->has_facts = false;
    return false;
}

static bool send_message(publisher_t *publisher)
{
    message_t message;
    char text[STATE_TEXT];
    if (!queue_take(&publisher->queue, &message, text)) return false;
    state_finish(text, now_us(publisher) - message.time_us, message.stream->dropped);
    if (broker_send(&publisher->broker, message.stream->topic, text, message.stream->is_retained))
        return true;
    message.stream->dropped++;
    publisher->queue.dropped++;
    return true;
}

/* As much as the broker takes. */
static void send_next(publisher_t *publisher)
{
    for (unsigned turn = 0; turn != BROKER_WINDOW && broker_is_free(&publisher->broker); turn++)
        if (!send_fact(publisher) && !send_message(publisher)) return;
}

static void take_acknowledged(void *ctx) { send_next(ctx); }

static void take_lost(void *ctx) { (void)ctx; }

static void tell(void *ctx, const char *text)
{
    (void)ctx;
    (void)fprintf(stderr, "fathom: %s\n", text);
}

/* ---- what is measured ---- */

static void put(publisher_t *publisher, state_t *state, topic_t topic, uint8_t probe, uint64_t time_us)
{
    char text[QUEUE_TEXT];
    stream_t *const stream = publisher->sensors[state->station->slot].streams[probe - 1][topic];
    if (stream == NULL) return;
    state->boot = publisher->boot;
    state->seq = ++stream->seq;
    const message_t message = {stream, time_us, state_begin(state, topic, text)};
    queue_put(&publisher->queue, &message, text);
    send_next(publisher);
}

/* True: that is new. */
static bool set_away(publisher_t *publisher, const station_t *station, bool is_away)
{
    publisher_sensor_t *const sensor = &publisher->sensors[station->slot];
    const bool is_new = sensor->is_away != is_away;
    sensor->is_away = is_away;
    if (sensor->is_available != is_away) return is_new;
    sensor->is_available = !is_away;
    sensor->has_news = true;
    publisher->has_facts = true;
    send_next(publisher);
    return is_new;
}

static uint64_t utc_of(const publisher_t *publisher, uint64_t time_us)
{
    const host_t *const host = publisher->host;
    return host->utc_us(host->ctx) - (now_us(publisher) - time_us);
}

bool publisher_result(publisher_t *publisher, const station_t *station, const result_t *result,
                      uint64_t time_us)
{
    const uint8_t probe = topic_has_probes(station) ? result->sample.probe : 1;
    state_t state = {.station = station, .result = result, .utc_us = utc_of(publisher, time_us)};
    if (result->alarm != 0) {
        put(publisher, &state, TOPIC_ALARM, probe, time_us);
        return false;
    }
    publisher->sensors[station->slot].failures = 0;
    const bool is_new = set_away(publisher, station, false);
    put(publisher, &state, TOPIC_STATE, probe, time_us);
    put(publisher, &state, TOPIC_LEVEL, probe, time_us);
    return is_new;
}

bool publisher_failure(publisher_t *publisher, const station_t *station, const char *word, uint8_t probe,
                       bool is_grave)
{
    const uint64_t time_us = now_us(publisher);
    const result_t none = {.has_level = false};
    state_t state = {.station = station,
                     .result = &none,
                     .failure = word,
                     .utc_us = publisher->host->utc_us(publisher->host->ctx)};
    publisher_sensor_t *const sensor = &publisher->sensors[station->slot];
    if (sensor->failures != FAILURES) sensor->failures++;
    const bool is_new = (is_grave || sensor->failures == FAILURES) && set_away(publisher, station, true);
    for (uint8_t i = 1; i <= FATHOM_DYP_PROBES; i++) {
        if (!topic_wants_probe(station, i) || (probe != 0 && topic_has_probes(station) && probe != i))
            continue;
        put(publisher, &state, TOPIC_STATE, i, time_us);
        put(publisher, &state, TOPIC_LEVEL, i, time_us);
    }
    return is_new;
}

/* ---- begin and end ---- */

bool publisher_add(publisher_t *publisher, const station_t *station)
{
    publisher_sensor_t *const sensor = &publisher->sensors[station->slot];
    if (sensor->station != station) memset(sensor, 0, sizeof *sensor);
    memset(sensor->streams, 0, sizeof sensor->streams);
    for (uint8_t probe = 1; probe <= FATHOM_DYP_PROBES; probe++)
        for (topic_t topic = 0; topic != TOPICS; topic++) {
            char text[TOPIC];
            if (!topic_wants_probe(station, probe) ||
                !topic_is_there(&publisher->results[station->slot], topic))
                continue;
            topic_of_probe(publisher->config, station, probe, topic, text);
            stream_t *const stream = streams_get(&publisher->streams, text);
            if (stream == NULL) return false;
            stream->is_retained = topic == TOPIC_ALARM;
            sensor->streams[probe - 1][topic] = stream;
        }
    sensor->station = station;
    sensor->discovered = discovery_all(publisher->config, station, &publisher->results[station->slot]);
    sensor->undiscovered = sensor->discovered;
    sensor->has_news = true;
    publisher->has_facts = true;
    return true;
}

bool publisher_begin(publisher_t *publisher, const host_t *host, const config_t *config,
                     config_results_t results)
{
    memset(publisher, 0, sizeof *publisher);
    publisher->host = host;
    publisher->config = config;
    publisher->results = results;
    publisher->start_us = now_us(publisher);
    state_boot(publisher->boot);
    if (queue_begin(&publisher->queue, config->queue_messages, config->queue_bytes)) return true;
    tell(NULL, "there is no memory left for the queue; make bytes: less");
    return false;
}

bool publisher_connect(publisher_t *publisher, fathom_loop_t *loop)
{
    static const broker_user_t user = {take_connected, take_lost, take_acknowledged, tell};
    char topic[TOPIC];
    topic_of_site(publisher->config, "status", topic);
    return broker_begin(&publisher->broker, publisher->host, loop, publisher->config, topic, &user,
                        publisher);
}

/* ---- another config ---- */

/* Of a sensor, and of each of its probes. */
static bool each_of_sensor(publisher_t *publisher, size_t slot,
                           bool (*take)(retained_t **list, const char *topic))
{
    const publisher_sensor_t *const sensor = &publisher->sensors[slot];
    char topic[DISCOVERY_TOPIC];
    topic_of_sensor(publisher->config, sensor->station, "availability", topic);
    if (!take(&publisher->gone, topic)) return false;
    for (size_t i = 0; i != FATHOM_DYP_PROBES * (size_t)TOPICS; i++) {
        const stream_t *const stream = sensor->streams[i / TOPICS][i % TOPICS];
        if (stream != NULL && stream->is_retained && !take(&publisher->gone, stream->topic)) return false;
    }
    for (unsigned bit = 0; bit != DISCOVERY_BITS; bit++) {
        if ((sensor->discovered >> bit & 1) == 0) continue;
        discovery_topic(publisher->config, sensor->station, bit, topic);
        if (!take(&publisher->gone, topic)) return false;
    }
    return true;
}

static bool each_retained(publisher_t *publisher, bool (*take)(retained_t **list, const char *topic))
{
    char topic[TOPIC];
    topic_of_site(publisher->config, "status", topic);
    if (!take(&publisher->gone, topic)) return false;
    topic_of_site(publisher->config, "publisher", topic);
    if (!take(&publisher->gone, topic)) return false;
    for (size_t slot = 0; slot != STATION_SLOTS; slot++)
        if (publisher->sensors[slot].station != NULL && !each_of_sensor(publisher, slot, take)) return false;
    return true;
}

static bool is_still_there(retained_t **list, const char *topic)
{
    retained_remove(list, topic);
    return true;
}

bool publisher_begin_change(publisher_t *publisher) { return each_retained(publisher, retained_add); }

void publisher_remove(publisher_t *publisher, size_t slot) { publisher->sensors[slot].station = NULL; }

void publisher_end_change(publisher_t *publisher, bool is_other_broker)
{
    char topic[TOPIC];
    topic_of_site(publisher->config, "status", topic);
    (void)each_retained(publisher, is_still_there);
    if (!queue_resize(&publisher->queue, publisher->config->queue_messages, publisher->config->queue_bytes))
        tell(NULL, "there is no memory left for another queue; it stays as it was");
    publisher->has_facts = true;
    publisher->told_dropped = UINT64_MAX;
    if (is_other_broker) broker_change(&publisher->broker, topic);
}

uint32_t publisher_tick(publisher_t *publisher)
{
    const uint32_t broker_us = broker_tick(&publisher->broker);
    send_next(publisher);
    return broker_us < NEWS_US ? broker_us : NEWS_US;
}

void publisher_status(const publisher_t *publisher, char *text, size_t capacity)
{
    size_t sensors = 0;
    size_t away = 0;
    for (size_t slot = 0; slot != STATION_SLOTS; slot++) {
        if (publisher->sensors[slot].station == NULL) continue;
        sensors++;
        if (publisher->sensors[slot].is_away) away++;
    }
    (void)snprintf(text, capacity, "%zu sensors, %zu away; broker %s %s; dropped %" PRIu64, sensors, away,
                   publisher->config->broker.host,
                   broker_is_connected(&publisher->broker) ? "connected" : "away", publisher->queue.dropped);
}

/* What still waits is sent, as far as that goes in END_US, and at last that it is offline. */
static void say_goodbye(publisher_t *publisher)
{
    enum { END_US = 2000000, TURN_US = 100000 };
    broker_t *const broker = &publisher->broker;
    const uint64_t until_us = now_us(publisher) + END_US;
    char topic[TOPIC];
    send_next(publisher);
    while (now_us(publisher) < until_us && !broker_is_idle(broker))
        if (!broker_wait(broker, TURN_US)) return;
    if (!broker_is_connected(broker)) return;
    topic_of_site(publisher->config, "status", topic);
    if (!broker_send(broker, topic, "offline", true)) return;
    /* Nothing more is sent when that is acknowledged. */
    publisher->has_facts = publisher->has_status = false;
    publisher->told_us = now_us(publisher);
    while (now_us(publisher) < until_us && !broker_is_idle(broker))
        if (!broker_wait(broker, TURN_US)) return;
}

void publisher_end(publisher_t *publisher)
{
    say_goodbye(publisher);
    broker_end(&publisher->broker);
    queue_end(&publisher->queue);
    streams_end(&publisher->streams);
    retained_end(&publisher->gone);
}
