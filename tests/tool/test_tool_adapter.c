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
    memset(&adapter, 0, sizeof adapter);
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
    adapter_close(&adapter);
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
static void plug_in_to(const char *bus, const char *tty, const char *socket, const char *serial)
{
    char below[LONG];
    add_device(bus, socket, "10c4", "ea60", serial);
    (void)snprintf(below, sizeof below, "%s/%s/%s:1.0/%s", bus, socket, socket, tty);
    add_tty(tty, below);
}

static void plug_in(const char *tty, const char *socket, const char *serial)
{
    plug_in_to("usb1", tty, socket, serial);
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

/* ttyUSB0 is open in socket 1-1.2. */
static void open_first(const char *serial)
{
    plug_in("ttyUSB0", "1-1.2", serial);
    open_adapter(named("ttyUSB0"));
}

static void lose_first(void)
{
    unplug("ttyUSB0", "1-1.2");
    adapter_close(&adapter);
}

/* The adapter is found under that name. NULL: it is not plugged in. */
static void expect_found(const char *tty)
{
    const char *const reason = adapter_find(&adapter, named("ttyUSB0"));
    if (tty == NULL) {
        assert_string_equal(reason, "");
        return;
    }
    assert_null(reason);
    assert_string_equal(adapter.path, named(tty));
}

static void expect_advice(const char *advice)
{
    const char *const text = adapter_advice(&adapter);
    if (advice == NULL)
        assert_null(text);
    else
        assert_non_null(text);
    if (advice != NULL) assert_string_equal(text, advice);
}

#define SAME_SOCKET ". Plug this adapter into the same USB socket (1-1.2)"
#define SHARED      "another adapter has, or may have had, the same serial number" SAME_SOCKET
#define COUNTED     "other adapters may have the same serial number" SAME_SOCKET
#define NO_SERIAL   "this adapter has no serial number" SAME_SOCKET

/* ---- alone ---- */

TEST(an_adapter_with_its_own_serial_number_is_found_in_another_socket_under_another_name)
{
    open_first("A50285BI");
    lose_first();
    expect_found(NULL);
    plug_in("ttyUSB0", "1-1.3", "OTHER7"); /* has its old name */
    expect_found(NULL);
    plug_in("ttyUSB1", "1-1.4", "A50285BI");
    expect_found("ttyUSB1");
    expect_advice(NULL);
}

TEST(a_second_loss_finds_it_in_the_third_socket)
{
    open_first("A50285BI");
    lose_first();
    plug_in("ttyUSB1", "1-1.4", "A50285BI");
    open_adapter(named("ttyUSB0"));
    unplug("ttyUSB1", "1-1.4");
    adapter_close(&adapter);
    plug_in("ttyUSB2", "1-1.1", "A50285BI");
    expect_found("ttyUSB2");
}

TEST(another_vendor_or_product_with_the_serial_number_is_another_adapter)
{
    open_first("A50285BI");
    lose_first();
    add_device("usb1", "1-1.2", "0403", "ea60", "A50285BI");
    add_tty("ttyUSB0", "usb1/1-1.2/1-1.2:1.0/ttyUSB0");
    expect_found(NULL);
    unplug("ttyUSB0", "1-1.2");
    add_device("usb1", "1-1.2", "10c4", "6010", "A50285BI");
    add_tty("ttyUSB0", "usb1/1-1.2/1-1.2:1.0/ttyUSB0");
    expect_found(NULL);
}

TEST(an_adapter_without_a_serial_number_is_found_in_its_socket_only)
{
    open_first(NULL);
    lose_first();
    expect_advice(NO_SERIAL);
    expect_advice(NULL); /* once */
    plug_in("ttyUSB0", "1-1.3", NULL);
    expect_found(NULL);
    plug_in("ttyUSB5", "1-1.2", NULL);
    expect_found("ttyUSB5");
}

/* The makers of chips and of clones use such numbers for whole series. */
TEST(an_adapter_with_a_counted_serial_number_is_found_in_its_socket_only)
{
    static const char *const serials[] = {"0001", "00000000", "12345678", "0123456789ABCDEF", "1"};
    for (size_t i = 0; i != sizeof serials / sizeof serials[0]; i++) {
        open_first(serials[i]);
        lose_first();
        expect_advice(COUNTED);
        plug_in("ttyUSB0", "1-1.3", serials[i]);
        expect_found(NULL);
        unplug("ttyUSB0", "1-1.3");
        plug_in("ttyUSB0", "1-1.2", serials[i]);
        expect_found("ttyUSB0");
        unplug("ttyUSB0", "1-1.2");
        memset(&adapter, 0, sizeof adapter);
    }
}

TEST(a_serial_number_that_is_programmed_for_a_site_is_its_own)
{
    open_first("0002");
    lose_first();
    plug_in("ttyUSB1", "1-1.3", "0002");
    expect_found("ttyUSB1");
}

/* ---- twins ---- */

TEST(a_twin_that_is_there_first_is_not_opened_instead)
{
    plug_in("ttyUSB1", "1-1.3", "A50285BI");
    open_first("A50285BI");
    lose_first();
    expect_advice(SHARED);
    expect_found(NULL);
    plug_in("ttyUSB0", "1-1.2", "A50285BI");
    expect_found("ttyUSB0");
}

TEST(a_twin_that_comes_later_is_not_opened_instead)
{
    open_first("A50285BI");
    plug_in("ttyUSB1", "1-1.3", "A50285BI");
    lose_first();
    expect_advice(SHARED);
    expect_found(NULL);
}

TEST(a_twin_that_was_plugged_in_for_a_moment_is_not_opened_instead)
{
    open_first("A50285BI");
    plug_in("ttyUSB1", "1-1.3", "A50285BI");
    unplug("ttyUSB1", "1-1.3");
    lose_first();
    expect_advice(SHARED);
    plug_in("ttyUSB1", "1-1.3", "A50285BI");
    expect_found(NULL);
}

TEST(another_adapter_that_stays_is_no_twin)
{
    open_first("A50285BI");
    plug_in("ttyUSB1", "1-1.3", "OTHER7");
    lose_first();
    plug_in("ttyUSB2", "1-1.4", "A50285BI");
    expect_found("ttyUSB2");
}

TEST(a_twin_that_comes_while_it_is_unplugged_is_not_opened_if_both_are_there)
{
    open_first("A50285BI");
    lose_first();
    plug_in("ttyUSB0", "1-1.3", "A50285BI");
    plug_in("ttyUSB1", "1-1.2", "A50285BI");
    expect_found("ttyUSB1");
    unplug("ttyUSB1", "1-1.2");
    expect_found(NULL); /* the twin alone */
    expect_advice(SHARED);
}

TEST(its_own_return_in_another_socket_is_no_twin)
{
    open_first("A50285BI");
    unplug("ttyUSB0", "1-1.2");
    plug_in("ttyUSB1", "1-1.3", "A50285BI"); /* before the loss was noticed */
    adapter_close(&adapter);
    expect_found("ttyUSB1");
}

TEST(after_a_move_a_twin_makes_both_doubtful)
{
    open_first("A50285BI");
    lose_first();
    plug_in("ttyUSB1", "1-1.3", "A50285BI");
    open_adapter(named("ttyUSB0"));
    assert_false(adapter_is_doubtful(&adapter));
    plug_in("ttyUSB0", "1-1.2", "A50285BI");
    assert_non_null(strstr(adapter_find(&adapter, named("ttyUSB0")), "the right one is unknown"));
    assert_true(adapter_is_doubtful(&adapter));
}

TEST(swapped_names_are_not_mixed_up)
{
    plug_in("ttyUSB1", "1-1.3", "0001");
    open_first("0001");
    lose_first();
    unplug("ttyUSB1", "1-1.3");
    plug_in("ttyUSB0", "1-1.3", "0001");
    plug_in("ttyUSB1", "1-1.2", "0001");
    expect_found("ttyUSB1");
    open_adapter(named("ttyUSB0"));
}

TEST(names_that_swap_between_finding_and_opening_are_noticed)
{
    plug_in("ttyUSB0", "1-1.2", "0001");
    assert_null(adapter_find(&adapter, named("ttyUSB0")));
    unplug("ttyUSB0", "1-1.2");
    plug_in("ttyUSB0", "1-1.3", "0001");
    assert_false(adapter_open(&adapter));
}

TEST(a_bus_that_is_numbered_anew_does_not_change_the_socket)
{
    plug_in_to("controller/usb1", "ttyUSB0", "1-1.2", "0001");
    open_adapter(named("ttyUSB0"));
    run("rm -rf %s/devices/controller %s/class/tty/ttyUSB0 && rm %s/ttyUSB0", sysfs, sysfs, dev);
    adapter_close(&adapter);
    plug_in_to("other/usb1", "ttyUSB0", "1-1.2", "0001");
    expect_found(NULL);
    plug_in_to("controller/usb3", "ttyUSB1", "3-1.2", "0001");
    expect_found("ttyUSB1");
}

/* ---- several ports, other kinds, links ---- */

TEST(the_ports_of_one_adapter_are_neither_twins_nor_mixed_up)
{
    plug_in("ttyUSB0", "1-1.2", "FT4ABC");
    add_tty("ttyUSB1", "usb1/1-1.2/1-1.2:1.1/ttyUSB1");
    write_file("usb1/1-1.2/1-1.2:1.1", "bInterfaceNumber", "01");
    open_adapter(named("ttyUSB1"));
    run("rm -rf %s/devices/usb1/1-1.2 %s/class/tty/ttyUSB* && rm %s/tty*", sysfs, sysfs, dev);
    adapter_close(&adapter);
    plug_in("ttyUSB1", "1-1.3", "FT4ABC"); /* the other interface has the old name */
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
    adapter_close(&adapter);
    assert_null(adapter_find(&adapter, named("ttyS0")));
    assert_null(adapter_advice(&adapter));
}

TEST(an_adapter_about_which_nothing_is_known_is_found_by_its_path_and_that_is_reported)
{
    run("touch %s/ttyUSB0", dev);
    assert_null(adapter_find(&adapter, named("ttyUSB0")));
    assert_null(adapter_advice(&adapter)); /* it was not open yet */
    open_adapter(named("ttyUSB0"));
    adapter_close(&adapter);
    assert_null(adapter_find(&adapter, named("ttyUSB0")));
    assert_string_equal(adapter.path, "");
    expect_advice("nothing is known about this adapter, so any adapter at this path will be read");
}

TEST(a_link_by_id_finds_neither_of_two_twins)
{
    char link[LONG];
    plug_in("ttyUSB0", "1-1.2", "0002");
    run("mkdir -p %s/serial/by-id && ln -s ../../ttyUSB0 %s/serial/by-id/usb-0002", dev, dev);
    (void)snprintf(link, sizeof link, "%s/serial/by-id/usb-0002", dev);
    assert_null(adapter_find(&adapter, link));
    assert_string_equal(adapter.path, named("ttyUSB0"));
    plug_in("ttyUSB1", "1-1.3", "0002");
    assert_non_null(strstr(adapter_find(&adapter, link), "several adapters have this identity"));
    assert_null(adapter_find(&adapter, named("ttyUSB0"))); /* the other names are clear */
}

TEST(an_open_adapter_that_was_named_by_id_keeps_its_socket_when_a_twin_comes)
{
    char link[LONG];
    plug_in("ttyUSB0", "1-1.2", "0002");
    run("mkdir -p %s/serial/by-id && ln -s ../../ttyUSB0 %s/serial/by-id/usb-0002", dev, dev);
    (void)snprintf(link, sizeof link, "%s/serial/by-id/usb-0002", dev);
    open_adapter(link);
    plug_in("ttyUSB1", "1-1.3", "0002");
    run("ln -sf ../../ttyUSB1 %s/serial/by-id/usb-0002", dev);
    lose_first();
    assert_string_equal(adapter_find(&adapter, link), "");
    plug_in("ttyUSB5", "1-1.2", "0002");
    assert_null(adapter_find(&adapter, link));
    assert_string_equal(adapter.path, named("ttyUSB5"));
}

/* FTDI's, which `setserial PORT low_latency` reduces to 1. */
TEST(the_latency_is_reported_if_it_is_known)
{
    plug_in("ttyUSB0", "1-1.2", "A50285BI");
    assert_int_equal(adapter_latency_ms(named("ttyUSB0")), 0);
    write_file("usb1/1-1.2/1-1.2:1.0/ttyUSB0", "latency_timer", "16");
    assert_int_equal(adapter_latency_ms(named("ttyUSB0")), 16);
    assert_int_equal(adapter_latency_ms("/no/such/port"), 0);
}
