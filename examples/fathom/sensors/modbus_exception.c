/* SPDX-License-Identifier: MIT */
#include "sensors/modbus_exception.h"

#include <stddef.h>

/* MODBUS Application Protocol V1.1b3, 7; the last two are a gateway's. */
modbus_exception_t modbus_exception(uint8_t number)
{
    static const modbus_exception_t texts[] = {
        [1] = {"illegal function", "the sensor does not support this function", true},
        [2] = {"illegal data address", "the sensor has no such register", true},
        [3] = {"illegal data value", "the sensor refuses this value or this number of registers", true},
        [4] = {"server device failure", "the sensor has failed. Switch its supply off and on", false},
        [5] = {"acknowledge", "the sensor is still busy. Try a longer --interval", false},
        [6] = {"server device busy", "the sensor is busy. Try --retries 2 or a longer --interval", false},
        [8] = {"memory parity error", "the sensor's memory is damaged. Switch its supply off and on", false},
        [10] = {"gateway path unavailable", "a gateway cannot reach the sensor. Check the gateway", false},
        [11] = {"gateway target device failed to respond",
                "a gateway receives no response of the sensor. Check the wires there", false},
    };
    static const modbus_exception_t unknown = {"unknown", "the Modbus standard has no such code", true};
    return number < sizeof texts / sizeof texts[0] && texts[number].name != NULL ? texts[number] : unknown;
}
