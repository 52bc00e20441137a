/* SPDX-License-Identifier: MIT */
/* What fathom publish writes, from a configuration file to the topics, the messages that wait for the broker, and the
 * discovery messages. No broker is there. */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): open_memstream */
#include "backup_desk.h"
#include "tool_bench.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/config.h"
#include "mqtt/publisher.h"
#include "reading/fields.h"
#include "sensors/driver.h"

static const char file[] =
    "site: mill/north\n"
    "broker: {host: h}\n"
    "queue: {messages: 4}\n"
    "lines:\n"
    "  - port: /dev/a\n"
    "    sensors:\n"
    "      - {name: tank, sensor: \"a16:1:modbus\", level: {mounting: 2300, height: 2000, capacity: 5000}}\n"
    "      - {name: bumper.1, sensor: \"a05:2:modbus\", probes: \"1,3\"}\n"
    "      - {name: gate, sensor: \"hps167s:7\", temperature: 10, interval: 2000,\n"
    "         alarm: {when: near<500, unknown: on, no-response: off}}\n"
    "  - {port: gpiochip0, in: 5, sensors: [{name: pit, sensor: \"a05:relay\"}]}\n";

enum { TANK, BUMPER, GATE, PIT };

static publish_settings_t settings;
static publish_settings_t next_settings;
static site_t site;
static site_t next;
static publisher_t publisher;

static uint64_t now_us(void *ctx) { return 1000; }

static void load(publish_settings_t *to, site_t *sensors, const char *text)
{
    desk_write("site.yaml", text);
    assert_true(config_load(to, sensors, "publish", desk_path("site.yaml")));
    for (size_t i = 0; i != sensors->sensor_count; i++)
        sensors->sensors[i]->number = i; /* as the loop does */
}

static void begin(void)
{
    static const host_t host = {.now_us = now_us, .utc_us = now_us};
    bench_begin();
    desk_begin();
    load(&settings, &site, file);
    publisher_init(&publisher, &host, NULL, &settings, &site, 0);
}

static int tear_down(void **state)
{
    publisher_deinit(&publisher);
    site_free(&site);
    site_free(&next);
    return desk_end(state);
}

EACH_BEGINS(begin())

static const suite_t suite = {.set_up = begins, .tear_down = tear_down};

static sensor_t *sensor(size_t number) { return site.sensors[number]; }

static topic_t *topic_at(const char *end)
{
    topic_t *topic = publisher.topics;
    while (topic != NULL && strcmp(topic->name + strlen(topic->name) - strlen(end), end) != 0)
        topic = topic->next;
    assert_non_null(topic);
    return topic;
}

/* ---- topics ---- */

/* Of four probes two are wanted; a relay of four probes is one contact. */
TEST(the_topics_are_those_of_the_sensors_their_probes_and_what_the_file_wants_of_them)
{
    static const char *const expected[] = {
        "fathom/mill/north/status",
        "fathom/mill/north/publisher",
        "homeassistant/sensor/fathom_mill_north_tank_distance/config",
        "homeassistant/sensor/fathom_mill_north_tank_level/config",
        "homeassistant/sensor/fathom_mill_north_tank_filled/config",
        "fathom/mill/north/tank/state",
        "fathom/mill/north/tank/level",
        "fathom/mill/north/tank/availability",
        "fathom/mill/north/tank/counters",
        "homeassistant/sensor/fathom_mill_north_bumper__2e1_1_distance/config",
        "fathom/mill/north/bumper.1/1/state",
        "homeassistant/sensor/fathom_mill_north_bumper__2e1_3_distance/config",
        "fathom/mill/north/bumper.1/3/state",
        "fathom/mill/north/bumper.1/availability",
        "fathom/mill/north/bumper.1/counters",
        "homeassistant/sensor/fathom_mill_north_gate_distance/config",
        "homeassistant/sensor/fathom_mill_north_gate_temperature/config",
        "homeassistant/binary_sensor/fathom_mill_north_gate_alarm/config",
        "fathom/mill/north/gate/state",
        "fathom/mill/north/gate/alarm",
        "fathom/mill/north/gate/availability",
        "fathom/mill/north/gate/counters",
        "homeassistant/sensor/fathom_mill_north_pit_distance/config",
        "fathom/mill/north/pit/state",
        "fathom/mill/north/pit/availability",
        "fathom/mill/north/pit/counters",
    };
    const topic_t *topic = publisher.topics;
    for (size_t i = 0; i != sizeof expected / sizeof expected[0]; i++, topic = topic->next) {
        assert_non_null(topic);
        assert_string_equal(topic->name, expected[i]);
        assert_true(topic->is_wanted && topic->is_due && !topic->is_known);
    }
    assert_null(topic);
}

