/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_PINS_BENCH_H
#define FATHOM_TESTS_PINS_BENCH_H

/* A simulated sensor on the lines of gpiochip0, for the tests of the tool. */

#include "sim/pin.h"
#include "tool_bench.h"

#define PWM "a16:pwm@gpiochip0,trigger=17,echo=27"

static fathom_sim_pins_t pins;
static tool_chip_t chip;
static const tool_run_t *last; /* of EXPECT */

/* What happens so long after the begin; 0: nothing does. */
static uint64_t passed_us;
static uint64_t at_us;
static void (*happens)(void);
static uint64_t until_us; /* and when it is away: it comes back */

static inline void pass(void *ctx, uint32_t max_us)
{
    const uint32_t began_us = bench.clock.now_us;
    fathom_sim_clock_idle(ctx, max_us < 1000 ? max_us : 1000);
    passed_us += bench.clock.now_us - began_us;
    if (at_us != 0 && passed_us >= at_us) {
        at_us = 0;
        happens();
    }
    if (until_us != 0 && passed_us >= until_us) chip.is_away = false;
}

static inline void take_pins(fathom_sim_device_t *device)
{
    fathom_sim_pins_init(&pins, device, &bench.line, &bench.clock);
    chip.trigger = fathom_sim_rx_pin(&pins);
    chip.capture = fathom_sim_capture(&pins);
    chip.in = fathom_sim_tx_pin(&pins);
}

static inline void with_a16(uint8_t mode)
{
    bench_a16((fathom_sim_a16_config_t){.mode = mode});
    take_pins(&bench.a16.device);
}

static inline void with_relay(fathom_sim_a05_config_t config)
{
    config.mode = FATHOM_SIM_A05_RELAY;
    bench_a05(config);
    take_pins(&bench.a05.device);
}

static inline void see(int32_t mm)
{
    for (int i = 0; i != 4; i++) bench.scene.value[i] = mm;
}

static inline int set_up(void **state)
{
    bench_begin();
    chip = (tool_chip_t){.path = "gpiochip0"};
    passed_us = 0;
    at_us = 0;
    until_us = 0;
    bench.tool.chip = &chip;
    bench.tool.idle = pass;
    return 0;
}

static inline unsigned count_of(const char *text, const char *part)
{
    unsigned count = 0;
    for (const char *at = strstr(text, part); at != NULL; at = strstr(at + 1, part)) count++;
    return count;
}

/* Runs it; `out` has this part so often and no other lines. */
#define EXPECT(exit_status, times, part, ...)                                                                \
    do {                                                                                                     \
        const tool_run_t *const ran = tool_run(&bench.tool, __VA_ARGS__);                                    \
        if (ran->status != (exit_status) || count_of(ran->out, part) != (times) ||                           \
            count_of(ran->out, "\n") != (times))                                                             \
            fail_msg("exit status %d, not %u times '%s':\n%s%s", ran->status, (unsigned)(times), part,       \
                     ran->out, ran->err);                                                                    \
        last = ran;                                                                                          \
    } while (0)

static inline void expect_err(const char *text)
{
    if (strstr(last->err, text) == NULL) fail_msg("'%s' is not in\n%s%s", text, last->out, last->err);
}

#endif
