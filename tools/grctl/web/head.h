/* SPDX-License-Identifier: MIT */
/* The head of a request as text, for what libevent does not tell of it. */
#ifndef GRCTL_WEB_HEAD_H
#define GRCTL_WEB_HEAD_H

#include <stdbool.h>
#include <stddef.h>

#include "tools/grctl/web/http.h"

struct evkeyvalq;

/* Where the head ends that a text begins with, 0: it has not come whole. */
size_t head_end(const char *text);
/*
 * What is wrong with a head, or with as much as came of one that is too large; its body may have
 * `body_max` bytes. libevent reads two lengths, unknown codings and folded headers in its own way,
 * and refuses the rest by a page of HTML.
 */
access_answer head_judge(const char *text, size_t size, size_t body_max);
/*
 * Of a whole head, "POST /stop HTTP/1.1" and headers, its URI and headers; false: it is something
 * else. The text is cut to pieces. `headers` is empty before, and the caller's in either case.
 */
bool head_read(char *text, char **uri, struct evkeyvalq *headers);
/* Where its body ends is said at most once, and by a coding that is known. */
bool head_is_framed(const struct evkeyvalq *headers);
/* Its body is there in `body_bytes` behind the head, or it has none: all of it is next. */
bool head_has_body(const struct evkeyvalq *headers, size_t body_bytes);
/* Path (decoded) and query of a URI; false where they are too long or no text. */
bool head_split(const char *uri, char path[HTTP_PATH_BYTES], char query[HTTP_PATH_BYTES]);
/* "GET", "POST", "PUT" of libevent's numbers, or "". */
const char *head_method(int command);
/* Of the statuses that libevent has no phrase for, and those of head_judge(); NULL: another. */
const char *head_reason(int status);

#endif
