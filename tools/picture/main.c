/* SPDX-License-Identifier: MIT */
/*
 * Draws docs/robot.svg: `picture MOTION...` has a simulated GR001 play motions, in virtual time,
 * and writes a moving SVG of it to standard output. The simulated servos give the angles,
 * the body model the places of the links. The right foot stays where it stands.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <grobo/core/body.h>
#include <grobo/core/sim.h>
#include <grobo/core/sim_static.h>
#include <grobo/core/static.h>
#include <grobo/motion_io.h>

#define FRAME_US 100000
#define MAX_FRAMES 400
#define LINKS 21
#define JOINTS 20
#define GIVE_UP_US 60000000
#define DEG (3.14159265358979323846 / 180)

/* Where the robot is looked at from: from its right, and a little from above. */
#define AZIMUTH (32 * DEG)
#define ELEVATION (14 * DEG)
#define PIXELS_PER_M 1000
#define STILL_PX 0.5 /* a solver moves feet that stand by less */
#define LEFT_PX 150
#define BOTTOM_PX 318

/* The curves beside it. */
#define CURVE_X 320
#define CURVE_W 270

enum link {
    WAIST,
    R_HIP = 3,
    R_KNEE,
    R_ANKLE,
    R_FOOT,
    L_HIP = 9,
    L_KNEE,
    L_ANKLE,
    L_FOOT,
    CHEST,
    HEAD,
    R_SHOULDER = 16,
    R_ELBOW,
    L_SHOULDER = 19,
    L_ELBOW
};

static grobo_robot robot;
static grobo_sim sim;
static double frames[MAX_FRAMES][JOINTS]; /* degrees */
static grobo_transform places[MAX_FRAMES][LINKS];
static int n_frames;
static grobo_sequencer_state state;

/* ---- the simulator plays ------------------------------------------------------------------ */

static void on_event(void *ctx, const grobo_event *event)
{
    (void)ctx;
    if (event->kind == GROBO_EVENT_PLAY) {
        state = event->u.play.to;
    }
}

static int64_t pump(int64_t now_us)
{
    uint8_t bytes[GROBO_FRAME_MAX_BYTES];
    grobo_robot_rx(&robot, bytes, grobo_sim_tx(&sim, bytes, sizeof bytes, now_us), now_us);
    grobo_robot_step(&robot, now_us);
    int n = grobo_robot_tx(&robot, bytes, sizeof bytes, now_us);
    (void)grobo_sim_rx(&sim, bytes, n > 0 ? (size_t)n : 0, now_us);
    int64_t next_us = grobo_robot_deadline(&robot, now_us);
    int64_t sim_us = grobo_sim_packet_deadline(&sim);
    return sim_us < next_us ? sim_us : next_us;
}

static void look(int64_t now_us)
{
    grobo_sim_step(&sim, now_us);
    for (int j = 0; j < JOINTS && n_frames < MAX_FRAMES; j++) {
        grobo_sim_view view;
        int servo = grobo_sim_find(&sim, grobo_model_motor_of_joint(grobo_gr001_model(), j));
        if (grobo_sim_look(&sim, servo, &view) == 0) {
            frames[n_frames][j] = view.angle_mdeg / 1000.0;
        }
    }
    n_frames += n_frames < MAX_FRAMES;
}

static int play(const char *path, int64_t *now_us)
{
    const grobo_read_options how = {GROBO_READ_OPTIONS_INIT, .model = grobo_gr001_model()};
    const grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .mode = GROBO_PLAY_RATE};
    grobo_motion *motion;
    grobo_clip clip;
    int result = grobo_motion_read_file(path, &how, NULL, &motion);
    if (result < 0) {
        return result;
    }
    result = grobo_motion_clip(motion, NULL, &clip);
    if (result >= 0) {
        state = GROBO_SEQUENCER_IDLE;
        result = grobo_robot_play(&robot, &clip, &options);
        int64_t give_up_us = *now_us + GIVE_UP_US;
        int64_t look_us = 0;
        while (result >= 0 && state != GROBO_SEQUENCER_FINISHED) {
            int64_t next_us = pump(*now_us);
            if (state == GROBO_SEQUENCER_PLAYING && *now_us >= look_us) {
                look(*now_us);
                look_us = (look_us ? look_us : *now_us) + FRAME_US;
            }
            *now_us = look_us > *now_us && look_us < next_us ? look_us : next_us;
            result = state == GROBO_SEQUENCER_FAILED || *now_us > give_up_us ? GROBO_ERR_STATE : 0;
        }
        grobo_motion_clip_free(&clip);
    }
    grobo_motion_free(motion);
    return result;
}

/* ---- where the links are ------------------------------------------------------------------ */

static void put(const grobo_transform *at, const double p[3], double to[3])
{
    for (int i = 0; i < 3; i++) {
        to[i] =
            at->p_m[i] + at->r[3 * i] * p[0] + at->r[3 * i + 1] * p[1] + at->r[3 * i + 2] * p[2];
    }
}

