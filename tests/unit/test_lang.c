/* SPDX-License-Identifier: MIT */
/* Which language messages have, how they are found, and how wide they are. */
#include <string.h>

#include "tests/support/test.h"
#include "tools/grctl/lang/lang.h"

static const char known[] = "no reply in time";

TEST(test_locales)
{
    static const struct {
        const char *locale;
        bool utf8, japanese;
    } rows[] = {
        {"ja_JP.UTF-8", false, true},
        {"ja_JP.utf8", false, true},
        {"ja.UTF8", false, true},
        {"ja_JP.UTF-8@x", true, true},
        {"ja_JP.eucJP", true, false},
        {"ja_JP.SJIS", true, false},
        {"ja_JP.", true, false},
        {"ja_JP.UTF-80", true, false},
        {"ja_JP.UTF", true, false},
        {"ja_JP", true, true},
        {"ja", true, true},
        {"ja@x", true, true},
        {"ja_JP", false, false},
        {"ja", false, false},
        {"jam_JM.UTF-8", true, false},
        {"en_US.UTF-8", true, false},
        {"C.UTF-8", true, false},
        {"C", true, false},
        {"j", true, false},
        {"", true, false},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        assert_int_equal(lang_start(rows[i].locale, rows[i].utf8), rows[i].japanese);
        assert_int_equal(strcmp(lang_text(known), known) != 0, rows[i].japanese);
    }
}

TEST(test_every_text)
{
    assert_true(lang_start("ja_JP.UTF-8", false));
    assert_true(lang_ja_count > 500);
    for (size_t i = 0; i < lang_ja_count; i++) {
        assert_true(i == 0 || strcmp(lang_ja[i - 1].id, lang_ja[i].id) < 0);
        assert_ptr_equal(lang_text(lang_ja[i].id), lang_ja[i].text);
        assert_int_not_equal(*lang_ja[i].text, '\0');
    }
}

TEST(test_other_texts)
{
    static const char unknown[] = "a text of nobody";
    lang_start("ja_JP.UTF-8", false);
    assert_ptr_equal(lang_text(unknown), unknown);
    assert_string_equal(lang_text(""), "");
    assert_string_equal(lang_text("\xff"), "\xff");
}

TEST(test_kept_english)
{
    lang_start("ja_JP.UTF-8", false);
    lang_keep_english(true);
    assert_ptr_equal(lang_text(known), known);
    lang_keep_english(false);
    assert_ptr_not_equal(lang_text(known), known);
}

TEST(test_columns)
{
    assert_int_equal(lang_columns("abc", 3), 3);
    assert_int_equal(lang_columns("abc", 0), 0);
    assert_int_equal(lang_columns("関節 1", strlen("関節 1")), 6);
    assert_int_equal(lang_columns("70 °C", strlen("70 °C")), 5);
    assert_int_equal(lang_columns("ﾈｺ。", strlen("ﾈｺ。")), 4); /* narrow katakana */
    assert_int_equal(lang_columns("\xe9\x96", 2), 2);          /* no UTF-8 */
    assert_int_equal(lang_columns("\xff\x80", 2), 2);
    assert_int_equal(lang_columns("😀", strlen("😀")), 2);
}

TEST(test_fit)
{
    assert_int_equal(lang_fit("関節", 4), 6);
    assert_int_equal(lang_fit("関節", 3), 3);
    assert_int_equal(lang_fit("関節", 1), 0);
    assert_int_equal(lang_fit("関節", -1), 0);
    assert_int_equal(lang_fit("abc", 9), 3);
    assert_int_equal(lang_fit("\xe9\x96", 9), 2);
}

TEST(test_units)
{
    static const struct {
        const char *text, *unit;
    } rows[] = {
        {"abc def", "abc"},   {"abc", "abc"},           {"関節", "関"},     {"節、次", "節、"},
        {"(関節)", "(関"},    {"節)。x", "節)。"},      {"m12を", "m12"},   {"ポート", "ポー"},
        {"a-b=c d", "a-b=c"}, {"「動く」", "「動"},     {"く」 x", "く」"}, {" x", ""},
        {"x\ny", "x"},        {"\xe9\x96", "\xe9\x96"},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        assert_int_equal(lang_unit(rows[i].text), strlen(rows[i].unit));
    }
}
