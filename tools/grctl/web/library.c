/* SPDX-License-Identifier: MIT */
#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <grobo/core/port.h>

#include "tools/grctl/cli/file.h"
#include "tools/grctl/web/analyse.h"
#include "tools/grctl/web/edit.h"
#include "tools/grctl/web/fields.h"
#include "tools/grctl/web/library.h"
#include "tools/grctl/web/serve.h"

#define LOOK_US INT64_C(2000000)

/* A file of the folder, and what is known of it. */
typedef struct entry {
    char name[LIBRARY_NAME_BYTES];
    int64_t size, modified_ms;
    bool seen, looked_at;
    json_t *told; /* what the list has of it besides, once it was looked at */
} entry;

struct library {
    const app *a;
    const char *folder;
    bool known; /* it was read once: what comes now is news */
    entry entries[LIBRARY_FILES_MAX];
    int n;
    /* the loop's */
    int64_t looked_us;
    bool looking;
};

library *library_new(const app *a, const char *folder)
{
    library *l = calloc(1, sizeof *l);
    if (l) {
        l->a = a;
        l->folder = folder;
    }
    return l;
}

void library_free(library *l)
{
    for (int i = 0; l && i < l->n; i++) {
        json_decref(l->entries[i].told);
    }
    free(l);
}

/* ---- names ----------------------------------------------------------------------------------- */

bool library_is_name(const char *name)
{
    if (!*name || *name == '.' || *name == '-' || strlen(name) >= LIBRARY_NAME_BYTES - 8 ||
        grobo_motion_format_of_path(name) == GROBO_FORMAT_AUTO) {
        return false;
    }
    for (const char *c = name; *c; c++) {
        if ((unsigned char)*c < 0x20 || *c == 0x7f || strchr("/\\:*?\"<>|", *c)) {
            return false;
        }
    }
    return true;
}

static int by_name(const void *a, const void *b)
{
    return strcmp(((const entry *)a)->name, ((const entry *)b)->name);
}

static entry *find(library *l, const char *name)
{
    for (int i = 0; i < l->n; i++) {
        if (strcmp(l->entries[i].name, name) == 0) {
            return &l->entries[i];
        }
    }
    return NULL;
}

/* The true path of a file that lies in the folder; false: it is none, or leads out of it. */
static bool true_path(const library *l, const char *name, char *path, struct stat *info)
{
    return grobo_motion_find(grobo_files_os(), l->folder, name, path, GROBO_PATH_MAX_BYTES) == 0 &&
           stat(path, info) == 0 && S_ISREG(info->st_mode);
}

/* ---- what lies in the folder ----------------------------------------------------------------- */

static void note(json_t *news, const char *name, const char *what)
{
    if (!news) {
        return;
    }
    json_array_append_new(news, json_pack("[o,s]", app_json_text(name), what));
}

static void see(library *l, const char *name, json_t *news)
{
    char path[GROBO_PATH_MAX_BYTES];
    struct stat info;
    entry *e = find(l, name);
    if (!library_is_name(name) || !true_path(l, name, path, &info)) {
        return;
    }
    if (!e) {
        if (l->n == LIBRARY_FILES_MAX) {
            return;
        }
        e = &l->entries[l->n++];
        *e = (entry){.size = -1};
        snprintf(e->name, sizeof e->name, "%s", name);
        note(l->known ? news : NULL, name, "is there");
    } else if (e->size != info.st_size || e->modified_ms != (int64_t)info.st_mtime * 1000) {
        note(news, name, "has changed");
    } else {
        e->seen = true;
        return;
    }
    e->seen = true;
    e->looked_at = false;
    e->size = info.st_size;
    e->modified_ms = (int64_t)info.st_mtime * 1000;
}

static void forget_gone(library *l, json_t *news)
{
    int n = 0;
    for (int i = 0; i < l->n; i++) {
        if (l->entries[i].seen) {
            l->entries[n++] = l->entries[i];
        } else {
            note(news, l->entries[i].name, "is gone");
            json_decref(l->entries[i].told);
        }
    }
    l->n = n;
}

