/* SPDX-License-Identifier: MIT */
/* What the process of a connection says is foreign: every field of a note has its bounds. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <event2/buffer.h>

#include "tests/support/next_random.h"
#include "tests/support/test.h"
#include "tools/grctl/fleet/mqtt_note.h"

enum { MUTATIONS = 200000 };

static const unsigned char correlation[] = {0, 1, 2, 255};

static const note message = {.kind = NOTE_MESSAGE,
                             .number = {1, 2, 3, 0xFFFFFFFF},
                             .message = {.topic = "grobo/v1/one/cmd/put",
                                         .payload = "{\"v\":1}",
                                         .size = 7,
                                         .retained = true,
                                         .response = "grobo/v1/ack/00",
                                         .correlation = correlation,
                                         .correlation_bytes = sizeof correlation}};

TEST(comes_as_it_went)
{
    struct evbuffer *b = evbuffer_new();
    note n;
    assert_true(note_write(b, &message));
    const note second = {.kind = NOTE_DOWN, .text = {"ブローカ"}};
    assert_true(note_write(b, &second));
    assert_int_equal(note_read(b, &n), 1);
    assert_true(note_is_news(&n));
    assert_string_equal(n.message.topic, message.message.topic);
    assert_string_equal(n.message.response, message.message.response);
    assert_int_equal(n.message.size, 7);
    assert_memory_equal(n.message.payload, "{\"v\":1}", 7);
    assert_int_equal(n.message.correlation_bytes, sizeof correlation);
    assert_memory_equal(n.message.correlation, correlation, sizeof correlation);
    assert_true(n.message.retained);
    assert_memory_equal(n.number, message.number, sizeof n.number);
    assert_null(n.text[0]);
    note_drop(b);
    assert_int_equal(note_read(b, &n), 1);
    assert_string_equal(n.text[0], "ブローカ");
    assert_null(n.message.topic);
    note_drop(b);
    assert_int_equal(note_read(b, &n), 0);
    assert_int_equal(evbuffer_get_length(b), 0);
    evbuffer_free(b);
}

/* In pieces: nothing is read before its end has come. */
TEST(waits_for_its_end)
{
    struct evbuffer *whole = evbuffer_new(), *b = evbuffer_new();
    note n;
    assert_true(note_write(whole, &message));
    size_t size = evbuffer_get_length(whole);
    const unsigned char *bytes = evbuffer_pullup(whole, -1);
    for (size_t i = 0; i < size; i++) {
        assert_int_equal(note_read(b, &n), 0);
        assert_int_equal(evbuffer_add(b, bytes + i, 1), 0);
    }
    assert_int_equal(note_read(b, &n), 1);
    evbuffer_free(b);
    evbuffer_free(whole);
}

static void look_at(const note *n)
{
    const mqtt_message *m = &n->message;
    assert_true(m->size <= MQTT_PAYLOAD_MAX_BYTES && m->payload != NULL);
    assert_true(m->correlation_bytes <= NOTE_TEXT_MAX_BYTES);
    assert_true(!m->topic || strlen(m->topic) <= NOTE_TEXT_MAX_BYTES);
    if (note_is_news(n) && n->kind == NOTE_MESSAGE) {
        assert_true(*m->topic && !strpbrk(m->topic, "+#"));
    }
    if (note_is_news(n) && n->kind == NOTE_DOWN) {
        assert_true(strlen(n->text[0]) <= NOTE_WHY_MAX_BYTES && !strchr(n->text[0], '\n'));
    }
}

/* Some bytes changed, some left out: it is refused, or within its bounds. */
TEST(bounds_whatever_comes)
{
    struct evbuffer *whole = evbuffer_new();
    uint32_t seed = 1;
    int refused = 0;
    assert_true(note_write(whole, &message));
    size_t size = evbuffer_get_length(whole);
    const unsigned char *bytes = evbuffer_pullup(whole, -1);
    unsigned char *copy = malloc(size);
    assert_non_null(copy);
    for (int i = 0; i < MUTATIONS; i++) {
        struct evbuffer *b = evbuffer_new();
        note n;
        memcpy(copy, bytes, size);
        for (uint32_t k = 1 + next_random(&seed) % 4; k > 0; k--) {
            copy[next_random(&seed) % size] = (unsigned char)next_random(&seed);
        }
        assert_int_equal(evbuffer_add(b, copy, size - next_random(&seed) % 2), 0);
        int is = note_read(b, &n);
        refused += is < 0;
        if (is > 0) {
            look_at(&n);
        }
        evbuffer_free(b);
    }
    free(copy);
    evbuffer_free(whole);
    assert_in_range(refused, MUTATIONS / 4, MUTATIONS);
}

