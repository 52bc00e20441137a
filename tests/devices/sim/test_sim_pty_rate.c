/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE
#define _XOPEN_SOURCE 700

#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include "sim/pty.h"
#include "sim_bench.h"

/* A client that sets another rate and sends a request at any moment: also between the two at which the simulated line looks
 * at the terminal, for the rate and for the bytes. */
enum { PATIENCE_MS = 5000 };

static fathom_sim_pty_t pty;
static int client;
static bool is_armed;

int __real_tcgetattr(int fd, struct termios *settings);
int __wrap_tcgetattr(int fd, struct termios *settings);

static void set_rate(speed_t speed)
{
    struct termios raw;
    assert_int_equal(__real_tcgetattr(client, &raw), 0);
    (void)cfsetispeed(&raw, speed);
    (void)cfsetospeed(&raw, speed);
    assert_int_equal(tcsetattr(client, TCSANOW, &raw), 0);
}

/* What the line has just seen is old when it goes on. */
int __wrap_tcgetattr(int fd, struct termios *settings)
{
    static const uint8_t measure[] = {0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xCB}; /* HPS-167S table 17 */
    const int result = __real_tcgetattr(fd, settings);
    if (is_armed) {
        is_armed = false;
        set_rate(B19200);
        assert_int_equal(write(client, measure, sizeof measure), sizeof measure);
    }
    return result;
}

static int tear_down(void **state)
{
    (void)close(client);
    fathom_sim_pty_close(&pty);
    return 0;
}

static const suite_t suite = {.tear_down = tear_down};

TEST(a_request_is_at_the_rate_that_was_set_before_it)
{
    uint8_t bytes[13];
    size_t heard = 0;
    uint32_t due_us = 0;
    bench_begin(&bench_19200, true);
    fathom_sim_line_init(&bench.line, &bench_19200, fathom_sim_pty_now_us());
    bench.line.full_duplex = true;
    assert_int_equal(fathom_sim_pty_open(&pty, &bench.line, NULL), 0);
    bench.fixed = FIXED(2083);
    add_hps((hps_config_t){0});
    client = open(fathom_sim_pty_path(&pty), O_RDWR | O_NOCTTY | O_NONBLOCK);
    assert_true(client >= 0);
    set_rate(B9600);
    assert_int_equal(fathom_sim_pty_pump(&pty, &due_us), 0);
    is_armed = true;
    for (int i = 0; heard != sizeof bytes && i != PATIENCE_MS; i++) {
        struct pollfd fds = {.fd = client, .events = POLLIN};
        assert_int_equal(fathom_sim_pty_pump(&pty, &due_us), 0);
        if (poll(&fds, 1, 1) == 1) heard += (size_t)read(client, bytes + heard, sizeof bytes - heard);
    }
    assert_int_equal(bench.device->counters.wrong_settings, 0);
    assert_true(is_hex(bytes, "01 03 08 08 23 DC B2 07 01 00 00 FD 41"));
}
