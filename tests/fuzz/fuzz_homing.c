/* SPDX-License-Identifier: MIT */
/* Any bytes as a calibration of LeRobot's form, for an SO-101: refused in one line, or what its
 * servos take. The first byte: whether it is what they held before. */
#include <string.h>

#include "tests/fuzz/target.h"
#include "tools/grctl/bringup/homing_file.h"
#include "tools/grctl/conn/family.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static app a;
    char said[APP_LINE_BYTES] = "";
    homing all[GROBO_JOINTS_MAX];
    if (!a.def) {
        a.def = grobo_robot_def_find("so101");
        a.made.size = sizeof a.made;
        MUST(a.def && grobo_robot_def_driver(a.def, a.def->wiring, &a.made) == 0);
        a.driver = &a.made;
    }
    app_hush(&a, said);
    bool any = size > 0 && (data[0] & 1) != 0;
    const char *bytes = (const char *)data + (size > 0);
    int status = homing_take(&a, "x", bytes, size - (size > 0), any, all);
    MUST((status != 0) == (*said != '\0'));
    MUST(!strpbrk(said, "\n\r"));
    for (int j = 0; status == 0 && j < a.def->model->n_joints; j++) {
        const grobo_servo_model *servo = family_servo(a.driver, a.def->model->joints[j].motor);
        MUST(all[j].min >= grobo_servo_register_of(servo, GROBO_ROLE_MIN_POSITION)->min);
        MUST(all[j].max <= grobo_servo_register_of(servo, GROBO_ROLE_MAX_POSITION)->max);
        MUST(any || (all[j].min < servo->middle && all[j].max > servo->middle));
    }
    return 0;
}
