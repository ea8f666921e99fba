/* Digests, requests and the mailbox, each against known values and its limits. */
#include "check.h"

#include "base/memory.h"
#include "live/channel.h"
#include "live/digest.h"
#include "live/mailbox.h"
#include "live/request.h"

#include <stdlib.h>
#include <string.h>

static void hash_both(const char *text, size_t size, char sha1[PEL_DIGEST_TEXT], char sha256[PEL_DIGEST_TEXT])
{
    unsigned char digest[PEL_SHA256_SIZE];
    pel_sha1(text, size, digest);
    pel_digest_text(digest, PEL_SHA1_SIZE, sha1);
    pel_sha256(text, size, digest);
    pel_digest_text(digest, PEL_SHA256_SIZE, sha256);
}

/* FIPS 180-4's examples; texts around the length of a block from Python's hashlib */
static void test_digests(void **unused)
{
    (void)unused;
    static const struct {
        size_t size;
        const char *sha1, *sha256;
    } cases[] = {
        {0, "2jmj7l5rSw0yVb/vlWAYkK/YBwk=", "47DEQpj8HBSa+/TImW+5JCeuQeRkm5NMpJWZG3hSuFU="},
        {1, "hvfkN/qlp/zhXR3cuerq6jd2Z7g=", "ypeBEsobvcr6wjGzmiPcTaeG7/gUfE5yuYB3ha/uSLs="},
        {55, "wci73CJ5bijA4VFj0giZtlYh1lo=", "n0OQ+NMMLdkuyfCVtl4rmumwqSWlJY4kHJ8ekQ9zQxg="},
        {56, "wtszD2CDhUyZ1LW/tujynyAb5pk=", "s1Q5pKxvCUi21vnjxq8PX1kM4g8b3nCQ73lwaG7Gc4o="},
        {63, "A/CfWxWKeoza2SC93Cm4HBilUfU=", "fT50oF19sVvOStnsBljqmOPwbu7PFrTG//LaRX3cLzQ="},
        {64, "AJi6gktcFkJ716ESKlpEKiXsZE0=", "/+BU/nrgy23GXDr5th1SCfQ5hR20PQulmXM33xVGaOs="},
        {65, "EWVTJscI1wMZviYQ6KV9mluVnTs=", "Y1NhxIu56rFBmOduqKt/GkFoXWrWKqkUbTAdTxfrCuA="},
        {119, "7pcQZaqgF+BjKoymx3uzv4sd/FY=", "MeulHDE6XAgiat8Y1KNZz9/Y0ugWsT9K+VL36mWE3Ps="},
        {120, "80wUiDhTRqVXCboFbd0IKA3UxtY=", "Lz0zVDLHC1gK8Ojhs2dKfAINaDql9zqq7f3FWvkEwhw="},
        {128, "rVs/28tSZ3jCg50vFR6nU5leJqA=", "aDbPE7rEAOkQUHHNavRwhN+srU5eMCyUv+0k4BOvtz4="},
        {200, "5hz//g2RlaUl/GzwbKLXcRnCSkA=", "wqkI2Y9d+Yet5BtfziEwZ++8wh7yJAISpB5UtefCiuU="},
    };
    char text[200], sha1[PEL_DIGEST_TEXT], sha256[PEL_DIGEST_TEXT];
    memset(text, 'a', sizeof text);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        hash_both(text, cases[i].size, sha1, sha256);
        assert_string_equal(sha1, cases[i].sha1);
        assert_string_equal(sha256, cases[i].sha256);
    }
    hash_both("abc", 3, sha1, sha256);
    assert_string_equal(sha1, "qZk+NkcGgWq6PiVxeFDCbJzQ2J0=");
    assert_string_equal(sha256, "ungWv48Bz+pBQUDeXa4iI7ADYaOWF3qctBD/YfIAFa0=");
    /* RFC 6455, section 1.3 */
    pel_channel_accept("dGhlIHNhbXBsZSBub25jZQ==", sha1);
    assert_string_equal(sha1, "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=");
}

static pel_request_end parse(const char *text, pel_request *request)
{
    return pel_request_parse(text, strlen(text), "pellicle-1", request);
}

