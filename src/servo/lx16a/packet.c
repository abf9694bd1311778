/* SPDX-License-Identifier: MIT */
/* Frames of LewanSoul and Hiwonder servos: measured, taken apart, built. */
#include <string.h>

#include <grobo/core/lx16a.h>

enum {
    HEADER = 0x55,
    AT_ID = 2,
    AT_LENGTH = 3,
    AT_COMMAND = 4,
    AT_DATA = 5,
    LENGTH_MIN = 3, /* length, command, sum */
    LENGTH_MAX = 7
};

size_t grobo_lx16a_reply_bytes(uint8_t command)
{
    static const uint8_t bytes[] = {
        [GROBO_LX16A_MOVE_READ] = 4,    [GROBO_LX16A_WAIT_READ] = 4,
        [GROBO_LX16A_ID_READ] = 1,      [GROBO_LX16A_OFFSET_READ] = 1,
        [GROBO_LX16A_LIMITS_READ] = 4,  [GROBO_LX16A_VOLTAGES_READ] = 4,
        [GROBO_LX16A_HEAT_READ] = 1,    [GROBO_LX16A_TEMPERATURE_READ] = 1,
        [GROBO_LX16A_VOLTAGE_READ] = 2, [GROBO_LX16A_POSITION_READ] = 2,
        [GROBO_LX16A_MODE_READ] = 4,    [GROBO_LX16A_LOAD_READ] = 1,
        [GROBO_LX16A_LED_READ] = 1,     [GROBO_LX16A_ALARM_READ] = 1};
    return command < sizeof bytes ? bytes[command] : 0;
}

static uint8_t sum_of(const uint8_t *frame, size_t n)
{
    unsigned sum = 0;
    for (size_t i = AT_ID; i < n - 1; i++) {
        sum += frame[i];
    }
    return (uint8_t)~sum;
}

/* A return is known by its command and length; a request to read has no data. */
static bool is_accepted(const uint8_t *bytes, size_t n, unsigned accept)
{
    if ((accept & GROBO_ACCEPT_COMMANDS) != 0) {
        return true;
    }
    if (n > AT_ID && bytes[AT_ID] > GROBO_LX16A_ID_MAX) {
        return false;
    }
    size_t data = n > AT_COMMAND ? grobo_lx16a_reply_bytes(bytes[AT_COMMAND]) : 0;
    return n <= AT_COMMAND || (data > 0 && bytes[AT_LENGTH] == LENGTH_MIN + data);
}

int grobo_lx16a_measure(const uint8_t *bytes, size_t n, unsigned accept)
{
    if (bytes == NULL) {
        return GROBO_ERR_ARG;
    }
    for (size_t i = 0; i < n && i < AT_ID; i++) {
        if (bytes[i] != HEADER) {
            return GROBO_ERR_FRAME;
        }
    }
    if ((n > AT_ID && bytes[AT_ID] > GROBO_LX16A_ID_ALL) || !is_accepted(bytes, n, accept)) {
        return GROBO_ERR_FRAME;
    }
    if (n <= AT_LENGTH) {
        return 0;
    }
    if (bytes[AT_LENGTH] < LENGTH_MIN || bytes[AT_LENGTH] > LENGTH_MAX) {
        return GROBO_ERR_FRAME;
    }
    size_t size = (size_t)bytes[AT_LENGTH] + LENGTH_MIN;
    if (n < size) {
        return 0;
    }
    return sum_of(bytes, size) == bytes[size - 1] ? (int)size : GROBO_ERR_CHECKSUM;
}

int grobo_lx16a_parse(const uint8_t *frame, size_t n, grobo_lx16a_packet *packet)
{
    if (frame == NULL || packet == NULL) {
        return GROBO_ERR_ARG;
    }
    int size = n > 0 ? grobo_lx16a_measure(frame, n, GROBO_ACCEPT_COMMANDS) : 0;
    if (size <= 0 || (size_t)size != n) {
        return size < 0 ? size : GROBO_ERR_FRAME;
    }
    *packet = (grobo_lx16a_packet){.id = frame[AT_ID],
                                   .command = frame[AT_COMMAND],
                                   .data = frame + AT_DATA,
                                   .data_bytes = n - GROBO_LX16A_OVERHEAD_BYTES};
    return GROBO_OK;
}

int grobo_lx16a_answer(const uint8_t *sent, size_t sent_bytes, const uint8_t *bytes, size_t n)
{
    grobo_lx16a_packet request;
    if (bytes == NULL) {
        return GROBO_ERR_ARG;
    }
    int result = grobo_lx16a_parse(sent, sent_bytes, &request);
    if (result < 0) {
        return result;
    }
    int size = grobo_lx16a_measure(bytes, n, GROBO_ACCEPT_RETURNS);
    if ((n > AT_ID && request.id != GROBO_LX16A_ID_ALL && bytes[AT_ID] != request.id) ||
        (n > AT_COMMAND && bytes[AT_COMMAND] != request.command)) {
        return GROBO_ERR_FRAME;
    }
    /* Two that answer at once may make a frame with a good sum. */
    bool own_id =
        size <= 0 || request.command != GROBO_LX16A_ID_READ || bytes[AT_DATA] == bytes[AT_ID];
    return own_id ? size : GROBO_ERR_FRAME;
}

int grobo_lx16a_build(const grobo_lx16a_packet *packet, uint8_t *buf, size_t cap)
{
    if (packet == NULL || buf == NULL || (packet->data == NULL && packet->data_bytes > 0) ||
        packet->id > GROBO_LX16A_ID_ALL) {
        return GROBO_ERR_ARG;
    }
    size_t size = packet->data_bytes + GROBO_LX16A_OVERHEAD_BYTES;
    if (packet->data_bytes > LENGTH_MAX - LENGTH_MIN) {
        return GROBO_ERR_CAP;
    }
    if (size > cap) {
        return GROBO_ERR_SPACE;
    }
    if (packet->data_bytes > 0) {
        memmove(buf + AT_DATA, packet->data, packet->data_bytes);
    }
    buf[0] = buf[1] = HEADER;
    buf[AT_ID] = packet->id;
    buf[AT_LENGTH] = (uint8_t)(LENGTH_MIN + packet->data_bytes);
    buf[AT_COMMAND] = packet->command;
    buf[size - 1] = sum_of(buf, size);
    return (int)size;
}
