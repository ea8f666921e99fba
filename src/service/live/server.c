/* HTTP and WebSocket: the page, and one channel to it. All of this runs in the caller's thread: one loop over all
   sockets, none of which is ever waited for. */
#define _XOPEN_SOURCE 700
#include "pellicle/server.h"

#include "base/memory.h"
#include "base/status.h"
#include "io/file.h"
#include "live/channel.h"
#include "live/message.h"
#include "live/player.h"
#include "live/request.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <unistd.h>

enum { SERVER_COOKIE = 0x73727621, TOKEN_BYTES = 16, BEAT_MILLISECONDS = 100, READ_SIZE = 65536, ANSWER_SIZE = 2400 };
/* sockets that have not asked for anything yet, those that get an answer, and pages */
enum { MOST_GUESTS = 256, MOST_PAGES = 32, MOST_VISITS = MOST_GUESTS + MOST_PAGES };
/* s until a request has to be whole, and until its answer has to be taken */
#define GUEST_SECONDS 5.0
#define ANSWER_SECONDS 60.0
/* s that a stage may take before the pages hear that their lines wait */
#define BUSY_SECONDS 0.5

typedef enum visit_state { VISIT_FREE, VISIT_ASKS, VISIT_ANSWERED, VISIT_PAGE } visit_state;

/* one socket */
typedef struct visit {
    visit_state state;
    int socket;
    double since; /* clock of its state */
    char *head;   /* (PEL_HEAD_LIMIT) of a request */
    size_t head_size;
    unsigned char *out; /* (out_room) bytes to send; out_done of out_size have gone */
    size_t out_room, out_size, out_done;
    bool ends; /* after these bytes */
    pel_mail_reader reader;
    pel_channel channel;
    unsigned char pong[PEL_CONTROL_LIMIT];
    size_t pong_size;
    bool has_pong;
} visit;

typedef struct server {
    const pel_server_def *def;
    pel_mailbox box;
    int listener, ring[2]; /* ring: a byte that wakes the loop */
    bool was_seen;         /* a page has come */
    char *page;
    size_t page_size;
    char *policy; /* Content-Security-Policy but for the address of the channel */
    char token[2 * TOKEN_BYTES + 1], cookie[40];
    char host[PEL_HOST_SIZE];  /* 127.0.0.1:PORT */
    char local[PEL_HOST_SIZE]; /* localhost:PORT */
    visit visits[MOST_VISITS];
} server;

pel_server_def pel_server_def_default(void)
{
    return (pel_server_def){.cookie = SERVER_COOKIE};
}

/* ---- who may come ---- */

static bool is_same(const char *a, const char *b)
{
    unsigned different = 0;
    size_t length = strlen(b);
    if (strlen(a) != length)
        return false;
    for (size_t i = 0; i < length; i++)
        different |= (unsigned)(unsigned char)a[i] ^ (unsigned)(unsigned char)b[i];
    return different == 0;
}

/* the address that was printed, localhost, or the address of this machine that the page has reached: the server may
   listen at several (0.0.0.0) */
static bool is_host(const server *s, const visit *v, const char *name)
{
    char reached[PEL_HOST_SIZE], digits[INET_ADDRSTRLEN];
    struct sockaddr_in at = {0};
    socklen_t size = sizeof at;
    if (strcmp(name, s->host) == 0 || strcmp(name, s->local) == 0)
        return true;
    if (getsockname(v->socket, (struct sockaddr *)&at, &size) != 0 || at.sin_family != AF_INET ||
        inet_ntop(AF_INET, &at.sin_addr, digits, sizeof digits) == NULL)
        return false;
    snprintf(reached, sizeof reached, "%s:%d", digits, (int)ntohs(at.sin_port));
    return strcmp(name, reached) == 0;
}

/* the token, a Host of this server, and no page of another origin */
static bool may_come(const server *s, const visit *v, const pel_request *request)
{
    if (!is_same(request->token, s->token) || !is_host(s, v, request->host))
        return false;
    return request->origin[0] == '\0' ||
           (strncmp(request->origin, "http://", 7) == 0 && is_host(s, v, request->origin + 7));
}

/* ---- sockets ---- */

