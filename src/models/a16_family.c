/* SPDX-License-Identifier: MIT */
#include "fathom/models.h"

#include "fathom/sensor/factory_line.h"
#include "models_internal.h"

/*
 * DYP's modules that send the frame of the A16, take its trigger, give its pulse or have its registers. A row is one
 * model in one mode: an identifier, the family, the mode, the certainty, name, aliases, maker, a note, facts. Its comment
 * has the sources and what was decided. README.md says how to add one. README.md of this folder and models.h are made of
 * the rows, and the first row of a name is what the name alone selects.
 *
 * Where the sources leave a number open, it is the A16's, or the careful one: a wider window, a longer period. "By
 * likeness" is a guess of ours from a sister model.
 */

static const fathom_line_settings_t fast_line = {115200, FATHOM_PARITY_NONE, 1};

#define FAST        .line_settings = (&fast_line)
#define FAST_BUS    FAST, .period_ms = 120 /* no source has a period of the requests: the A16's */
#define SLOW_BUS    SLOW, .period_ms = 120
#define TEMPERATURE .registers = FATHOM_HAS_TEMPERATURE

/* clang-format off */
#define UART_AUTO_ROWS(ROW) \
    /* A16 datasheet 2. It prints no period of the frames. */ \
    ROW(a16nyuw, A16, AUTO, H, "A16NYUW", "", "DYP", "", SLOW, RANGE(500, 15000)) \
    /* ESPHome a01nyub, drivers for DFRobot SEN0313, Adafruit 4664. SEN0313 does not say whether it is form A or B. Nearer \
     * than 280 mm the value is wrong, and no code says so. */ \
    ROW(a01anyub, A16, AUTO, H, "A01ANYUB", "A01NYUB, A01, SEN0313, Adafruit-4664, Adafruit-4665", "DYP", "", \
        SLOW, RANGE(280, 7500)) \
    /* ESPHome pull request 12761, two projects. One project has a frame each second, drivers for the A01 expect several: \
     * the period stays open, so that each frame counts as a measurement. */ \
    ROW(a01cnyub, A16, AUTO, H, "A01CNYUB", "", "DYP", "", SLOW, RANGE(280, 2500)) \
    /* DFRobot SEN0311 page, ESPHome a02yyuw, ArduPilot. Users saw 0 with nothing in front and with a hand on the probe, \
     * so 0 keeps no meaning. */ \
    ROW(a02yyuw, A16, AUTO, H, "A02YYUW", "A02YYU, SEN0311, A0221AU", "DYP", "", \
        SLOW, RANGE(30, 4500), .period_ms = 100) \
    /* DFRobot SEN0312 page, Meadow Me007ys, ESPHome ME007YS. */ \
    ROW(me007ys, A16, AUTO, H, "ME007YS", "ME007YS-TX, SEN0312", "DYP", "", SLOW, RANGE(280, 4500), .period_ms = 100) \
    /* DYP's sheet of serial sensors, one driver. */ \
    ROW(me007tx, A16, AUTO, M, "ME007TX", "ME007Y-TX", "DYP", "5 V supply", SLOW, RANGE(30, 4000), .period_ms = 50) \
    /* ESPHome pull request 12761 (range), a sketch (frame and baud rate). */ \
    ROW(a19nyuw, A16, AUTO, H, "A19NYUW", "A19", "DYP", "", SLOW, RANGE(280, 4500)) \
    /* ESPHome pull request 12761 (range), a program for two sensors. FFFD and FFFE by likeness with the A21. */ \
    ROW(a22nyuw, A16, AUTO, H, "A22NYUW", "A22YYUW", "DYP", "", FAST, RANGE(20, 3000)) \
    /* ESPHome pull request 12761 (range), a bridge for four modules. */ \
    ROW(r01uw, A16, AUTO, H, "R01UW", "R01", "DYP", "laser", FAST, RANGE(20, 4000)) \
    /* DFRobot SEN0754 page. No range was seen: the A16's 1 to 16350 mm. */ \
    ROW(sen0754, A16, AUTO, H, "SEN0754", "", "DFRobot", "", FAST, RANGE(1, 16350), .period_ms = 100) \
    /* ESPHome ds1603l. A frame every few seconds: 4 s. */ \
    ROW(ds1603l, A16, AUTO, H, "DS1603L", "", "", "liquid height through the bottom of a tank", \
        SLOW, RANGE(50, 2000), .period_ms = 4000) \
    /* ESPHome pull request 12761, a test program. */ \
    ROW(l023muw, A16, AUTO, M, "L023MUW", "", "DYP", "liquid height through the bottom of a tank", SLOW, RANGE(20, 2000)) \
    /* ESPHome pull request 12761; the range also in a guide of think-link. */ \
    ROW(a17nyuw, A16, AUTO, M, "A17NYUW", "", "DYP", "", SLOW, RANGE(250, 10000)) \
    /* A16 datasheet 5. */ \
    ROW(a16ny2w_auto, A16, AUTO, H, "A16NY2W", "", "DYP", "RS232, until the first Modbus request", \
        SLOW, RANGE(500, 15000))

