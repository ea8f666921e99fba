#include "help.h"

#include <pellicle/base.h>

#include <string.h>

enum { PAGE_WIDTH = 88, DOC_COLUMN = 24 };

void cli_print_wrapped(FILE *file, const char *text, int column, int indent)
{
    if (column < indent)
        column += fprintf(file, "%*s", indent - column, "");
    bool first = true;
    while (*text != '\0') {
        if (*text == '\n') {
            fprintf(file, "\n%*s", indent, "");
            column = indent;
            first = true;
            ++text;
            continue;
        }
        int length = (int)strcspn(text, " \n");
        if (!first && column + 1 + length > PAGE_WIDTH) {
            fprintf(file, "\n%*s", indent, "");
            column = indent;
            first = true;
        }
        column += fprintf(file, "%s%.*s", first ? "" : " ", length, text);
        first = false;
        text += length;
        text += strspn(text, " ");
    }
    fputc('\n', file);
}

/* "[-o DIR]", on a new line where the one that has `column` letters would be too long; returns the new column */
static int print_option_usage(FILE *file, const cli_option *option, int column, int indent)
{
    char text[160], letter[2] = {option->letter, '\0'};
    int length = snprintf(text, sizeof text, "[%s%s%s%s]%s", option->letter != 0 ? "-" : "--",
                          option->letter != 0 ? letter : option->name, option->value != NULL ? " " : "",
                          option->value != NULL ? option->value : "", option->repeated ? "..." : "");
    if (column + 1 + length > PAGE_WIDTH) {
        fprintf(file, "\n%*s", indent - 1, "");
        column = indent - 1;
    }
    return column + fprintf(file, " %s", text);
}

static void print_usage(FILE *file, const cli_command *command)
{
    int indent = fprintf(file, "usage: pellicle %s", command->name), column = indent;
    for (int i = 0; i < CLI_SLOTS && command->slots[i].name != NULL; ++i)
        column += fprintf(file, command->slots[i].optional ? " [%s]%s" : " %s%s", command->slots[i].name,
                          command->slots[i].repeated ? "..." : "");
    for (int i = 0; i < CLI_OPTIONS && command->options[i].name != NULL; ++i)
        column = print_option_usage(file, &command->options[i], column, indent + 1);
    fputs("\n", file);
}

static void print_option(FILE *file, const cli_option *option)
{
    int column = 0;
    if (option->letter != 0)
        column += fprintf(file, "  -%c, ", option->letter);
    else
        column += fprintf(file, "      ");
    column += fprintf(file, "--%s", option->name);
    if (option->value != NULL)
        column += fprintf(file, " %s", option->value);
    if (column + 2 > DOC_COLUMN) {
        fputc('\n', file);
        column = 0;
    }
    cli_print_wrapped(file, option->doc, column, DOC_COLUMN);
}

void cli_print_help(FILE *file, const cli_command *command)
{
    fprintf(file, "pellicle %s: %s\n\n", command->name, command->summary);
    print_usage(file, command);
    fputc('\n', file);
    cli_print_wrapped(file, command->text, 0, 0);
    fputs("\noptions:\n", file);
    for (int i = 0; i < CLI_OPTIONS && command->options[i].name != NULL; ++i)
        print_option(file, &command->options[i]);
    print_option(file, &cli_help_option);
    if (command->more_help != NULL)
        command->more_help(file);
    fputs("\nexamples:\n  ", file);
    for (const char *c = command->examples; *c != '\0'; ++c)
        fputs(*c == '\n' ? "\n  " : (char[]){*c, '\0'}, file);
    fputc('\n', file);
}

void cli_print_overview(FILE *file)
{
    fputs("pellicle " PEL_VERSION ": soft tissue and thin shells on triangle surface meshes\n\n"
          "usage: pellicle COMMAND ...\n\ncommands:\n",
          file);
    for (int i = 0; cli_command_at(i) != NULL; ++i)
        fprintf(file, "  %-12s %s\n", cli_command_at(i)->name, cli_command_at(i)->summary);
    fputs("\n'pellicle COMMAND --help' explains a command with examples. 'pellicle --version' prints the "
          "version.\nexit status: 0 done; 1 the run failed; 2 wrong usage, scene or mesh, nothing was written.\n",
          file);
}
