/* Stop signals: SIGINT, SIGTERM and SIGHUP, by which commands that write several files stop between two of them. */
#ifndef PELLICLE_CLI_STOP_H
#define PELLICLE_CLI_STOP_H

#include <stdbool.h>

/* After the call the first of these signals requests a stop, and writes `text` (ends with a newline, lives forever) to
   standard error; the second ends the program immediately. Signals that the parent process ignores stay ignored.
   Further calls change nothing. */
void cli_catch_stop(const char *text);

bool cli_stop_asked(void);

#endif
