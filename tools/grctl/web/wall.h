/* SPDX-License-Identifier: MIT */
/*
 * Who may ask what of `serve`: judged by the raw request, before anything else looks at it. evhttp
 * itself takes any Host, two of them, and lets a URI's own host win.
 */
#ifndef GRCTL_WEB_WALL_H
#define GRCTL_WEB_WALL_H

#include <stdbool.h>
#include <stdint.h>

struct evkeyvalq;

enum {
    WALL_TOKEN_BYTES = 64 + 1,  /* of a token, with its NUL */
    WALL_SECRET_BYTES = 32 + 1, /* of one that is made here: 128 bits in hexadecimal */
    WALL_NAME_BYTES = 128,
    WALL_HOSTS = 5
};

/* What is asked of a request beside what is asked of all. */
typedef enum wall_rule {
    WALL_PAGE,  /* GET of the page: anybody who reaches it, the token is in none of it */
    WALL_READ,  /* GET of data */
    WALL_STOP,  /* POST that stops: its content type and its body do not matter */
    WALL_PLAIN, /* POST whose token may stand in its text/plain body: judged by who reads it */
    WALL_ACT,   /* POST that changes something */
    WALL_SAVE,  /* PUT */
    WALL_DRAFT  /* POST of a draft: as ACT, and as large as what is PUT */
} wall_rule;

typedef struct wall {
    char hosts[WALL_HOSTS][WALL_NAME_BYTES]; /* without port */
    int n_hosts;
    uint16_t port;      /* that this listener has */
    uint16_t page_port; /* that of the page: its Origin */
    bool open;          /* it listens beyond loopback */
    char token[WALL_TOKEN_BYTES];
} wall;

typedef struct wall_request {
    const char *method; /* "GET", "POST", "PUT"; NULL: another */
    const char *uri;    /* as it was sent */
    const struct evkeyvalq *headers;
} wall_request;

/* What is wrong with it, and its HTTP status and code of error; status 0: nothing. */
typedef struct wall_answer {
    int status;
    const char *code, *message;
} wall_answer;

/* Host, URI, Origin: of every request, also of one for nothing that is here. */
wall_answer wall_check_source(const wall *w, const wall_request *r);
/* Method, content type, token. */
wall_answer wall_check_right(const wall *w, const wall_request *r, wall_rule rule);
/* The one method of what has this rule. */
const char *wall_method(wall_rule rule);
/* A token that stood elsewhere than in its header. */
wall_answer wall_check_token(const wall *w, const char *token);

/* The host of the request without its port, in brackets where it is IPv6: one of ours. */
const char *wall_host(const wall *w, const wall_request *r);

/* Equal, in a time that does not tell where they differ. */
bool wall_equal(const char *a, const char *b);
/* 128 random bits. */
void wall_make_secret(char secret[WALL_SECRET_BYTES]);

#endif