static void scan(library *l, json_t *news)
{
    DIR *folder = opendir(l->folder);
    struct dirent *found;
    for (int i = 0; i < l->n; i++) {
        l->entries[i].seen = false;
    }
    while (folder && (found = readdir(folder)) != NULL) {
        see(l, found->d_name, news);
    }
    if (folder) {
        closedir(folder);
    }
    l->known = true;
    forget_gone(l, news);
    qsort(l->entries, (size_t)l->n, sizeof l->entries[0], by_name);
}

/* ---- files ----------------------------------------------------------------------------------- */

/* A hash of bytes, in quotes. */
static void hash_of(const void *bytes, size_t size, char etag[LIBRARY_ETAG_BYTES])
{
    uint64_t hash = UINT64_C(0xcbf29ce484222325); /* FNV-1a */
    for (size_t i = 0; i < size; i++) {
        hash = (hash ^ ((const unsigned char *)bytes)[i]) * UINT64_C(0x100000001b3);
    }
    snprintf(etag, LIBRARY_ETAG_BYTES, "\"%016llx\"", (unsigned long long)hash);
}

int library_read(library *l, const char *name, library_file *file)
{
    struct stat info;
    memset(file, 0, sizeof *file);
    if (!find(l, name)) { /* it may have come just now */
        scan(l, NULL);
    }
    if (!find(l, name) || !true_path(l, name, file->path, &info)) {
        return GROBO_ERR_NOENT;
    }
    heap all = file_bytes(file->path, LIBRARY_FILE_BYTES);
    if (!all.bytes) {
        return errno == EFBIG ? GROBO_ERR_CAP : GROBO_ERR_IO;
    }
    file->bytes = all.bytes;
    file->size = all.size;
    hash_of(file->bytes, file->size, file->etag);
    snprintf(file->path, sizeof file->path, "%s", name);
    return GROBO_OK;
}

void library_drop(library_file *file)
{
    free(file->bytes);
    file->bytes = NULL;
}

/* Whether the folder has anything of that name: also a link that leads out of it, or nowhere. */
static bool is_taken(const library *l, const char *name)
{
    DIR *folder = opendir(l->folder);
    struct dirent *found;
    bool taken = false;
    while (folder && !taken && (found = readdir(folder)) != NULL) {
        taken = strcmp(found->d_name, name) == 0;
    }
    if (folder) {
        closedir(folder);
    }
    return taken;
}

/* Writes one, where it is as it was: GROBO_ERR_EXISTS where not. etag NULL: there shall be none. */
static int write_file(library *l, const char *name, const char *etag, const void *bytes,
                      size_t size)
{
    char path[GROBO_PATH_MAX_BYTES];
    library_file now;
    int error = library_read(l, name, &now);
    bool same = etag ? error == GROBO_OK && strcmp(etag, now.etag) == 0 : !is_taken(l, name);
    library_drop(&now);
    if (!same) {
        return GROBO_ERR_EXISTS;
    }
    int n = snprintf(path, sizeof path, "%s/%s", l->folder, name);
    return n > 0 && (size_t)n < sizeof path ? file_save(path, bytes, size) : GROBO_ERR_SPACE;
}

/* ---- a request on its way through the worker ------------------------------------------------- */

typedef struct ask ask;
struct ask {
    worker_task task;
    serve *s;
    http_request *request; /* NULL: nobody waits */
    library *l;
    void (*run)(ask *q);
    char name[LIBRARY_NAME_BYTES];
    char match[LIBRARY_ETAG_BYTES]; /* of If-Match, "" for a new file */
    double rate_hz;
    json_t *body;
    char *sent; /* bytes of a PUT */
    size_t sent_size;
    /* the answer */
    int status;
    char *text;
    size_t size;
    const char *type;
    char etag[LIBRARY_ETAG_BYTES];
    json_t *news;
    bool more; /* there is more to look at */
};

static void answer(ask *q, int status, json_t *body)
{
    heap text = {0};
    heap_json(&text, body);
    q->text = text.bytes;
    q->size = text.size;
    q->status = status;
    q->type = "application/json";
}

static void refuse(ask *q, int status, const char *code, const char *message)
{
    answer(q, status,
           json_pack("{s:{s:o,s:o}}", "error", "code", app_json_code(code), "message",
                     app_json_text(message)));
}

