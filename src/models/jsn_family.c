/* SPDX-License-Identifier: MIT */
#include "fathom/models.h"

#include "fathom/sensor/factory_line.h"
#include "models_internal.h"

/*
 * JSN-SR04T, AJ-SR04M, HC-SR04 and their like: the frame of the A16, or a pulse after a high trigger pulse. a16_family.c
 * says what a row is. A JSN-SR04T, a JSN-SR20 and an AJ-SR04M have their mode from a resistor on the board. The mode in
 * which they send is first, because the tool reads serial ports.
 */

#define JSN_V3   "JSN-SR04T-V3.0, JSN-SR04T-V3.3, SEN0207"
#define JSN_V2   "JSN-SR04T-V2.0"
#define JSN_DUAL "JSN-SR20"
#define AJ       "K02, AJ-SR04M-T-X"

/* clang-format off */
#define ROWS(ROW) \
    /* DFRobot SEN0207 page, a seller's page, ESPHome jsn_sr04t, which takes 250 to 6000 mm. */ \
    ROW(jsn_sr04t_auto, A16, AUTO, H, "JSN-SR04T", JSN_V3, "JSN", "47k, or pad M1", \
        SLOW, RANGE(230, 5000), .period_ms = 100) \
    /* DFRobot SEN0207 page, ESPHome jsn_sr04t, a test sketch: triggers more than 60 ms apart, and a response within 100 \
     * ms. The period is the longer time, so that no trigger comes before a response that may still come. */ \
    ROW(jsn_sr04t_controlled, A16, CONTROLLED, H, "JSN-SR04T", JSN_V3, "JSN", "120k, or pad M2", \
        SLOW, RANGE(230, 5000), BYTE(0x55), .period_ms = 101, WINDOW(4, 100)) \
    /* A seller's page, DFRobot SEN0207 page. Modes 0 (open) and 4 (360k, low power). The scale is that of V2.0's text, so \
     * is the pulse of 60 ms; the period is that of the automatic mode. Mode 4 may need 1 ms to wake, as an AJ-SR04M does. */ \
    ROW(jsn_sr04t_pulse, A16, PULSE, H, "JSN-SR04T", JSN_V3, "JSN", "resistor open, or 360k", \
        RANGE(230, 5000), HIGH_PULSE(1000), .period_ms = 100, .us_per_dm = 588, .no_target_ms = 60) \
    /* Mode 3: project notes, a seller's page (200 ms). Scale as above. */ \
    ROW(jsn_sr04t_free, A16, FREE_PULSE, M, "JSN-SR04T", JSN_V3, "JSN", "200k", \
        RANGE(230, 5000), .period_ms = 200, .us_per_dm = 588, .no_target_ms = 60) \
    /* A page on the JSN-SR04T, ArduPilot issue 19961. Other texts have 250 mm. */ \
    ROW(jsn_sr04t_2_auto, A16, AUTO, H, "JSN-SR04T-2.0", JSN_V2, "JSN", "R27 = 47k", \
        SLOW, RANGE(200, 6000), .period_ms = 100) \
    /* ESPHome pull request 6023 (the byte), notes on the boards. The resistor was not seen printed. Times of V3. */ \
    ROW(jsn_sr04t_2_ctrl, A16, CONTROLLED, M, "JSN-SR04T-2.0", JSN_V2, "JSN", "R27 = 120k", \
        SLOW, RANGE(200, 6000), BYTE(0x55), .period_ms = 101, WINDOW(4, 100)) \
    /* A page on the JSN-SR04T, ArduPilot's forum. One page says less than 10 us. Echo low again after 60 ms. */ \
    ROW(jsn_sr04t_2_pulse, A16, PULSE, H, "JSN-SR04T-2.0", JSN_V2, "JSN", "R27 open", \
        RANGE(200, 6000), HIGH_PULSE(10), .period_ms = 100, .us_per_dm = 588, .no_target_ms = 60) \
    /* Project notes, a seller's page (range). */ \
    ROW(jsn_sr20_auto, A16, AUTO, M, "JSN-SR20-Y1", JSN_DUAL, "JSN", "47k", SLOW, RANGE(20, 5000), .period_ms = 100) \
    /* The same. No times: the A16's period, and a window from the shortest frame. */ \
    ROW(jsn_sr20_controlled, A16, CONTROLLED, M, "JSN-SR20-Y1", JSN_DUAL, "JSN", "120k", \
        SLOW, RANGE(20, 5000), BYTE(0x55), .period_ms = 121, WINDOW(4, 120)) \
    /* A seller's page (20 us), Supla's changelog (30 us). Echo low again after 40 ms. The period is the automatic one. */ \
    ROW(jsn_sr20_pulse, A16, PULSE, H, "JSN-SR20-Y1", JSN_DUAL, "JSN", "resistor open", \
        RANGE(20, 5000), HIGH_PULSE(30), .period_ms = 100, .us_per_dm = 575, .no_target_ms = 40) \
    /* Manual of the AJ-SR04M, a seller's page, ESPHome feature request 2854. One driver has 360k for the triggered mode, \
     * manual and a test say 120k automatic and 47k triggered, the other way round than JSN. Boards whose sum is that of the \
     * two bytes without FF are reported too, and refused here. With the usual probe it reaches 6 m. */ \
    ROW(aj_sr04m_auto, A16, AUTO, H, "AJ-SR04M", AJ, "", "R19 = 120k", SLOW, RANGE(200, 8000)) \
    /* The same, ESPHome pull request 11992: byte 01. One driver in service sends 55: if a board is silent, try that in a \
     * copy. It waits for 120 ms if there is no echo; 10 ms more are for the byte and the frame. 0 is no echo. */ \
    ROW(aj_sr04m_controlled, A16, CONTROLLED, H, "AJ-SR04M", AJ, "", "R19 = 47k", \
        SLOW, RANGE(200, 8000), BYTE(0x01), .period_ms = 131, WINDOW(4, 130), .value_0 = FATHOM_MEANS_NO_TARGET) \
    /* Manual of the AJ-SR04M, a measurement: the echo begins 12 ms after the trigger. Modes 1 and 2; 2 needs 1 ms to wake. \
     * The manual has 50 ms, in which 12 ms and the 46 ms of 8 m have no place: 100 ms. */ \
    ROW(aj_sr04m_pulse, A16, PULSE, H, "AJ-SR04M", AJ, "", "R19 open, or 300k", \
        RANGE(200, 8000), HIGH_PULSE(1000), .period_ms = 100, .us_per_dm = 580) \
    /* A guide, gateway notes, a driver. One project found its TX inverted. No times: the A16's period, wide window. */ \
    ROW(sr04m_2, A16, CONTROLLED, M, "SR04M-2", "JSN-SR04M-2", "", "", \
        SLOW, RANGE(250, 4500), BYTE(0x55), .period_ms = 121, WINDOW(4, 120)) \
    /* SunFounder's page, ArduPilot. 50 ms or more: 60. With nothing in range 38 ms, or no pulse. */ \
    ROW(hc_sr04, A16, PULSE, H, "HC-SR04", "HY-SRF05, RCWL-9610A", "", "5 V: echo needs a divider at 3.3 V inputs", \
        RANGE(20, 4000), HIGH_PULSE(10), .period_ms = 60, .us_per_dm = 580, .no_target_ms = 38) \
    /* A project, notes of a simulator. Times of the HC-SR04. Public notes liken RCWL-1601, 1605 and 1670 to it. */ \
    ROW(rcwl_1655, A16, PULSE, M, "RCWL-1655", "", "RCWL", "", \
        RANGE(200, 4500), HIGH_PULSE(10), .period_ms = 60, .us_per_dm = 580, .no_target_ms = 38)
/* clang-format on */

ROWS(MODEL_FACTS)

static const fathom_model_description_t descriptions[] = {ROWS(MODEL_DESCRIPTION)};

const fathom_model_table_t fathom_models_jsn = MODEL_TABLE(descriptions);