static void refuse(const note *n)
{
    assert_false(note_is_news(n));
}

TEST(judges_each_kind)
{
    char longest[NOTE_WHY_MAX_BYTES + 2];
    memset(longest, 'x', sizeof longest - 1);
    longest[sizeof longest - 1] = '\0';
    refuse(&(note){.kind = NOTE_MESSAGE});
    refuse(&(note){.kind = NOTE_MESSAGE, .message = {.topic = ""}});
    refuse(&(note){.kind = NOTE_MESSAGE, .message = {.topic = "a/#"}});
    refuse(&(note){.kind = NOTE_MESSAGE, .message = {.topic = "a", .response = "+"}});
    refuse(&(note){.kind = NOTE_MESSAGE, .message = {.topic = "a\xff"}});
    refuse(&(note){.kind = NOTE_REFUSED, .text = {"\xe3\x83"}});
    refuse(&(note){.kind = NOTE_DOWN});
    refuse(&(note){.kind = NOTE_DOWN, .text = {longest}});
    refuse(&(note){.kind = NOTE_REFUSED, .text = {"\x1b[2J"}});
    refuse(&(note){.kind = NOTE_UP});
    refuse(&(note){.kind = NOTE_TAKEN, .number = {0, 1}});
    refuse(&(note){.kind = NOTE_TAKEN, .number = {1, 2}});
    for (note_kind kind = NOTE_CONFIG; kind <= NOTE_BYE; kind++) {
        refuse(&(note){.kind = kind, .text = {"x"}, .number = {1}});
    }
    assert_true(note_is_news(&(note){.kind = NOTE_UP, .number = {1}}));
    assert_true(note_is_news(&(note){.kind = NOTE_TAKEN, .number = {1, 0}}));
    assert_true(note_is_news(&message));
}

/* A password and the name of a file are bytes. */
TEST(tells_a_configuration)
{
    const mqtt_config said = {.host = "h",
                              .port = 1883,
                              .id = "i",
                              .password = "\xff\xe9",
                              .ca = "caf\xe9.crt",
                              .keepalive_s = 5};
    mqtt_config heard = {.base = NULL};
    struct evbuffer *b = evbuffer_new();
    note n = note_of_config(&said);
    assert_true(note_write(b, &n));
    assert_int_equal(note_read(b, &n), 1);
    note_to_config(&n, &heard);
    assert_string_equal(heard.host, "h");
    assert_string_equal(heard.password, "\xff\xe9");
    assert_string_equal(heard.ca, "caf\xe9.crt");
    assert_null(heard.user);
    assert_null(heard.will);
    assert_int_equal(heard.port, 1883);
    assert_int_equal(heard.keepalive_s, 5);
    evbuffer_free(b);
}

/* A length that is none is refused at once; one that is too long is never written. */
TEST(bounds_the_length)
{
    static const unsigned char short_one[] = {1, 0, 0, 0}, long_one[] = {0xff, 0xff, 0xff, 0x7f};
    struct evbuffer *b = evbuffer_new();
    note n = {.kind = NOTE_MESSAGE, .message = {.topic = "x", .size = NOTE_MAX_BYTES}};
    assert_false(note_write(b, &n));
    assert_int_equal(evbuffer_get_length(b), 0);
    evbuffer_add(b, short_one, sizeof short_one);
    assert_int_equal(note_read(b, &n), -1);
    evbuffer_drain(b, sizeof short_one);
    evbuffer_add(b, long_one, sizeof long_one);
    assert_int_equal(note_read(b, &n), -1);
    evbuffer_free(b);
}
