/* SPDX-License-Identifier: MIT */
/* Two columns, as the body stands: a right limb left of its left counterpart, joint by joint. */
#include <string.h>

#include "tools/grctl/view/layout.h"

enum {
    HEADING = 30,      /* height of a section's heading */
    AXIS = 26,         /* of the labels below its last panel */
    BETWEEN = 12,      /* rows */
    TALL = 76,         /* a panel */
    TALL_OF_FEW = 132, /* a panel where there are few */
    TALL_OF_ONE = 240,
    SLIM = 8,
    FEW = 4
};

/* What stands side by side: one limb in each column, or one set of joints in both. */
typedef struct block {
    const char *group[2], *title[2], *side[2];
} block;

static const block blocks[] = {
    {{"right_arm", "left_arm"}, {"Right arm", "Left arm"}, {"right", "left"}},
    {{NULL, NULL}, {"Head and trunk", NULL}, {"middle", NULL}}, /* those of no group */
    {{"right_leg", "left_leg"}, {"Right leg", "Left leg"}, {"right", "left"}},
};
enum { BLOCKS = sizeof blocks / sizeof blocks[0] };

typedef struct column {
    const char *title, *side;
    const plot_curve *curves[GROBO_JOINTS_MAX];
    int n;
} column;

static grobo_joint_mask group_of(const grobo_model *model, const char *name)
{
    for (int i = 0; model && name && i < model->n_groups; i++) {
        if (strcmp(model->groups[i].name, name) == 0) {
            return model->groups[i].joints;
        }
    }
    return 0;
}

static grobo_joint_mask limbs_of(const grobo_model *model)
{
    grobo_joint_mask limbs = 0;
    for (int b = 0; b < BLOCKS; b++) {
        limbs |= group_of(model, blocks[b].group[0]) | group_of(model, blocks[b].group[1]);
    }
    return limbs;
}

static void choose(column *c, const plot_data *data, grobo_joint_mask joints)
{
    for (int i = 0; i < data->n_curves; i++) {
        if (joints & GROBO_JOINT_BIT(data->curves[i].joint)) {
            c->curves[c->n++] = &data->curves[i];
        }
    }
}

/* One set alone takes both columns, row by row. */
static void spread(column columns[2])
{
    column all = columns[columns[0].n ? 0 : 1];
    columns[0] = (column){.title = all.title, .side = all.side};
    columns[1] = (column){.side = all.side};
    for (int i = 0; i < all.n; i++) {
        columns[i % 2].curves[columns[i % 2].n++] = all.curves[i];
    }
}

static void fill(column columns[2], const block *b, const plot_data *data)
{
    grobo_joint_mask limbs = limbs_of(data->of.model);
    for (int side = 0; side < 2; side++) {
        columns[side] = (column){.title = b->title[side], .side = b->side[side]};
        if (b->group[side]) {
            choose(&columns[side], data, group_of(data->of.model, b->group[side]));
        } else if (side == 0) {
            choose(&columns[side], data, ~limbs);
        }
    }
    if (!limbs) {
        columns[0].title = "Joints";
    }
    if (!columns[0].n || !columns[1].n) {
        spread(columns);
    }
}

bool plot_is_still(const plot_curve *curve)
{
    return !curve->set || curve->max_deg - curve->min_deg < 0.05;
}

static double height_of(const plot_curve *curve, double tall)
{
    return plot_is_still(curve) ? SLIM : tall;
}

/* A row is as high as the higher of its panels. */
static double row_height(const column columns[2], int row, double tall)
{
    double height = 0;
    for (int side = 0; side < 2; side++) {
        if (row < columns[side].n && height_of(columns[side].curves[row], tall) > height) {
            height = height_of(columns[side].curves[row], tall);
        }
    }
    return height;
}

static void begin_section(plot_layout *l, const column *c, double x, double y, double width)
{
    l->sections[l->n_sections++] = (plot_section){.title = c->title ? c->title : "",
                                                  .side = c->side,
                                                  .x = x,
                                                  .y = y,
                                                  .plot_x = x + PLOT_GUTTER,
                                                  .plot_w = width - PLOT_GUTTER};
}

/* Places the rows of a block from y on. Returns where it ends. */
static double place(plot_layout *l, const column columns[2], double y, double width, double tall)
{
    double bottom = y + HEADING;
    int first = l->n_sections;
    int rows = columns[0].n > columns[1].n ? columns[0].n : columns[1].n;
    for (int side = 0; side < 2; side++) {
        if (columns[side].n) {
            begin_section(l, &columns[side], PLOT_MARGIN + side * (width + PLOT_GAP), y, width);
        }
    }
    for (int row = 0; row < rows; row++) {
        double top = bottom + (row ? BETWEEN : 0) + PLOT_NAME;
        bottom = top + row_height(columns, row, tall);
        for (int side = 0; side < 2; side++) {
            plot_section *section = &l->sections[first + (columns[0].n ? side : 0)];
            if (row >= columns[side].n) {
                continue;
            }
            double height = height_of(columns[side].curves[row], tall);
            section->axis_y = top + height;
            l->panels[l->n_panels++] =
                (plot_panel){.curve = columns[side].curves[row],
                             .side = columns[side].side,
                             .slim = plot_is_still(columns[side].curves[row]),
                             .box = {section->plot_x, top, section->plot_w, height}};
        }
    }
    return bottom + AXIS;
}

void plot_arrange(plot_layout *layout, const plot_data *data)
{
    double width = data->n_curves == 1 ? PLOT_WIDTH - 2 * PLOT_MARGIN
                                       : (PLOT_WIDTH - 2 * PLOT_MARGIN - PLOT_GAP) / 2.0;
    double tall = data->n_curves == 1 ? TALL_OF_ONE : data->n_curves <= FEW ? TALL_OF_FEW : TALL;
    column columns[2];
    memset(layout, 0, sizeof *layout);
    layout->height = PLOT_HEAD + (data->of.balance ? PLOT_BALANCE_HEIGHT : 0);
    for (int b = 0; b < BLOCKS; b++) {
        fill(columns, &blocks[b], data);
        if (columns[0].n || columns[1].n) {
            layout->height = place(layout, columns, layout->height, width, tall);
        }
    }
    layout->height += data->n_curves ? PLOT_MARGIN / 2.0 : PLOT_MARGIN;
}

int plot_columns(grobo_joint_mask joints)
{
    bool one = joints && !(joints & (joints - 1));
    int width = one ? PLOT_WIDTH - 2 * PLOT_MARGIN : (PLOT_WIDTH - 2 * PLOT_MARGIN - PLOT_GAP) / 2;
    return width - PLOT_GUTTER;
}