TEST(without_discovery_there_are_no_entities)
{
    settings.discovery[0] = '\0';
    for (topic_kind_t kind = ENTITY_DISTANCE; kind <= ENTITY_ALARM; kind++)
        assert_false(topic_is_there(&settings, kind, sensor(TANK), 1));
    assert_true(topic_is_there(&settings, TOPIC_STATE, sensor(TANK), 1));
}

/* A site of 100 characters and a name of 31. */
TEST(the_longest_topic_fits)
{
    static const char end[] = "n_4_temperature/config";
    char name[TOPIC_NAME];
    memset(settings.site, 's', SETTINGS_NAME - 1);
    memset(settings.prefix, 'p', SETTINGS_NAME - 1);
    memset(settings.discovery, 'd', SETTINGS_NAME - 1);
    memset(sensor(BUMPER)->name, 'n', 31);
    topic_name(&settings, TOPIC_AVAILABILITY, sensor(BUMPER), 0, name);
    assert_int_equal(strlen(name), 100 + 1 + 100 + 1 + 31 + 1 + 12);
    topic_name(&settings, ENTITY_TEMPERATURE, sensor(BUMPER), 4, name);
    assert_string_equal(name + strlen(name) - strlen(end), end);
}

/* ---- ids and what an earlier run left ---- */

enum { LETTERS = 6, LONGEST = 5, IDS = 6180, ID = 80 };

static int by_text(const void *one, const void *other) { return strcmp(one, other); }

/* All sites of up to five of these letters without an empty level: of length n, e(n) end with / and o(n) with another one,
 * o(n) = 5 * (o(n - 1) + e(n - 1)) and e(n) = o(n - 1): 5 + 25 + 150 + 875 + 5125. */
TEST(no_two_names_have_one_id)
{
    static char ids[IDS][ID];
    size_t count = 0;
    unsigned codes = 1;
    for (size_t length = 1; length <= LONGEST; length++) {
        codes *= LETTERS;
        for (unsigned code = 0; code != codes; code++) {
            char name[TOPIC_NAME];
            memset(settings.site, 0, sizeof settings.site);
            for (unsigned i = 0, rest = code; i != length; i++, rest /= LETTERS)
                settings.site[i] = "a5_.-/"[rest % LETTERS];
            if (settings.site[0] == '/' || settings.site[length - 1] == '/' ||
                strstr(settings.site, "//") != NULL)
                continue;
            topic_name(&settings, ENTITY_DISTANCE, sensor(TANK), 1, name);
            assert_int_equal(strspn(name, "abcdefghijklmnopqrstuvwxyz0123456789_-/"), strlen(name));
            assert_true(count != IDS);
            (void)snprintf(ids[count++], ID, "%s", name);
        }
    }
    assert_int_equal(count, IDS);
    qsort(ids, count, ID, by_text);
    for (size_t i = 1; i != count; i++) assert_string_not_equal(ids[i - 1], ids[i]);
}

