/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>

#include "tools/grctl/conn/family.h"

char family_names[FAMILY_NAMES_BYTES];
char family_or_all[FAMILY_NAMES_BYTES] = "all";
char family_series[FAMILY_NAMES_BYTES];

/* Another word of a choice. */
static void add_name(char *names, const char *name)
{
    size_t n = strlen(names);
    (void)snprintf(names + n, FAMILY_NAMES_BYTES - n, "%s%s", n > 0 ? "|" : "", name);
}

void family_list(void)
{
    for (const grobo_family *f = grobo_families(); f->robot; f++) {
        add_name(family_names, f->robot->name);
        add_name(family_or_all, f->robot->name);
        for (const grobo_words *const *words = f->words; *words; words++) {
            add_name(family_series, (*words)->name);
        }
    }
}

const grobo_robot_family *family_called(const char *name)
{
    for (size_t i = 0; grobo_robot_family_at(i); i++) {
        if (strcmp(grobo_robot_family_at(i)->name, name) == 0) {
            return grobo_robot_family_at(i);
        }
    }
    return NULL;
}

static bool has_rate(const grobo_robot_family *family, int32_t bps)
{
    const grobo_servo_table *table = family->tables[0];
    for (int i = 0; i < table->rate_count; i++) {
        if (table->rates[i].bps == bps) {
            return true;
        }
    }
    return false;
}

int family_usual_bps(const grobo_robot_family *family, size_t i)
{
    static const int32_t usual[] = {1000000, 57600, 115200, 3000000};
    if (i == 0) {
        return (int)family->baud_bps;
    }
    for (size_t k = 0; k < sizeof usual / sizeof *usual; k++) {
        if (usual[k] != (int32_t)family->baud_bps && has_rate(family, usual[k]) && --i == 0) {
            return usual[k];
        }
    }
    return 0;
}

const grobo_driver *family_driver(const grobo_robot_family *family)
{
    static grobo_driver driver = GROBO_TABLE_INIT(grobo_driver);
    static grobo_joint joint;
    static const grobo_group all = {.name = "all", .joints = 1};
    static const grobo_model model =
        GROBO_TABLE(grobo_model, .name = "any", GROBO_MODEL_JOINTS(&joint), .groups = &all,
                    .n_joints = 1, .n_groups = 1);
    joint = (grobo_joint){.name = "any",
                          .min_rad = -0.1,
                          .max_rad = 0.1,
                          .max_speed_rad_s = 1,
                          .servo_model = family->tables[0]->models[0].number,
                          .mirror_sign = 1};
    int (*init)(grobo_driver *, const grobo_model *) = family->init[GROBO_WIRING_BUS];
    if (init(&driver, &model) < 0) {
        return NULL;
    }
    joint.motor = driver.protocol->id_max;
    return init(&driver, &model) < 0 ? NULL : &driver;
}

/* The family of a driver's servos; behind a board are RS30x. NULL: one of the driver's own. A
 * protocol is known by its name: a family may have one that differs in its delay alone. */
static const grobo_robot_family *family_of_driver(const grobo_driver *driver)
{
    static const grobo_protocol *known[16]; /* of the families */
    const grobo_protocol *wanted =
        driver->protocol->relay ? grobo_rs30x_protocol() : driver->protocol;
    for (size_t i = 0; grobo_robot_family_at(i) && i < sizeof known / sizeof *known; i++) {
        const grobo_driver *any = known[i] ? NULL : family_driver(grobo_robot_family_at(i));
        known[i] = any ? any->protocol : known[i];
        if (known[i] && strcmp(known[i]->name, wanted->name) == 0) {
            return grobo_robot_family_at(i);
        }
    }
    return NULL;
}

const grobo_robot_family *family_of_servo(const grobo_servo_model *servo)
{
    const grobo_servo_table *table;
    for (size_t f = 0; grobo_robot_family_at(f); f++) {
        for (size_t i = 0; (table = grobo_robot_family_at(f)->tables[i]) != NULL; i++) {
            if (table == grobo_servo_series(servo)) {
                return grobo_robot_family_at(f);
            }
        }
    }
    return NULL;
}

bool family_is(const grobo_driver *driver, const char *name)
{
    const grobo_robot_family *family = family_of_driver(driver);
    return family && strcmp(family->name, name) == 0;
}

const grobo_servo_model *family_model(const grobo_robot_family *family, const char *name)
{
    const grobo_servo_table *table;
    for (size_t i = 0; (table = family->tables[i]) != NULL; i++) {
        for (int m = 0; m < table->model_count; m++) {
            if (strcmp(table->models[m].name, name) == 0) {
                return &table->models[m];
            }
        }
    }
    return NULL;
}

/* The servo of this number that a joint of the robot has; NULL: none. */
static const grobo_servo_model *robot_numbered(const grobo_driver *driver, uint16_t number)
{
    for (int j = 0; j < driver->model->n_joints; j++) {
        const grobo_servo_model *servo = grobo_model_joint(driver->model, j)->servo;
        if (servo && servo->number == number) {
            return servo;
        }
    }
    return NULL;
}

