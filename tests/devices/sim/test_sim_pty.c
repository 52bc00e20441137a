/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE
#define _XOPEN_SOURCE 700

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include "sim/pty.h"
#include "sim_bench.h"

/* In real time: every wait is for an event and has an end. Lower bounds of times are exact, upper ones leave
 * room for a loaded machine. */
enum { PATIENCE_MS = 5000 };

static fathom_sim_pty_t pty;
static char directory[64];
static char link_path[128];

static void set_up(const fathom_line_settings_t *settings)
{
    bench_begin(settings, true);
    fathom_sim_line_init(&bench.line, settings, fathom_sim_pty_now_us());
    bench.line.full_duplex = true;
    strcpy(directory, "/tmp/fathom_sim_pty_XXXXXX");
    assert_non_null(mkdtemp(directory));
    snprintf(link_path, sizeof link_path, "%s/port", directory);
    const fathom_sim_pty_config_t config = {.link = link_path};
    assert_int_equal(fathom_sim_pty_open(&pty, &bench.line, &config), 0);
}

static void set_sending(uint8_t mode)
{
    set_up(&bench_9600);
    bench.fixed = FIXED(mode == FATHOM_SIM_A16_AUTO ? 1953 : 751);
    add_a16(mode, (a16_config_t){0});
}

static int tear_down(void **state)
{
    struct stat there;
    if (directory[0] == '\0') return 0; /* the test had none */
    fathom_sim_pty_close(&pty);
    assert_int_equal(lstat(link_path, &there), -1); /* it leaves nothing behind */
    assert_int_equal(rmdir(directory), 0);
    directory[0] = '\0';
    return 0;
}

static const suite_t suite = {.tear_down = tear_down};

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
static size_t pump(int client, uint8_t *bytes, size_t count, uint32_t limit_ms)
{
    const uint32_t begin_us = fathom_sim_pty_now_us();
    size_t heard = 0;
    for (;;) {
        uint32_t due_us = 0;
        assert_int_equal(fathom_sim_pty_pump(&pty, &due_us), 0);
        if (client >= 0 && heard < count) {
            const ssize_t more = read(client, bytes + heard, count - heard);
            if (more > 0) heard += (size_t)more;
        }
        const uint32_t gone_ms = fathom_elapsed_us(fathom_sim_pty_now_us(), begin_us) / MS;
        if (heard == count || gone_ms >= limit_ms) return heard;
        const uint32_t left_ms = limit_ms - gone_ms;
        struct pollfd fds = {.fd = fathom_sim_pty_fd(&pty), .events = POLLIN};
        const uint32_t wait_ms = due_us / MS < left_ms ? (due_us + MS - 1) / MS : left_ms;
        assert_true(poll(&fds, 1, (int)wait_ms) >= 0);
        assert_int_equal(fds.revents & (POLLHUP | POLLERR | POLLNVAL), 0);
    }
}

static const uint8_t ask_realtime[] = {0x01, 0x03, 0x01, 0x01, 0x00, 0x01, 0xD4, 0x36}; /* A16 6(4) ex 2 */

static void transaction(int client)
{
    uint8_t bytes[16];
    const uint32_t begin_us = fathom_sim_pty_now_us();
    assert_int_equal(write(client, ask_realtime, 8), 8);
    assert_int_equal(pump(client, bytes, 7, PATIENCE_MS), 7);
    assert_true(is_hex(bytes, "01 03 02 02 EF F8 A8"));
    /* request 8.3 ms, at least 105 ms of work, response 7.3 ms */
    assert_true(fathom_elapsed_us(fathom_sim_pty_now_us(), begin_us) >= 120 * MS);
}

static void transaction_at(const char *path)
{
    const int client = open_client(path, B9600);
    transaction(client);
    close(client);
}

TEST(a_client_gets_a_response_in_true_time)
{
    set_sending(FATHOM_SIM_A16_MODBUS);
    transaction_at(fathom_sim_pty_path(&pty));
}

TEST(the_port_is_raw_before_a_client_makes_it_so)
{
    uint8_t byte;
    set_sending(FATHOM_SIM_A16_MODBUS);
    const int client = open(link_path, O_RDWR | O_NOCTTY | O_NONBLOCK);
    assert_true(client >= 0);
    transaction(client);
    /* no terminal has echoed the response to the device */
    assert_int_equal(pump(client, &byte, 1, 50), 0);
    assert_int_equal(bench.line.counters.from_host, 8);
    close(client);
}