static void refuse_named(ask *q, const char *name, int error)
{
    char text[LIBRARY_NAME_BYTES + 64];
    int status = error == GROBO_ERR_NOENT ? 404 : error == GROBO_ERR_CAP ? 413 : 422;
    snprintf(text, sizeof text, "%s: %s", name, file_error_text(error));
    refuse(q, status, grobo_error_name(error), text);
}

static void refuse_error(ask *q, int error)
{
    refuse_named(q, q->name, error);
}

static void work(worker_task *task)
{
    ask *q = (ask *)task;
    q->run(q);
}

static void tell_news(ask *q)
{
    size_t i;
    json_t *one;
    json_array_foreach(q->news, i, one)
    {
        const char *name = json_string_value(json_array_get(one, 0));
        events_tell(&q->s->events, "file", "info", json_pack("{s:s}", "motion", name), "%s %s",
                    name, json_string_value(json_array_get(one, 1)));
    }
}

static void look_on(serve *s);

static void done(worker_task *task)
{
    ask *q = (ask *)task;
    if (!q->s->ending) {
        tell_news(q);
    }
    if (q->request && q->status == 200 && *q->etag) {
        http_reply_content(
            q->request,
            &(http_content){.type = q->type, .bytes = q->text, .size = q->size, .etag = q->etag});
    } else if (q->request) {
        http_reply_text(q->request, q->status ? q->status : 503, q->text, q->size);
    } else {
        q->l->looking = false;
    }
    if (q->more && !q->s->ending) {
        look_on(q->s);
    }
    json_decref(q->body);
    json_decref(q->news);
    free(q->sent);
    free(q->text);
    free(q);
}

/* NULL: it was refused. */
static ask *new_ask(serve *s, http_request *r, const char *name, void (*run)(ask *q))
{
    ask *q = calloc(1, sizeof *q);
    if (!q) {
        if (r) {
            serve_refuse(s, r, GROBO_ERR_NOMEM, "motions");
        }
        return NULL;
    }
    q->task = (worker_task){.work = work, .done = done};
    q->s = s;
    q->request = r;
    q->l = s->library;
    q->run = run;
    q->news = json_array();
    snprintf(q->name, sizeof q->name, "%s", name);
    if (r) {
        const char *bytes = http_body(r, &q->sent_size);
        q->sent = malloc(q->sent_size + 1);
        q->sent_size = q->sent ? q->sent_size : 0;
        if (q->sent_size) {
            memcpy(q->sent, bytes, q->sent_size);
        }
    }
    return q;
}

/* ---- looking at files ------------------------------------------------------------------------ */

static json_t *told_of(analysis *n, const library_file *file)
{
    if (!n->motion) {
        return json_pack("{s:s,s:s,s:o}", "state", "unreadable", "etag", file->etag, "check",
                         analysis_check_json(n));
    }
    return json_pack("{s:s,s:s,s:s,s:o,s:I,s:o,s:o}", "state", "ready", "etag", file->etag, "kind",
                     analysis_kind(n), "length_ms", app_json_number(analysis_length_ms(n), 3),
                     "keys", (json_int_t)grobo_motion_size(n->motion), "check",
                     analysis_check_json(n), "thumbnail", analysis_thumbnail_json(n));
}

static void look_at(library *l, entry *e)
{
    library_file file;
    analysis n;
    json_decref(e->told);
    e->told = NULL;
    e->looked_at = true;
    int error = library_read(l, e->name, &file);
    if (!error && analysis_begin(&n, l->a, e->name)) {
        analysis_read(&n, file.bytes, file.size, false);
        e->told = told_of(&n, &file);
        analysis_end(&n);
    } else {
        e->told = json_pack("{s:s}", "state", "unreadable");
    }
    library_drop(&file);
}

/* One file that nobody has looked at. */
static void run_look(ask *q)
{
    library *l = q->l;
    if (q->rate_hz > 0) { /* the first in a row */
        scan(l, q->news);
    }
    for (int i = 0; i < l->n; i++) {
        if (!l->entries[i].looked_at) {
            char name[LIBRARY_NAME_BYTES];
            snprintf(name, sizeof name, "%s", l->entries[i].name);
            look_at(l, &l->entries[i]);
            note(q->news, name, "is ready");
            q->more = true;
            return;
        }
    }
}

