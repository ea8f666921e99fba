#include "live/request.h"

#include <ctype.h>
#include <string.h>
#include <strings.h>

/* text at..end */
typedef struct span {
    const char *at, *end;
} span;

static span trim(span text)
{
    while (text.at < text.end && (*text.at == ' ' || *text.at == '\t'))
        text.at++;
    while (text.end > text.at && (text.end[-1] == ' ' || text.end[-1] == '\t'))
        text.end--;
    return text;
}

/* splits the text at a letter and leaves the rest */
static span take(span *text, char letter)
{
    const char *found = memchr(text->at, letter, (size_t)(text->end - text->at));
    span taken = {text->at, found != NULL ? found : text->end};
    text->at = found != NULL ? found + 1 : text->end;
    return taken;
}

static bool is(span text, const char *word)
{
    size_t length = strlen(word);
    return (size_t)(text.end - text.at) == length && strncasecmp(text.at, word, length) == 0;
}

/* whether one of the words between commas is this one */
static bool lists(span text, const char *word)
{
    bool found = false;
    while (text.at < text.end)
        found |= is(trim(take(&text, ',')), word);
    return found;
}

static bool copy(span text, char *to, size_t room)
{
    size_t length = (size_t)(text.end - text.at);
    if (length >= room)
        return false;
    memcpy(to, text.at, length);
    to[length] = '\0';
    return true;
}

static void take_query(span query, pel_request *request)
{
    while (query.at < query.end) {
        span value = take(&query, '&'), name = take(&value, '=');
        if (!is(name, "token") || request->has_query_token)
            continue;
        request->has_query_token = true;
        if (!copy(value, request->token, sizeof request->token))
            request->token[0] = '\0';
    }
}

static bool take_first_line(span line, pel_request *request)
{
    span method = take(&line, ' '), target = take(&line, ' ');
    if (!is(line, "HTTP/1.1") || target.at == target.end || *target.at != '/')
        return false;
    span path = take(&target, '?');
    request->is_get = is(method, "GET");
    if (!copy(path, request->path, sizeof request->path))
        memcpy(request->path, "/?", 3);
    take_query(target, request);
    return true;
}

static void take_cookies(span cookies, const char *name, pel_request *request)
{
    while (cookies.at < cookies.end && !request->has_query_token) {
        span value = trim(take(&cookies, ';')), key = take(&value, '=');
        if (is(key, name) && !copy(value, request->token, sizeof request->token))
            request->token[0] = '\0';
    }
}

/* all headers that an upgrade requires */
typedef struct upgrade {
    bool connection, websocket, version;
} upgrade;

static bool take_header(span line, const char *cookie, pel_request *request, upgrade *asks)
{
    span name = take(&line, ':'), value = trim(line);
    if (name.at == name.end || isspace((unsigned char)name.end[-1]) || isspace((unsigned char)*name.at))
        return false;
    if (is(name, "Host"))
        return request->host[0] == '\0' && copy(value, request->host, sizeof request->host);
    if (is(name, "Origin"))
        return request->origin[0] == '\0' && value.at < value.end &&
               copy(value, request->origin, sizeof request->origin);
    if (is(name, "Cookie"))
        take_cookies(value, cookie, request);
    else if (is(name, "Connection"))
        asks->connection |= lists(value, "Upgrade");
    else if (is(name, "Upgrade"))
        asks->websocket |= lists(value, "websocket");
    else if (is(name, "Sec-WebSocket-Version"))
        asks->version |= is(value, "13");
    else if (is(name, "Sec-WebSocket-Protocol"))
        request->has_protocol |= lists(value, "pellicle");
    else if (is(name, "Sec-WebSocket-Key"))
        return copy(value, request->key, sizeof request->key);
    return true;
}

/* the end of the head, behind its empty line; null = not there yet */
static const char *find_end(const char *bytes, size_t size)
{
    for (size_t i = 3; i < size; i++)
        if (bytes[i] == '\n' && memcmp(bytes + i - 3, "\r\n\r\n", 4) == 0)
            return bytes + i + 1;
    return NULL;
}

pel_request_end pel_request_parse(const char *bytes, size_t size, const char *cookie, pel_request *request)
{
    upgrade asks = {0};
    *request = (pel_request){0};
    const char *end = find_end(bytes, size < PEL_HEAD_LIMIT ? size : PEL_HEAD_LIMIT);
    if (end == NULL)
        return size < PEL_HEAD_LIMIT ? PEL_REQUEST_PART : PEL_REQUEST_BAD;
    request->size = (size_t)(end - bytes);
    if (memchr(bytes, '\0', request->size) != NULL)
        return PEL_REQUEST_BAD;
    /* but for the empty line */
    span rest = {bytes, end - 2};
    for (bool is_first = true; rest.at < rest.end; is_first = false) {
        span line = take(&rest, '\n');
        if (line.end == line.at || line.end[-1] != '\r')
            return PEL_REQUEST_BAD;
        line.end--;
        if (is_first ? !take_first_line(line, request) : !take_header(line, cookie, request, &asks))
            return PEL_REQUEST_BAD;
    }
    request->upgrades = asks.connection && asks.websocket && asks.version && request->key[0] != '\0';
    return PEL_REQUEST_WHOLE;
}