TEST(automatic_frames_come_at_their_own_pace)
{
    uint8_t bytes[20];
    const uint32_t begin_us = fathom_sim_pty_now_us();
    set_sending(FATHOM_SIM_A16_AUTO);
    const int client = open_client(link_path, B9600);
    assert_int_equal(pump(client, bytes, 12, PATIENCE_MS), 12);
    assert_true(fathom_elapsed_us(fathom_sim_pty_now_us(), begin_us) >= 290 * MS);
    for (size_t i = 0; i < 12; i += 4) assert_true(is_hex(bytes + i, "FF 07 A1 A7")); /* A16 2(4) */
    close(client);
}

TEST(clients_come_and_go)
{
    uint8_t byte;
    set_sending(FATHOM_SIM_A16_MODBUS);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(pump(-1, &byte, 1, 20), 0); /* no client is there: no error, no spinning */
        transaction_at(link_path);
    }
    /* one that leaves before its response */
    int client = open_client(link_path, B9600);
    assert_int_equal(write(client, ask_realtime, 8), 8);
    assert_int_equal(pump(client, &byte, 1, 20), 0);
    close(client);
    for (int i = 0; bench.line.counters.to_host != 4 * 7; i++) {
        assert_int_equal(pump(-1, &byte, 1, 10), 0);
        assert_true(i < PATIENCE_MS / 10);
    }
    assert_int_equal(bench.device->counters.answered, 4);
    client = open_client(link_path, B9600);
    tcflush(client, TCIFLUSH);
    transaction(client);
    close(client);
}

TEST(without_input_it_need_not_be_called)
{
    uint32_t due_us = 0;
    set_sending(FATHOM_SIM_A16_MODBUS);
    assert_int_equal(fathom_sim_pty_pump(&pty, &due_us), 0);
    assert_int_equal(due_us, UINT32_C(600000000));
    (void)tear_down(NULL);
    set_sending(FATHOM_SIM_A16_AUTO);
    assert_int_equal(fathom_sim_pty_pump(&pty, &due_us), 0);
    assert_in_range(due_us, 0, 100 * MS);
}

TEST(a_device_hears_its_own_rate_only)
{
    const uint8_t measure[] = {0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xCB}; /* HPS-167S table 17 */
    uint8_t bytes[16];
    set_up(&bench_19200);
    bench.fixed = FIXED(2083);
    add_hps((hps_config_t){0});
    int client = open_client(link_path, B9600);
    assert_int_equal(write(client, measure, 8), 8);
    for (int i = 0; bench.device->counters.wrong_settings < 8 && i < PATIENCE_MS / 10; i++)
        assert_int_equal(pump(client, bytes, 1, 10), 0);
    assert_int_equal(pump(client, bytes, 1, 20), 0); /* and nothing is answered */
    assert_int_equal(bench.device->counters.wrong_settings, 8);
    close(client);
    client = open_client(link_path, B19200);
    assert_int_equal(write(client, measure, 8), 8);
    assert_int_equal(pump(client, bytes, 13, PATIENCE_MS), 13);
    assert_true(is_hex(bytes, "01 03 08 08 23 DC B2 07 01 00 00 FD 41"));
    pty.ignore_baud = true;
    close(client);
    client = open_client(link_path, B115200);
    assert_int_equal(write(client, measure, 8), 8);
    assert_int_equal(pump(client, bytes, 13, PATIENCE_MS), 13);
    close(client);
}

TEST(unread_bytes_do_not_pile_up)
{
    static const fathom_line_settings_t fast = {115200, FATHOM_PARITY_NONE, 1};
    uint8_t bytes[4096];
    set_up(&fast);
    add_a16(FATHOM_SIM_A16_AUTO, (a16_config_t){.period_us = 2 * MS}); /* 2000 bytes a second */
    bench.device->settings = fast;
    while (bench.device->counters.automatic <= 150) /* more than 600 bytes */
        assert_int_equal(pump(-1, bytes, 1, 10), 0);
    const int client = open_client(link_path, B115200);
    ssize_t old = read(client, bytes, sizeof bytes);
    for (int i = 0; old <= 0 && i < PATIENCE_MS / 10; i++) { /* all was thrown away a moment ago */
        assert_int_equal(pump(-1, bytes, 1, 10), 0);
        old = read(client, bytes, sizeof bytes);
    }
    assert_in_range(old, 1, 510);
    assert_int_equal(pump(client, bytes, 8, PATIENCE_MS), 8);
    close(client);
}

