/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* CRTSCTS, rates above 38400, mkstemp, chown */
#include <errno.h>
#include <fcntl.h>
#include <grp.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include "posix_rig.h"

#include "../../port/posix/internal/describe.h"

/* Opening and settings, over real pseudo terminals; and what fathom_posix_open says when it fails. */

static const suite_t suite = PORT_RIG_SUITE(port_rig_set_up);

static void check_seen(speed_t speed, uint8_t parity, uint8_t stop_bits)
{
    struct termios seen;
    assert_int_equal(tcgetattr(rig.pty.master, &seen), 0); /* a pseudo terminal's ends share them */
    assert_int_equal(cfgetospeed(&seen), speed);
    assert_int_equal(cfgetispeed(&seen), speed);
    assert_int_equal((seen.c_cflag & PARODD) != 0, parity == FATHOM_PARITY_ODD);
    assert_int_equal((seen.c_cflag & CSTOPB) != 0, stop_bits == 2);
    assert_int_equal(seen.c_cflag & CSIZE, CS8);
    assert_int_equal(seen.c_cflag & CRTSCTS, 0);
    assert_int_equal(seen.c_cflag & (CLOCAL | CREAD), CLOCAL | CREAD);
    assert_int_equal(seen.c_iflag, 0);
    assert_int_equal(seen.c_oflag, 0);
    assert_int_equal(seen.c_lflag, 0);
}

static const struct {
    uint32_t baud;
    speed_t speed;
} rates[] = {{1200, B1200},     {2400, B2400},     {4800, B4800},     {9600, B9600},     {19200, B19200},
             {38400, B38400},   {57600, B57600},   {115200, B115200}, {230400, B230400}, {460800, B460800},
             {500000, B500000}, {576000, B576000}, {921600, B921600}};
enum { RATES = sizeof rates / sizeof rates[0] };

TEST(every_rate_is_what_the_other_end_sees)
{
    for (size_t i = 0; i != RATES; i++) { /* opened with it */
        const fathom_line_settings_t settings = {rates[i].baud, FATHOM_PARITY_NONE, 1};
        assert_int_equal(open_with(&settings), FATHOM_POSIX_OK);
        check_seen(rates[i].speed, FATHOM_PARITY_NONE, 1);
        fathom_posix_close(&rig.port);
    }
    assert_int_equal(open_with(&usual), FATHOM_POSIX_OK);
    for (size_t i = 0; i != RATES; i++) { /* changed to it */
        const fathom_line_settings_t settings = {rates[i].baud, FATHOM_PARITY_NONE, 1};
        assert_int_equal(fathom_posix_set_line(&rig.port, &settings), FATHOM_POSIX_OK);
        check_seen(rates[i].speed, FATHOM_PARITY_NONE, 1);
    }
}

TEST(every_parity_and_stop_bit_is_accepted_in_every_order)
{
    for (unsigned pair = 0; pair != 36; pair++) {
        const unsigned both[2] = {pair / 6, pair % 6};
        for (unsigned i = 0; i != 2; i++) {
            const fathom_line_settings_t settings = {19200, (uint8_t)(both[i] % 3),
                                                     (uint8_t)(1 + both[i] / 3)};
            const fathom_posix_status_t status =
                i == 0 ? open_with(&settings) : fathom_posix_set_line(&rig.port, &settings);
            assert_string_equal(fathom_posix_error_text(&rig.port), "");
            assert_int_equal(status, FATHOM_POSIX_OK);
            check_seen(B19200, settings.parity, settings.stop_bits);
        }
        fathom_posix_close(&rig.port);
    }
}

