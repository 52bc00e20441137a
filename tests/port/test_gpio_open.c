/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* mkstemp, chown */
#include <errno.h>
#include <fcntl.h>
#include <grp.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include "gpio_chip.h"
#include "posix_pty.h"

/* What fathom_gpio_open_... asks of the kernel, and says when that refuses; levels of pins without edges. */

static fathom_gpio_t gpio;

static int begins(void **state)
{
    chip_reset();
    memset(&gpio, 0, sizeof gpio);
    return 0;
}

static int ends(void **state)
{
    fathom_gpio_close(&gpio);
    assert_int_equal(chip.open_chips, 0); /* nothing but the line stays open */
    chip_reset();
    return 0;
}

static const suite_t suite = {.set_up = begins, .tear_down = ends};

enum { OUTPUT, INPUT, EDGES };

static fathom_gpio_status_t open_as(int kind, const char *name, uint32_t line)
{
    memset(&gpio, 0xA5, sizeof gpio); /* any content will do */
    if (kind == OUTPUT) return fathom_gpio_open_output(&gpio, name, line, true);
    if (kind == INPUT) return fathom_gpio_open_input(&gpio, name, line, FATHOM_GPIO_BIAS_PULL_UP);
    return fathom_gpio_open_edges(&gpio, name, line, FATHOM_GPIO_BIAS_AS_IS);
}

static void expect_failure(int kind, const char *name, uint32_t line, fathom_gpio_status_t error,
                           const char *text)
{
    const unsigned before = posix_count_fds();
    assert_int_equal(open_as(kind, name, line), error);
    assert_int_equal(fathom_gpio_error(&gpio), error);
    assert_int_equal(fathom_gpio_fd(&gpio), -1);
    gpio_says(&gpio, text);
    assert_null(strchr(fathom_gpio_error_text(&gpio), '\n'));
    fathom_gpio_close(&gpio);
    assert_int_equal(posix_count_fds(), before);
}

TEST(an_output_is_requested_with_its_level)
{
    assert_int_equal(open_as(OUTPUT, "gpiochip0", 17), FATHOM_GPIO_OK);
    const struct gpio_v2_line_request *const request = &chip.lines[0].request;
    assert_int_equal(request->num_lines, 1);
    assert_int_equal(request->offsets[0], 17);
    assert_string_equal(request->consumer, "fathom");
    assert_int_equal(request->config.flags, GPIO_V2_LINE_FLAG_OUTPUT);
    assert_int_equal(request->config.num_attrs, 1);
    assert_int_equal(request->config.attrs[0].attr.id, GPIO_V2_LINE_ATTR_ID_OUTPUT_VALUES);
    assert_int_equal(request->config.attrs[0].mask, 1);
    assert_true(chip.lines[0].level);
    assert_int_equal(chip.open_flags & (O_ACCMODE | O_CLOEXEC), O_RDWR | O_CLOEXEC);
    assert_int_equal(chip.open_chips, 0);
    fathom_gpio_close(&gpio);
    assert_int_equal(fathom_gpio_open_output(&gpio, "/dev/gpiochip0", 4, false), FATHOM_GPIO_OK);
    assert_false(chip.lines[0].level);
}

TEST(an_output_is_driven)
{
    assert_int_equal(open_as(OUTPUT, "gpiochip0", 17), FATHOM_GPIO_OK);
    const fathom_pin_t pin = fathom_gpio_pin(&gpio);
    assert_null(pin.get);
    pin.set(pin.ctx, false);
    assert_false(chip.lines[0].level);
    chip.interrupts = 2;
    pin.set(pin.ctx, true);
    assert_true(chip.lines[0].level);
    assert_int_equal(chip.lines[0].sets, 2);
    assert_int_equal(fathom_gpio_error(&gpio), FATHOM_GPIO_OK);
    assert_string_equal(fathom_gpio_error_text(&gpio), "");
}