static void test_requests(void **unused)
{
    (void)unused;
    pel_request request;
    const char whole[] =
        "GET /a?x=1&token=ab HTTP/1.1\r\nHost: h\r\nCookie: pellicle-1=cd\r\nConnection: keep-alive, "
        "Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: k\r\n\r\nrest";
    /* every beginning is a part; bytes behind the head stay */
    for (size_t size = 0; size < strlen(whole) - 4; size++)
        assert_int_equal(pel_request_parse(whole, size, "pellicle-1", &request), PEL_REQUEST_PART);
    assert_int_equal(parse(whole, &request), PEL_REQUEST_WHOLE);
    assert_int_equal(request.size, strlen(whole) - 4);
    assert_true(request.is_get && request.upgrades && request.has_query_token && !request.has_protocol);
    assert_string_equal(request.path, "/a");
    assert_string_equal(request.token, "ab");
    assert_string_equal(request.host, "h");
    assert_int_equal(parse("POST / HTTP/1.1\r\nhost:h\r\nCookie: a=b; pellicle-1=cd\r\n\r\n", &request),
                     PEL_REQUEST_WHOLE);
    assert_true(!request.is_get && !request.upgrades && !request.has_query_token);
    assert_string_equal(request.token, "cd");
    static const char *const bad[] = {
        "GET / HTTP/1.0\r\n\r\n",
        "GET x HTTP/1.1\r\n\r\n",
        "GET / HTTP/1.1\r\n: a\r\n\r\n",
        "GET / HTTP/1.1\r\nA : b\r\n\r\n",
        "GET / HTTP/1.1\nHost: a\r\n\r\n",
        "\r\n\r\n",
        "GET / HTTP/1.1\r\nHost: a\r\nHost: a\r\n\r\n",
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(parse(bad[i], &request), PEL_REQUEST_BAD);
    /* a zero byte, and values that do not fit */
    assert_int_equal(pel_request_parse("GET / HTTP/1.1\r\nA: \0\r\n\r\n", 24, "c", &request), PEL_REQUEST_BAD);
    char line[1000];
    snprintf(line, sizeof line, "GET / HTTP/1.1\r\nHost: %0*d\r\n\r\n", PEL_HOST_SIZE, 1);
    assert_int_equal(parse(line, &request), PEL_REQUEST_BAD);
    snprintf(line, sizeof line, "GET /?token=%0*d HTTP/1.1\r\n\r\n", PEL_TOKEN_SIZE, 1);
    assert_int_equal(parse(line, &request), PEL_REQUEST_WHOLE);
    assert_true(request.has_query_token && request.token[0] == '\0');
    char *large = malloc(PEL_HEAD_LIMIT);
    memset(large, 'a', PEL_HEAD_LIMIT);
    assert_int_equal(pel_request_parse(large, PEL_HEAD_LIMIT - 1, "c", &request), PEL_REQUEST_PART);
    assert_int_equal(pel_request_parse(large, PEL_HEAD_LIMIT, "c", &request), PEL_REQUEST_BAD);
    free(large);
}

static char *make_line(size_t size)
{
    char *line = pel_allocate(size + 1, 1);
    assert_non_null(line);
    memset(line, 'a', size);
    return line;
}

static int32_t take_all(pel_mailbox *box)
{
    static char *lines[PEL_LINE_LIMIT];
    int32_t count = 0;
    assert_true(pel_mailbox_wait(box, 0, lines, &count));
    for (int32_t i = 0; i < count; i++)
        pel_free(lines[i]);
    return count;
}

/* lines and bytes that wait are limited; then there is room again */
static void test_mailbox(void **unused)
{
    (void)unused;
    pel_mailbox box;
    pel_mailbox_create(&box);
    /* docs/live.md */
    assert_true(PEL_LINE_LIMIT == 1024 && PEL_MESSAGE_LIMIT == 8 << 20 && PEL_WAITING_LIMIT == 32 << 20);
    for (int round = 0; round < 2; round++) {
        for (int i = 0; i < PEL_LINE_LIMIT + 5; i++)
            pel_mailbox_line(&box, make_line(3), false);
        assert_int_equal(box.lost_lines, 5 * (round + 1));
        assert_int_equal(take_all(&box), PEL_LINE_LIMIT);
    }
    const int32_t fit = PEL_WAITING_LIMIT / PEL_MESSAGE_LIMIT;
    for (int i = 0; i < fit + 2; i++)
        pel_mailbox_line(&box, make_line(PEL_MESSAGE_LIMIT - 1), false);
    assert_int_equal(box.lost_lines, 12);
    assert_int_equal(take_all(&box), fit);
    /* a page that has not drawn two frames gets no third one */
    unsigned char *bytes = NULL;
    size_t room = 0, size = 0;
    pel_mail_reader reader;
    pel_mailbox_welcome(&box, &reader);
    for (int i = 0; i < PEL_FRAMES_UNDER_WAY + 1; i++) {
        pel_mailbox_post(&box, PEL_POST_FRAME, (unsigned char *)make_line(7), 7);
        int kind = pel_mailbox_take(&box, &reader, 10, &bytes, &room, &size);
        assert_int_equal(kind, i < PEL_FRAMES_UNDER_WAY ? PEL_POST_FRAME : PEL_POST_COUNT);
    }
    pel_mailbox_received(&reader);
    assert_int_equal(pel_mailbox_take(&box, &reader, 10, &bytes, &room, &size), PEL_POST_FRAME);
    pel_free(bytes);
    /* a stage is busy only while lines wait, and is told once */
    pel_mailbox_begin(&box, "the step", 0);
    assert_null(pel_mailbox_find_busy(&box, pel_seconds() + 1));
    pel_mailbox_line(&box, make_line(1), false);
    assert_null(pel_mailbox_find_busy(&box, pel_seconds() - 100));
    assert_string_equal(pel_mailbox_find_busy(&box, pel_seconds() + 1), "the step");
    assert_null(pel_mailbox_find_busy(&box, pel_seconds() + 1));
    (void)take_all(&box);
    pel_mailbox_begin(&box, "opening", 1);
    assert_string_equal(pel_mailbox_find_busy(&box, pel_seconds() + 1), "opening");
    pel_mailbox_destroy(&box);
}

/* takes the head of a masked frame of a text, and its payload of spaces */
static pel_channel_event take_frame(pel_channel *channel, unsigned char first, size_t size, size_t given)
{
    unsigned char head[PEL_CHANNEL_HEAD] = {first, 0x80 | 127}, *payload = malloc(given + 1);
    size_t used = 0;
    assert_non_null(payload);
    memset(payload, ' ', given + 1);
    for (int i = 0; i < 8; i++)
        head[2 + i] = (unsigned char)((uint64_t)size >> (56 - 8 * i));
    pel_channel_event event = pel_channel_take(channel, head, sizeof head, &used);
    if (event == PEL_CHANNEL_NOTHING && given > 0)
        event = pel_channel_take(channel, payload, given, &used);
    free(payload);
    return event;
}

/* a message of 8 MiB is whole, also in pieces; a byte more is refused by the head, before it comes */
static void test_message_limit(void **unused)
{
    (void)unused;
    pel_channel channel = {0};
    assert_int_equal(take_frame(&channel, 0x81, PEL_MESSAGE_LIMIT, PEL_MESSAGE_LIMIT), PEL_CHANNEL_MESSAGE);
    assert_int_equal(strlen(channel.text), PEL_MESSAGE_LIMIT);
    assert_int_equal(take_frame(&channel, 0x81, PEL_MESSAGE_LIMIT + 1, 0), PEL_CHANNEL_REFUSED);
    pel_channel_free(&channel);
    const size_t part = PEL_MESSAGE_LIMIT / 2;
    for (size_t more = 0; more < 2; more++) {
        assert_int_equal(take_frame(&channel, 0x01, part, part), PEL_CHANNEL_NOTHING);
        pel_channel_event event = take_frame(&channel, 0x80, part + more, more == 0 ? part : 0);
        assert_int_equal(event, more == 0 ? PEL_CHANNEL_MESSAGE : PEL_CHANNEL_REFUSED);
    }
    pel_channel_free(&channel);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_digests), cmocka_unit_test(test_requests),
                                       cmocka_unit_test(test_mailbox), cmocka_unit_test(test_message_limit)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
