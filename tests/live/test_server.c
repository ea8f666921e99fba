/* The server as a browser sees it, without one: access, messages to a page, lines of all kinds, pages that leave. */
#define _XOPEN_SOURCE 700
#include "check.h"
#include "source_dir.h"

#include "live/request.h"

#include <pellicle/server.h>

#include <arpa/inet.h>
#include <errno.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

static const char text[] =
    "version: 1\ntitle: a ball\nbodies:\n"
    "  - { name: ball, mesh: { shape: geodesic-sphere, frequency: 3 }, mass: { per_vertex: 0.1 },\n"
    "      springs: { stiffness: 3, damping: 0.1 }, volumetric: { stiffness: 1.5, damping: 0.1 } }\n"
    "solver: { method: quasi-static, dt: 0.01 }\nduration: 1\n";

static pel_scene *scene;
static pthread_t thread;
static atomic_bool is_over;
static char address[400], token[64];
static atomic_int port;
static pel_status ending;
static const char *listened; /* address of the interface; null = the default */

/* ---- the server in a thread ---- */

static void note_address(void *user, const char *given)
{
    (void)user;
    const char *digits = strrchr(given, ':') + 1;
    snprintf(address, sizeof address, "%s", given);
    snprintf(token, sizeof token, "%s", strstr(given, "token=") + 6);
    atomic_store(&port, atoi(digits));
}

static bool is_wanted(void *user)
{
    (void)user;
    return !atomic_load(&is_over);
}

static void *run_server(void *unused)
{
    (void)unused;
    pel_server_def def = pel_server_def_default();
    def.scene = scene;
    def.page = PEL_SOURCE_DIR "/tests/live/page.html";
    def.host = listened;
    def.paused = true;
    def.opened = note_address;
    def.wanted = is_wanted;
    ending = pel_serve(&def, NULL);
    atomic_store(&port, -1);
    return NULL;
}

static bool start_server(void)
{
    atomic_store(&port, 0);
    atomic_store(&is_over, false);
    if (pthread_create(&thread, NULL, run_server, NULL) != 0)
        return false;
    while (atomic_load(&port) == 0)
        nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
    return atomic_load(&port) > 0;
}

static void stop_server(void)
{
    atomic_store(&is_over, true);
    pthread_join(thread, NULL);
}

static int start(void **unused)
{
    (void)unused;
    if (pel_scene_parse("ball.yaml", text, strlen(text), NULL, 0, NULL, &scene, NULL) != PEL_OK)
        return 1;
    return !start_server();
}

static int stop(void **unused)
{
    (void)unused;
    stop_server();
    pel_scene_destroy(scene);
    return ending != PEL_OK;
}

/* ---- a browser ---- */

typedef struct client {
    int socket;
    unsigned char *message; /* the last one, with a zero behind it */
    size_t size;
    bool is_text;
} client;

static void reach(int made)
{
    struct sockaddr_in where = {.sin_family = AF_INET, .sin_port = htons((uint16_t)atomic_load(&port))};
    const struct timeval patience = {.tv_sec = 20};
    inet_pton(AF_INET, "127.0.0.1", &where.sin_addr);
    assert_int_equal(connect(made, (struct sockaddr *)&where, sizeof where), 0);
    setsockopt(made, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
}

static int call(void)
{
    int made = socket(AF_INET, SOCK_STREAM, 0);
    reach(made);
    return made;
}

static void write_all(int to, const void *bytes, size_t size)
{
    for (size_t done = 0; done < size;) {
        ssize_t count = send(to, (const char *)bytes + done, size - done, MSG_NOSIGNAL);
        if (count <= 0)
            return; /* the other side has closed: reading tells */
        done += (size_t)count;
    }
}

static bool read_all(int from, void *bytes, size_t size)
{
    for (size_t done = 0; done < size;) {
        ssize_t count = recv(from, (char *)bytes + done, size - done, 0);
        /* silence is not the end */
        if (count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK))
            fail_msg("the server neither answers nor closes");
        if (count <= 0)
            return false;
        done += (size_t)count;
    }
    return true;
}

