/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_MODELS_H
#define FATHOM_MODELS_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/sample.h"
#include "fathom/sensor/model_facts.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief The known models that speak the protocols of the A16, A05 and HPS-167S: the facts of each, and a list.
 *
 * A program names the facts of its module in the configuration of the driver for the mode. The table has one object for
 * each model and mode. A program that compiles with `-ffunction-sections -fdata-sections` and links with
 * `--gc-sections` contains only the facts that it names: 28 bytes on a 32-bit machine, 23 bytes of RAM on an AVR. The
 * line settings are 8 bytes more, 6 on an AVR. Without these options it contains a whole table with its texts.
 *
 * @code
 * const fathom_a16_auto_config_t config = {.model = &fathom_model_a02yyuw};
 * fathom_a16_auto_init(&tank, &line, &config);
 * @endcode
 *
 * The facts were collected from public sources. None was tried with a real module. src/models/README.md says which rows
 * are certain, which modules are near relatives, and how to add a row.
 *
 * | mode | driver |
 * |---|---|
 * | FATHOM_MODE_AUTO | a16_auto.h, a05_auto.h |
 * | FATHOM_MODE_CONTROLLED | a16_controlled.h |
 * | FATHOM_MODE_PULSE | a16_pwm.h |
 * | FATHOM_MODE_FREE_PULSE | a16_pwm.h with fathom_output_none() |
 * | FATHOM_MODE_MODBUS | a16_modbus.h, a05_modbus.h, hps167s.h |
 * | FATHOM_MODE_55AA | a05_dyp.h |
 * | FATHOM_MODE_0A | hps167_uart.h |
 */

/** @brief How a module sends its distances. */
typedef enum {
    FATHOM_MODE_ANY = 0,        /**< No mode: fathom_model_find() returns the first row of the name. */
    FATHOM_MODE_AUTO = 1,       /**< Frames without a request, on a UART or RS232. */
    FATHOM_MODE_CONTROLLED = 2, /**< One frame for each trigger, on a UART. */
    FATHOM_MODE_PULSE = 3,      /**< One pulse for each trigger; its width is the time of flight. */
    FATHOM_MODE_FREE_PULSE = 4, /**< Pulses without a trigger. */
    FATHOM_MODE_MODBUS = 5,     /**< Modbus RTU. */
    FATHOM_MODE_55AA = 6,       /**< Frames 55 AA on request. */
    FATHOM_MODE_0A = 7          /**< Frames 0A of an HPS-167 on request. */
} fathom_model_mode_t;

/** @brief One model in one mode, in words. Texts are ASCII and never NULL. */
typedef struct {
    /** @brief The name on the module or in the shop. Models with several modes have a row for each, with one name. */
    const char *name;

    /** @brief Other names with ", " between them, for example of a seller; or "". */
    const char *aliases;

    /** @brief The maker, or the seller if the maker is not known; or "". */
    const char *maker;

    /** @brief What the owner has to know: the resistor that selects the mode, the wires; or "". */
    const char *note;

    /** @brief The facts. Valid as long as the program runs. */
    const fathom_model_facts_t *facts;

    /** @brief The family, which is the `model` of its samples: a fathom_model_t. */
    uint8_t family;

    /** @brief The mode: a fathom_model_mode_t. Never FATHOM_MODE_ANY. */
    uint8_t mode;

    /**
     * @brief True if a maker's or a seller's manual has the facts, or two sources agree. False: one good source.
     *
     * It speaks of the row's main facts: frame, line settings, range. Other numbers may be guesses, which the row's
     * comment in src/models names.
     */
    bool is_certain;
} fathom_model_description_t;

/**
 * @brief Returns a row of the list of all models. Links all rows.
 *
 * @param index  Number of the row, from 0. Numbers change from version to version.
 * @return The row, or NULL if there are no more.
 */
const fathom_model_description_t *fathom_model_at(uint16_t index);

