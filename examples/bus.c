/* SPDX-License-Identifier: MIT */
/*
 * Three sensors on one RS-485 pair, read in one loop: an A16 and an A05 at 9600 8N1 beside an HPS-167S at 19200 8E1.
 *
 *   example_bus              against simulated sensors, in simulated time: 12 seconds in no time
 *   example_bus PATH [S]     on a serial port, for S seconds (default 10): A16 at address 1, A05 at 2, HPS-167S at 7
 *
 * What a firmware takes from here is bus_init and the loop in read_bus; only the two functions at the end know Linux
 * or the simulator. With a sensor that falls silent (the simulated A05 loses its power for six seconds) the others
 * are read as before: the driver asks it less and less often until it answers again.
 */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "fathom/fathom.h"
#include "fathom_posix.h"
#include "sim/a05.h"
#include "sim/a16.h"
#include "sim/hps167s.h"
#include "sim/scene.h"
#include "sim/sim.h"
#include "sim/uart.h"

enum { A16 = 0, A05 = 1, HPS = 2, SENSORS = 3 };

static const char *const names[SENSORS] = {"A16", "A05", "HPS-167S"};

/* Whatever is on a line where settings differ has to name its own. They are read at each request. */
static const fathom_line_settings_t ultrasonic = {9600, FATHOM_PARITY_NONE, 1};
static const fathom_line_settings_t infrared = {19200, FATHOM_PARITY_EVEN, 1};

/* All memory of the bus; nothing is allocated. */
typedef struct {
    fathom_line_parts_t parts;
    uint8_t frame[32];
    fathom_line_t line;
    fathom_fair_share_t share;
    fathom_modbus_t modbus;
    fathom_a16_modbus_t a16;
    fathom_a05_modbus_t a05;
    fathom_hps167s_t hps;
    fathom_sensor_t sensors[SENSORS];
    const fathom_modbus_unit_t *units[SENSORS]; /* their counters */
    uint32_t start_us;
} bus_t;

static bool bus_init(bus_t *bus, const fathom_uart_t *uart, const fathom_clock_t *clock)
{
    bus->parts = (fathom_line_parts_t){
        .uart = uart,
        .clock = clock,
        .frame = bus->frame,
        .frame_size = sizeof bus->frame,
        .find_echo = fathom_line_find_echo,
        /* With factory settings an HPS-167S sends unsolicited measurements, and a Modbus master may share the pair. */
        .senders = &fathom_line_senders,
        .masters = &fathom_line_masters,
        /* The silence after which the slowest of the three recognises the end of a frame. */
        .silence_us = FATHOM_T3_5_US(9600, 10),
        /* A frame that broke off is given up after this; a USB adapter holds bytes back for up to 16 ms. */
        .gap_us = 25000,
    };
    if (fathom_line_init(&bus->line, &bus->parts) != FATHOM_OK) return false;
    /* If the requests alternated, the HPS-167S would get one for each of the slow ones: twice a second. */
    fathom_fair_share(&bus->share, &bus->line);
    bus->modbus = fathom_modbus_client(&bus->line);

    const fathom_a16_modbus_config_t a16 = {
        .modbus.line_settings = &ultrasonic,
        .modbus.address = 1,
        .value = FATHOM_REAL_TIME,
    };
    const fathom_a05_modbus_config_t a05 = {
        .modbus.line_settings = &ultrasonic,
        .modbus.address = 2,
        /* If the sensor is silent, it gets a request every two seconds; the default is 16 time-outs, 9.6 s. */
        .modbus.backoff_us = 2000000,
    };
    const fathom_hps167s_config_t hps = {
        .modbus.line_settings = &infrared,
        .modbus.address = 7,
    };
    if (fathom_a16_modbus_init(&bus->a16, &bus->modbus, &a16) != FATHOM_OK ||
        fathom_a05_modbus_init(&bus->a05, &bus->modbus, &a05) != FATHOM_OK ||
        fathom_hps167s_init(&bus->hps, &bus->modbus, &hps) != FATHOM_OK)
        return false;

    bus->sensors[A16] = fathom_a16_modbus_sensor(&bus->a16);
    bus->sensors[A05] = fathom_a05_modbus_sensor(&bus->a05);
    bus->sensors[HPS] = fathom_hps167s_sensor(&bus->hps);
    bus->units[A16] = fathom_a16_modbus_unit(&bus->a16);
    bus->units[A05] = fathom_a05_modbus_unit(&bus->a05);
    bus->units[HPS] = fathom_hps167s_unit(&bus->hps);
    bus->start_us = clock->now_us(clock->ctx);
    return true;
}

static void use(uint32_t time_us, int i, fathom_status_t status, const fathom_sample_t *sample)
{
    (void)printf("%8.3f s  %-8s ", time_us / 1000000.0, names[i]);
    if (status < 0)
        (void)printf("no reading: %s\n", fathom_status_name(status));
    else if (sample->kind == FATHOM_TARGET)
        (void)printf("probe %u  %5u mm\n", sample->probe, sample->distance_mm);
    else
        (void)printf("probe %u  %s\n", sample->probe,
                     sample->kind == FATHOM_NO_TARGET ? "no target" : "no distance");
}

