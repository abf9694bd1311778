/* SPDX-License-Identifier: MIT */
#include <stdio.h>

#include <grobo/serial.h>

#include "tools/grctl/decode/registers.h"
#include "tools/grctl/decode/words.h"
#include "tools/grctl/decode/words_i.h"

static const char *kind_of(const frame *f)
{
    static const char *const board[] = {"check", "relay", "relay_return", "slot", "scenario"};
    static const char *const packet[] = {"packet", "packet", "return", "ack", "nack"};
    switch (f->kind) {
    case FRAME_BOARD:
        return board[f->board.kind];
    case FRAME_PACKET:
        return packet[f->packet.kind];
    case FRAME_ECHO:
        return "echo";
    case FRAME_CUT:
        return "cut";
    case FRAME_RUBBISH:
        return "rubbish";
    }
    return "rubbish";
}

/* Reserved bytes are told where they are not 0. */
static json_t *part_json(const words_i_part *part)
{
    const char *name = words_i_joint(part->id);
    json_t *registers = json_object();
    json_t *other = json_object();
    json_t *o = json_pack("{s:i,s:o,s:o}", "id", part->id, "name",
                          name ? json_string(name) : json_null(), "registers", registers);
    for (size_t at = 0; at < part->n;) {
        char key[REGISTERS_TEXT_BYTES];
        words_i_item item;
        at += words_i_value(part, at, &item);
        if (item.whole) {
            registers_key(item.reg, key, sizeof key);
            json_object_set_new(registers, key, registers_json(item.reg, item.value));
        } else if (item.reg || item.value) {
            snprintf(key, sizeof key, "%u", item.address);
            json_object_set_new(other, key, json_integer(item.value));
        }
    }
    if (json_object_size(other) > 0)
        json_object_set(o, "other_bytes", other);
    json_decref(other);
    return o;
}

static json_t *status_json(const grobo_rs30x_packet *p)
{
    json_t *list = json_array();
    for (size_t i = 0; i < words_i_n_status; i++)
        if (p->flags & words_i_status[i].bit)
            json_array_append_new(list, json_string(words_i_status[i].key));
    return list;
}

static json_t *packet_json(const frame *f)
{
    static const char *const kinds[] = {"short", "long", "return", "ack", "nack"};
    const grobo_rs30x_packet *p = &f->packet;
    const uint8_t *bytes = f->kind == FRAME_BOARD ? f->board.packet : f->bytes;
    int right = words_i_right_sum(p);
    json_t *servos = json_array();
    words_i_part part;
    json_t *o = json_pack("{s:s,s:s,s:i,s:i,s:i,s:i,s:i,s:i,s:b}", "kind", kinds[p->kind], "action",
                          words_i_action(p), "id", p->id, "flags", p->flags, "address", p->address,
                          "length", p->length, "count", p->count, "sum", bytes[f->packet_size - 1],
                          "sum_ok", f->sum_ok);
    if (!f->sum_ok && right >= 0)
        json_object_set_new(o, "right_sum", json_integer(right));
    if (p->kind == GROBO_RS30X_RETURN)
        json_object_set_new(o, "status", status_json(p));
    for (int i = 0; words_i_share(p, i, &part); i++)
        json_array_append_new(servos, part_json(&part));
    json_object_set_new(o, "servos", servos);
    return o;
}

static json_t *reply_json(const frame *f, const grobo_reply *reply, int known)
{
    static const char *const kinds[] = {"none", "ack", "return"};
    json_t *o;
    if (known < 0 && known != GROBO_ERR_MISMATCH)
        return json_pack("{s:o}", "error", app_json_code(grobo_error_name(known)));
    o = json_pack("{s:s,s:I}", "kind", kinds[reply->kind], "bytes", (json_int_t)reply->bytes);
    if (reply->kind == GROBO_REPLY_RETURN) {
        json_object_set_new(o, "id", json_integer(reply->id));
        json_object_set_new(o, "address", json_integer(reply->address));
        json_object_set_new(o, "length", json_integer(reply->length));
    }
    if (known == GROBO_ERR_MISMATCH)
        json_object_set_new(o, "asked_bytes", json_integer(f->board.reply_bytes));
    return o;
}

json_t *words_json(const frame *f)
{
    char hex[3 * FRAMES_BUFFER_BYTES + 1];
    grobo_reply reply;
    int known = words_i_expects(f, &reply);
    json_t *o;
    if (grobo_hex(hex, sizeof hex, f->bytes, f->size) < 0)
        hex[0] = '\0';
    o = json_pack("{s:s,s:s,s:I,s:s}", "from", words_side(f->side), "kind", kind_of(f), "bytes",
                  (json_int_t)f->size, "hex", hex);
    if (f->kind == FRAME_BOARD &&
        (f->board.kind == GROBO_BOARD_SLOT || f->board.kind == GROBO_BOARD_SCENARIO))
        json_object_set_new(o, "number", json_integer(f->board.number));
    if (f->has_packet && f->packet_size > 1)
        json_object_set_new(o, "packet", packet_json(f));
    if (known != GROBO_ERR_TYPE && f->kind != FRAME_ECHO)
        json_object_set_new(o, "reply", reply_json(f, &reply, known));
    return o;
}