/* never waited for, and not for child processes */
static bool set_up(int descriptor)
{
    return descriptor >= 0 && fcntl(descriptor, F_SETFL, O_NONBLOCK) == 0 &&
           fcntl(descriptor, F_SETFD, FD_CLOEXEC) == 0;
}

static void end_visit(visit *v)
{
    close(v->socket);
    pel_free(v->head);
    pel_free(v->out);
    pel_channel_free(&v->channel);
    *v = (visit){.socket = -1};
}

/* sends without blocking */
static void flush(visit *v)
{
    while (v->out_done < v->out_size) {
        ssize_t count = send(v->socket, v->out + v->out_done, v->out_size - v->out_done, MSG_NOSIGNAL | MSG_DONTWAIT);
        if (count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR))
            return;
        if (count <= 0) {
            end_visit(v);
            return;
        }
        v->out_done += (size_t)count;
    }
    if (v->ends)
        end_visit(v);
}

static bool is_idle(const visit *v)
{
    return v->out_done == v->out_size;
}

/* puts bytes behind those that wait; ends the visit when out of memory */
static void put(visit *v, const void *bytes, size_t size)
{
    void *out = v->out;
    if (is_idle(v))
        v->out_size = v->out_done = 0;
    if (!pel_reserve(&out, &v->out_room, v->out_size + size, 1)) {
        end_visit(v);
        return;
    }
    v->out = out;
    if (size > 0)
        memcpy(v->out + v->out_size, bytes, size);
    v->out_size += size;
}

/* ---- the page ---- */

static const char safe_headers[] = "cache-control: no-store\r\nreferrer-policy: no-referrer\r\n"
                                   "x-content-type-options: nosniff\r\nx-frame-options: DENY\r\nconnection: close\r\n";

/* more: further headers, each with its end; body nullable */
static void answer(visit *v, const char *status, const char *more, const char *body, size_t size)
{
    char head[ANSWER_SIZE];
    int length =
        snprintf(head, sizeof head, "HTTP/1.1 %s\r\n%s%scontent-length: %zu\r\n\r\n", status, safe_headers, more, size);
    v->state = VISIT_ANSWERED;
    v->since = pel_seconds();
    v->ends = true;
    put(v, head, (size_t)length < sizeof head ? (size_t)length : sizeof head - 1);
    if (v->state == VISIT_ANSWERED)
        put(v, body, size);
    if (v->state == VISIT_ANSWERED)
        flush(v);
}

/* the token goes from the address into a cookie of this server alone */
static void send_home(const server *s, visit *v)
{
    char more[300];
    snprintf(more, sizeof more, "location: /\r\nset-cookie: %s=%s; HttpOnly; SameSite=Lax; Path=/\r\n", s->cookie,
             s->token);
    answer(v, "303 See Other", more, NULL, 0);
}

static void send_page(const server *s, visit *v, const pel_request *request)
{
    char more[ANSWER_SIZE - 400];
    snprintf(more, sizeof more,
             "content-type: text/html; charset=utf-8\r\n"
             "content-security-policy: %s; connect-src 'self' ws://%s\r\n",
             s->policy, request->host);
    answer(v, "200 OK", more, s->page, s->page_size);
}

static void welcome(server *s, visit *v, const pel_request *request)
{
    char head[400], accept[PEL_DIGEST_TEXT];
    pel_channel_accept(request->key, accept);
    int length = snprintf(head, sizeof head,
                          "HTTP/1.1 101 Switching Protocols\r\nupgrade: websocket\r\nconnection: Upgrade\r\n"
                          "sec-websocket-accept: %s\r\n%s\r\n",
                          accept, request->has_protocol ? "sec-websocket-protocol: pellicle\r\n" : "");
    v->state = VISIT_PAGE;
    v->since = pel_seconds();
    pel_mailbox_welcome(&s->box, &v->reader);
    /* nobody misses the beginning */
    if (!s->was_seen && !s->def->paused)
        pel_mailbox_line(&s->box, pel_copy_string("play"), false);
    s->was_seen = true;
    put(v, head, (size_t)length);
}

static int32_t count_visits(const server *s, visit_state state)
{
    int32_t count = 0;
    for (int32_t i = 0; i < MOST_VISITS; i++)
        count += s->visits[i].state == state;
    return count;
}

