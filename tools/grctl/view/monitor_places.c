/* SPDX-License-Identifier: MIT */
/*
 * Where joints stand on the screen, by the robot's model alone. A robot with pairs in the mirror
 * has two columns: its right side on the left, as seen by whoever faces it; joints without a
 * partner are above, the last (a head) first. Any other robot is a list, in as many columns as its
 * joints need and the screen has. A blank row separates groups where there is room.
 */
#include <stdlib.h>

#include "tools/grctl/view/monitor.h"

/* The smallest group that a joint is in; n_groups: none. */
static int limb_of(const grobo_model *model, int joint)
{
    int best = model->n_groups, least = GROBO_JOINTS_MAX + 1;
    for (int g = 0; g < model->n_groups; g++) {
        int n = grobo_joints_count(model->groups[g].joints);
        if ((model->groups[g].joints & GROBO_JOINT_BIT(joint)) && n < least) {
            best = g;
            least = n;
        }
    }
    return best;
}

bool monitor_has_partner(const grobo_model *model, int joint)
{
    return grobo_model_joint(model, joint)->mirror != joint &&
           grobo_model_joint(model, joint)->mirror < model->n_joints;
}

static bool is_paired(const grobo_model *model)
{
    for (int j = 0; j < model->n_joints; j++) {
        if (monitor_has_partner(model, j)) {
            return true;
        }
    }
    return false;
}

/* Of a pair: its name says so, else it is the earlier one. */
static bool is_right(const grobo_model *model, int joint)
{
    int partner = grobo_model_joint(model, joint)->mirror;
    char here = grobo_model_joint(model, joint)->name[0],
         there = grobo_model_joint(model, partner)->name[0];
    bool here_r = here == 'R' || here == 'r', there_r = there == 'R' || there == 'r';
    return here_r != there_r ? here_r : joint < partner;
}

/* One joint after the other, and where a row may stay free before it. */
typedef struct line {
    int joint, partner; /* partner -1: none beside it */
    int limb;
} line;

static int add_line(line *lines, int n, int joint, int partner, int limb)
{
    int at = n;
    while (at > 0 && lines[at - 1].limb > limb) {
        lines[at] = lines[at - 1];
        at--;
    }
    lines[at] = (line){joint, partner, limb};
    return n + 1;
}

/* Joints without a partner two in a row, then pair after pair, by their limbs. */
static int list_pairs(const grobo_model *model, line *lines)
{
    int n = 0, open = -1;
    for (int j = model->n_joints - 1; j >= 0; j--) {
        if (monitor_has_partner(model, j)) {
            continue;
        }
        if (open >= 0) {
            lines[open].partner = j;
            open = -1;
        } else {
            open = n;
            n = add_line(lines, n, j, -1, -1);
        }
    }
    for (int j = 0; j < model->n_joints; j++) {
        if (monitor_has_partner(model, j) && is_right(model, j)) {
            n = add_line(lines, n, j, grobo_model_joint(model, j)->mirror, limb_of(model, j));
        }
    }
    return n;
}

static int list_all(const grobo_model *model, line *lines)
{
    for (int j = 0; j < model->n_joints; j++) {
        lines[j] = (line){j, -1, limb_of(model, j)};
    }
    return model->n_joints;
}

static int count_gaps(const line *lines, int n)
{
    int gaps = 0;
    for (int i = 1; i < n; i++) {
        gaps += lines[i].limb != lines[i - 1].limb;
    }
    return gaps;
}

static void put(monitor_layout *l, int joint, int row, int column)
{
    l->cell[l->n++] = (monitor_cell){.joint = joint, .row = row, .column = column};
    l->n_rows = row >= l->n_rows ? row + 1 : l->n_rows;
}

/* Column after column, so that the next cell is the next joint below. */
static void place_pairs(monitor_layout *l, const line *lines, int n, bool gaps)
{
    l->n_columns = 2;
    for (int side = 0; side < 2; side++) {
        for (int i = 0, row = 0; i < n; i++, row++) {
            row += gaps && i > 0 && lines[i].limb != lines[i - 1].limb;
            int joint = side ? lines[i].partner : lines[i].joint;
            if (joint >= 0) {
                put(l, joint, row, side);
            }
        }
    }
}

static void place_list(monitor_layout *l, const line *lines, int n, int height, int most)
{
    int columns = (n + height - 1) / height;
    l->n_columns = columns > most ? most : columns;
    int rows = (n + l->n_columns - 1) / l->n_columns;
    bool gaps = l->n_columns == 1 && n + count_gaps(lines, n) <= height;
    for (int i = 0, row = 0; i < n; i++, row++) {
        row += gaps && i > 0 && lines[i].limb != lines[i - 1].limb;
        put(l, lines[i].joint, l->n_columns == 1 ? row : i % rows, i / rows);
    }
}

void monitor_lay_out(monitor_layout *l, const grobo_model *model, int height, int columns)
{
    line lines[GROBO_JOINTS_MAX];
    *l = (monitor_layout){.height = height};
    if (is_paired(model)) {
        int n = list_pairs(model, lines);
        place_pairs(l, lines, n, n + count_gaps(lines, n) <= height);
    } else {
        int n = list_all(model, lines);
        place_list(l, lines, n, height, columns);
    }
}

static int find(const monitor_layout *l, int joint)
{
    int at = 0;
    while (at < l->n - 1 && l->cell[at].joint != joint) {
        at++;
    }
    return at;
}

int monitor_top(const monitor_layout *l, int joint)
{
    int page = l->cell[find(l, joint)].row / l->height * l->height;
    int last = l->n_rows > l->height ? l->n_rows - l->height : 0;
    return page < last ? page : last;
}

int monitor_below(const monitor_layout *l, int joint, int by)
{
    return l->cell[(find(l, joint) + by + l->n) % l->n].joint;
}

/* In the next column the joint of the same row, or the nearest to it. */
int monitor_beside(const monitor_layout *l, int joint, int by)
{
    const monitor_cell *from = &l->cell[find(l, joint)];
    int column = (from->column + by + l->n_columns) % l->n_columns, best = joint, least = l->n_rows;
    for (int i = 0; i < l->n; i++) {
        int away = abs(l->cell[i].row - from->row);
        if (l->cell[i].column == column && away < least) {
            best = l->cell[i].joint;
            least = away;
        }
    }
    return best;
}
