/* SPDX-License-Identifier: MIT */
#include "sensors/modbus_exception.h"

#include <stddef.h>

/* MODBUS Application Protocol V1.1b3, 7; the last two are a gateway's. */
modbus_exception_t modbus_exception(uint8_t number)
{
    static const modbus_exception_t texts[] = {
        [1] = {"illegal function", "it does not know this kind of request", true},
        [2] = {"illegal data address", "it has no such register", true},
        [3] = {"illegal data value", "it does not take so many registers", true},
        [4] = {"server device failure", "it has failed; switch its supply off and on", false},
        [5] = {"acknowledge", "it is still at work; try a longer --interval", false},
        [6] = {"server device busy", "try --retries 2 or a longer --interval", false},
        [8] = {"memory parity error", "its memory is damaged; switch its supply off and on", false},
        [10] = {"gateway path unavailable", "a gateway in between cannot reach it; check the gateway", false},
        [11] = {"gateway target device failed to respond",
                "a gateway in between hears nothing of it; check the wiring there", false},
    };
    static const modbus_exception_t unknown = {"unknown", "no code of the Modbus standard", true};
    return number < sizeof texts / sizeof texts[0] && texts[number].name != NULL ? texts[number] : unknown;
}
