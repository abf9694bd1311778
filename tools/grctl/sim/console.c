/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <string.h>

#include <grobo/core/sim.h>

#include "tools/grctl/lang/lang.h"
#include "tools/grctl/sim/console.h"

static grobo_sim *sim_of(const sim_console *console)
{
    return grobo_sim_server_sim(console->server[console->robot]);
}

static const grobo_model *model_of(const sim_console *console)
{
    return console->model[console->robot];
}

/* ---- words ----------------------------------------------------------------------------------- */

static bool is_word(const sim_console *console, int i, const char *word)
{
    return i < console->n_words && strcmp(console->word[i], word) == 0;
}

static bool read_number(const sim_console *console, int i, double min, double max, double *number)
{
    return i < console->n_words && cli_read_number(console->word[i], number) && *number >= min &&
           *number <= max;
}

/* A servo by motor number, or any name of joints: 12, m12, R_KNEE_P, legs. */
static bool read_servos(const sim_console *console, grobo_joint_mask *joints)
{
    double motor;
    if (console->n_words < 2) {
        return false;
    }
    if (!cli_read_number(console->word[1], &motor)) {
        return grobo_model_find_joints(model_of(console), console->word[1],
                                       strlen(console->word[1]), joints) > 0;
    }
    int joint = grobo_model_joint_of_motor(model_of(console), (int)motor);
    if (joint < 0) {
        return false;
    }
    *joints = GROBO_JOINT_BIT(joint);
    return true;
}

static bool read_switch(const sim_console *console, int i, bool *on)
{
    *on = is_word(console, i, "on");
    return *on || is_word(console, i, "off");
}

/* ---- what can be done ------------------------------------------------------------------------ */

/* Does something to one servo; false: the words do not say what. */
typedef bool (*servo_fn)(const sim_console *console, int servo);

static bool set_silent(const sim_console *console, int servo)
{
    bool on;
    return read_switch(console, 2, &on) &&
           grobo_sim_set_cable(sim_of(console), servo,
                               on ? GROBO_SIM_CABLE_MUTE : GROBO_SIM_CABLE_IN) == 0;
}

static bool set_cable(const sim_console *console, int servo)
{
    grobo_sim_cable cable = is_word(console, 2, "mute")  ? GROBO_SIM_CABLE_MUTE
                            : is_word(console, 2, "out") ? GROBO_SIM_CABLE_OUT
                                                         : GROBO_SIM_CABLE_IN;
    return (cable != GROBO_SIM_CABLE_IN || is_word(console, 2, "in")) &&
           grobo_sim_set_cable(sim_of(console), servo, cable) == 0;
}

static bool set_blocked(const sim_console *console, int servo)
{
    bool on;
    return read_switch(console, 2, &on) && grobo_sim_set_blocked(sim_of(console), servo, on) == 0;
}

static bool turn(const sim_console *console, int servo)
{
    double deg, ms = 0;
    if (!read_number(console, 2, -180, 180, &deg) ||
        (console->n_words > 3 && !read_number(console, 3, 0, 60000, &ms))) {
        return false;
    }
    return grobo_sim_set_angle(sim_of(console), servo, (int32_t)lround(deg * 1000),
                               (int64_t)(ms * 1000)) == 0;
}

static bool set_load(const sim_console *console, int servo)
{
    double ma;
    return read_number(console, 2, 0, 5000, &ma) &&
           grobo_sim_set_load(sim_of(console), servo, (int32_t)ma) == 0;
}

static bool push(const sim_console *console, int servo)
{
    double nm;
    return read_number(console, 2, -100, 100, &nm) &&
           grobo_sim_push(sim_of(console), servo, nm) == 0;
}

static bool set_wall(const sim_console *console, int servo)
{
    double min, max;
    if (is_word(console, 2, "off")) {
        return grobo_sim_set_wall(sim_of(console), servo, INT32_MIN, INT32_MAX) == 0;
    }
    return read_number(console, 2, -180, 180, &min) && read_number(console, 3, -180, 180, &max) &&
           grobo_sim_set_wall(sim_of(console), servo, (int32_t)lround(min * 1000),
                              (int32_t)lround(max * 1000)) == 0;
}

