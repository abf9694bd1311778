/* SPDX-License-Identifier: MIT */
/*
 * Lines of text at any rate, of a microcontroller with an IMU or of a simulator. The first line may
 * have begun before the port was opened, so that it is dropped. A line that is none is dropped and
 * counted; a port that is lost says so once, and the robot goes on without.
 */
#include <string.h>

#include <grobo/model.h>

#include "tools/grctl/cli/output.h"
#include "tools/grctl/conn/imu.h"
#include "tools/grctl/lang/lang.h"

enum { IMU_BAUD_BPS = 115200, NUMBERS = 5 };

static bool is_between(char c)
{
    return c == ' ' || c == '\t' || c == ',';
}

/* The next word of a line is a number. */
static bool take_number(const char **at, double *number)
{
    char word[32];
    size_t n = 0;
    while (is_between(**at)) {
        (*at)++;
    }
    while (**at != '\0' && !is_between(**at)) {
        if (n == sizeof word - 1) {
            return false;
        }
        word[n++] = *(*at)++;
    }
    word[n] = '\0';
    return n > 0 && cli_read_number(word, number);
}

bool imu_parse(const char *line, grobo_imu *reading)
{
    double rad[NUMBERS];
    for (int i = 0; i < NUMBERS; i++) {
        if (!take_number(&line, &rad[i])) {
            return false;
        }
        rad[i] = grobo_rad_from_deg(rad[i]);
    }
    *reading = (grobo_imu){rad[0], rad[1], {rad[2], rad[3], rad[4]}};
    return true;
}

static void take_line(imu *i)
{
    grobo_imu reading;
    i->line[i->n] = '\0';
    if (!imu_parse(i->line, &reading) || grobo_robot_set_imu(i->c->robot, &reading) < 0) {
        i->bad++;
        return;
    }
    i->lines++;
    if (i->took != NULL) {
        i->took(i->ctx, &reading);
    }
}

static void on_data(void *ctx, grobo_serial *serial, const uint8_t *bytes, size_t size)
{
    imu *i = ctx;
    (void)serial;
    for (size_t k = 0; k < size; k++) {
        char c = (char)bytes[k];
        if (c == '\n' || c == '\r') {
            if (!i->broken && i->n > 0) {
                take_line(i);
            }
            i->n = 0;
            i->broken = false;
        } else if (i->n < IMU_LINE_BYTES - 1) {
            i->line[i->n++] = c;
        } else {
            i->broken = true;
        }
    }
}

static void on_event(void *ctx, grobo_serial *serial, grobo_serial_event event, int error)
{
    const imu *i = ctx;
    if (event == GROBO_SERIAL_UNPLUGGED || event == GROBO_SERIAL_FAILED) {
        app_note(i->c->a, "the IMU at %s is lost: %s", grobo_serial_device(serial),
                 _(grobo_error_text(error)));
    }
}

int imu_open(imu *i, conn *c, const char *port)
{
    const grobo_serial_config config = {
        GROBO_SERIAL_CONFIG_INIT,   .device = port,     .baud_bps = IMU_BAUD_BPS, .base = c->base,
        .mode = GROBO_SERIAL_ASYNC, .on_data = on_data, .on_event = on_event,     .ctx = i};
    i->c = c;
    i->broken = true;
    int error = grobo_serial_new(&config, &i->serial);
    if (error == GROBO_OK) {
        error = grobo_serial_open(i->serial);
    }
    return error < 0 ? app_fail_error(c->a, EXIT_ROBOT, error, "--imu %s", port) : 0;
}

void imu_close(imu *i)
{
    if (i->serial != NULL && i->bad > 0) {
        app_note(i->c->a, "%lu lines of the IMU were no readings", i->bad);
    }
    grobo_serial_free(i->serial);
    i->serial = NULL;
}
