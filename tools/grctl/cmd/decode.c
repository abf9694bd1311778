/* SPDX-License-Identifier: MIT */
#include <string.h>
#include <time.h>

#include <grobo/core/lines.h>

#include "tools/grctl/cli/file.h"
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/conn/family.h"
#include "tools/grctl/conn/trace.h"
#include "tools/grctl/decode/decoder.h"
#include "tools/grctl/decode/hextext.h"

enum { HEX_BYTES = 65536 };
enum { OPT_FAMILY };

static const cli_option options[] = {
    [OPT_FAMILY] = OPTION_CHOICE("family", 0, family_series, "family of the servos (the robot's)"),
};

static unsigned wiring_of(const app *a)
{
    const cli_value *wiring = app_global(a, GLOBAL_WIRING);
    if (!wiring->given) {
        return FRAMES_ANY_WIRING;
    }
    return (grobo_wiring)wiring->choice == GROBO_WIRING_BOARD ? GROBO_WORDS_BOARD : GROBO_WORDS_BUS;
}

/* ---- a trace ------------------------------------------------------------------------------- */

/* What the trace says of one line: of one of several its name too. */
static void print_line(const decoder *d, const pcapng_reader *r, const pcapng_interface *i,
                       const char *started)
{
    bool several = r->n_interfaces > 1;
    const char *device = i->name, *line = i->description;
    char family[PCAPNG_TEXT_BYTES];
    if (!d->a->json) {
        app_note(d->a, "%s%s%s%s%s, %llu bps, begun %s", r->comment, *r->comment ? ": " : "",
                 i->name, *i->description ? ", " : "", i->description,
                 (unsigned long long)i->speed_bps, started);
        return;
    }
    if (several && trace_family(i, family, sizeof family, &device)) {
        line = family;
    }
    app_json_line(several ? i->name : NULL);
    app_print_json(json_pack("{s:{s:o,s:o,s:o,s:I,s:s}}", "trace", "comment",
                             app_json_text(r->comment), "device", app_json_text(device), "line",
                             app_json_text(line), "baud_bps", (json_int_t)i->speed_bps, "started",
                             started));
    app_json_line(NULL);
}

/* What the trace says of itself. */
static void print_head(const decoder *d, const pcapng_reader *r, const pcapng_chunk *first)
{
    time_t seconds = (time_t)(first->time_us / 1000000);
    const struct tm *utc = gmtime(&seconds);
    char started[40] = "";
    if (utc) {
        strftime(started, sizeof started, "%Y-%m-%dT%H:%M:%SZ", utc);
    }
    for (unsigned i = 0; i < r->n_interfaces; i++) {
        print_line(d, r, &r->interfaces[i], started);
    }
}

static void print_comment(const decoder *d, const pcapng_chunk *chunk)
{
    double time_ms = (double)(chunk->time_us - d->first_us) / 1e3;
    if (d->a->json) {
        app_print_json(json_pack("{s:o,s:o}", "time_ms", app_json_number(time_ms, 3), "comment",
                                 app_json_text(chunk->comment)));
    } else {
        app_print_line("%10.3f  %-7s  %s", time_ms, "comment", chunk->comment);
    }
}

static frames_side side_of(pcapng_direction direction)
{
    switch (direction) {
    case PCAPNG_OUT:
        return FRAMES_HOST;
    case PCAPNG_IN:
        return FRAMES_ROBOT;
    case PCAPNG_UNKNOWN:
        break;
    }
    return FRAMES_EITHER;
}

/* ---- a trace of several lines ---------------------------------------------------------------- */

/* Each line has a decoder of its own: made with its first bytes. */
static decoder lines[PCAPNG_INTERFACES_MAX];

static const char *series_of(const grobo_driver *driver)
{
    int id = grobo_model_joint(driver->model, 0)->motor;
    const grobo_words *own = talk_of_servo(family_servo(driver, id));
    return own ? own->name : "rs30x";
}

/* The line of this name and family of the robot; NULL: it has none. */
static const grobo_driver *own_line(const app *a, const char *name, const char *family)
{
    const grobo_lines *own = grobo_driver_lines(app_driver(a));
    for (int i = 0; own && i < own->n_lines; i++) {
        const grobo_driver *driver = &own->line[i].driver;
        if (own->line[i].name && strcmp(own->line[i].name, name) == 0 &&
            family_is(driver, family)) {
            return driver;
        }
    }
    return NULL;
}

/* Who is on it: as --family says, else the robot's line of that name, else its family. */
static void make_line(decoder *d, const decoder *all, const pcapng_interface *interface)
{
    app *a = all->a;
    const cli_value *given = app_option(a, OPT_FAMILY);
    char family[PCAPNG_TEXT_BYTES] = "";
    const char *device;
    bool told = trace_family(interface, family, sizeof family, &device);
    const grobo_driver *own = told ? own_line(a, interface->name, family) : NULL;
    const grobo_driver *driver = own ? own : app_driver(a);
    const char *series = given->given                 ? given->text
                         : !own && talk_named(family) ? family
                                                      : series_of(driver);
    decoder_init(d, a, wiring_of(a), driver, series);
    d->timed = d->begun = true;
    d->first_us = all->first_us;
}

static void feed_line(const decoder *all, const pcapng_reader *r, const pcapng_chunk *chunk)
{
    decoder *its = &lines[chunk->interface - r->interfaces];
    if (!its->a) {
        make_line(its, all, chunk->interface);
    }
    for (decoder *d = lines; d < lines + PCAPNG_INTERFACES_MAX; d++) {
        if (d->a) {
            d->line = r->interfaces[d - lines].name;
            decoder_pass(d, chunk->time_us);
        }
    }
    decoder_feed(its, side_of(chunk->direction), chunk->time_us, chunk->bytes, chunk->size);
}

