/* SPDX-License-Identifier: MIT */
/* Both CRCs of the port over the bytes that the test puts into `asked`, one record of 4 bytes each time. */
#include <avr/io.h>

#include "../crcs.h"

#define fathom_crc16 crc_without_table
#include "../../../../port/avr/crc16.c"
#undef fathom_crc16
uint16_t crc_by_table(const uint8_t *bytes, uint8_t length);
#define fathom_crc16 crc_by_table
#include "../../../../port/avr/crc16_table.c"

volatile crcs_t asked;

static uint16_t (*volatile const ways[2])(const uint8_t *bytes, uint8_t length) = {crc_without_table,
                                                                                   crc_by_table};

int main(void)
{
    uint8_t bytes[CRCS_BYTES];
    for (;;) {
        while (asked.go == 0) continue;
        for (uint8_t i = 0; i < CRCS_BYTES; i++) bytes[i] = asked.bytes[i];
        for (uint8_t i = 0; i < 2; i++) {
            const uint16_t crc = ways[i](bytes, asked.length);
            GPIOR0 = (uint8_t)crc;
            GPIOR0 = (uint8_t)(crc >> 8);
        }
        asked.go = 0;
        GPIOR1 = CRCS_RECORD;
    }
}