static void answer_request(server *s, visit *v, const pel_request *request)
{
    bool is_root = strcmp(request->path, "/") == 0;
    if (!may_come(s, v, request))
        answer(v, "403 Forbidden", "", NULL, 0);
    else if (!request->is_get)
        answer(v, "405 Method Not Allowed", "allow: GET\r\n", NULL, 0);
    else if (!is_root)
        answer(v, "404 Not Found", "", NULL, 0);
    else if (request->upgrades && count_visits(s, VISIT_PAGE) == MOST_PAGES)
        answer(v, "503 Service Unavailable", "", NULL, 0);
    else if (request->upgrades)
        welcome(s, v, request);
    else if (request->has_query_token)
        send_home(s, v);
    else
        send_page(s, v, request);
}

/* ---- messages to a page ---- */

/* the next message that is due, or the answer to a ping */
static void send_post(server *s, visit *v)
{
    size_t size = 0;
    if (!is_idle(v))
        return;
    v->out_size = v->out_done = 0;
    if (v->has_pong) {
        unsigned char head[PEL_CHANNEL_OUT],
            *begin = pel_channel_head(head + sizeof head, PEL_FRAME_PONG, v->pong_size);
        v->has_pong = false;
        put(v, begin, (size_t)(head + sizeof head - begin));
        if (v->state == VISIT_PAGE)
            put(v, v->pong, v->pong_size);
        return;
    }
    int kind = pel_mailbox_take(&s->box, &v->reader, PEL_CHANNEL_OUT, &v->out, &v->out_room, &size);
    if (kind < 0)
        end_visit(v);
    if (kind < 0 || kind == PEL_POST_COUNT)
        return;
    bool binary = kind == PEL_POST_FRAME || kind == PEL_POST_SURFACE;
    unsigned char *begin = pel_channel_head(v->out + PEL_CHANNEL_OUT, binary ? PEL_FRAME_BINARY : PEL_FRAME_TEXT, size);
    v->out_done = (size_t)(begin - v->out);
    v->out_size = PEL_CHANNEL_OUT + size;
}

static void send_posts(server *s, visit *v)
{
    do {
        send_post(s, v);
        if (v->state == VISIT_PAGE && !is_idle(v))
            flush(v);
        else
            break;
    } while (v->state == VISIT_PAGE && is_idle(v));
}

/* ---- messages from a page ---- */

/* "received" is between the page and the server; all other lines are for the simulation */
static void take_line(server *s, visit *v)
{
    char *line = v->channel.text;
    if (strcmp(line, "received") == 0) {
        pel_mailbox_received(&v->reader);
        return;
    }
    pel_mailbox_line(&s->box, line, pel_player_interrupts(line));
    v->channel.text = NULL;
    v->channel.room = 0;
}

/* false when the channel ends */
static bool take_frames(server *s, visit *v, const unsigned char *bytes, size_t size)
{
    for (size_t at = 0, used = 0;; at += used) {
        switch (pel_channel_take(&v->channel, bytes + at, size - at, &used)) {
        case PEL_CHANNEL_NOTHING:
            return true;
        case PEL_CHANNEL_MESSAGE:
            take_line(s, v);
            break;
        case PEL_CHANNEL_PINGED:
            v->has_pong = true;
            v->pong_size = v->channel.control_size;
            memcpy(v->pong, v->channel.control, v->pong_size);
            break;
        case PEL_CHANNEL_CLOSED:
        case PEL_CHANNEL_REFUSED:
            return false;
        }
    }
}

static void hear_page(server *s, visit *v)
{
    static const unsigned char farewell[] = {0x80 | PEL_FRAME_CLOSE, 0};
    unsigned char bytes[READ_SIZE];
    ssize_t count = recv(v->socket, bytes, sizeof bytes, MSG_DONTWAIT);
    if (count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR))
        return;
    if (count > 0 && take_frames(s, v, bytes, (size_t)count))
        return;
    /* polite, if the socket takes it */
    if (count > 0 && is_idle(v))
        (void)!send(v->socket, farewell, sizeof farewell, MSG_NOSIGNAL | MSG_DONTWAIT);
    end_visit(v);
}

