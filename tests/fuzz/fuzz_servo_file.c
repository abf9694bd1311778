/* SPDX-License-Identifier: MIT */
/* Any bytes as a servo model beside a robot's file: refused with a word, or a servo that can be
 * driven and simulated. The first byte chooses the family. */
#include <stdio.h>
#include <string.h>

#include <grobo/core/sim_static.h>

#include "src/robots/file/own.h"
#include "tests/fuzz/target.h"

typedef struct bytes {
    const uint8_t *at;
    size_t left;
} bytes;

static int read_bytes(void *ctx, void *buffer, size_t size)
{
    bytes *from = ctx;
    size_t n = from->left < size ? from->left : size;
    if (n > 0) {
        memcpy(buffer, from->at, n);
        from->at += n;
        from->left -= n;
    }
    return (int)n;
}

static int open_bytes(void *ctx, const char *path, grobo_source *source)
{
    MUST(strcmp(path, "servo.yaml") == 0);
    *source = (grobo_source){read_bytes, ctx};
    return 0;
}

static void close_bytes(void *ctx, const grobo_source *source)
{
    MUST(source->ctx == ctx);
}

/* Whether every register of a model is where a simulated servo can hold it. */
static void check_servo(const grobo_servo_model *servo)
{
    const grobo_servo_register *reg;
    int end = 0;
    MUST(servo->span_ticks > 0 && servo->span_deg > 0 && servo->current_ma > 0);
    for (size_t i = 0; (reg = grobo_servo_register_row(servo, i)) != NULL; i++) {
        MUST(reg->address >= end && reg->min <= reg->max);
        end = reg->address + reg->bytes;
        MUST(end <= GROBO_SIM_REGISTER_BYTES);
        MUST(grobo_servo_register_named(servo, reg->name) == reg);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static grobo_sim sim;
    static grobo_robot_sim config;
    size_t n = 0;
    while (grobo_robot_family_at(n) != NULL) {
        n++;
    }
    char text[256];
    int length = snprintf(text, sizeof text,
                          "name: a\nfamily: %s\njoints:\n"
                          "  - {name: x, id: 1, servo: ./servo.yaml, limits_deg: [-1, 1]}\n",
                          grobo_robot_family_at(size > 0 ? data[0] % n : 0)->name);
    bytes robot = {(const uint8_t *)text, (size_t)length};
    bytes servo = {size > 0 ? data + 1 : data, size > 0 ? size - 1 : 0};
    const grobo_i_beside beside = {open_bytes, close_bytes, &servo};
    grobo_robot_def *def = NULL;
    grobo_diagnostics *list = NULL;
    grobo_driver driver = GROBO_TABLE_INIT(grobo_driver);
    MUST(grobo_diagnostics_new(NULL, &list) == 0);
    int error =
        grobo_i_robot_read(&(grobo_source){read_bytes, &robot}, "", &beside, list, NULL, &def);
    MUST((error == 0) == (def != NULL));
    MUST((error == 0) == (grobo_diagnostics_total(list, GROBO_SEVERITY_ERROR) == 0));
    if (def != NULL) {
        check_servo(def->model->joints[0].servo);
        MUST(grobo_robot_def_driver(def, def->wiring, &driver) == 0);
        MUST(grobo_robot_def_sim(def, def->wiring, &config) == 0);
        if (grobo_sim_init(&sim, &config.config, 0) ==
            0) { /* its rate may be none of the servo's */
            grobo_sim_step(&sim, 100000);
        }
    }
    grobo_robot_def_free(def);
    grobo_diagnostics_free(list);
    return 0;
}
