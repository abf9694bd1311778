/* SPDX-License-Identifier: MIT */
/* Reads the head of a request without its body, and names methods and statuses. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <event2/http.h>
#include <event2/keyvalq_struct.h>
#include <event2/util.h>

#include "tools/grctl/web/head.h"

size_t head_end(const char *text)
{
    const char *a = strstr(text, "\r\n\r\n"), *b = strstr(text, "\n\n");
    return a && (!b || a < b) ? (size_t)(a - text) + 4 : b ? (size_t)(b - text) + 2 : 0;
}

static size_t count_headers(const struct evkeyvalq *headers, const char *name)
{
    size_t n = 0;
    for (const struct evkeyval *h = headers->tqh_first; h; h = h->next.tqe_next) {
        n += evutil_ascii_strcasecmp(h->key, name) == 0;
    }
    return n;
}

bool head_has_body(const struct evkeyvalq *headers, size_t body_bytes)
{
    const char *length = evhttp_find_header(headers, "Content-Length");
    if (!length || count_headers(headers, "Content-Length") != 1 ||
        evhttp_find_header(headers, "Transfer-Encoding")) {
        return !length && !evhttp_find_header(headers, "Transfer-Encoding");
    }
    size_t digits = strspn(length, "0123456789");
    return digits > 0 && digits < 8 && length[digits] == '\0' &&
           strtoul(length, NULL, 10) <= body_bytes && body_bytes <= HTTP_BODY_BYTES;
}

/* The next line of a head, without its end; NULL: there is none. */
static char *next_line(char **text)
{
    char *line = *text, *end = strchr(line, '\n');
    if (!end || line == end || (line[0] == '\r' && line + 1 == end)) {
        return NULL;
    }
    *text = end + 1;
    *end = '\0';
    if (end[-1] == '\r') {
        end[-1] = '\0';
    }
    return line;
}

bool head_read(char *text, char **uri, struct evkeyvalq *headers)
{
    char *line = next_line(&text), *end = line ? strrchr(line, ' ') : NULL;
    if (!end || strncmp(line, "POST /", 6) != 0 || strncmp(end, " HTTP/1.", 8) != 0) {
        return false;
    }
    *end = '\0';
    *uri = line + 5;
    while ((line = next_line(&text)) != NULL) {
        char *value = line + strcspn(line, ": \t");
        if (value == line || *value != ':') {
            return false; /* folded, or none */
        }
        *value++ = '\0';
        value += strspn(value, " \t");
        if (evhttp_add_header(headers, line, value) < 0) {
            return false;
        }
    }
    return true;
}

bool head_split(const char *uri, char path[HTTP_PATH_BYTES], char query[HTTP_PATH_BYTES])
{
    size_t length = strcspn(uri, "?#"), decoded = 0;
    char raw[HTTP_PATH_BYTES];
    if (length >= sizeof raw) {
        return false;
    }
    memcpy(raw, uri, length);
    raw[length] = '\0';
    char *text = evhttp_uridecode(raw, 0, &decoded);
    bool fits = text && decoded < HTTP_PATH_BYTES && strlen(text) == decoded;
    if (fits) {
        memcpy(path, text, decoded + 1);
        snprintf(query, HTTP_PATH_BYTES, "%s", uri[length] == '?' ? uri + length + 1 : "");
    }
    free(text);
    return fits;
}

const char *head_reason(int status)
{
    return status == 413   ? "Content Too Large"
           : status == 422 ? "Unprocessable Content"
           : status == 428 ? "Precondition Required"
           : status == 429 ? "Too Many Requests"
                           : NULL;
}

const char *head_method(int command)
{
    switch (command) {
    case EVHTTP_REQ_GET:
        return "GET";
    case EVHTTP_REQ_POST:
        return "POST";
    case EVHTTP_REQ_PUT:
        return "PUT";
    }
    return "";
}
