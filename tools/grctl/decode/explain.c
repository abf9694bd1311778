/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "tools/grctl/conn/registers.h"
#include "tools/grctl/decode/explain.h"

/* Fewer registers are named, more are told by their addresses. */
enum { NAMES_MAX = 4 };

explain_item explain_item_at(const grobo_servo_model *servo, const grobo_telegram_part *part,
                             int at)
{
    explain_item i = {.servo = servo, .address = part->address + at, .bytes = 1};
    bool there = part->address >= 0 && i.address <= UINT16_MAX;
    i.reg = there ? grobo_servo_register_at(servo, (uint16_t)i.address) : NULL;
    i.whole = i.reg && i.reg->address == i.address && at + i.reg->bytes <= part->length;
    if (i.whole) {
        i.bytes = i.reg->bytes;
        i.value = part->data ? grobo_servo_register_get(servo, i.reg, part->data + at) : 0;
    } else if (part->data) {
        i.value = part->data[at];
    }
    return i;
}

static explain_item item_of(const talk *who, const grobo_telegram_part *part, int at)
{
    return explain_item_at(talk_servo(who, part->id), part, at);
}

/* ---- text ---------------------------------------------------------------------------------- */

static bool is_numbered(const text *t)
{
    return t->talk->words->numbered;
}

static void say_value(text *t, const explain_item *i, bool write)
{
    char value[REGISTERS_TEXT_BYTES], range[64];
    registers_text(i->servo, i->reg, i->value, value, sizeof value);
    say(t, "%s %s", i->reg->name, value);
    const char *remark = t->talk->words->remark ? t->talk->words->remark(i->reg, i->value) : NULL;
    if (remark) {
        say(t, " (%s)", remark);
    }
    if (write && (i->value < i->reg->min || i->value > i->reg->max)) {
        snprintf(range, sizeof range, "%d is outside %d..%d", (int)i->value, (int)i->reg->min,
                 (int)i->reg->max);
        say(t, ", ");
        say_bad(t, range);
    } else if (write && (i->reg->flags & GROBO_REGISTER_W) == 0) {
        say(t, ", ");
        say_bad(t, "which is read only");
    }
}

/* A register or byte in a list of them. */
static void say_item(text *t, const explain_item *i, bool write)
{
    if (i->whole) {
        say_value(t, i, write);
    } else {
        const char *part = is_numbered(t) ? " (half of " : " (part of ";
        say(t, "%s%d = %02X%s%s%s", is_numbered(t) ? "No." : "", i->address, (unsigned)i->value,
            i->reg ? part : "", i->reg ? i->reg->name : "", i->reg ? ")" : "");
    }
}

/* Limits that leave no room. */
static void say_order(text *t, const explain_item *i, int32_t *lowest)
{
    if (i->whole && i->reg->role == GROBO_ROLE_MIN_POSITION) {
        *lowest = i->value;
    } else if (i->whole && i->reg->role == GROBO_ROLE_MAX_POSITION && i->value < *lowest) {
        say(t, ", ");
        say_bad(t, "which is below the other");
    }
}

/* Registers of a servo; bytes between them are said where they are not 0. */
static void say_values(text *t, const grobo_telegram_part *part, bool write)
{
    const char *comma = "";
    int32_t lowest = INT32_MIN;
    if (part->address < 0) {
        say(t, "%d byte%s", part->length, part->length == 1 ? "" : "s");
        say_hex(t, part->data, (size_t)part->length);
        return;
    }
    for (int at = 0; at < part->length;) {
        const explain_item i = item_of(t->talk, part, at);
        at += i.bytes;
        if (i.reg || i.value != 0) {
            say(t, "%s", comma);
            say_item(t, &i, write);
            comma = ", ";
        }
        if (write) {
            say_order(t, &i, &lowest);
        }
    }
    if (!*comma && (part->length > 0 || is_numbered(t))) {
        say(t, "nothing but zeros");
    }
}

/* Registers by their numbers, in families that call them so. */
static void say_span(text *t, int address, int length)
{
    if (length > 1) {
        say(t, "No.%d-%d", address, address + length - 1);
    } else {
        say(t, "No.%d", address);
    }
}

/* Each of them, by its name or number. */
static void say_each(text *t, const grobo_telegram_part *part)
{
    const char *comma = "";
    for (int at = 0; at < part->length;) {
        const explain_item i = item_of(t->talk, part, at);
        at += i.bytes;
        if (i.whole) {
            say(t, "%s%s", comma, i.reg->name);
        } else {
            say(t, "%sNo.%d", comma, i.address);
        }
        comma = ", ";
    }
}