static void hear_request(server *s, visit *v)
{
    pel_request request;
    ssize_t count = recv(v->socket, v->head + v->head_size, PEL_HEAD_LIMIT - v->head_size, MSG_DONTWAIT);
    if (count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR))
        return;
    if (count <= 0) {
        end_visit(v);
        return;
    }
    v->head_size += (size_t)count;
    pel_request_end end = pel_request_parse(v->head, v->head_size, s->cookie, &request);
    if (end == PEL_REQUEST_PART)
        return;
    if (end == PEL_REQUEST_BAD) {
        answer(v, "400 Bad Request", "", NULL, 0);
        return;
    }
    answer_request(s, v, &request);
    /* frames that came with the request */
    if (v->state == VISIT_PAGE && v->head_size > request.size &&
        !take_frames(s, v, (unsigned char *)v->head + request.size, v->head_size - request.size))
        end_visit(v);
}

/* ---- the loop ---- */

/* the visit of a state that began first, null = none */
static visit *find_oldest(server *s, visit_state state)
{
    visit *oldest = NULL;
    for (int32_t i = 0; i < MOST_VISITS; i++)
        if (s->visits[i].state == state && (oldest == NULL || s->visits[i].since < oldest->since))
            oldest = &s->visits[i];
    return oldest;
}

/* A guest who says nothing leaves when another one comes who finds no place. */
static bool make_place(server *s)
{
    visit *oldest = find_oldest(s, VISIT_ASKS);
    if (oldest == NULL)
        oldest = find_oldest(s, VISIT_ANSWERED);
    if (oldest != NULL)
        end_visit(oldest);
    return oldest != NULL;
}

static void admit(server *s)
{
    int32_t guests = MOST_VISITS - count_visits(s, VISIT_FREE) - count_visits(s, VISIT_PAGE);
    int made = accept(s->listener, NULL, NULL);
    if (made < 0 && (errno == EMFILE || errno == ENFILE) && make_place(s))
        made = accept(s->listener, NULL, NULL);
    if (made < 0)
        return;
    (void)set_up(made);
    if (guests >= MOST_GUESTS)
        make_place(s);
    visit *v = s->visits;
    while (v->state != VISIT_FREE)
        v++;
    *v = (visit){.state = VISIT_ASKS, .socket = made, .since = pel_seconds()};
    v->head = pel_allocate(PEL_HEAD_LIMIT, 1);
    if (v->head == NULL)
        end_visit(v);
}

static void end_late_visits(server *s, double now)
{
    for (int32_t i = 0; i < MOST_VISITS; i++) {
        visit *v = &s->visits[i];
        if ((v->state == VISIT_ASKS && now - v->since > GUEST_SECONDS) ||
            (v->state == VISIT_ANSWERED && now - v->since > ANSWER_SECONDS))
            end_visit(v);
    }
}

/* tells the pages once that a stage takes long while their lines wait */
static void tell_busy(server *s, double now)
{
    const char *stage = pel_mailbox_find_busy(&s->box, now - BUSY_SECONDS);
    char text[200];
    size_t size = 0;
    if (stage == NULL)
        return;
    snprintf(text, sizeof text, "%s takes long, and commands wait for it. Pause, Undo, Reset or Open stops it", stage);
    unsigned char *bytes = pel_message_notice("note", text, &size);
    pel_mailbox_post(&s->box, PEL_POST_NOTICE, bytes, size);
}

static void serve_visit(server *s, visit *v, short events)
{
    if (events & (POLLIN | POLLHUP | POLLERR)) {
        if (v->state == VISIT_ASKS)
            hear_request(s, v);
        else if (v->state == VISIT_PAGE)
            hear_page(s, v);
        else if (events & (POLLHUP | POLLERR))
            end_visit(v);
    }
    if (v->state == VISIT_ANSWERED)
        flush(v);
    if (v->state == VISIT_PAGE && (events & POLLOUT) && !is_idle(v))
        flush(v);
}

