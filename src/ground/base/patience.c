#include "base/patience.h"

#include <stddef.h>

static _Thread_local bool (*asked)(void *user);
static _Thread_local void *asked_user;
static _Thread_local bool is_lost;

void pel_patience_begin(bool (*wanted)(void *user), void *user)
{
    asked = wanted;
    asked_user = user;
    is_lost = false;
}

bool pel_patience_end(void)
{
    bool was_lost = is_lost;
    asked = NULL;
    is_lost = false;
    return was_lost;
}

bool pel_patience_is_lost(void)
{
    if (asked != NULL && !is_lost)
        is_lost = !asked(asked_user);
    return is_lost;
}
