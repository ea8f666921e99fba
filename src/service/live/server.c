/* HTTP and WebSocket through libwebsockets: the page, and one channel to it. All of this runs in the caller's thread.
 */
#define _XOPEN_SOURCE 700
#include "pellicle/server.h"

#include "base/memory.h"
#include "base/status.h"
#include "live/player.h"

#include <arpa/inet.h>
#include <libwebsockets.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { SERVER_COOKIE = 0x73727621, TOKEN_BYTES = 16, HOST_SIZE = 300, BEAT_MICROSECONDS = 100000 };

typedef struct server {
    const pel_server_def *def;
    pel_mailbox box;
    struct lws_context *context;
    bool was_seen; /* a page has come */
    char token[2 * TOKEN_BYTES + 1];
    char host[HOST_SIZE];        /* 127.0.0.1:PORT */
    char local[HOST_SIZE];       /* localhost:PORT */
    lws_sorted_usec_list_t beat; /* lets lws_service return */
    unsigned char *sending;      /* (room) a message with room for the head before it */
    size_t room;
} server;

/* a page */
typedef struct page {
    pel_mail_reader reader;
    char *line; /* a message being received */
    size_t length, room;
} page;

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
static bool is_host(const server *s, struct lws *wsi, const char *name)
{
    char reached[HOST_SIZE], digits[INET_ADDRSTRLEN];
    struct sockaddr_in at = {0};
    socklen_t size = sizeof at;
    if (strcmp(name, s->host) == 0 || strcmp(name, s->local) == 0)
        return true;
    if (getsockname(lws_get_socket_fd(wsi), (struct sockaddr *)&at, &size) != 0 || at.sin_family != AF_INET ||
        inet_ntop(AF_INET, &at.sin_addr, digits, sizeof digits) == NULL)
        return false;
    snprintf(reached, sizeof reached, "%s:%d", digits, (int)ntohs(at.sin_port));
    return strcmp(name, reached) == 0;
}

/* the token, a Host of this server, and no page of another origin */
static bool may_come(const server *s, struct lws *wsi)
{
    char text[HOST_SIZE + 16];
    const char *token = lws_get_urlarg_by_name(wsi, "token=", text, sizeof text);
    if (token == NULL || !is_same(token, s->token))
        return false;
    if (lws_hdr_copy(wsi, text, sizeof text, WSI_TOKEN_HOST) <= 0 || !is_host(s, wsi, text))
        return false;
    if (lws_hdr_total_length(wsi, WSI_TOKEN_ORIGIN) == 0)
        return true;
    return lws_hdr_copy(wsi, text, sizeof text, WSI_TOKEN_ORIGIN) > 0 && strncmp(text, "http://", 7) == 0 &&
           is_host(s, wsi, text + 7);
}

/* ---- the page ---- */

static int serve_page(const server *s, struct lws *wsi, const char *path)
{
    static const char headers[] = "cache-control: no-store\r\nreferrer-policy: no-referrer\r\n"
                                  "x-content-type-options: nosniff\r\nx-frame-options: DENY\r\n";
    if (!may_come(s, wsi))
        return lws_return_http_status(wsi, HTTP_STATUS_FORBIDDEN, NULL) != 0 || lws_http_transaction_completed(wsi) ? -1
                                                                                                                    : 0;
    if (strcmp(path, "/") != 0)
        return lws_return_http_status(wsi, HTTP_STATUS_NOT_FOUND, NULL) != 0 || lws_http_transaction_completed(wsi) ? -1
                                                                                                                    : 0;
    int sent = lws_serve_http_file(wsi, s->def->page, "text/html; charset=utf-8", headers, sizeof headers - 1);
    return sent < 0 || (sent > 0 && lws_http_transaction_completed(wsi)) ? -1 : 0;
}

/* ---- messages to a page ---- */

static int send_post(server *s, struct lws *wsi, page *p)
{
    size_t size = 0;
    int kind = pel_mailbox_take(&s->box, &p->reader, LWS_PRE, &s->sending, &s->room, &size);
    if (kind < 0 || kind == PEL_POST_COUNT)
        return kind < 0 ? -1 : 0;
    bool binary = kind == PEL_POST_FRAME || kind == PEL_POST_SURFACE;
    if (lws_write(wsi, s->sending + LWS_PRE, size, binary ? LWS_WRITE_BINARY : LWS_WRITE_TEXT) < (int)size)
        return -1;
    lws_callback_on_writable(wsi);
    return 0;
}

/* ---- messages from a page ---- */

/* "received" is between the page and the server; all other lines are for the simulation */
static void take_line(server *s, struct lws *wsi, page *p)
{
    if (strcmp(p->line, "received") == 0) {
        pel_mailbox_received(&p->reader);
        lws_callback_on_writable(wsi);
        return;
    }
    pel_mailbox_line(&s->box, p->line);
    p->line = NULL;
    p->room = 0;
}

static int receive(server *s, struct lws *wsi, page *p, const char *bytes, size_t size)
{
    void *line = p->line;
    if (lws_frame_is_binary(wsi) || p->length + size > PEL_MESSAGE_LIMIT || memchr(bytes, '\0', size) != NULL)
        return -1;
    if (!pel_reserve(&line, &p->room, p->length + size + 1, 1))
        return -1;
    p->line = line;
    memcpy(p->line + p->length, bytes, size);
    p->length += size;
    p->line[p->length] = '\0';
    if (!lws_is_final_fragment(wsi) || lws_remaining_packet_payload(wsi) > 0)
        return 0;
    p->length = 0;
    take_line(s, wsi, p);
    return 0;
}

