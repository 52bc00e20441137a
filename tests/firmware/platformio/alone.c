/* SPDX-License-Identifier: MIT */
#include "fathom/fathom.h"
#include "fathom_serial.h"

/* A program without a port of Fathom's: it names what needs none. */
int main(void)
{
    static const uint8_t frame[] = {0x02, 0x07, 0x41, 0x12};
    return fathom_crc16(frame, sizeof frame);
}
