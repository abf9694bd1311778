/* SPDX-License-Identifier: MIT */
/* Why a request failed, in words, with the numbers in the unit of the joint. Who does not ask for
 * it does not link it. */
#include <math.h>
#include <string.h>

#include <grobo/core/unit.h>

#include "src/robot/query.h"
#include "src/robot/robot.h"
#include "src/robot/speed.h"
#include "src/robot/state.h"

/* A text being put together: what does not fit is left out. */
typedef struct writing {
    char *text;
    size_t room, used;
} writing;

static void put(writing *w, const char *text)
{
    for (; *text != '\0' && w->used + 1 < w->room; text++) {
        w->text[w->used++] = *text;
    }
    w->text[w->used] = '\0';
}

static const double tens[] = {1, 10, 100, 1e3, 1e4, 1e5, 1e6};

/* Rounded to a number of decimal places. */
static void put_number(writing *w, double value, int places)
{
    char digits[24];
    size_t at = sizeof digits - 1;
    int64_t rest = llround(fmin(fabs(value), 1e9) * tens[places]);

    put(w, value < 0 && rest > 0 ? "-" : "");
    digits[at] = '\0';
    for (int n = 0; n <= places || rest > 0; n++) {
        if (n > 0 && n == places) {
            digits[--at] = '.';
        }
        digits[--at] = (char)('0' + rest % 10);
        rest /= 10;
    }
    put(w, &digits[at]);
}

static void put_joint(writing *w, const grobo_joint *joint)
{
    put(w, "motor ");
    put_number(w, joint->motor, 0);
    put(w, " (");
    put(w, joint->name);
    put(w, ")");
}

/* With as many places as show that the value is beyond the range, one at least. */
static void put_range(writing *w, double value, double a, double b, const char *unit)
{
    double low = fmin(a, b), high = fmax(a, b);
    int places = 1;

    while (places < 6 && round(value * tens[places]) >= round(low * 10) / 10 * tens[places] &&
           round(value * tens[places]) <= round(high * 10) / 10 * tens[places]) {
        places++;
    }
    put(w, ", ");
    put_number(w, value, places);
    put(w, unit);
    put(w, " is not within ");
    put_number(w, low, 1);
    put(w, " to ");
    put_number(w, high, 1);
    put(w, unit);
}

/* The angle or the speed that was refused, and what there is. A servo may keep a range of its own
 * within that of the model. */
static void put_limit(writing *w, const grobo_robot *robot, int joint)
{
    const grobo_model *model = robot->driver->model;
    const grobo_joint *of = grobo_i_joint(model, joint);
    const grobo_joint_state *state = &robot->axes[joint].state;
    double rad = grobo_rad_from_deg(robot->fault_deg);

    if (grobo_i_joint_is_wheel(model, joint)) {
        double most = grobo_deg_from_rad(grobo_i_speed_limit(robot, joint, false));
        put_range(w, robot->fault_deg, -most, most, " deg/s");
        return;
    }
    bool beyond = rad < of->min_rad || rad > of->max_rad;
    bool narrower = !beyond && (state->valid & GROBO_FIELD_RANGE) != 0;
    const char *unit = grobo_unit_name(grobo_model_unit(model, joint));
    char spaced[8] = " ";

    memcpy(spaced + 1, unit, strlen(unit) + 1);
    put_range(w, grobo_model_value(model, joint, rad),
              grobo_model_value(model, joint, narrower ? state->low_rad : of->min_rad),
              grobo_model_value(model, joint, narrower ? state->high_rad : of->max_rad), spaced);
}

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
    case GROBO_TRIP_LIMIT:
    case GROBO_TRIP_APART:
    case GROBO_TRIP_BLOCKED:
    case GROBO_TRIP_OVERLOAD:
        return " deg";
    case GROBO_TRIP_HOST_STALL:
        return " ms";
    case GROBO_TRIP_LOST_REPLIES:
        return " in a row";
    case GROBO_TRIP_NONE:
    case GROBO_TRIP_TORQUE_LOST:
    case GROBO_TRIP_NUMBER:
    case GROBO_TRIP_ESTOP:
        break;
    }
    return NULL;
}

static void put_trip(writing *w, const grobo_robot *robot)
{
    const grobo_trip_info *trip = &robot->trip;
    bool measured = trip_unit(trip->trip) != NULL && trip->value != 0;

    put(w, ": ");
    put(w, grobo_trip_name(trip->trip));
    if (trip->joint >= 0) {
        put(w, ", ");
        put_joint(w, grobo_i_joint(robot->driver->model, trip->joint));
    }
    if (measured) {
        put(w, ", ");
        put_number(w, trip->value, 1);
        put(w, trip_unit(trip->trip));
    }
}

/* Whether it is said of fault_joint. Where no joint is meant that may be of an error before: then
 * the state of the joint tells. */
static bool names_joint(const grobo_robot *robot, int result)
{
    if (robot->fault_joint < 0) {
        return false;
    }
    const grobo_robot_axis *axis = &robot->axes[robot->fault_joint];
    return result == GROBO_ERR_LIMIT || result == GROBO_ERR_NAN || result == GROBO_ERR_SPEED ||
           (result == GROBO_ERR_STALE && !grobo_i_is_sensed(axis)) ||
           (result == GROBO_ERR_STATE && grobo_i_is_external(axis));
}

int grobo_robot_error_text(const grobo_robot *robot, int result, char *text, size_t room)
{
    if (robot == NULL || text == NULL || room == 0) {
        return GROBO_ERR_ARG;
    }
    writing w = {.text = text, .room = room};

    put(&w, grobo_error_text(result));
    grobo_i_lock(robot);
    bool of_joint = names_joint(robot, result);
    if (of_joint) {
        put(&w, ": ");
        put_joint(&w, grobo_i_joint(robot->driver->model, robot->fault_joint));
    }
    if (of_joint && result == GROBO_ERR_LIMIT) {
        put_limit(&w, robot, robot->fault_joint);
    }
    if (result == GROBO_ERR_LATCHED && robot->trip.trip != GROBO_TRIP_NONE) {
        put_trip(&w, robot);
    }
    grobo_i_unlock(robot);
    return (int)w.used;
}
