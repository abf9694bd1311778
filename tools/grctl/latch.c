/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>

#include <grobo/port.h>
#include <grobo/session.h>

#include "latch.h"
#include "os.h"

enum { FOLDER_BYTES = 1024, NAMES = 2 };
typedef struct mark {
    char path[FOLDER_BYTES + GROBO_DEVICE_MAX_BYTES + 8];
} mark;
typedef struct mark_list {
    mark of[NAMES * OS_FOLDERS];
    int n;
} mark_list;

/* In each folder, by the name that stays when the device is plugged in elsewhere. */
static void add_marks(mark_list *marks, const char *device)
{
    char identity[GROBO_DEVICE_MAX_BYTES], folder[FOLDER_BYTES];
    if (grobo_port_identity(device, identity, sizeof identity) < 0)
        return;
    for (char *c = identity; *c; c++)
        if (strchr("/\\:", *c))
            *c = '!';
    for (int i = 0; i < OS_FOLDERS; i++)
        if (os_private_folder(i, folder, sizeof folder))
            snprintf(marks->of[marks->n++].path, sizeof marks->of[0].path, "%s/estop-%s", folder,
                     identity);
}

/*
 * The marks of a device: whoever has it may have opened it by another name, or by a link. The name
 * as given stands for it while it is unplugged. None of a simulator in process.
 */
static const mark_list *marks_of(const char *device)
{
    static mark_list marks;
    char real[GROBO_DEVICE_MAX_BYTES];
    marks.n = 0;
    if (strcmp(device, GROBO_DEVICE_SIM) == 0)
        return &marks;
    add_marks(&marks, device);
    if (os_true_path(device, real, sizeof real) && strcmp(real, device) != 0)
        add_marks(&marks, real);
    return &marks;
}

int latch_set(const char *device)
{
    const mark_list *marks = marks_of(device);
    int set = 0;
    for (int i = 0; i < marks->n; i++)
        set += os_mark(marks->of[i].path);
    return set || strcmp(device, GROBO_DEVICE_SIM) == 0 ? GROBO_OK : GROBO_ERR_IO;
}

int latch_clear(const char *device)
{
    const mark_list *marks = marks_of(device);
    bool cleared = marks->n > 0 || strcmp(device, GROBO_DEVICE_SIM) == 0;
    for (int i = 0; i < marks->n; i++)
        cleared = os_unmark(marks->of[i].path) && cleared;
    return cleared ? GROBO_OK : GROBO_ERR_IO;
}

bool latch_is_set(const char *device)
{
    const mark_list *marks = marks_of(device);
    bool set = false;
    for (int i = 0; i < marks->n && !set; i++)
        set = os_is_marked(marks->of[i].path);
    return set;
}