#define UART_CONTROLLED_ROWS(ROW) \
    /* A16 datasheet 3: 90 to 110 ms, and 10 ms more at each end for clocks and frame. */ \
    ROW(a16nytw, A16, CONTROLLED, H, "A16NYTW", "", "DYP", "", \
        SLOW, RANGE(500, 15000), FALLING(2000), .period_ms = 121, WINDOW(80, 120)) \
    /* Arduino library A02YYUW, ESPHome pull request 8046, labels A0221AT. A low pulse or any byte. One report has about 60 \
     * ms, no source a period: the A16's, and a window from the shortest frame. */ \
    ROW(a02yytw, A16, CONTROLLED, H, "A02YYTW", "A02YYT, A0221AT", "DYP", "", \
        SLOW, RANGE(30, 4500), FALLING(2000), .period_ms = 121, WINDOW(4, 120)) \
    /* ESPHome pull request 12761, a project, a driver. One project wires the module as trigger and echo; name and driver \
     * say UART. The driver sends the byte 01, ESPHome a low pulse, and both begin with a falling edge. It waits for 50 ms, \
     * and takes 250 ms as the period. */ \
    ROW(a06blyt, A16, CONTROLLED, H, "A06BLYT", "", "DYP", "", \
        SLOW, RANGE(300, 2000), FALLING(2000), .period_ms = 250, WINDOW(4, 120)) \
    /* ESPHome pull request 12761, a sketch. No times: the A16's period, and a window from the shortest frame. */ \
    ROW(a12bnytw, A16, CONTROLLED, H, "A12BNYTW", "", "DYP", "", \
        SLOW, RANGE(250, 5000), FALLING(2000), .period_ms = 121, WINDOW(4, 120)) \
    /* A driver made from DYP's A21 interface manual, an Arduino reader, ESPHome pull request 12761: 8 to 140 ms. */ \
    ROW(a21ayytw, A16, CONTROLLED, H, "A21AYYTW", "A21NYTW", "DYP", "", \
        FAST, RANGE(30, 5000), FALLING(2000), .period_ms = 150, WINDOW(5, 145)) \
    /* ESPHome pull request 12761, a robot's firmware that triggers each 50 to 200 ms: the longer one. No source has the \
     * response: from the shortest frame to the latest response of an A21. FFFD and FFFE by likeness with the A21. */ \
    ROW(a22nytw, A16, CONTROLLED, M, "A22NYTW", "A22YYTW", "DYP", "", \
        FAST, RANGE(20, 3000), FALLING(2000), .period_ms = 200, WINDOW(1, 145)) \
    /* Seller's sheet of the GL04, DFRobot SEN0599 page, ESPHome l04xmtw, ArduPilot: 13 to 14 ms. 0 is no echo, also out of \
     * the water; in one log over silt nearly all frames have it. */ \
    ROW(l041mtw, A16, CONTROLLED, H, "L041MTW", "GL041MT, SEN0599, 5AE0077", "DYP", "under water", \
        FAST, RANGE(50, 6000), FALLING(2000), .period_ms = 19, WINDOW(8, 18), .value_0 = FATHOM_MEANS_NO_TARGET) \
    /* Seller's sheet of the GL04 (14 and 9 ms), DFRobot SEN0598 page (19 and 13 ms): the longer period, and both times. \
     * ArduPilot has 2 m, seller and DFRobot 3 m. */ \
    ROW(l042mtw, A16, CONTROLLED, H, "L042MTW", "GL042MT, SEN0598", "DYP", "under water", \
        FAST, RANGE(20, 3000), FALLING(2000), .period_ms = 19, WINDOW(5, 18), .value_0 = FATHOM_MEANS_NO_TARGET) \
    /* DYP's L08 sheet as two programs quote it, two drivers. A trigger sooner than 33 ms locks the module until power-off, \
     * by one report. The sheet wants a low pulse of 33 ms, two tests found any byte enough. 2 m is what scripts and \
     * product page say; 3 and 10 m, in ESPHome, are another form's and a mistake. FFFB is out of the water. 0 is too near \
     * in one report, and no echo with the L04: no meaning. */ \
    ROW(l081mtw, A16, CONTROLLED, H, "L081MTW", "", "DYP", "under water", \
        FAST, RANGE(50, 2000), BYTE(0x01), .period_ms = 34, WINDOW(3, 33), .value_fffb = FATHOM_MEANS_UNKNOWN) \
    /* Two scripts, ESPHome pull request 12761. A script has 50 to 2000 mm, the others 80 to 3000. Sooner than each second \
     * the module sends the old value again. */ \
    ROW(l08b50tw, A16, CONTROLLED, H, "L08B50TW", "", "DYP", "under water", \
        FAST, RANGE(80, 3000), FALLING(2000), .period_ms = 1000, WINDOW(1, 200))