/* one turn: waits for a beat at most */
static void serve_turn(server *s)
{
    struct pollfd polled[MOST_VISITS + 2] = {{.fd = s->listener, .events = POLLIN},
                                             {.fd = s->ring[0], .events = POLLIN}};
    visit *of[MOST_VISITS];
    nfds_t count = 0;
    char bytes[64];
    for (int32_t i = 0; i < MOST_VISITS; i++) {
        visit *v = &s->visits[i];
        if (v->state == VISIT_FREE)
            continue;
        short events = (short)((v->state != VISIT_ANSWERED ? POLLIN : 0) | (is_idle(v) ? 0 : POLLOUT));
        of[count] = v;
        polled[2 + count++] = (struct pollfd){.fd = v->socket, .events = events};
    }
    if (poll(polled, count + 2, BEAT_MILLISECONDS) > 0) {
        while (read(s->ring[0], bytes, sizeof bytes) == (ssize_t)sizeof bytes)
            continue;
        for (nfds_t i = 0; i < count; i++)
            if (polled[2 + i].revents != 0)
                serve_visit(s, of[i], polled[2 + i].revents);
        if (polled[0].revents != 0)
            admit(s);
    }
    for (int32_t i = 0; i < MOST_VISITS; i++)
        if (s->visits[i].state == VISIT_PAGE)
            send_posts(s, &s->visits[i]);
    end_late_visits(s, pel_seconds());
    tell_busy(s, pel_seconds());
}

/* ---- the server ---- */

static pel_status make_token(server *s, pel_error *error)
{
    unsigned char bytes[TOKEN_BYTES];
    if (getentropy(bytes, sizeof bytes) != 0)
        return pel_fail(error, PEL_BAD_FILE, "the system gives no random numbers for the token");
    for (size_t i = 0; i < sizeof bytes; i++)
        snprintf(s->token + 2 * i, 3, "%02x", bytes[i]);
    return PEL_OK;
}

static pel_status check_def(const pel_server_def *def, pel_error *error)
{
    if (def->cookie != SERVER_COOKIE)
        return pel_fail(error, PEL_BAD_ARGUMENT, "server def was not made by pel_server_def_default()");
    if (def->scene == NULL || def->page == NULL)
        return pel_fail(error, PEL_BAD_ARGUMENT, "the server has no %s", def->scene == NULL ? "scene" : "page");
    if (def->port < 0 || def->port > 65535 || def->thread_count < 0)
        return pel_fail(error, PEL_BAD_ARGUMENT, "the port %d is not 0 to 65535, or the number of threads is below 0",
                        (int)def->port);
    return PEL_OK;
}

/* 'sha256-...' of each script of the page, which alone may run there */
static pel_status make_policy(server *s, pel_error *error)
{
    static const char before[] = "default-src 'none'; style-src 'unsafe-inline'; img-src data: blob:; media-src blob:; "
                                 "base-uri 'none'; form-action 'none'; frame-ancestors 'none'; script-src";
    void *policy = NULL;
    size_t room = 0, length = sizeof before - 1;
    bool fits = pel_reserve(&policy, &room, sizeof before + 8, 1);
    if (fits)
        memcpy(policy, before, sizeof before);
    const char *at = s->page;
    int32_t count = 0;
    while (fits && (at = strstr(at, "<script")) != NULL && (at = strchr(at, '>')) != NULL) {
        const char *end = strstr(++at, "</script>");
        char text[PEL_DIGEST_TEXT];
        unsigned char digest[PEL_SHA256_SIZE];
        if (end == NULL)
            break;
        pel_sha256(at, (size_t)(end - at), digest);
        pel_digest_text(digest, sizeof digest, text);
        fits = pel_reserve(&policy, &room, length + sizeof text + 16, 1);
        if (fits)
            length += (size_t)sprintf((char *)policy + length, " 'sha256-%s'", text);
        count++;
        at = end;
    }
    if (fits && count == 0)
        memcpy((char *)policy + length, " 'none'", 8);
    s->policy = policy;
    if (!fits)
        return pel_fail_memory(error);
    return count <= 8 ? PEL_OK : pel_fail(error, PEL_BAD_FORMAT, "the page has more than 8 scripts");
}

static pel_status read_page(server *s, pel_error *error)
{
    pel_status status = pel_file_read(s->def->page, &s->page, &s->page_size, error);
    if (status == PEL_BAD_FILE)
        pel_fail_remedy(error, "build it with `make web`");
    return status == PEL_OK ? make_policy(s, error) : status;
}