static void look(serve *s, bool scans)
{
    ask *q = s->library->looking ? NULL : new_ask(s, NULL, "", run_look);
    if (q) {
        q->rate_hz = scans;
        q->task.patient = true;
        s->library->looking = true;
        worker_put(s->worker, &q->task);
    }
}

static void look_on(serve *s)
{
    look(s, false);
}

void library_look(serve *s)
{
    int64_t now_us = grobo_now_us();
    if (now_us - s->library->looked_us >= LOOK_US) {
        s->library->looked_us = now_us;
        look(s, true);
    }
}

/* ---- the list -------------------------------------------------------------------------------- */

static json_t *entry_json(const entry *e)
{
    json_t *o = json_pack("{s:o,s:s,s:I,s:I,s:s}", "name", app_json_text(e->name), "format",
                          grobo_motion_format_name(grobo_motion_format_of_path(e->name)), "bytes",
                          (json_int_t)e->size, "modified_ms", (json_int_t)e->modified_ms, "state",
                          "pending");
    if (e->looked_at) {
        json_object_update(o, e->told);
    }
    return o;
}

static void run_list(ask *q)
{
    json_t *list = json_array();
    scan(q->l, q->news);
    for (int i = 0; i < q->l->n; i++) {
        json_array_append_new(list, entry_json(&q->l->entries[i]));
        q->more |= !q->l->entries[i].looked_at;
    }
    answer(q, 200,
           json_pack("{s:o,s:o}", "directory", app_json_text(q->l->folder), "motions", list));
}

static void put(serve *s, ask *q)
{
    if (q) {
        worker_put(s->worker, &q->task);
    }
}

void library_list(serve *s, http_request *r)
{
    put(s, new_ask(s, r, "", run_list));
}

/* ---- one motion ------------------------------------------------------------------------------ */

static void run_get(ask *q)
{
    library_file file;
    analysis n;
    int error = library_read(q->l, q->name, &file);
    if (error) {
        refuse_error(q, error);
    } else if (analysis_begin(&n, q->l->a, q->name)) {
        analysis_read(&n, file.bytes, file.size, true);
        memcpy(q->etag, file.etag, sizeof q->etag);
        answer(q, 200,
               json_pack("{s:o,s:s,s:s,s:s,s:o,s:o,s:o,s:o,s:o,s:o}", "name",
                         app_json_text(q->name), "format",
                         grobo_motion_format_name(grobo_motion_format_of_path(q->name)), "kind",
                         analysis_kind(&n), "etag", file.etag, "length_ms",
                         app_json_number(analysis_length_ms(&n), 3), "keys", analysis_keys_json(&n),
                         "frames", analysis_frames_json(&n, q->rate_hz), "check",
                         analysis_check_json(&n), "diagnostics", analysis_diagnostics_json(&n),
                         "balance", analysis_balance_json(&n)));
        analysis_end(&n);
    }
    library_drop(&file);
}

void library_get(serve *s, http_request *r, const char *name, double rate_hz)
{
    ask *q = new_ask(s, r, name, run_get);
    if (q) {
        q->rate_hz = rate_hz;
    }
    put(s, q);
}

static void run_get_file(ask *q)
{
    library_file file;
    int error = library_read(q->l, q->name, &file);
    if (error) {
        refuse_error(q, error);
    } else {
        q->text = file.bytes;
        q->size = file.size;
        q->status = 200;
        q->type = "application/octet-stream";
        memcpy(q->etag, file.etag, sizeof q->etag);
        file.bytes = NULL;
    }
    library_drop(&file);
}

void library_get_file(serve *s, http_request *r, const char *name)
{
    put(s, new_ask(s, r, name, run_get_file));
}

/* ---- what was sent: large, so that it is read here and not in the loop ----------------------- */

/* False: it is refused. */
static bool read_sent(ask *q)
{
    q->body = q->sent ? json_loadb(q->sent, q->sent_size, JSON_REJECT_DUPLICATES, NULL) : NULL;
    if (!json_is_object(q->body)) {
        refuse(q, 400, "syntax", "the body is no JSON object");
    }
    return !q->status;
}

/* ---- writing --------------------------------------------------------------------------------- */

