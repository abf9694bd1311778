/* SPDX-License-Identifier: MIT */
#include <ctype.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "tools/grctl/lang/lang.h"

static bool japanese, keeps_english;

/* ---- which language ------------------------------------------------------------------------- */

const char *lang_wanted(void)
{
    static const char *const names[] = {"LC_ALL", "LC_MESSAGES", "LANG"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        const char *value = getenv(names[i]);
        if (value && *value) {
            return value;
        }
    }
    return "";
}

/* UTF-8, utf8, with or without a modifier behind it. */
static bool is_utf8(const char *charset)
{
    static const char name[] = "utf8";
    size_t n = 0;
    for (; *charset && *charset != '@'; charset++) {
        if (*charset == '-') {
            continue;
        }
        if (n + 1 == sizeof name || tolower((unsigned char)*charset) != name[n]) {
            return false;
        }
        n++;
    }
    return n + 1 == sizeof name;
}

bool lang_start(const char *locale, bool utf8)
{
    const char *charset = strchr(locale, '.');
    bool ja = strncmp(locale, "ja", 2) == 0 && (!locale[2] || strchr("_.@", locale[2]));
    japanese = ja && (charset ? is_utf8(charset + 1) : utf8);
    return japanese;
}

void lang_keep_english(bool english)
{
    keeps_english = english;
}

const char *lang_text(const char *text)
{
    size_t from = 0, to = japanese && !keeps_english ? lang_ja_count : 0;
    while (from < to) {
        size_t middle = from + (to - from) / 2;
        int order = strcmp(text, lang_ja[middle].id);
        if (order == 0) {
            return lang_ja[middle].text;
        }
        if (order < 0) {
            to = middle;
        } else {
            from = middle + 1;
        }
    }
    return text;
}

/* ---- how wide ------------------------------------------------------------------------------- */

/*
 * Done here and not by wcwidth(): that needs a locale that is installed, which the messages do
 * not, and Windows has none. Wide are the blocks that Unicode's East Asian Width has as W or F.
 */
static bool is_wide(uint32_t c)
{
    static const struct {
        uint32_t first, last;
    } wide[] = {{0x1100, 0x115f},   {0x2e80, 0x303e},  {0x3041, 0xa4cf}, {0xac00, 0xd7a3},
                {0xf900, 0xfaff},   {0xfe30, 0xfe6f},  {0xff01, 0xff60}, {0xffe0, 0xffe6},
                {0x1f300, 0x1f64f}, {0x20000, 0x3fffd}};
    for (size_t i = 0; i < sizeof wide / sizeof wide[0]; i++) {
        if (c >= wide[i].first && c <= wide[i].last) {
            return true;
        }
    }
    return false;
}

/* The character that begins there and its bytes; a byte that is no UTF-8 counts as one. */
static size_t decode(const char *text, uint32_t *c)
{
    unsigned char lead = (unsigned char)*text;
    size_t n = lead < 0xc0 ? 1 : lead < 0xe0 ? 2 : lead < 0xf0 ? 3 : 4;
    *c = n == 1 ? lead : lead & (0x7fu >> n);
    for (size_t i = 1; i < n; i++) {
        if (((unsigned char)text[i] & 0xc0) != 0x80) {
            *c = lead;
            return 1;
        }
        *c = *c << 6 | ((unsigned char)text[i] & 0x3f);
    }
    return n;
}

int lang_columns(const char *text, size_t size)
{
    int columns = 0;
    uint32_t c;
    for (size_t i = 0; i < size; columns += 1 + is_wide(c)) {
        i += decode(text + i, &c);
    }
    return columns;
}

size_t lang_fit(const char *text, int columns)
{
    size_t size = 0;
    uint32_t c;
    while (text[size]) {
        size_t n = decode(text + size, &c);
        columns -= 1 + is_wide(c);
        if (columns < 0) {
            break;
        }
        size += n;
    }
    return size;
}

/* Does the text begin with one of these characters? They are of three bytes each. */
static bool is_one_of(const char *text, const char *marks)
{
    for (; *marks; marks += 3) {
        if (strncmp(text, marks, 3) == 0) {
            return true;
        }
    }
    return false;
}

/* What stays on the line of the character before it. */
static bool is_closing(const char *text)
{
    static const char marks[] = "、。）」』】・ー：；？！％"
                                "ぁぃぅぇぉっゃゅょァィゥェォッャュョ";
    return is_one_of(text, marks) || (*text && strchr(",.;:)?!", *text));
}

/* What goes to the line of the character behind it. */
static bool is_opening(const char *text)
{
    return *text == '(' || is_one_of(text, "（「『【");
}

size_t lang_unit(const char *text)
{
    size_t size = 0;
    uint32_t c;
    while (text[size] && text[size] != ' ' && text[size] != '\n') {
        const char *at = text + size;
        size += decode(at, &c);
        bool may_end = is_wide(c);
        decode(text + size, &c);
        if ((may_end || is_wide(c)) && !is_opening(at) && !is_closing(text + size)) {
            break;
        }
    }
    return size;
}
