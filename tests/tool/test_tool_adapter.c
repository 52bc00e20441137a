/* SPDX-License-Identifier: MIT */
/* How the tool finds a USB adapter again: against a sysfs and a folder of device files that are made here, with links
 * and one-line files laid out as Linux does for usb-serial (ttyUSB0 below the interface) and cdc_acm (the interface
 * itself). */
#define _DEFAULT_SOURCE 1
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include "suite.h"

#include "ports/adapter.h"

enum { LONG = 512 };

static char root[64];
static char sysfs[80];
static char dev[80];
static adapter_t adapter;
static char
    own[16]; /* a serial number that no other test has, since the tool remembers those that were shared */

__attribute__((format(printf, 1, 2))) static void run(const char *format, ...)
{
    char command[4 * LONG];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(command, sizeof command, format, arguments);
    va_end(arguments);
    assert_int_equal(system(command), 0); /* NOLINT: the command is this file's */
}

static void remove_root(void) { run("rm -rf %s", root); }

/* The folder of the device files is the same in all tests, since it is watched from the first adapter on. */
static int set_up(void **state)
{
    static unsigned tests;
    memset(&adapter, 0, sizeof adapter);
    (void)snprintf(own, sizeof own, "A5%03uBI", ++tests);
    if (root[0] != '\0') return 0;
    strcpy(root, "/tmp/fathom-sysfs-XXXXXX");
    if (mkdtemp(root) == NULL || atexit(remove_root) != 0) return -1;
    (void)snprintf(sysfs, sizeof sysfs, "%s/sys", root);
    (void)snprintf(dev, sizeof dev, "%s/dev", root);
    run("mkdir -p %s/class/tty %s/devices %s", sysfs, sysfs, dev);
    adapter_sysfs = sysfs;
    adapter_dev = dev;
    return 0;
}

static int tear_down(void **state)
{
    run("rm -rf %s/devices/* %s/class/tty/* %s/*", sysfs, sysfs, dev);
    return 0;
}

static const suite_t suite = {.set_up = set_up, .tear_down = tear_down};

static void write_file(const char *folder, const char *name, const char *text)
{
    char path[2 * LONG];
    assert_true(snprintf(path, sizeof path, "%s/devices/%s/%s", sysfs, folder, name) < (int)sizeof path);
    FILE *const file = fopen(path, "w");
    assert_non_null(file);
    (void)fprintf(file, "%s\n", text);
    (void)fclose(file);
}

/* A tty whose `device` link leads to `below` in devices/. Its device file appears last. */
static void add_tty(const char *tty, const char *below)
{
    run("mkdir -p %s/devices/%s %s/class/tty/%s && ln -s %s/devices/%s %s/class/tty/%s/device && touch %s/%s",
        sysfs, below, sysfs, tty, sysfs, below, sysfs, tty, dev, tty);
}

/* A USB device in a socket of a bus, with one interface. serial NULL: it has none. */
static void add_device(const char *bus, const char *socket, const char *vendor, const char *product,
                       const char *serial)
{
    char folder[LONG];
    run("mkdir -p %s/devices/%s/%s/%s:1.0", sysfs, bus, socket, socket);
    (void)snprintf(folder, sizeof folder, "%s/%s", bus, socket);
    write_file(folder, "idVendor", vendor);
    write_file(folder, "idProduct", product);
    if (serial != NULL) write_file(folder, "serial", serial);
    (void)snprintf(folder, sizeof folder, "%s/%s/%s:1.0", bus, socket, socket);
    write_file(folder, "bInterfaceNumber", "00");
}

/* An adapter of usb-serial, a CP2102. */
static void plug_in(const char *bus, const char *tty, const char *socket, const char *serial)
{
    char below[LONG];
    add_device(bus, socket, "10c4", "ea60", serial);
    (void)snprintf(below, sizeof below, "%s/%s/%s:1.0/%s", bus, socket, socket, tty);
    add_tty(tty, below);
}

/* As the kernel does: the entries of sysfs go first. */
static void unplug(const char *tty, const char *socket)
{
    run("rm -rf %s/devices/usb1/%s %s/class/tty/%s && rm %s/%s", sysfs, socket, sysfs, tty, dev, tty);
}