#define BOOT "{\"utc\":null,\"boot\":\"0123456789abcdef\"}"
#define ENTITY(site, program)                                                                                \
    "{\"name\":\"x\",\"availability\":[{\"topic\":\"" site                                                   \
    "/status\"},{\"topic\":\"x\"}],\"origin\":{\"name\":\"" program "\",\"sw_version\":\"0.5.0\"}}"

static const struct {
    const char *name;
    const char *payload;
    topic_kind_t kind;
    const char *counters;
} left[] = {
    {"fathom/mill/north/old/counters", BOOT, TOPIC_COUNTERS, "fathom/mill/north/old/counters"},
    {"fathom/mill/north/old/availability", "online", TOPIC_AVAILABILITY, "fathom/mill/north/old/counters"},
    {"fathom/mill/north/old/availability", "offline", TOPIC_AVAILABILITY, "fathom/mill/north/old/counters"},
    {"fathom/mill/north/old/alarm", BOOT, TOPIC_ALARM, "fathom/mill/north/old/counters"},
    {"fathom/mill/north/old/4/alarm", BOOT, TOPIC_ALARM, "fathom/mill/north/old/counters"},
    {"ha/x/sensor/any/config", ENTITY("fathom/mill/north", "fathom"), ENTITY_DISTANCE, ""},
    {"ha/sensor/any/config", ENTITY("fathom/mill", "fathom"), TOPICS, ""},
    {"ha/sensor/any/config", ENTITY("fathom/mill/north2", "fathom"), TOPICS, ""},
    {"ha/sensor/any/config", ENTITY("fathom/mill/north", "other"), TOPICS, ""},
    {"ha/sensor/any/config", "", TOPICS, ""},
    {"fathom/mill/north/old/availability", "on", TOPICS, NULL},
    {"fathom/mill/north/old/counters", "{}", TOPICS, NULL},
    {"fathom/mill/north/old/state", BOOT, TOPICS, NULL},
    {"fathom/mill/north/old/5/alarm", BOOT, TOPICS, NULL},
    {"fathom/mill/north/old/a/alarm", BOOT, TOPICS, NULL},
    {"fathom/mill/north/old/1/counters", BOOT, TOPICS, NULL},
    {"fathom/mill/north/old/1/x/alarm", BOOT, TOPICS, NULL},
    {"fathom/mill/north2/old/counters", BOOT, TOPICS, NULL},
    {"fathom/mill/counters", BOOT, TOPICS, NULL},
    {"counters", BOOT, TOPICS, NULL},
};

TEST(what_a_run_of_this_site_left_is_known_by_its_topic_and_its_payload)
{
    for (size_t i = 0; i != sizeof left / sizeof left[0]; i++) {
        char counters[TOPIC_NAME] = "";
        if (topic_of_site(&settings, left[i].name, left[i].payload, counters) != left[i].kind)
            fail_msg("%s %s", left[i].name, left[i].payload);
        if (left[i].counters != NULL) assert_string_equal(counters, left[i].counters);
    }
}

/* Without counters of the sensor that sent it a message is another program's. */
TEST(what_no_sensor_has_is_deleted_behind_the_counters_of_its_sensor)
{
    broker_t *const broker = &publisher.broker;
    broker->received(broker->received_ctx, "fathom/mill/north/old/alarm", BOOT, true);
    assert_ptr_equal(publisher.topics, topic_at("mill/north/status"));
    broker->received(broker->received_ctx, "fathom/mill/north/old/counters", BOOT, true);
    broker->received(broker->received_ctx, "fathom/mill/north/old/alarm", BOOT, true);
    broker->received(broker->received_ctx, "fathom/mill/north/tank/alarm", BOOT, true);
    broker->received(broker->received_ctx, "fathom/mill/north/tank/counters", BOOT, true);
    assert_ptr_equal(publisher.topics, topic_at("tank/alarm"));
    assert_ptr_equal(publisher.topics->next, topic_at("old/alarm"));
    assert_ptr_equal(publisher.topics->next->next, topic_at("old/counters"));
    assert_ptr_equal(publisher.topics->next->next->next, topic_at("mill/north/status"));
    assert_false(topic_at("old/alarm")->is_wanted);
    assert_true(topic_at("old/alarm")->is_known);
    assert_false(publisher.is_heard);
    broker->received(broker->received_ctx, "fathom/mill/north/tank/counters", BOOT, false);
    assert_false(publisher.is_heard); /* another start's */
    broker->received(broker->received_ctx, "fathom/mill/north/tank/counters", publisher.boot, false);
    assert_true(publisher.is_heard);
}

