/* SPDX-License-Identifier: MIT */
/* How the tool knows a USB adapter again: against a sysfs that is built here, of links and one-line files laid out as
 * Linux does for usb-serial (ttyUSB0 below the interface) and cdc_acm (the interface itself). */
#define _DEFAULT_SOURCE 1
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include "suite.h"

#include "ports/sysfs_adapter.h"

enum { LONG = 512 };

static char root[64];

__attribute__((format(printf, 1, 2))) static void run(const char *format, ...)
{
    char command[4 * LONG];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(command, sizeof command, format, arguments);
    va_end(arguments);
    assert_int_equal(system(command), 0); /* NOLINT: the command is this file's */
}

static int set_up(void **state)
{
    strcpy(root, "/tmp/fathom-sysfs-XXXXXX");
    if (mkdtemp(root) == NULL) return -1;
    run("mkdir -p %s/class/tty %s/devices %s/dev", root, root, root);
    return 0;
}

static int tear_down(void **state)
{
    run("rm -rf %s", root);
    return 0;
}

static const suite_t suite = {.set_up = set_up, .tear_down = tear_down};

static void write_file(const char *folder, const char *name, const char *text)
{
    char path[2 * LONG];
    assert_true(snprintf(path, sizeof path, "%s/devices/%s/%s", root, folder, name) < (int)sizeof path);
    FILE *const file = fopen(path, "w");
    assert_non_null(file);
    (void)fprintf(file, "%s\n", text);
    (void)fclose(file);
}

/* A USB device in a socket, with one interface; serial NULL: it has none. */
static void plug_in(const char *socket, const char *vendor, const char *product, const char *serial)
{
    char folder[LONG];
    run("mkdir -p %s/devices/usb1/%s/%s:1.0", root, socket, socket);
    (void)snprintf(folder, sizeof folder, "usb1/%s", socket);
    write_file(folder, "idVendor", vendor);
    write_file(folder, "idProduct", product);
    if (serial != NULL) write_file(folder, "serial", serial);
    (void)snprintf(folder, sizeof folder, "usb1/%s/%s:1.0", socket, socket);
    write_file(folder, "bInterfaceNumber", "00");
}

static void unplug(const char *socket, const char *tty)
{
    run("rm -rf %s/devices/usb1/%s %s/class/tty/%s", root, socket, root, tty);
}

/* Its tty: `below` is the folder of devices/ that its `device` link shows. */
static void add_tty(const char *tty, const char *below)
{
    run("mkdir -p %s/devices/%s %s/class/tty/%s && ln -s %s/devices/%s %s/class/tty/%s/device && "
        "touch %s/dev/%s",
        root, below, root, tty, root, below, root, tty, root, tty);
}

/* An adapter of usb-serial. */
static void plug_in_as(const char *tty, const char *socket, const char *vendor, const char *product,
                       const char *serial)
{
    char below[64];
    plug_in(socket, vendor, product, serial);
    (void)snprintf(below, sizeof below, "usb1/%s/%s:1.0/%s", socket, socket, tty);
    add_tty(tty, below);
}

static sysfs_adapter_t adapter;
static char path[SYSFS_PATH];

static bool identify(const char *tty)
{
    char device[LONG];
    (void)snprintf(device, sizeof device, "%s/dev/%s", root, tty);
    return sysfs_adapter_identify(&adapter, root, device);
}

/* The adapter is there, under that name; NULL: it is not. */
static void expect_found(const char *name)
{
    assert_int_equal(sysfs_adapter_find(&adapter, root, path), name != NULL);
    if (name != NULL) assert_string_equal(path, name);
}

TEST(an_adapter_is_what_its_usb_device_says)
{
    plug_in_as("ttyUSB0", "1-2", "0403", "6001", "A50285BI");
    write_file("usb1/1-2/1-2:1.0/ttyUSB0", "port_number", "0");
    assert_true(identify("ttyUSB0"));
    assert_string_equal(adapter.vendor, "0403");
    assert_string_equal(adapter.product, "6001");
    assert_string_equal(adapter.serial, "A50285BI");
    assert_string_equal(adapter.socket, "1-2");
    assert_string_equal(adapter.interface, "00");
    assert_string_equal(adapter.port, "0");
    assert_false(adapter.needs_socket);
}

