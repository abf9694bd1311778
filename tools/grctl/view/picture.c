/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "tools/grctl/cli/file.h"
#include "tools/grctl/cli/output.h"
#include "tools/grctl/os/os.h"
#include "tools/grctl/view/picture.h"

/* They read SVG from standard input and write PNG to standard output, two pixels for one. */
static const char *const rasterisers[][8] = {
    {"rsvg-convert", "--format=png", "--zoom=2"},
    {"inkscape", "--pipe", "--export-type=png", "--export-dpi=192", "--export-filename=-"},
    {"magick", "-density", "192", "svg:-", "png:-"},
    {"convert", "-density", "192", "svg:-", "png:-"},
};
enum { RASTERISERS = sizeof rasterisers / sizeof rasterisers[0] };

picture_format picture_format_of(const char *path)
{
    const char *dot = strrchr(file_last_part(path), '.');
    if (dot && strcasecmp(dot, ".svg") == 0) {
        return PICTURE_SVG;
    }
    if (dot && strcasecmp(dot, ".png") == 0) {
        return PICTURE_PNG;
    }
    return PICTURE_NONE;
}

bool picture_is_foreign(const char *path)
{
    char start[128];
    size_t signature = strlen(svg_signature);
    FILE *file = fopen(path, "rb");
    if (!file) {
        return errno != ENOENT;
    }
    size_t n = fread(start, 1, sizeof start, file);
    fclose(file);
    return n < signature || memcmp(start, svg_signature, signature) != 0;
}

/* ---- files --------------------------------------------------------------------------------- */

static int refuse(app *a, const char *path, int error)
{
    return app_fail(a, EXIT_FILE, grobo_error_name(error), "%s: cannot write: %s", path,
                    file_write_error_text(error));
}

static int save_stream(app *a, const char *path, FILE *from)
{
    heap all = file_rest(from, SIZE_MAX);
    int error = all.bytes ? file_save(path, all.bytes, all.size) : GROBO_ERR_IO;
    free(all.bytes);
    return error ? refuse(a, path, error) : 0;
}

/* ---- PNG ----------------------------------------------------------------------------------- */

static bool is_png(FILE *file)
{
    static const unsigned char magic[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    unsigned char start[sizeof magic];
    rewind(file);
    if (fread(start, 1, sizeof start, file) != sizeof start) {
        return false;
    }
    rewind(file);
    return memcmp(start, magic, sizeof magic) == 0;
}

/* Tries one program after the other. Returns the one that drew a picture, or NULL. */
static const char *rasterise(const app *a, FILE *in, FILE *out, const char **tried)
{
    for (int i = 0; i < RASTERISERS; i++) {
        rewind(in);
        if (ftruncate(fileno(out), 0) != 0 || lseek(fileno(in), 0, SEEK_SET) != 0) {
            return NULL;
        }
        rewind(out);
        intptr_t program = os_begin(rasterisers[i], in, out, NULL);
        if (program < 0) {
            continue; /* it is not here */
        }
        if (os_wait(program) == 0 && is_png(out)) {
            return rasterisers[i][0];
        }
        *tried = rasterisers[i][0];
        app_detail(a, "%s did not draw it", *tried);
    }
    return NULL;
}

static int save_png(app *a, const svg *drawing, const char *path)
{
    const char *tried = NULL, *used = NULL;
    FILE *in = os_temporary(), *out = os_temporary();
    int status = 0;
    if (!in || !out || fwrite(drawing->bytes, 1, drawing->size, in) != drawing->size ||
        fflush(in) != 0) {
        status = app_fail(a, EXIT_FILE, "IO", "%s: no room for temporary files", path);
    } else {
        used = rasterise(a, in, out, &tried);
        if (used) {
            status = save_stream(a, path, out);
        } else if (tried) {
            status = app_fail(a, EXIT_FILE, "IO", "%s: %s could not draw it; write .svg instead",
                              path, tried);
        } else {
            status = app_fail(a, EXIT_FILE, "UNSUPPORTED",
                              "%s: PNG needs rsvg-convert, inkscape or ImageMagick; install one "
                              "(Debian: librsvg2-bin) or write .svg",
                              path);
        }
    }
    if (in) {
        fclose(in);
    }
    if (out) {
        fclose(out);
    }
    return status;
}

int picture_save(app *a, const svg *drawing, const char *path, picture_format format)
{
    if (format == PICTURE_PNG) {
        return save_png(a, drawing, path);
    }
    if (strcmp(path, "-") != 0) {
        int error = file_save(path, drawing->bytes, drawing->size);
        return error ? refuse(a, path, error) : 0;
    }
    output_bytes(drawing->bytes, drawing->size); /* the end of the program says if it failed */
    return 0;
}
