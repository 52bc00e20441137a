/* SPDX-License-Identifier: MIT */
#include <stdio.h>

#include "fathom/codec/crc16.h"
#include "fathom/engine/modbus_client.h"
#include "fathom/version.h"

/* Prints the version and whether code from the library works; MODBUS over Serial Line V1.02 has the frame. */
int main(void)
{
    const uint8_t frame[] = {0x02, 0x07, 0x41, 0x12};
    printf("%s %s\n", FATHOM_VERSION_STRING, fathom_crc16(frame, sizeof frame) == 0 ? "works" : "fails");
    return fathom_line_due_us == NULL;
}