/* Behind which address a servo has no registers. */
static int end_of(const grobo_servo_model *servo)
{
    int end = 0;
    const grobo_servo_register *reg;
    for (size_t i = 0; (reg = grobo_servo_register_row(servo, i)) != NULL; i++) {
        end = reg->address + reg->bytes;
    }
    return end;
}

/* "present_position", or "132-147" for many. */
static void say_names(text *t, const grobo_telegram_part *part)
{
    const grobo_servo_model *servo = talk_servo(t->talk, part->id);
    const char *comma = "";
    char names[256] = "";
    size_t used = 0;
    int n = 0;
    if (is_numbered(t)) {
        say_each(t, part);
        return;
    }
    for (int at = 0; at < part->length; n++) {
        const grobo_telegram_part asked = {part->id, part->address, part->length, NULL};
        const explain_item i = item_of(t->talk, &asked, at);
        at += i.bytes;
        n = i.whole ? n : NAMES_MAX;
        if (i.whole && used < sizeof names) {
            used += (size_t)snprintf(names + used, sizeof names - used, "%s%s", comma, i.reg->name);
            comma = ", ";
        }
    }
    if (n > 0 && n <= NAMES_MAX) {
        say(t, "%s", names);
    } else if (part->length == 0) {
        say(t, "nothing at %d", part->address);
    } else {
        say(t, "%d-%d", part->address, part->address + part->length - 1);
    }
    if (part->address + part->length > end_of(servo)) {
        say(t, " ");
        say_bad(t, "(behind the last known register)");
    }
}

static void say_who(text *t, const grobo_telegram *said)
{
    if (said->all) {
        say(t, "all servos");
    } else if (said->id >= 0) {
        say_servo(t, said->id);
    }
}

static bool alike(const grobo_telegram *said)
{
    for (size_t i = 1; i < said->n_parts; i++) {
        if (said->part[i].address != said->part[0].address ||
            said->part[i].length != said->part[0].length) {
            return false;
        }
    }
    return said->n_parts > 0;
}

/* Whether each servo's share has a line of its own. */
static bool has_lines(const grobo_telegram *said)
{
    return said->shares && said->n_parts > 0 && (said->part[0].data || !alike(said));
}

static void say_many(text *t, const grobo_telegram *said)
{
    bool reads = said->n_parts > 0 && !said->part[0].data;
    if (said->reply) {
        say(t, "%zu servos return", said->n_parts);
        return;
    }
    say(t, "%s", said->action);
    if (!reads || !alike(said)) {
        say(t, " %zu servos%s", said->n_parts, alike(said) ? ": " : "");
    }
    if (alike(said)) {
        say(t, "%s", reads ? " " : "");
        say_names(t, &said->part[0]);
    }
    for (size_t i = 0; reads && alike(said) && i < said->n_parts; i++) {
        say(t, "%s", i ? ", " : " of ");
        say_servo(t, said->part[i].id);
    }
}

/* One that has its registers in its head: what it reads, does or returns beside values. */
static void say_headed(text *t, const grobo_telegram *said)
{
    if (said->reply) {
        say_who(t, said);
        say(t, " returns");
        if (said->n_parts > 0) {
            say(t, " ");
            say_span(t, said->address, said->length);
            say(t, ": ");
        }
    } else if (strcmp(said->action, "read") == 0) {
        say(t, "read ");
        say_span(t, said->address, said->length);
        say(t, " of ");
        say_who(t, said);
    } else if (said->bare || said->n_parts == 0) {
        say(t, "%s ", strcmp(said->action, "nothing") == 0 ? "nothing for" : said->action);
        say_who(t, said);
    } else {
        say(t, "write ");
        say_who(t, said);
        say(t, ": ");
    }
}

static void say_one(text *t, const grobo_telegram *said)
{
    const grobo_telegram_part *part = said->n_parts > 0 ? &said->part[0] : NULL;
    if (said->headed) {
        say_headed(t, said);
    } else if (said->reply) {
        say_who(t, said);
        say(t, "%s", part ? " returns " : " answers");
    } else if (part && !part->data) {
        say(t, "%s ", said->action);
        say_names(t, part);
        say(t, " of ");
        say_who(t, said);
        return;
    } else {
        say(t, "%s ", said->action);
        say_who(t, said);
        say(t, "%s", part && part->length > 0 ? ": " : "");
    }
    for (size_t i = 0; i < said->n_parts && !said->bare; i++) {
        say(t, "%s", i ? ", " : "");
        say_values(t, &said->part[i], !said->reply && !is_numbered(t));
    }
}

