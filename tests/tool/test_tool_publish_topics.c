/* SPDX-License-Identifier: MIT */
/* What fathom publish writes: topics, states and discovery messages, from a configuration file to the text. */
#include "backup_desk.h"
#include "tool_bench.h"

#include <stdio.h>
#include <string.h>

#include "cli/config.h"
#include "mqtt/discovery.h"
#include "mqtt/state.h"
#include "sensors/driver.h"

static publish_settings_t settings;
static site_t site;

static const char file[] =
    "site: mill/north\n"
    "broker: {host: h}\n"
    "lines:\n"
    "  - port: /dev/a\n"
    "    sensors:\n"
    "      - {name: tank, sensor: \"a16:1:modbus\", level: {mounting: 2300, height: 2000, capacity: 5000}}\n"
    "      - {name: bumper.1, sensor: \"a05:2:modbus\", probes: \"1,3\"}\n"
    "      - {name: gate, sensor: \"hps167s:7\", temperature: 10, interval: 2000,\n"
    "         alarm: {when: near<500, unknown: on, no-response: off}}\n"
    "  - {port: gpiochip0, in: 5, sensors: [{name: pit, sensor: \"a05:relay\"}]}\n"
    "  - {port: gpiochip1, in: 6, sensors: [{name: door, sensor: \"a16:switch\"}]}\n";

enum { TANK, BUMPER, GATE, PIT, DOOR };

static void begin(void)
{
    bench_begin();
    desk_begin();
    desk_write("site.yaml", file);
    assert_true(config_load(&settings, &site, "publish", desk_path("site.yaml")));
}

static int tear_down(void **state)
{
    site_free(&site);
    return desk_end(state);
}

EACH_BEGINS(begin())

static const suite_t suite = {.set_up = begins, .tear_down = tear_down};

static sensor_t *sensor(size_t number) { return site.sensors[number]; }

/* ---- topics ---- */

TEST(a_topic_has_the_prefix_the_site_the_sensor_and_its_probe)
{
    char topic[TOPIC];
    topic_of_site(&settings, "status", topic);
    assert_string_equal(topic, "fathom/mill/north/status");
    topic_of_sensor(&settings, sensor(TANK), "availability", topic);
    assert_string_equal(topic, "fathom/mill/north/tank/availability");
    topic_of_probe(&settings, sensor(TANK), 1, TOPIC_LEVEL, topic);
    assert_string_equal(topic, "fathom/mill/north/tank/level");
    topic_of_probe(&settings, sensor(BUMPER), 3, TOPIC_STATE, topic);
    assert_string_equal(topic, "fathom/mill/north/bumper.1/3/state");
}

/* Four probes, of which two are wanted; a relay of four probes is one contact. */
TEST(a_sensor_has_the_topics_of_the_probes_that_are_wanted)
{
    static const uint8_t wanted[] = {[TANK] = 1, [BUMPER] = 1 + 4, [GATE] = 1, [PIT] = 1, [DOOR] = 1};
    for (size_t i = 0; i != sizeof wanted; i++)
        for (uint8_t probe = 1; probe <= 4; probe++)
            assert_int_equal(sensor_has_probe(sensor(i), probe), wanted[i] >> (probe - 1) & 1);
    for (size_t i = 0; i != sizeof wanted; i++) assert_int_equal(topic_has_probes(sensor(i)), i == BUMPER);
}

TEST(level_and_alarm_are_topics_of_those_that_have_them)
{
    for (size_t i = 0; i != site.sensor_count; i++) {
        assert_true(topic_is_there(sensor(i), TOPIC_STATE));
        assert_int_equal(topic_is_there(sensor(i), TOPIC_LEVEL), i == TANK);
        assert_int_equal(topic_is_there(sensor(i), TOPIC_ALARM), i == GATE);
    }
}

