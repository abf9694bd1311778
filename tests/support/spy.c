/* SPDX-License-Identifier: MIT */
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/spy.h"

enum { ARGUMENTS = 32 };

/* Bytes of a frame as far as its beginning tells: A, P: fixed; S, T: the second byte counts. */
static size_t frame_size(const uint8_t *bytes, size_t size)
{
    switch (bytes[0]) {
    case 0x41:
        return 2;
    case 0x50:
        return 3;
    case 0x53:
    case 0x54:
        return size < 2 ? 0 : 2 + (size_t)bytes[1];
    }
    return 1;
}

static void note(spy *s, int64_t now_us)
{
    static const uint8_t head[] = {0x53, 0x6C, 0xFA, 0xAF, 0x00, 0x00, 0x1E, 0x05, 0x14};
    spy_frame *pose = &s->poses[s->n_poses];
    if (s->part_size != SPY_POSE_BYTES || memcmp(s->part, head, sizeof head) != 0 ||
        s->n_poses == SPY_FRAMES) {
        return;
    }
    pose->at_us = now_us;
    pose->size = s->part_size;
    memcpy(pose->bytes, s->part, s->part_size);
    s->n_poses++;
    if (s->on_pose) {
        s->on_pose(s);
    }
}

static void on_tap(void *ctx, grobo_direction direction, int64_t now_us, const uint8_t *bytes,
                   size_t size)
{
    spy *s = ctx;
    if (direction != GROBO_DIR_RX) {
        return;
    }
    s->bytes += size;
    for (size_t i = 0; i < size; i++) {
        s->part[s->part_size++] = bytes[i];
        if (frame_size(s->part, s->part_size) == s->part_size) {
            note(s, now_us);
            s->part_size = 0;
        }
    }
}

static void on_child(evutil_socket_t number, short what, void *ctx)
{
    spy *s = ctx;
    int status;
    (void)number;
    (void)what;
    if (waitpid(s->child, &status, WNOHANG) != s->child) {
        return;
    }
    s->running = false;
    s->status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    event_base_loopbreak(s->base);
}

bool spy_open(spy *s, const grobo_sim_config *sim)
{
    grobo_sim_server_config config = {GROBO_SIM_SERVER_CONFIG_INIT, .sim = sim, .on_tap = on_tap,
                                      .ctx = s};
    grobo_os_cause cause;
    memset(s, 0, sizeof *s);
    s->poses = calloc(SPY_FRAMES, sizeof *s->poses);
    s->base = grobo_loop_new();
    if (!s->poses || !s->base) {
        return false;
    }
    config.base = s->base;
    s->ended = evsignal_new(s->base, SIGCHLD, on_child, s);
    return s->ended && evsignal_add(s->ended, NULL) == 0 &&
           grobo_sim_server_new(&config, &s->server, &cause) == GROBO_OK;
}

static void be_the_child(const spy *s, const char *program, const char *const *arguments)
{
    const char *all[ARGUMENTS + 4] = {program, "-d", grobo_sim_server_device(s->server)};
    for (int i = 0; i < ARGUMENTS && arguments[i]; i++) {
        all[3 + i] = arguments[i];
    }
    if (dup2(fileno(s->file), STDOUT_FILENO) >= 0) {
        execv(program, (char *const *)(uintptr_t)all);
    }
    _exit(127);
}

int spy_run(spy *s, const char *const *arguments, int limit_s)
{
    const char *program = getenv("GRCTL");
    struct timeval limit = {limit_s, 0};
    size_t n;
    s->file = tmpfile();
    if (!program || !s->file) {
        return -1;
    }
    s->child = fork();
    if (s->child == 0) {
        be_the_child(s, program, arguments);
    }
    s->running = s->child > 0;
    event_base_loopexit(s->base, &limit);
    while (s->running && !event_base_got_exit(s->base)) {
        event_base_loop(s->base, EVLOOP_ONCE);
    }
    if (s->running) {
        kill(s->child, SIGKILL);
        waitpid(s->child, NULL, 0);
        s->status = -1;
    }
    rewind(s->file);
    n = fread(s->out, 1, sizeof s->out - 1, s->file);
    s->out[n] = '\0';
    fclose(s->file);
    return s->status;
}

void spy_close(spy *s)
{
    grobo_sim_server_free(s->server);
    if (s->ended) {
        event_free(s->ended);
    }
    if (s->base) {
        event_base_free(s->base);
    }
    free(s->poses);
}

int spy_angle_ddeg(const spy_frame *frame, int motor)
{
    const uint8_t *at = &frame->bytes[5 * (motor - 1) + 10];
    return (int16_t)(at[0] | at[1] << 8);
}

int spy_time_cs(const spy_frame *frame, int motor)
{
    const uint8_t *at = &frame->bytes[5 * (motor - 1) + 12];
    return at[0] | at[1] << 8;
}
