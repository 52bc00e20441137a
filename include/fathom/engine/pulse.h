/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_PULSE_H
#define FATHOM_PULSE_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/engine/trigger.h"
#include "fathom/hal.h"
#include "fathom/sample.h"
#include "fathom/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @file
 * @brief Triggers a sensor repeatedly and measures the high pulse that it sends back (A16 1).
 *
 * A fathom_capture_t measures the pulse, so a slow loop costs time and no precision. No function waits, and the only
 * state is in the fathom_pulse_meter_t. Call all functions of one meter from one context. a16_pwm.h is built on this
 * file, and include/COST.md has its size.
 *
 * A cycle begins with the falling edge of the trigger, and is `cycle_us` long, the period of the trigger. It has one
 * outcome:
 *
 * | what the capture reports | outcome |
 * |---|---|
 * | a pulse of `noise_us` to below `no_target_us` | FATHOM_TARGET |
 * | a pulse of `no_target_us` to `stuck_us` | FATHOM_NO_TARGET: the A16 has a fixed pulse of about 94 ms |
 * | a longer pulse | FATHOM_FAULT: no working sensor sends this |
 * | until the end of the cycle only shorter pulses, one of them 100 us or more | FATHOM_UNKNOWN: its longest width |
 * | until the end of the cycle no pulse of 100 us or more, and the line is high | FATHOM_FAULT: width 0, a stuck line |
 * | the same, and the line is low then | FATHOM_ERR_NO_RESPONSE: no supply, a cut wire, another mode |
 *
 * The first pulse of at least `noise_us` decides, wherever it is in the cycle: the 110 ms of the datasheet are
 * information only. The rest of its cycle is not evaluated. All shorter pulses are counted in `noises`.
 *
 * **How long a program can be without an outcome.** If the longest time between two polls is P, each reading or error
 * follows the one before, or the initialisation, within
 *
 *     2 * cycle_us + low_us + 3 * P                if a pin is the trigger
 *     2 * cycle_us + low_us + 2 s + 5 * P          if a break is the trigger
 *
 * by the clock of the meter, whatever the output, the capture and the line do. If the clock stands still, the
 * time stands still with it. If the clock is set back by up to 100 ms, the bound grows by that amount.
 *
 * **Age.** A pulse that ended more than 2.5 s (FATHOM_PULSE_STALE_US) before the poll that takes it is no reading: the
 * outcome is FATHOM_ERR_STALE, and `stales` counts it. A program that sleeps longer than that after a trigger should
 * poll until the outcome of the next cycle. A pause of 71 minutes or more cannot be seen, because the clock wraps: call
 * fathom_pulse_init() again after such a pause.
 *
 * A pulse of another source that is between `noise_us` and `stuck_us` long cannot be distinguished from one of the
 * sensor.
 */

/** Shorter pulses are interference on the wire. From this width on, a pulse shows that a device responds. */
#define FATHOM_PULSE_SHORT_US 100u

/** A pulse that ended longer ago than this is no reading: 2 s, and half a second for a slow loop. */
#define FATHOM_PULSE_STALE_US 2500000uL

/** @brief The reading of one cycle. */
typedef struct {
    uint32_t width_us; /**< Width of the pulse; 0 if the line is stuck. */
    /** Time of the end of the pulse. With FATHOM_UNKNOWN and with a width of 0: time of the poll that ended the
     * cycle. */
    uint32_t time_us;
    uint8_t kind; /**< FATHOM_TARGET, FATHOM_NO_TARGET, FATHOM_FAULT or FATHOM_UNKNOWN. */
} fathom_pulse_reading_t;

/**
 * @brief A meter. The caller owns the memory, and sets the members up to `noise_us` before fathom_pulse_init(). Other
 * members without a remark may be read only.
 */