static void end_lines(decoder *all)
{
    for (decoder *d = lines; d < lines + PCAPNG_INTERFACES_MAX; d++) {
        if (d->a) {
            decoder_end(d);
            decoder_add(all, d);
        }
    }
}

/* A pcapng trace. Returns 0 or the exit status. */
static int decode_trace(decoder *d, input *in)
{
    static pcapng_reader reader;
    pcapng_chunk chunk;
    int more;
    d->timed = true;
    pcapng_reader_init(&reader, input_read, in);
    while ((more = pcapng_read(&reader, &chunk)) > 0) {
        if (!d->begun) {
            print_head(d, &reader, &chunk);
            d->first_us = chunk.time_us;
            d->begun = true;
        }
        if (reader.n_interfaces > 1) {
            feed_line(d, &reader, &chunk);
        } else {
            decoder_feed(d, side_of(chunk.direction), chunk.time_us, chunk.bytes, chunk.size);
        }
        if (*chunk.comment) {
            print_comment(d, &chunk);
        }
    }
    end_lines(d);
    if (more < 0) {
        decoder_end(d);
        return input_fail(in, d->a, &reader);
    }
    return 0;
}

/* ---- the command --------------------------------------------------------------------------- */

static int decode_file(decoder *d, const char *path)
{
    input in;
    int status = input_open(&in, d->a, path);
    if (status) {
        return status;
    }
    status = input_is_pcapng(&in) ? decode_trace(d, &in) : decode_text(d, &in);
    input_close(&in);
    decoder_end(d);
    if (!status) {
        decoder_summary(d);
    }
    return status ? status : decoder_status(d);
}

/* One name of a file, rather than hex: it is no hex and looks like a path or is there. */
static bool is_file(const app *a)
{
    const char *name = a->line.argument[0];
    uint8_t bytes[1];
    size_t at;
    if (a->line.n_arguments != 1) {
        return false;
    }
    if (strcmp(name, "-") == 0) {
        return true;
    }
    int n = hextext_parse(name, bytes, sizeof bytes, &at);
    if (n == 1 || n == GROBO_ERR_CAP) {
        return strpbrk(name, "/.") != NULL;
    }
    return file_is_there(name) || strpbrk(name, "/.");
}

static int decode_arguments(decoder *d)
{
    static uint8_t bytes[HEX_BYTES];
    app *a = d->a;
    size_t used = 0;
    for (int i = 0; i < a->line.n_arguments; i++) {
        const char *text = a->line.argument[i];
        size_t at = 0;
        int n = hextext_parse(text, bytes + used, sizeof bytes - used, &at);
        if (n == GROBO_ERR_CAP) {
            return app_fail(a, EXIT_USAGE, "CAP", "decode: more than %d bytes; use a file",
                            HEX_BYTES);
        }
        if (n < 0) {
            return app_fail(a, EXIT_USAGE, "SYNTAX",
                            "decode: '%.*s' is neither a byte in hex nor a file",
                            hextext_word(text + at) > 40 ? 40 : hextext_word(text + at), text + at);
        }
        used += (size_t)n;
    }
    if (used == 0) {
        return app_fail(a, EXIT_USAGE, "EMPTY", "decode: no bytes");
    }
    decoder_feed(d, FRAMES_EITHER, 0, bytes, used);
    decoder_end(d);
    return decoder_status(d);
}

static int run(app *a)
{
    static decoder d;
    const cli_value *given = app_option(a, OPT_FAMILY);
    decoder_init(&d, a, wiring_of(a), app_driver(a),
                 given->given ? given->text : series_of(app_driver(a)));
    if (a->line.n_arguments == 0) {
        return decode_file(&d, "-");
    }
    return is_file(a) ? decode_file(&d, a->line.argument[0]) : decode_arguments(&d);
}

const cli_command cmd_decode = {
    .name = "decode",
    COMMAND_ARGUMENTS("[HEX | FILE]", 0, -1, CLI_ARG_FILE),
    .summary = "explain frames, from hex or a trace",
    .details =
        "Explains bytes: frames of the board, packets to and from servos, registers by name and\n"
        "in their units, whether the sum is right, which reply is expected. --family names the\n"
        "family of the packets: Futaba (rs30x), DYNAMIXEL 2.0 and 1.0 (dynamixel2, dynamixel1),\n"
        "Feetech STS and SMS (feetech) and SCS (scs), Hiwonder (lx16a), Kondo (ics); by default\n"
        "it is that of the robot. In most families a reply does not name its registers: the\n"
        "request before it does. Registers are those of the servo's model where the robot or the\n"
        "bytes name it, else of the first model of the family. Bytes that are no frame are shown\n"
        "as they are. The bytes come as hex on the command line (with or without blanks), from a\n"
        "file or standard input of hex, from the output of 'play --dry-run', or from a trace of\n"
        "--trace; of a robot of several lines it names the line of each frame, and with --robot\n"
        "its joints. A name that is hex is read as hex: write ./cafe for a file. The exit status\n"
        "is 3 if a frame had a wrong sum or was cut off.\n"
        "-v shows the bytes too. --wiring selects how the host's frames are read; without it\n"
        "board frames and bare packets are both recognized.\n",
    .example = "  grctl decode 53 0C FA AF 03 00 1E 04 01 F6 FF 00 00 11\n"
               "  grctl play --dry-run motions/greet.pseq | grctl decode\n"
               "  grctl decode walk.pcapng\n"
               "  grctl decode --family dynamixel2 FF FF FD 00 01 03 00 01 19 4E\n",
    COMMAND_OPTIONS(options),
    .run = run,
};