/* Writes it, and tells what it is now, and what of it the format has no place for. */
static void save(ask *q, const void *bytes, size_t size, const grobo_diagnostics *lost)
{
    int error = write_file(q->l, q->name, *q->match ? q->match : NULL, bytes, size);
    if (error == GROBO_ERR_EXISTS) {
        refuse(q, 409, "changed", "the file is not as it was read");
    } else if (error) {
        refuse_error(q, error);
    } else {
        scan(q->l, q->news);
        entry *e = find(q->l, q->name);
        if (e) {
            look_at(q->l, e);
            json_t *told = entry_json(e), *notes = json_array();
            grobo_diagnostic d;
            for (size_t i = 0; grobo_diagnostics_get(lost, i, &d) == 0; i++) {
                json_array_append_new(notes, app_json_text(d.message));
            }
            json_object_set_new(told, "notes", notes);
            answer(q, 200, told);
        }
    }
}

/* The file that keys are taken from, which is still what was read. 0: it is, or it is refused. */
static int read_base(ask *q, const char *name, const char *etag, grobo_motion **base)
{
    grobo_read_options read = {GROBO_READ_OPTIONS_INIT, .model = app_model(q->l->a), .name = name};
    library_file file;
    int error = library_read(q->l, name, &file);
    if (!error && etag && strcmp(etag, file.etag) != 0) {
        refuse(q, 409, "changed", "the file is not as it was read");
    } else if (!error) {
        error = grobo_motion_read_memory(file.bytes, file.size, &read, NULL, base);
    }
    library_drop(&file);
    return error;
}

/* The motion that an edit makes of a file (name), or of nothing (NULL). NULL: it is refused. */
static grobo_motion *edited(ask *q, const json_t *edit, const char *name, const char *etag)
{
    edit_result made = {.motion = NULL};
    grobo_motion *base = NULL;
    int error = name ? read_base(q, name, etag, &base) : GROBO_OK;
    if (error) {
        refuse_named(q, name, error);
    } else if (!q->status) {
        error =
            edit_apply(edit, app_model(q->l->a), base, grobo_motion_format_of_path(q->name), &made);
        if (error) {
            refuse(q, error == GROBO_ERR_NOMEM ? 503 : 422, grobo_error_name(error),
                   made.complaint);
        }
    }
    grobo_motion_free(base);
    return made.motion;
}

static const char *text_in(const json_t *object, const char *key)
{
    return json_string_value(json_object_get(object, key));
}

/* With the line of `play`, whose options say how legs are solved: as they are by default. */
static void write_edited(ask *q, const grobo_motion *made)
{
    analysis n;
    char *bytes = NULL;
    size_t size = 0;
    if (!analysis_begin(&n, q->l->a, q->name)) {
        return;
    }
    int error = edit_file(&n.app, q->name, made, n.found, &bytes, &size);
    if (error == GROBO_ERR_UNREACHABLE) {
        refuse(q, 422, n.app.failed, n.said);
    } else if (error) {
        refuse_error(q, error);
    } else {
        save(q, bytes, size, n.found);
    }
    free(bytes);
    analysis_end(&n);
}

static const field base_fields[] = {{.name = "motion", .kind = FIELD_TEXT, .needed = true},
                                    {.name = "etag", .kind = FIELD_TEXT},
                                    {.name = NULL}};

static void run_put(ask *q)
{
    if (!read_sent(q)) {
        return;
    }
    const json_t *base = json_object_get(q->body, "base");
    char complaint[FIELDS_TEXT_BYTES];
    if (base && !fields_fit(base, base_fields, "base", complaint)) {
        refuse(q, 400, "arg", complaint);
        return;
    }
    bool from_file = *q->match != '\0' && !base;
    grobo_motion *made = edited(q, q->body, from_file ? q->name : text_in(base, "motion"),
                                from_file ? NULL : text_in(base, "etag"));
    if (made) {
        write_edited(q, made);
    }
    grobo_motion_free(made);
}

static void run_put_file(ask *q)
{
    analysis n;
    if (!analysis_begin(&n, q->l->a, q->name)) {
        return;
    }
    analysis_read(&n, q->sent, q->sent_size, false);
    if (n.motion) {
        save(q, q->sent, q->sent_size, NULL);
    } else {
        refuse(q, 422, n.app.failed, n.said);
    }
    analysis_end(&n);
}

