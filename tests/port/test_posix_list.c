/* SPDX-License-Identifier: MIT */
/* The list of ports, on a made-up /sys and /dev; the real ones are only looked through. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "ports/posix/posix.h"
#include "tests/support/folder.h"
#include "tests/support/line.h"
#include "tests/support/nobody.h"
#include "tests/support/test.h"

static test_line line;

/* Runs a shell command in the folder. */
static void shell(const char *command)
{
    char whole[2048];

    assert_true(snprintf(whole, sizeof whole, "cd %s && %s", folder, command) < (int)sizeof whole);
    assert_int_equal(system(whole), 0);
}

static int set_up(void)
{
    char command[256];

    (void)folder_set_up();
    test_line_open(&line);
    /* An FTDI adapter as ttyUSB0, a chip as ttyS0, a node without a chip, a virtual console. */
    shell("mkdir -p class/tty dev/serial/by-id drivers/ftdi_sio drivers/serial8250 "
          "devices/usb1/1-1/1-1:1.0/ttyUSB0/tty/ttyUSB0 devices/serial0/tty/ttyS0 "
          "devices/serial0/tty/ttyS1 devices/virtual/tty/tty1");
    shell("cd devices/usb1/1-1 && echo 0403 >idVendor && echo 6001 >idProduct && "
          "echo FTDI >manufacturer && echo 'FT232R USB UART' >product && echo A1B2C3 >serial");
    shell("cd devices/usb1/1-1/1-1:1.0/ttyUSB0 && echo 16 >latency_timer && "
          "ln -s ../../../../../drivers/ftdi_sio driver && ln -s ../.. tty/ttyUSB0/device");
    shell("cd devices/serial0 && ln -s ../../drivers/serial8250 driver && "
          "ln -s ../.. tty/ttyS0/device && ln -s ../.. tty/ttyS1/device && "
          "echo 4 >tty/ttyS0/type && echo 0 >tty/ttyS1/type");
    shell("cd class/tty && ln -s ../../devices/usb1/1-1/1-1:1.0/ttyUSB0/tty/ttyUSB0 && "
          "ln -s ../../devices/serial0/tty/ttyS0 && ln -s ../../devices/serial0/tty/ttyS1 && "
          "ln -s ../../devices/virtual/tty/tty1");
    snprintf(command, sizeof command, "ln -s %s dev/ttyUSB0", line.device);
    shell(command);
    shell("ln -s ../../ttyUSB0 dev/serial/by-id/usb-FTDI_FT232R_USB_UART_A1B2C3-if00-port0");
    return 0;
}

static int tear_down(void)
{
    test_line_close(&line);
    shell("rm -r class dev devices drivers");
    folder_remove(NULL, 0);
    return 0;
}

typedef struct {
    grobo_port_info info[8];
    int count;
    int stop; /* returned at the first */
} found;

static int collect(void *ctx, const grobo_port_info *info)
{
    found *f = ctx;

    assert_true(f->count < 8);
    f->info[f->count++] = *info;
    return f->stop;
}

static int list(found *f)
{
    return grobo_i_posix_list(in_folder("class/tty"), in_folder("proc"), in_folder("dev"), collect,
                              f);
}

TEST(each_port_with_a_device_is_described)
{
    found f = {.count = 0};

    assert_int_equal(list(&f), 2);
    assert_string_equal(f.info[0].path, in_folder("dev/ttyS0"));
    assert_string_equal(f.info[0].driver, "serial8250");
    assert_string_equal(f.info[0].by_id, "");
    assert_int_equal(f.info[0].usb_vendor, -1);
    assert_int_equal(f.info[0].latency_ms, -1);
    assert_int_equal(f.info[0].open_result, GROBO_ERR_NOENT);

    assert_string_equal(f.info[1].path, in_folder("dev/ttyUSB0"));
    assert_string_equal(f.info[1].driver, "ftdi_sio");
    assert_string_equal(strrchr(f.info[1].by_id, '/'),
                        "/usb-FTDI_FT232R_USB_UART_A1B2C3-if00-port0");
    assert_int_equal(f.info[1].usb_vendor, 0x0403);
    assert_int_equal(f.info[1].usb_product, 0x6001);
    assert_string_equal(f.info[1].manufacturer, "FTDI");
    assert_string_equal(f.info[1].product, "FT232R USB UART");
    assert_string_equal(f.info[1].serial_number, "A1B2C3");
    assert_int_equal(f.info[1].latency_ms, 16);
    assert_int_equal(f.info[1].owner_pid, 0);
    assert_int_equal(f.info[1].open_result, GROBO_OK);
}

TEST(without_sysfs_adapters_are_found_by_their_names)
{
    found f = {.count = 0};

    assert_int_equal(grobo_i_posix_list("/no/such/folder", "/none", in_folder("dev"), collect, &f),
                     1);
    assert_string_equal(f.info[0].path, in_folder("dev/ttyUSB0"));
    assert_string_equal(strrchr(f.info[0].by_id, '/'),
                        "/usb-FTDI_FT232R_USB_UART_A1B2C3-if00-port0");
    assert_string_equal(f.info[0].driver, "");
    assert_int_equal(f.info[0].usb_vendor, -1);
    assert_int_equal(f.info[0].latency_ms, -1);
    assert_int_equal(f.info[0].open_result, GROBO_OK);
    assert_int_equal(grobo_i_posix_list("/no/such/folder", "/none", "/nor/this", collect, &f), 0);
}

