/* SPDX-License-Identifier: MIT */
/*
 * Emergency stops across programs, as notes between the programs of one user. Three kinds:
 *
 *   estop-NAME   a mark, one for each name of the device. Its first line is the mark's id, the
 *                others are the notes that were set together: clearing one clears all.
 *   holder-NAME  the process that has the device: number and start time.
 *   answer-ID    what was done about the mark: a grobo_estop_answer and a result. As long as there
 *                is none, the stop has not reached the robot.
 *
 * A mark counts as soon as its file is there, whatever is in it.
 */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include <grobo/session.h>

#include "src/link/guard/estop.h"

/* Longest part of a device's name that goes into that of a note. */
enum { NAME_PART = 180 };

/* A mark in which no id could be written, for want of room on the disk. */
static const char nameless[] = "none";

/* Users whose programs have a device at a time, and their processes. */
enum { USERS_MAX = 4, HOLDERS_MAX = 16 };

/* ---- names of notes ----------------------------------------------------------------------- */

static char *put(char *to, const char *text, size_t size)
{
    memcpy(to, text, size);
    return to + size;
}

static bool fits_a_file(char c)
{
    return (unsigned char)c >= ' ' && c != '/' && c != '\\' && c != ':' && c != '*' && c != '?' &&
           c != '"' && c != '<' && c != '>' && c != '|';
}

/* Without characters that no system takes in a file's name. A long name is cut and gets a sum.
 * Plain copies: each session makes one of each of its names twenty times a second. */
static void note_of(const char *kind, const char *name, char *note)
{
    size_t size = strlen(name);
    char *at = put(note, kind, strlen(kind));

    *at++ = '-';
    if (size > NAME_PART) {
        uint32_t sum = 2166136261u; /* FNV-1a */

        for (const char *c = name; *c != '\0'; c++) {
            sum = (sum ^ (unsigned char)*c) * 16777619u;
        }
        at += snprintf(at, sizeof "00000000-", "%08" PRIx32 "-", sum);
        name += size - NAME_PART;
        size = NAME_PART;
    }
    for (const char *c = name; c < name + size; c++) {
        *at++ = fits_a_file(*c) ? *c : '!';
    }
    *at = '\0';
}

/* The id in a mark's text: its first line. */
static void take_id(const char *text, char *id)
{
    size_t size = strcspn(text, "\n");

    if (size == 0 || size >= sizeof((grobo_estop *)0)->id) {
        text = nameless;
        size = sizeof nameless - 1;
    }
    memcpy(id, text, size);
    id[size] = '\0';
}

static bool is_device(const char *device)
{
    return device != NULL && device[0] != '\0' && strcmp(device, GROBO_DEVICE_AUTO) != 0;
}

/* The notes of one kind that there are by the names of a device, in each folder. */
typedef struct note_walk {
    const char *kind;
    const grobo_i_device_names *names;
    grobo_i_note_folders in;
    int at; /* of the next: name and folder */
    /* the one that was found: */
    int folder;
    char note[NOTE_NAME_BYTES];
    char text[NOTE_TEXT_BYTES];
} note_walk;

static void walk_notes(note_walk *walk, const char *kind, const grobo_i_device_names *names)
{
    walk->kind = kind;
    walk->names = names;
    walk->at = 0;
    grobo_i_note_folders_find(&walk->in);
}

static bool next_note(note_walk *walk)
{
    while (walk->at < walk->names->n * NOTE_FOLDERS) {
        walk->folder = walk->at % NOTE_FOLDERS;
        if (walk->folder == 0) {
            note_of(walk->kind, walk->names->name[walk->at / NOTE_FOLDERS], walk->note);
        }
        walk->at++;
        if (grobo_i_note_read(&walk->in, walk->folder, walk->note, walk->text, sizeof walk->text) >=
            0) {
            return true;
        }
    }
    return false;
}

/* ---- marks -------------------------------------------------------------------------------- */

static void remove_answer(const char *id)
{
    char note[NOTE_NAME_BYTES];
    grobo_os_cause cause;

    note_of("answer", id, note);
    (void)grobo_i_note_remove(note, &cause);
}