TEST(an_input_is_requested_with_its_resistor_and_no_edges)
{
    static const uint64_t flags[] = {
        0, GPIO_V2_LINE_FLAG_BIAS_PULL_UP, GPIO_V2_LINE_FLAG_BIAS_PULL_DOWN,
        GPIO_V2_LINE_FLAG_BIAS_DISABLED}; /* in the order of fathom_gpio_bias_t */
    for (int bias = 0; bias != 4; bias++) {
        assert_int_equal(fathom_gpio_open_input(&gpio, "gpiochip0", 5, (fathom_gpio_bias_t)bias),
                         FATHOM_GPIO_OK);
        assert_int_equal(chip.lines[0].request.config.flags, GPIO_V2_LINE_FLAG_INPUT | flags[bias]);
        assert_int_equal(chip.lines[0].request.config.num_attrs, 0);
        fathom_gpio_close(&gpio);
        assert_int_equal(fathom_gpio_open_edges(&gpio, "gpiochip0", 5, (fathom_gpio_bias_t)bias),
                         FATHOM_GPIO_OK);
        assert_int_equal(chip.lines[0].request.config.flags,
                         GPIO_V2_LINE_FLAG_INPUT | GPIO_V2_LINE_FLAG_EDGE_RISING |
                             GPIO_V2_LINE_FLAG_EDGE_FALLING | flags[bias]);
        assert_int_equal(chip.lines[0].request.event_buffer_size, FATHOM_GPIO_QUEUE);
        fathom_gpio_close(&gpio);
    }
}

TEST(an_input_tells_its_level)
{
    assert_int_equal(open_as(INPUT, "gpiochip0", 5), FATHOM_GPIO_OK);
    const fathom_pin_t pin = fathom_gpio_pin(&gpio);
    assert_null(pin.set);
    assert_false(pin.get(pin.ctx));
    chip.lines[0].level = true;
    chip.interrupts = 1;
    assert_true(pin.get(pin.ctx));
    chip.lines[0].level = false;
    assert_false(pin.get(pin.ctx));
}

TEST(a_contact_does_not_open_because_the_chip_has_gone)
{
    assert_int_equal(open_as(INPUT, "gpiochip0", 5), FATHOM_GPIO_OK);
    const fathom_pin_t pin = fathom_gpio_pin(&gpio);
    chip.lines[0].level = true;
    assert_true(pin.get(pin.ctx));
    chip.level_error = ENODEV;
    assert_true(pin.get(pin.ctx));
    assert_int_equal(fathom_gpio_error(&gpio), FATHOM_GPIO_ERR_LOST);
    gpio_says(&gpio, "/dev/gpiochip0, line 5: the chip has gone");
    /* For good, until it is opened again: then it is what it is. */
    chip.level_error = 0;
    chip.lines[0].level = false;
    assert_true(pin.get(pin.ctx));
    fathom_gpio_close(&gpio);
    assert_int_equal(open_as(INPUT, "gpiochip0", 5), FATHOM_GPIO_OK);
    assert_false(pin.get(pin.ctx));
    assert_int_equal(fathom_gpio_error(&gpio), FATHOM_GPIO_OK);
}

TEST(an_output_of_a_chip_that_has_gone_is_told)
{
    assert_int_equal(open_as(OUTPUT, "gpiochip0", 17), FATHOM_GPIO_OK);
    const fathom_pin_t pin = fathom_gpio_pin(&gpio);
    chip.set_error = ENODEV;
    pin.set(pin.ctx, false);
    assert_int_equal(fathom_gpio_error(&gpio), FATHOM_GPIO_ERR_LOST);
    gpio_says(&gpio, "/dev/gpiochip0, line 17: the chip has gone (No such device)");
    chip.set_error = 0;
    pin.set(pin.ctx, false);
    assert_int_equal(chip.lines[0].sets, 0);
    static const struct {
        int error;
        const char *text;
    } rows[] = {{ENXIO, "the chip has gone (No such device or address)"},
                {EIO, "setting it: Input/output error"}};
    for (unsigned i = 0; i != 2; i++) {
        fathom_gpio_close(&gpio);
        assert_int_equal(open_as(OUTPUT, "gpiochip0", 17), FATHOM_GPIO_OK);
        chip.set_error = rows[i].error;
        pin.set(pin.ctx, false);
        gpio_says(&gpio, rows[i].text);
        chip.set_error = 0;
    }
}

/* The system gives the number of its descriptor to the next one that is opened. */
TEST(a_pin_that_is_closed_leaves_the_others_alone)
{
    static fathom_gpio_t next;
    assert_int_equal(open_as(OUTPUT, "gpiochip0", 17), FATHOM_GPIO_OK);
    const fathom_pin_t pin = fathom_gpio_pin(&gpio);
    const int fd = fathom_gpio_fd(&gpio);
    fathom_gpio_close(&gpio);
    assert_int_equal(fathom_gpio_open_output(&next, "gpiochip0", 18, true), FATHOM_GPIO_OK);
    assert_int_equal(fathom_gpio_fd(&next), fd);
    pin.set(pin.ctx, false);
    assert_int_equal(chip.lines[0].sets, 0);
    fathom_gpio_close(&gpio);
    assert_int_equal(chip.lines[0].fd, fd);
    fathom_gpio_close(&next);
}

