/* SPDX-License-Identifier: MIT */
/* Any bytes as a robot's file: refused with a word, or a robot that can be driven and simulated. */
#include <math.h>
#include <string.h>

#include <grobo/core/sim_static.h>
#include <grobo/robot_file.h>

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

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static grobo_sim sim;
    static grobo_robot_sim config;
    bytes from = {data, size};
    grobo_robot_def *def = NULL;
    grobo_diagnostics *list = NULL;
    grobo_driver driver = GROBO_TABLE_INIT(grobo_driver);
    MUST(grobo_diagnostics_new(NULL, &list) == 0);
    int error = grobo_robot_def_read(&(grobo_source){read_bytes, &from}, "", list, NULL, &def);
    MUST((error == 0) == (def != NULL));
    MUST((error == 0) == (grobo_diagnostics_total(list, GROBO_SEVERITY_ERROR) == 0));
    if (def != NULL) {
        MUST(grobo_model_check(def->model) == 0);
        MUST(grobo_robot_def_driver(def, def->wiring, &driver) == 0);
        MUST(grobo_robot_def_sim(def, def->wiring, &config) == 0);
        (void)grobo_sim_init(&sim, &config.config, 0); /* not every line is one of its servos' */
        for (int i = 0; i < def->n_links; i++) {
            MUST(def->links[i].parent < i && def->links[i].joint < def->model->n_joints);
            MUST(isfinite(def->links[i].origin_m[0]) && isfinite(def->links[i].origin_rad[2]));
        }
    }
    grobo_robot_def_free(def);
    grobo_diagnostics_free(list);
    return 0;
}