/* A site of 100 characters and a name of 31. */
TEST(the_longest_topic_fits)
{
    char topic[TOPIC];
    char discovered[DISCOVERY_TOPIC];
    char payload[DISCOVERY_TEXT];
    memset(settings.site, 's', SETTINGS_NAME - 1);
    memset(settings.prefix, 'p', SETTINGS_NAME - 1);
    memset(settings.discovery, 'd', SETTINGS_NAME - 1);
    memset(sensor(BUMPER)->name, 'n', 31);
    topic_of_sensor(&settings, sensor(BUMPER), "availability", topic);
    assert_int_equal(strlen(topic), 100 + 1 + 100 + 1 + 31 + 1 + 12);
    topic_of_probe(&settings, sensor(BUMPER), 4, TOPIC_STATE, topic);
    assert_string_equal(topic + 100 + 1 + 100 + 1 + 31, "/4/state");
    discovery_topic(&settings, sensor(BUMPER), 3 * ENTITIES, discovered);
    assert_string_equal(discovered + strlen(discovered) - 19, "n_4_distance/config");
    discovery_payload(&settings, sensor(BUMPER), 3 * ENTITIES, payload);
    assert_int_equal(payload[strlen(payload) - 1], '}');
}

/* ---- states ---- */

/* 2026-11-23 09:43:12.345678 is 1795426992.345678 s after 1970: `date -u -d 2026-11-23T09:43:12 +%s`. */
static reading_t reading_of(size_t number, const result_t *result)
{
    return (reading_t){.sensor = sensor(number), .result = result, .utc_us = UINT64_C(1795426992345678)};
}

#define BEGIN "{\"utc\":\"2026-11-23T09:43:12.345678Z\","
#define END   ",\"boot\":\"0123456789abcdef\",\"seq\":7,\"age_ms\":1500,\"dropped\":3}"

static void expect(const reading_t *reading, topic_t topic, const char *expected)
{
    char text[STATE_TEXT];
    state_begin(reading, topic, "0123456789abcdef", 7, text);
    state_finish(text, 1500999, 3);
    assert_string_equal(text, expected);
}

TEST(a_reading_is_a_state)
{
    const result_t result = {.sample = {.kind = FATHOM_TARGET, .distance_mm = 1500, .probe = 1}};
    const reading_t message = reading_of(BUMPER, &result);
    expect(&message, TOPIC_STATE, BEGIN "\"status\":\"target\",\"distance_mm\":1500" END);
}

TEST(what_is_no_distance_has_none)
{
    const result_t result = {.sample = {.kind = FATHOM_NO_TARGET, .distance_mm = 1500, .probe = 1}};
    const reading_t message = reading_of(TANK, &result);
    expect(&message, TOPIC_STATE, BEGIN "\"status\":\"no_target\",\"distance_mm\":null" END);
    expect(&message, TOPIC_LEVEL,
           BEGIN "\"status\":\"no_target\",\"level_mm\":null,\"level_per_mille\":null,\"volume\":null" END);
}

TEST(a_level_is_told_as_such)
{
    const result_t result = {.sample = {.kind = FATHOM_TARGET, .distance_mm = 1500, .probe = 1},
                             .has_level = true,
                             .level = {.level_mm = -5, .per_mille = 400, .volume = 2000}};
    const reading_t message = reading_of(TANK, &result);
    expect(&message, TOPIC_LEVEL,
           BEGIN "\"status\":\"target\",\"level_mm\":-5,\"level_per_mille\":400,\"volume\":2000" END);
}

TEST(a_temperature_is_told_in_degrees_once_it_is_known)
{
    const result_t result = {.sample = {.kind = FATHOM_TARGET, .distance_mm = 900, .probe = 1}};
    const reading_t message = reading_of(GATE, &result);
    reader_t reader = {.temperature = {.is_known = false}};
    sensor(GATE)->reader = &reader;
    expect(&message, TOPIC_STATE,
           BEGIN "\"status\":\"target\",\"distance_mm\":900,\"temperature_degc\":null" END);
    reader.temperature.is_known = true;
    reader.temperature.dc = -5;
    expect(&message, TOPIC_STATE,
           BEGIN "\"status\":\"target\",\"distance_mm\":900,\"temperature_degc\":-0.5" END);
    sensor(GATE)->reader = NULL;
}

