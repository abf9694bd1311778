/* SPDX-License-Identifier: MIT */
/*
 * Reading and writing motion files, as ratios to what cannot be avoided: libyaml's own parsing for
 * YAML, the C library's strtod() for .m. And memory: of a long motion, and of reading one. Ends
 * with 1 where more memory is taken than promised, or hostile texts take seconds.
 */
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <yaml.h>

#include <grobo/core/motion_io.h>

#include "tests/bench/bench.h"

enum { FRAMES = 10000, POSES = 5000, JOINTS = 20, ROUNDS = 5, LONG_FRAMES = 1000000 };

/* A text in memory. */
typedef struct text {
    char *data;
    size_t size, room;
} text;

static int take(void *ctx, const void *data, size_t size)
{
    text *to = ctx;

    if (to->size + size + 1 > to->room) {
        to->room = (to->size + size + 1) * 2;
        to->data = realloc(to->data, to->room);
        if (to->data == NULL) {
            return GROBO_ERR_NOMEM;
        }
    }
    memcpy(to->data + to->size, data, size);
    to->size += size;
    to->data[to->size] = '\0';
    return 0;
}

/* Angles as files have them: of nine digits in Choreonoid's, of 0.1 degrees in .m. */
static double angle_of(grobo_motion_kind kind, size_t n, int j)
{
    long mixed = (long)((n * 7919 + (size_t)j * 104729003) % 2000000003) - 1000000001;

    return kind == GROBO_MOTION_POSTURES ? grobo_rad_from_ddeg((int)(mixed / 1000000))
                                         : (double)mixed / 1e9;
}

static grobo_motion *make_motion(grobo_motion_kind kind, size_t size)
{
    grobo_motion *motion = NULL;
    grobo_posture posture;

    if (grobo_motion_new(kind, JOINTS, NULL, &motion) < 0 ||
        grobo_posture_init(&posture, JOINTS) < 0) {
        return NULL;
    }
    if (kind == GROBO_MOTION_FRAMES) {
        (void)grobo_motion_set_frame_rate(motion, 500);
    }
    for (size_t n = 0; n < size; n++) {
        for (int j = 0; j < JOINTS; j++) {
            (void)grobo_posture_set_rad(&posture, j, angle_of(kind, n, j));
        }
        posture.time_us = 20000;
        if (grobo_motion_append(motion, &posture) < 0) {
            grobo_motion_free(motion);
            return NULL;
        }
    }
    return motion;
}

static double now_ms(void)
{
    return bench_cpu_us() / 1000;
}

/* ---- what it is compared with ------------------------------------------------------------- */

static void libyaml_alone(const text *file)
{
    yaml_parser_t parser;
    yaml_event_t event;
    bool more = yaml_parser_initialize(&parser);

    yaml_parser_set_input_string(&parser, (const unsigned char *)file->data, file->size);
    while (more) {
        more = yaml_parser_parse(&parser, &event) && event.type != YAML_STREAM_END_EVENT;
        yaml_event_delete(&event);
    }
    yaml_parser_delete(&parser);
}

static volatile double sink_value;

static void strtod_alone(const text *file)
{
    char *p = file->data;
    double sum = 0;

    for (;;) {
        char *end;
        double value = strtod(p, &end);
        if (end == p) {
            break;
        }
        sum += value;
        p = end;
    }
    sink_value = sum;
}

/* ---- time --------------------------------------------------------------------------------- */

static void read_it(const text *file)
{
    grobo_motion *motion = NULL;

    (void)grobo_motion_read_memory(file->data, file->size, NULL, NULL, &motion);
    grobo_motion_free(motion);
}

/* Medians over the rounds. Ratios are of neighbours in time, which saw the same machine. */
typedef struct times {
    double base_ms, read_ms, write_ms, read_ratio, write_ratio;
} times;

static int compare(const void *a, const void *b)
{
    double left = *(const double *)a, right = *(const double *)b;

    return (left > right) - (left < right);
}

static double median(double *values)
{
    qsort(values, ROUNDS, sizeof *values, compare);
    return values[ROUNDS / 2];
}