void library_put(serve *s, http_request *r, const char *name, bool file)
{
    const char *match = http_header(r, "If-Match"), *none = http_header(r, "If-None-Match");
    if (!library_is_name(name)) {
        http_refuse(r, 400, "arg",
                    "a motion's name is a file's, with .pseq, .m, .mseq, .yaml or .seq");
        return;
    }
    if (!match == !(none && strcmp(none, "*") == 0) ||
        (match && strlen(match) >= LIBRARY_ETAG_BYTES)) {
        http_refuse(r, 428, "changed", "If-Match has the ETag, or If-None-Match * for a new file");
        return;
    }
    ask *q = new_ask(s, r, name, file ? run_put_file : run_put);
    if (!q) {
        return;
    }
    snprintf(q->match, sizeof q->match, "%s", match ? match : "");
    put(s, q);
}

/* ---- a dry run ------------------------------------------------------------------------------- */

static void set_options(ask *q, analysis *n)
{
    const json_t *speed = json_object_get(q->body, "speed_pct");
    n->app.clamps = json_is_true(json_object_get(q->body, "clamp"));
    n->app.line.option[PLAY_MIRROR].given = json_is_true(json_object_get(q->body, "mirror"));
    n->app.line.option[PLAY_REVERSE].given = json_is_true(json_object_get(q->body, "reverse"));
    if (speed) {
        n->app.line.option[PLAY_SPEED] =
            (cli_value){.given = 1, .number = round(json_number_value(speed))};
    }
}

static const field preview_fields[] = {
    {.name = "motion", .kind = FIELD_TEXT},
    {.name = "edit", .kind = FIELD_OBJECT},
    {.name = "etag", .kind = FIELD_TEXT},
    {.name = "speed_pct", .kind = FIELD_WHOLE, .least = 1, .most = GROBO_PLAY_SPEED_MAX_PCT},
    {.name = "mirror", .kind = FIELD_FLAG},
    {.name = "reverse", .kind = FIELD_FLAG},
    {.name = "clamp", .kind = FIELD_FLAG},
    {.name = "rate_hz", .kind = FIELD_NUMBER, .least = 1, .most = 100},
    {.name = NULL}};

/* What a preview asks for. False: it is refused. */
static bool read_preview(ask *q)
{
    if (!read_sent(q)) {
        return false;
    }
    const char *name = text_in(q->body, "motion");
    const json_t *rate = json_object_get(q->body, "rate_hz");
    char complaint[FIELDS_TEXT_BYTES];
    if (!fields_fit(q->body, preview_fields, "preview", complaint)) {
        refuse(q, 400, "arg", complaint);
        return false;
    }
    if (!name && !json_object_get(q->body, "edit")) {
        refuse(q, 400, "arg", "preview: expected motion or edit");
        return false;
    }
    q->rate_hz = rate ? json_number_value(rate) : 30;
    snprintf(q->name, sizeof q->name, "%s", name ? name : "");
    return true;
}

static void run_preview(ask *q)
{
    if (!read_preview(q)) {
        return;
    }
    const json_t *edit = json_object_get(q->body, "edit");
    library_file file = {.bytes = NULL};
    analysis n;
    grobo_motion *made =
        edit ? edited(q, edit, *q->name ? q->name : NULL, text_in(q->body, "etag")) : NULL;
    int error = edit ? GROBO_OK : library_read(q->l, q->name, &file);
    if (error) {
        refuse_error(q, error);
    }
    if (q->status || !analysis_begin(&n, q->l->a, *q->name ? q->name : "edit")) {
        library_drop(&file);
        grobo_motion_free(made);
        return;
    }
    set_options(q, &n);
    if (made) {
        analysis_take(&n, made, true);
    } else {
        analysis_read(&n, file.bytes, file.size, true);
    }
    answer(q, 200,
           json_pack("{s:o,s:o,s:o,s:o,s:o}", "length_ms",
                     app_json_number(analysis_length_ms(&n), 3), "check", analysis_check_json(&n),
                     "diagnostics", analysis_diagnostics_json(&n), "balance",
                     analysis_balance_json(&n), "frames", analysis_frames_json(&n, q->rate_hz)));
    analysis_end(&n);
    library_drop(&file);
}

void library_preview(serve *s, http_request *r)
{
    put(s, new_ask(s, r, "", run_preview));
}
