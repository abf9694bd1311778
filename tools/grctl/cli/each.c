/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "tools/grctl/cli/each.h"
#include "tools/grctl/os/os.h"

enum { LINE_BYTES = 1 << 16 };

typedef struct one {
    intptr_t program; /* -1: none */
    FILE *out, *err;
} one;

/* The words of the line with another device, which is the last to be named. */
static const char **words_for(const char *robot, int argc, char *const *argv)
{
    const char **words = calloc((size_t)argc + 3, sizeof *words);
    int n = 0, i = 1;
    if (!words) {
        return NULL;
    }
    words[n++] = os_own_program(argv[0]);
    for (; i < argc && strcmp(argv[i], "--") != 0; i++) {
        words[n++] = argv[i];
    }
    words[n++] = "-d";
    words[n++] = robot;
    for (; i < argc; i++) {
        words[n++] = argv[i];
    }
    return words;
}

static int begin(app *a, one *child, const char *robot, int argc, char *const *argv)
{
    const char **words = words_for(robot, argc, argv);
    child->out = os_temporary();
    child->err = os_temporary();
    child->program =
        words && child->out && child->err ? os_begin(words, NULL, child->out, child->err) : -1;
    free(words);
    return child->program < 0 ? app_fail(a, EXIT_ROBOT, "IO", "%s: cannot be started", robot) : 0;
}

static void print_json(const char *robot, char *line)
{
    json_t *object = json_loads(line, 0, NULL);
    if (object) {
        json_object_set_new(object, "name", json_string(robot));
        app_print_json(object);
    }
}

/* Lines of one robot; what was said of it too. */
static void give_out(const app *a, const char *robot, FILE *from, bool said)
{
    char *line = malloc(LINE_BYTES);
    if (!line) {
        return;
    }
    rewind(from);
    while (fgets(line, LINE_BYTES, from)) {
        line[strcspn(line, "\n")] = '\0';
        if (said) {
            fprintf(stderr, "%s: %s\n", robot, line);
        } else if (a->json) {
            print_json(robot, line);
        } else {
            app_print("%s: %s\n", robot, line);
        }
    }
    free(line);
}

static void end(const app *a, one *child, const char *robot, int *status)
{
    if (child->program >= 0) {
        int ended = os_wait(child->program);
        *status = ended < 0 ? EXIT_ROBOT : ended > *status ? ended : *status;
        give_out(a, robot, child->out, false);
        give_out(a, robot, child->err, true);
    }
    if (child->out) {
        fclose(child->out);
    }
    if (child->err) {
        fclose(child->err);
    }
}

int each_run(app *a, int argc, char *const *argv)
{
    one children[CONFIG_GROUP_MAX];
    int status = EXIT_DONE;
    for (int i = 0; i < a->group->n; i++) {
        int failed = begin(a, &children[i], a->group->robot[i], argc, argv);
        status = failed > status ? failed : status;
    }
    for (int i = 0; i < a->group->n; i++) {
        end(a, &children[i], a->group->robot[i], &status);
    }
    return status;
}