TEST(what_came_before_it_was_opened_is_thrown_away)
{
    const int slave = open(rig.pty.path, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    struct termios raw;
    assert_true(slave >= 0);
    assert_int_equal(tcgetattr(slave, &raw), 0);
    cfmakeraw(&raw);
    assert_int_equal(tcsetattr(slave, TCSANOW, &raw), 0);
    posix_pty_send(&rig.pty, (const uint8_t *)"old", 3);
    assert_true(posix_wait_for(slave, POLLIN));

    assert_int_equal(open_with(&usual), FATHOM_POSIX_OK);
    assert_int_equal(port_rig_read_one(), 0);
    fathom_posix_close(&rig.port);
    assert_int_equal(close(slave), 0);
}

TEST(the_descriptor_does_not_block_and_is_not_inherited)
{
    assert_int_equal(open_with(&usual), FATHOM_POSIX_OK);
    assert_true((fcntl(fathom_posix_fd(&rig.port), F_GETFL) & O_NONBLOCK) != 0);
    assert_true((fcntl(fathom_posix_fd(&rig.port), F_GETFD) & FD_CLOEXEC) != 0);
}

/* 0: opened, and there is no controlling terminal after it. */
static int open_in_a_new_session(void *path)
{
    fathom_posix_uart_t port;
    if (setsid() < 0) return 1;
    if (fathom_posix_open(&port, path, &usual) != FATHOM_POSIX_OK) return 2;
    return open("/dev/tty", O_RDWR | O_CLOEXEC) < 0 ? 0 : 3;
}

TEST(it_does_not_become_the_controlling_terminal)
{
    assert_int_equal(chmod(rig.pty.path, 0666), 0);
    assert_int_equal(posix_run_unprivileged(open_in_a_new_session, rig.pty.path), 0);
}

/* The exit status of a child that opens it: the error, positive. */
static int open_it(void *path)
{
    fathom_posix_uart_t port;
    return -(int)fathom_posix_open(&port, path, &usual);
}

TEST(a_second_open_is_refused_even_to_root_and_allowed_after_close)
{
    fathom_posix_uart_t first, second;
    assert_int_equal(chmod(rig.pty.path, 0666), 0);
    assert_int_equal(fathom_posix_open(&first, rig.pty.path, &usual), FATHOM_POSIX_OK);
    assert_int_equal(fathom_posix_open(&second, rig.pty.path, &usual), FATHOM_POSIX_ERR_IN_USE);
    assert_int_equal(fathom_posix_error(&second), FATHOM_POSIX_ERR_IN_USE);
    assert_non_null(strstr(fathom_posix_error_text(&second), rig.pty.path));
    assert_non_null(strstr(fathom_posix_error_text(&second), "in use by another program"));
    assert_int_equal(posix_run_unprivileged(open_it, rig.pty.path), -FATHOM_POSIX_ERR_IN_USE);
    check_seen(B9600, FATHOM_PARITY_NONE, 1); /* the first one's settings stand */
    fathom_posix_close(&second);
    assert_int_equal(fathom_posix_open(&second, rig.pty.path, &usual), FATHOM_POSIX_ERR_IN_USE);
    fathom_posix_close(&first);
    assert_int_equal(fathom_posix_open(&second, rig.pty.path, &usual), FATHOM_POSIX_OK);
    fathom_posix_close(&second);
    assert_int_equal(posix_run_unprivileged(open_it, rig.pty.path), 0);
}

TEST(a_program_that_was_killed_does_not_keep_the_port)
{
    int pipe_ends[2];
    char byte = 0;
    assert_int_equal(chmod(rig.pty.path, 0666), 0);
    assert_int_equal(pipe(pipe_ends), 0);
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        fathom_posix_uart_t port;
        (void)alarm(60);
        byte = fathom_posix_open(&port, rig.pty.path, &usual) == FATHOM_POSIX_OK ? 'y' : 'n';
        if (write(pipe_ends[1], &byte, 1) != 1) _exit(1);
        for (;;) (void)pause();
    }
    assert_int_equal(read(pipe_ends[0], &byte, 1), 1);
    assert_int_equal(byte, 'y');
    assert_int_equal(posix_run_unprivileged(open_it, rig.pty.path), -FATHOM_POSIX_ERR_IN_USE);
    assert_int_equal(kill(child, SIGKILL), 0);
    assert_int_equal(waitpid(child, NULL, 0), child);
    assert_int_equal(posix_run_unprivileged(open_it, rig.pty.path), 0);
    (void)close(pipe_ends[0]);
    (void)close(pipe_ends[1]);
}