/* The notes to be set: not by a name that another device may have later. */
static int list_marks(const grobo_i_device_names *names, char note[][NOTE_NAME_BYTES])
{
    int n = 0;

    for (int i = 0; i < names->n; i++) {
        if (i != names->passing) {
            note_of("estop", names->name[i], note[n++]);
        }
    }
    return n;
}

static int set_mark(const char *note, const char *text, grobo_estop *stop, grobo_os_cause *cause)
{
    int r = grobo_i_note_write(note, text, cause);

    if (r < 0) {
        /* A full disk may still take an empty file. */
        grobo_os_cause again;
        int empty = grobo_i_note_write(note, "", &again);

        if (empty > 0) {
            remove_answer(nameless);
            snprintf(stop->id, sizeof stop->id, "%s", nameless);
            r = empty;
        }
    }
    stop->places |= r > 0 ? (unsigned)r : 0;
    return r < 0 ? r : GROBO_OK;
}

/* Sets all marks of a stop in the directories as they are. Returns the first error. */
static int set_marks(char note[][NOTE_NAME_BYTES], int n, const char *text, grobo_estop *stop,
                     grobo_os_cause *cause)
{
    int r = GROBO_OK;

    for (int i = 0; i < n; i++) {
        int error = set_mark(note[i], text, stop, cause);

        r = error < 0 ? error : r;
    }
    return r;
}

/* The answers to marks that are replaced are of no use to anybody. */
static void forget_answers(const char *note)
{
    grobo_i_note_folders in;
    char text[NOTE_TEXT_BYTES];
    char id[sizeof((grobo_estop *)0)->id];

    grobo_i_note_folders_find(&in);
    for (int folder = 0; folder < NOTE_FOLDERS; folder++) {
        if (grobo_i_note_read(&in, folder, note, text, sizeof text) >= 0) {
            take_id(text, id);
            remove_answer(id);
        }
    }
}

/* The processes of other users that have the device, guards left out; 0: the caller is not root. */
static int find_others(const char *device, grobo_i_holder *others, int max)
{
    grobo_i_holder all[HOLDERS_MAX];
    int n = grobo_i_is_root() ? grobo_i_holders_find(device, all, HOLDERS_MAX) : 0;
    int n_others = 0;

    for (int i = 0; i < n && n_others < max; i++) {
        if (!all[i].guard && all[i].user != 0) {
            others[n_others++] = all[i];
        }
    }
    return n_others;
}

/* Root's stop is that of every user whose program has the device: it is set beside them, by their
 * rights. Where that fails, they do not answer. */
static void set_beside(const grobo_i_holder *others, int n_others, char note[][NOTE_NAME_BYTES],
                       int n, const char *text, grobo_estop *stop)
{
    grobo_os_cause cause;

    for (int i = 0; i < n_others; i++) {
        grobo_estop theirs = {.places = 0};

        if (grobo_i_note_user_begin(others[i].user, others[i].group) >= 0) {
            (void)set_marks(note, n, text, &theirs, &cause);
            grobo_i_note_user_end();
        }
        stop->places |= theirs.places << NOTE_FOLDERS;
    }
}

int grobo_estop_set(const char *device, grobo_estop *stop, grobo_os_cause *cause)
{
    grobo_i_holder others[USERS_MAX];
    grobo_i_device_names names;
    char note[DEVICE_NAMES][NOTE_NAME_BYTES];
    char text[NOTE_TEXT_BYTES];
    grobo_i_process self;
    grobo_estop made = {.places = 0};
    grobo_os_cause why;
    int size;
    int r = GROBO_OK;

    if (!is_device(device)) {
        return GROBO_ERR_ARG;
    }
    if (strcmp(device, GROBO_DEVICE_SIM) != 0) {
        grobo_i_device_names_find(device, &names);
        int n = list_marks(&names, note);

        grobo_i_process_self(&self);
        snprintf(made.id, sizeof made.id, "%x-%" PRIx64, (unsigned)self.pid,
                 (uint64_t)grobo_now_us());
        size = snprintf(text, sizeof text, "%s\n", made.id);
        for (int i = 0; i < n; i++) {
            forget_answers(note[i]);
            size += snprintf(text + size, sizeof text - (size_t)size, "%s\n", note[i]);
        }
        int n_others = find_others(device, others, USERS_MAX);

        for (int i = 0; i < n_others; i++) {
            size += snprintf(text + size, sizeof text - (size_t)size, "user %u %u\n",
                             others[i].user, others[i].group);
        }
        set_beside(others, n_others, note, n, text, &made);
        r = n > 0 ? set_marks(note, n, text, &made, cause != NULL ? cause : &why) : GROBO_ERR_ARG;
    }
    if (stop != NULL) {
        *stop = made;
    }
    return r;
}