/* sends a request and reads the head of the answer; returns its status */
static int request(int to, const char *path, const char *key, const char *headers)
{
    char out[1200], in[4096];
    size_t length = 0;
    int status = 0;
    snprintf(out, sizeof out, "GET %s%s HTTP/1.1\r\n%s\r\n", path, key, headers);
    write_all(to, out, strlen(out));
    while (length < sizeof in - 1 && read_all(to, in + length, 1)) {
        in[++length] = '\0';
        if (strstr(in, "\r\n\r\n") != NULL)
            break;
    }
    return sscanf(in, "HTTP/1.%*d %d", &status) == 1 ? status : 0;
}

static int ask(const char *path, const char *key, const char *headers)
{
    int line = call(), status = request(line, path, key, headers);
    close(line);
    return status;
}

static const char *own_host(void)
{
    static char host[100];
    snprintf(host, sizeof host, "Host: 127.0.0.1:%d\r\n", atomic_load(&port));
    return host;
}

#define UPGRADE                                                                                                        \
    "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"                                       \
    "Sec-WebSocket-Key: x3JJHMbDL1EzLkh9GBhXDw==\r\nSec-WebSocket-Protocol: pellicle\r\n"

/* asks for a channel; the status */
static int enter(int to)
{
    char headers[600], path[100];
    snprintf(headers, sizeof headers, "%s" UPGRADE, own_host());
    snprintf(path, sizeof path, "/?token=%s", token);
    return request(to, path, "", headers);
}

static client visit(void)
{
    client made = {.socket = call()};
    assert_int_equal(enter(made.socket), 101);
    return made;
}

static void leave(client *who)
{
    close(who->socket);
    free(who->message);
    *who = (client){.socket = -1};
}

/* a frame of a message of kind 1 (text) or 2 (binary) or another; masked, as those of browsers are */
static void say_as(const client *who, int kind, const void *bytes, size_t size)
{
    unsigned char head[14] = {(unsigned char)(0x80 | kind)}, *masked = malloc(size + 1);
    size_t length = 2;
    assert_non_null(masked);
    if (size < 126) {
        head[1] = (unsigned char)(0x80 | size);
    } else {
        head[1] = 0x80 | 127;
        for (int i = 0; i < 8; i++)
            head[length++] = (unsigned char)((uint64_t)size >> (56 - 8 * i));
    }
    const unsigned char mask[4] = {1, 2, 3, 4};
    memcpy(head + length, mask, 4);
    write_all(who->socket, head, length + 4);
    for (size_t i = 0; i < size; i++)
        masked[i] = (unsigned char)(((const unsigned char *)bytes)[i] ^ mask[i % 4]);
    write_all(who->socket, masked, size);
    free(masked);
}

static void say(const client *who, const char *line)
{
    say_as(who, 1, line, strlen(line));
}

/* the next message; false when the server has closed */
static bool hear(client *who)
{
    unsigned char head[2], more[8];
    if (!read_all(who->socket, head, 2))
        return false;
    size_t size = head[1] & 0x7f;
    size_t bytes = size == 126 ? 2 : size == 127 ? 8 : 0;
    if (!read_all(who->socket, more, bytes))
        return false;
    for (size_t i = 0; i < bytes; i++)
        size = i == 0 ? more[0] : size << 8 | more[i];
    who->message = realloc(who->message, size + 1);
    who->size = size;
    who->is_text = (head[0] & 0xf) == 1;
    who->message[size] = '\0';
    return read_all(who->socket, who->message, size) && (head[0] & 0xf) != 8;
}

/* the head of a binary message, or the text of the other kind */
static char *head_of(const client *who)
{
    if (who->is_text)
        return (char *)who->message;
    uint32_t length = (uint32_t)who->message[0] | (uint32_t)who->message[1] << 8 | (uint32_t)who->message[2] << 16;
    assert_true(length + 4 <= who->size);
    return (char *)who->message + 4;
}

/* waits for a message of a type that holds some words; draws every picture at once */
static char *await(client *who, const char *type, const char *words)
{
    char wanted[40];
    snprintf(wanted, sizeof wanted, "\"type\":\"%s\"", type);
    for (int i = 0; i < 5000; i++) {
        assert_true(hear(who));
        char *head = head_of(who);
        bool fits = strstr(head, wanted) != NULL && strstr(head, words) != NULL;
        if (strstr(head, "\"type\":\"frame\"") != NULL)
            say(who, "received");
        if (fits)
            return head;
    }
    fail_msg("no %s with %s", type, words);
    return NULL;
}