TEST(a_change_of_an_alarm_is_told_with_its_distance)
{
    const result_t result = {.sample = {.kind = FATHOM_TARGET, .distance_mm = 480, .probe = 1},
                             .alarm = FATHOM_ALARM_ON,
                             .is_on = true};
    const result_t silent = {.sample = {.kind = FATHOM_UNKNOWN, .probe = 1},
                             .alarm = FATHOM_ALARM_NO_RESPONSE};
    const reading_t on = reading_of(GATE, &result);
    const reading_t off = reading_of(GATE, &silent);
    expect(&on, TOPIC_ALARM, BEGIN "\"alarm\":\"on\",\"is_on\":true,\"distance_mm\":480" END);
    expect(&off, TOPIC_ALARM, BEGIN "\"alarm\":\"no_response\",\"is_on\":false,\"distance_mm\":null" END);
}

TEST(an_attempt_that_has_failed_says_so_and_tells_no_value)
{
    const result_t none = {.has_level = false};
    reading_t message = reading_of(GATE, &none);
    message.failure = "no_response";
    reader_t reader = {.temperature = {.is_known = true}};
    sensor(GATE)->reader = &reader;
    expect(&message, TOPIC_STATE,
           BEGIN "\"status\":\"no_response\",\"distance_mm\":null,\"temperature_degc\":null" END);
    sensor(GATE)->reader = NULL;
}

TEST(the_longest_state_fits_into_a_place_of_the_queue)
{
    char text[QUEUE_TEXT];
    const result_t result = {.sample = {.kind = FATHOM_TARGET, .distance_mm = UINT16_MAX, .probe = 1},
                             .has_level = true,
                             .level = {.level_mm = INT32_MIN, .per_mille = UINT16_MAX, .volume = UINT32_MAX}};
    reading_t message = reading_of(TANK, &result);
    state_begin(&message, TOPIC_LEVEL, "0123456789abcdef", UINT64_MAX, text);
    assert_true(strlen(text) < QUEUE_TEXT / 2);
    assert_non_null(strstr(text, "\"seq\":18446744073709551615"));
}

TEST(the_counters_of_a_sensor_have_busy_lines_other_masters_and_old_bytes)
{
    char text[COUNTERS_TEXT];
    counters_t *const counters = &sensor(GATE)->counters;
    counters->attempts = 9;
    counters->failures[-FATHOM_ERR_LINE_BUSY] = 3;
    counters->failures[-FATHOM_ERR_OTHER_MASTER] = 2;
    counters->total.line[FATHOM_LINE_BUSY_ATTEMPTS] = 3;
    counters->total.line[FATHOM_LINE_OTHER_MASTERS] = 2;
    counters->total.line[FATHOM_LINE_OLD_BYTES] = 17;
    state_of_counters(sensor(GATE), UINT64_C(1795426992345678), "0123456789abcdef", text);
    assert_non_null(strstr(text, BEGIN "\"boot\":\"0123456789abcdef\",\"attempts\":9,"));
    assert_non_null(strstr(text, "\"line_busy\":3"));
    assert_non_null(strstr(text, "\"other_master\":2"));
    assert_non_null(strstr(text, "\"old_bytes\":17"));
    assert_non_null(strstr(text, "\"busy_attempts\":3"));
    assert_non_null(strstr(text, "\"other_master_attempts\":2"));
    assert_int_equal(text[strlen(text) - 1], '}');
}

TEST(the_longest_counters_fit)
{
    char text[COUNTERS_TEXT];
    memset(&sensor(GATE)->counters, 0x7F, sizeof sensor(GATE)->counters);
    state_of_counters(sensor(GATE), 0, "0123456789abcdef", text);
    assert_true(strlen(text) < COUNTERS_TEXT - 100);
    assert_int_equal(text[strlen(text) - 1], '}');
}

TEST(the_publisher_tells_of_itself)
{
    char text[STATE_TEXT];
    const publisher_state_t message = {.boot = "0123456789abcdef",
                                       .utc_us = UINT64_C(1795426992345678),
                                       .uptime_us = 61999999,
                                       .dropped = 12,
                                       .queued = 3,
                                       .sensors = 5};
    state_of_publisher(&message, text);
    assert_non_null(strstr(text, BEGIN "\"version\":\""));
    assert_non_null(strstr(text,
                           "\",\"boot\":\"0123456789abcdef\",\"uptime_s\":61,\"sensors\":5,\"queued\":3,"
                           "\"dropped\":12}"));
}

