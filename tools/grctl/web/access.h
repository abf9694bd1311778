/* SPDX-License-Identifier: MIT */
/*
 * Who may ask what of `serve`: judged by the raw request, before anything else looks at it. evhttp
 * itself takes any Host, two of them, and lets a URI's own host win.
 */
#ifndef GRCTL_WEB_ACCESS_H
#define GRCTL_WEB_ACCESS_H

#include <stdbool.h>
#include <stdint.h>

struct evkeyvalq;

enum {
    ACCESS_TOKEN_BYTES = 64 + 1,  /* of a token, with its NUL */
    ACCESS_SECRET_BYTES = 32 + 1, /* of one that is made here: 128 bits in hexadecimal */
    ACCESS_NAME_BYTES = 128,
    ACCESS_HOSTS = 5
};

/* What is asked of a request beside what is asked of all. */
typedef enum access_rule {
    ACCESS_PAGE,  /* GET of the page: anybody who reaches it, the token is in none of it */
    ACCESS_READ,  /* GET of data */
    ACCESS_STOP,  /* POST that stops: its content type and its body do not matter */
    ACCESS_PLAIN, /* POST whose token may stand in its text/plain body: judged by who reads it */
    ACCESS_ACT,   /* POST that changes something */
    ACCESS_SAVE,  /* PUT */
    ACCESS_DRAFT  /* POST of a draft: as ACT, and as large as what is PUT */
} access_rule;

typedef struct access_rules {
    char hosts[ACCESS_HOSTS][ACCESS_NAME_BYTES]; /* without port */
    int n_hosts;
    uint16_t port;      /* that this listener has */
    uint16_t page_port; /* that of the page: its Origin */
    bool open;          /* it listens beyond loopback */
    char token[ACCESS_TOKEN_BYTES];
} access_rules;

typedef struct access_request {
    const char *method; /* "GET", "POST", "PUT"; NULL: another */
    const char *uri;    /* as it was sent */
    const struct evkeyvalq *headers;
} access_request;

/* What is wrong with it, and its HTTP status and code of error; status 0: nothing. */
typedef struct access_answer {
    int status;
    const char *code, *message;
} access_answer;

/* Host, URI, Origin: of every request, also of one for nothing that is here. */
access_answer access_check_source(const access_rules *w, const access_request *r);
/* Method, content type, token. */
access_answer access_check_right(const access_rules *w, const access_request *r, access_rule rule);
/* The one method of what has this rule. */
const char *access_method(access_rule rule);
/* A token that stood elsewhere than in its header. */
access_answer access_check_token(const access_rules *w, const char *token);

/* The host of the request without its port, in brackets where it is IPv6: one of ours. */
const char *access_host(const access_rules *w, const access_request *r);

/* Equal, in a time that does not tell where they differ. */
bool access_equal(const char *a, const char *b);
/* 128 random bits. */
void access_make_secret(char secret[ACCESS_SECRET_BYTES]);

#endif
