/* SPDX-License-Identifier: MIT */
/* Bytes as people write them: "FA AF 03", "FAAF03", "0xFA,0xAF", "fa:af". */
#ifndef GRCTL_HEXTEXT_H
#define GRCTL_HEXTEXT_H

#include <stddef.h>
#include <stdint.h>

/*
 * Reads a whole text. Returns the number of bytes; GROBO_ERR_SYNTAX with *at at what is no byte
 * (0 based), GROBO_ERR_CAP when there are more than fit.
 */
int hextext_parse(const char *text, uint8_t *bytes, size_t capacity, size_t *at);

/* The length of the word that begins here, for a complaint about it. */
int hextext_word(const char *text);

#endif