static bool set_temperature(const sim_console *console, int servo)
{
    double c;
    return read_number(console, 2, -40, 150, &c) &&
           grobo_sim_set_temperature(sim_of(console), servo, c) == 0;
}

static bool set_id(const sim_console *console, int servo)
{
    double id;
    return read_number(console, 2, 0, GROBO_SERVO_ID_MAX, &id) &&
           grobo_sim_set_id(sim_of(console), servo, (int)id) == 0;
}

static const struct {
    const char *name;
    servo_fn act;
    const char *usage;
} servo_commands[] = {
    {"silent", set_silent, "silent SERVO on|off"},
    {"cable", set_cable, "cable SERVO in|mute|out"},
    {"block", set_blocked, "block SERVO on|off"},
    {"turn", turn, "turn SERVO DEG [MS]"},
    {"load", set_load, "load SERVO MA (0 to 5000)"},
    {"push", push, "push SERVO NM (-100 to 100)"},
    {"wall", set_wall, "wall SERVO MIN MAX|off"},
    {"temperature", set_temperature, "temperature SERVO C (-40 to 150)"},
    {"id", set_id, "id SERVO ID (1 to 127)"},
};

static const char *act_on_servos(const sim_console *console, size_t i)
{
    grobo_joint_mask joints;
    if (!read_servos(console, &joints)) {
        return servo_commands[i].usage;
    }
    for (int servo = 0; servo < model_of(console)->n_joints; servo++) {
        if ((joints & GROBO_JOINT_BIT(servo)) && !servo_commands[i].act(console, servo)) {
            return servo_commands[i].usage;
        }
    }
    return NULL;
}

static void say_servo(const sim_console *console, int servo)
{
    static const char *const cables[] = {"", N_(", mute"), N_(", cable out")};
    static const char *const torques[] = {"off", "on", "brake"};
    grobo_sim_view v;
    if (grobo_sim_look(sim_of(console), servo, &v) < 0) {
        return;
    }
    app_note(console->a, "%3d  %-12s  %7.1f deg  to %7.1f  torque %-5s  %4d mA  %5.1f C%s%s%s",
             (int)v.id, grobo_model_joint(model_of(console), servo)->name, v.angle_mdeg / 1e3,
             v.target_mdeg / 1e3, torques[v.torque], (int)v.current_ma, v.temperature_c,
             _(cables[v.cable]), v.moving ? _(", moving") : "", v.stalled ? _(", stalled") : "");
}

static const char *look(sim_console *console)
{
    grobo_joint_mask joints = GROBO_JOINTS_ALL(model_of(console)->n_joints);
    if (console->n_words > 1 && !read_servos(console, &joints)) {
        return "look [SERVO]";
    }
    grobo_sim_step(sim_of(console), grobo_now_us());
    for (int servo = 0; servo < model_of(console)->n_joints; servo++) {
        if (joints & GROBO_JOINT_BIT(servo)) {
            say_servo(console, servo);
        }
    }
    return NULL;
}

static const char *choose_robot(sim_console *console)
{
    double number;
    if (!read_number(console, 1, 1, console->n, &number)) {
        return _("robot N, one of those that run");
    }
    console->robot = (int)number - 1;
    return NULL;
}

static const char *set_voltage(sim_console *console)
{
    double v;
    if (!read_number(console, 1, 0, 20, &v)) {
        return "voltage V (0 to 20)";
    }
    grobo_sim_set_supply(sim_of(console), (uint32_t)lround(v * 1000));
    return NULL;
}

static const char *set_payload(sim_console *console)
{
    double kg;
    const char *link = console->n_words > 2 ? console->word[2] : console->payload_link;
    if (!read_number(console, 1, 0, 100, &kg) ||
        grobo_sim_set_payload(sim_of(console), link, kg) < 0) {
        return "payload KG [LINK] (0 to 100)";
    }
    return NULL;
}

static const char *set_resistance(sim_console *console)
{
    double mohm;
    if (!read_number(console, 1, 0, 100000, &mohm) ||
        grobo_sim_set_supply_mohm(sim_of(console), (uint32_t)mohm) < 0) {
        return "supply MOHM (0 to 100000)";
    }
    return NULL;
}