/* ttyUSB2 before ttyUSB10: the order in which adapters are tried. */
/* ttyAMA0 has a Bluetooth chip, ttyAMA10 is a console, ttyS0 one of the kernel's command line. */
TEST(consoles_and_bluetooth_are_told_apart)
{
    static const struct {
        const char *name;
        bool console, bluetooth;
    } want[] = {{"ttyAMA0", false, true},
                {"ttyAMA1", false, false},
                {"ttyAMA10", true, false},
                {"ttyS0", true, false},
                {"ttyUSB0", false, false}};
    found f = {.count = 0};

    shell("mkdir proc && printf 'tty0   -WU (EC p  ) 4:7\\nttyAMA10 -W- (EC   ) 204:64\\n' "
          ">proc/consoles");
    shell("echo 'quiet earlyconsole=ttyAMA1 console=ttyS0,115200 rw' >proc/cmdline");
    shell("for n in 0 1 10; do mkdir -p devices/uart$n/of_node && : >dev/ttyAMA$n && "
          "ln -s ../../devices/uart$n class/tty/ttyAMA$n && ln -s . devices/uart$n/device; done && "
          "mkdir devices/uart0/of_node/bluetooth");
    assert_int_equal(list(&f), 5);
    for (int i = 0; i < f.count; i++) {
        assert_string_equal(strrchr(f.info[i].path, '/') + 1, want[i].name);
        assert_int_equal(f.info[i].console, want[i].console);
        assert_int_equal(f.info[i].bluetooth, want[i].bluetooth);
    }
    shell("rm -r proc devices/uart* class/tty/ttyAMA* dev/ttyAMA*");
}

TEST(ports_are_in_the_order_of_their_numbers)
{
    static const char *const names[] = {"ttyS0", "ttyUSB0", "ttyUSB1", "ttyUSB2", "ttyUSB10"};
    found f = {.count = 0};

    shell("for n in 10 2 1; do mkdir -p devices/usb1/1-1/1-1:1.0/ttyUSB$n && "
          "ln -s ../../devices/usb1/1-1/1-1:1.0/ttyUSB$n class/tty/ttyUSB$n && "
          "ln -s .. class/tty/ttyUSB$n/device && : >dev/ttyUSB$n; done");
    assert_int_equal(list(&f), 5);
    for (int i = 0; i < f.count; i++) {
        assert_string_equal(strrchr(f.info[i].path, '/') + 1, names[i]);
    }
    f.count = 0;
    assert_int_equal(grobo_i_posix_list("/no/such/folder", "/none", in_folder("dev"), collect, &f),
                     4);
    for (int i = 0; i < f.count; i++) {
        assert_string_equal(strrchr(f.info[i].path, '/') + 1, names[i + 1]);
    }
    shell("for n in 1 2 10; do "
          "rm -r devices/usb1/1-1/1-1:1.0/ttyUSB$n class/tty/ttyUSB$n dev/ttyUSB$n; done");
}

TEST(a_visit_can_be_ended)
{
    found f = {.stop = 7};

    assert_int_equal(list(&f), 7);
    assert_int_equal(f.count, 1);
}

/* The name the system knows this process by; under valgrind it is not the program's. */
static void own_name(char *name, size_t name_bytes)
{
    FILE *comm = fopen("/proc/self/comm", "r");

    assert_non_null(comm);
    assert_non_null(fgets(name, (int)name_bytes, comm));
    assert_int_equal(fclose(comm), 0);
    name[strcspn(name, "\n")] = '\0';
}

TEST(a_port_in_use_names_its_owner)
{
    char name[64];
    const grobo_port_ops *ops = grobo_port_serial_ops();
    grobo_port port;
    grobo_os_cause cause;
    found f = {.count = 0};

    own_name(name, sizeof name);
    assert_int_equal(ops->open(&port, line.device, 115200, &cause), GROBO_OK);
    assert_int_equal(list(&f), 2);
    assert_int_equal(f.info[1].owner_pid, getpid());
    assert_string_equal(f.info[1].owner_name, name);
    assert_int_equal(f.info[1].open_result, GROBO_ERR_BUSY);
    ops->close(&port);
}

static int result_of_opening(void *ctx)
{
    found f = {.count = 0};

    (void)ctx;
    return list(&f) == 2 ? f.info[1].open_result : GROBO_OK;
}

TEST(a_port_of_somebody_else_is_not_to_be_opened)
{
    assert_int_equal(chmod(folder, 0755), 0);
    assert_int_equal(chmod(line.device, 0600), 0);
    assert_int_equal(as_nobody(result_of_opening, NULL), GROBO_ERR_PERM);
}

TEST(a_device_without_a_link_is_its_own_identity)
{
    char name[GROBO_DEVICE_MAX_BYTES] = "";

    assert_int_equal(grobo_port_identity(line.device, name, sizeof name), GROBO_OK);
    assert_string_equal(name, line.device);
    assert_int_equal(grobo_port_identity(line.device, name, 3), GROBO_ERR_SPACE);
    assert_int_equal(grobo_port_identity(NULL, name, sizeof name), GROBO_ERR_ARG);
}

TEST(this_machines_ports_can_be_listed)
{
    found f = {.stop = 1};
    int r = grobo_port_list(collect, &f);

    assert_true(r >= 0);
    for (int i = 0; i < f.count; i++) {
        assert_int_equal(access(f.info[i].path, F_OK), 0);
    }
}

TESTS_BETWEEN(set_up, tear_down)