static pel_status fail_to_listen(const server *s, const char *host, pel_error *error)
{
    char place[PEL_HOST_SIZE];
    const int32_t port = s->def->port;
    snprintf(place, sizeof place, "%s:%d", host, (int)port);
    pel_fail(error, PEL_BAD_FILE,
             port > 0 ? "the port is in use, or the address does not belong to this machine"
                      : "the address is none of this machine");
    pel_fail_remedy(error, port > 0 ? "omit --port to use a free one, or name another"
                                    : "omit --host, or name an address that `ip address` lists");
    pel_fail_place(error, place, 0, 0);
    return PEL_BAD_FILE;
}

static pel_status listen_for_pages(server *s, pel_error *error)
{
    const char *host = s->def->host != NULL ? s->def->host : "127.0.0.1";
    struct sockaddr_in at = {.sin_family = AF_INET, .sin_port = htons((uint16_t)s->def->port)};
    socklen_t size = sizeof at;
    const int on = 1;
    if (pipe(s->ring) != 0 || !set_up(s->ring[0]) || !set_up(s->ring[1]))
        return pel_fail(error, PEL_OUT_OF_MEMORY, "no pipe can be created for the server");
    s->listener = socket(AF_INET, SOCK_STREAM, 0);
    if (!set_up(s->listener) || inet_pton(AF_INET, host, &at.sin_addr) != 1 ||
        setsockopt(s->listener, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) != 0 ||
        bind(s->listener, (struct sockaddr *)&at, sizeof at) != 0 || listen(s->listener, SOMAXCONN) != 0 ||
        getsockname(s->listener, (struct sockaddr *)&at, &size) != 0)
        return fail_to_listen(s, host, error);
    int port = ntohs(at.sin_port);
    snprintf(s->host, sizeof s->host, "%s:%d", host, port);
    snprintf(s->local, sizeof s->local, "localhost:%d", port);
    snprintf(s->cookie, sizeof s->cookie, "pellicle-%d", port);
    return PEL_OK;
}

/* wakes the loop; may be called by any thread */
static void ring(void *user)
{
    const server *s = user;
    /* a full pipe wakes it too */
    (void)!write(s->ring[1], "", 1);
}

static void serve_until_done(server *s)
{
    const pel_server_def *def = s->def;
    char address[PEL_HOST_SIZE + 80];
    snprintf(address, sizeof address, "http://%s/?token=%s", s->host, s->token);
    if (def->opened != NULL)
        def->opened(def->user, address);
    while (def->wanted == NULL || def->wanted(def->user))
        serve_turn(s);
}

static pel_status run_threads(server *s, pel_player *player, pel_error *error)
{
    pthread_t thread;
    if (pthread_create(&thread, NULL, pel_player_run, player) != 0)
        return pel_fail(error, PEL_OUT_OF_MEMORY, "no thread can be created for the simulation");
    serve_until_done(s);
    pel_mailbox_end(&s->box);
    pthread_join(thread, NULL);
    return PEL_OK;
}

static void close_server(server *s)
{
    for (int32_t i = 0; i < MOST_VISITS; i++)
        if (s->visits[i].state != VISIT_FREE)
            end_visit(&s->visits[i]);
    const int open[] = {s->listener, s->ring[0], s->ring[1]};
    for (size_t i = 0; i < sizeof open / sizeof *open; i++)
        if (open[i] >= 0)
            close(open[i]);
    pel_mailbox_destroy(&s->box);
    pel_free(s->page);
    pel_free(s->policy);
    pel_free(s);
}

pel_status pel_serve(const pel_server_def *def, pel_error *error)
{
    PEL_REFUSE_NULL(def, error);
    pel_player *player = NULL;
    pel_status status = check_def(def, error);
    server *s = status == PEL_OK ? pel_allocate(1, sizeof *s) : NULL;
    if (s == NULL)
        return status == PEL_OK ? pel_fail_memory(error) : status;
    s->def = def;
    s->listener = s->ring[0] = s->ring[1] = -1;
    pel_mailbox_create(&s->box);
    status = read_page(s, error);
    if (status == PEL_OK)
        status = make_token(s, error);
    if (status == PEL_OK)
        status = pel_player_create(def, &s->box, &player, error);
    if (status == PEL_OK)
        status = listen_for_pages(s, error);
    if (status == PEL_OK) {
        s->box.user = s;
        s->box.ring = ring;
        status = run_threads(s, player, error);
    }
    pel_player_destroy(player);
    close_server(s);
    return status;
}
