/* SPDX-License-Identifier: MIT */
/*
 * The process that has the connection to a broker: whatever a broker says, and whatever that
 * process becomes, who uses it hears of a broker that was lost and goes on. This program is its own
 * process of a connection, see main().
 */
#include <netinet/in.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <event2/buffer.h>
#include <event2/event.h>
#include <event2/listener.h>

#include "tests/support/next_random.h"
#include "tests/support/test.h"
#include "tools/grctl/fleet/mqtt.h"
#include "tools/grctl/fleet/mqtt_host.h"
#include "tools/grctl/fleet/mqtt_note.h"
#include "tools/grctl/os/child.h"

enum { SESSIONS = 90, PATIENCE_S = 60 };

static const char as_what[] = "GROBO_TEST_BROKER_PROCESS";
static const unsigned char accepted[] = {0x20, 0x03, 0, 0, 0};

/* ---- a broker -------------------------------------------------------------------------------- */

typedef struct rig {
    struct event_base *base;
    struct evconnlistener *listener;
    uint16_t port;
    unsigned char says[4096]; /* to who connects, then it closes unless it keeps */
    size_t size;
    bool keeps;
    mqtt *m;
    int ups, downs, messages;
    char why[256];
} rig;

static void on_connect_packet(evutil_socket_t fd, short what, void *ctx)
{
    rig *r = ctx;
    char bytes[1024];
    (void)what;
    ssize_t n = recv(fd, bytes, sizeof bytes, 0);
    if (n > 0) {
        (void)!send(fd, r->says, r->size, MSG_NOSIGNAL);
    }
    if (n <= 0 || !r->keeps) {
        close(fd);
    } else {
        event_base_once(r->base, fd, EV_READ, on_connect_packet, r, NULL);
        r->size = 0;
    }
}

static void on_accept(struct evconnlistener *listener, evutil_socket_t fd, struct sockaddr *from,
                      int size, void *ctx)
{
    rig *r = ctx;
    (void)listener;
    (void)from;
    (void)size;
    event_base_once(r->base, fd, EV_READ, on_connect_packet, r, NULL);
}

static void says(rig *r, const void *bytes, size_t size)
{
    assert_true(r->size + size <= sizeof r->says);
    memcpy(r->says + r->size, bytes, size);
    r->size += size;
}

static void on_up(void *ctx)
{
    ((rig *)ctx)->ups++;
}

static void on_down(void *ctx, const char *why)
{
    rig *r = ctx;
    r->downs++;
    snprintf(r->why, sizeof r->why, "%s", why);
    event_base_loopbreak(r->base);
}

static void on_message(void *ctx, const mqtt_message *message)
{
    rig *r = ctx;
    r->messages++;
    assert_true(strlen(message->topic) > 0 && message->size <= MQTT_PAYLOAD_MAX_BYTES);
}

static void on_refused(void *ctx, const char *why)
{
    (void)ctx;
    assert_true(strlen(why) > 0);
}

static void begin(rig *r)
{
    struct sockaddr_in here = {.sin_family = AF_INET};
    socklen_t size = sizeof here;
    here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    memset(r, 0, sizeof *r);
    r->base = event_base_new();
    r->listener = evconnlistener_new_bind(r->base, on_accept, r, LEV_OPT_CLOSE_ON_FREE, -1,
                                          (struct sockaddr *)&here, sizeof here);
    assert_non_null(r->listener);
    assert_int_equal(
        getsockname(evconnlistener_get_fd(r->listener), (struct sockaddr *)&here, &size), 0);
    r->port = ntohs(here.sin_port);
    says(r, accepted, sizeof accepted);
}

static void join(rig *r)
{
    const mqtt_config config = {.base = r->base,
                                .host = "127.0.0.1",
                                .port = r->port,
                                .id = "test",
                                .keepalive_s = 5,
                                .will_topic = "w",
                                .will = "gone",
                                .on_up = on_up,
                                .on_down = on_down,
                                .on_message = on_message,
                                .on_refused = on_refused,
                                .ctx = r};
    const char *why;
    r->m = mqtt_new(&config, &why);
    assert_non_null(r->m);
    mqtt_start(r->m);
}

static void give_up(evutil_socket_t fd, short what, void *ctx)
{
    (void)fd;
    (void)what;
    (void)ctx;
    fail_msg("nothing came");
}

/* Until so many losses were told, and it is as it is wanted. */
static void await(rig *r, int downs, bool up)
{
    const struct timeval most = {.tv_sec = PATIENCE_S};
    struct event *limit = evtimer_new(r->base, give_up, NULL);
    evtimer_add(limit, &most);
    while (r->downs < downs || mqtt_is_up(r->m) != up) {
        assert_true(event_base_loop(r->base, EVLOOP_ONCE) >= 0);
    }
    event_free(limit);
}

static void await_downs(rig *r, int n)
{
    await(r, n, false);
}

static void await_up(rig *r)
{
    await(r, 0, true);
}

static void leave(rig *r)
{
    mqtt_free(r->m);
    evconnlistener_free(r->listener);
    event_base_free(r->base);
    assert_int_equal(waitpid(-1, NULL, WNOHANG), -1); /* no child is left */
}

/* ---- what a broker says ---------------------------------------------------------------------- */

/* An AUTH with properties that it must not have: an assertion of libmosquitto 2.0.11. */
TEST(ends_nobody_else)
{
    static const unsigned char packet[] = {0xf0, 0x03, 0x00, 0x68, 0x00};
    rig r;
    begin(&r);
    says(&r, packet, sizeof packet);
    r.keeps = true;
    join(&r);
    await_downs(&r, 1);
    assert_false(mqtt_is_up(r.m));
    r.size = 0; /* the next one is a good broker */
    says(&r, accepted, sizeof accepted);
    await_up(&r);
    leave(&r);
}