/* Removes the marks that were set together, as a mark's text lists them, in the directories as they
 * are. */
static int remove_group(const char *text, grobo_os_cause *cause)
{
    char note[NOTE_NAME_BYTES];
    int r = GROBO_OK;

    take_id(text, note);
    remove_answer(note);
    for (text += strcspn(text, "\n"); *text == '\n'; text += strcspn(text, "\n")) {
        size_t size = strcspn(++text, "\n");

        if (size < sizeof note && strncmp(text, "estop-", 6) == 0) {
            memcpy(note, text, size);
            note[size] = '\0';
            r = strpbrk(note, "/\\") == NULL && grobo_i_note_remove(note, cause) < 0 ? GROBO_ERR_IO
                                                                                     : r;
        }
    }
    return r;
}

/* The same, and where root has set them beside programs of other users. */
static int clear_group(const char *text, grobo_os_cause *cause)
{
    int r = remove_group(text, cause);

    for (const char *at = strstr(text, "\nuser "); at != NULL; at = strstr(at + 1, "\nuser ")) {
        unsigned user;
        unsigned group;

        if (sscanf(at, "\nuser %u %u", &user, &group) == 2 &&
            grobo_i_note_user_begin(user, group) >= 0) {
            int error = remove_group(text, cause);

            grobo_i_note_user_end();
            r = error < 0 ? error : r;
        }
    }
    return r;
}

static bool has(char list[][sizeof((grobo_estop *)0)->id], int n, const char *id)
{
    int at = 0;

    while (at < n && strcmp(list[at], id) != 0) {
        at++;
    }
    return at < n;
}

/* Those that a watch has heard, or all (NULL). GROBO_ERR_STATE: one stands that it has not. */
static int clear_marks(const grobo_i_device_names *names, grobo_i_estop_watch *of,
                       grobo_os_cause *cause)
{
    note_walk marks;
    char id[sizeof((grobo_estop *)0)->id];
    bool fresh = false;
    int r = GROBO_OK;

    walk_notes(&marks, "estop", names);
    while (next_note(&marks)) {
        take_id(marks.text, id);
        if (of != NULL && !has(of->heard, of->n_heard, id)) {
            fresh = true;
            continue;
        }
        int error = clear_group(marks.text, cause);

        r = error < 0 ? error : r;
    }
    for (int i = 0; !fresh && i < names->n; i++) { /* one that is empty, or cannot be read */
        note_of("estop", names->name[i], marks.note);
        int error = grobo_i_note_remove(marks.note, cause);

        r = error < 0 ? error : r;
    }
    return fresh ? GROBO_ERR_STATE : r;
}

int grobo_i_estop_watch_clear(grobo_i_estop_watch *watch, grobo_os_cause *cause)
{
    return clear_marks(&watch->names, watch, cause);
}

int grobo_estop_clear(const char *device, grobo_os_cause *cause)
{
    grobo_i_device_names names;
    grobo_os_cause why;

    if (!is_device(device)) {
        return GROBO_ERR_ARG;
    }
    if (strcmp(device, GROBO_DEVICE_SIM) == 0) {
        return GROBO_OK;
    }
    grobo_i_device_names_find(device, &names);
    return clear_marks(&names, NULL, cause != NULL ? cause : &why);
}

bool grobo_estop_stands(const char *device)
{
    grobo_i_device_names names;
    note_walk marks;

    if (!is_device(device) || strcmp(device, GROBO_DEVICE_SIM) == 0) {
        return false;
    }
    grobo_i_device_names_find(device, &names);
    walk_notes(&marks, "estop", &names);
    return next_note(&marks);
}

/* ---- who has the device ------------------------------------------------------------------- */

static bool next_holder(note_walk *walk, grobo_i_process *holder)
{
    while (next_note(walk)) {
        if (sscanf(walk->text, "%d %" SCNu64, &holder->pid, &holder->started) == 2 &&
            holder->pid > 0) {
            return true;
        }
    }
    return false;
}

