/* SPDX-License-Identifier: MIT */
/* Values of LewanSoul and Hiwonder servos, by addresses of this library: the commands that carry
 * them. Registers and models are in table.c. */
#include "src/servo/lx16a/items.h"

const grobo_i_item grobo_i_lx16a_items[] = {
    {0, 1, GROBO_LX16A_ID, GROBO_LX16A_ID_READ},
    {1, 1, GROBO_LX16A_OFFSET, GROBO_LX16A_OFFSET_READ},
    {2, 4, GROBO_LX16A_LIMITS, GROBO_LX16A_LIMITS_READ},
    {6, 4, GROBO_LX16A_VOLTAGES, GROBO_LX16A_VOLTAGES_READ},
    {10, 1, GROBO_LX16A_HEAT, GROBO_LX16A_HEAT_READ},
    {11, 1, GROBO_LX16A_ALARM, GROBO_LX16A_ALARM_READ},
    {12, 1, GROBO_LX16A_LED, GROBO_LX16A_LED_READ},
    {16, 1, GROBO_LX16A_LOAD, GROBO_LX16A_LOAD_READ},
    {17, 4, GROBO_LX16A_MODE, GROBO_LX16A_MODE_READ},
    {21, 4, GROBO_LX16A_MOVE, GROBO_LX16A_MOVE_READ},
    {25, 4, GROBO_LX16A_WAIT, GROBO_LX16A_WAIT_READ},
    {29, 1, 0, GROBO_LX16A_TEMPERATURE_READ},
    {30, 2, 0, GROBO_LX16A_VOLTAGE_READ},
    {32, 2, 0, GROBO_LX16A_POSITION_READ},
    {0, 0, 0, 0},
};
