/* SPDX-License-Identifier: MIT */
/*
 * Runs a fuzz target over files instead of under libFuzzer: `make check` replays each corpus with
 * it, so that an input that once broke something stays tested by every compiler.
 *
 * usage: replay FILE...      prints TAP: all files are one test
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { INPUT_MAX_BYTES = 1 << 20 };

/* The input has a block of its own size, so that valgrind and ASan see one byte too many. */
static int replay(const char *path)
{
    static uint8_t buffer[INPUT_MAX_BYTES];
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        return -1;
    }
    size_t size = fread(buffer, 1, sizeof buffer, file);
    int bad = ferror(file) || fgetc(file) != EOF;
    fclose(file);
    if (bad) {
        return -1;
    }
    uint8_t *exact = malloc(size > 0 ? size : 1);
    if (exact == NULL) {
        return -1;
    }
    for (size_t i = 0; i < size; i++) {
        exact[i] = buffer[i];
    }
    int result = LLVMFuzzerTestOneInput(exact, size);
    free(exact);
    return result;
}

int main(int argc, char **argv)
{
    int failed = argc < 2;
    puts("1..1");
    for (int i = 1; i < argc; i++) {
        printf("# %s\n", argv[i]); /* the last one where it crashes */
        fflush(stdout);
        if (replay(argv[i]) != 0) {
            puts("# FAILED");
            failed++;
        }
    }
    printf("%s 1 - %d files of the corpus\n", failed == 0 ? "ok" : "not ok", argc - 1);
    return failed > 0;
}
