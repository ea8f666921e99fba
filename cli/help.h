/* Help pages and the manual page, written from the table of commands. */
#ifndef PELLICLE_CLI_HELP_H
#define PELLICLE_CLI_HELP_H

#include "options.h"

void cli_print_overview(FILE *file);
void cli_print_help(FILE *file, const cli_command *command);
/* the manual page pellicle(1), in the man macros of roff */
void cli_print_manual(FILE *file);

/* words of text from the cursor's column on, wrapped to lines that begin with `indent` blanks; ends with a newline */
void cli_print_wrapped(FILE *file, const char *text, int column, int indent);

#endif