const grobo_servo_model *family_numbered(const grobo_driver *driver, uint16_t number)
{
    const grobo_robot_family *family = family_of_driver(driver);
    const grobo_servo_model *found = robot_numbered(driver, number);
    const grobo_servo_table *table;
    for (size_t i = 0; family && !found && (table = family->tables[i]) != NULL; i++) {
        found = grobo_servo_model_numbered(table, number);
    }
    return found;
}

const grobo_servo_model *family_joint_servo(const grobo_driver *driver, int joint)
{
    const grobo_joint *of = grobo_model_joint(driver->model, joint);
    return of->servo ? of->servo : family_numbered(driver, of->servo_model);
}

bool family_is_any(const grobo_servo_model *servo)
{
    return servo->number == 0 && (servo->flags & GROBO_MODEL_NO_JOINT) != 0;
}

/* What all servos of a family have, where the library describes that; else its first model. */
static const grobo_servo_model *any_of(const grobo_robot_family *family)
{
    const grobo_servo_table *table = family->tables[0];
    for (int m = 0; m < table->model_count; m++) {
        if (family_is_any(&table->models[m])) {
            return &table->models[m];
        }
    }
    return &table->models[0];
}

const grobo_servo_model *family_servo(const grobo_driver *driver, int id)
{
    int joint = grobo_model_joint_of_motor(driver->model, id);
    const grobo_robot_family *family = family_of_driver(driver);
    const grobo_servo_model *found = joint < 0 ? NULL : family_joint_servo(driver, joint);
    return found || !family ? found : joint < 0 ? any_of(family) : &family->tables[0]->models[0];
}

const grobo_servo_model *family_identify(const grobo_driver *driver, const uint8_t *bytes)
{
    const grobo_robot_family *family = family_of_driver(driver);
    const grobo_servo_model *found = NULL;
    const grobo_servo_table *table;
    for (size_t i = 0; family && !found && (table = family->tables[i]) != NULL; i++) {
        const grobo_servo_model *any = &table->models[0];
        const grobo_servo_register *model = grobo_servo_register_of(any, GROBO_ROLE_MODEL);
        uint16_t number = (uint16_t)grobo_servo_register_get(any, model, bytes);
        found = robot_numbered(driver, number);
        found = found && grobo_servo_series(found) == table
                    ? found
                    : grobo_servo_model_numbered(table, number);
    }
    return found;
}

static bool can_read(const grobo_driver *driver, int address, int length)
{
    const grobo_register_io io = {.id = grobo_model_joint(driver->model, 0)->motor,
                                  .address = (uint16_t)address,
                                  .length = (uint16_t)length};
    grobo_exchange exchange = {0};
    return driver->registers && length > 0 && length <= FAMILY_PIECE_BYTES &&
           driver->registers(driver, NULL, &io, &exchange) >= 0;
}

int family_piece(const grobo_driver *driver, const grobo_servo_model *servo,
                 const grobo_servo_register *reg, uint16_t *address)
{
    const grobo_servo_register *from, *to;
    int end = 0;
    for (size_t i = 0; (from = grobo_servo_register_row(servo, i)) != NULL; i++) {
        int begin = from->address > reg->address ? reg->address : from->address;
        for (size_t k = 0; (to = grobo_servo_register_row(servo, k)) != NULL; k++) {
            int this_end = to->address + to->bytes;
            bool holds = this_end >= reg->address + reg->bytes;
            bool shorter = end == 0 || this_end - begin < end - *address;
            if (holds && shorter && can_read(driver, begin, this_end - begin)) {
                *address = (uint16_t)begin;
                end = this_end;
            }
        }
    }
    return end ? end - *address : 0;
}

int family_block(const grobo_driver *driver, const grobo_servo_model *servo, size_t first, int most)
{
    const grobo_servo_register *begin = grobo_servo_register_row(servo, first), *reg = begin;
    int n = 0;
    for (int k = 1; reg; k++) {
        int length = reg->address + reg->bytes - begin->address;
        if ((length <= most || n == 0) && can_read(driver, begin->address, length)) {
            n = k;
        }
        reg = grobo_servo_register_row(servo, first + (size_t)k);
    }
    return n;
}

int family_identity(const grobo_driver *driver, const grobo_servo_model *servo, uint16_t *address)
{
    const grobo_servo_register *a = grobo_servo_register_of(servo, GROBO_ROLE_MODEL);
    const grobo_servo_register *b = grobo_servo_register_of(servo, GROBO_ROLE_FIRMWARE);
    const grobo_servo_register *id = grobo_servo_register_of(servo, GROBO_ROLE_ID);
    if (!a || !b) {
        return a || id ? family_piece(driver, servo, a ? a : id, address) : 0;
    }
    int end = a->address + a->bytes > b->address + b->bytes ? a->address + a->bytes
                                                            : b->address + b->bytes;
    *address = a->address < b->address ? a->address : b->address;
    return end - *address;
}