TEST(arguments_outside_the_contract_are_refused)
{
    fathom_posix_line_errors_t errors;
    const unsigned before = posix_count_fds();
    const struct {
        fathom_line_settings_t settings;
        const char *text;
    } wrong[] = {{{0, 0, 1}, "0 baud is not a standard rate"},
                 {{12345, 0, 1}, "12345 baud is not a standard rate"},
                 {{9600, 3, 1}, "parity 3"},
                 {{9600, 0, 0}, "0 stop bits"},
                 {{9600, 0, 3}, "3 stop bits"}};
    assert_int_equal(fathom_posix_open(NULL, rig.pty.path, &usual), FATHOM_POSIX_ERR_ARGUMENT);
    assert_int_equal(fathom_posix_open(&rig.port, NULL, &usual), FATHOM_POSIX_ERR_ARGUMENT);
    assert_string_equal(fathom_posix_error_text(&rig.port), "serial port: no path or no settings were given");
    assert_int_equal(open_with(NULL), FATHOM_POSIX_ERR_ARGUMENT);
    for (size_t i = 0; i != sizeof wrong / sizeof wrong[0]; i++) {
        assert_int_equal(open_with(&wrong[i].settings), FATHOM_POSIX_ERR_ARGUMENT);
        assert_non_null(strstr(fathom_posix_error_text(&rig.port), wrong[i].text));
        assert_int_equal(posix_count_fds(), before);
    }
    assert_int_equal(open_with(&usual), FATHOM_POSIX_OK);
    for (size_t i = 0; i != sizeof wrong / sizeof wrong[0]; i++)
        assert_int_equal(fathom_posix_set_line(&rig.port, &wrong[i].settings), FATHOM_POSIX_ERR_ARGUMENT);
    assert_int_equal(fathom_posix_set_line(&rig.port, NULL), FATHOM_POSIX_ERR_ARGUMENT);
    assert_int_equal(fathom_posix_set_line(NULL, &usual), FATHOM_POSIX_ERR_ARGUMENT);
    assert_int_equal(fathom_posix_line_errors(NULL, &errors), FATHOM_POSIX_ERR_ARGUMENT);
    assert_int_equal(fathom_posix_line_errors(&rig.port, NULL), FATHOM_POSIX_ERR_ARGUMENT);
    check_seen(B9600, FATHOM_PARITY_NONE, 1);
    fathom_posix_close(&rig.port);
    fathom_posix_close(NULL);
}

/* ---- failures ---- */

static void check_failure(const char *path, fathom_posix_status_t error, const char *text)
{
    const unsigned before = posix_count_fds();
    memset(&rig.port, 0xA5, sizeof rig.port);
    assert_int_equal(fathom_posix_open(&rig.port, path, &usual), error);
    assert_int_equal(fathom_posix_error(&rig.port), error);
    assert_int_equal(posix_count_fds(), before);
    assert_int_equal(fathom_posix_fd(&rig.port), -1);
    assert_memory_equal(fathom_posix_error_text(&rig.port), path, 63 < strlen(path) ? 63 : strlen(path));
    port_rig_says(text);
    fathom_posix_close(&rig.port);
    assert_int_equal(posix_count_fds(), before);
}

TEST(a_missing_path_is_told_as_such)
{
    check_failure("/dev/ttyNONE7", FATHOM_POSIX_ERR_NOT_FOUND, "no such device");
    check_failure("/dev/null/ttyUSB0", FATHOM_POSIX_ERR_NOT_FOUND, "no such device");
    check_failure("./ttyNONE7", FATHOM_POSIX_ERR_NOT_FOUND, "no such device");
    check_failure("", FATHOM_POSIX_ERR_NOT_FOUND, "no such device");
    check_failure("/dev/a-path-that-is-longer-than-what-the-port-keeps-of-it-for-its-messages/ttyUSB0",
                  FATHOM_POSIX_ERR_NOT_FOUND, ": no such device");
}

TEST(what_is_not_a_tty_is_told_as_such)
{
    char file[] = "/tmp/fathom-test-XXXXXX";
    const int fd = mkstemp(file);
    assert_true(fd >= 0);
    assert_int_equal(close(fd), 0);
    check_failure(file, FATHOM_POSIX_ERR_NOT_A_TTY, "not a serial port");
    assert_int_equal(unlink(file), 0);
    check_failure("/dev/null", FATHOM_POSIX_ERR_NOT_A_TTY, "not a serial port");
    check_failure("/tmp", FATHOM_POSIX_ERR_NOT_A_TTY, "not a serial port");
}

typedef struct {
    const char *path;
    const char *texts[3];
} denied_t;

static int open_is_denied(void *arg)
{
    const denied_t *const denied = arg;
    fathom_posix_uart_t port;
    if (fathom_posix_open(&port, denied->path, &usual) != FATHOM_POSIX_ERR_PERMISSION) return 1;
    for (int i = 0; i != 3; i++) {
        if (strstr(fathom_posix_error_text(&port), denied->texts[i]) == NULL) {
            (void)fprintf(stderr, "\"%s\" does not say \"%s\"\n", fathom_posix_error_text(&port),
                          denied->texts[i]);
            return 2;
        }
    }
    return 0;
}

