/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include <event2/http.h>
#include <event2/keyvalq_struct.h>
#include <event2/util.h>

#include "tools/grctl/web/access.h"

static const access_answer fine = {0};

static access_answer refuse(int status, const char *code, const char *message)
{
    return (access_answer){.status = status, .code = code, .message = message};
}

/* The one value of a header; NULL: none. *n: how often it is there. */
static const char *header(const access_request *r, const char *name, int *n)
{
    const char *found = NULL;
    const struct evkeyval *h;
    int count = 0;
    for (h = r->headers->tqh_first; h; h = h->next.tqe_next) {
        if (strcasecmp(h->key, name) == 0) {
            found = h->value;
            count++;
        }
    }
    if (n) {
        *n = count;
    }
    return found;
}

/* Which of our hosts stands before :port, in any case; NULL: none. */
static const char *own_host(const access_rules *w, const char *text, uint16_t port)
{
    char whole[ACCESS_NAME_BYTES + 8];
    for (int i = 0; i < w->n_hosts; i++) {
        snprintf(whole, sizeof whole, "%s:%u", w->hosts[i], port);
        /* A browser leaves the port of http away. */
        if (strcasecmp(text, whole) == 0 || (port == 80 && strcasecmp(text, w->hosts[i]) == 0)) {
            return w->hosts[i];
        }
    }
    return NULL;
}

const char *access_host(const access_rules *w, const access_request *r)
{
    const char *host = header(r, "Host", NULL);
    return host ? own_host(w, host, w->port) : NULL;
}

static bool is_own_origin(const access_rules *w, const char *origin)
{
    static const char scheme[] = "http://";
    return strncasecmp(origin, scheme, sizeof scheme - 1) == 0 &&
           own_host(w, origin + sizeof scheme - 1, w->page_port) != NULL;
}

/* A browser says where a request comes from; what says nothing is no browser. */
static access_answer check_origin(const access_rules *w, const access_request *r)
{
    int n_origins, n_sites;
    const char *origin = header(r, "Origin", &n_origins);
    const char *site = header(r, "Sec-Fetch-Site", &n_sites);
    bool second = w->port != w->page_port;
    bool reads = r->method && strcmp(r->method, "GET") == 0;
    if (n_origins > 1 || n_sites > 1 || (origin && !is_own_origin(w, origin))) {
        return refuse(403, "forbidden", "the request comes from another page");
    }
    if (!site || strcmp(site, "same-origin") == 0) {
        return fine;
    }
    if (second && strcmp(site, "same-site") == 0) {
        return fine;
    }
    /* Typed into the address bar, or a link that was clicked: what it opens is our own page. */
    const char *mode = header(r, "Sec-Fetch-Mode", NULL), *to = header(r, "Sec-Fetch-Dest", NULL);
    if (reads && mode && to && strcmp(mode, "navigate") == 0 && strcmp(to, "document") == 0) {
        return fine;
    }
    return refuse(403, "forbidden", "the request comes from another site");
}

access_answer access_check_source(const access_rules *w, const access_request *r)
{
    int n_hosts;
    const char *host = header(r, "Host", &n_hosts);
    if (!r->uri || r->uri[0] != '/' || r->uri[1] == '/') {
        return refuse(403, "forbidden", "the request names a host in its URI");
    }
    if (n_hosts != 1 || !own_host(w, host, w->port)) {
        return refuse(403, "forbidden",
                      "the header Host is not the address of this server; --name allows another");
    }
    return check_origin(w, r);
}

bool access_equal(const char *a, const char *b)
{
    size_t n = strlen(a), m = strlen(b);
    unsigned differ = n != m;
    for (size_t i = 0; i < n; i++) {
        differ |= (unsigned)(a[i] ^ b[m ? i % m : 0]) & 0xffU;
    }
    return differ == 0 && n > 0;
}

access_answer access_check_token(const access_rules *w, const char *token)
{
    if (token && access_equal(token, w->token)) {
        return fine;
    }
    return refuse(401, "token",
                  "the token is missing or wrong: it stands in the link that serve printed");
}

static bool is_type(const char *type, const char *wanted)
{
    size_t n = strlen(wanted);
    return type && strncasecmp(type, wanted, n) == 0 &&
           (type[n] == '\0' || type[n] == ';' || type[n] == ' ');
}

/* A foreign form or no-cors fetch cannot send JSON: a browser asks first, and is refused. */
static bool is_type_allowed(const access_request *r, access_rule rule)
{
    const char *type = header(r, "Content-Type", NULL);
    if (is_type(type, "application/json")) {
        return true;
    }
    switch (rule) {
    case ACCESS_PAGE:
    case ACCESS_READ:
        return true;
    case ACCESS_STOP:
        return true; /* a stop needs no body: what kind it is of does not matter */
    case ACCESS_PLAIN:
        return is_type(type, "text/plain");
    case ACCESS_ACT:
    case ACCESS_DRAFT:
        return false;
    case ACCESS_SAVE:
        return is_type(type, "application/octet-stream");
    }
    return false;
}

const char *access_method(access_rule rule)
{
    return rule == ACCESS_PAGE || rule == ACCESS_READ ? "GET"
           : rule == ACCESS_SAVE                      ? "PUT"
                                                      : "POST";
}

access_answer access_check_right(const access_rules *w, const access_request *r, access_rule rule)
{
    if (!r->method || strcmp(r->method, access_method(rule)) != 0) {
        return refuse(405, "method", "this method is not for this path");
    }
    if (!is_type_allowed(r, rule)) {
        return refuse(415, "forbidden", "the header Content-Type is not application/json");
    }
    if (rule == ACCESS_PAGE || rule == ACCESS_STOP || rule == ACCESS_PLAIN ||
        (rule == ACCESS_READ && !w->open)) {
        return fine;
    }
    return access_check_token(w, header(r, "X-Grobo-Token", NULL));
}

void access_make_secret(char secret[ACCESS_SECRET_BYTES])
{
    unsigned char bits[16];
    evutil_secure_rng_get_bytes(bits, sizeof bits);
    for (size_t i = 0; i < sizeof bits; i++) {
        snprintf(secret + 2 * i, 3, "%02x", bits[i]);
    }
}
