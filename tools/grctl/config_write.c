/* SPDX-License-Identifier: MIT */
/* Writing trims into a configuration file that a person wrote: only they change. */
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <grobo/model.h>

#include "config.h"

static int fail(app *a, const char *path, int cause)
{
    return app_fail(a, EXIT_FILE, "IO", "%s: cannot be written: %s", path, strerror(cause));
}

/* libyaml counts characters, files bytes. */
static size_t byte_of(const char *text, size_t characters)
{
    size_t i = 0;
    if (strncmp(text, "\xef\xbb\xbf", 3) == 0) /* a byte order mark counts as none */
        i = 3;
    for (; text[i] && characters > 0; characters--)
        for (i++; ((unsigned char)text[i] & 0xc0) == 0x80;)
            i++;
    return i;
}

static char *read_all(const char *path)
{
    FILE *file = fopen(path, "rb");
    char *text = file ? calloc(1, CONFIG_FILE_MAX_BYTES + 1) : NULL;
    if (text && fread(text, 1, CONFIG_FILE_MAX_BYTES, file) == CONFIG_FILE_MAX_BYTES) {
        errno = EFBIG;
        free(text);
        text = NULL;
    }
    if (file)
        fclose(file);
    return text;
}

static void put_trims(FILE *to, const config_robot *robot)
{
    const char *before = "";
    putc('{', to);
    for (int j = 0; j < grobo_gr001_model.n_joints; j++) {
        if (robot->trim_deg[j] == 0)
            continue;
        fprintf(to, "%s%s: %.1f", before, grobo_gr001_model.joints[j].name, robot->trim_deg[j]);
        before = ", ";
    }
    putc('}', to);
}

static void put_file(FILE *to, const char *text, const config_robot *robot)
{
    size_t at = byte_of(text, robot->trimmed ? robot->trim_at : robot->first_at);
    size_t end = byte_of(text, robot->trimmed ? robot->trim_end : robot->first_at);
    fwrite(text, 1, at, to);
    if (!robot->trimmed)
        fputs("trim: ", to);
    put_trims(to, robot);
    if (!robot->trimmed && robot->flow)
        fputs(", ", to);
    else if (!robot->trimmed)
        fprintf(to, "\n%*s", (int)robot->first_column, "");
    fputs(text + end, to);
}

/* The file behind a symbolic link is replaced, not the link. */
static int replace(app *a, const char *path, const char *text, const config_robot *robot)
{
    char temporary[CONFIG_PATH_BYTES + 16];
    struct stat old;
    int fd, cause = 0;
    FILE *to;
    snprintf(temporary, sizeof temporary, "%s.XXXXXX", path);
    fd = mkstemp(temporary);
    if (fd < 0)
        return fail(a, path, errno);
    if (stat(path, &old) == 0)
        fchmod(fd, old.st_mode & 07777);
    to = fdopen(fd, "w");
    if (!to) {
        cause = errno;
        close(fd);
    } else {
        put_file(to, text, robot);
        if (fflush(to) != 0 || fsync(fd) != 0)
            cause = errno;
        if (fclose(to) != 0 && !cause)
            cause = errno;
    }
    if (!cause && rename(temporary, path) != 0)
        cause = errno;
    if (!cause)
        return EXIT_DONE;
    unlink(temporary);
    return fail(a, path, cause);
}

int config_write_trims(app *a, const config_robot *robot)
{
    char *real = realpath(robot->path, NULL);
    char *text = real ? read_all(real) : NULL;
    int status = text ? replace(a, real, text, robot) : fail(a, robot->path, errno);
    free(text);
    free(real);
    return status;
}
