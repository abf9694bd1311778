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
 * Of a whole head, "POST /stop HTTP/1.1" and headers, its URI and headers; false: it is something
 * else. The text is cut to pieces. `headers` is empty before, and the caller's in either case.
 */
bool head_read(char *text, char **uri, struct evkeyvalq *headers);
/* Its body is there in `body_bytes` behind the head, or it has none: all of it is next. */
bool head_has_body(const struct evkeyvalq *headers, size_t body_bytes);
/* Path (decoded) and query of a URI; false where they are too long or no text. */
bool head_split(const char *uri, char path[HTTP_PATH_BYTES], char query[HTTP_PATH_BYTES]);
/* "GET", "POST", "PUT" of libevent's numbers, or "". */
const char *head_method(int command);
/* Of the statuses that libevent has no phrase for; NULL: it has. */
const char *head_reason(int status);

#endif
