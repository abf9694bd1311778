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

bool head_is_framed(const struct evkeyvalq *headers)
{
    const char *coding = evhttp_find_header(headers, "Transfer-Encoding");
    size_t lengths = count_headers(headers, "Content-Length");
    size_t codings = count_headers(headers, "Transfer-Encoding");
    return lengths + codings <= 1 && (!coding || evutil_ascii_strcasecmp(coding, "chunked") == 0);
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

/* ---- what of a head is malformed ------------------------------------------------------------- */

enum { METHOD_BYTES_MAX = 16 };

/* A piece of a line, without the spaces around it. */
typedef struct piece {
    const char *text;
    size_t size;
} piece;

/* A head's fields that tell where its body ends, and what it waits for. */
typedef struct framing {
    piece length, coding, expect; /* the last of each; no text: none */
    int lengths, codings;
} framing;

/* The characters that a method and a field's name consist of (tchar of RFC 9110, 5.6.2). */
static size_t token(const char *text)
{
    return strspn(text, "!#$%&'*+-.^_`|~0123456789abcdefghijklmnopqrstuvwxyz"
                        "ABCDEFGHIJKLMNOPQRSTUVWXYZ");
}

static bool is_word(const char *text, size_t size, const char *word)
{
    return size == strlen(word) && evutil_ascii_strncasecmp(text, word, size) == 0;
}

/* "METHOD /target HTTP/1.1" (RFC 9112, 3). */
static access_answer judge_line(const char *line, size_t size)
{
    const access_answer bad = {400, "syntax", "the request line is malformed"};
    size_t method = token(line), target = strcspn(line + (method < size ? method + 1 : 0), " \r\n");
    const char *version = line + method + 1 + target + 1;
    if (method == 0 || method > METHOD_BYTES_MAX || method >= size || line[method] != ' ' ||
        target == 0 || method + 1 + target + 1 >= size ||
        size - (size_t)(version - line) != sizeof "HTTP/1.1" - 1 ||
        strncmp(version, "HTTP/", 5) != 0) {
        return bad;
    }
    for (const char *c = line + method + 1; c < version - 1; c++) {
        if ((unsigned char)*c <= ' ' || *c == 0x7f) {
            return bad;
        }
    }
    bool known = strncmp(version, "HTTP/1.1", 8) == 0 || strncmp(version, "HTTP/1.0", 8) == 0;
    return known ? (access_answer){0}
                 : (access_answer){505, "syntax", "the version is not HTTP/1.1 or HTTP/1.0"};
}

static piece trim(const char *text, size_t size)
{
    while (size > 0 && (*text == ' ' || *text == '\t')) {
        text++;
        size--;
    }
    while (size > 0 && (text[size - 1] == ' ' || text[size - 1] == '\t')) {
        size--;
    }
    return (piece){text, size};
}

static bool is_text(piece p)
{
    for (size_t i = 0; i < p.size; i++) {
        if (((unsigned char)p.text[i] < ' ' && p.text[i] != '\t') || p.text[i] == 0x7f) {
            return false;
        }
    }
    return true;
}

/* "Name: value"; false: it is folded, has a space before its colon or what is no text. */
static bool take_field(const char *line, size_t size, framing *f)
{
    size_t name = token(line);
    if (name == 0 || name >= size || line[name] != ':') {
        return false;
    }
    piece value = trim(line + name + 1, size - name - 1);
    if (is_word(line, name, "Content-Length")) {
        f->length = value;
        f->lengths++;
    } else if (is_word(line, name, "Transfer-Encoding")) {
        f->coding = value;
        f->codings++;
    } else if (is_word(line, name, "Expect")) {
        f->expect = value;
    }
    return is_text(value);
}

/* Where the body ends is said once, in one way, and by digits (RFC 9112, 6). */
static access_answer judge_framing(const framing *f, size_t body_max)
{
    if (f->lengths > 1 || f->codings > 1 || (f->lengths && f->codings)) {
        return (access_answer){400, "syntax", "the length of the body is given twice"};
    }
    if (f->codings && !is_word(f->coding.text, f->coding.size, "chunked")) {
        return (access_answer){501, "syntax", "the transfer coding is not chunked"};
    }
    if (f->lengths) {
        size_t digits = strspn(f->length.text, "0123456789");
        if (digits == 0 || digits != f->length.size) {
            return (access_answer){400, "syntax", "the header Content-Length is no number"};
        }
        if (digits > 9 || strtoul(f->length.text, NULL, 10) > body_max) {
            return (access_answer){413, "too_large", "the body is too large"};
        }
    }
    if (f->expect.text && !is_word(f->expect.text, f->expect.size, "100-continue")) {
        return (access_answer){417, "syntax", "the header Expect is not 100-continue"};
    }
    return (access_answer){0};
}

access_answer head_judge(const char *text, size_t size, size_t body_max)
{
    framing f = {0};
    const char *line = text, *end;
    if (memchr(text, '\0', size)) {
        return (access_answer){400, "syntax", "the head of the request has a zero byte"};
    }
    while ((end = memchr(line, '\n', size - (size_t)(line - text))) != NULL) {
        size_t length = (size_t)(end - line);
        length -= length > 0 && line[length - 1] == '\r';
        if (length == 0 && line != text) {
            return judge_framing(&f, body_max);
        }
        if (line == text) {
            access_answer no = judge_line(line, length);
            if (no.status) {
                return no;
            }
        } else if (!take_field(line, length, &f)) {
            return (access_answer){400, "syntax", "a header of the request is malformed"};
        }
        line = end + 1;
    }
    return (access_answer){431, "too_large", "the head of the request is larger than 8 kB"};
}

/* ---- the head of a stop ---------------------------------------------------------------------- */

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
    return status == 400   ? "Bad Request"
           : status == 413 ? "Content Too Large"
           : status == 417 ? "Expectation Failed"
           : status == 422 ? "Unprocessable Content"
           : status == 428 ? "Precondition Required"
           : status == 429 ? "Too Many Requests"
           : status == 431 ? "Request Header Fields Too Large"
           : status == 501 ? "Not Implemented"
           : status == 505 ? "HTTP Version Not Supported"
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
