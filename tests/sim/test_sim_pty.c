/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE
#define _XOPEN_SOURCE 700

#include "bench.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include "sim/a16.h"
#include "sim/hps167s.h"
#include "sim/pty.h"
#include "sim/scene.h"

/* In real time: every wait is for an event and has an end. Lower bounds of times are exact, upper ones leave
 * room for a loaded machine. */
enum { MS = 1000, PATIENCE_MS = 5000 };

typedef struct {
    fathom_sim_line_t line;
    fathom_sim_fixed_t fixed;
    fathom_sim_a16_t a16;
    fathom_sim_hps167s_t hps;
    fathom_sim_pty_t pty;
    char directory[64];
    char link[128];
} stage_t;

static void set_up(stage_t *s, const fathom_line_settings_t *settings)
{
    memset(s, 0, sizeof *s);
    fathom_sim_line_init(&s->line, settings, fathom_sim_pty_now_us());
    s->line.full_duplex = true;
    strcpy(s->directory, "/tmp/fathom_sim_pty_XXXXXX");
    assert_non_null(mkdtemp(s->directory));
    snprintf(s->link, sizeof s->link, "%s/port", s->directory);
    const fathom_sim_pty_config_t config = {.link = s->link};
    assert_int_equal(fathom_sim_pty_open(&s->pty, &s->line, &config), 0);
}

static void set_a16(stage_t *s, uint8_t mode)
{
    set_up(s, &bench_9600);
    s->fixed.value[0] = mode == FATHOM_SIM_A16_AUTO ? 1953 : 751;
    const fathom_sim_a16_config_t config = {.mode = mode, .scene = fathom_sim_fixed(&s->fixed)};
    fathom_sim_a16_init(&s->a16, &config);
    fathom_sim_attach(&s->line, &s->a16.device, fathom_sim_pty_now_us());
}

static void tear_down(stage_t *s)
{
    struct stat there;
    fathom_sim_pty_close(&s->pty);
    assert_int_equal(lstat(s->link, &there), -1); /* it leaves nothing behind */
    assert_int_equal(rmdir(s->directory), 0);
}

static int open_client(const char *path, speed_t speed)
{
    struct termios raw;
    const int fd = open(path, O_RDWR | O_NOCTTY | O_NONBLOCK);
    assert_true(fd >= 0);
    assert_int_equal(tcgetattr(fd, &raw), 0);
    raw.c_lflag = raw.c_iflag = raw.c_oflag = 0;
    raw.c_cflag = CS8 | CREAD | CLOCAL;
    cfsetispeed(&raw, speed);
    cfsetospeed(&raw, speed);
    assert_int_equal(tcsetattr(fd, TCSANOW, &raw), 0);
    return fd;
}

/* Pumps until the client has `count` bytes or `limit_ms` have passed; returns how many it has. */
static size_t hear(stage_t *s, int client, uint8_t *bytes, size_t count, uint32_t limit_ms)
{
    const uint32_t begin_us = fathom_sim_pty_now_us();
    size_t heard = 0;
    for (;;) {
        uint32_t due_us = 0;
        assert_int_equal(fathom_sim_pty_pump(&s->pty, &due_us), 0);
        if (client >= 0 && heard < count) {
            const ssize_t more = read(client, bytes + heard, count - heard);
            if (more > 0) heard += (size_t)more;
        }
        const uint32_t gone_ms = fathom_elapsed_us(fathom_sim_pty_now_us(), begin_us) / MS;
        if (heard == count || gone_ms >= limit_ms) return heard;
        const uint32_t left_ms = limit_ms - gone_ms;
        struct pollfd fds = {.fd = fathom_sim_pty_fd(&s->pty), .events = POLLIN};
        const uint32_t wait_ms = due_us / MS < left_ms ? (due_us + MS - 1) / MS : left_ms;
        assert_true(poll(&fds, 1, (int)wait_ms) >= 0);
        assert_int_equal(fds.revents & (POLLHUP | POLLERR | POLLNVAL), 0);
    }
}

static const uint8_t ask_realtime[] = {0x01, 0x03, 0x01, 0x01, 0x00, 0x01, 0xD4, 0x36}; /* A16 6(4) ex 2 */
static const uint8_t realtime[] = {0x01, 0x03, 0x02, 0x02, 0xEF, 0xF8, 0xA8};

