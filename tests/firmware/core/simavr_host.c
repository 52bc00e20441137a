/* SPDX-License-Identifier: MIT */
#include <simavr/sim_avr.h>
#include <simavr/sim_core.h>
#include <simavr/sim_elf.h>
#include <stdio.h>
#include <stdlib.h>

/*
 * simavr_host IMAGE CYCLES: runs a program for an ATmega2560 with external RAM up to the last address, FFFF, until
 * its main returns, and prints what it writes to GPIOR0. The exit status is main's; 124 when it did not end within so
 * many millions of cycles, 125 when it crashed or its stack met its data, 2 when it could not be loaded.
 */
enum {
    GPIOR0 = 0x3E,
    SPL = 0x5D,
    SPH = 0x5E,
    R24 = 24,                /* the low byte of what a function returns */
    RJMP_TO_ITSELF = 0xCFFF, /* with interrupts off the end of avr-libc's exit and abort */
    RAM_BEGIN = 0x200,
    RAM_END = 0xFFFF
};

static void put(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param)
{
    (void)avr;
    (void)address;
    (void)param;
    putchar(value);
}

static unsigned word_at(const uint8_t *bytes) { return bytes[0] | (unsigned)bytes[1] << 8; }

int main(int argc, char **argv)
{
    elf_firmware_t firmware = {.frequency = 16000000};
    if (argc != 3 || elf_read_firmware(argv[1], &firmware) != 0) return 2;
    const avr_cycle_count_t limit = strtoull(argv[2], NULL, 10) * 1000000;
    const unsigned data_end = RAM_BEGIN + firmware.datasize + firmware.bsssize;
    avr_t *const avr = avr_make_mcu_by_name("atmega2560");
    if (avr == NULL) return 2;
    avr->ramend = RAM_END;
    avr_init(avr);
    avr_load_firmware(avr, &firmware);
    avr_register_io_write(avr, GPIOR0, put, NULL);

    unsigned least_sp = RAM_END;
    while (avr->cycle < limit && avr->state == cpu_Running) {
        avr->pc = avr_run_one(avr); /* avr_run is for timers and interrupts, of which there are none */
        const unsigned sp = word_at(avr->data + SPL);
        if (sp >= RAM_BEGIN && sp < least_sp) least_sp = sp; /* 0 before the start-up code sets it */
        if (sp >= RAM_BEGIN && sp < data_end) {
            printf("the stack met the data, which ends at %04X\n", data_end);
            return 125;
        }
        if (!avr->sreg[S_I] && word_at(avr->flash + avr->pc) == RJMP_TO_ITSELF) {
            printf("%.0f million cycles, %u bytes of data, %u of stack\n", (double)avr->cycle / 1e6,
                   data_end - RAM_BEGIN, RAM_END - least_sp);
            return avr->data[R24];
        }
    }
    if (avr->cycle >= limit) {
        printf("did not end within %s million cycles\n", argv[2]);
        return 124;
    }
    printf("crashed at %04X\n", (unsigned)avr->pc);
    return 125;
}
