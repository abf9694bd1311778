/* SPDX-License-Identifier: MIT */
/* The head of a stop whose body may never come. */
#include <stdio.h>
#include <string.h>

#include <event2/http.h>
#include <event2/keyvalq_struct.h>

#include "tests/support/test.h"
#include "tools/grctl/web/head.h"

static struct evkeyvalq headers;
static char text[1024], *uri;

static int begin(void)
{
    headers.tqh_first = NULL;
    headers.tqh_last = &headers.tqh_first;
    uri = NULL;
    return 0;
}

static int end(void)
{
    evhttp_clear_headers(&headers);
    return 0;
}

static const test_fixture fixture[] = {{NULL, begin, end}};

static bool read_head(const char *head)
{
    (void)end();
    (void)begin();
    snprintf(text, sizeof text, "%s", head);
    return head_read(text, &uri, &headers);
}

TEST(a_head_ends_with_an_empty_line)
{
    assert_int_equal(head_end(""), 0);
    assert_int_equal(head_end("POST / HTTP/1.1\r\nHost: a\r\n"), 0);
    assert_int_equal(head_end("a\r\n\r\nb\n\n"), 5);
    assert_int_equal(head_end("a\n\nb\r\n\r\n"), 3);
}

TEST_WITH(fixture, a_head_is_read_or_left_to_libevent)
{
    static const char *const others[] = {"\r\n\r\n",
                                         "GET /stop HTTP/1.1\r\n\r\n",
                                         "POST http://a/stop HTTP/1.1\r\n\r\n",
                                         "POST /stop\r\n\r\n",
                                         "POST /stop HTTP/2\r\n\r\n",
                                         "POST /stop HTTP/1.1\r\nHost\r\n\r\n",
                                         "POST /stop HTTP/1.1\r\nHost : a\r\n\r\n",
                                         "POST /stop HTTP/1.1\r\nA: b\r\n c\r\n\r\n",
                                         "POST /stop HTTP/1.1\r\n: a\r\n\r\n"};
    assert_true(
        read_head("POST /stop?x HTTP/1.1\r\nHost: a:1\r\nX:\tb  c\r\n\r\nrest: no\r\n\r\n"));
    assert_string_equal(uri, "/stop?x");
    assert_string_equal(evhttp_find_header(&headers, "host"), "a:1");
    assert_string_equal(evhttp_find_header(&headers, "X"), "b  c");
    assert_null(evhttp_find_header(&headers, "rest"));
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        assert_false(read_head(others[i]));
    }
}

static bool has_body(const char *lines, size_t bytes)
{
    char head[512];
    snprintf(head, sizeof head, "POST /stop HTTP/1.1\r\n%s\r\n", lines);
    assert_true(read_head(head));
    return head_has_body(&headers, bytes);
}

TEST_WITH(fixture, a_body_is_there_or_not)
{
    assert_true(has_body("", 0));
    assert_true(has_body("Content-Length: 0\r\n", 0));
    assert_true(has_body("Content-Length: 2\r\n", 2));
    assert_false(has_body("Content-Length: 2\r\n", 1));
    assert_true(has_body("Content-Length: 010\r\n", 10));
    assert_false(has_body("Content-Length: 010\r\n", 9));
    assert_false(has_body("Content-Length: none\r\n", 99));
    assert_false(has_body("Content-Length: -1\r\n", 99));
    assert_false(has_body("Content-Length: 99999999\r\n", 99));
    assert_false(has_body("Content-Length: 2\r\nContent-Length: 2\r\n", 2));
    assert_false(has_body("Transfer-Encoding: chunked\r\n", 9));
    assert_false(has_body("Content-Length: 2\r\nTransfer-Encoding: gzip\r\n", 9));
}

TEST(a_uri_has_path_and_query)
{
    char path[HTTP_PATH_BYTES], query[HTTP_PATH_BYTES], longer[2 * HTTP_PATH_BYTES];
    assert_true(head_split("/a%20b?c=d#e", path, query));
    assert_string_equal(path, "/a b");
    assert_string_equal(query, "c=d#e");
    assert_true(head_split("/", path, query));
    assert_string_equal(query, "");
    assert_false(head_split("/a%00b", path, query));
    memset(longer, '/', sizeof longer - 1);
    longer[sizeof longer - 1] = '\0';
    assert_false(head_split(longer, path, query));
}

/* Where a body ends is told once and in one way, or nobody knows which request comes next. */
TEST(what_is_malformed_has_its_status)
{
    static const struct {
        const char *line, *fields;
        int status;
    } heads[] = {
        {"GET / HTTP/1.1", "", 0},
        {"GET / HTTP/1.0", "Host: a\r\n", 0},
        {"GET / HTTP/1.2", "", 505},
        {"GET / HTTP/2.0", "", 505},
        {"GET /", "", 400},
        {"GET  / HTTP/1.1", "", 400},
        {"G(T / HTTP/1.1", "", 400},
        {"POST / HTTP/1.1", "Content-Length: 100\r\n", 0},
        {"POST / HTTP/1.1", "Content-Length: 101\r\n", 413},
        {"POST / HTTP/1.1", "Content-Length: 0000000099\r\n", 413},
        {"POST / HTTP/1.1", "Content-Length: 9a\r\n", 400},
        {"POST / HTTP/1.1", "Content-Length:\r\n", 400},
        {"POST / HTTP/1.1", "Content-Length: 2\r\nContent-Length: 2\r\n", 400},
        {"POST / HTTP/1.1", "Transfer-Encoding: chunked\r\n", 0},
        {"POST / HTTP/1.1", "Transfer-Encoding: chunked\r\nTransfer-Encoding: chunked\r\n", 400},
        {"POST / HTTP/1.1", "Content-Length: 2\r\nTransfer-Encoding: chunked\r\n", 400},
        {"POST / HTTP/1.1", "Transfer-Encoding: gzip\r\n", 501},
        {"POST / HTTP/1.1", "Expect: 100-continue\r\n", 0},
        {"POST / HTTP/1.1", "Expect: more\r\n", 417},
        {"POST / HTTP/1.1", "A: b\r\n c\r\n", 400},
        {"POST / HTTP/1.1", "A : b\r\n", 400},
    };
    for (size_t i = 0; i < sizeof heads / sizeof heads[0]; i++) {
        char head[256];
        int n = snprintf(head, sizeof head, "%s\r\n%s\r\n", heads[i].line, heads[i].fields);
        int status = head_judge(head, (size_t)n, 100).status;
        if (status != heads[i].status) {
            fail_msg("%s, %s: %d", heads[i].line, heads[i].fields, status);
        }
    }
}