/* The path that the user named, which stays valid. */
static const char *named(const char *tty)
{
    static char paths[8][LONG];
    size_t i = 0;
    while (paths[i][0] != '\0' && strcmp(strrchr(paths[i], '/') + 1, tty) != 0) i++;
    (void)snprintf(paths[i], sizeof paths[i], "%s/%s", dev, tty);
    return paths[i];
}

static void open_adapter(const char *path)
{
    assert_null(adapter_find(&adapter, path));
    assert_true(adapter_open(&adapter));
}

/* ---- conversations ---- */

static const char *advice_of(const char *word)
{
#define SAME_SOCKET ". Plug this adapter into the same USB socket (1-1.2)"
    static const char *const texts[][2] = {
        {"shared", "another adapter has, or may have had, the same serial number" SAME_SOCKET},
        {"counted", "other adapters may have the same serial number" SAME_SOCKET},
        {"no-serial", "this adapter has no serial number" SAME_SOCKET},
    };
    for (size_t i = 0; i != sizeof texts / sizeof texts[0]; i++)
        if (strcmp(texts[i][0], word) == 0) return texts[i][1];
    return NULL;
}

/* The user has named ttyUSB0. */
static void find(const char *word)
{
    const char *const reason = adapter_find(&adapter, named("ttyUSB0"));
    if (strncmp(word, "ttyUSB", 6) == 0) {
        assert_null(reason);
        assert_string_equal(adapter.path, named(word));
    } else if (strcmp(word, "nothing") == 0) {
        assert_string_equal(reason, "");
    } else {
        assert_string_equal(word, "doubt");
        assert_non_null(strstr(reason, "the right one is unknown"));
        assert_string_equal(adapter_doubt(&adapter), reason);
    }
}

/*
 * The steps of a conversation: "+ttyUSB0 2 SERIAL" and "-ttyUSB0 2" (an adapter appears in the socket 1-1.2 and goes),
 * "open", "taken" (another adapter took the path), "find TTY", "find nothing", "find doubt", and "advice KIND". A SERIAL
 * "own" is no other test's, and "none" is none.
 */
static void play(const char *steps)
{
    char copy[LONG];
    char *rest = NULL;
    (void)snprintf(copy, sizeof copy, "%s", steps);
    for (char *step = strtok_r(copy, ";", &rest); step != NULL; step = strtok_r(NULL, ";", &rest)) {
        char words[3][32] = {"", "", ""};
        char socket[40];
        (void)sscanf(step, "%31s %31s %31s", words[0], words[1], words[2]);
        (void)snprintf(socket, sizeof socket, "1-1.%s", words[1]);
        if (words[0][0] == '+')
            plug_in("usb1", words[0] + 1, socket,
                    strcmp(words[2], "own") == 0    ? own
                    : strcmp(words[2], "none") == 0 ? NULL
                                                    : words[2]);
        else if (words[0][0] == '-')
            unplug(words[0] + 1, socket);
        else if (strcmp(words[0], "open") == 0)
            open_adapter(named("ttyUSB0"));
        else if (strcmp(words[0], "taken") == 0)
            assert_false(adapter_open(&adapter));
        else if (strcmp(words[0], "find") == 0)
            find(words[1]);
        else if (advice_of(words[1]) == NULL)
            assert_null(adapter_advice(&adapter));
        else
            assert_string_equal(adapter_advice(&adapter), advice_of(words[1]));
    }
}

#define CONVERSATION(name, steps)                                                                            \
    TEST(name) { play(steps); }

CONVERSATION(
    an_adapter_with_its_own_serial_number_is_found_in_another_socket_under_another_name,
    "+ttyUSB0 2 own; open; -ttyUSB0 2; find nothing; +ttyUSB0 3 OTHER7; find nothing;" /* the old name */
    "+ttyUSB1 4 own; find ttyUSB1; advice none")

CONVERSATION(
    a_second_loss_finds_it_in_the_third_socket,
    "+ttyUSB0 2 own; open; -ttyUSB0 2; +ttyUSB1 4 own; open; -ttyUSB1 4; +ttyUSB2 1 own; find ttyUSB2")

CONVERSATION(an_adapter_without_a_serial_number_is_found_in_its_socket_only,
             "+ttyUSB0 2 none; open; -ttyUSB0 2; advice no-serial; advice none;" /* once */
             "+ttyUSB0 3 none; find nothing; +ttyUSB5 2 none; find ttyUSB5")

CONVERSATION(a_serial_number_that_is_programmed_for_a_site_is_its_own,
             "+ttyUSB0 2 0002; open; -ttyUSB0 2; +ttyUSB1 3 0002; find ttyUSB1")

