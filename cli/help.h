/* Help pages and the bash completion, written from the table of commands. */
#ifndef PELLICLE_CLI_HELP_H
#define PELLICLE_CLI_HELP_H

#include "options.h"

void cli_print_overview(FILE *file);
void cli_print_help(FILE *file, const cli_command *command);
void cli_print_completion(FILE *file);

/* words of text from the cursor's column on, wrapped to lines that begin with `indent` blanks; ends with a newline */
void cli_print_wrapped(FILE *file, const char *text, int column, int indent);

#endif
