/* SPDX-License-Identifier: MIT */
/* Numbers as text: exact both ways, in every locale. */
#include <locale.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "src/motion/text/number.h"
#include "tests/support/os.h"
#include "tests/support/test.h"

TEST(test_numbers)
{
    static const struct {
        const char *text;
        double value;
    } good[] = {{"0", 0},
                {"+1", 1},
                {".5", 0.5},
                {"5.", 5},
                {"-1e-019", -1e-19},
                {"1E+2", 100},
                {"6.9e-310", 6.9e-310},
                {"4.9406564584124654e-324", 4.9406564584124654e-324},
                {"1e-400", 0},
                {"0.1", 0.1},
                {"123456789012345678901234567890", 123456789012345678901234567890.0},
                {"9007199254740993", 9007199254740993.0},
                {"0.3333333333333333148", 0.3333333333333333148},
                {"1.7976931348623157e308", 1.7976931348623157e308},
                {"00000000000000000000000001.50", 1.5}};
    static const char *const bad[] = {"",      "-",     "+-1",    ".",   "e5",   "1e",   "1e+",
                                      "1x",    " 1",    "1 ",     "nan", "inf",  "0x10", "1,5",
                                      "1.2.3", "1e999", "-1e999", "--1", "1_000"};
    double value = 42;

    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++) {
        assert_true(grobo_i_parse_number(good[i].text, strlen(good[i].text), &value));
        assert_memory_equal(&value, &good[i].value, sizeof value);
    }
    assert_true(grobo_i_parse_number("-0", 2, &value) && signbit(value));
    value = 42;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_false(grobo_i_parse_number(bad[i], strlen(bad[i]), &value));
    }
    assert_true(value == 42);
}

/* Written numbers read back as they were, whatever they are, and shortly where that is enough. */
TEST(test_number_round_trip)
{
    char text[GROBO_I_NUMBER_BYTES];
    uint64_t bits = 88172645463325252U;

    assert_int_equal(grobo_i_format_number(0.35, text), 4);
    assert_memory_equal(text, "0.35", 4);
    assert_int_equal(grobo_i_format_number(1.5e-19, text), 7);
    for (int i = 0; i < 200000; i++) {
        double value, back;
        bits ^= bits << 13;
        bits ^= bits >> 7;
        bits ^= bits << 17;
        memcpy(&value, &bits, sizeof value);
        if (!isfinite(value)) {
            continue;
        }
        size_t length = grobo_i_format_number(value, text);
        assert_true(length < GROBO_I_NUMBER_BYTES);
        assert_true(grobo_i_parse_number(text, length, &back));
        assert_true(back == value);
        /* As strtod() has it, too. */
        text[length] = '\0';
        assert_true(strtod(text, NULL) == value);
    }
}

/* Of any digits and exponent the nearest double, as the C library finds it. */
TEST(test_numbers_are_rounded_right)
{
    uint64_t bits = 88172645463325252U;

    for (int i = 0; i < 300000; i++) {
        char text[64];
        double value = 0;
        bits ^= bits << 13;
        bits ^= bits >> 7;
        bits ^= bits << 17;
        /* 1 to 20 digits, most of them wide; exponents where the quick way ends and beyond. */
        uint64_t digits = bits >> (i % 5 == 0 ? (bits & 63) : (bits & 7));
        int exponent = (int)(bits >> 40 & 63) - 40;
        int length = snprintf(text, sizeof text, "%llue%d", (unsigned long long)digits, exponent);
        assert_true(grobo_i_parse_number(text, (size_t)length, &value));
        if (value != strtod(text, NULL)) {
            fail_msg("%s gives %.17g", text, value);
        }
    }
    /* Just beside half of a last place, and on it. */
    static const char *const halves[] = {
        "9007199254740993",    "9007199254740992.5",
        "9007199254740993.01", "1.00000000000000011102230246251565",
        "18014398509481982e1", "4503599627370496.5",
        "4503599627370497.5",  "450359962737049650e-2"};
    for (size_t i = 0; i < sizeof halves / sizeof halves[0]; i++) {
        double value = 0;
        assert_true(grobo_i_parse_number(halves[i], strlen(halves[i]), &value));
        assert_true(value == strtod(halves[i], NULL));
    }
}

TEST(test_locale)
{
    char text[GROBO_I_NUMBER_BYTES];
    double value;

    if (!test_locale_with_comma()) {
        print_message("no locale with a decimal comma can be had\n");
        skip();
    }
    bool parsed = grobo_i_parse_number("0.33333333333333331", 19, &value);
    size_t length = grobo_i_format_number(1.0 / 3, text);
    setlocale(LC_NUMERIC, "C");
    assert_true(parsed && value == 1.0 / 3);
    assert_int_equal(length, 19);
    assert_memory_equal(text, "0.33333333333333331", 19);
}
