/* SPDX-License-Identifier: MIT */
/* The frames that a driver sends, whatever the line. */
#include <string.h>

#include <grobo/core/rs30x.h>

int grobo_frame_wrap(const grobo_protocol *protocol, const uint8_t *packet, size_t n, uint8_t *buf,
                     size_t cap)
{
    if (protocol == NULL || buf == NULL) {
        return GROBO_ERR_ARG;
    }
    if (protocol->relay != NULL) {
        return protocol->relay->wrap(packet, n, buf, cap);
    }
    grobo_reply reply;
    int result = grobo_rs30x_reply_to(packet, n, &reply);
    if (result < 0) {
        return result;
    }
    if (n > cap) {
        return GROBO_ERR_SPACE;
    }
    memmove(buf, packet, n);
    return (int)n;
}

/* Wraps in its place what a builder has put into buf. */
static int wrap_built(const grobo_protocol *protocol, int built, uint8_t *buf, size_t cap)
{
    return built < 0 ? built : grobo_frame_wrap(protocol, buf, (size_t)built, buf, cap);
}

int grobo_frame_goal(const grobo_protocol *protocol, const grobo_rs30x_goal *goal, uint8_t *buf,
                     size_t cap)
{
    return wrap_built(protocol, grobo_rs30x_write_goal(goal, buf, cap), buf, cap);
}

int grobo_frame_goals(const grobo_protocol *protocol, const grobo_rs30x_goal *goals, size_t n,
                      uint8_t *buf, size_t cap)
{
    return wrap_built(protocol, grobo_rs30x_write_goals(goals, n, buf, cap), buf, cap);
}

static bool is_torque(unsigned value)
{
    return value <= GROBO_TORQUE_BRAKE;
}

int grobo_frame_torque(const grobo_protocol *protocol, uint8_t id, grobo_torque torque,
                       uint8_t *buf, size_t cap)
{
    if (!is_torque(torque)) {
        return GROBO_ERR_ARG;
    }
    int built = grobo_rs30x_write_u8(id, GROBO_RS30X_WANT_NOTHING, GROBO_RS30X_TORQUE,
                                     (uint8_t)torque, buf, cap);
    return wrap_built(protocol, built, buf, cap);
}

int grobo_frame_torques(const grobo_protocol *protocol, const grobo_rs30x_byte *torques, size_t n,
                        uint8_t *buf, size_t cap)
{
    if (torques == NULL && n > 0) {
        return GROBO_ERR_ARG;
    }
    for (size_t i = 0; i < n; i++) {
        if (!is_torque(torques[i].value)) {
            return GROBO_ERR_ARG;
        }
    }
    int built = grobo_rs30x_write_bytes(GROBO_RS30X_TORQUE, torques, n, buf, cap);
    return wrap_built(protocol, built, buf, cap);
}

int grobo_frame_read(const grobo_protocol *protocol, uint8_t id, uint8_t address, uint8_t length,
                     uint8_t *buf, size_t cap)
{
    return wrap_built(protocol, grobo_rs30x_read(id, address, length, buf, cap), buf, cap);
}
