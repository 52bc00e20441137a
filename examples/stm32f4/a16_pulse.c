/* SPDX-License-Identifier: MIT */
/*
 * An A16 with PWM output: its RX is triggered by PB1, its TX is at PA0, TIM2_CH1, where TIM2 captures both edges. The
 * pin of the A16 is high at 3 V, and PA0 wants 2 V for a high level.
 *
 * Never run: no simulator here has TIM2's captures. It is compiled, and the parts of it are tested apart: the driver
 * and edges.h everywhere, the clock and the sleep on QEMU, the capture on memory in place of its registers.
 */
#include "board.h"
#include "fathom/fathom.h"
#include "fathom_stm32f4.h"
#include "start.h"

static fathom_edges_t edges;

void tim2_interrupt(void) { fathom_stm32f4_tim2_interrupt(); }
void tim5_interrupt(void) { fathom_stm32f4_tim5_interrupt(); }

int main(void)
{
    static const fathom_stm32f4_pin_t trigger_pin = {'B', 1};
    static const fathom_stm32f4_pin_t pulse_pin = {'A', 0};
    const board_clocks_t *const clocks = board_begin();
    fathom_stm32f4_clock_init(clocks->timer_hz);
    const fathom_pin_t trigger = fathom_stm32f4_output(&trigger_pin);
    const fathom_pin_t level = fathom_stm32f4_input(&pulse_pin, FATHOM_STM32F4_DOWN);
    fathom_edges_init(&edges, &level);
    if (!fathom_stm32f4_capture_init(&pulse_pin, &edges)) return 2;
    const fathom_capture_t capture = fathom_edges_capture(&edges);

    fathom_a16_pwm_t tank;
    const fathom_output_t output = fathom_output_pin(&trigger);
    if (fathom_a16_pwm_init(&tank, &capture, &fathom_stm32f4_clock, &output, NULL) != FATHOM_OK) return 2;
    const fathom_sensor_t sensor = fathom_a16_pwm_sensor(&tank);
    fathom_stm32f4_idle_t idle = {NULL, 0};
    for (;;) {
        fathom_sample_t sample;
        const fathom_status_t status = fathom_wait(&sensor, &sample, fathom_stm32f4_idle, &idle);
        if (status == FATHOM_OK)
            board_use(&sample);
        else
            board_fail(status);
    }
}
