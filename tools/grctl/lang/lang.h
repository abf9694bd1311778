/* SPDX-License-Identifier: MIT */
/*
 * The language of grctl. The sources are English; a catalogue (lang/ja.po) has every text that a
 * person reads in Japanese, and is compiled into the command. What programs read stays English:
 * all of --json, results on standard output, files, completion.
 *
 * The functions that print messages look their formats up themselves: lang/rules.txt lists them.
 * A text that reaches a message as an argument is marked by _(), one in a table by N_().
 */
#ifndef GRCTL_LANG_H
#define GRCTL_LANG_H

#include <stdbool.h>
#include <stddef.h>

/* Looks the text up where it stands; it is printed by a function that does not. */
#define _(text) lang_text(text)
/* Only marks the text, which is looked up when it is printed. */
#define N_(text) text

typedef struct lang_entry {
    const char *id; /* as it stands in the sources */
    const char *text;
} lang_entry;

/* The catalogue: sorted by the bytes of `id`, none of them twice. */
extern const lang_entry lang_ja[];
extern const size_t lang_ja_count;

/* The value of LC_ALL, LC_MESSAGES or LANG: of the first that is set and not empty, else "". */
const char *lang_wanted(void);

/*
 * Chooses the language of a locale such as ja, ja_JP or ja_JP.UTF-8@modifier. It must be UTF-8: by
 * its name, or where that has no character set, by utf8, which says so of LC_CTYPE.
 * Returns true if the language is Japanese; else it is English.
 */
bool lang_start(const char *locale, bool utf8);

/* English for as long as `english` holds: texts that become part of JSON. */
void lang_keep_english(bool english);

/* The text in the language chosen, or `text` itself where that is English. Not NULL. */
const char *lang_text(const char *text) __attribute__((format_arg(1)));

/* Columns that `size` bytes of UTF-8 take on a terminal. */
int lang_columns(const char *text, size_t size);

/* How many bytes of the text fit into so many columns; no character is cut. */
size_t lang_fit(const char *text, int columns);

/* Bytes up to where a line may end: of a word, or of one character of a language without blanks. */
size_t lang_unit(const char *text);

#endif