static const char *set_faults(sim_console *console)
{
    if (console->n_words < 2 ||
        grobo_sim_set_faults(sim_of(console), console->word[1], strlen(console->word[1])) < 0) {
        return "fault KIND=RATE,... (drop flip duplicate delay split rubbish silent dupid hangup "
               "brownout all; 0 to 1)";
    }
    return NULL;
}

static const char *plug(sim_console *console)
{
    bool in = is_word(console, 1, "in");
    if (!in && !is_word(console, 1, "out")) {
        return "plug in|out";
    }
    int error = grobo_sim_server_plug(console->server[console->robot], in);
    return error < 0 ? app_error_text(error) : NULL;
}

static const struct {
    const char *name;
    const char *(*act)(sim_console *console);
} commands[] = {
    {"look", look},        {"robot", choose_robot},  {"voltage", set_voltage},
    {"fault", set_faults}, {"payload", set_payload}, {"supply", set_resistance},
    {"plug", plug},
};

/* Whether a command needs a world with weight, and there is none. */
static bool lacks_weight(const sim_console *console)
{
    static const char *const heavy[] = {"push", "wall", "payload", "supply"};
    for (size_t i = 0; i < sizeof heavy / sizeof heavy[0]; i++) {
        if (is_word(console, 0, heavy[i])) {
            return grobo_sim_push(sim_of(console), 0, 0) == GROBO_ERR_UNSUPPORTED;
        }
    }
    return false;
}

/* NULL: done. Else how the command is to be said. */
static const char *carry_out(sim_console *console)
{
    if (lacks_weight(console)) {
        return _("this robot has no weight: its file has no masses, or --physics off");
    }
    for (size_t i = 0; i < sizeof servo_commands / sizeof servo_commands[0]; i++) {
        if (is_word(console, 0, servo_commands[i].name)) {
            return act_on_servos(console, i);
        }
    }
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++) {
        if (is_word(console, 0, commands[i].name)) {
            return commands[i].act(console);
        }
    }
    if (is_word(console, 0, "quit")) {
        event_base_loopbreak(console->base);
        return NULL;
    }
    return _("robot fault silent cable block turn load push wall payload temperature id voltage "
             "supply plug look quit; see "
             "'grctl help sim'");
}

/* ---- lines ----------------------------------------------------------------------------------- */

static bool split(sim_console *console)
{
    char *rest = console->line;
    console->n_words = 0;
    for (;;) {
        rest += strspn(rest, " \t\r");
        if (*rest == '\0' || *rest == '#') {
            return true;
        }
        if (console->n_words == (int)(sizeof console->word / sizeof console->word[0])) {
            return false;
        }
        console->word[console->n_words++] = rest;
        rest += strcspn(rest, " \t\r");
        if (*rest) {
            *rest++ = '\0';
        }
    }
}

static void on_line(sim_console *console)
{
    const char *usage;
    char said[SIM_CONSOLE_BYTES];
    snprintf(said, sizeof said, "%s", console->line);
    if (!split(console)) {
        usage = _("at most 4 words");
    } else if (console->n_words == 0) {
        return;
    } else {
        usage = carry_out(console);
    }
    if (usage) {
        app_note(console->a, "sim: '%s'? say: %s", said, usage);
    } else if (strcmp(console->word[0], "look") != 0) {
        app_note(console->a, "sim: %s", said);
    }
    grobo_sim_server_pump(console->server[console->robot]);
}

static void take(sim_console *console, char c)
{
    if (c != '\n') {
        if (console->used < sizeof console->line - 1) {
            console->line[console->used++] = c;
        } else {
            console->too_long = true;
        }
        return;
    }
    console->line[console->used] = '\0';
    console->used = 0;
    if (console->too_long) {
        app_note(console->a, "sim: a line of more than %d bytes is skipped", SIM_CONSOLE_BYTES - 1);
    } else {
        on_line(console);
    }
    console->too_long = false;
}

static void on_input(void *ctx, const char *bytes, size_t size)
{
    sim_console *console = ctx;
    if (!bytes) {
        app_note(console->a, "sim: standard input: %s", app_error_text(GROBO_ERR_NOMEM));
    }
    for (size_t i = 0; i < size; i++) {
        take(console, bytes[i]);
    }
}

bool sim_console_start(sim_console *console)
{
    return os_input_start(&console->input, console->base, on_input, console);
}

void sim_console_stop(sim_console *console)
{
    os_input_stop(&console->input);
}
