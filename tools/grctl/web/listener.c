/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include <grobo/error.h>

#include "tools/grctl/cli/output.h"
#include "tools/grctl/web/listener.h"

enum { TOKEN_LEAST = 16, WRONG_US = 300000 };

int listener_open(app *a, const web_options *options, http_config *config, events *e)
{
    const char *complaint = NULL, *token = getenv("GRCTL_TOKEN");
    config->address = options->listen;
    config->port = options->port;
    config->name = options->name;
    config->token = token && *token ? token : NULL;
    config->wrong_us = WRONG_US;
    if (config->token && (strlen(token) < TOKEN_LEAST || strlen(token) >= ACCESS_TOKEN_BYTES)) {
        return app_fail(a, EXIT_USAGE, "ARG", "serve: GRCTL_TOKEN has %d to %d characters",
                        TOKEN_LEAST, ACCESS_TOKEN_BYTES - 1);
    }
    int error = http_new(config, &e->to, &complaint);
    if (error) {
        return app_fail(a, EXIT_ROBOT, grobo_error_name(error), "serve: port %u: %s", options->port,
                        complaint);
    }
    return EXIT_DONE;
}

void listener_announce(const app *a, const http *h)
{
    const char *host = http_host(h);
    char url[256], stop_url[256];
    snprintf(url, sizeof url, "http://%s:%u/", host, http_port(h));
    snprintf(stop_url, sizeof stop_url, "http://%s:%u/", host, http_stop_port(h));
    if (a->json) {
        app_print_json(
            json_pack("{s:s,s:s,s:s}", "url", url, "stop_url", stop_url, "token", http_token(h)));
    } else {
        if (http_is_open(h)) {
            app_note(a, "serve: HTTP is not encrypted: programs on that network can read the "
                        "token; use 'ssh -L' or a proxy with TLS");
        }
        app_print("%s#token=%s\n", url, http_token(h));
    }
    output_flush();
}

const char *body_text(const json_t *body, const char *key)
{
    const char *text = json_string_value(json_object_get(body, key));
    return text ? text : "";
}

const char *header_or_body(const http_request *r, const json_t *body, const char *header,
                           const char *key)
{
    const char *value = http_header(r, header);
    return value ? value : body_text(body, key);
}

bool listener_has_token(http_request *r, const json_t *body)
{
    access_answer no = http_check_token(r, header_or_body(r, body, "X-Grobo-Token", "token"));
    if (no.status) {
        http_refuse(r, no.status, no.code, "%s", no.message);
    }
    return !no.status;
}

requester requester_of(const json_t *body)
{
    const char *given = body_text(body, "name");
    size_t n = strlen(given);
    requester who = {"a script"};
    if (n >= sizeof who.name) {
        n = sizeof who.name - 1;
        while (((unsigned char)given[n] & 0xC0) == 0x80) { /* JSON has whole characters */
            n--;
        }
    }
    if (n > 0) {
        memcpy(who.name, given, n);
        who.name[n] = '\0';
    }
    return who;
}