/* FTDI's, of which `setserial PORT low_latency` makes 1. */
TEST(the_time_for_which_an_adapter_keeps_bytes_back_is_told_where_it_is_known)
{
    char device[LONG];
    plug_in_as("ttyUSB0", "1-2", "0403", "6001", "A50285BI");
    (void)snprintf(device, sizeof device, "%s/dev/ttyUSB0", root);
    assert_int_equal(sysfs_adapter_latency_ms(root, device), 0);
    write_file("usb1/1-2/1-2:1.0/ttyUSB0", "latency_timer", "16");
    assert_int_equal(sysfs_adapter_latency_ms(root, device), 16);
    assert_int_equal(sysfs_adapter_latency_ms(root, "/no/such/port"), 0);
}

TEST(an_adapter_of_the_cdc_class_too_and_through_a_link)
{
    char target[LONG];
    char link_path[LONG];
    plug_in("1-3.4", "1a86", "55d3", "5424");
    add_tty("ttyACM0", "usb1/1-3.4/1-3.4:1.0");
    (void)snprintf(target, sizeof target, "%s/dev/ttyACM0", root);
    (void)snprintf(link_path, sizeof link_path, "%s/dev/tank", root);
    assert_int_equal(symlink(target, link_path), 0);
    assert_true(identify("tank"));
    assert_string_equal(adapter.serial, "5424");
    assert_string_equal(adapter.socket, "1-3.4");
}

TEST(a_tty_that_is_no_usb_adapter_is_none)
{
    strcpy(path, "untouched");
    add_tty("ttyS0", "platform/serial8250");
    assert_false(identify("ttyS0"));
    assert_string_equal(adapter.vendor, "");
    assert_false(identify("nowhere"));
    expect_found(NULL); /* and it is not found as the first best */
    assert_string_equal(path, "untouched");
}

TEST(with_a_serial_number_it_is_found_in_another_socket_under_another_name)
{
    plug_in_as("ttyUSB0", "1-2", "0403", "6001", "A50285BI");
    assert_true(identify("ttyUSB0"));
    unplug("1-2", "ttyUSB0");
    expect_found(NULL);
    plug_in_as("ttyUSB0", "1-4", "0403", "6001", "OTHER"); /* takes its old name */
    expect_found(NULL);
    plug_in_as("ttyUSB1", "1-5", "0403", "6001", "A50285BI");
    expect_found("/dev/ttyUSB1");
}

TEST(another_vendor_or_product_with_its_serial_number_is_another)
{
    plug_in_as("ttyUSB0", "1-2", "0403", "6001", "0001");
    assert_true(identify("ttyUSB0"));
    unplug("1-2", "ttyUSB0");
    plug_in_as("ttyUSB0", "1-2", "10c4", "6001", "0001");
    expect_found(NULL);
    unplug("1-2", "ttyUSB0");
    plug_in_as("ttyUSB0", "1-2", "0403", "6010", "0001");
    expect_found(NULL);
}

TEST(without_a_serial_number_it_is_found_in_its_socket_only)
{
    plug_in_as("ttyUSB0", "1-2", "1a86", "7523", NULL);
    assert_true(identify("ttyUSB0"));
    assert_true(adapter.needs_socket);
    unplug("1-2", "ttyUSB0");
    plug_in_as("ttyUSB0", "1-3", "1a86", "7523", NULL);
    expect_found(NULL);
    plug_in_as("ttyUSB5", "1-2", "1a86", "7523", NULL);
    expect_found("/dev/ttyUSB5");
}

TEST(two_with_the_same_serial_number_are_told_apart_by_their_socket)
{
    plug_in_as("ttyUSB0", "1-2", "10c4", "ea60", "0001");
    plug_in_as("ttyUSB1", "1-3", "10c4", "ea60", "0001");
    assert_true(identify("ttyUSB0"));
    assert_true(adapter.needs_socket);
    unplug("1-2", "ttyUSB0");
    expect_found(NULL); /* ttyUSB1 has another sensor */
}

TEST(the_ports_of_one_adapter_are_told_apart)
{
    plug_in_as("ttyUSB0", "1-2", "0403", "6011", "FT4ABC");
    add_tty("ttyUSB1", "usb1/1-2/1-2:1.1/ttyUSB1");
    write_file("usb1/1-2/1-2:1.1", "bInterfaceNumber", "01");
    assert_true(identify("ttyUSB1"));
    assert_string_equal(adapter.interface, "01");
    assert_false(adapter.needs_socket);
    expect_found("/dev/ttyUSB1");
}