/* Fills the process that has the device and is alive; false where there is none. */
static bool find_holder(const grobo_i_device_names *names, const grobo_estop *stop,
                        grobo_estop_holder *holder)
{
    note_walk holders;
    grobo_i_process process;

    walk_notes(&holders, "holder", names);
    while (next_holder(&holders, &process)) {
        /* One that does not see the mark would go on with what it was doing. */
        bool wake = stop != NULL && (stop->places & 1u << holders.folder) != 0;
        int r = grobo_i_process_look(&process, wake);

        if (r != GROBO_ERR_NOENT) {
            holder->pid = process.pid;
            holder->stopped = r == 1;
            holder->resumed = r == 1 && wake;
            return true;
        }
    }
    return false;
}

static bool read_answer(const char *id, int *answer, int *result)
{
    grobo_i_note_folders in;
    char note[NOTE_NAME_BYTES];
    char text[64];

    grobo_i_note_folders_find(&in);
    note_of("answer", id, note);
    for (int folder = 0; folder < NOTE_FOLDERS; folder++) {
        if (grobo_i_note_read(&in, folder, note, text, sizeof text) >= 0 &&
            sscanf(text, "%d %d", answer, result) == 2) {
            return true;
        }
    }
    return false;
}

/* One that was only heard is still owed where the program that heard it has exited. */
static bool is_final(int answer)
{
    return answer == GROBO_ESTOP_DONE || answer == GROBO_ESTOP_FAILED;
}

/* Takes the answer to a stop from the directories as they are. */
static void take_answer(const grobo_estop *stop, grobo_estop_holder *holder)
{
    int answer;
    int result;

    if (stop != NULL && stop->id[0] != '\0' && read_answer(stop->id, &answer, &result) &&
        (is_final(answer) || (answer == GROBO_ESTOP_HEARD && holder->pid != 0))) {
        holder->answer = (grobo_estop_answer)answer;
        holder->result = result;
    }
}

/*
 * A process of another user that is registered in his directories, and its answer. Only one that
 * the system shows to have the device counts: a note of his may name any process.
 */
static bool ask_other(const grobo_i_device_names *names, const grobo_i_holder *other,
                      const grobo_estop *stop, grobo_estop_holder *holder)
{
    note_walk holders;
    grobo_i_process process;
    bool wake = stop != NULL && stop->places >> NOTE_FOLDERS != 0;
    bool found = false;

    if (grobo_i_note_user_begin(other->user, other->group) < 0) {
        return false;
    }
    walk_notes(&holders, "holder", names);
    while (!found && next_holder(&holders, &process)) {
        found = process.pid == other->pid;
    }
    if (found) {
        *holder = (grobo_estop_holder){.answer = GROBO_ESTOP_SILENT, .pid = other->pid};
        take_answer(stop, holder);
    }
    grobo_i_note_user_end();
    if (found) {
        holder->stopped = grobo_i_process_look(&process, wake) == 1;
        holder->resumed = holder->stopped && wake;
    }
    return found;
}

static void ask_others(const char *device, const grobo_i_device_names *names,
                       const grobo_estop *stop, grobo_estop_holder *holder)
{
    grobo_i_holder others[USERS_MAX];
    int n = find_others(device, others, USERS_MAX);

    for (int i = 0; i < n; i++) {
        if (ask_other(names, &others[i], stop, holder)) {
            return;
        }
    }
}

int grobo_estop_ask(const char *device, const grobo_estop *stop, grobo_estop_holder *holder)
{
    grobo_i_device_names names;

    if (!is_device(device) || holder == NULL) {
        return GROBO_ERR_ARG;
    }
    *holder = (grobo_estop_holder){.answer = GROBO_ESTOP_NOBODY};
    if (strcmp(device, GROBO_DEVICE_SIM) == 0) {
        return GROBO_OK;
    }
    grobo_i_device_names_find(device, &names);
    if (find_holder(&names, stop, holder)) {
        holder->answer = GROBO_ESTOP_SILENT;
    }
    take_answer(stop, holder);
    if (holder->answer == GROBO_ESTOP_NOBODY) {
        ask_others(device, &names, stop, holder);
    }
    return GROBO_OK;
}