#define PULSE_ROWS(ROW) \
    /* A16 datasheet 1. */ \
    ROW(a16nymw, A16, PULSE, H, "A16NYMW", "", "DYP", "", \
        RANGE(500, 15000), FALLING(2000), .period_ms = 221, .us_per_dm = 575, .no_target_ms = 94) \
    /* Arduino library A02YYUW and its demo, two projects. The label A0221AM is PWM by its letter and in one project, UART \
     * in another that did not try it. 693 cm, 40 ms, were seen with the probe covered. The period is the A16's. */ \
    ROW(a02yymw, A16, PULSE, H, "A02YYMW", "A02YYM, A0221AM", "DYP", "", \
        RANGE(30, 4500), FALLING(5000), .period_ms = 221, .us_per_dm = 575, .no_target_ms = 40) \
    /* Manual DYP-A01-V2.0, its list of outputs. Scale and period are the A16's. There is a free-running variant too. */ \
    ROW(a01_pwm, A16, PULSE, M, "A01-PWM", "", "DYP", "", \
        RANGE(280, 7500), FALLING(2000), .period_ms = 221, .us_per_dm = 575) \
    /* DFRobot SEN0300 page: low for 0.1 to 10 ms. The scale is the A16's. */ \
    ROW(sen0300_pwm, A16, PULSE, H, "SEN0300", "ULS", "DFRobot", "the module in its PWM mode", \
        RANGE(270, 8000), FALLING(2000), .period_ms = 61, .us_per_dm = 575) \
    /* A driver, the README of an Arduino library. No period: the A16's. */ \
    ROW(me007y, A16, PULSE, M, "ME007Y", "BLJ-ME007Y", "DYP", "", \
        RANGE(300, 3500), HIGH_PULSE(10), .period_ms = 221, .us_per_dm = 588) \
    /* DFRobot's wiki of the URM06: 1 us for each mm, and 15 ms after an error. */ \
    ROW(urm06_pulse, A16, PULSE, M, "URM06-PULSE", "SEN0151", "DFRobot", "", \
        RANGE(200, 10000), FALLING(100), .period_ms = 100, .us_per_dm = 100, .no_target_ms = 15)