CONVERSATION(a_twin_that_is_there_first_is_not_opened_instead,
             "+ttyUSB1 3 own; +ttyUSB0 2 own; open; -ttyUSB0 2; advice shared; find nothing; +ttyUSB0 2 own;"
             "find ttyUSB0")

CONVERSATION(a_twin_that_comes_later_is_not_opened_instead,
             "+ttyUSB0 2 own; open; +ttyUSB1 3 own; find ttyUSB0; -ttyUSB0 2; advice shared; find nothing")

CONVERSATION(a_twin_that_was_plugged_in_for_a_moment_is_not_opened_instead,
             "+ttyUSB0 2 own; open; +ttyUSB1 3 own; -ttyUSB1 3; -ttyUSB0 2; find nothing; advice shared;"
             "+ttyUSB1 3 own; find nothing")

CONVERSATION(another_adapter_that_stays_is_no_twin,
             "+ttyUSB0 2 own; open; +ttyUSB1 3 OTHER7; -ttyUSB0 2; +ttyUSB2 4 own; find ttyUSB2")

CONVERSATION(a_twin_that_comes_while_it_is_unplugged_is_not_opened_if_both_are_there,
             "+ttyUSB0 2 own; open; -ttyUSB0 2; +ttyUSB0 3 own; +ttyUSB1 2 own; find ttyUSB1; -ttyUSB1 2;"
             "find nothing; advice shared") /* the twin alone */

CONVERSATION(its_own_return_in_another_socket_is_no_twin,
             "+ttyUSB0 2 own; open; -ttyUSB0 2; +ttyUSB1 3 own; find ttyUSB1")

CONVERSATION(after_a_move_a_twin_makes_both_doubtful,
             "+ttyUSB0 2 own; open; -ttyUSB0 2; +ttyUSB1 3 own; open; +ttyUSB0 2 own; find doubt")

CONVERSATION(
    swapped_names_are_not_mixed_up,
    "+ttyUSB1 3 0001; +ttyUSB0 2 0001; open; -ttyUSB0 2; -ttyUSB1 3; +ttyUSB0 3 0001; +ttyUSB1 2 0001;"
    "find ttyUSB1; open")

CONVERSATION(names_that_swap_between_finding_and_opening_are_noticed,
             "+ttyUSB0 2 0001; find ttyUSB0; -ttyUSB0 2; +ttyUSB0 3 0001; taken")

/* The makers of chips and of clones use such numbers for whole series. */
TEST(an_adapter_with_a_counted_serial_number_is_found_in_its_socket_only)
{
    static const char *const serials[] = {"00000000", "12345678", "0123456789ABCDEF", "1"};
    for (size_t i = 0; i != sizeof serials / sizeof serials[0]; i++) {
        char steps[LONG];
        (void)snprintf(
            steps, sizeof steps,
            "+ttyUSB0 2 %s; open; -ttyUSB0 2; advice counted; +ttyUSB0 3 %s; find nothing; -ttyUSB0 3;"
            "+ttyUSB0 2 %s; find ttyUSB0; -ttyUSB0 2",
            serials[i], serials[i], serials[i]);
        play(steps);
        memset(&adapter, 0, sizeof adapter);
    }
}

/* ---- others ---- */

TEST(another_vendor_or_product_with_the_serial_number_is_another_adapter)
{
    static const char *const others[][2] = {{"0403", "ea60"}, {"10c4", "6010"}};
    play("+ttyUSB0 2 own; open; -ttyUSB0 2");
    for (size_t i = 0; i != 2; i++) {
        add_device("usb1", "1-1.2", others[i][0], others[i][1], own);
        add_tty("ttyUSB0", "usb1/1-1.2/1-1.2:1.0/ttyUSB0");
        play("find nothing; -ttyUSB0 2");
    }
}

TEST(a_bus_that_is_numbered_anew_does_not_change_the_socket)
{
    plug_in("controller/usb1", "ttyUSB0", "1-1.2", "0001");
    open_adapter(named("ttyUSB0"));
    run("rm -rf %s/devices/controller %s/class/tty/ttyUSB0 && rm %s/ttyUSB0", sysfs, sysfs, dev);
    plug_in("other/usb1", "ttyUSB0", "1-1.2", "0001");
    find("nothing");
    plug_in("controller/usb3", "ttyUSB1", "3-1.2", "0001");
    find("ttyUSB1");
}