static times measure(const grobo_motion *motion, const text *file, void (*base)(const text *file))
{
    double base_ms[ROUNDS], read_ms[ROUNDS], write_ms[ROUNDS], reads[ROUNDS], writes[ROUNDS];
    text out = {0};

    /* Room for what is written is not the writer's work. */
    (void)grobo_motion_write(motion, GROBO_FORMAT_AUTO, NULL, &(grobo_sink){take, &out}, NULL);
    for (int round = 0; round < ROUNDS; round++) {
        out.size = 0;
        double t0 = now_ms();
        base(file);
        double t1 = now_ms();
        read_it(file);
        double t2 = now_ms();
        (void)grobo_motion_write(motion, GROBO_FORMAT_AUTO, NULL, &(grobo_sink){take, &out}, NULL);
        double t3 = now_ms();
        base_ms[round] = t1 - t0;
        read_ms[round] = t2 - t1;
        write_ms[round] = t3 - t2;
        reads[round] = read_ms[round] / base_ms[round];
        writes[round] = write_ms[round] / read_ms[round];
    }
    free(out.data);
    return (times){median(base_ms), median(read_ms), median(write_ms), median(reads),
                   median(writes)};
}

static void format_row(const char *name, const char *what, const char *who, double ms, double mb)
{
    char measure[96];

    (void)snprintf(measure, sizeof measure, "%s %.0f MB of %s, ms", what, mb, name);
    bench_row("S9", measure, who, ms);
}

static bool bench_format(const char *name, grobo_motion_kind kind, size_t size, const char *floor,
                         void (*base)(const text *file))
{
    grobo_motion *motion = make_motion(kind, size);
    text file = {0};

    if (motion == NULL ||
        grobo_motion_write(motion, GROBO_FORMAT_AUTO, NULL, &(grobo_sink){take, &file}, NULL) < 0) {
        fprintf(stderr, "bench_motion: %s failed\n", name);
        return false;
    }
    times t = measure(motion, &file, base);
    double mb = (double)file.size / 1e6;

    format_row(name, "read", "grobo", t.read_ratio * t.base_ms, mb);
    format_row(name, "read", floor, t.base_ms, mb);
    format_row(name, "write", "grobo", t.write_ms, mb);
    free(file.data);
    grobo_motion_free(motion);
    return true;
}

/* The cost of a frame must not grow with their number. */
static void bench_growth(size_t frames)
{
    grobo_motion *motion = make_motion(GROBO_MOTION_FRAMES, frames);
    text file = {0};
    char measure[96];

    if (motion != NULL && grobo_motion_write(motion, GROBO_FORMAT_AUTO, NULL,
                                             &(grobo_sink){take, &file}, NULL) >= 0) {
        const double begin_ms = now_ms();
        read_it(&file);
        (void)snprintf(measure, sizeof measure, "read yaml of %zu frames, us a frame", frames);
        bench_row("S9", measure, "grobo", (now_ms() - begin_ms) * 1000 / (double)frames);
    }
    free(file.data);
    grobo_motion_free(motion);
}

/* Small texts that cost a parser much. */
static bool bench_hostile(const char *name, const char *unit, size_t size, double allowed_ms)
{
    text file = {0};

    while (file.size < size) {
        (void)take(&file, unit, strlen(unit));
    }
    double begin_ms = now_ms();
    read_it(&file);
    double took_ms = now_ms() - begin_ms;
    if (took_ms > allowed_ms) {
        fprintf(stderr, "bench_motion: %s: %.2f ms, %.0f allowed\n", name, took_ms, allowed_ms);
    }
    free(file.data);
    return took_ms <= allowed_ms;
}

/* ---- memory ------------------------------------------------------------------------------- */

static size_t most_bytes(void)
{
    struct rusage usage;

    (void)getrusage(RUSAGE_SELF, &usage);
    return (size_t)usage.ru_maxrss * 1024;
}