TEST(a_call_that_was_interrupted_is_repeated)
{
    chip.interrupts = 3;
    assert_int_equal(open_as(EDGES, "gpiochip0", 27), FATHOM_GPIO_OK);
    assert_int_equal(chip.interrupts, 0);
    assert_int_equal(chip.opened, 1);
}

enum {
    ARGUMENT = FATHOM_GPIO_ERR_ARGUMENT,
    NOT_FOUND = FATHOM_GPIO_ERR_NOT_FOUND,
    NOT_A_CHIP = FATHOM_GPIO_ERR_NOT_A_CHIP,
    NO_LINE = FATHOM_GPIO_ERR_NO_LINE,
    IN_USE = FATHOM_GPIO_ERR_IN_USE,
    PERMISSION = FATHOM_GPIO_ERR_PERMISSION,
    UNSUPPORTED = FATHOM_GPIO_ERR_UNSUPPORTED,
    SYSTEM = FATHOM_GPIO_ERR_SYSTEM
};

TEST(whatever_fails_is_an_error_with_its_reason)
{
    static const char of_32[] = "xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx"; /* without its zero */
    static const struct {
        int kind;
        uint32_t line;
        int error;
        const char *text;
        struct {
            const char *name;              /* NULL: gpiochip0 */
            int open, chip, info, request; /* the errors of its calls */
            bool is_rigid;
            const char *consumer;
        } has;
    } rows[] = {
        /* names */
        {INPUT, 1, ARGUMENT, "no chip was named", {.name = ""}},
        {INPUT, 1, NOT_A_CHIP, "/dev/null, line 1: not a GPIO chip", {.name = "/dev/null"}},
        {INPUT, 1, NOT_A_CHIP, "/, line 1: not a GPIO chip", {.name = "/"}},
        {INPUT, 1, NOT_A_CHIP, "not a GPIO chip; ls /dev/gpiochip* lists", {.name = "/tmp"}},
        {INPUT, 1, NOT_A_CHIP, "/dev/null, line 1: ", {.name = "null"}},
        {INPUT, 1, NOT_A_CHIP, "not a GPIO chip", {.chip = EINVAL}},
        {OUTPUT, 1, NOT_FOUND, "/dev/gpiochip77, line 1: no such chip; ls ", {.name = "gpiochip77"}},
        {OUTPUT, 1, NOT_FOUND, "no such chip", {.name = "/dev/null/gpiochip0"}},
        {OUTPUT, 1, NOT_FOUND, "no chip behind this name", {.open = ENODEV}},
        {OUTPUT, 1, NOT_FOUND, "no chip behind this name", {.open = ENXIO}},
        {OUTPUT, 1, NOT_FOUND, "no chip behind this name", {.chip = ENODEV}},
        {OUTPUT, 1, SYSTEM, "opening it: Too many open files", {.open = EMFILE}},
        {OUTPUT, 17, PERMISSION, "line 17: permission denied", {.open = EPERM}},
        {OUTPUT, 17, PERMISSION, "line 17: permission denied", {.open = EACCES}},
        /* lines */
        {INPUT, 54, NO_LINE, "line 54: the chip has the lines 0 to 53", {0}},
        {OUTPUT, 4000000000u, NO_LINE, "line 4000000000: the chip has", {0}},
        {OUTPUT, 8, IN_USE, "in use by another program or by a driver", {.request = EBUSY}},
        {OUTPUT, 8, IN_USE, "in use by \"spi0 CS0\"; ", {.request = EBUSY, .consumer = "spi0 CS0"}},
        {OUTPUT, 8, IN_USE, "in use by \"y\"; end that program", {.request = EBUSY, .consumer = "y"}},
        {OUTPUT, 8, IN_USE, "xxx\"; end that program", {.request = EBUSY, .consumer = of_32}},
        {OUTPUT, 17, PERMISSION, "this line is not for programs", {.request = EPERM}},
        {OUTPUT, 17, PERMISSION, "this line is not for programs", {.request = EACCES}},
        {OUTPUT, 17, SYSTEM, "taking it: Cannot allocate memory", {.request = ENOMEM}},
        {EDGES, 27, SYSTEM, "making its reads return at once: Bad file descriptor", {.is_rigid = true}},
        /* a kernel with version 1 only */
        {INPUT, 5, UNSUPPORTED, "version 1 of the GPIO interface only; Linux 5.10", {.info = EINVAL}},
        {EDGES, 5, UNSUPPORTED, "version 1 ", {.info = ENOTTY}},
        {INPUT, 5, NOT_FOUND, "no chip behind this name", {.info = ENODEV}},
        /* gpiolib, edge_detector_setup(): the line has no interrupt; EIO: the chip has no such direction */
        {EDGES, 27, UNSUPPORTED, "no interrupt for it, so edges are not told", {.request = ENODEV}},
        {INPUT, 27, NOT_FOUND, "no chip behind this name", {.request = ENODEV}},
        {EDGES, 27, UNSUPPORTED, "no interrupt for it", {.request = ENXIO}},
        {OUTPUT, 17, UNSUPPORTED, "it cannot be an output", {.request = EIO}},
        {INPUT, 17, UNSUPPORTED, "it cannot be an input", {.request = EIO}},
    };
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        chip_reset();
        chip.open_error = rows[i].has.open;
        chip.chip_error = rows[i].has.chip;
        chip.info_error = rows[i].has.info;
        chip.request_error = rows[i].has.request;
        chip.is_rigid = rows[i].has.is_rigid;
        if (rows[i].has.consumer != NULL)
            memcpy(chip.consumer, rows[i].has.consumer, strlen(rows[i].has.consumer));
        expect_failure(rows[i].kind, rows[i].has.name != NULL ? rows[i].has.name : "gpiochip0", rows[i].line,
                       (fathom_gpio_status_t)rows[i].error, rows[i].text);
        assert_int_equal(chip.refused, rows[i].has.request != 0);
        assert_int_equal(chip.opened, rows[i].has.is_rigid);
    }
}