/* ---- several ports, other kinds, links ---- */

TEST(the_ports_of_one_adapter_are_neither_twins_nor_mixed_up)
{
    plug_in("usb1", "ttyUSB0", "1-1.2", own);
    add_tty("ttyUSB1", "usb1/1-1.2/1-1.2:1.1/ttyUSB1");
    write_file("usb1/1-1.2/1-1.2:1.1", "bInterfaceNumber", "01");
    open_adapter(named("ttyUSB1"));
    run("rm -rf %s/devices/usb1/1-1.2 %s/class/tty/ttyUSB* && rm %s/tty*", sysfs, sysfs, dev);
    plug_in("usb1", "ttyUSB1", "1-1.3", own); /* the other interface has the old name */
    assert_string_equal(adapter_find(&adapter, named("ttyUSB1")), "");
    add_tty("ttyUSB0", "usb1/1-1.3/1-1.3:1.1/ttyUSB0");
    write_file("usb1/1-1.3/1-1.3:1.1", "bInterfaceNumber", "01");
    assert_null(adapter_find(&adapter, named("ttyUSB1")));
    assert_string_equal(adapter.path, named("ttyUSB0"));
    assert_null(adapter_advice(&adapter));
}

TEST(an_adapter_of_the_cdc_class_is_found_through_a_link)
{
    add_device("usb1", "1-3.4", "1a86", "55d3", "5424007231");
    add_tty("ttyACM0", "usb1/1-3.4/1-3.4:1.0");
    run("ln -s %s/ttyACM0 %s/tank", dev, dev);
    open_adapter(named("tank"));
    assert_string_equal(adapter.path, named("ttyACM0"));
}

TEST(a_tty_that_is_no_usb_adapter_is_found_by_its_path)
{
    add_tty("ttyS0", "platform/serial8250");
    open_adapter(named("ttyS0"));
    assert_string_equal(adapter.path, "");
    assert_null(adapter_find(&adapter, named("ttyS0")));
    assert_null(adapter_advice(&adapter));
}

TEST(an_adapter_about_which_nothing_is_known_is_found_by_its_path_and_that_is_reported)
{
    run("touch %s/ttyUSB0", dev);
    assert_null(adapter_find(&adapter, named("ttyUSB0")));
    assert_null(adapter_advice(&adapter)); /* it was not open yet */
    open_adapter(named("ttyUSB0"));
    assert_null(adapter_find(&adapter, named("ttyUSB0")));
    assert_string_equal(adapter.path, "");
    assert_string_equal(adapter_advice(&adapter),
                        "nothing is known about this adapter, so any adapter at this path will be read");
}

TEST(a_link_by_id_finds_neither_of_two_twins_and_an_open_adapter_keeps_its_socket)
{
    char link[LONG];
    play("+ttyUSB0 2 own");
    run("mkdir -p %s/serial/by-id && ln -s ../../ttyUSB0 %s/serial/by-id/usb-0002", dev, dev);
    (void)snprintf(link, sizeof link, "%s/serial/by-id/usb-0002", dev);
    open_adapter(link);
    assert_string_equal(adapter.path, named("ttyUSB0"));
    play("+ttyUSB1 3 own");
    run("ln -sf ../../ttyUSB1 %s/serial/by-id/usb-0002", dev);
    adapter_t other = {.path = ""};
    assert_non_null(strstr(adapter_find(&other, link), "several adapters have this identity"));
    assert_null(adapter_find(&other, named("ttyUSB0"))); /* the other names are clear */
    play("-ttyUSB0 2");
    assert_string_equal(adapter_find(&adapter, link), "");
    play("+ttyUSB5 2 own");
    assert_null(adapter_find(&adapter, link));
    assert_string_equal(adapter.path, named("ttyUSB5"));
}

/* FTDI's, which `setserial PORT low_latency` reduces to 1. */
TEST(the_latency_is_reported_if_it_is_known)
{
    plug_in("usb1", "ttyUSB0", "1-1.2", own);
    assert_int_equal(adapter_latency_ms(named("ttyUSB0")), 0);
    write_file("usb1/1-1.2/1-1.2:1.0/ttyUSB0", "latency_timer", "16");
    assert_int_equal(adapter_latency_ms(named("ttyUSB0")), 16);
    assert_int_equal(adapter_latency_ms("/no/such/port"), 0);
}
