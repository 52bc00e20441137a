/* SPDX-License-Identifier: MIT */
#include "diagnosis/advice_pins.h"

#include <inttypes.h>

static void print_no_pulse(FILE *to, uint32_t noises)
{
    if (noises != 0)
        (void)fprintf(
            to,
            "no pulse of the sensor came back, but %" PRIu32
            " shorter ones: noise on the wire of echo; keep it away from motors and from the wire of trigger",
            noises);
    else
        (void)fputs("no pulse came back", to);
    (void)fputs("; check the sensor's supply and ground, the wires from trigger to its RX and from its TX to "
                "echo, that "
                "these are the numbers of the chip's lines (gpioinfo lists them) and not of the header's "
                "pins, and that "
                "it is the PWM variant; 5 V or RS232 at a pin for 3.3 V may have destroyed that",
                to);
}

bool advice_print_pins(FILE *to, const failure_t *failure, const reader_facts_t *facts)
{
    switch (failure->status) {
    case FATHOM_ERR_NO_RESPONSE:
        print_no_pulse(to, failure->noises);
        return true;
    case FATHOM_ERR_MALFORMED:
        (void)fprintf(
            to,
            "a pulse came that is no distance from %u to %u mm (--window); check for noise, and that "
            "nothing is nearer than 50 cm",
            facts->min_mm, facts->max_mm);
        return true;
    case FATHOM_ERR_STALE:
        if (failure->mode->has_pulses) {
            (void)fputs(
                "a pulse was read more than 2.5 s after its end; the machine is too busy, or it slept", to);
            return true;
        }
        (void)fputs(
            "the level does not stand still; check for a loose wire or a worn contact, that something pulls "
            "the "
            "input to one side (bias=up or bias=down, or a resistor), and that this is the number of the "
            "chip's line (gpioinfo lists them)",
            to);
        return true;
    default:
        return false;
    }
}
