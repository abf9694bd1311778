/* SPDX-License-Identifier: MIT */
/* Leg IK by Choreonoid's iteration, choreonoid-whole-body.md, section "Solving". Kept for agreement
 * with what authors saw: it stops at a tolerance, so its answers miss the target by a little. */
#include <float.h>
#include <string.h>

#include "src/body/body.h"
#include "src/body/vec.h"

enum { DOF = GROBO_BODY_LEG_JOINTS };

#define ROUNDS_MAX 50
#define ERROR_MAX 1e-14 /* of |e|^2 */
#define ERROR_MAX_COMPAT11 1e-12
#define GAIN_MIN 1e-14
#define ROUNDS_WITHOUT_GAIN 3
#define DAMPING 1e-12
#define STEP 0.9
#define COSINE_OF_NOTHING (1.0 - 1e-6)

/* w(R) = k (R12 - R21, R20 - R02, R01 - R10), k = -theta / (2 sin theta) */
void grobo_i_omega(double out[3], const double r[9])
{
    const double cosine = 0.5 * (r[0] + r[4] + r[8] - 1);

    if (cosine > COSINE_OF_NOTHING) {
        out[0] = out[1] = out[2] = 0;
        return;
    }
    const double theta = acos(fmax(cosine, -1));
    const double k = -theta / (2 * sin(theta));

    out[0] = k * (r[5] - r[7]);
    out[1] = k * (r[6] - r[2]);
    out[2] = k * (r[1] - r[3]);
}

void grobo_i_leg_jacobian(const struct grobo_i_numeric *problem, const grobo_transform *start,
                          const double *q_rad, double jacobian[6][DOF], grobo_transform *end)
{
    double axis[DOF][3], at[DOF][3];
    grobo_transform now = *start;

    for (int step = 0; step < DOF; step++) {
        const int i = problem->up ? DOF - 1 - step : step;
        const grobo_body_link *link = &problem->model->links[problem->leg->link[i]];
        const grobo_transform before = now;

        if (problem->up) {
            grobo_i_step_up(link, q_rad[i], &before, &now);
        } else {
            grobo_i_step_down(link, q_rad[i], &before, &now);
        }
        memcpy(at[i], problem->up ? before.p_m : now.p_m, sizeof at[i]);
        mat_vec(axis[i], now.r, link->axis);
        for (int k = 0; k < 3 && problem->up; k++) {
            axis[i][k] = -axis[i][k];
        }
    }
    for (int i = 0; i < DOF; i++) {
        double arm[3], sweep[3];

        vec_add_scaled(arm, now.p_m, -1, at[i]);
        vec_cross(sweep, axis[i], arm);
        for (int k = 0; k < 3; k++) {
            jacobian[k][i] = sweep[k];
            jacobian[3 + k][i] = axis[i][k];
        }
    }
    *end = now;
}

/* e = [p_goal - p; R w(R^T R_goal)], and |e|^2 */
static double path_error(const grobo_transform *end, const grobo_transform *goal, double e[6])
{
    double turn[9], w[3];
    double sum = 0;

    vec_add_scaled(e, goal->p_m, -1, end->p_m);
    mat_t_mul(turn, end->r, goal->r);
    grobo_i_omega(w, turn);
    mat_vec(e + 3, end->r, w);
    for (int k = 0; k < 6; k++) {
        sum += e[k] * e[k];
    }
    return sum;
}

/* x = A^-1 b by elimination with row pivoting; A and b are used up. False: singular. */
static bool solve6(double a[6][6], double b[6], double x[6])
{
    for (int column = 0; column < 6; column++) {
        int pivot = column;

        for (int row = column + 1; row < 6; row++) {
            pivot = fabs(a[row][column]) > fabs(a[pivot][column]) ? row : pivot;
        }
        if (fabs(a[pivot][column]) < DBL_MIN) {
            return false;
        }
        for (int k = 0; k < 6 && pivot != column; k++) {
            const double kept = a[column][k];

            a[column][k] = a[pivot][k];
            a[pivot][k] = kept;
        }
        const double kept = b[column];

        b[column] = b[pivot];
        b[pivot] = pivot == column ? b[column] : kept;
        for (int row = column + 1; row < 6; row++) {
            const double factor = a[row][column] / a[column][column];

            for (int k = column; k < 6; k++) {
                a[row][k] -= factor * a[column][k];
            }
            b[row] -= factor * b[column];
        }
    }
    for (int row = 5; row >= 0; row--) {
        x[row] = b[row];
        for (int k = row + 1; k < 6; k++) {
            x[row] -= a[row][k] * x[k];
        }
        x[row] /= a[row][row];
    }
    return true;
}

/* dq = J^T (J J^T + 1e-12 I)^-1 e */
static bool damped_step(double jacobian[6][DOF], double e[6], double dq_rad[DOF])
{
    double a[6][6], x[6];

    for (int i = 0; i < 6; i++) {
        for (int j = 0; j < 6; j++) {
            a[i][j] = i == j ? DAMPING : 0;
            for (int k = 0; k < DOF; k++) {
                a[i][j] += jacobian[i][k] * jacobian[j][k];
            }
        }
    }
    if (!solve6(a, e, x)) {
        return false;
    }
    for (int k = 0; k < DOF; k++) {
        dq_rad[k] = 0;
        for (int i = 0; i < 6; i++) {
            dq_rad[k] += jacobian[i][k] * x[i];
        }
    }
    return true;
}

bool grobo_i_leg_numeric(const struct grobo_i_numeric *problem, const grobo_transform *start,
                         const grobo_transform *goal, double q_rad[DOF])
{
    const double error_max = problem->compat11 ? ERROR_MAX_COMPAT11 : ERROR_MAX;
    double jacobian[6][DOF], e[6], q[DOF], dq[DOF];
    double before = DBL_MAX;
    int without_gain = 0;

    memcpy(q, q_rad, sizeof q);
    for (int round = 0; round < ROUNDS_MAX; round++) {
        grobo_transform end;

        grobo_i_leg_jacobian(problem, start, q, jacobian, &end);
        const double error = path_error(&end, goal, e);

        if (error < error_max) {
            memcpy(q_rad, q, sizeof q);
            return true;
        }
        if (!problem->compat11 && before - error < GAIN_MIN &&
            ++without_gain >= ROUNDS_WITHOUT_GAIN) {
            return false;
        }
        before = error;
        if (!(problem->compat11 ? solve6(jacobian, e, dq) : damped_step(jacobian, e, dq))) {
            return false;
        }
        for (int i = 0; i < DOF; i++) {
            q[i] += STEP * dq[i];
        }
    }
    return false;
}