static void welcome(server *s, struct lws *wsi, page *p)
{
    *p = (page){0};
    pel_mailbox_welcome(&s->box, &p->reader);
    /* nobody misses the beginning */
    if (!s->was_seen && !s->def->paused)
        pel_mailbox_line(&s->box, pel_copy_string("play"));
    s->was_seen = true;
    lws_callback_on_writable(wsi);
}

static int serve(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t size)
{
    server *s = lws_context_user(lws_get_context(wsi));
    switch (reason) {
    case LWS_CALLBACK_HTTP:
        return serve_page(s, wsi, in);
    case LWS_CALLBACK_HTTP_FILE_COMPLETION:
        return lws_http_transaction_completed(wsi) ? -1 : 0;
    case LWS_CALLBACK_HTTP_CONFIRM_UPGRADE:
        if (may_come(s, wsi))
            return 0;
        return lws_return_http_status(wsi, HTTP_STATUS_FORBIDDEN, NULL) != 0 ? -1 : 1;
    case LWS_CALLBACK_ESTABLISHED:
        welcome(s, wsi, user);
        return 0;
    case LWS_CALLBACK_CLOSED:
        pel_free(((page *)user)->line);
        return 0;
    case LWS_CALLBACK_RECEIVE:
        return receive(s, wsi, user, in, size);
    case LWS_CALLBACK_SERVER_WRITEABLE:
        return send_post(s, wsi, user);
    case LWS_CALLBACK_EVENT_WAIT_CANCELLED:
        lws_callback_on_writable_all_protocol(s->context, lws_get_protocol(wsi));
        return 0;
    default:
        return 0;
    }
}

/* ---- the server ---- */

static pel_status make_token(server *s, pel_error *error)
{
    unsigned char bytes[TOKEN_BYTES];
    FILE *file = fopen("/dev/urandom", "rb");
    bool done = file != NULL && fread(bytes, 1, sizeof bytes, file) == sizeof bytes;
    if (file != NULL)
        fclose(file);
    if (!done)
        return pel_fail(error, PEL_BAD_FILE, "/dev/urandom gives no random numbers for the token");
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
    if (access(def->page, R_OK) != 0) {
        pel_fail(error, PEL_BAD_FILE, "the page cannot be read");
        pel_fail_remedy(error, "build it with `make web`");
        pel_fail_place(error, def->page, 0, 0);
        return PEL_BAD_FILE;
    }
    return PEL_OK;
}

static pel_status listen_for_pages(server *s, pel_error *error)
{
    static const struct lws_protocols protocols[] = {
        {.name = "pellicle", .callback = serve, .per_session_data_size = sizeof(page), .rx_buffer_size = 65536}, {0}};
    const pel_server_def *def = s->def;
    const char *host = def->host != NULL ? def->host : "127.0.0.1";
    struct lws_context_creation_info info = {0};
    info.port = def->port;
    info.iface = host;
    info.protocols = protocols;
    info.gid = -1;
    info.uid = -1;
    info.user = s;
    info.options =
        LWS_SERVER_OPTION_DISABLE_IPV6 | LWS_SERVER_OPTION_EXPLICIT_VHOSTS | LWS_SERVER_OPTION_FAIL_UPON_UNABLE_TO_BIND;
    lws_set_log_level(0, NULL);
    s->context = lws_create_context(&info);
    if (s->context == NULL)
        return pel_fail_memory(error);
    struct lws_vhost *vhost = lws_create_vhost(s->context, &info);
    if (vhost == NULL) {
        char place[HOST_SIZE];
        snprintf(place, sizeof place, "%s:%d", host, (int)def->port);
        pel_fail(error, PEL_BAD_FILE,
                 def->port > 0 ? "the port is in use, or the address does not belong to this machine"
                               : "the address is none of this machine");
        pel_fail_remedy(error, def->port > 0 ? "omit --port to use a free one, or name another"
                                             : "omit --host, or name an address that `ip address` lists");
        pel_fail_place(error, place, 0, 0);
        return PEL_BAD_FILE;
    }
    int port = lws_get_vhost_listen_port(vhost);
    snprintf(s->host, sizeof s->host, "%s:%d", host, port);
    snprintf(s->local, sizeof s->local, "localhost:%d", port);
    return PEL_OK;
}

/* wakes lws_service; may be called by any thread */
static void ring(void *user)
{
    const server *s = user;
    if (s->context != NULL)
        lws_cancel_service(s->context);
}

static void beat(lws_sorted_usec_list_t *list)
{
    server *s = lws_container_of(list, server, beat);
    lws_sul_schedule(s->context, 0, list, beat, BEAT_MICROSECONDS);
}

static void serve_until_done(server *s)
{
    const pel_server_def *def = s->def;
    char address[HOST_SIZE + 80];
    snprintf(address, sizeof address, "http://%s/?token=%s", s->host, s->token);
    if (def->opened != NULL)
        def->opened(def->user, address);
    beat(&s->beat);
    while (def->wanted == NULL || def->wanted(def->user))
        if (lws_service(s->context, 0) < 0)
            break;
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

pel_status pel_serve(const pel_server_def *def, pel_error *error)
{
    PEL_REFUSE_NULL(def, error);
    server s = {.def = def};
    pel_player *player = NULL;
    pel_status status = check_def(def, error);
    if (status != PEL_OK)
        return status;
    pel_mailbox_create(&s.box);
    status = make_token(&s, error);
    if (status == PEL_OK)
        status = pel_player_create(def, &s.box, &player, error);
    if (status == PEL_OK)
        status = listen_for_pages(&s, error);
    s.box.ring = ring;
    s.box.user = &s;
    if (status == PEL_OK)
        status = run_threads(&s, player, error);
    s.box.ring = NULL;
    if (s.context != NULL)
        lws_context_destroy(s.context);
    pel_player_destroy(player);
    pel_mailbox_destroy(&s.box);
    pel_free(s.sending);
    return status;
}