/**
 * @brief Returns true if this is the name or one of the aliases of a model.
 *
 * Letters may be large or small. Characters other than letters and digits do not count: `hcsr04` is HC-SR04. The name
 * may begin with DYP, and then end with a version, as a label does: `DYP-A02YYUW-V2.0` is A02YYUW.
 *
 * @param model  The row.
 * @param name   The name.
 */
bool fathom_model_is_called(const fathom_model_description_t *model, const char *name);

/**
 * @brief Returns the first row with this name or alias and mode. Links all rows.
 *
 * @param name  The name, compared as by fathom_model_is_called().
 * @param mode  A fathom_model_mode_t. FATHOM_MODE_ANY selects the first mode of the model.
 * @return The row, or NULL if there is none.
 */
const fathom_model_description_t *fathom_model_find(const char *name, uint8_t mode);

/* models: kept by tests/checks/models.py --update */
/** @brief A16NYUW, automatic: 500 to 15000 mm, 9600 8N1. */
extern const fathom_model_facts_t fathom_model_a16nyuw;
/** @brief A01ANYUB, automatic: 280 to 7500 mm, 9600 8N1. */
extern const fathom_model_facts_t fathom_model_a01anyub;
/** @brief A01CNYUB, automatic: 280 to 2500 mm, 9600 8N1. */
extern const fathom_model_facts_t fathom_model_a01cnyub;
/** @brief A02YYUW, automatic: 30 to 4500 mm, 9600 8N1. */
extern const fathom_model_facts_t fathom_model_a02yyuw;
/** @brief ME007YS, automatic: 280 to 4500 mm, 9600 8N1. */
extern const fathom_model_facts_t fathom_model_me007ys;
/** @brief ME007TX, automatic: 30 to 4000 mm, 9600 8N1. */
extern const fathom_model_facts_t fathom_model_me007tx;
/** @brief A19NYUW, automatic: 280 to 4500 mm, 9600 8N1. */
extern const fathom_model_facts_t fathom_model_a19nyuw;
/** @brief A22NYUW, automatic: 20 to 3000 mm, 115200 8N1. */
extern const fathom_model_facts_t fathom_model_a22nyuw;
/** @brief R01UW, automatic: 20 to 4000 mm, 115200 8N1. */
extern const fathom_model_facts_t fathom_model_r01uw;
/** @brief SEN0754, automatic: 1 to 16350 mm, 115200 8N1. */
extern const fathom_model_facts_t fathom_model_sen0754;
/** @brief DS1603L, automatic: 50 to 2000 mm, 9600 8N1. */
extern const fathom_model_facts_t fathom_model_ds1603l;
/** @brief L023MUW, automatic: 20 to 2000 mm, 9600 8N1. */
extern const fathom_model_facts_t fathom_model_l023muw;
/** @brief A17NYUW, automatic: 250 to 10000 mm, 9600 8N1. */
extern const fathom_model_facts_t fathom_model_a17nyuw;
/** @brief A16NY2W, automatic: 500 to 15000 mm, 9600 8N1. */
extern const fathom_model_facts_t fathom_model_a16ny2w_auto;
/** @brief A16NYTW, controlled: 500 to 15000 mm, 9600 8N1. */
extern const fathom_model_facts_t fathom_model_a16nytw;
/** @brief A02YYTW, controlled: 30 to 4500 mm, 9600 8N1. */
extern const fathom_model_facts_t fathom_model_a02yytw;
/** @brief A06BLYT, controlled: 300 to 2000 mm, 9600 8N1. */
extern const fathom_model_facts_t fathom_model_a06blyt;
/** @brief A12BNYTW, controlled: 250 to 5000 mm, 9600 8N1. */
extern const fathom_model_facts_t fathom_model_a12bnytw;
/** @brief A21AYYTW, controlled: 30 to 5000 mm, 115200 8N1. */
extern const fathom_model_facts_t fathom_model_a21ayytw;
/** @brief A22NYTW, controlled: 20 to 3000 mm, 115200 8N1. */
extern const fathom_model_facts_t fathom_model_a22nytw;
/** @brief L041MTW, controlled: 50 to 6000 mm, 115200 8N1. */
extern const fathom_model_facts_t fathom_model_l041mtw;
/** @brief L042MTW, controlled: 20 to 3000 mm, 115200 8N1. */
extern const fathom_model_facts_t fathom_model_l042mtw;
/** @brief L081MTW, controlled: 50 to 2000 mm, 115200 8N1. */
extern const fathom_model_facts_t fathom_model_l081mtw;
/** @brief L08B50TW, controlled: 80 to 3000 mm, 115200 8N1. */
extern const fathom_model_facts_t fathom_model_l08b50tw;
/** @brief A16NYMW, pulse: 500 to 15000 mm. */
extern const fathom_model_facts_t fathom_model_a16nymw;
/** @brief A02YYMW, pulse: 30 to 4500 mm. */
extern const fathom_model_facts_t fathom_model_a02yymw;
/** @brief A01-PWM, pulse: 280 to 7500 mm. */
extern const fathom_model_facts_t fathom_model_a01_pwm;
/** @brief SEN0300, pulse: 270 to 8000 mm. */
extern const fathom_model_facts_t fathom_model_sen0300_pwm;
/** @brief ME007Y, pulse: 300 to 3500 mm. */
extern const fathom_model_facts_t fathom_model_me007y;
/** @brief URM06-PULSE, pulse: 200 to 10000 mm. */
extern const fathom_model_facts_t fathom_model_urm06_pulse;
/** @brief A16NY4W, Modbus: 500 to 15000 mm, 9600 8N1. */
extern const fathom_model_facts_t fathom_model_a16ny4w;
/** @brief A16NY2W, Modbus: 500 to 15000 mm, 9600 8N1. */
extern const fathom_model_facts_t fathom_model_a16ny2w;
/** @brief A02YY4W, Modbus: 30 to 4500 mm, 9600 8N1. */
extern const fathom_model_facts_t fathom_model_a02yy4w;
/** @brief A12-RS485, Modbus: 250 to 5000 mm, 9600 8N1. */
extern const fathom_model_facts_t fathom_model_a12_rs485;
/** @brief A17NY4W, Modbus: 250 to 10000 mm, 9600 8N1. */
extern const fathom_model_facts_t fathom_model_a17ny4w;
/** @brief A21-RS485, Modbus: 30 to 5000 mm, 115200 8N1. */
extern const fathom_model_facts_t fathom_model_a21_rs485;
/** @brief A22-RS485, Modbus: 20 to 3000 mm, 115200 8N1. */
extern const fathom_model_facts_t fathom_model_a22_rs485;
/** @brief L041M4W, Modbus: 50 to 6000 mm, 115200 8N1. */
extern const fathom_model_facts_t fathom_model_l041m4w;
/** @brief L042M4W, Modbus: 20 to 3000 mm, 115200 8N1. */
extern const fathom_model_facts_t fathom_model_l042m4w;
/** @brief L08-RS485, Modbus: 80 to 3000 mm, 115200 8N1. */
extern const fathom_model_facts_t fathom_model_l08_rs485;
/** @brief Seeed-101991041, Modbus: 280 to 7500 mm, 9600 8N1. */
extern const fathom_model_facts_t fathom_model_seeed_750;
/** @brief Seeed-101991042, Modbus: 250 to 5000 mm, 9600 8N1. */
extern const fathom_model_facts_t fathom_model_seeed_500;
/** @brief SEN0754, Modbus: 1 to 16350 mm, 115200 8N1. */
extern const fathom_model_facts_t fathom_model_sen0754_modbus;
/** @brief DJLK-003AB, Modbus: 1 to 16350 mm, 9600 8N1. */
extern const fathom_model_facts_t fathom_model_djlk_003ab;
/** @brief JSN-SR04T, automatic: 230 to 5000 mm, 9600 8N1. */
extern const fathom_model_facts_t fathom_model_jsn_sr04t_auto;
/** @brief JSN-SR04T, controlled: 230 to 5000 mm, 9600 8N1. */
extern const fathom_model_facts_t fathom_model_jsn_sr04t_controlled;
/** @brief JSN-SR04T, pulse: 230 to 5000 mm. */
extern const fathom_model_facts_t fathom_model_jsn_sr04t_pulse;
/** @brief JSN-SR04T, free-running pulse: 230 to 5000 mm. */
extern const fathom_model_facts_t fathom_model_jsn_sr04t_free;
/** @brief JSN-SR04T-2.0, automatic: 200 to 6000 mm, 9600 8N1. */
extern const fathom_model_facts_t fathom_model_jsn_sr04t_2_auto;
/** @brief JSN-SR04T-2.0, controlled: 200 to 6000 mm, 9600 8N1. */
extern const fathom_model_facts_t fathom_model_jsn_sr04t_2_ctrl;
/** @brief JSN-SR04T-2.0, pulse: 200 to 6000 mm. */
extern const fathom_model_facts_t fathom_model_jsn_sr04t_2_pulse;
/** @brief JSN-SR20-Y1, automatic: 20 to 5000 mm, 9600 8N1. */
extern const fathom_model_facts_t fathom_model_jsn_sr20_auto;
/** @brief JSN-SR20-Y1, controlled: 20 to 5000 mm, 9600 8N1. */
extern const fathom_model_facts_t fathom_model_jsn_sr20_controlled;
/** @brief JSN-SR20-Y1, pulse: 20 to 5000 mm. */
extern const fathom_model_facts_t fathom_model_jsn_sr20_pulse;
/** @brief AJ-SR04M, automatic: 200 to 8000 mm, 9600 8N1. */
extern const fathom_model_facts_t fathom_model_aj_sr04m_auto;
/** @brief AJ-SR04M, controlled: 200 to 8000 mm, 9600 8N1. */
extern const fathom_model_facts_t fathom_model_aj_sr04m_controlled;
/** @brief AJ-SR04M, pulse: 200 to 8000 mm. */
extern const fathom_model_facts_t fathom_model_aj_sr04m_pulse;
/** @brief SR04M-2, controlled: 250 to 4500 mm, 9600 8N1. */
extern const fathom_model_facts_t fathom_model_sr04m_2;
/** @brief HC-SR04, pulse: 20 to 4000 mm. */
extern const fathom_model_facts_t fathom_model_hc_sr04;
/** @brief RCWL-1655, pulse: 200 to 4500 mm. */
extern const fathom_model_facts_t fathom_model_rcwl_1655;
/** @brief A05LYU, automatic: 250 to 4500 mm, 9600 8N1. */
extern const fathom_model_facts_t fathom_model_a05lyu;
/** @brief A05-RS485, 55 AA: 250 to 4500 mm, 9600 8N1. */
extern const fathom_model_facts_t fathom_model_a05_rs485;
/** @brief A05-RS485, Modbus: 250 to 4500 mm, 9600 8N1. */
extern const fathom_model_facts_t fathom_model_a05_modbus;
/** @brief HPS-167S, Modbus: 80 to 18000 mm, 19200 8E1. */
extern const fathom_model_facts_t fathom_model_hps167s;
/** @brief HPS-167, 0A: 80 to 18000 mm, 115200 8N1. */
extern const fathom_model_facts_t fathom_model_hps167;
/** @brief HPS-166, 0A: 80 to 18000 mm, 115200 8N1. */
extern const fathom_model_facts_t fathom_model_hps166;
/* end */

#ifdef __cplusplus
}
#endif

#endif
