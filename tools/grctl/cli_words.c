/* SPDX-License-Identifier: MIT */
/* What may stand where on a command line, told by the tables of cli.h. */
#include <string.h>

#include "cli.h"

const char *cli_next_word(const char **words, size_t *length)
{
    const char *word = *words;
    if (*word == '\0')
        return NULL;
    *length = strcspn(word, "|");
    *words = word + *length + (word[*length] == '|');
    return word;
}

cli_argument cli_option_argument(const cli_option *option)
{
    static const char *const files[] = {"FILE", "OUT", "PATH", "TRACE"};
    if (option->kind != CLI_TEXT)
        return CLI_ARG_NONE;
    if (strcmp(option->value, "DEV") == 0)
        return CLI_ARG_DEVICE;
    if (strcmp(option->value, "LIST") == 0)
        return CLI_ARG_JOINT;
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++)
        if (strncmp(option->value, files[i], strlen(files[i])) == 0)
            return CLI_ARG_FILE;
    return CLI_ARG_NONE;
}

const char *cli_first_argument(const cli_command *command, size_t *length)
{
    const char *words = command->arguments;
    *length = strspn(words, "abcdefghijklmnopqrstuvwxyz-|");
    if (*length == 0 || !memchr(words, '|', *length))
        return NULL;
    return words[*length] == '\0' || words[*length] == ' ' ? words : NULL;
}