#define MODBUS_ROWS(ROW) \
    /* A16 datasheet 5 and 6, a test with a module. */ \
    ROW(a16ny4w, A16, MODBUS, H, "A16NY4W", "", "DYP", "RS485", SLOW_BUS, RANGE(500, 15000)) \
    /* A16 datasheet 5 and 6. */ \
    ROW(a16ny2w, A16, MODBUS, H, "A16NY2W", "", "DYP", "RS232", SLOW_BUS, RANGE(500, 15000)) \
    /* A guide of think-link. */ \
    ROW(a02yy4w, A16, MODBUS, M, "A02YY4W", "", "DYP", "RS485", SLOW_BUS, RANGE(30, 4500), TEMPERATURE) \
    /* boneIO's device file. The range is that of ESPHome's A12. */ \
    ROW(a12_rs485, A16, MODBUS, M, "A12-RS485", "", "DYP", "RS485", SLOW_BUS, RANGE(250, 5000), TEMPERATURE) \
    /* A guide of think-link. It has no baud rate: the A16's. */ \
    ROW(a17ny4w, A16, MODBUS, M, "A17NY4W", "", "DYP", "RS485", SLOW_BUS, RANGE(250, 10000)) \
    /* DFRobot SEN0592 page, a driver, a robot's node. A21AYY4W and A21BYY4W are names by the rule of the letters. */ \
    ROW(a21_rs485, A16, MODBUS, H, "A21-RS485", "SEN0592, A21AYY4W, A21BYY4W", "DYP", "RS485", \
        FAST_BUS, RANGE(30, 5000), TEMPERATURE) \
    /* DFRobot SEN0591 page, a seller's sheet, a ROS driver. */ \
    ROW(a22_rs485, A16, MODBUS, H, "A22-RS485", "SEN0591", "DYP", "RS485", FAST_BUS, RANGE(20, 3000), TEMPERATURE) \
    /* Seller's sheet of the GL04. */ \
    ROW(l041m4w, A16, MODBUS, M, "L041M4W", "GL041M4", "DYP", "RS485, under water", FAST_BUS, RANGE(50, 6000), TEMPERATURE) \
    /* Seller's sheet of the GL04, an Arduino reader. */ \
    ROW(l042m4w, A16, MODBUS, H, "L042M4W", "GL042M4", "DYP", "RS485, under water", FAST_BUS, RANGE(20, 3000), TEMPERATURE) \
    /* Two programs, a robot's notes. FFFB is out of the water. */ \
    ROW(l08_rs485, A16, MODBUS, M, "L08-RS485", "", "DYP", "RS485, under water", \
        FAST_BUS, RANGE(80, 3000), .value_fffb = FATHOM_MEANS_UNKNOWN) \
    /* Seeed's wiki and the examples of its PDF in two projects. By its range an A01. */ \
    ROW(seeed_750, A16, MODBUS, H, "Seeed-101991041", "101991041", "Seeed", "RS485", \
        SLOW_BUS, RANGE(280, 7500), TEMPERATURE) \
    /* Seeed's wiki. Wiring and template are those of the 750 cm one; registers were not seen. */ \
    ROW(seeed_500, A16, MODBUS, M, "Seeed-101991042", "101991042", "Seeed", "RS485", SLOW_BUS, RANGE(250, 5000)) \
    /* DFRobot SEN0754 page. Range: see sen0754. */ \
    ROW(sen0754_modbus, A16, MODBUS, M, "SEN0754", "", "DFRobot", "UART", FAST_BUS, RANGE(1, 16350)) \
    /* A flood node's firmware, a block list. No range: the A16's 1 to 16350 mm. */ \
    ROW(djlk_003ab, A16, MODBUS, M, "DJLK-003AB", "DJLK-003", "DJLK", "RS485", SLOW_BUS, RANGE(1, 16350))
/* clang-format on */

UART_AUTO_ROWS(MODEL_FACTS)
UART_CONTROLLED_ROWS(MODEL_FACTS)
PULSE_ROWS(MODEL_FACTS)
MODBUS_ROWS(MODEL_FACTS)

static const fathom_model_description_t descriptions[] = {
    UART_AUTO_ROWS(MODEL_DESCRIPTION) UART_CONTROLLED_ROWS(MODEL_DESCRIPTION) PULSE_ROWS(MODEL_DESCRIPTION)
        MODBUS_ROWS(MODEL_DESCRIPTION)};

const fathom_model_table_t fathom_models_a16 = MODEL_TABLE(descriptions);
