/* SPDX-License-Identifier: MIT */
#include <grobo/core/serial.h>

static const char digits[] = "0123456789ABCDEF";

int grobo_hex(const void *bytes, size_t size, char *text, size_t text_bytes)
{
    if (text == NULL || (bytes == NULL && size > 0)) {
        return GROBO_ERR_ARG;
    }
    const uint8_t *from = bytes;
    char *to = text;

    if (text_bytes == 0 || size > text_bytes / 3) {
        return GROBO_ERR_SPACE;
    }
    for (size_t i = 0; i < size; i++) {
        if (i > 0) {
            *to++ = ' ';
        }
        *to++ = digits[from[i] >> 4];
        *to++ = digits[from[i] & 15];
    }
    *to = '\0';
    return (int)(to - text);
}

int grobo_hex_print(const void *bytes, size_t size, FILE *stream)
{
    if (stream == NULL || (bytes == NULL && size > 0)) {
        return GROBO_ERR_ARG;
    }
    const uint8_t *from = bytes;

    for (size_t i = 0; i < size; i++) {
        if (fprintf(stream, i == 0 ? "%02X" : " %02X", from[i]) < 0) {
            return GROBO_ERR_IO;
        }
    }
    return fputc('\n', stream) == '\n' ? GROBO_OK : GROBO_ERR_IO;
}
