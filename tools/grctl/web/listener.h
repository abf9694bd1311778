/* SPDX-License-Identifier: MIT */
/* The way into a page: its listeners and token as the options say, and the link that is printed. */
#ifndef GRCTL_WEB_LISTENER_H
#define GRCTL_WEB_LISTENER_H

#include "tools/grctl/web/events.h"
#include "tools/grctl/web/lease.h"
#include "tools/grctl/web/web.h"

/*
 * Fills in e->to, to be freed by http_free(), and what of `config` is an option; base, rule, serve
 * and ctx are the caller's. 0, or the exit status with the reason said.
 */
int listener_open(app *a, const web_options *options, http_config *config, events *e);
/* The link, with its token. */
void listener_announce(const app *a, const http *h);
/* A key of a body that is text; "" where there is none. */
const char *body_text(const json_t *body, const char *key);
/* Where a page cannot set a header, its value stands in the body. */
const char *header_or_body(const http_request *r, const json_t *body, const char *header,
                           const char *key);
/* Has it the token, in header or body? False: it was refused. */
bool listener_has_token(http_request *r, const json_t *body);
/* Who asks, as said in the body; of a long name as many characters as fit. */
typedef struct requester {
    char name[LEASE_NAME_BYTES];
} requester;
requester requester_of(const json_t *body);

#endif