static void say_sum(text *t, const frame *f, const grobo_telegram *said)
{
    char bad[64];
    const char *name = said->sum_bytes == 2 ? "CRC" : "sum";
    int digits = 2 * said->sum_bytes;
    if (said->sum_bytes == 0) {
        return;
    }
    if (f->sum_ok) {
        say(t, "; %s %0*X right", name, digits, said->sum);
        return;
    }
    if (said->right_sum >= 0) {
        snprintf(bad, sizeof bad, "%s %0*X wrong, should be %0*X", name, digits, said->sum, digits,
                 (unsigned)said->right_sum);
    } else {
        snprintf(bad, sizeof bad, "%s %0*X wrong", name, digits, said->sum);
    }
    say(t, "; ");
    say_bad(t, bad);
}

int explain_expects(const frame *f, grobo_reply *reply)
{
    grobo_reply carried;
    *reply = (grobo_reply){.kind = GROBO_REPLY_NONE};
    if (f->kind > FRAME_ECHO || f->as.reply) {
        return GROBO_ERR_TYPE;
    }
    int known = frame_reply(f, reply);
    if (known == GROBO_ERR_FRAME && f->as.relay && f->talk->words->carried &&
        f->talk->words->carried(f->bytes, f->size, &carried) >= 0) {
        *reply = carried;
        return GROBO_ERR_MISMATCH;
    }
    return known;
}

static void say_reply(text *t, const frame *f)
{
    grobo_reply reply;
    char bad[80];
    int known = explain_expects(f, &reply);
    bool silent =
        known == GROBO_ERR_TYPE || known == GROBO_ERR_CHECKSUM || known == GROBO_ERR_FRAME;
    if (f->kind == FRAME_ECHO || silent ||
        (known < 0 && known != GROBO_ERR_MISMATCH && !is_numbered(t))) {
        return;
    }
    say(t, "; ");
    if (known == GROBO_ERR_MISMATCH) {
        snprintf(bad, sizeof bad, "but the packet is answered by %u bytes", reply.bytes);
        say_bad(t, bad);
    } else if (known < 0) {
        say_bad(t, "asks for registers that do not exist");
    } else if (reply.kind == GROBO_REPLY_NONE) {
        say(t, "no reply");
    } else if (reply.kind == GROBO_REPLY_ACK) {
        say(t, "reply: ACK");
    } else if (reply.kind == GROBO_REPLY_ANY) {
        say(t, "reply: of each that is there");
    } else {
        say(t, "reply: %u bytes", reply.bytes);
    }
}

/* One that says nothing but this. */
static void say_plain(text *t, const grobo_telegram *said)
{
    if (said->bad) {
        say_bad(t, said->plain);
    } else {
        say(t, "%s", said->plain);
    }
    say_hex(t, said->rest, said->n_rest);
}

static void say_content(text *t, const grobo_telegram *said)
{
    if (!said->action) {
        char bad[48];
        snprintf(bad, sizeof bad, "unknown instruction %02X", said->code);
        say_bad(t, bad);
        say(t, " to ");
        say_who(t, said);
    } else if (said->shares) {
        say_many(t, said);
    } else {
        say_one(t, said);
    }
    if (said->then) {
        say(t, ", then %s", said->then);
    }
    if (said->remark) {
        say(t, ", %s", said->remark);
    }
}

void explain_say(text *t, const frame *f, const grobo_telegram *said)
{
    const char *comma = "; ";
    say(t, "%s", said->relay.lead);
    if (said->plain) {
        say_plain(t, said);
        say_reply(t, f);
        return;
    }
    say_content(t, said);
    for (size_t i = 0; i < said->n_status; i++) {
        say(t, "%s", comma);
        say_bad(t, said->status[i].text);
        comma = ", ";
    }
    if (*said->trouble) {
        say(t, "; ");
        say_bad(t, said->trouble);
    }
    say_sum(t, f, said);
    say_reply(t, f);
}

void explain_shares(text *t, const grobo_telegram *said)
{
    for (size_t i = 0; has_lines(said) && i < said->n_parts; i++) {
        say(t, "    ");
        say_servo(t, said->part[i].id);
        say(t, ": ");
        if (said->part[i].data && said->part[i].length > 0) {
            say_values(t, &said->part[i], !said->reply && !is_numbered(t));
        } else {
            say_names(t, &said->part[i]);
        }
        say(t, "\n");
    }
}

/* ---- what is wrong --------------------------------------------------------------------------- */

