/* SPDX-License-Identifier: MIT */
#include "commands/publish/explain.h"

#include <inttypes.h>
#include <string.h>

#include "mqtt/topics.h"

static void print_broker(const publish_settings_t *settings, FILE *to)
{
    const broker_settings_t *const broker = &settings->broker;
    (void)fprintf(to, "broker     %s port %u%s\n", broker->host, broker->port,
                  broker->has_tls ? ", TLS" : "");
    (void)fprintf(to, "client     %s%s%s\n", broker->client_id, broker->user[0] != '\0' ? ", user " : "",
                  broker->user);
    (void)fprintf(to, "queue      %" PRIu32 " messages, %" PRIu32 " bytes\n", settings->queue_messages,
                  settings->queue_bytes);
    (void)fprintf(to, "discovery  %s\n", settings->discovery[0] != '\0' ? settings->discovery : "off");
}

static void print_site_topic(const publish_settings_t *settings, const char *word, FILE *to)
{
    char topic[TOPIC];
    topic_of_site(settings, word, topic);
    (void)fprintf(to, "           %s\n", topic);
}

/* "median 5, level, alarm" */
static void print_processing(const results_config_t *processing, FILE *to)
{
    if (processing->median != 0) (void)fprintf(to, ", median %u", processing->median);
    if (processing->has_level) (void)fputs(", level", to);
    if (processing->has_alarm)
        (void)fprintf(to, ", alarm %s%u/%u", processing->alarm.when == FATHOM_NEAR ? "near<" : "far>",
                      processing->alarm.on_mm, processing->alarm.off_mm);
}

static void print_sensor(const sensor_t *sensor, FILE *to)
{
    (void)fprintf(to, "%-10s %s", sensor->name, sensor->model->name);
    if (sensor->mode->has_address) (void)fprintf(to, ":%u", sensor->address);
    (void)fprintf(to, ":%s@%s, %" PRIu32 " ms", sensor->mode->name, sensor->port->path,
                  sensor->settings.period_us / 1000);
    print_processing(&sensor->processing, to);
    (void)fputs("\n", to);
}

static void print_topics(const publish_settings_t *settings, const sensor_t *sensor, FILE *to)
{
    char topic[TOPIC];
    for (uint8_t probe = 1; probe <= FATHOM_DYP_PROBES; probe++)
        for (topic_t word = 0; word != TOPICS; word++) {
            if (!sensor_has_probe(sensor, probe) || !topic_is_there(sensor, word)) continue;
            topic_of_probe(settings, sensor, probe, word, topic);
            (void)fprintf(to, "           %s\n", topic);
        }
    topic_of_sensor(settings, sensor, "availability", topic);
    (void)fprintf(to, "           %s\n", topic);
    topic_of_sensor(settings, sensor, "counters", topic);
    (void)fprintf(to, "           %s\n", topic);
}

void explain(const publish_settings_t *settings, const site_t *site, FILE *to)
{
    print_broker(settings, to);
    print_site_topic(settings, "status", to);
    print_site_topic(settings, "publisher", to);
    for (size_t i = 0; i != site->sensor_count; i++) {
        print_sensor(site->sensors[i], to);
        print_topics(settings, site->sensors[i], to);
    }
}
