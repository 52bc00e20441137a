/* SPDX-License-Identifier: MIT */
/*
 * second_pty KIND SEED: a second device (second.h) on a pseudo terminal, in real time, which has had power for 12 s.
 * The first line of the output is the terminal's path. At SIGTERM it prints what the device did, a line each, and ends:
 *     sent VALUE               measured, or what stood in the place of a measurement
 *     set REGISTER VALUE       a setting that was taken
 *     state ADDRESS BAUD
 * Parity does not come through a pseudo terminal: it is always the device's.
 */
#define _GNU_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): posix_openpt */
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#include "second_device.h"

enum { POWERED_US = 12000000, LONGEST_MS = 20 };

static second_device_t device;
static int master = -1, slave = -1;
static volatile sig_atomic_t is_over;

static void on_signal(int number)
{
    (void)number;
    is_over = 1;
}

static const struct {
    const char *name;
    second_kind_t kind;
} kinds[] = {{"a16", SECOND_A16_RS485},     {"a16-rs232", SECOND_A16_RS232}, {"a05", SECOND_A05_RS485},
             {"a05-uart", SECOND_A05_UART}, {"hps167s", SECOND_HPS167S},     {"hps167", SECOND_HPS167}};

static uint64_t now_us(void)
{
    static uint64_t began_us;
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    uint64_t us = (uint64_t)now.tv_sec * 1000000 + (uint64_t)now.tv_nsec / 1000;
    if (began_us == 0) began_us = us;
    return POWERED_US + us - began_us;
}

static bool open_terminal(void)
{
    struct termios raw;
    master = posix_openpt(O_RDWR | O_NOCTTY);
    if (master < 0 || grantpt(master) < 0 || unlockpt(master) < 0) return false;
    slave = open(ptsname(master), O_RDWR | O_NOCTTY); /* open all the time: nothing that is sent hangs up */
    if (slave < 0 || tcgetattr(slave, &raw) < 0) return false;
    raw.c_iflag = raw.c_oflag = raw.c_lflag = 0;
    raw.c_cflag = CS8 | CREAD | CLOCAL;
    if (tcsetattr(slave, TCSANOW, &raw) < 0) return false;
    return fcntl(master, F_SETFL, O_NONBLOCK) == 0;
}

/* The device's settings, at the rate that the client has set. */
static second_line_t clients_line(void)
{
    static const struct {
        speed_t speed;
        uint32_t baud;
    } rates[] = {{B9600, 9600}, {B19200, 19200}, {B57600, 57600}, {B115200, 115200}, {B230400, 230400}};
    second_line_t line = second_state(&device).line;
    struct termios seen;
    if (tcgetattr(slave, &seen) < 0) return line;
    for (size_t i = 0; i < sizeof rates / sizeof rates[0]; i++) {
        if (rates[i].speed == cfgetospeed(&seen)) line.baud = rates[i].baud;
    }
    return line;
}

static void send(void *context, const second_byte_t *byte)
{
    (void)context;
    if (byte->line.baud == clients_line().baud && write(master, &byte->value, 1) != 1)
        (void)tcflush(slave, TCIFLUSH);
}

static void receive(void)
{
    uint8_t bytes[64];
    const ssize_t count = read(master, bytes, sizeof bytes);
    second_line_t line = clients_line();
    uint64_t begin_us = now_us(), bits = 9U + (line.parity != 'N' ? 1U : 0U) + line.stop_bits;
    second_run(&device, begin_us, send, NULL);
    for (ssize_t i = 0; i < count; i++) {
        uint64_t before = (uint64_t)i * bits * 1000000 / line.baud,
                 after = (uint64_t)(i + 1) * bits * 1000000 / line.baud;
        second_host_byte(&device, bytes[i], begin_us + before, begin_us + after, line);
    }
}

static void tell(void)
{
    second_state_t state = second_state(&device);
    uint64_t count = second_log_count(&device);
    for (uint64_t i = count > SECOND_LOG_EVENTS ? count - SECOND_LOG_EVENTS : 0; i < count; i++) {
        const second_event_t *event = second_log_at(&device, i);
        for (size_t p = 0; event->kind == SECOND_EVENT_MEASUREMENT && p < SECOND_PROBES; p++) {
            if ((event->probes >> p & 1U) != 0) (void)printf("sent %u\n", event->sent[p]);
        }
        if (event->kind == SECOND_EVENT_SETTING)
            (void)printf("set %u %lld\n", event->reg, (long long)event->new_value);
    }
    (void)printf("state %u %u\n", state.address, (unsigned)state.line.baud);
}

int main(int argc, char **argv)
{
    second_config_t config = {.kind = SECOND_KINDS, .scene = {{1234, 2000, 1953, 3562}}};
    for (size_t i = 0; argc == 3 && i < sizeof kinds / sizeof kinds[0]; i++) {
        if (strcmp(argv[1], kinds[i].name) == 0) config.kind = kinds[i].kind;
    }
    if (config.kind == SECOND_KINDS) return 2;
    config.seed = strtoull(argv[2], NULL, 10);
    if (!second_init(&device, &config) || !open_terminal()) return 1;
    (void)signal(SIGTERM, on_signal);
    second_power(&device, true, 0);
    second_run(&device, POWERED_US, NULL, NULL);
    (void)printf("%s\n", ptsname(master));
    (void)fflush(stdout);
    while (!is_over) {
        struct pollfd asked = {master, POLLIN, 0};
        uint64_t next_us = second_next_us(&device), now = now_us();
        uint64_t wait_ms = next_us > now ? (next_us - now) / 1000 : 0;
        (void)poll(&asked, 1, wait_ms > LONGEST_MS ? LONGEST_MS : (int)wait_ms);
        if ((asked.revents & POLLIN) != 0) receive();
        second_run(&device, now_us(), send, NULL);
    }
    tell();
    return 0;
}
