/* SPDX-License-Identifier: MIT */
/* fathom sim: its help, and what it refuses. What it simulates is in e2e/test_sim_devices.py, on a pseudo terminal. */
#include "tool_bench.h"

#include <stdio.h>
#include <string.h>

EACH_BEGINS(bench_begin())
static const suite_t suite = {.set_up = begins};

/* ---- sensors ---- */

REFUSES(a_sensor_that_does_not_exist_is_refused, "sim", {"", "no sensor is named"},
        {"b17", "unknown sensor 'b17'"}, {"a16:0", "from 1 to 254"}, {"a16:255", "255"}, {"a16:1x", "1x"},
        {"hps167s:33", "from 1 to 32"}, {"a16:1:wave", "wave"}, {"a16:1:auto:1", "auto:1"})

REFUSES(a_sensor_that_the_line_cannot_carry_is_refused, "sim",
        {"a16:pwm", "a16 in mode pwm has GPIO pins and no line"},
        {"a16 a05", "a16 and a05 would both send automatically"},
        {"a16 hps167s:2 a05", "a16 and a05 would both send automatically"})

TEST(more_than_64_sensors_are_refused)
{
    char words[65 * sizeof "a16::modbus" + sizeof "sim "] = "sim ";
    for (int i = 0; i != 65; i++) strcat(words, "a16::modbus ");
    assert_refused(words, "a line has at most 64 sensors, not 65");
}

/* ---- options and keys ---- */

REFUSES(a_wrong_option_is_refused, "sim", {"a16 --port /nowhere", "unknown option '--port'"},
        {"a16 --seed 4294967296", "It takes a whole number from 0 to 4294967295"},
        {"a16 --fault", "--fault needs a value"})

REFUSES(a_wrong_key_is_refused_with_its_sensor, "sim", {"a16,", "a16: unknown key ''"},
        {"a16:1,1500", "a16:1: unknown key '1500'"}, {"a16,colour=red", "unknown key 'colour'"},
        {"a16,Distance=1", "Did you mean distance?"}, {"a16,=1", "unknown key ''"},
        {"a16,fault", "fault has no value"},
        {"hps167s:7 a16:1:modbus,baud=19200", "a16:1:modbus: a16 does not have the rate 19200"},
        {"hps167s:7 a16:1:modbus,with=count-03", "a16:1:modbus: unknown trait of a16 'count-03'"},
        {"a05,distance=1000,2000,fault", "distance of a05 is 'fault'"})

REFUSES(a_wrong_distance_is_refused, "sim",
        {"a16 --distance 1000,2000", "distance '1000,2000' is more than the 1 of a16"},
        {"a05 --distance 1,2,3,4,5", "more than the 4 of a05"},
        {"a16 --distance 65536",
         "distance of a16 is '65536'. It takes 0 to 65535 mm, no-target, interference."},
        {"a16 --distance -1", "is '-1'"}, {"a16 --distance=", "is ''"},
        {"a16 --distance fault", "is 'fault'"}, {"a16 --distance 111111111111111111111111111111", "is '1111"},
        {"a05 --distance 1000,", "is ''"}, {"a05 --distance ,1000", "is ''"},
        {"hps167s --distance interference", "no-target, fault."},
        {"a16:1:modbus a05:2:modbus hps167s:7 --distance 1,2", "distance '1,2' is more than the 1 of a16"})

REFUSES(a_rate_that_no_sensor_has_is_refused, "sim", {"a16 --baud 19200", "a16 does not have the rate 19200"},
        {"a05 a16::modbus --baud 19200", "a05 does not have the rate 19200"},
        {"hps167s --baud 9600", "It takes 19200, 57600, 115200 or 230400"},
        {"hps167s --baud 38400", "'38400'"}, {"hps167s --baud 19200x", "'19200x'"}, {"hps167s --baud=", "''"},
        {"hps167s --baud 0", "'0'"})

