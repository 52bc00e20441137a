/* SPDX-License-Identifier: MIT */
/*
 * Both ways to take pulses at once, on one signal at PB0 (ICP1) and PD2 (INT0). Each pulse is a record, of kind 1 by
 * ICP1 and of kind 2 by INT0: its width and its end in us, the low byte first, and how many edges were missed so far.
 * What comes at the UART, 115200 8N1, goes back there, so that traffic brings all of its interrupts.
 */
#include <avr/interrupt.h>
#include <avr/io.h>

#include "fathom/engine/edges.h"
#include "fathom_avr.h"

static uint8_t sending[1];
static const fathom_avr_usart_config_t usart = {
    .request = sending, .request_size = sizeof sending, .line = {115200, FATHOM_PARITY_NONE, 1}};

static const fathom_avr_pin_t icp1_at = {&PORTB, _BV(PB0)};
static const fathom_avr_pin_t int0_at = {&PORTD, _BV(PD2)};
static fathom_edges_t by_icp1, by_int0;

static void tell_us(uint32_t us)
{
    for (uint8_t i = 0; i != 4; i++, us >>= 8) GPIOR0 = (uint8_t)us;
}

static void tell(const fathom_capture_t *capture, const fathom_edges_t *edges, uint8_t which)
{
    fathom_pulse_t pulse;
    if (capture->take(capture->ctx, &pulse) != 1) return;
    tell_us(pulse.width_us);
    tell_us(pulse.end_us);
    GPIOR0 = edges->missed;
    GPIOR1 = which;
    capture->arm(capture->ctx); /* as a meter does for each pulse */
}

int main(void)
{
    fathom_avr_clock_init();
    const fathom_pin_t icp1 = fathom_avr_input(&icp1_at, false);
    const fathom_pin_t int0 = fathom_avr_input(&int0_at, false);
    fathom_edges_init(&by_icp1, &icp1);
    fathom_edges_init(&by_int0, &int0);
    const fathom_capture_t captured = fathom_edges_capture(&by_icp1);
    const fathom_capture_t seen = fathom_edges_capture(&by_int0);
    fathom_avr_icp1_init(&by_icp1);
    fathom_avr_int0_init(&by_int0);
    if (!fathom_avr_usart0_init(&usart)) return 1;
    sei();
    captured.arm(captured.ctx);
    seen.arm(seen.ctx);
    for (;;) {
        uint8_t byte;
        fathom_rx_t rx = {0};
        tell(&captured, &by_icp1, 1);
        tell(&seen, &by_int0, 2);
        if (fathom_avr_usart0.read(NULL, &byte, 1, &rx) == 1) fathom_avr_usart0.write(NULL, &byte, 1);
        fathom_avr_idle(NULL, FATHOM_NO_DEADLINE);
    }
}
