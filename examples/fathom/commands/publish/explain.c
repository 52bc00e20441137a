/* SPDX-License-Identifier: MIT */
#include "commands/publish/explain.h"

#include <inttypes.h>
#include <string.h>

#include "mqtt/topics.h"
#include "ports/line_text.h"

static void explain_broker(const config_t *config, FILE *to)
{
    const broker_config_t *const broker = &config->broker;
    (void)fprintf(to, "broker %s port %u, client %s", broker->host, broker->port, broker->client_id);
    if (broker->user[0] != '\0') (void)fprintf(to, ", user %s", broker->user);
    if (broker->password_file[0] != '\0') (void)fprintf(to, ", password from %s", broker->password_file);
    if (broker->has_tls && broker->ca_file[0] != '\0')
        (void)fprintf(to, ", TLS with the authorities of %s", broker->ca_file);
    else
        (void)fputs(broker->has_tls ? ", TLS with the system's authorities" : ", no TLS", to);
    if (broker->certificate_file[0] != '\0') (void)fprintf(to, ", certificate %s", broker->certificate_file);
    (void)fprintf(to, "\nwhile it is away up to %" PRIu32 " messages and %" PRIu32 " bytes are kept\n",
                  config->queue_messages, config->queue_bytes);
    if (config->discovery[0] != '\0')
        (void)fprintf(to, "Home Assistant finds the sensors below %s/\n", config->discovery);
    else
        (void)fputs("Home Assistant is not told of the sensors\n", to);
}

static void explain_port(const port_options_t *port, const station_t *station, FILE *to)
{
    (void)fprintf(to, " at %s", port->path);
    if (port_kind(port->path) == PORT_TTY) {
        char line[LINE_TEXT];
        (void)fprintf(to, " (%s)", line_text(&station->line, line));
    }
}

static void explain_alarm(const results_config_t *results, FILE *to)
{
    const fathom_alarm_config_t *const alarm = &results->alarm;
    (void)fprintf(to, ", alarm on %s %u mm and off %s %u mm, %s without a distance and %s without a response",
                  alarm->when == FATHOM_NEAR ? "below" : "above", alarm->on_mm,
                  alarm->when == FATHOM_NEAR ? "above" : "below", alarm->off_mm,
                  alarm->if_unknown == FATHOM_ALARM_ON ? "on" : "off",
                  alarm->if_no_response == FATHOM_ALARM_ON ? "on" : "off");
}

static void explain_sensor(const config_t *config, const results_config_t *results, const station_t *station,
                           FILE *to)
{
    char topic[TOPIC];
    (void)fprintf(to, "\n%s: %s in mode %s", station->name, station->model->name, station->mode->name);
    if (station->mode->has_address) (void)fprintf(to, ", address %u,", station->address);
    explain_port(&config->sensors.ports[station->port], station, to);
    if (station->settings.period_us != 0)
        (void)fprintf(to, ", every %" PRIu32 " ms", station->settings.period_us / 1000);
    else
        (void)fputs(", as fast as it can", to);
    if (results->median != 0) (void)fprintf(to, ", median of %u", results->median);
    if (results->gate_mm != 0)
        (void)fprintf(to, " without what is farther than %u mm from it", results->gate_mm);
    if (results->has_level)
        (void)fprintf(to, ", level in a tank of %u mm under %u mm", results->tank.height_mm,
                      results->tank.mounting_mm);
    if (results->has_alarm) explain_alarm(results, to);
    (void)fputs("\n", to);
    for (uint8_t probe = 1; probe <= station->model->probes; probe++)
        for (topic_t word = 0; word != TOPICS; word++) {
            if (!topic_wants_probe(station, probe) || !topic_is_there(results, word)) continue;
            topic_of_probe(config, station, probe, word, topic);
            (void)fprintf(to, "  %s\n", topic);
        }
    topic_of_sensor(config, station, "availability", topic);
    (void)fprintf(to, "  %s\n", topic);
}

void explain(const config_t *config, config_results_t results, FILE *to)
{
    char topic[TOPIC];
    const sensor_options_t *const sensors = &config->sensors;
    (void)fprintf(to, "%s: %zu sensor%s at %zu port%s\n", config->path, sensors->station_count,
                  sensors->station_count == 1 ? "" : "s", sensors->port_count,
                  sensors->port_count == 1 ? "" : "s");
    explain_broker(config, to);
    topic_of_site(config, "status", topic);
    (void)fprintf(to, "  %s\n", topic);
    topic_of_site(config, "publisher", topic);
    (void)fprintf(to, "  %s\n", topic);
    for (size_t i = 0; i != sensors->station_count; i++)
        explain_sensor(config, &results[sensors->stations[i]->slot], sensors->stations[i], to);
    (void)fputs("\nNothing was opened or sent.\n", to);
}
