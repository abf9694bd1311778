/* SPDX-License-Identifier: MIT */
/* What a message says that a trip measured. */

#include "tests/support/test.h"
#include "tools/grctl/conn/conn.h"

TEST(a_trip_says_what_it_measured)
{
    static const struct {
        grobo_trip trip;
        double value;
        const char *text;
    } rows[] = {
        {GROBO_TRIP_TEMPERATURE, 71, " (71 deg C)"},
        {GROBO_TRIP_OVERHEATED, 80, " (80 deg C)"},
        {GROBO_TRIP_OVERHEATED, 0, ""},
        {GROBO_TRIP_CURRENT, 1234, " (1234 mA)"},
        {GROBO_TRIP_VOLTAGE, 5900, " (5900 mV)"},
        {GROBO_TRIP_LOST_REPLIES, 5, " (5 in a row)"},
        {GROBO_TRIP_LOST_REPLIES, 0, " (no answer in time)"},
        {GROBO_TRIP_LIMIT, 0, " (0 deg)"},
        {GROBO_TRIP_HOST_STALL, 120.26, " (120.3 ms late)"},
        {GROBO_TRIP_TORQUE_LOST, 0, ""},
        {GROBO_TRIP_ESTOP, 0, ""},
        {GROBO_TRIP_APART, 12.34, " (12.34 deg)"},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const grobo_trip_info trip = {.trip = rows[i].trip, .value = rows[i].value};
        char text[48] = "not told";
        conn_trip_value(&trip, text, sizeof text);
        assert_string_equal(text, rows[i].text);
    }
}
