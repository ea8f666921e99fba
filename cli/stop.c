#include "stop.h"

#include <signal.h>
#include <string.h>
#include <unistd.h>

static volatile sig_atomic_t stop_asked;
static const char *stop_text;

static void ask_to_stop(int number)
{
    (void)number;
    stop_asked = 1;
    /* a message that does not get through changes nothing */
    if (write(STDERR_FILENO, stop_text, strlen(stop_text)) < 0)
        stop_asked = 1;
}

static void catch_signal(int number)
{
    struct sigaction action, old;
    memset(&action, 0, sizeof action);
    action.sa_handler = ask_to_stop;
    action.sa_flags = (int)SA_RESETHAND;
    if (sigaction(number, NULL, &old) == 0 && old.sa_handler != SIG_IGN)
        sigaction(number, &action, NULL);
}

void cli_catch_stop(const char *text)
{
    if (stop_text != NULL)
        return;
    stop_text = text;
    catch_signal(SIGINT);
    catch_signal(SIGTERM);
    catch_signal(SIGHUP);
}

bool cli_stop_asked(void)
{
    return stop_asked != 0;
}