/* unknown: on. */
TEST(an_alarm_is_unknown_at_the_start_and_not_again_when_its_sensor_goes_on)
{
    static const char unknown[] = "\"alarm\":\"unknown\",\"is_on\":true,\"distance_mm\":null,\"boot\":";
    const topic_t *const alarm = topic_at("gate/alarm");
    const message_t *const first = publisher.queue.first;
    assert_ptr_equal(first->topic, alarm);
    assert_memory_equal(first->text, unknown, sizeof unknown - 1);
    publisher_change(&publisher, &site, false);
    assert_int_equal(alarm->seq, 1);
    load(&next_settings, &next, file);
    next.sensors[GATE]->probes[0].alarm = (fathom_alarm_t){.state = FATHOM_ALARM_OFF};
    publisher_change(&publisher, &next, false);
    assert_int_equal(alarm->seq, 2);
    assert_non_null(strstr(publisher.queue.last->text, "\"alarm\":\"off\",\"is_on\":false"));
}

/* ---- messages ---- */

/* The date of a reading is not used: it would be wrong if the clock is set while the message waits. */
static bool publish(size_t number, const char *failure, const result_t *result)
{
    const reading_t reading = {.sensor = sensor(number),
                               .status = failure != NULL ? FATHOM_ERR_NO_RESPONSE : FATHOM_OK,
                               .failure = failure,
                               .result = result,
                               .utc_us = 1};
    return publisher_reading(&publisher, &reading);
}

/* The newest message of a topic that ends so. */
static const char *text_at(const char *end)
{
    const topic_t *const topic = topic_at(end);
    const message_t *newest = NULL;
    for (const message_t *message = publisher.queue.first; message != NULL; message = message->next)
        if (message->topic == topic) newest = message;
    return newest != NULL ? newest->text : "";
}

#define STATUS "\"status\":"

static const result_t target = {.sample = {.kind = FATHOM_TARGET, .distance_mm = 1500, .probe = 1}};
static const result_t none = {.sample = {.kind = FATHOM_NO_TARGET, .distance_mm = 1500, .probe = 1}};
static const result_t silent = {.alarm = 0};
static const result_t level = {.sample = {.kind = FATHOM_TARGET, .distance_mm = 1500, .probe = 1},
                               .has_level = true,
                               .level = {.level_mm = -5, .per_mille = 400, .volume = 2000}};
static const result_t near = {.sample = {.kind = FATHOM_TARGET, .distance_mm = 480, .probe = 1},
                              .alarm = FATHOM_ALARM_ON,
                              .is_on = true};
static const result_t away = {.sample = {.kind = FATHOM_UNKNOWN, .probe = 1},
                              .alarm = FATHOM_ALARM_NO_RESPONSE};