/* The root that keeps the right foot flat on the origin. */
static void place(int frame)
{
    double q_rad[JOINTS];
    for (int j = 0; j < JOINTS; j++) {
        q_rad[j] = frames[frame][j] * DEG;
    }
    grobo_transform root = {{0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    grobo_body_forward(grobo_gr001_body(), &root, q_rad, places[frame]);
    const grobo_transform foot = places[frame][R_FOOT];
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            root.r[3 * i + k] = foot.r[3 * k + i];
            root.p_m[i] -= foot.r[3 * k + i] * foot.p_m[k];
        }
    }
    grobo_body_forward(grobo_gr001_body(), &root, q_rad, places[frame]);
}

/* ---- drawing ------------------------------------------------------------------------------ */

typedef struct point {
    enum link link;
    double p[3];
} point;

/* To the right and upwards, in pixels. */
static void project(int frame, const point *p, double px[2])
{
    double at[3];
    put(&places[frame][p->link], p->p, at);
    double away = at[1] * sin(AZIMUTH) - at[0] * cos(AZIMUTH);
    px[0] = LEFT_PX + (at[0] * sin(AZIMUTH) + at[1] * cos(AZIMUTH)) * PIXELS_PER_M;
    px[1] = BOTTOM_PX - (at[2] * cos(ELEVATION) + away * sin(ELEVATION)) * PIXELS_PER_M;
}

static bool moves(const point *points, int n)
{
    for (int f = 1; f < n_frames; f++) {
        for (int i = 0; i < n; i++) {
            double first[2];
            double px[2];
            project(0, &points[i], first);
            project(f, &points[i], px);
            if (hypot(px[0] - first[0], px[1] - first[1]) > STILL_PX) {
                return true;
            }
        }
    }
    return false;
}

static void print_shape(int frame, const point *points, int n)
{
    for (int i = 0; i < n; i++) {
        double px[2];
        project(frame, &points[i], px);
        printf("%c%.1f %.1f", i ? 'L' : 'M', px[0], px[1]);
    }
    printf("%s", n > 2 ? "Z" : n == 1 ? "h0" : "");
}

/* A path through points of links, closed where it has an area; one point is a dot. */
static void print_path(const char *attribute, const point *points, int n)
{
    printf("<path %s d=\"", attribute);
    print_shape(0, points, n); /* as it stands where nothing moves an SVG */
    if (!moves(points, n)) {
        printf("\"/>\n");
        return;
    }
    printf("\"><animate attributeName=\"d\" values=\"");
    for (int f = 0; f < n_frames; f++) {
        printf("%s", f ? ";" : "");
        print_shape(f, points, n);
    }
    printf("\" dur=\"%.1fs\" repeatCount=\"indefinite\"/></path>\n",
           n_frames * FRAME_US / 1000000.0);
}

/* The three faces of a box that are seen: its front, its right side, its top. */
static void print_box(enum link link, const double low[3], const double high[3])
{
    const double *corner[2] = {low, high};
    static const struct {
        const char *class;
        unsigned char at[4]; /* bits: x, y, z of low or high */
    } faces[] = {{"class=\"f\"", {1, 3, 7, 5}},
                 {"class=\"s\"", {0, 1, 5, 4}},
                 {"class=\"t\"", {4, 5, 7, 6}}};
    for (size_t face = 0; face < sizeof faces / sizeof faces[0]; face++) {
        point points[4];
        for (int i = 0; i < 4; i++) {
            unsigned at = faces[face].at[i];
            points[i] =
                (point){link, {corner[at & 1][0], corner[at >> 1 & 1][1], corner[at >> 2][2]}};
        }
        print_path(faces[face].class, points, 4);
    }
}

/* A limb with its outline, from a joint to the next, and the joint on it. */
static void print_limb(char kind, point from, point to)
{
    static int number;
    char id[24];
    number++;
    snprintf(id, sizeof id, "id=\"p%d\"", number);
    printf("<g class=\"%c o\">", kind);
    print_path(id, (const point[]){from, to}, 2);
    printf("</g><use href=\"#p%d\" class=\"%c\"/>", number, kind);
    print_path("class=\"j\"", &from, 1);
}

static void print_leg(enum link hip, int side)
{
    print_box(hip + 3, (double[3]){-0.045, -0.0275 + side * 0.01, -0.022},
              (double[3]){0.033, 0.0275 + side * 0.01, -0.010});
    print_limb('l', (point){hip + 1, {0}}, (point){hip + 2, {0}});
    print_limb('l', (point){hip, {0}}, (point){hip + 1, {0}});
}

static void print_arm(enum link shoulder)
{
    print_limb('a', (point){shoulder, {0}}, (point){shoulder + 1, {0}});
    print_limb('a', (point){shoulder + 1, {0}}, (point){shoulder + 1, {0.002, 0, -0.055}});
}

