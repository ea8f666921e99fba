#include "io/csv.h"

static bool ends(char letter, bool quoted)
{
    return letter == '\0' || letter == '\r' || letter == '\n' || (letter == ',' && !quoted);
}

bool pel_csv_next(const char **at, char *cell, size_t size)
{
    if (*at == NULL)
        return false;
    const char *from = *at;
    size_t length = 0;
    bool quoted = false;
    for (; !ends(*from, quoted); from++) {
        if (*from == '"' && (!quoted || from[1] != '"')) {
            quoted = !quoted;
            continue;
        }
        from += *from == '"';
        if (length + 1 < size)
            cell[length++] = *from;
    }
    cell[length] = '\0';
    *at = *from == ',' ? from + 1 : NULL;
    return true;
}