static void copy_value(const char *head, const char *key, char *value, size_t size)
{
    const char *at = strstr(head, key);
    assert_non_null(at);
    snprintf(value, size, "%.*s", (int)strcspn(at + strlen(key), ",}\""), at + strlen(key));
}

/* ---- tests ---- */

static void test_who_may_come(void **unused)
{
    (void)unused;
    char wrong[64], headers[300], upgrade[700];
    snprintf(wrong, sizeof wrong, "%s", token);
    wrong[0] = wrong[0] == 'a' ? 'b' : 'a';
    assert_true(strncmp(address, "http://127.0.0.1:", 17) == 0 && strlen(token) == 32);
    const struct {
        const char *path, *key, *host, *origin;
        int status;
    } cases[] = {
        {"/?token=", token, own_host(), "", 303},
        {"/?token=", wrong, own_host(), "", 403},
        {"/?token=", "", own_host(), "", 403},
        {"/", "", own_host(), "", 403},
        {"/nothing?token=", token, own_host(), "", 404},
        {"/nothing?token=", wrong, own_host(), "", 403},
        {"/?token=", token, "Host: evil.example\r\n", "", 403},
        {"/?token=", token, "", "", 403},
        {"/?token=", token, own_host(), "Origin: http://evil.example\r\n", 403},
        {"/?token=", token, own_host(), "Origin: null\r\n", 403},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        snprintf(headers, sizeof headers, "%s%s", cases[i].host, cases[i].origin);
        int status = ask(cases[i].path, cases[i].key, headers);
        if (status != cases[i].status)
            print_error("case %d: %d\n", (int)i, status);
        assert_int_equal(status, cases[i].status);
        /* the channel as the page */
        snprintf(upgrade, sizeof upgrade, "%s" UPGRADE, headers);
        status = ask(cases[i].path, cases[i].key, upgrade);
        int expected = cases[i].status == 303 ? 101 : cases[i].status;
        if (status != expected)
            print_error("channel, case %d: %d\n", (int)i, status);
        assert_int_equal(status, expected);
    }
    snprintf(headers, sizeof headers, "Host: localhost:%d\r\nOrigin: http://localhost:%d\r\n", atomic_load(&port),
             atomic_load(&port));
    assert_int_equal(ask("/?token=", token, headers), 303);
}

/* the answer to a request, whole, with a zero behind it */
static const char *fetch(const char *path, const char *headers, char *answer, size_t room)
{
    char out[1200];
    size_t length = 0;
    int line = call();
    snprintf(out, sizeof out, "GET %s HTTP/1.1\r\n%s\r\n", path, headers);
    write_all(line, out, strlen(out));
    while (length < room - 1 && read_all(line, answer + length, 1))
        length++;
    answer[length] = '\0';
    close(line);
    return answer;
}

/* Whatever is answered stays in no cache, tells no other page the address, is taken for nothing else and in no frame.
 */