static void exchange(stage_t *s, int client)
{
    uint8_t bytes[16];
    const uint32_t begin_us = fathom_sim_pty_now_us();
    assert_int_equal(write(client, ask_realtime, 8), 8);
    assert_int_equal(hear(s, client, bytes, 7, PATIENCE_MS), 7);
    assert_memory_equal(bytes, realtime, 7);
    /* request 8.3 ms, at least 105 ms of work, answer 7.3 ms */
    assert_true(fathom_elapsed_us(fathom_sim_pty_now_us(), begin_us) >= 120 * MS);
}

TEST(a_client_gets_an_answer_in_true_time)
{
    stage_t s;
    set_a16(&s, FATHOM_SIM_A16_MODBUS);
    const int client = open_client(fathom_sim_pty_path(&s.pty), B9600);
    exchange(&s, client);
    close(client);
    tear_down(&s);
}

TEST(the_port_is_raw_before_anyone_makes_it_so)
{
    uint8_t byte;
    stage_t s;
    set_a16(&s, FATHOM_SIM_A16_MODBUS);
    const int client = open(s.link, O_RDWR | O_NOCTTY | O_NONBLOCK);
    assert_true(client >= 0);
    exchange(&s, client);
    /* no terminal has echoed the answer to the device */
    assert_int_equal(hear(&s, client, &byte, 1, 50), 0);
    assert_int_equal(s.line.counters.from_host, 8);
    close(client);
    tear_down(&s);
}

TEST(automatic_frames_come_at_their_own_pace)
{
    uint8_t bytes[20];
    stage_t s;
    set_a16(&s, FATHOM_SIM_A16_AUTO);
    const uint32_t begin_us = fathom_sim_pty_now_us();
    const int client = open_client(s.link, B9600);
    assert_int_equal(hear(&s, client, bytes, 12, PATIENCE_MS), 12);
    assert_true(fathom_elapsed_us(fathom_sim_pty_now_us(), begin_us) >= 290 * MS);
    for (size_t i = 0; i < 12; i += 4)
        assert_memory_equal(bytes + i, ((const uint8_t[]){0xFF, 0x07, 0xA1, 0xA7}), 4); /* A16 2(4) */
    close(client);
    tear_down(&s);
}

TEST(clients_come_and_go)
{
    uint8_t byte;
    stage_t s;
    set_a16(&s, FATHOM_SIM_A16_MODBUS);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(hear(&s, -1, &byte, 1, 20), 0); /* nobody is there: no error, no spinning */
        const int client = open_client(s.link, B9600);
        exchange(&s, client);
        close(client);
    }
    /* one that leaves before its answer */
    int client = open_client(s.link, B9600);
    assert_int_equal(write(client, ask_realtime, 8), 8);
    assert_int_equal(hear(&s, client, &byte, 1, 20), 0);
    close(client);
    assert_int_equal(hear(&s, -1, &byte, 1, 200), 0);
    assert_int_equal(s.a16.device.counters.answered, 4);
    client = open_client(s.link, B9600);
    tcflush(client, TCIFLUSH);
    exchange(&s, client);
    close(client);
    tear_down(&s);
}

TEST(without_input_it_need_not_be_called)
{
    uint32_t due_us = 0;
    stage_t s;
    set_a16(&s, FATHOM_SIM_A16_MODBUS);
    assert_int_equal(fathom_sim_pty_pump(&s.pty, &due_us), 0);
    assert_int_equal(due_us, UINT32_C(600000000));
    tear_down(&s);
    set_a16(&s, FATHOM_SIM_A16_AUTO);
    assert_int_equal(fathom_sim_pty_pump(&s.pty, &due_us), 0);
    assert_in_range(due_us, 0, 100 * MS);
    tear_down(&s);
}

