/* SPDX-License-Identifier: MIT */
/*
 * Each row was typed from makers' and sellers' pages, and from drivers and projects of others. Where two sources differ,
 * the row is the one that is harder to read: the longer time between triggers, the wider span of responses.
 */
#include "relatives.h"

#define UART(name, form, baud, min, max, ...)                                                                \
    {                                                                                                        \
        (name), SECOND_RELATIVE, (form), (baud), (min), (max), __VA_ARGS__                                   \
    }
#define AUTO(name, baud, min, max, ms, ...) UART(name, FORM_AUTO, baud, min, max, .gap_ms = (ms), __VA_ARGS__)
#define CONTROLLED(name, baud, min, max, ms, ...)                                                            \
    UART(name, FORM_CONTROLLED, baud, min, max, .gap_ms = (ms), __VA_ARGS__)
#define MODBUS(name, baud, min, max, ...) UART(name, FORM_MODBUS, baud, min, max, __VA_ARGS__)
#define PULSE(name, min, max, ms, scale, none, ...)                                                          \
    {                                                                                                        \
        (name), SECOND_RELATIVE_PULSE, FORM_PULSE, 0, (min), (max), .us_per_dm = (scale), .none_ms = (none), \
                                                                    .gap_ms = (ms), __VA_ARGS__              \
    }
#define LOW(us)            .trigger = TRIGGER_LOW, .least_us = (us)
#define HIGH(us)           .trigger = TRIGGER_HIGH, .least_us = (us)
#define BYTE(value)        .trigger = TRIGGER_BYTE, .trigger_byte = (value)
#define RESPONSE(from, to) .from_ms = (from), .to_ms = (to)
#define READS(real, other) .real_ms = (real), .to_ms = (other)
#define MEANS(text)        .values = (text)
#define TEMPERATURE        .has_temperature = true
#define SILENT             .values = NULL
#define OTHER(name, kind, form, ms)                                                                          \
    {                                                                                                        \
        (name), (kind), (form), 9600, 250, 4500, .gap_ms = (ms)                                              \
    }

