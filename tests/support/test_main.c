/* SPDX-License-Identifier: MIT */
/* The main() of a program that has tests only. */
#include "tests/support/test.h"

int main(int argc, char **argv)
{
    return test_main(argc, argv);
}
