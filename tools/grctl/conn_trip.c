/* SPDX-License-Identifier: MIT */
/* Why the engine stopped, in words. */
#include "conn.h"

/* What a trip's value is measured in. */
static const char *trip_unit(grobo_trip trip)
{
    switch (trip) {
    case GROBO_TRIP_TEMPERATURE:
    case GROBO_TRIP_OVERHEATED:
        return " deg C";
    case GROBO_TRIP_CURRENT:
        return " mA";
    case GROBO_TRIP_VOLTAGE:
        return " mV";
    case GROBO_TRIP_LOST_REPLIES:
        return " in a row";
    case GROBO_TRIP_LIMIT:
        return " deg";
    case GROBO_TRIP_HOST_STALL:
        return " ms late";
    case GROBO_TRIP_NONE:
    case GROBO_TRIP_TORQUE_LOST:
    case GROBO_TRIP_NUMBER:
    case GROBO_TRIP_ESTOP:
        break;
    }
    return "";
}

int conn_fail_trip(conn *c, const char *doing)
{
    const grobo_trip_info *t = &c->trip;
    const grobo_model *model = grobo_robot_driver(c->robot)->model;
    char value[48] = "";
    if (*trip_unit(t->trip))
        snprintf(value, sizeof value, " (%.4g%s)", t->value, trip_unit(t->trip));
    if (t->joint >= 0 && t->joint < model->n_joints)
        return app_fail(c->a, EXIT_SAFETY, grobo_trip_name(t->trip),
                        "%s: stopped for safety: %s%s at motor %d (%s)", doing,
                        grobo_trip_name(t->trip), value, model->joints[t->joint].motor,
                        model->joints[t->joint].name);
    return app_fail(c->a, EXIT_SAFETY, grobo_trip_name(t->trip), "%s: stopped for safety: %s%s",
                    doing, grobo_trip_name(t->trip), value);
}
