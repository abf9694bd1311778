/* SPDX-License-Identifier: MIT */
/* How the base stood at each posture of a recorded motion: a table beside it. */
#include <stdlib.h>
#include <string.h>

#include <grobo/model.h>

#include "tools/grctl/cli/file.h"
#include "tools/grctl/cli/output.h"
#include "tools/grctl/conn/imu_rows.h"

struct imu_row {
    int64_t time_us;
    grobo_imu reading;
    bool known;
};

int imu_rows_add(imu_rows *rows, int64_t time_us, const grobo_imu *reading)
{
    if (rows->n == rows->capacity) {
        size_t capacity = rows->capacity == 0 ? 256 : 2 * rows->capacity;
        struct imu_row *more = realloc(rows->row, capacity * sizeof *more);
        if (more == NULL) {
            return GROBO_ERR_NOMEM;
        }
        rows->row = more;
        rows->capacity = capacity;
    }
    struct imu_row *row = &rows->row[rows->n++];
    *row = (struct imu_row){.time_us = time_us, .known = reading != NULL};
    if (reading != NULL) {
        row->reading = *reading;
    }
    return GROBO_OK;
}

void imu_rows_drop(imu_rows *rows)
{
    rows->n -= rows->n > 0;
}

void imu_rows_free(imu_rows *rows)
{
    free(rows->row);
    *rows = (imu_rows){0};
}

static void print_row(heap *text, const struct imu_row *row, int64_t at_us)
{
    heap_print(text, "%.3f", (double)at_us / 1e6);
    if (!row->known) {
        heap_print(text, ",,,,,\n");
        return;
    }
    const double *rate = row->reading.rate_rad_s;
    heap_print(text, ",%.2f,%.2f,%.2f,%.2f,%.2f\n", grobo_deg_from_rad(row->reading.roll_rad),
               grobo_deg_from_rad(row->reading.pitch_rad), grobo_deg_from_rad(rate[0]),
               grobo_deg_from_rad(rate[1]), grobo_deg_from_rad(rate[2]));
}

int imu_rows_save(const imu_rows *rows, app *a, const char *motion)
{
    char path[GROBO_PATH_MAX_BYTES];
    heap text = {0};
    int64_t at_us = 0;
    int n = snprintf(path, sizeof path, "%s.imu.csv", motion);
    heap_print(&text, "time_s,roll_deg,pitch_deg,x_dps,y_dps,z_dps\n");
    for (size_t i = 0; i < rows->n; i++) {
        at_us += rows->row[i].time_us;
        print_row(&text, &rows->row[i], at_us);
    }
    int error = n < 0 || (size_t)n >= sizeof path ? GROBO_ERR_CAP
                : text.bytes == NULL              ? GROBO_ERR_NOMEM
                                                  : file_save(path, text.bytes, text.size);
    free(text.bytes);
    if (error < 0) {
        return app_fail(a, EXIT_FILE, grobo_error_name(error), "%s: cannot write: %s", path,
                        file_write_error_text(error));
    }
    app_note(a, "how the base stood: %s", path);
    return EXIT_DONE;
}
