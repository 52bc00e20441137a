/* SPDX-License-Identifier: MIT */
/*
 * An HPS-167S on UART0, 19200 8E1; TX is P0.24, RX is P0.25, as on a BBC micro:bit.
 *
 *   qemu-system-arm -M microbit -kernel hps167s.elf -display none -monitor none \
 *       -semihosting-config enable=on,target=native -chardev serial,id=a,path=/dev/pts/3 -serial chardev:a
 *
 * prints its readings, and ends after 30 of them.
 */
#include "fathom/fathom.h"
#include "nrf51.h"
#include "tell.h"

static uint8_t frame[32];

int main(void)
{
    static const fathom_line_settings_t settings = {19200, FATHOM_PARITY_EVEN, 1};
    nrf51_clock_begin();
    if (!nrf51_uart_begin(24, 25, &settings)) return 2;
    const fathom_line_parts_t parts = {
        .uart = &nrf51_uart,
        .clock = &nrf51_clock,
        .frame = frame,
        .frame_size = sizeof frame,
        .echo = FATHOM_LINE_ECHO_OFF,
        .marks = fathom_line_marks,      /* the UART reports parity errors, framing errors and overruns */
        .senders = &fathom_line_senders, /* with factory settings the sensor sends measurements unasked */
        .silence_us = FATHOM_T3_5_US(19200, 11),
        /* QEMU's far end is a program of an operating system, which pauses as it likes; on a wire: 0, the default. */
        .gap_us = 25000,
    };
    fathom_line_t line;
    if (fathom_line_init(&line, &parts) != FATHOM_OK) return 2;
    const fathom_modbus_t modbus = fathom_modbus_client(&line);
    fathom_hps167s_t gate;
    if (fathom_hps167s_init(&gate, &modbus, NULL) != FATHOM_OK) return 2;

    const fathom_sensor_t sensor = fathom_hps167s_sensor(&gate);
    for (int readings = 0; readings != 30;) {
        fathom_sample_t sample;
        const fathom_status_t status = fathom_wait(&sensor, &sample, nrf51_idle, NULL);
        if (status == FATHOM_OK) {
            readings++;
            tell_sample("gate", &sample);
        } else {
            tell_error("gate", status);
        }
    }
    return 0;
}