static const struct {
    size_t sensor;
    const char *failure;
    const result_t *result;
    const char *topic;
    const char *text;
} messages[] = {
    {BUMPER, NULL, &target, "1/1/state", STATUS "\"target\",\"distance_mm\":1500"},
    {BUMPER, "no_response", &silent, "1/3/state", STATUS "\"no_response\",\"distance_mm\":null"},
    {TANK, NULL, &none, "tank/state", STATUS "\"no_target\",\"distance_mm\":null"},
    {TANK, NULL, &none, "tank/level",
     STATUS "\"no_target\",\"level_mm\":null,\"level_per_mille\":null,\"volume\":null"},
    {TANK, NULL, &level, "tank/level",
     STATUS "\"target\",\"level_mm\":-5,\"level_per_mille\":400,\"volume\":2000"},
    {GATE, NULL, &target, "gate/state", STATUS "\"target\",\"distance_mm\":1500,\"temperature_degc\":-0.5"},
    {GATE, "no_response", &silent, "gate/state",
     STATUS "\"no_response\",\"distance_mm\":null,\"temperature_degc\":null"},
    {GATE, NULL, &near, "gate/alarm", "\"alarm\":\"on\",\"is_on\":true,\"distance_mm\":480"},
    {GATE, NULL, &away, "gate/alarm", "\"alarm\":\"no_response\",\"is_on\":false,\"distance_mm\":null"},
};

TEST(a_message_has_what_its_topic_tells_of_a_reading)
{
    reader_t reader = {.temperature = {.is_known = true, .dc = -5}};
    sensor(GATE)->reader = &reader;
    for (size_t i = 0; i != sizeof messages / sizeof messages[0]; i++) {
        char expected[400];
        (void)publish(messages[i].sensor, messages[i].failure, messages[i].result);
        (void)snprintf(expected, sizeof expected, "%s,\"boot\":\"%s\",\"seq\":%u", messages[i].text,
                       publisher.boot, (unsigned)topic_at(messages[i].topic)->seq);
        assert_string_equal(text_at(messages[i].topic), expected);
    }
    reader.temperature.is_known = false;
    (void)publish(GATE, NULL, &target);
    assert_non_null(strstr(text_at("gate/state"), "\"temperature_degc\":null"));
    sensor(GATE)->reader = NULL;
}

TEST(a_sensor_is_away_after_three_failures_and_at_once_without_its_port)
{
    static const reading_t lost = {.status = FATHOM_ERR_PORT, .failure = "port", .result = &silent};
    reading_t reading = lost;
    topic_t *const availability = topic_at("pit/availability");
    reading.sensor = sensor(PIT);
    availability->is_due = false;
    assert_false(publish(PIT, "no_response", &silent));
    assert_false(publish(PIT, "no_response", &silent));
    assert_true(publish(PIT, "no_response", &silent));
    assert_false(publish(PIT, "no_response", &silent));
    assert_false(availability->is_due); /* it was offline before */
    (void)publish(PIT, NULL, &target);
    assert_true(availability->is_due);
    assert_true(publisher_reading(&publisher, &reading));
    assert_false(publisher_reading(&publisher, &reading));
}

TEST(each_start_has_a_number_of_its_own)
{
    char boot[sizeof publisher.boot];
    (void)strcpy(boot, publisher.boot);
    assert_int_equal(strspn(boot, "0123456789abcdef"), 16);
    publisher_deinit(&publisher);
    publisher_init(&publisher, publisher.host, NULL, &settings, &site, 0);
    assert_string_not_equal(boot, publisher.boot);
}

TEST(the_counters_of_a_sensor_have_busy_lines_other_masters_and_old_bytes)
{
    static const char *const expected[] = {"\"attempts\":9,",    "\"line_busy\":3",
                                           "\"other_master\":2", "\"busy_attempts\":3",
                                           "\"old_bytes\":17",   "\"other_master_attempts\":2"};
    counters_t *const counters = &sensor(GATE)->counters;
    char *text;
    size_t length;
    json_t json = {.to = open_memstream(&text, &length)};
    counters->attempts = 9;
    counters->failures[-FATHOM_ERR_LINE_BUSY] = counters->total.line[FATHOM_LINE_BUSY_ATTEMPTS] = 3;
    counters->failures[-FATHOM_ERR_OTHER_MASTER] = counters->total.line[FATHOM_LINE_OTHER_MASTERS] = 2;
    counters->total.line[FATHOM_LINE_OLD_BYTES] = 17;
    stats_json_of_sensor(&json, sensor(GATE));
    assert_int_equal(fclose(json.to), 0);
    for (size_t i = 0; i != sizeof expected / sizeof expected[0]; i++)
        assert_non_null(strstr(text, expected[i]));
    free(text);
}