/* Of a group that is not root's, which a pseudo terminal of root may have. */
static gid_t deny(mode_t mode)
{
    struct stat status;
    if (geteuid() == 0) assert_int_equal(chown(rig.pty.path, 65534, getgrnam("tty")->gr_gid), 0);
    assert_int_equal(chmod(rig.pty.path, mode), 0);
    assert_int_equal(stat(rig.pty.path, &status), 0);
    return status.st_gid;
}

/* A real EACCES: the owner may do nothing, which stops him even where his group may, and the port is opened
 * by a child that is not root. */
TEST(a_denied_permission_names_the_group_and_how_to_join_it)
{
    char belongs[64], command[64];
    const gid_t gid = deny(0060);
    assert_true(gid != 0);
    const struct group *const group = getgrgid(gid);
    assert_non_null(group);
    (void)snprintf(belongs, sizeof belongs, "permission denied: it belongs to the group %s;", group->gr_name);
    (void)snprintf(command, sizeof command, "sudo usermod -aG %s $USER", group->gr_name);
    denied_t denied = {rig.pty.path, {belongs, command, "log in again"}};
    assert_int_equal(posix_run_unprivileged(open_is_denied, &denied), 0);
}

/* The group file forgets the name; the linker puts this in its place. */
static bool groups_have_no_names;
static int groups_error;
int __real_getgrgid_r(gid_t gid, struct group *entry, char *memory, size_t size, struct group **result);
int __wrap_getgrgid_r(gid_t gid, struct group *entry, char *memory, size_t size, struct group **result);
int __wrap_getgrgid_r(gid_t gid, struct group *entry, char *memory, size_t size, struct group **result)
{
    *result = NULL;
    if (groups_error != 0) return groups_error;
    return groups_have_no_names ? 0 : __real_getgrgid_r(gid, entry, memory, size, result);
}

/* The same in this process: what is looked at is the file, which need not be denied. */
static void denied_says(const char *path, const char *text)
{
    char got[200];
    assert_ptr_equal(fathom_posix_describe_denied(path, "dialout", got, sizeof got), got);
    if (strstr(got, text) == NULL) fail_msg("\"%s\" does not say \"%s\"", got, text);
}

TEST(what_is_denied_is_described_by_its_group_and_mode)
{
    char belongs[64];
    const gid_t gid = deny(0660);
    (void)snprintf(belongs, sizeof belongs, "the group %s; join it", getgrgid(gid)->gr_name);
    denied_says(rig.pty.path, belongs);
    assert_int_equal(chmod(rig.pty.path, 0620), 0);
    denied_says(rig.pty.path, "with mode 0620, so joining a group does not help");
    denied_says(rig.pty.path, "GROUP=\"dialout\"");
    assert_int_equal(chmod(rig.pty.path, 0020), 0); /* may write, may not read */
    denied_says(rig.pty.path, "with mode 0020, so joining a group does not help");
    denied_says("/nowhere/tty", "a folder on its way is closed to you");
    assert_int_equal(chmod(rig.pty.path, 0660), 0);
    (void)snprintf(belongs, sizeof belongs, "the group %lu; join it", (unsigned long)gid);
    groups_error = EIO; /* the group file cannot be read */
    denied_says(rig.pty.path, belongs);
    groups_error = 0;
    groups_have_no_names = true;
    denied_says(rig.pty.path, belongs);
    (void)snprintf(belongs, sizeof belongs, "sudo usermod -aG %lu $USER", (unsigned long)gid);
    denied_says(rig.pty.path, belongs);
    groups_have_no_names = false;
    if (geteuid() != 0) return;
    assert_int_equal(chown(rig.pty.path, 0, 0), 0);
    denied_says(rig.pty.path, "the group root with mode 0660");
}

TEST(an_error_that_the_system_does_not_know_is_its_number)
{
    char text[80];
    assert_string_equal(fathom_posix_words(ENOENT, text, sizeof text), "No such file or directory");
    assert_string_equal(fathom_posix_words(123456, text, sizeof text), "error 123456");
}

TEST(a_closed_folder_on_the_way_is_told_as_such)
{
    char folder[] = "/tmp/fathom-test-XXXXXX";
    char path[64];
    assert_non_null(mkdtemp(folder));
    assert_int_equal(chmod(folder, 0), 0);
    (void)snprintf(path, sizeof path, "%s/tty", folder);
    denied_t denied = {path, {"permission denied", "a folder on its way", path}};
    assert_int_equal(posix_run_unprivileged(open_is_denied, &denied), 0);
    assert_int_equal(rmdir(folder), 0);
}