TEST(each_start_has_a_number_of_its_own)
{
    char one[BOOT];
    char other[BOOT];
    state_boot(one);
    state_boot(other);
    assert_int_equal(strlen(one), 16);
    assert_int_equal(strspn(one, "0123456789abcdef"), 16);
    assert_string_not_equal(one, other);
}

/* ---- discovery ---- */

static uint32_t bits_of(size_t number) { return discovery_all(&settings, sensor(number)); }

TEST(each_entity_that_a_sensor_has_is_told)
{
    enum { DISTANCE = 1 << ENTITY_DISTANCE };
    assert_int_equal(bits_of(TANK), DISTANCE | 1 << ENTITY_LEVEL | 1 << ENTITY_FILLED);
    assert_int_equal(bits_of(BUMPER), DISTANCE | DISTANCE << 2 * ENTITIES);
    assert_int_equal(bits_of(GATE), DISTANCE | 1 << ENTITY_TEMPERATURE | 1 << ENTITY_ALARM);
    assert_int_equal(bits_of(PIT), DISTANCE);
    settings.discovery[0] = '\0';
    assert_int_equal(bits_of(TANK), 0);
}

/* The keys: tests/tool/e2e/test_publish_discovery.py. 3 intervals of 2 s, and 30 s. */
TEST(an_entity_is_told_with_what_its_topics_have)
{
    char topic[DISCOVERY_TOPIC];
    char text[DISCOVERY_TEXT];
    discovery_topic(&settings, sensor(GATE), ENTITY_TEMPERATURE, topic);
    assert_string_equal(topic, "homeassistant/sensor/fathom_mill_north_gate_temperature/config");
    discovery_payload(&settings, sensor(GATE), ENTITY_TEMPERATURE, text);
    static const char expected[] =
        "{\"name\":\"temperature\",\"unique_id\":\"fathom_mill_north_gate_temperature\","
        "\"state_topic\":\"fathom/mill/north/gate/state\",\"qos\":1,"
        "\"value_template\":\"{{ value_json.temperature_degc }}\",\"device_class\":\"temperature\","
        "\"unit_of_measurement\":\"\xC2\xB0\x43\",\"state_class\":\"measurement\",\"expire_after\":36,"
        "\"availability\":[{\"topic\":\"fathom/mill/north/status\"},"
        "{\"topic\":\"fathom/mill/north/gate/availability\"}],\"availability_mode\":\"all\","
        "\"device\":{\"identifiers\":[\"fathom_mill_north_gate\"],\"name\":\"mill/north "
        "gate\",\"model\":\"hps167s\"},"
        "\"origin\":{\"name\":\"fathom\",\"sw_version\":\"";
    assert_memory_equal(text, expected, sizeof expected - 1);
    assert_string_equal(text + strlen(text) - 3, "\"}}");
}

TEST(a_contact_tells_a_word_and_no_distance)
{
    char text[DISCOVERY_TEXT];
    discovery_payload(&settings, sensor(PIT), ENTITY_DISTANCE, text);
    assert_non_null(strstr(text, "{\"name\":\"contact\","));
    assert_non_null(strstr(text, "\"value_template\":\"{{ value_json.status }}\",\"expire_after\""));
    assert_null(strstr(text, "unit_of_measurement"));
    assert_null(strstr(text, "device_class"));
}

TEST(an_alarm_is_a_binary_sensor_that_does_not_expire)
{
    char topic[DISCOVERY_TOPIC];
    char text[DISCOVERY_TEXT];
    discovery_topic(&settings, sensor(GATE), ENTITY_ALARM, topic);
    assert_string_equal(topic, "homeassistant/binary_sensor/fathom_mill_north_gate_alarm/config");
    discovery_payload(&settings, sensor(GATE), ENTITY_ALARM, text);
    assert_non_null(strstr(text, "\"state_topic\":\"fathom/mill/north/gate/alarm\""));
    assert_non_null(strstr(text, "\"value_template\":\"{{ 'ON' if value_json.is_on else 'OFF' }}\","
                                 "\"device_class\":\"problem\""));
    assert_null(strstr(text, "expire_after"));
}