#define TAKES_S  "It takes warm-up=S, a whole number from 1 to 255."
#define TAKES_MS "It takes unasked=MS, a number from 1 to 60000."
REFUSES(a_wrong_trait_is_refused, "sim", {"a16 --with unasked=5", "unknown trait of a16 'unasked'"},
        {"a16:1:modbus a05:2:modbus hps167s:7 --with x",
         "unknown trait of a16 'x'. It is one of exceptions, broadcast, "},
        {"hps167s --with warm-up", TAKES_S}, {"hps167s --with warm-up=", TAKES_S},
        {"hps167s --with warm-up=0", TAKES_S}, {"hps167s --with warm-up=256", TAKES_S},
        {"hps167s --with warm-up=1s", TAKES_S},
        {"hps167s --with count-03=1", "with is 'count-03=1'. count-03 takes no value."},
        {"hps167s --with unasked", TAKES_MS}, {"hps167s --with unasked=", TAKES_MS},
        {"hps167s --with unasked=0.9", TAKES_MS}, {"hps167s --with unasked=60000.001", TAKES_MS},
        {"hps167s --with unasked=18.", TAKES_MS}, {"hps167s --with unasked=.5", TAKES_MS},
        {"hps167s --with unasked=18.5555", TAKES_MS}, {"hps167s --with unasked=18.5s", TAKES_MS},
        {"hps167s --with unasked=100000", TAKES_MS})

/* ---- faults ---- */

static const char *const kinds[] = {
    "stuck",     "interference", "fault",     "no-target", "unit",      "function", "count",
    "exception", "flip-bit",     "flip-byte", "drop",      "insert",    "truncate", "trailing",
    "parity",    "framing",      "overrun",   "split",     "duplicate", "delay",    "late",
    "silence",   "power-cycle",  "noise",     "unasked",   "break",     "echo"};

TEST(the_help_lists_every_fault)
{
    const tool_run_t *const run = tool_run(&bench.tool, "help faults");
    for (size_t i = 0; i != sizeof kinds / sizeof kinds[0]; i++) {
        char line[20];
        (void)snprintf(line, sizeof line, "\n  %s ", kinds[i]);
        if (strstr(run->out, line) == NULL) fail_msg("%s", kinds[i]);
    }
}

REFUSES(a_wrong_fault_is_refused, "sim",
        {"a16 --fault flip", "unknown fault of a16 in mode auto 'flip'. Did you mean flip-bit?"},
        {"a16 --fault xyz", "unknown fault of a16 in mode auto 'xyz'. It is one of stuck, "},
        {"a16 --fault flip-bt", "Did you mean flip-bit?"}, {"a16 --fault=", "fault of a16 in mode auto ''"},
        {"a16 --fault =0.5", "fault of a16 in mode auto ''"},
        {"a16 --fault clock-jump", "fault of a16 in mode auto 'clock-jump'"},
        {"a16 --fault xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx", "stuck, interference, no-target, "},
        {"hps167s --fault interference", "fault of hps167s in mode modbus 'interference'"},
        {"a16:1:modbus a05:2:modbus hps167s:7 --fault interference",
         "fault of hps167s in mode modbus 'interference'"},
        {"a05::dyp --fault fault", "fault of a05 in mode dyp 'fault'"},
        {"a16 --fault drop=1% --fault late=7 --fault insert", "fault is 'late=7'"},
        {"a16,distance=1,fault=drop=2", "a16: fault is 'drop=2'"})

TEST(a_wrong_chance_of_a_fault_is_refused)
{
    static const char *const chances[] = {
        "",     "0",   "0.0",          "2",        "1.1",   "101%",
        "-1",   "+1",  "0,5",          "1e-3",     "%",     ".",
        "5%%",  "0x1", "0.0000001",    "0.00001%", "1@",    "1@0",
        "1@-1", "1@x", "1@4294967296", "@3",       "1@2@3", "9999999999999999999999999999999999999999"};
    for (size_t i = 0; i != sizeof chances / sizeof chances[0]; i++) {
        char words[80];
        char message[160];
        (void)snprintf(words, sizeof words, "sim a16 --fault drop=%s", chances[i]);
        (void)snprintf(message, sizeof message,
                       "fault is 'drop=%s'. It takes KIND[=P[@N]], P from 0.000001 to 1 or as 5%%, N from 1.",
                       chances[i]);
        assert_refused(words, message);
    }
}

TEST(more_than_32_faults_are_refused)
{
    char words[500] = "sim a16,fault=drop";
    for (int i = 0; i != 32; i++) strcat(words, " --fault drop");
    assert_refused(words, "a16: a sensor has at most 32 faults.");
    strcat(words, " --fault drop");
    assert_refused(words, "--fault is 'drop'. It takes at most 32 faults.");
}