/* clang-format off */
const second_relative_t second_relatives[] = {
    /* Automatic. 0 of an A02 was seen with nothing in range and with a hand on the probe. */
    AUTO("A16NYUW", 9600, 500, 15000, 0, SILENT),
    AUTO("A01NYUB", 9600, 280, 7500, 0, SILENT),  /* a frame each second, or several a second */
    AUTO("A01CNYUB", 9600, 280, 2500, 0, SILENT), /* the same */
    AUTO("SEN0311", 9600, 30, 4500, 100, MEANS("u???")),
    AUTO("SEN0312", 9600, 280, 4500, 100, SILENT),
    AUTO("ME007TX", 9600, 30, 4000, 50, SILENT),
    AUTO("A19NYUW", 9600, 280, 4500, 0, SILENT),
    AUTO("A22NYUW", 115200, 20, 3000, 0, MEANS("??ni")),
    AUTO("R01UW", 115200, 20, 4000, 0, SILENT),
    AUTO("SEN0754", 115200, 0, 0, 100, MEANS("??ni")),
    AUTO("DS1603L", 9600, 50, 2000, 4000, SILENT), /* "every few seconds" */
    AUTO("L023MUW", 9600, 20, 2000, 0, SILENT),
    AUTO("JSN-SR04T-V2.0", 9600, 200, 6000, 100, SILENT),
    AUTO("SEN0207", 9600, 230, 5000, 100, SILENT),
    AUTO("JSN-SR20-Y1", 9600, 20, 5000, 100, SILENT),
    AUTO("AJ-SR04M", 9600, 200, 8000, 0, SILENT),
    AUTO("A17NYUW", 9600, 250, 10000, 0, SILENT),
    AUTO("A16NY2W", 9600, 500, 15000, 0, SILENT),

    /* Controlled. */
    CONTROLLED("A16NYTW", 9600, 500, 15000, 120, LOW(0), RESPONSE(90, 110)),
    CONTROLLED("A0221AT", 9600, 30, 4500, 0, LOW(0), RESPONSE(60, 60)),
    CONTROLLED("A06BLYT", 9600, 300, 2000, 250, LOW(0), RESPONSE(0, 50)), /* a driver waits 50 ms */
    CONTROLLED("A12BNYTW", 9600, 250, 5000, 0, LOW(0)),
    CONTROLLED("A21AYYTW", 115200, 30, 5000, 150, LOW(0), RESPONSE(8, 140), MEANS("??ni")),
    CONTROLLED("A22NYTW", 115200, 20, 3000, 200, LOW(0), MEANS("??ni")), /* a robot triggers each 50 to 200 ms */
    CONTROLLED("SEN0599", 115200, 50, 6000, 19, LOW(0), RESPONSE(13, 14), MEANS("n???")),
    CONTROLLED("SEN0598", 115200, 20, 3000, 19, LOW(0), RESPONSE(9, 13), MEANS("n???")), /* or 14 ms apart */
    CONTROLLED("L081MTW", 115200, 50, 2000, 33, BYTE(0x01), RESPONSE(5, 18), MEANS("?un?")), /* any byte */
    CONTROLLED("L08B50TW", 115200, 80, 3000, 1000, LOW(100), MEANS("??n?")),
    CONTROLLED("JSN-SR04T-V2.0", 9600, 200, 6000, 0, BYTE(0x55)),
    CONTROLLED("SEN0207", 9600, 230, 5000, 60, BYTE(0x55)),
    CONTROLLED("JSN-SR20-Y1", 9600, 20, 5000, 0, BYTE(0x55)),
    CONTROLLED("AJ-SR04M", 9600, 200, 8000, 0, BYTE(0x01), RESPONSE(0, 120), MEANS("n???")), /* one driver waits 120 */
    CONTROLLED("SR04M-2", 9600, 250, 4500, 0, BYTE(0x55)),

    /* Pulses. */
    PULSE("A16NYMW", 500, 15000, 220, 575, 94, LOW(0)),
    PULSE("A0221AM", 30, 4500, 0, 575, 40, LOW(5000)),
    PULSE("A01-PWM", 280, 7500, 0, 0, 0, LOW(0)),
    PULSE("SEN0300", 270, 8000, 60, 0, 0, LOW(100), .most_us = 10000), /* longer is another mode */
    PULSE("ME007Y", 300, 3500, 0, 588, 0, HIGH(10)),
    PULSE("SEN0151", 200, 10000, 100, 100, 15, LOW(51)),
    PULSE("JSN-SR04T-V2.0", 200, 6000, 0, 588, 60, HIGH(10)),
    PULSE("SEN0207", 230, 5000, 0, 588, 60, HIGH(10)),
    {"SEN0207", SECOND_RELATIVE_PULSE, FORM_FREE_PULSE, 0, 230, 5000, .gap_ms = 200}, /* 57.5 to 58.8 us for each cm */
    PULSE("JSN-SR20-Y1", 20, 5000, 0, 575, 40, HIGH(30)), /* or 20 us */
    PULSE("AJ-SR04M", 200, 8000, 50, 580, 0, HIGH(1000)), /* mode 1: 10 us, mode 2: 1 ms to wake */
    PULSE("HC-SR04", 20, 4000, 50, 580, 38, HIGH(10)),
    PULSE("RCWL-1655", 200, 4500, 50, 580, 38, HIGH(10)),

    /* Modbus. No source has the baud rate of an A17: that of the A16. */
    MODBUS("A16NY4W", 9600, 500, 15000, READS(150, 0)),
    MODBUS("A16NY2W", 9600, 500, 15000, SILENT),
    MODBUS("A02YY4W", 9600, 30, 4500, READS(120, 520), TEMPERATURE),
    MODBUS("A12-RS485", 9600, 250, 5000, TEMPERATURE),
    MODBUS("A17NY4W", 9600, 250, 10000, SILENT),
    MODBUS("SEN0592", 115200, 30, 5000, READS(140, 750), TEMPERATURE, MEANS("??ni")),
    MODBUS("SEN0591", 115200, 20, 3000, READS(140, 300), TEMPERATURE, MEANS("??ni")),
    MODBUS("L041M4W", 115200, 50, 6000, READS(26, 121), TEMPERATURE),
    MODBUS("L042M4W", 115200, 20, 3000, READS(26, 121), TEMPERATURE),
    MODBUS("L08-RS485", 115200, 80, 3000, MEANS("?un?")),
    MODBUS("101991041", 9600, 280, 7500, READS(0, 500), TEMPERATURE),
    MODBUS("101991042", 9600, 250, 5000, SILENT),
    MODBUS("SEN0754", 115200, 0, 0, MEANS("??ni")),
    MODBUS("DJLK-003AB", 9600, 0, 0, SILENT),

    /* The forms of an A05 and an HPS-167S; their own simulations play them. */
    OTHER("A05LYU", SECOND_A05_UART, FORM_AUTO, 0),
    OTHER("A05-RS485", SECOND_A05_RS485, FORM_55AA, 250),
    OTHER("A05-RS485", SECOND_A05_RS485, FORM_MODBUS, 0),
    {"HPS-167S", SECOND_HPS167S, FORM_MODBUS, 19200, 80, 18000, SILENT},
    {"HPS-167", SECOND_HPS167, FORM_0A, 115200, 80, 18000, .gap_ms = 20}, /* no range: that of the HPS-167S */
    {"HPS-166", SECOND_HPS167, FORM_0A, 115200, 80, 18000, SILENT},       /* no baud rate either */
};
/* clang-format on */

const size_t second_relatives_count = sizeof second_relatives / sizeof second_relatives[0];
