/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "tools/grctl/cli/joints.h"
#include "tools/grctl/conn/servos.h"
#include "tools/grctl/conn/wire.h"

/* Behind a network a reply may take as long as it likes. */
enum { TCP_MARGIN_US = 50000 };

int servos_read(conn *c, int id, int address, int length, uint8_t *data)
{
    grobo_register_io io = {
        .id = (uint8_t)id, .address = (uint8_t)address, .length = (uint8_t)length};
    c->data = data;
    c->data_bytes = (size_t)length;
    int error = conn_wait(c, grobo_robot_registers(grobo_session_robot(c->session), &io));
    c->data = NULL; /* it is the caller's */
    return error;
}

int servos_wait(conn *c, int baud_bps, int length, uint32_t margin_us, int retries,
                uint32_t *timeout_us)
{
    bool remote = strncmp(conn_device(c), "tcp:", 4) == 0;
    grobo_robot_config config = conn_robot_config(c->a);
    uint32_t wire_us;
    int error = wire_read_us(grobo_robot_driver(c->robot), baud_bps, length, &wire_us);
    if (error) {
        return error;
    }
    if (!config.retries) {
        config.retries = retries;
    }
    if (!config.timeout_us) {
        config.timeout_us = wire_us + (remote ? TCP_MARGIN_US : margin_us);
    }
    if (timeout_us) {
        *timeout_us = config.timeout_us;
    }
    return grobo_robot_configure(c->robot, &config);
}

int servos_parse_id(app *a, const char *text, int *status)
{
    double number;
    if (cli_read_number(text, &number)) {
        if (number >= 1 && number <= GROBO_RS30X_ID_MAX && number == (double)(int)number) {
            return (int)number;
        }
        *status = app_fail(a, EXIT_USAGE, "ARG", "'%s' is not an id from 1 to %d", text,
                           GROBO_RS30X_ID_MAX);
        return -1;
    }
    int joint = joints_parse_one(a, text, strlen(text), status);
    return joint < 0 ? -1 : grobo_model_motor_of_joint(app_model(a), joint);
}
