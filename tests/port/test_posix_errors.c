/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* mkstemp, chown */
#include <errno.h>
#include <grp.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include "posix_rig.h"

#include "../../port/posix/internal/describe.h"

/* What fathom_posix_open says when it fails. */

static const suite_t suite = {.begin_round = posix_start_watchdog};
static const suite_t fresh = {.set_up = port_rig_set_up, .tear_down = port_rig_tear_down};

static void check_failure(const char *path, fathom_posix_status_t error, const char *text)
{
    fathom_posix_uart_t port;
    const unsigned before = posix_count_fds();
    memset(&port, 0xA5, sizeof port);
    assert_int_equal(fathom_posix_open(&port, path, &usual), error);
    assert_int_equal(fathom_posix_error(&port), error);
    assert_int_equal(posix_count_fds(), before);
    assert_int_equal(fathom_posix_fd(&port), -1);
    assert_int_equal(strncmp(fathom_posix_error_text(&port), path, 63 < strlen(path) ? 63 : strlen(path)), 0);
    if (strstr(fathom_posix_error_text(&port), text) == NULL)
        fail_msg("\"%s\" does not say \"%s\"", fathom_posix_error_text(&port), text);
    fathom_posix_close(&port);
    assert_int_equal(posix_count_fds(), before);
}

TEST(a_missing_path_is_told_as_such)
{
    check_failure("/dev/ttyNONE7", FATHOM_POSIX_ERR_NOT_FOUND, "no such device");
    check_failure("/dev/null/ttyUSB0", FATHOM_POSIX_ERR_NOT_FOUND, "no such device");
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
TEST_IN(fresh, a_denied_permission_names_the_group_and_how_to_join_it)
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

TEST_IN(fresh, what_is_denied_is_described_by_its_group_and_mode)
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
