/* The manual page pellicle(1), made from the table of commands. */
#include "help.h"

#include <pellicle/base.h>

#include <string.h>

/* words of text; a newline begins a paragraph when `paragraphs`, else a line */
static void print_text(FILE *file, const char *text, bool paragraphs)
{
    bool at_start = true;
    for (; *text != '\0'; ++text) {
        if (*text == '\n') {
            if (!at_start)
                fputs(paragraphs ? "\n.P\n" : "\n.br\n", file);
            at_start = true;
            continue;
        }
        if (at_start && (*text == '.' || *text == '\''))
            fputs("\\&", file);
        if (*text == '-')
            fputs("\\-", file);
        else if (*text == '\\')
            fputs("\\e", file);
        else
            fputc(*text, file);
        at_start = false;
    }
    fputc('\n', file);
}

static void print_option(FILE *file, const cli_option *option)
{
    fputs(".TP\n", file);
    if (option->letter != 0)
        fprintf(file, "\\fB\\-%c\\fR, ", option->letter);
    fputs("\\fB\\-\\-", file);
    for (const char *c = option->name; *c != '\0'; ++c)
        fputs(*c == '-' ? "\\-" : (char[]){*c, '\0'}, file);
    fputs("\\fR", file);
    if (option->value != NULL)
        fprintf(file, " \\fI%s\\fR", option->value);
    fputc('\n', file);
    print_text(file, option->doc, false);
}

static void print_command(FILE *file, const cli_command *command)
{
    fprintf(file, ".SS pellicle %s", command->name);
    for (int i = 0; i < CLI_SLOTS && command->slots[i].name != NULL; ++i)
        fprintf(file, command->slots[i].optional ? " [%s]%s" : " %s%s", command->slots[i].name,
                command->slots[i].repeated ? "..." : "");
    fputs("\n", file);
    print_text(file, command->text, true);
    for (int i = 0; i < CLI_OPTIONS && command->options[i].name != NULL; ++i)
        print_option(file, &command->options[i]);
    fputs(".P\nExamples:\n.P\n.RS\n.nf\n", file);
    for (const char *line = command->examples; *line != '\0';) {
        size_t length = strcspn(line, "\n");
        char text[512];
        snprintf(text, sizeof text, "%.*s", (int)length, line);
        print_text(file, text, false);
        line += length + (line[length] == '\n');
    }
    fputs(".fi\n.RE\n", file);
}

void cli_print_manual(FILE *file)
{
    fputs(".TH PELLICLE 1 \"\" \"pellicle " PEL_VERSION "\" \"User Commands\"\n"
          ".SH NAME\n"
          "pellicle \\- simulate soft tissue and thin shells on triangle surface meshes\n"
          ".SH SYNOPSIS\n"
          ".B pellicle\n"
          ".I COMMAND\n"
          "[\\fIOPTION\\fR...] [\\fIARGUMENT\\fR...]\n"
          ".SH COMMANDS\n",
          file);
    for (int i = 0; cli_command_at(i) != NULL; ++i)
        print_command(file, cli_command_at(i));
    fputs(".SH OPTIONS OF ALL COMMANDS\n", file);
    print_option(file, &cli_help_option);
    fputs(".SH EXIT STATUS\n.TP\n0\ndone\n.TP\n1\nthe run failed\n.TP\n2\nwrong usage, scene or mesh; nothing was "
          "written\n",
          file);
}