TEST(what_the_chip_cannot_do_is_told_for_each_kind_of_pin)
{
    static const int refusals[] = {EINVAL, EOPNOTSUPP, 524 /* ENOTSUPP, the kernel's own */};
    for (unsigned i = 0; i != 3; i++) {
        chip.request_error = refusals[i];
        expect_failure(INPUT, "gpiochip0", 17, FATHOM_GPIO_ERR_UNSUPPORTED,
                       "refuses an input like this; take");
        expect_failure(EDGES, "gpiochip0", 17, FATHOM_GPIO_ERR_UNSUPPORTED,
                       "refuses an input like this, with edges");
        expect_failure(OUTPUT, "gpiochip0", 17, FATHOM_GPIO_ERR_UNSUPPORTED,
                       "refuses an output like this; take");
    }
}

TEST(a_path_is_there_and_has_127_characters_at_most)
{
    static const unsigned lengths[] = {299, 139, 128};
    char path[300] = "/dev/";
    memset(path + 5, 'x', 294);
    for (unsigned i = 0; i != 3; i++) {
        path[lengths[i]] = '\0';
        expect_failure(INPUT, path, 1, FATHOM_GPIO_ERR_ARGUMENT, "a path has 127 characters at most");
    }
    expect_failure(INPUT, NULL, 1, FATHOM_GPIO_ERR_ARGUMENT, "pin, line 1: no chip was named");
    path[127] = '\0';
    expect_failure(INPUT, path, 1, FATHOM_GPIO_ERR_NOT_FOUND, "no such chip");
    assert_int_equal(fathom_gpio_open_input(NULL, path, 1, FATHOM_GPIO_BIAS_AS_IS), FATHOM_GPIO_ERR_ARGUMENT);
    fathom_gpio_close(NULL);
    assert_int_equal(open_as(INPUT, "gpiochip0", 53), FATHOM_GPIO_OK); /* its last line */
}

static int open_is_denied(void *path)
{
    if (fathom_gpio_open_input(&gpio, path, 4, FATHOM_GPIO_BIAS_AS_IS) != FATHOM_GPIO_ERR_PERMISSION)
        return 1;
    const char *const text = fathom_gpio_error_text(&gpio);
    return strstr(text, "line 4: permission denied: it belongs to the group ") != NULL &&
                   strstr(text, "GROUP=\"gpio\"") != NULL
               ? 0
               : 2;
}

/* Permissions as Debian has them: root's alone. */
TEST(a_file_is_no_chip_and_if_denied_named_with_its_group_and_the_rule)
{
    char file[] = "/tmp/fathom-test-XXXXXX";
    const int fd = mkstemp(file);
    assert_true(fd >= 0);
    expect_failure(INPUT, file, 1, FATHOM_GPIO_ERR_NOT_A_CHIP, "not a GPIO chip; ls /dev/gpiochip* lists");
    assert_int_equal(fchmod(fd, 0), 0);
    assert_int_equal(close(fd), 0);
    assert_int_equal(posix_run_unprivileged(open_is_denied, file), 0);
    assert_int_equal(unlink(file), 0);
}
