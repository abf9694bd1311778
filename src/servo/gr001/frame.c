/* SPDX-License-Identifier: MIT */
/* The frames that a driver sends, for either wiring. */
#include <grobo/board.h>

#include <string.h>

int grobo_frame_wrap(grobo_wiring wiring, const uint8_t *packet, size_t n, uint8_t *buf, size_t cap)
{
    if (wiring == GROBO_WIRING_BOARD) {
        return grobo_board_relay(packet, n, buf, cap);
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

int grobo_frame_reply(grobo_wiring wiring, const uint8_t *frame, size_t n, grobo_reply *reply)
{
    static const grobo_reply nothing = {GROBO_REPLY_NONE, 0, 0, 0};
    if (wiring == GROBO_WIRING_BUS) {
        return grobo_rs30x_reply_to(frame, n, reply);
    }
    grobo_board_frame parsed;
    grobo_reply found = nothing;
    int bytes = grobo_board_parse(frame, n, &parsed);
    if (bytes < 0) {
        return bytes;
    }
    if (parsed.packet_bytes > 0) {
        bytes = grobo_rs30x_reply_to(parsed.packet, parsed.packet_bytes, &found);
    }
    if (bytes < 0) {
        return bytes;
    }
    switch (parsed.kind) {
    case GROBO_BOARD_CHECK:
        found.kind = GROBO_REPLY_ACK;
        break;
    case GROBO_BOARD_SEND:
    case GROBO_BOARD_SLOT:
    case GROBO_BOARD_SCENARIO:
        found = nothing;
        break;
    case GROBO_BOARD_ASK:
        if (parsed.reply_bytes != bytes) {
            return GROBO_ERR_FRAME;
        }
        break;
    }
    *reply = found;
    return (int)grobo_reply_bytes(&found);
}

/* Wraps in its place what a builder has put into buf. */
static int wrap_built(grobo_wiring wiring, int built, uint8_t *buf, size_t cap)
{
    return built < 0 ? built : grobo_frame_wrap(wiring, buf, (size_t)built, buf, cap);
}

int grobo_frame_goal(grobo_wiring wiring, const grobo_rs30x_goal *goal, uint8_t *buf, size_t cap)
{
    return wrap_built(wiring, grobo_rs30x_write_goal(goal, buf, cap), buf, cap);
}

int grobo_frame_goals(grobo_wiring wiring, const grobo_rs30x_goal *goals, size_t n, uint8_t *buf,
                      size_t cap)
{
    return wrap_built(wiring, grobo_rs30x_write_goals(goals, n, buf, cap), buf, cap);
}

static bool is_torque(unsigned value)
{
    return value <= GROBO_TORQUE_BRAKE;
}

int grobo_frame_torque(grobo_wiring wiring, uint8_t id, grobo_torque torque, uint8_t *buf,
                       size_t cap)
{
    if (!is_torque(torque)) {
        return GROBO_ERR_ARG;
    }
    int built = grobo_rs30x_write_u8(id, GROBO_RS30X_WANT_NOTHING, GROBO_RS30X_TORQUE,
                                     (uint8_t)torque, buf, cap);
    return wrap_built(wiring, built, buf, cap);
}

int grobo_frame_torques(grobo_wiring wiring, const grobo_rs30x_byte *torques, size_t n,
                        uint8_t *buf, size_t cap)
{
    for (size_t i = 0; i < n; i++) {
        if (!is_torque(torques[i].value)) {
            return GROBO_ERR_ARG;
        }
    }
    int built = grobo_rs30x_write_bytes(GROBO_RS30X_TORQUE, torques, n, buf, cap);
    return wrap_built(wiring, built, buf, cap);
}

int grobo_frame_read(grobo_wiring wiring, uint8_t id, uint8_t address, uint8_t length, uint8_t *buf,
                     size_t cap)
{
    return wrap_built(wiring, grobo_rs30x_read(id, address, length, buf, cap), buf, cap);
}
