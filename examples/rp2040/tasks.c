/* SPDX-License-Identifier: MIT */
#include "tasks.h"
#include "board.h"
#include "fathom/engine/modbus_client.h"
#include "fathom/engine/wait.h"
#include "fathom/sensor/a16_modbus.h"
#include "fathom/sensor/hps167s.h"
#include "fathom_rp2040.h"
#include "task.h"
#include "vectors.h"

/*
 * One task a line, each written as if it were alone, and one that blinks:
 *   tank   an A16 with RS232 or RS485, address 1, on UART0: 9600 8N1, TX at GPIO 0, RX at GPIO 1
 *   gate   an HPS-167S, address 1, on UART1: 19200 8E1, DI at GPIO 4, RO at GPIO 5, DE and /RE at GPIO 6
 *   lamp   GPIO 25, the other way every 250 ms; GPIO 15 is high while one of the two sees something within 1 m
 * A line, its drivers and fathom_wait belong to one task. The receive interrupt gives the semaphore that the task takes
 * in fathom_wait's idle hook. What tasks tell each other is in `tank` and `gate`.
 */
enum { TANK_TX = 0, TANK_RX = 1, DI = 4, RO = 5, DE = 6, LAMP = 25, NEAR = 15 };
enum { DE_ALARM = 0, IDLE_ALARM = 3, NEAR_MM = 1000, BLINK_US = 250000 };

tasks_reading_t tank, gate;

static fathom_rp2040_idle_t idle = {.alarm = IDLE_ALARM};
static fathom_rp2040_uart_t tank_uart;
static fathom_rp2040_uart_t gate_uart;
static task_semaphore_t tank_came;
static task_semaphore_t gate_came;
static task_semaphore_t news;

void uart0_irq(void)
{
    fathom_rp2040_uart_interrupt(&tank_uart);
    task_give(&tank_came);
}

void uart1_irq(void)
{
    fathom_rp2040_uart_interrupt(&gate_uart);
    task_give(&gate_came);
}

void timer_irq_0(void)
{
    fathom_rp2040_uart_alarm(&gate_uart);
    task_give(&gate_came); /* the request has left */
}

void timer_irq_3(void) { fathom_rp2040_idle_alarm(&idle); }

static void tell(tasks_reading_t *reading, fathom_status_t status, const fathom_sample_t *sample)
{
    if (status == FATHOM_OK) {
        reading->readings++;
        reading->distance_mm = sample->kind == FATHOM_TARGET ? sample->distance_mm : UINT16_MAX;
    } else {
        reading->errors++;
        reading->distance_mm = UINT16_MAX;
    }
    reading->status = status;
    task_give(&news);
}

/* Reports a configuration that `init` refused, and ends the task: it waits for a semaphore that nothing gives. */
static void end(tasks_reading_t *reading, fathom_status_t status)
{
    static task_semaphore_t never;
    tell(reading, status, NULL);
    for (;;) task_take(&never, FATHOM_NO_DEADLINE);
}

static void read_tank(void)
{
    const fathom_uart_t uart = fathom_rp2040_uart(&tank_uart);
    uint8_t frame[16];
    fathom_line_t line;
    const fathom_line_parts_t line_parts = {
        .uart = &uart,
        .clock = &fathom_rp2040_clock,
        .frame = frame,
        .frame_size = sizeof frame,
        .echo = FATHOM_LINE_ECHO_OFF,
        .marks = fathom_line_marks,
        .silence_us = FATHOM_T3_5_US(9600, 10),
    };
    fathom_status_t status = fathom_line_init(&line, &line_parts);
    if (status != FATHOM_OK) end(&tank, status);
    const fathom_modbus_t modbus = fathom_modbus_client(&line);
    fathom_a16_modbus_t a16;
    const fathom_a16_modbus_config_t config = {.value = FATHOM_REAL_TIME};
    status = fathom_a16_modbus_init(&a16, &modbus, &config);
    if (status != FATHOM_OK) end(&tank, status);
    const fathom_sensor_t sensor = fathom_a16_modbus_sensor(&a16);
    for (;;) {
        fathom_sample_t sample;
        status = fathom_wait(&sensor, &sample, task_take, &tank_came);
        tell(&tank, status, &sample);
    }
}