/* The motion alone, and reading it from a file, each in a process of its own. */
static size_t grown_by(bool reading, const char *path)
{
    int ends[2];
    size_t grown = 0;

    if (pipe(ends) != 0) {
        return 0;
    }
    (void)fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        grobo_motion *motion = NULL;
        size_t before = most_bytes();
        if (reading) {
            (void)grobo_motion_read_file(path, NULL, NULL, &motion);
        } else {
            motion = make_motion(GROBO_MOTION_FRAMES, LONG_FRAMES / 10);
        }
        grown = grobo_motion_size(motion) == LONG_FRAMES / 10 ? most_bytes() - before : 0;
        _exit(write(ends[1], &grown, sizeof grown) != sizeof grown);
    }
    if (child > 0) {
        (void)waitpid(child, NULL, 0);
        grown = read(ends[0], &grown, sizeof grown) == sizeof grown ? grown : 0;
    }
    (void)close(ends[0]);
    (void)close(ends[1]);
    return grown;
}

static int to_file(void *ctx, const void *data, size_t size)
{
    return fwrite(data, 1, size, ctx) == size ? 0 : GROBO_ERR_IO;
}

static bool bench_memory(void)
{
    char path[] = "/tmp/grobo-bench-XXXXXX";
    int fd = mkstemp(path);
    FILE *file = fd >= 0 ? fdopen(fd, "wb") : NULL;
    grobo_motion *motion = make_motion(GROBO_MOTION_FRAMES, LONG_FRAMES / 10);

    if (file == NULL || motion == NULL ||
        grobo_motion_write(motion, GROBO_FORMAT_AUTO, NULL, &(grobo_sink){to_file, file}, NULL) <
            0) {
        printf("memory failed\n");
        return false;
    }
    (void)fclose(file);
    grobo_motion_free(motion);
    size_t alone = grown_by(false, path), reading = grown_by(true, path);
    (void)unlink(path);
    double million_mb = (double)alone * 10 / 1e6;
    double more_mib = ((double)reading - (double)alone) / 1048576;
    bool kept = alone > 0 && million_mb <= 200 && more_mib <= 2;
    bench_row("S9", "a frame of 20 joints, bytes", "grobo", million_mb);
    bench_row("S9", "reading takes more than the motion, MiB", "grobo", more_mib);
    if (!kept) {
        fputs("bench_motion: 200 bytes a frame and 2 MiB are allowed\n", stderr);
    }
    return kept;
}

/* usage: bench_motion FILE FRAMES: writes a file for a peer to read. */
static int write_sample(const char *path, size_t frames)
{
    FILE *file = fopen(path, "wb");
    grobo_motion *motion = make_motion(GROBO_MOTION_FRAMES, frames);
    int r = file == NULL || motion == NULL ? GROBO_ERR_NOMEM
                                           : grobo_motion_write(motion, GROBO_FORMAT_AUTO, NULL,
                                                                &(grobo_sink){to_file, file}, NULL);

    grobo_motion_free(motion);
    return file == NULL || fclose(file) != 0 || r < 0 ? 1 : 0;
}

int main(int argc, char **argv)
{
    if (argc == 3) {
        return write_sample(argv[1], (size_t)bench_number(argv[2]));
    }
    bool kept = bench_memory(); /* first: what was freed would hide what is taken */

    kept &= bench_format("m", GROBO_MOTION_POSTURES, FRAMES, "floor strtod", strtod_alone);
    kept &= bench_format("pseq", GROBO_MOTION_KEYS, POSES, "floor libyaml", libyaml_alone);
    kept &= bench_format("mseq", GROBO_MOTION_STEPS, POSES, "floor libyaml", libyaml_alone);
    kept &= bench_format("yaml", GROBO_MOTION_FRAMES, FRAMES, "floor libyaml", libyaml_alone);
    for (size_t frames = 1000; frames <= LONG_FRAMES / 5; frames *= 10) {
        bench_growth(frames);
    }
    kept &= bench_hostile("40 kB of [", "[", 40000, 50);
    kept &= bench_hostile("40 kB of x: [", "x: [", 40000, 50);
    kept &= bench_hostile("100 MB of [", "[", 100000000, 2000);
    kept &= bench_hostile("100 MB of a: - ? {", "a: - ? { ", 100000000, 2000);
    return kept ? 0 : 1;
}
