/* SPDX-License-Identifier: MIT */
#include "fathom/status.h"

/* What to check after each status, in one or two sentences. The order is that of the numbers, from FATHOM_PENDING down. */

const char *fathom_status_advice(fathom_status_t status)
{
    static const char *const advice[] = {
        "Nothing is new yet. Poll again.",
        "There is nothing to do.",
        "The bus or the driver is not initialised, or a value is out of its range. Check what each init "
        "returned.",
        "The serial port is gone or does not send. Check the adapter and its cable, and open the port again.",
        "Nothing came back. Check supply, ground, address, line settings; swap A and B. If others respond, "
        "check this one's plug.",
        "What came back was damaged. Check baud rate and parity first, then termination, bias and ground.",
        "The unit refused the request. Check that the sensor is the model and in the mode that the driver is "
        "for.",
        "A whole frame came that is no response. Check that one sensor of this model has this address.",
        "The sensor sends nothing. Check supply, ground and its TX wire, and that it is in the mode to send "
        "by itself.",
        "The request was cancelled. Ask again.",
        "Another command is not finished. Call again later.",
        "The frame buffer of the line is too small. Give it 32 bytes.",
        "It is not known whether the adapter echoes, so the write may be done or not. Read the setting.",
        "The port cannot do this. Check the line settings, and which functions the port has.",
        "The sensor was switched on just now. Wait for its start-up time.",
        "The setting was sent but could not be read back. Read it again before you rely on it.",
        "A unit responds at that address already. Choose a free address.",
        "The unit acknowledged the setting but has another value. Check the range of the setting.",
        "The line was never silent. Look for a device that sends all the time and for missing bias, or poll "
        "more often.",
        "Another master asks this unit, so its response may be meant for that one. Let one master ask the "
        "unit.",
    };
    if ((status > FATHOM_PENDING) || (status < FATHOM_ERR_OTHER_MASTER)) return "This is no status.";
    return advice[FATHOM_PENDING - (int)status];
}