typedef struct {
    /** Makes the edges. `trigger.output` drives the input of the sensor: a pin, or the break of a UART that has no other
     * use. `trigger.clock` is the clock. What they point to must stay valid until fathom_pulse_deinit(). The period of the
     * trigger is the length of a cycle; trigger.h has the ranges of `trigger.period_us` and `trigger.low_us`. */
    fathom_trigger_t trigger;
    /** Captures the output of the sensor, with `arm` and `take`; not shared. Must stay valid until
     * fathom_pulse_deinit(). Invariant: NULL after an initialisation that failed. */
    const fathom_capture_t *capture;
    /** Pulses from this width on mean that nothing is in range: noise_us + 1..stuck_us, in microseconds. */
    uint32_t no_target_us;
    /** Longer pulses are a fault: no_target_us..trigger.period_us, in microseconds. */
    uint32_t stuck_us;
    /** Shorter pulses are noise: 0..65535 us, below `no_target_us`. Less than the sensor's shortest pulse, by a margin for
     * the clocks of both sides. */
    uint16_t noise_us;

    /* Members of the meter. */
    uint16_t short_us; /**< Longest pulse of this cycle of 100 us..noise_us; 0: none. */
    uint16_t noises;   /**< Pulses shorter than `noise_us`; stops at 65535. The caller may set it to 0. */
    uint16_t stales;   /**< Pulses that were too old; stops at 65535. The caller may set it to 0. */
    bool is_waiting;   /**< A cycle has no outcome yet. */
} fathom_pulse_meter_t;

/**
 * @brief Initialises a meter and makes the trigger high. The first falling edge may come `trigger.low_us` later.
 *
 * If the function fails, the meter is zeroed: set its members again before the next try. The function may be called
 * again at any time; it discards the cycle in progress.
 *
 * @param meter  The meter, with its members set. Must stay valid until fathom_pulse_deinit().
 * @retval FATHOM_OK               The meter is ready.
 * @retval FATHOM_ERR_ARGUMENT     The capture, the clock or the trigger, or one of their functions, is NULL, or a member
 *                                 is outside its range.
 * @retval FATHOM_ERR_UNSUPPORTED  The UART has no `set_break`, or the pin no `set`.
 */
fathom_status_t fathom_pulse_init(fathom_pulse_meter_t *meter);

/**
 * @brief Takes captured pulses, and triggers the next cycle if it is time to. A poll takes at most 16 pulses.
 *
 * In a slow loop the cycles are longer, and the trigger is low until the poll after `low_us`. Poll at least once in 71
 * minutes.
 *
 * @param meter    The meter.
 * @param reading  Written with FATHOM_OK only.
 * @retval FATHOM_OK               `*reading` is the outcome of a cycle. The next cycle has begun if it was time.
 * @retval FATHOM_PENDING          There is no outcome yet.
 * @retval FATHOM_ERR_NO_RESPONSE  The cycle ended without a pulse.
 * @retval FATHOM_ERR_STALE        A pulse was captured, and the program polled too late for it.
 * @retval FATHOM_ERR_PORT         The capture or the output failed; each poll returns this until it works again. Or the
 *                                 output refused for 1 s; this is returned once a second. The meter tries again.
 * @retval FATHOM_ERR_ARGUMENT     The initialisation failed or never ran, and the memory is zeroed.
 */
fathom_status_t fathom_pulse_poll(fathom_pulse_meter_t *meter, fathom_pulse_reading_t *reading);

/**
 * @brief Returns the time in microseconds until fathom_pulse_poll() must be called again if no pulse ends; never
 * FATHOM_NO_DEADLINE. If the end of a pulse does not wake the program, the reading is returned at the end of the cycle.
 * Returns 0 for a meter in zeroed memory.
 */
uint32_t fathom_pulse_due_us(const fathom_pulse_meter_t *meter);

/**
 * @brief Makes the trigger high, if it is low. Call it again, and do not poll, unless it returns FATHOM_OK. The
 * memory belongs to the caller again after that.
 * @retval FATHOM_OK        The trigger is high. A pin, and a meter in zeroed memory, always have this result.
 * @retval FATHOM_PENDING   The UART refused to end the break. The trigger is low until a later call succeeds.
 * @retval FATHOM_ERR_PORT  The break failed, or the UART has refused for 1 s. If the caller gives up, the memory
 *                          belongs to the caller too, and the trigger stays low.
 */
fathom_status_t fathom_pulse_deinit(fathom_pulse_meter_t *meter);

#ifdef __cplusplus
}
#endif

#endif
