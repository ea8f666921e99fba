#include "keys/scalar.h"

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

typedef struct scalar_decoder {
    const char *at, *end;
    char *text;
    size_t length;
} scalar_decoder;

static void put(scalar_decoder *out, char letter)
{
    out->text[out->length++] = letter;
}

/* one code point as UTF-8 */
static void put_code(scalar_decoder *out, uint32_t code)
{
    if (code < 0x80) {
        put(out, (char)code);
        return;
    }
    int tail = code < 0x800 ? 1 : code < 0x10000 ? 2 : 3;
    static const uint32_t heads[] = {0, 0xc0, 0xe0, 0xf0};
    put(out, (char)(unsigned char)(heads[tail] | code >> (6 * tail)));
    while (tail-- > 0)
        put(out, (char)(unsigned char)(0x80 | (code >> (6 * tail) & 0x3f)));
}

static bool is_blank(const scalar_decoder *in)
{
    return in->at < in->end && (*in->at == ' ' || *in->at == '\t');
}

static bool is_break(const scalar_decoder *in)
{
    return in->at < in->end && (*in->at == '\n' || *in->at == '\r');
}

/* \n, \r or \r\n */
static void skip_break(scalar_decoder *in)
{
    in->at += *in->at == '\r' && in->at + 1 < in->end && in->at[1] == '\n' ? 2 : 1;
}

/* empty lines become line feeds; returns how many there were */
static int skip_empty_lines(scalar_decoder *decoder)
{
    int count = 0;
    for (;;) {
        while (is_blank(decoder))
            decoder->at++;
        if (!is_break(decoder))
            return count;
        skip_break(decoder);
        put(decoder, '\n');
        count++;
    }
}

/* a line break becomes a space, empty lines after it become line feeds instead */
static void fold(scalar_decoder *decoder)
{
    skip_break(decoder);
    if (skip_empty_lines(decoder) == 0)
        put(decoder, ' ');
}

/* blanks count unless a line ends with them */
static void copy_blanks(scalar_decoder *decoder)
{
    const char *start = decoder->at;
    while (is_blank(decoder))
        decoder->at++;
    for (; !is_break(decoder) && start < decoder->at; start++)
        put(decoder, *start);
}

/* the number of `digits` hexadecimal digits */
static uint32_t read_hexadecimal(scalar_decoder *in, int digits)
{
    uint32_t number = 0;
    for (; digits > 0 && in->at < in->end; digits--, in->at++) {
        char c = *in->at;
        uint32_t digit = (uint32_t)(c <= '9' ? c - '0' : (c | 0x20) - 'a' + 10);
        number = number << 4 | (digit & 15);
    }
    return number;
}

/* \uXXXX; two halves of a pair, as JSON writes them, make one code point */
static uint32_t read_code(scalar_decoder *in, int digits)
{
    uint32_t code = read_hexadecimal(in, digits);
    bool first_half = code >= 0xd800 && code < 0xdc00;
    if (first_half && in->end - in->at >= 6 && in->at[0] == '\\' && in->at[1] == 'u') {
        in->at += 2;
        code = 0x10000 + ((code & 0x3ff) << 10) + (read_hexadecimal(in, 4) & 0x3ff);
    }
    return code <= 0x10ffff && (code < 0xd800 || code > 0xdfff) ? code : 0xfffd;
}

/* escapes in double quotes */
static void decode_escape(scalar_decoder *decoder)
{
    static const char letters[] = "0abt\tnvfre \"/\\N_LP";
    static const uint16_t codes[] = {0,    7,   8,   9,   9,    10,   11,   12,     13,
                                     0x1b, ' ', '"', '/', '\\', 0x85, 0xa0, 0x2028, 0x2029};
    decoder->at++;
    if (decoder->at == decoder->end)
        return;
    if (is_break(decoder)) {
        skip_break(decoder);
        skip_empty_lines(decoder);
        return;
    }
    char letter = *decoder->at++;
    const char *known = letter != '\0' ? strchr(letters, letter) : NULL;
    if (known != NULL)
        put_code(decoder, codes[known - letters]);
    else if (letter == 'x' || letter == 'u' || letter == 'U')
        put_code(decoder, read_code(decoder, letter == 'x' ? 2 : letter == 'u' ? 4 : 8));
}

char *pel_scene_decode_scalar(pel_arena *arena, const char *source, size_t size, char quote, size_t *length)
{
    /* \L is two bytes and gives three */
    scalar_decoder decoder = {source, source + size, pel_arena_take(arena, 2 * size + 1, 1), 0};
    if (decoder.text == NULL)
        return NULL;
    while (decoder.at < decoder.end) {
        if (is_break(&decoder)) {
            fold(&decoder);
        } else if (is_blank(&decoder)) {
            copy_blanks(&decoder);
        } else if (quote == '"' && *decoder.at == '\\') {
            decode_escape(&decoder);
        } else {
            put(&decoder, *decoder.at);
            decoder.at += quote == '\'' && *decoder.at == '\'' && decoder.at + 1 < decoder.end ? 2 : 1;
        }
    }
    *length = decoder.length;
    return decoder.text;
}
