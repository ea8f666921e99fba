/* Stop signals: SIGINT, SIGTERM and SIGHUP, by which commands that write several files stop between two of them. */
#ifndef PELLICLE_CLI_STOP_H
#define PELLICLE_CLI_STOP_H

#include <stdbool.h>

/* From now on the first of these signals asks to stop, and writes `text` (ends with a newline, lives forever) on
   standard error; the second ends the program at once, as all of them did before. Signals that the caller told us to
   ignore stay ignored. Further calls change nothing. */
void cli_catch_stop(const char *text);

bool cli_stop_asked(void);

#endif
