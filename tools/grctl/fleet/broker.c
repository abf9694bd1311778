/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "tools/grctl/fleet/broker.h"

static int bad(app *a, const char *url)
{
    return app_fail(a, EXIT_USAGE, "ARG",
                    "--broker %s: mqtt://[USER@]HOST[:PORT] or mqtts://... is wanted", url);
}

static bool take_port(broker *b, const char *text)
{
    char *behind;
    long port = strtol(text, &behind, 10);
    b->config.port = (int)port;
    return behind != text && *behind == '\0' && port > 0 && port < 65536;
}

/* HOST[:PORT]; an address of IPv6 stands in brackets. */
static bool take_host(broker *b, const char *host)
{
    bool six = *host == '[';
    const char *end = host + strcspn(host, six ? "]" : ":");
    const char *rest = six && *end ? end + 1 : end;
    host += six;
    if (end <= host || (size_t)(end - host) >= sizeof b->host || (six && *end != ']')) {
        return false;
    }
    snprintf(b->host, sizeof b->host, "%.*s", (int)(end - host), host);
    return *rest == ':' ? take_port(b, rest + 1) : *rest == '\0';
}

/* [USER@]HOST[:PORT] */
static bool take_place(broker *b, const char *place)
{
    const char *at = strrchr(place, '@');
    if (at && (size_t)(at - place) >= sizeof b->user) {
        return false;
    }
    snprintf(b->user, sizeof b->user, "%.*s", at ? (int)(at - place) : 0, place);
    return take_host(b, at ? at + 1 : place);
}

int broker_read(broker *b, app *a)
{
    const char *url =
        app_option(a, BROKER_URL)->given ? app_option(a, BROKER_URL)->text : "mqtt://localhost";
    bool tls = strncmp(url, "mqtts://", 8) == 0;
    memset(b, 0, sizeof *b);
    if (!mqtt_possible()) {
        return app_fail(a, EXIT_ROBOT, "UNSUPPORTED", "%s: this grctl has no MQTT in it",
                        a->line.command->name);
    }
    if (!tls && strncmp(url, "mqtt://", 7) != 0) {
        return bad(a, url);
    }
    b->config.port = tls ? MQTT_TLS_PORT : MQTT_PORT;
    if (!take_place(b, url + (tls ? 8 : 7))) {
        return bad(a, url);
    }
    b->config.host = b->host;
    b->config.user = *b->user ? b->user : NULL;
    b->config.password = *b->user ? getenv("GRCTL_MQTT_PASSWORD") : NULL;
    b->config.ca = app_option(a, BROKER_CA)->text;
    b->config.certificate = app_option(a, BROKER_CERT)->text;
    b->config.key = app_option(a, BROKER_KEY)->text;
    if (tls && !b->config.ca) {
        return app_fail(a, EXIT_USAGE, "ARG",
                        "--broker %s: --ca names the file that the broker's certificate is "
                        "checked by",
                        url);
    }
    if (!b->config.certificate != !b->config.key) {
        return app_fail(a, EXIT_USAGE, "ARG", "--cert and --key belong together");
    }
    b->config.ca = tls ? b->config.ca : NULL;
    b->config.keepalive_s = 5; /* less is refused by libmosquitto */
    return EXIT_DONE;
}