/* The main loop; ends `until_us` after the start. `idle` sleeps until bytes arrive or a driver is due; a loop with
 * other work needs none. */
static void read_bus(bus_t *bus, uint32_t until_us, fathom_idle_t idle, void *idle_ctx)
{
    const fathom_clock_t *const clock = bus->parts.clock;
    for (;;) {
        const uint32_t time_us = fathom_elapsed_us(clock->now_us(clock->ctx), bus->start_us);
        bool is_idle = true;
        if (time_us >= until_us) return;
        for (int i = 0; i != SENSORS; i++) {
            fathom_sample_t sample;
            const fathom_status_t status = fathom_poll(&bus->sensors[i], &sample);
            if (status == FATHOM_PENDING) continue;
            use(time_us, i, status, &sample);
            is_idle = false;
        }
        if (is_idle) {
            const uint32_t left_us = until_us - time_us;
            const uint32_t due_us = fathom_due_us(bus->sensors, SENSORS);
            idle(idle_ctx, due_us < left_us ? due_us : left_us);
        }
    }
}

static void tell(const bus_t *bus)
{
    for (int i = 0; i != SENSORS; i++)
        (void)printf("%-8s responses %u, failures %u, time-outs in a row %u, left alone for %.1f s\n",
                     names[i], fathom_modbus_unit_responses(bus->units[i]),
                     fathom_modbus_unit_failures(bus->units[i]), bus->units[i]->timeouts_in_row,
                     bus->units[i]->backoff_left_us / 1000000.0);
}

/* ---- where it runs ---- */

static int on_port(bus_t *bus, const char *path, uint32_t seconds)
{
    fathom_posix_uart_t port;
    if (fathom_posix_open(&port, path, &ultrasonic) != FATHOM_POSIX_OK) {
        (void)fprintf(stderr, "example_bus: %s\n", fathom_posix_error_text(&port));
        return 1;
    }
    const fathom_uart_t uart = fathom_posix_uart(&port);
    const fathom_clock_t clock = fathom_posix_clock();
    const bool is_right = bus_init(bus, &uart, &clock);
    if (is_right) {
        read_bus(bus, seconds * 1000000u, fathom_posix_wait, &port);
        tell(bus);
    }
    fathom_posix_close(&port);
    return is_right ? 0 : 1;
}

static int simulated(bus_t *bus)
{
    static fathom_sim_line_t wire;
    static fathom_sim_a16_t a16;
    static fathom_sim_a05_t a05;
    static fathom_sim_hps167s_t hps;
    fathom_sim_fixed_t tank = {{1953}};
    fathom_sim_fixed_t bumper = {{1000, 2000, FATHOM_SIM_NO_TARGET, 3562}};
    fathom_sim_fixed_t gate = {{2083}};
    fathom_sim_clock_t time;
    fathom_sim_uart_t end;
    fathom_sim_clock_init(&time, 0, 0);
    fathom_sim_line_init(&wire, &ultrasonic, time.now_us);
    fathom_sim_a16_init(&a16, &(fathom_sim_a16_config_t){.address = 1,
                                                         .mode = FATHOM_SIM_A16_MODBUS,
                                                         .scene = fathom_sim_fixed(&tank)});
    fathom_sim_a05_init(&a05, &(fathom_sim_a05_config_t){.address = 2,
                                                         .mode = FATHOM_SIM_A05_MODBUS,
                                                         .scene = fathom_sim_fixed(&bumper)});
    fathom_sim_hps167s_init(&hps,
                            &(fathom_sim_hps167s_config_t){.address = 7, .scene = fathom_sim_fixed(&gate)});
    fathom_sim_attach(&wire, &a16.device, time.now_us);
    fathom_sim_attach(&wire, &a05.device, time.now_us);
    fathom_sim_attach(&wire, &hps.device, time.now_us);
    fathom_sim_uart_init(&end, &wire, &time);
    const fathom_uart_t uart = fathom_sim_uart(&end);
    const fathom_clock_t clock = fathom_sim_clock(&time);
    if (!bus_init(bus, &uart, &clock)) return 1;
    read_bus(bus, 3000000, fathom_sim_clock_idle, &time);
    (void)printf("-- the A05 loses its power\n");
    fathom_sim_detach(&wire, &a05.device, time.now_us);
    read_bus(bus, 9000000, fathom_sim_clock_idle, &time);
    tell(bus);
    (void)printf("-- it has power again\n");
    fathom_sim_attach(&wire, &a05.device, time.now_us);
    read_bus(bus, 12000000, fathom_sim_clock_idle, &time);
    tell(bus);
    return 0;
}

int main(int argc, char **argv)
{
    static bus_t bus;
    if (argc < 2) return simulated(&bus);
    return on_port(&bus, argv[1], argc > 2 ? (uint32_t)strtoul(argv[2], NULL, 10) : 10);
}