/* ---- the queue ---- */

/* The number of each message that waits, in their order: "tank 3 gate 1". */
static void expect_queue(const char *expected)
{
    char text[200] = "";
    size_t bytes = 0;
    for (const message_t *message = publisher.queue.first; message != NULL; message = message->next) {
        const char *const seq = strstr(message->text, "\"seq\":");
        const size_t length = strlen(text);
        (void)snprintf(text + length, sizeof text - length, "%s%.4s %s", length != 0 ? " " : "",
                       message->topic->sensor->name, seq + strlen("\"seq\":"));
        bytes += message->size;
    }
    assert_string_equal(text, expected);
    assert_int_equal(publisher.queue.bytes, bytes);
}

TEST(where_one_more_does_not_fit_the_oldest_is_dropped_and_counted_in_its_topic)
{
    for (int i = 0; i != 3; i++) {
        (void)publish(GATE, NULL, &target);
        (void)publish(PIT, NULL, &target);
    }
    expect_queue("gate 2 pit 2 gate 3 pit 3");
    assert_int_equal(publisher.queue.dropped, 2);
    assert_int_equal(topic_at("gate/state")->dropped, 1);
    assert_int_equal(topic_at("pit/state")->dropped, 1);
}

TEST(the_bytes_are_a_bound_too_and_other_bounds_keep_what_fits)
{
    (void)publish(GATE, NULL, &target);
    (void)publish(PIT, NULL, &target);
    settings.queue_bytes = (uint32_t)publisher.queue.bytes;
    publisher_change(&publisher, &site, false);
    expect_queue("gate 1 gate 1 pit 1"); /* of gate the alarm too, which is unknown */
    (void)publish(PIT, NULL, &target);   /* it is shorter than gate's */
    expect_queue("gate 1 pit 1 pit 2");
    settings.queue_bytes = (uint32_t)publisher.queue.bytes - 1;
    publisher_change(&publisher, &site, false);
    expect_queue("pit 1 pit 2");
    assert_int_equal(publisher.queue.dropped, 1);
}

/* What an alarm is now is retained: a new message that the queue has no place for replaces the kept one alone. */
TEST(the_newest_change_of_an_alarm_is_kept_beside_a_full_queue)
{
    topic_t *const topic = topic_at("gate/alarm");
    (void)publish(GATE, NULL, &near);
    for (int i = 0; i != 4; i++) (void)publish(PIT, NULL, &target);
    expect_queue("pit 1 pit 2 pit 3 pit 4");
    assert_non_null(topic->kept);
    assert_int_equal(topic->kept->seq, 2); /* the first is that of the start */
    assert_true(topic->is_due && !topic->kept->is_sent);
    assert_int_equal(publisher.queue.dropped, 1);
    (void)publish(GATE, NULL, &away);
    for (int i = 0; i != 4; i++) (void)publish(PIT, NULL, &target);
    assert_int_equal(topic->kept->seq, 3);
    assert_int_equal(topic->dropped, 2);
    assert_int_equal(publisher.queue.dropped, 2 + topic_at("pit/state")->dropped);
    publisher_change(&publisher, &site, false);
    assert_non_null(topic->kept);
}

/* ---- another file ---- */