static void test_headers(void **unused)
{
    (void)unused;
    static char answer[1 << 17];
    static const char *const headers[] = {"cache-control: no-store", "referrer-policy: no-referrer",
                                          "x-content-type-options: nosniff", "x-frame-options: DENY",
                                          "connection: close"};
    static const struct {
        const char *path, *status;
    } cases[] = {{"/?token=", "303"}, {"/none?token=", "404"}, {"/?token=0", "403"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char path[100], line[64];
        snprintf(path, sizeof path, "%s%s", cases[i].path, token);
        fetch(path, own_host(), answer, sizeof answer);
        assert_memory_equal(answer + strlen("HTTP/1.1 "), cases[i].status, 3);
        for (size_t h = 0; h < sizeof headers / sizeof *headers; h++) {
            snprintf(line, sizeof line, "\r\n%s\r\n", headers[h]);
            if (strstr(answer, line) == NULL)
                fail_msg("%s: no '%s'", cases[i].status, headers[h]);
        }
    }
}

/* the token goes from the address into a cookie, which lets in alone; the page may run its own scripts only */
static void test_cookie(void **unused)
{
    (void)unused;
    static char answer[1 << 17];
    char path[100], headers[400], cookie[120];
    snprintf(path, sizeof path, "/?token=%s", token);
    fetch(path, own_host(), answer, sizeof answer);
    assert_non_null(strstr(answer, "location: /\r\n"));
    const char *set = strstr(answer, "set-cookie: ");
    assert_non_null(set);
    assert_non_null(strstr(set, "; HttpOnly; SameSite=Lax; Path=/\r\n"));
    snprintf(cookie, sizeof cookie, "%.*s", (int)strcspn(set + 12, ";"), set + 12);
    snprintf(headers, sizeof headers, "%sCookie: other=1; %s; more=2\r\n", own_host(), cookie);
    assert_int_equal(ask("/", "", headers), 200);
    fetch("/", headers, answer, sizeof answer);
    assert_non_null(strstr(answer, "\r\ncontent-security-policy: default-src 'none'; "));
    assert_non_null(strstr(answer, "script-src 'sha256-xY6QKfH9PRsQnLz56nj6MBwiK5oHg+im1Jkpdp1x/Ck='; connect-src"));
    assert_non_null(strstr(answer, "frame-ancestors 'none'"));
    assert_non_null(strstr(answer, "<script>let a = 1;</script>"));
    /* an address with a wrong token does not fall back to the cookie */
    assert_int_equal(ask("/?token=0", "", headers), 403);
    cookie[strlen(cookie) - 1] = (char)(cookie[strlen(cookie) - 1] ^ 1);
    snprintf(headers, sizeof headers, "%sCookie: %s\r\n", own_host(), cookie);
    assert_int_equal(ask("/", "", headers), 403);
    /* what is no request */
    assert_int_equal(ask("/", "", "Host: a\r\nHost: b\r\n"), 400);
    assert_int_equal(ask("/", "", " folded: x\r\n"), 400);
    memset(answer, 'a', PEL_HEAD_LIMIT);
    answer[PEL_HEAD_LIMIT] = '\0';
    int line = call();
    write_all(line, answer, PEL_HEAD_LIMIT);
    char reply[16] = {0};
    assert_true(read_all(line, reply, 12));
    assert_string_equal(reply, "HTTP/1.1 400");
    close(line);
}

/* sockets that say nothing, or half a request, do not keep a page out, however many they are */
static void test_idle_sockets(void **unused)
{
    (void)unused;
    enum { IDLE = 300 };
    int idle[IDLE];
    for (int i = 0; i < IDLE; i++) {
        idle[i] = call();
        if (i % 2 == 0)
            write_all(idle[i], "GET / HT", 8);
    }
    client who = visit();
    say(&who, "echo 91");
    (void)await(&who, "frame", "\"echo\":91");
    leave(&who);
    /* and half a request ends by itself */
    int line = call();
    const double start = pel_seconds();
    char byte;
    write_all(line, "GET / HT", 8);
    assert_false(read_all(line, &byte, 1));
    assert_true(pel_seconds() - start < 15);
    close(line);
    for (int i = 0; i < IDLE; i++)
        close(idle[i]);
}

/* where no descriptor is left, those that say nothing leave at once, and a page comes in */
static void test_descriptors(void **unused)
{
    (void)unused;
    enum { IDLE = 40, LEFT = 6 };
    int idle[IDLE], page;
    struct rlimit before, few;
    for (int i = 0; i < IDLE; i++)
        idle[i] = socket(AF_INET, SOCK_STREAM, 0);
    page = socket(AF_INET, SOCK_STREAM, 0);
    int most = page;
    for (int i = 0; i < IDLE; i++)
        most = idle[i] > most ? idle[i] : most;
    assert_int_equal(getrlimit(RLIMIT_NOFILE, &before), 0);
    few = before;
    few.rlim_cur = (rlim_t)(most + 1 + LEFT);
    assert_int_equal(setrlimit(RLIMIT_NOFILE, &few), 0);
    const double start = pel_seconds();
    for (int i = 0; i < IDLE; i++)
        reach(idle[i]);
    reach(page);
    int status = enter(page);
    setrlimit(RLIMIT_NOFILE, &before);
    assert_int_equal(status, 101);
    /* not after they have been silent for 5 s */
    assert_true(pel_seconds() - start < 3);
    for (int i = 0; i < IDLE; i++)
        close(idle[i]);
    close(page);
}

/* the 33rd page is told to come later; once one has left there is room */
static void test_most_pages(void **unused)
{
    (void)unused;
    enum { PAGES = 32 };
    client pages[PAGES];
    int status = 0;
    for (int i = 0; i < PAGES; i++)
        pages[i] = visit();
    int line = call();
    assert_int_equal(enter(line), 503);
    close(line);
    for (int i = 0; i < PAGES; i++)
        leave(&pages[i]);
    for (int tries = 0; tries < 100 && status != 101; tries++) {
        line = call();
        status = enter(line);
        close(line);
    }
    assert_int_equal(status, 101);
}

static void test_first_messages(void **unused)
{
    (void)unused;
    client who = visit();
    /* hello, parameters and surface before the first picture, whatever their order */
    bool has_surface = false, has_hello = false;
    for (;;) {
        assert_true(hear(&who));
        const char *head = head_of(&who);
        has_hello |= strstr(head, "\"type\":\"hello\"") != NULL && strstr(head, "\"title\":\"a ball\"") != NULL;
        has_surface |= strstr(head, "\"type\":\"surface\"") != NULL && strstr(head, "\"triangles\":180") != NULL;
        if (strstr(head, "\"type\":\"frame\"") == NULL)
            continue;
        assert_true(has_hello && has_surface);
        /* head, 92 x 3 floats, 92 bytes */
        uint32_t length = (uint32_t)who.message[0] | (uint32_t)who.message[1] << 8;
        assert_int_equal(who.size, 4 + length + 92 * 12 + 92);
        break;
    }
    leave(&who);
}

static void test_drag_undo_reset(void **unused)
{
    (void)unused;
    char start_hash[40], hash[40], value[40];
    client who = visit();
    say(&who, "reset");
    say(&who, "echo 1");
    copy_value(await(&who, "frame", "\"echo\":1"), "\"hash\":\"", start_hash, sizeof start_hash);
    say(&who, "mark");
    say(&who, "grab 0 -5 0 0 1 0 20 0.3");
    say(&who, "move 0 -1.5 0");
    for (int i = 0; i < 10; i++)
        say(&who, "step");
    say(&who, "echo 2");
    char *head = await(&who, "frame", "\"echo\":2");
    copy_value(head, "\"hash\":\"", hash, sizeof hash);
    assert_string_not_equal(hash, start_hash);
    assert_non_null(strstr(head, "\"kind\":\"grab\""));
    copy_value(head, "\"step\":", value, sizeof value);
    assert_string_equal(value, "10");
    say(&who, "set bodies.ball.springs.stiffness 4.5");
    (void)await(&who, "parameters", "\"value\":[4.5]");
    /* refused in place, and the simulation continues */
    say(&who, "set bodies.ball.springs.stiffness -4.5");
    (void)await(&who, "notice", "stiffness");
    say(&who, "save");
    head = await(&who, "scene", "0 grab 0 -5 0 0 1 0 20 0.3");
    assert_non_null(strstr(head, "10 set bodies.ball.springs.stiffness 4.5"));
    say(&who, "undo");
    say(&who, "echo 3");
    copy_value(await(&who, "frame", "\"echo\":3"), "\"hash\":\"", hash, sizeof hash);
    assert_string_equal(hash, start_hash);
    /* the same steps from the start repeat what was done */
    for (int round = 0; round < 2; round++) {
        if (round == 0)
            say(&who, "grab 0 -5 0 0 1 0 20 0.3");
        if (round == 0)
            say(&who, "move 0 -1.5 0");
        for (int i = 0; i < 5; i++)
            say(&who, "step");
        say(&who, round == 0 ? "echo 4" : "echo 5");
        copy_value(await(&who, "frame", round == 0 ? "\"echo\":4" : "\"echo\":5"), "\"hash\":\"", value, sizeof value);
        if (round == 0)
            memcpy(hash, value, sizeof hash);
        say(&who, "replay");
        (void)await(&who, "hello", "a ball");
    }
    assert_string_equal(value, hash);
    assert_string_not_equal(value, start_hash);
    say(&who, "field displacement");
    (void)await(&who, "frame", "\"field\":\"displacement\"");
    say(&who, "field nonsense");
    (void)await(&who, "notice", "nonsense");
    say(&who, "open nonsense: [");
    (void)await(&who, "notice", "was not opened");
    say(&who, "open version: 1\ntitle: other\nbodies: [{ mesh: { shape: geodesic-sphere } }]\nduration: 1\n");
    (void)await(&who, "hello", "\"title\":\"other\"");
    char again[sizeof text + 8];
    snprintf(again, sizeof again, "open %s", text);
    say(&who, again);
    (void)await(&who, "hello", "a ball");
    leave(&who);
}

/* pages that say nonsense, that leave in the middle of a message, that never draw */
static void test_rude_pages(void **unused)
{
    (void)unused;
    uint32_t seed = 1;
    client who = visit(), sleeper = visit();
    say(&who, "play");
    for (int i = 0; i < 1000; i++) {
        char line[120];
        size_t size = (seed = seed * 1664525u + 1013904223u) % sizeof line;
        for (size_t c = 0; c < size; c++)
            line[c] = (char)(1 + ((seed = seed * 1664525u + 1013904223u) >> 24) % 126);
        static const char *const words[] = {"set ", "grab ", "press ", "move ", "pin ", "open ", "field ", "echo "};
        if (i % 2 == 0 && size > 10)
            memcpy(line, words[i / 2 % 8], strlen(words[i / 2 % 8]));
        say_as(&who, 1, line, size);
    }
    say(&who, "reset");
    say(&who, "echo 77");
    (void)await(&who, "frame", "\"echo\":77");
    /* refused: binary messages; half a message */
    say_as(&sleeper, 2, "play", 4);
    while (hear(&sleeper))
        continue;
    leave(&sleeper);
    sleeper = visit();
    const unsigned char half[] = {0x81, 0x80 | 50, 1, 2, 3, 4, 'a'};
    write_all(sleeper.socket, half, sizeof half);
    leave(&sleeper);
    /* coming back */
    leave(&who);
    who = visit();
    say(&who, "echo 78");
    (void)await(&who, "frame", "\"echo\":78");
    leave(&who);
}

/* frames that RFC 6455 does not allow end the channel: without a mask, reserved bits, other kinds, a long ping, too
 * much */
static void test_bad_frames(void **unused)
{
    (void)unused;
    static const struct {
        unsigned char bytes[14];
        size_t size;
    } cases[] = {
        {{0x81, 4, 'p', 'l', 'a', 'y'}, 6},
        {{0xc1, 0x80, 1, 2, 3, 4}, 6},
        {{0x83, 0x80, 1, 2, 3, 4}, 6},
        {{0x80, 0x80, 1, 2, 3, 4}, 6},
        {{0x89, 0x80 | 126, 0, 126, 1, 2, 3, 4}, 8},
        {{0x09, 0x80, 1, 2, 3, 4}, 6},
        /* 8 MiB and a byte; a length that wraps around */
        {{0x81, 0x80 | 127, 0, 0, 0, 0, 0, 0x80, 0, 1, 1, 2, 3, 4}, 14},
        {{0x81, 0x80 | 127, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 1, 2, 3, 4}, 14},
        /* a zero byte in a text */
        {{0x81, 0x80 | 1, 1, 2, 3, 4, 1}, 7},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        client who = visit();
        write_all(who.socket, cases[i].bytes, cases[i].size);
        int heard = 0;
        while (heard < 50 && hear(&who))
            heard++;
        if (heard == 50)
            print_error("case %d\n", (int)i);
        assert_true(heard < 50);
        leave(&who);
    }
    /* allowed: a message in pieces with a ping between them */
    static const unsigned char pieces[] = {0x01, 0x83, 0,   0,    0,    0, 'e', 'c', 'h', 0x89, 0x82, 0,   0,  0,
                                           0,    'h',  'i', 0x80, 0x84, 0, 0,   0,   0,   'o',  ' ',  '9', '5'};
    client who = visit();
    write_all(who.socket, pieces, sizeof pieces);
    bool has_pong = false, has_echo = false;
    while (!has_pong || !has_echo) {
        assert_true(hear(&who));
        bool is_pong = who.size == 2 && memcmp(who.message, "hi", 2) == 0;
        has_pong |= is_pong;
        if (is_pong || who.is_text)
            continue;
        has_echo |= strstr(head_of(&who), "\"echo\":95") != NULL;
        say(&who, "received");
    }
    leave(&who);
}

/* What takes minutes is stopped by the next line that waits for it, and by the end; the scene stays as it was. */
static void test_long_stages(void **unused)
{
    (void)unused;
    static const char huge[] =
        "open version: 1\ntitle: huge\nbodies: [{ mesh: { shape: geodesic-sphere, frequency: 300 }, "
        "mass: { density: 1000 }, membrane: { preset: rubber, thickness: 0.001 } }]\n"
        "solver: { method: static }\ncontact: { self: true }\nduration: 1\n";
    static const char many[] =
        "open version: 1\ntitle: many\nbodies: [{ mesh: { shape: geodesic-sphere, frequency: 20 }, "
        "mass: { density: 1000 }, membrane: { preset: rubber, thickness: 0.001 } }]\n"
        "solver: { method: xpbd, substeps: 1000000 }\nduration: 1\n";
    client who = visit();
    say(&who, huge);
    say(&who, "echo 81");
    (void)await(&who, "notice", "opening the scene takes long");
    say(&who, "pause");
    (void)await(&who, "notice", "opening the scene was stopped");
    (void)await(&who, "frame", "\"echo\":81");
    say(&who, many);
    (void)await(&who, "hello", "many");
    /* the first step, without a mark before it */
    say(&who, "step");
    nanosleep(&(struct timespec){.tv_nsec = 100000000}, NULL);
    say(&who, "pause");
    say(&who, "echo 82");
    (void)await(&who, "notice", "the step was stopped");
    assert_non_null(strstr(await(&who, "frame", "\"echo\":82"), "\"step\":0"));
    /* the end does not wait for a step either */
    say(&who, "step");
    nanosleep(&(struct timespec){.tv_nsec = 300000000}, NULL);
    const double start = pel_seconds();
    stop_server();
    assert_true(pel_seconds() - start < 5);
    leave(&who);
    assert_true(start_server());
}

/* a server of all addresses answers at each of them, and to no other name */
static void test_all_addresses(void **unused)
{
    (void)unused;
    char headers[200];
    stop_server();
    listened = "0.0.0.0";
    assert_true(start_server());
    assert_true(strncmp(address, "http://0.0.0.0:", 15) == 0);
    assert_int_equal(ask("/?token=", token, own_host()), 303);
    snprintf(headers, sizeof headers, "%sOrigin: http://127.0.0.1:%d\r\n", own_host(), atomic_load(&port));
    assert_int_equal(ask("/?token=", token, headers), 303);
    assert_int_equal(ask("/?token=", "0", own_host()), 403);
    const char *const wrong[] = {"127.0.0.2:", "evil.example:", "127.0.0.1:1"};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        char name[60];
        snprintf(name, sizeof name, "%s%d", wrong[i], atomic_load(&port));
        snprintf(headers, sizeof headers, "Host: %s\r\n", name);
        assert_int_equal(ask("/?token=", token, headers), 403);
        snprintf(headers, sizeof headers, "%sOrigin: http://%s\r\n", own_host(), name);
        assert_int_equal(ask("/?token=", token, headers), 403);
    }
}

static void test_port_is_taken(void **unused)
{
    (void)unused;
    pel_server_def def = pel_server_def_default();
    pel_error error;
    def.scene = scene;
    def.page = PEL_SOURCE_DIR "/tests/live/page.html";
    def.port = atomic_load(&port);
    assert_int_equal(pel_serve(&def, &error), PEL_BAD_FILE);
    assert_non_null(strstr(error.what, "port"));
    assert_true(error.remedy[0] != '\0');
    char place[40];
    snprintf(place, sizeof place, "127.0.0.1:%d", def.port);
    assert_string_equal(error.file, place);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_who_may_come),    cmocka_unit_test(test_first_messages),
        cmocka_unit_test(test_drag_undo_reset), cmocka_unit_test(test_rude_pages),
        cmocka_unit_test(test_headers),         cmocka_unit_test(test_cookie),
        cmocka_unit_test(test_idle_sockets),    cmocka_unit_test(test_bad_frames),
        cmocka_unit_test(test_long_stages),     cmocka_unit_test(test_port_is_taken),
        cmocka_unit_test(test_all_addresses),   cmocka_unit_test(test_descriptors),
        cmocka_unit_test(test_most_pages),
    };
    return cmocka_run_group_tests(tests, start, stop);
}