static void print_figure(void)
{
    print_arm(L_SHOULDER);
    print_leg(L_HIP, 1);
    print_leg(R_HIP, -1);
    print_box(WAIST, (double[3]){-0.018, -0.034, -0.022}, (double[3]){0.046, 0.034, 0.016});
    print_box(CHEST, (double[3]){-0.058, -0.040, 0.004}, (double[3]){0.008, 0.040, 0.062});
    print_box(HEAD, (double[3]){-0.024, -0.023, 0.009}, (double[3]){0.022, 0.023, 0.044});
    print_path("class=\"v\"",
               (const point[]){{HEAD, {0.022, -0.017, 0.019}},
                               {HEAD, {0.022, 0.017, 0.019}},
                               {HEAD, {0.022, 0.017, 0.034}},
                               {HEAD, {0.022, -0.017, 0.034}}},
               4);
    print_arm(R_SHOULDER);
}

/* ---- curves ------------------------------------------------------------------------------- */

static void print_curve(int joint, int middle_px)
{
    double low = frames[0][joint];
    double high = low;
    for (int f = 1; f < n_frames; f++) {
        low = fmin(low, frames[f][joint]);
        high = fmax(high, frames[f][joint]);
    }
    double scale = 44 / fmax(high - low, 1);
    printf("<text x=\"%d\" y=\"%d\">%s</text>\n", CURVE_X, middle_px - 30,
           grobo_model_joint(grobo_gr001_model(), joint)->name);
    printf("<text x=\"%d\" y=\"%d\" text-anchor=\"end\">%.0f to %.0f°</text>\n", CURVE_X + CURVE_W,
           middle_px - 30, low, high);
    printf("<path class=\"c\" d=\"");
    for (int f = 0; f < n_frames; f++) {
        printf("%c%.1f %.1f", f ? 'L' : 'M', CURVE_X + f * (double)CURVE_W / n_frames,
               middle_px + 22 - (frames[f][joint] - low) * scale);
    }
    printf("\"/>\n");
}

static void print_svg(int n_motions, char **motions)
{
    printf("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 620 360\" "
           "font-family=\"sans-serif\" font-size=\"12\">\n<title>A simulated GR001 plays");
    for (int i = 0; i < n_motions; i++) {
        printf("%s %s", i ? "," : "", motions[i]);
    }
    printf("</title>\n<style>\n"
           "path{stroke-linejoin:round;stroke-linecap:round;fill:none}\n"
           ".f{fill:#dfe5ec}.s{fill:#b4bfcb}.t{fill:#f4f7fa}\n"
           ".f,.s,.t{stroke:#39434e;stroke-width:2}\n"
           ".l{stroke:#cdd6df;stroke-width:23}.a{stroke:#cdd6df;stroke-width:18}\n"
           ".o{stroke:#39434e}.l.o{stroke-width:27}.a.o{stroke-width:22}\n"
           ".j{stroke:#2f6fb3;stroke-width:9}.v{fill:#1d2733}\n"
           ".g{fill:#8892a0;fill-opacity:.25}\n"
           ".c,.n{stroke:#2f7fd0;stroke-width:2}.n{stroke-width:1}\n"
           "text{fill:#57606a}\n"
           "@media(prefers-color-scheme:dark){text{fill:#9aa4af}.o,.f,.s,.t{stroke:#68737f}}\n"
           "</style>\n");
    printf("<ellipse class=\"g\" cx=\"175\" cy=\"322\" rx=\"120\" ry=\"30\"/>\n");
    print_figure();
    print_curve(16 - 1, 80);
    print_curve(14 - 1, 180);
    print_curve(4 - 1, 280);
    double length_s = n_frames * FRAME_US / 1000000.0;
    printf("<path class=\"n\" d=\"M%d 56V306\"><animateTransform attributeName=\"transform\" "
           "type=\"translate\" from=\"0\" to=\"%d\" dur=\"%.1fs\" repeatCount=\"indefinite\"/>"
           "</path>\n",
           CURVE_X, CURVE_W, length_s);
    printf("<text x=\"%d\" y=\"336\">angles of the simulated servos, %.1f s</text>\n</svg>\n",
           CURVE_X, length_s);
}

int main(int argc, char **argv)
{
    const grobo_sim_config config = {GROBO_SIM_CONFIG_INIT, .model = grobo_gr001_model()};
    int64_t now_us = 0;
    int result = grobo_sim_init(&sim, &config, 0);
    if (result >= 0) {
        result = grobo_robot_init(&robot, grobo_gr001_driver(GROBO_WIRING_BOARD), NULL, NULL, 0);
    }
    if (result >= 0) {
        grobo_robot_on_event(&robot, on_event, NULL);
        grobo_robot_link_up(&robot, 0);
    }
    for (int i = 1; i < argc && result >= 0; i++) {
        result = play(argv[i], &now_us);
        if (result < 0) {
            fprintf(stderr, "picture: %s: %s\n", argv[i], grobo_error_text(result));
        }
    }
    for (int f = 0; f < n_frames; f++) {
        place(f);
    }
    if (result >= 0 && n_frames > 1) {
        print_svg(argc - 1, argv + 1);
    }
    return result < 0 || n_frames < 2;
}