/* Some packets with a right head and any content, then bytes of any kind. */
static void say_random(rig *r, uint32_t seed)
{
    int packets = (int)(next_random(&seed) % 8);
    for (int i = 0; i < packets; i++) {
        unsigned char packet[96];
        size_t length = next_random(&seed) % (sizeof packet - 2);
        packet[0] = (unsigned char)next_random(&seed);
        packet[1] = (unsigned char)length;
        for (size_t at = 0; at < length; at++) {
            uint32_t any = next_random(&seed);
            packet[2 + at] = (unsigned char)(any & 0x300 ? any % 8 : any);
        }
        says(r, packet, 2 + length);
    }
    for (uint32_t n = next_random(&seed) % 256; n > 0; n--) {
        unsigned char any = (unsigned char)next_random(&seed);
        says(r, &any, 1);
    }
}

TEST(survives_random_sessions)
{
    int died = 0;
    for (uint32_t seed = 1; seed <= SESSIONS; seed++) {
        rig r;
        begin(&r);
        say_random(&r, seed);
        join(&r);
        await_downs(&r, 1);
        died += strstr(r.why, "the process of the connection ended") != NULL;
        leave(&r);
    }
    printf("# %d of %d sessions ended the process of the connection\n", died, SESSIONS);
}

/* ---- what the process may become ------------------------------------------------------------- */

static void send_note(int fd, note_kind kind, uint32_t number, const char *topic)
{
    struct evbuffer *bytes = evbuffer_new();
    const note n = {.kind = kind, .number = {number}, .message = {.topic = topic}};
    size_t size = note_write(bytes, &n) ? evbuffer_get_length(bytes) : 0;
    (void)os_child_send(fd, evbuffer_pullup(bytes, -1), size);
    evbuffer_free(bytes);
}

static void say_garbage(int fd)
{
    unsigned char bytes[256];
    memset(bytes, 0xff, sizeof bytes);
    (void)os_child_send(fd, bytes, sizeof bytes);
}

/* In the process: as what GROBO_TEST_BROKER_PROCESS tells. */
static int misbehave(const char *how)
{
    int fd = os_child_settle();
    char byte;
    if (strcmp(how, "never") == 0) {
        return 1;
    }
    send_note(fd, NOTE_READY, 0, NULL);
    if (strcmp(how, "garbage") == 0) {
        say_garbage(fd);
    } else if (strcmp(how, "order") == 0) {
        send_note(fd, NOTE_PUBLISH, 1, "x"); /* what only the other side says */
    } else if (strcmp(how, "early") == 0) {
        send_note(fd, NOTE_MESSAGE, 0, "x"); /* without a connection */
    } else if (strcmp(how, "wild") == 0) {
        send_note(fd, NOTE_UP, 1, NULL);
        send_note(fd, NOTE_MESSAGE, 0, "a/+/b");
    } else if (strcmp(how, "taken") == 0) {
        send_note(fd, NOTE_UP, 1, NULL);
        send_note(fd, NOTE_TAKEN, 77, NULL); /* what nobody gave */
    } else if (strcmp(how, "hangs") == 0) {
        send_note(fd, NOTE_UP, 1, NULL);
    } else {
        abort();
    }
    while (read(fd, &byte, 1) > 0) { /* it stays until it is ended */
        continue;
    }
    return 0;
}

static void is_ended(const char *how, const char *why)
{
    rig r;
    setenv(as_what, how, 1);
    begin(&r);
    join(&r);
    await_downs(&r, 1);
    assert_string_equal(r.why, why);
    assert_int_equal(r.messages, 0);
    assert_false(mqtt_is_up(r.m));
    const mqtt_message message = {.topic = "t", .payload = "x", .size = 1};
    assert_int_equal(mqtt_publish(r.m, &message, 1, 0), 0);
    leave(&r);
    unsetenv(as_what);
}

TEST(checks_what_it_says)
{
    static const char *const hows[] = {"garbage", "order", "early", "wild", "taken"};
    for (size_t i = 0; i < sizeof hows / sizeof hows[0]; i++) {
        is_ended(hows[i], "what the process of the connection says is not understood");
    }
}

TEST(starts_it_again)
{
    rig r;
    setenv(as_what, "dies", 1);
    begin(&r);
    join(&r);
    await_downs(&r, 3);
    unsetenv(as_what);
    await_up(&r);
    leave(&r);
}

TEST(ends_one_that_hangs)
{
    is_ended("hangs", "the process of the connection hangs");
}

/* As where a system has no such process: the connection is in this one. */
TEST(stays_inside)
{
    rig r;
    setenv(as_what, "never", 1);
    begin(&r);
    r.keeps = true;
    join(&r);
    unsetenv(as_what);
    assert_int_equal(waitpid(-1, NULL, WNOHANG), -1); /* there is none */
    await_up(&r);
    const mqtt_message message = {.topic = "t", .payload = "x", .size = 1};
    assert_true(mqtt_publish(r.m, &message, 0, 0) > 0);
    assert_true(mqtt_subscribe(r.m, "t", 0, false));
    leave(&r);
}

int main(int argc, char **argv)
{
    const char *how = getenv(as_what);
    if (argc == 2 && strcmp(argv[1], MQTT_HOST_WORD) == 0) {
        return how ? misbehave(how) : mqtt_host_main();
    }
    mqtt_note_program(argv[0]);
    if (!mqtt_possible()) {
        printf("1..0 # SKIP built without libmosquitto\n");
        return 0;
    }
    return test_main(argc, argv);
}
