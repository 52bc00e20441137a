/* SPDX-License-Identifier: MIT */
#include "commands/sim/sim.h"
#include "sensors/models.h"

void sim_help(FILE *to)
{
    (void)fputs("fathom sim puts simulated sensors behind a pseudo terminal, which any program can open like "
                "a serial\n"
                "port. It prints the port's path and runs until Ctrl-C.\n\n"
                "usage: fathom sim SENSOR[:ADDRESS][:MODE][,KEY=VALUE...]... [OPTIONS]\n\n",
                to);
    models_print(to);
    (void)fputs(
        "\nThe first mode is the default, the address from the factory is 1. Up to 64 sensors hang on the "
        "one\n"
        "line, as on an RS485 pair; one of them at most may send by itself (mode auto). Two with the same\n"
        "address answer into each other, as real ones do.\n\n"
        "  --link PATH       makes a link to the port, for a name that stays; removed at the end. Replaces "
        "nothing\n"
        "                    but a link that a killed `fathom sim` has left behind\n"
        "  --echo            the host hears itself, as behind an RS485 adapter with local echo\n"
        "  --counters        at the end, on stderr: what each sensor has heard and done, as one JSON object "
        "a "
        "line\n"
        "  --one-by-one      each further sensor is connected when the one before has left its address, for "
        "`fathom\n"
        "                    commission`\n"
        "  --seed N          where the movement begins, the small differences of the response times, and the "
        "faults;\n"
        "                    default 0\n\n"
        "Write an option of one sensor behind it: a05:2,distance=1500,fault=silence=10%. An option without "
        "a\n"
        "sensor applies to all sensors that can have it:\n\n"
        "  --distance MM     what it measures, 0..65535, which is sent as it is; or no-target, interference "
        "(a16,\n"
        "                    a05) or fault (hps167s). An a05 takes up to four, separated by commas; the last "
        "one\n"
        "                    holds for the probes that are left. Default: something that moves to and fro\n"
        "  --baud RATE       the rate that an hps167s was set to: 19200 (default), 57600, 115200 or 230400\n"
        "  --with NAME       gives it what was set before, or one of the ways that the datasheets leave "
        "open:\n",
        to);
    sim_print_traits(to);
    (void)fputs("  --fault KIND[=P[@N]]\n"
                "                    damages what it sends: each frame with the chance P, such as 0.05 or 5% "
                "(default "
                "1), or\n"
                "                    only the N-th, counted from 1. May be given several times, such as\n"
                "                    --fault silence=10% --fault flip-bit=0.01. The kinds:\n",
                to);
    sim_print_faults(to);
    (void)fputs(
        "\nSIGUSR1 cuts the power of all for a second; they keep the settings that real ones keep.\n"
        "Each answers only at its own baud rate. Parity cannot be seen through a pseudo terminal: it is "
        "taken "
        "to be\n"
        "that of the sensors with the rate that was set.\n"
        "Exit status: 0 after Ctrl-C, 1 when the port or the link cannot be made, 2 for wrong usage.\n\n"
        "examples, each with what reads it:\n"
        "  fathom sim a16 --link ./tank                    fathom read a16 --port ./tank\n"
        "  fathom sim a05::modbus --link ./bumper --distance 1000,2000,1953,no-target\n"
        "                                                  fathom read a05 --mode modbus --port ./bumper\n"
        "  fathom sim hps167s:7 --link ./gate              fathom read hps167s --address 7 --port ./gate\n"
        "  fathom sim a16:1:modbus a05:2:modbus hps167s:7 --link ./bus\n"
        "                                                  fathom read a05 --mode modbus --address 2 --port "
        "./bus\n"
        "  fathom sim hps167s --link ./tof                 mbpoll -m rtu -a 1 -b 19200 -P even -t 4:hex -0 "
        "-r 8 -c 4 -1 ./tof\n",
        to);
}
