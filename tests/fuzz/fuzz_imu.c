/* SPDX-License-Identifier: MIT */
/* Any bytes as a line of an IMU: no line, or five finite numbers. The engine takes or refuses
 * them. */
#include <math.h>
#include <string.h>

#include "tests/fuzz/target.h"
#include "tools/grctl/conn/imu.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char line[IMU_LINE_BYTES];
    grobo_imu reading;
    size_t n = size < sizeof line ? size : sizeof line - 1;
    memcpy(line, data, n);
    line[n] = '\0';
    if (imu_parse(line, &reading)) {
        MUST(isfinite(reading.roll_rad) && isfinite(reading.pitch_rad));
        for (int k = 0; k < 3; k++) {
            MUST(isfinite(reading.rate_rad_s[k]));
        }
    }
    return 0;
}