TEST(a_device_hears_its_own_rate_only)
{
    const uint8_t measure[] = {0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xCB}; /* HPS-167S table 17 */
    uint8_t bytes[16];
    stage_t s;
    set_up(&s, &bench_19200);
    s.fixed.value[0] = 2083;
    const fathom_sim_hps167s_config_t config = {.scene = fathom_sim_fixed(&s.fixed)};
    fathom_sim_hps167s_init(&s.hps, &config);
    fathom_sim_attach(&s.line, &s.hps.device, fathom_sim_pty_now_us());
    int client = open_client(s.link, B9600);
    assert_int_equal(write(client, measure, 8), 8);
    assert_int_equal(hear(&s, client, bytes, 1, 100), 0);
    assert_int_equal(s.hps.device.counters.wrong_settings, 8);
    close(client);
    client = open_client(s.link, B19200);
    assert_int_equal(write(client, measure, 8), 8);
    assert_int_equal(hear(&s, client, bytes, 13, PATIENCE_MS), 13);
    assert_memory_equal(
        bytes,
        ((const uint8_t[]){0x01, 0x03, 0x08, 0x08, 0x23, 0xDC, 0xB2, 0x07, 0x01, 0x00, 0x00, 0xFD, 0x41}),
        13);
    s.pty.ignore_baud = true;
    close(client);
    client = open_client(s.link, B115200);
    assert_int_equal(write(client, measure, 8), 8);
    assert_int_equal(hear(&s, client, bytes, 13, PATIENCE_MS), 13);
    close(client);
    tear_down(&s);
}

TEST(what_nobody_reads_does_not_pile_up)
{
    uint8_t bytes[4096];
    stage_t s;
    set_a16(&s, FATHOM_SIM_A16_AUTO);
    s.a16.device.period_us = 5 * MS; /* 800 bytes a second */
    assert_int_equal(hear(&s, -1, bytes, 1, 1200), 0);
    assert_true(s.a16.device.counters.automatic > 150); /* more than 600 bytes */
    const int client = open_client(s.link, B9600);
    const ssize_t old = read(client, bytes, sizeof bytes);
    assert_in_range(old, 1, 510);
    assert_int_equal(hear(&s, client, bytes, 8, PATIENCE_MS), 8);
    close(client);
    tear_down(&s);
}

TEST(the_link_leads_to_the_terminal_and_replaces_an_old_one)
{
    char target[64] = {0};
    stage_t s;
    fathom_sim_pty_t second;
    set_up(&s, &bench_9600);
    assert_true(readlink(s.link, target, sizeof target - 1) > 0);
    assert_string_equal(target, fathom_sim_pty_path(&s.pty));
    fathom_sim_line_t line;
    fathom_sim_line_init(&line, &bench_9600, fathom_sim_pty_now_us());
    const fathom_sim_pty_config_t config = {.link = s.link};
    assert_int_equal(fathom_sim_pty_open(&second, &line, &config), 0);
    memset(target, 0, sizeof target);
    assert_true(readlink(s.link, target, sizeof target - 1) > 0);
    assert_string_equal(target, fathom_sim_pty_path(&second));
    fathom_sim_pty_close(&s.pty); /* it is not the first one's any more */
    assert_int_equal(access(s.link, F_OK), 0);
    fathom_sim_pty_close(&second);
    fathom_sim_pty_close(&second); /* twice is no error */
    tear_down(&s);
}

TEST(a_file_in_the_place_of_the_link_is_left_alone)
{
    char path[64];
    fathom_sim_line_t line;
    fathom_sim_pty_t pty;
    strcpy(path, "/tmp/fathom_sim_file_XXXXXX");
    const int fd = mkstemp(path);
    assert_true(fd >= 0);
    fathom_sim_line_init(&line, &bench_9600, fathom_sim_pty_now_us());
    const fathom_sim_pty_config_t config = {.link = path};
    assert_int_equal(fathom_sim_pty_open(&pty, &line, &config), -1);
    assert_int_equal(errno, EEXIST);
    assert_int_equal(access(path, F_OK), 0);
    close(fd);
    assert_int_equal(unlink(path), 0);
    /* nor is a place where none can be made an invention */
    const fathom_sim_pty_config_t nowhere = {.link = "/nowhere/at/all"};
    assert_int_equal(fathom_sim_pty_open(&pty, &line, &nowhere), -1);
    assert_int_equal(errno, ENOENT);
    assert_int_equal(fathom_sim_pty_fd(&pty), -1);
    char long_name[300];
    memset(long_name, 'x', sizeof long_name);
    long_name[299] = '\0';
    const fathom_sim_pty_config_t too_long = {.link = long_name};
    assert_int_equal(fathom_sim_pty_open(&pty, &line, &too_long), -1);
    assert_int_equal(errno, ENAMETOOLONG);
}
