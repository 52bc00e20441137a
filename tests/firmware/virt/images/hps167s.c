/* SPDX-License-Identifier: MIT */
/*
 * An HPS-167S on the UART of QEMU's virt, 19200 8E1:
 *
 *   qemu-system-riscv32 -M virt -bios none -kernel hps167s.elf -display none -monitor none \
 *       -semihosting-config enable=on,target=native -chardev serial,id=a,path=/dev/pts/3 -serial chardev:a
 *
 * prints its readings, and ends after 30 of them.
 */
#include "fathom/fathom.h"
#include "fathom_virt.h"
#include "start.h"
#include "tell.h"

static fathom_virt_uart_t port;
static uint8_t request[8];
static uint8_t frame[32];

void external_interrupt(void) { fathom_virt_external_interrupt(&port); }
void timer_interrupt(void) { fathom_virt_timer_interrupt(); }

int main(void)
{
    const fathom_virt_uart_config_t port_config = {
        .request = request,
        .request_size = sizeof request,
        .clock_hz = FATHOM_VIRT_UART_HZ,
        .line = {19200, FATHOM_PARITY_EVEN, 1},
    };
    if (!fathom_virt_uart_begin(&port, &port_config)) return 2;
    const fathom_uart_t uart = fathom_virt_uart(&port);
    const fathom_line_parts_t config = {
        .uart = &uart,
        .clock = &fathom_virt_clock,
        .frame = frame,
        .frame_size = sizeof frame,
        .echo = FATHOM_LINE_ECHO_OFF,
        .marks = fathom_line_marks,
        .silence_us = FATHOM_T3_5_US(19200, 11),
        /* QEMU's far end is a program of an operating system, which pauses as it likes; on a wire: 0, the default. */
        .gap_us = 25000,
    };
    fathom_line_t line;
    if (fathom_line_init(&line, &config) != FATHOM_OK) return 2;
    const fathom_modbus_t modbus = fathom_modbus_client(&line);
    fathom_hps167s_t gate;
    if (fathom_hps167s_init(&gate, &modbus, NULL) != FATHOM_OK) return 2;

    const fathom_sensor_t sensor = fathom_hps167s_sensor(&gate);
    for (int readings = 0; readings != 30;) {
        fathom_sample_t sample;
        const fathom_status_t status = fathom_wait(&sensor, &sample, fathom_virt_idle, &port);
        if (status == FATHOM_OK) {
            readings++;
            tell_sample("gate", &sample);
        } else {
            tell_error("gate", status);
        }
    }
    return 0;
}