static bool is_wrong(const explain_item *i, char *why, size_t capacity)
{
    if (i->reg && (i->reg->flags & GROBO_REGISTER_W) == 0) {
        snprintf(why, capacity, "it writes %s, which is read-only", i->reg->name);
        return true;
    }
    if (i->whole && (i->value < i->reg->min || i->value > i->reg->max)) {
        snprintf(why, capacity, "%s %d is outside %d..%d", i->reg->name, (int)i->value,
                 (int)i->reg->min, (int)i->reg->max);
        return true;
    }
    return false;
}

const char *explain_offence(const talk *who, const uint8_t *bytes, size_t n,
                            const grobo_telegram *said, char *why, size_t capacity)
{
    const char *code = who->words->offence ? who->words->offence(bytes, n, why, capacity) : NULL;
    if (code || said->plain || said->bare) {
        return code;
    }
    if (!said->action || *said->trouble) {
        snprintf(why, capacity, "%s", said->action ? said->trouble : "no servo has this command");
        return "request";
    }
    for (size_t k = 0; k < said->n_parts; k++) {
        const grobo_telegram_part *part = &said->part[k];
        for (int at = 0; part->data && part->address >= 0 && at < part->length;) {
            const explain_item i = item_of(who, part, at);
            if (i.whole && is_wrong(&i, why, capacity)) {
                return "range";
            }
            at += i.bytes;
        }
    }
    return NULL;
}

/* ---- JSON ---------------------------------------------------------------------------------- */

json_t *explain_part(const talk *who, const grobo_servo_model *servo,
                     const grobo_telegram_part *part)
{
    json_t *registers = json_object();
    json_t *other = json_object();
    for (int at = 0; part->data && at < part->length;) {
        char key[REGISTERS_TEXT_BYTES];
        const explain_item i = explain_item_at(servo, part, at);
        if (i.whole) {
            registers_key(i.reg, key, sizeof key);
            json_object_set_new(registers, key, registers_json(i.servo, i.reg, i.value));
        } else if (i.reg || i.value || part->address < 0) {
            snprintf(key, sizeof key, "%d", part->address < 0 ? at : i.address);
            json_object_set_new(other, key, json_integer(i.value));
        }
        at += i.bytes;
    }
    bool others = json_object_size(other) > 0;
    bool asks = !part->data;
    json_t *o =
        json_pack("{s:i,s:s?,s:o*,s:o*,s:o,s:O*}", "id", part->id, "name",
                  talk_joint(who, part->id), "address", asks ? json_integer(part->address) : NULL,
                  "length", asks ? json_integer(part->length) : NULL, "registers", registers,
                  "other_bytes", others ? other : NULL);
    json_decref(other);
    return o;
}

static json_t *status_json(const grobo_telegram *said)
{
    json_t *status = json_array();
    for (size_t i = 0; i < said->n_status; i++) {
        const grobo_telegram_status *is = &said->status[i];
        json_array_append_new(status, json_string(is->key ? is->key : is->text));
    }
    return status;
}

json_t *explain_packet(const frame *f, const grobo_telegram *said)
{
    char unknown[32];
    if (said->plain) {
        return NULL;
    }
    json_t *servos = json_array();
    snprintf(unknown, sizeof unknown, "instruction %02X", said->code);
    for (size_t i = 0; i < said->n_parts; i++) {
        const grobo_telegram_part *part = &said->part[i];
        json_array_append_new(servos, explain_part(f->talk, talk_servo(f->talk, part->id), part));
    }
    bool named = said->id >= 0 && (!said->all || said->headed);
    const char *kind = said->reply ? "return" : "command";
    json_t *o = json_pack("{s:s,s:s,s:o*,s:i}", "kind", said->kind ? said->kind : kind, "action",
                          said->action ? said->action : unknown, "id",
                          named ? json_integer(said->id) : NULL, "flags", (int)said->code);
    if (said->headed) {
        json_object_set_new(o, "address", json_integer(said->header[0]));
        json_object_set_new(o, "length", json_integer(said->header[1]));
        json_object_set_new(o, "count", json_integer(said->header[2]));
    }
    json_t *rest = json_pack(
        "{s:o*,s:b,s:o*,s:o*,s:o*,s:o}", "sum", said->sum_bytes ? json_integer(said->sum) : NULL,
        "sum_ok", f->sum_ok, "right_sum",
        f->sum_ok || said->right_sum < 0 ? NULL : json_integer(said->right_sum), "status",
        said->reply ? status_json(said) : NULL, "trouble",
        *said->trouble ? json_string(said->trouble) : NULL, "servos", servos);
    json_object_update(o, rest);
    json_decref(rest);
    return o;
}