int grobo_estop_force(const char *device, grobo_estop_means means)
{
    grobo_i_holder holders[HOLDERS_MAX];
    int reached = 0;
    int r = GROBO_OK;

    if (!is_device(device) || (unsigned)means > GROBO_ESTOP_BY_SIGTERM) {
        return GROBO_ERR_ARG;
    }
    int n = grobo_i_holders_find(device, holders, HOLDERS_MAX);

    for (int i = 0; i < n; i++) {
        if (holders[i].guard == (means == GROBO_ESTOP_BY_GUARD)) {
            int error = grobo_i_holder_end(device, &holders[i]);

            reached += error >= 0;
            r = error < 0 ? error : r;
        }
    }
    return n < 0 ? n : reached > 0 ? reached : r;
}

/* ---- a session's side --------------------------------------------------------------------- */

void grobo_i_estop_watch_begin(grobo_i_estop_watch *watch, const char *device)
{
    char note[NOTE_NAME_BYTES];
    char text[64];
    grobo_i_process self;
    grobo_os_cause cause;
    bool armed = watch->on && watch->armed;

    grobo_i_device_names_find(device, &watch->names);
    grobo_i_process_self(&self);
    snprintf(text, sizeof text, "%d %" PRIu64 "\n", self.pid, self.started);
    for (int i = 0; i < watch->names.n; i++) {
        note_of("holder", watch->names.name[i], note);
        /* Where it cannot be registered, whoever asks is told that nobody is. */
        (void)grobo_i_note_write(note, text, &cause);
    }
    watch->on = true;
    watch->armed = armed;
}

void grobo_i_estop_watch_end(grobo_i_estop_watch *watch)
{
    note_walk holders;
    grobo_i_process self;
    grobo_i_process holder;
    grobo_os_cause cause;

    if (!watch->on) {
        return;
    }
    grobo_i_estop_watch_answer(watch);
    grobo_i_process_self(&self);
    walk_notes(&holders, "holder", &watch->names);
    while (next_holder(&holders, &holder)) {
        /* A connection may have several, and the last one is registered. */
        if (holder.pid == self.pid) {
            (void)grobo_i_note_remove(holders.note, &cause);
        }
    }
    *watch = (grobo_i_estop_watch){.on = false};
}

uint64_t grobo_i_estop_holder_stamp(const grobo_i_device_names *names)
{
    grobo_i_note_folders in;
    char note[NOTE_NAME_BYTES];
    uint64_t sum = 0;

    grobo_i_note_folders_find(&in);
    for (int i = 0; i < names->n; i++) {
        note_of("holder", names->name[i], note);
        for (int folder = 0; folder < NOTE_FOLDERS; folder++) {
            sum = sum * 31 + grobo_i_note_stamp(&in, folder, note);
        }
    }
    return sum;
}

bool grobo_i_estop_watch_look(grobo_i_estop_watch *watch, bool *pending)
{
    char standing[ESTOP_HEARD][sizeof((grobo_estop *)0)->id];
    note_walk marks;
    int n = 0;
    bool fresh = false;
    int answer;
    int result;

    *pending = false;
    watch->looked_us = grobo_now_us();
    walk_notes(&marks, "estop", &watch->names);
    while (n < ESTOP_HEARD && next_note(&marks)) {
        take_id(marks.text, standing[n]);
        n += !has(standing, n, standing[n]);
    }
    for (int i = 0; i < n; i++) {
        if (!has(watch->heard, watch->n_heard, standing[i])) {
            fresh = true;
            *pending =
                *pending || !(read_answer(standing[i], &answer, &result) && is_final(answer));
        }
    }
    memcpy(watch->heard, standing, (size_t)n * sizeof standing[0]);
    watch->n_heard = n;
    return fresh;
}

void grobo_i_estop_watch_answer(grobo_i_estop_watch *watch)
{
    char note[NOTE_NAME_BYTES];
    char text[64];
    grobo_os_cause cause;

    if (watch->say == GROBO_ESTOP_NOBODY) {
        return;
    }
    snprintf(text, sizeof text, "%d %d\n", (int)watch->say, watch->result);
    for (int i = 0; i < watch->n_heard; i++) {
        note_of("answer", watch->heard[i], note);
        (void)grobo_i_note_write(note, text, &cause);
    }
    watch->say = GROBO_ESTOP_NOBODY;
}