static void read_gate(void)
{
    const fathom_uart_t uart = fathom_rp2040_uart(&gate_uart);
    uint8_t frame[32];
    fathom_line_t line;
    const fathom_line_parts_t line_parts = {
        .uart = &uart,
        .clock = &fathom_rp2040_clock,
        .frame = frame,
        .frame_size = sizeof frame,
        .echo = FATHOM_LINE_ECHO_OFF,
        .marks = fathom_line_marks,
        .senders = &fathom_line_senders, /* with factory settings the sensor sends measurements unasked */
        .silence_us = FATHOM_T3_5_US(19200, 11),
    };
    fathom_status_t status = fathom_line_init(&line, &line_parts);
    if (status != FATHOM_OK) end(&gate, status);
    const fathom_modbus_t modbus = fathom_modbus_client(&line);
    fathom_hps167s_t hps;
    status = fathom_hps167s_init(&hps, &modbus, NULL);
    if (status != FATHOM_OK) end(&gate, status);
    const fathom_sensor_t sensor = fathom_hps167s_sensor(&hps);
    for (;;) {
        fathom_sample_t sample;
        status = fathom_wait(&sensor, &sample, task_take, &gate_came);
        tell(&gate, status, &sample);
    }
}

static void blink(void)
{
    const fathom_pin_t lamp = fathom_rp2040_output(LAMP, false);
    const fathom_pin_t near = fathom_rp2040_output(NEAR, false);
    uint32_t since_us = fathom_rp2040_clock.now_us(fathom_rp2040_clock.ctx);
    bool on = false;
    for (;;) {
        const uint32_t now_us = fathom_rp2040_clock.now_us(fathom_rp2040_clock.ctx);
        const uint32_t passed_us = fathom_elapsed_us(now_us, since_us);
        if (passed_us >= BLINK_US) {
            since_us += BLINK_US;
            on = !on;
            lamp.set(lamp.ctx, on);
            continue;
        }
        near.set(near.ctx, tank.distance_mm < NEAR_MM || gate.distance_mm < NEAR_MM);
        task_take(&news, BLINK_US - passed_us);
    }
}

int main(void)
{
    static uint8_t tank_request[8], gate_request[8];
    static const fathom_rp2040_uart_config_t tank_config = {
        .wiring = {.clk_peri_hz = BOARD_CLK_PERI_HZ, .number = 0, .tx = TANK_TX, .rx = TANK_RX},
        .line = {.baud = 9600, .parity = FATHOM_PARITY_NONE, .stop_bits = 1},
        .request = tank_request,
        .request_size = sizeof tank_request,
    };
    static const fathom_rp2040_uart_config_t gate_config = {
        .wiring = {.clk_peri_hz = BOARD_CLK_PERI_HZ,
                   .number = 1,
                   .tx = DI,
                   .rx = RO,
                   .has_driver = true,
                   .driver = DE,
                   .alarm = DE_ALARM},
        .line = {.baud = 19200, .parity = FATHOM_PARITY_EVEN, .stop_bits = 1},
        .request = gate_request,
        .request_size = sizeof gate_request,
    };
    static task_t tank_task, gate_task, lamp_task;
    tank.distance_mm = gate.distance_mm = UINT16_MAX;
    fathom_rp2040_clock_init(BOARD_CLK_REF_HZ);
    fathom_rp2040_idle_init(&idle);
    if (!fathom_rp2040_uart_init(&tank_uart, &tank_config)) return 1;
    if (!fathom_rp2040_uart_init(&gate_uart, &gate_config)) return 2;
    task_start(&tank_task, read_tank);
    task_start(&gate_task, read_gate);
    task_start(&lamp_task, blink);
    task_run(&idle);
    return 3;
}