TEST(a_sensor_that_is_named_again_goes_on_with_its_numbers)
{
    const topic_t *const gate = topic_at("gate/state");
    (void)publish(GATE, NULL, &target);
    load(&next_settings, &next,
         "site: mill/north\nbroker: {host: h}\nlines:\n  - port: /dev/a\n"
         "    sensors: [{name: pit, sensor: a16}]\n");
    publisher_change(&publisher, &next, false);
    assert_false(gate->is_wanted);
    assert_false(topic_at("pit_distance/config")->is_known);
    assert_true(topic_at("pit/state")->is_wanted);
    publisher_change(&publisher, &site, false);
    (void)publish(GATE, NULL, &target);
    assert_true(gate->is_wanted);
    assert_int_equal(gate->seq, 2);
}

/* ---- discovery messages ---- */

static char *entity(size_t number, topic_kind_t kind)
{
    char *text;
    size_t length;
    json_t json = {.to = open_memstream(&text, &length)};
    json_begin(&json, NULL, '{');
    topic_json_entity(&json, &settings, kind, sensor(number), 1);
    json_end(&json, '}');
    assert_int_equal(fclose(json.to), 0);
    return text;
}

#define ORIGIN "\"origin\":{\"name\":\"fathom\",\"sw_version\":\""

/* The keys: tests/tool/e2e/test_publish.py. 3 intervals of 2 s, and 30 s. An alarm does not expire; a contact has
 * a word and no unit. */
static const struct {
    size_t sensor;
    topic_kind_t kind;
    const char *value;
} entities[] = {
    {GATE, ENTITY_TEMPERATURE,
     "{\"name\":\"temperature\",\"unique_id\":\"fathom_mill_north_gate_temperature\","
     "\"state_topic\":\"fathom/mill/north/gate/state\",\"qos\":1,"
     "\"value_template\":\"{{ value_json.temperature_degc }}\",\"device_class\":\"temperature\","
     "\"unit_of_measurement\":\"\xC2\xB0\x43\",\"state_class\":\"measurement\",\"expire_after\":36,"},
    {GATE, ENTITY_ALARM,
     "{\"name\":\"alarm\",\"unique_id\":\"fathom_mill_north_gate_alarm\","
     "\"state_topic\":\"fathom/mill/north/gate/alarm\",\"qos\":1,"
     "\"value_template\":\"{{ 'ON' if value_json.is_on else 'OFF' }}\",\"device_class\":\"problem\","},
    {PIT, ENTITY_DISTANCE,
     "{\"name\":\"contact\",\"unique_id\":\"fathom_mill_north_pit_distance\","
     "\"state_topic\":\"fathom/mill/north/pit/state\",\"qos\":1,"
     "\"value_template\":\"{{ value_json.status }}\",\"expire_after\":33,"},
    {BUMPER, ENTITY_DISTANCE,
     "{\"name\":\"distance 1\",\"unique_id\":\"fathom_mill_north_bumper__2e1_1_distance\","
     "\"state_topic\":\"fathom/mill/north/bumper.1/1/state\",\"qos\":1,"
     "\"value_template\":\"{{ value_json.distance_mm }}\",\"device_class\":\"distance\","
     "\"unit_of_measurement\":\"mm\",\"state_class\":\"measurement\",\"expire_after\":33,"},
};

TEST(an_entity_is_told_with_what_its_topic_has)
{
    static const char availability[] =
        "\"availability\":[{\"topic\":\"fathom/mill/north/status\"},"
        "{\"topic\":\"fathom/mill/north/gate/availability\"}],\"availability_mode\":\"all\","
        "\"device\":{\"identifiers\":[\"fathom_mill_north_gate\"],\"name\":\"mill/north gate\","
        "\"model\":\"hps167s\"}," ORIGIN;
    for (size_t i = 0; i != sizeof entities / sizeof entities[0]; i++) {
        char *const text = entity(entities[i].sensor, entities[i].kind);
        const size_t length = strlen(entities[i].value);
        assert_memory_equal(text, entities[i].value, length);
        assert_memory_equal(text + length, availability, strlen("\"availability\":["));
        if (entities[i].sensor == GATE)
            assert_memory_equal(text + length, availability, sizeof availability - 1);
        free(text);
    }
}