static void expect_link_to(const char *path)
{
    char target[128] = {0};
    assert_true(readlink(link_path, target, sizeof target - 1) > 0);
    assert_string_equal(target, path);
}

static void put_link_to(const char *path)
{
    (void)unlink(link_path);
    assert_int_equal(symlink(path, link_path), 0);
}

static int open_again(void)
{
    const fathom_sim_pty_config_t config = {.link = link_path};
    return fathom_sim_pty_open(&pty, &bench.line, &config);
}

TEST(the_link_leads_to_the_terminal_and_replaces_one_that_was_left_behind)
{
    set_up(&bench_9600);
    expect_link_to(fathom_sim_pty_path(&pty));
    fathom_sim_pty_close(&pty);
    put_link_to("/dev/pts/99999999");
    assert_int_equal(open_again(), 0);
    expect_link_to(fathom_sim_pty_path(&pty));
    fathom_sim_pty_close(&pty);
    fathom_sim_pty_close(&pty); /* twice is no error */
}

/* The next one opened has the lowest number that is free: mostly that of the one which was killed. */
TEST(a_link_left_behind_may_lead_to_the_new_terminal)
{
    bool is_replaced = false;
    set_up(&bench_9600);
    for (int tries = 0; tries != 100 && !is_replaced; tries++) { /* another program may get it first */
        char old[FATHOM_SIM_PTY_PATH];
        strcpy(old, fathom_sim_pty_path(&pty));
        fathom_sim_pty_close(&pty);
        put_link_to(old);
        is_replaced = open_again() == 0;
    }
    assert_true(is_replaced);
    expect_link_to(fathom_sim_pty_path(&pty));
}

/* To what is there, or to what only the user knows, such as an adapter that is unplugged. */
TEST(a_link_of_the_users_is_neither_replaced_nor_removed)
{
    set_up(&bench_9600);
    const char *const targets[] = {fathom_sim_pty_path(&pty), "/tmp", "/dev/ttyUSB_none", "port", "nowhere"};
    for (size_t i = 0; i != 5; i++) {
        fathom_sim_pty_t second;
        fathom_sim_line_t line;
        fathom_sim_line_init(&line, &bench_9600, fathom_sim_pty_now_us());
        put_link_to(targets[i]);
        const fathom_sim_pty_config_t config = {.link = link_path};
        assert_int_equal(fathom_sim_pty_open(&second, &line, &config), -1);
        assert_int_equal(errno, EEXIST);
        expect_link_to(targets[i]);
    }
    fathom_sim_pty_close(&pty); /* it is not its any more */
    expect_link_to("nowhere");
    assert_int_equal(unlink(link_path), 0);
}

/* Nor is a place where none can be made an invention. */
TEST(a_file_in_the_place_of_the_link_is_left_alone)
{
    char file[] = "/tmp/fathom_sim_file_XXXXXX";
    char long_name[300];
    const int fd = mkstemp(file);
    assert_true(fd >= 0);
    memset(long_name, 'x', sizeof long_name);
    long_name[299] = '\0';
    const struct {
        const char *link;
        int error;
    } rows[] = {{file, EEXIST}, {"/nowhere/at/all", ENOENT}, {long_name, ENAMETOOLONG}};
    bench_begin(&bench_9600, true);
    for (size_t i = 0; i != 3; i++) {
        const fathom_sim_pty_config_t config = {.link = rows[i].link};
        assert_int_equal(fathom_sim_pty_open(&pty, &bench.line, &config), -1);
        assert_int_equal(errno, rows[i].error);
        assert_int_equal(fathom_sim_pty_fd(&pty), -1);
    }
    assert_int_equal(access(file, F_OK), 0);
    close(fd);
    assert_int_equal(unlink(file), 0);
}
