/* The completions of bash, zsh and fish, made from the table of commands. */
#include "commands.h"

#include <string.h>

/* ---- bash: one case for each command ---- */

static void print_words(FILE *file, cli_words *words)
{
    for (int i = 0; words(i) != NULL; ++i)
        fprintf(file, "%s%s", i > 0 ? " " : "", words(i));
}

/* the statement that fills COMPREPLY for one kind of value */
static void print_reply(FILE *file, cli_kind kind, cli_words *words, void (*print_keys)(FILE *file))
{
    switch (kind) {
    case CLI_FILE:
        fputs("COMPREPLY=($(compgen -f -- \"$word\"))", file);
        break;
    case CLI_FOLDER:
        fputs("COMPREPLY=($(compgen -d -- \"$word\"))", file);
        break;
    case CLI_SCENE:
        fputs("COMPREPLY=($(for end in yaml yml json; do compgen -f -X \"!*.$end\" -- \"$word\"; done; "
              "compgen -d -- \"$word\"))",
              file);
        break;
    case CLI_SETTING:
        fputs("compopt -o nospace; COMPREPLY=($(compgen -S = -W '", file);
        print_keys(file);
        fputs("' -- \"$word\"))", file);
        break;
    case CLI_WORD:
        fputs("COMPREPLY=($(compgen -W '", file);
        print_words(file, words);
        fputs("' -- \"$word\"))", file);
        break;
    case CLI_FLAG:
    case CLI_TEXT:
    case CLI_LENGTH:
    case CLI_COUNT:
        fputs("COMPREPLY=()", file);
        break;
    }
}

/* the values of options, by the word before the cursor */
static void print_option_values(FILE *file, const cli_command *command)
{
    fputs("        case \"$previous\" in\n", file);
    for (int i = 0; i < CLI_OPTIONS && command->options[i].name != NULL; ++i) {
        const cli_option *option = &command->options[i];
        if (option->kind == CLI_FLAG)
            continue;
        if (option->letter != 0)
            fprintf(file, "        -%c | ", option->letter);
        else
            fputs("        ", file);
        fprintf(file, "--%s) ", option->name);
        print_reply(file, option->kind, option->words, option->print_keys);
        fputs("; return ;;\n", file);
    }
    fputs("        esac\n", file);
}

static void print_command(FILE *file, const cli_command *command)
{
    fprintf(file, "    %s)\n", command->name);
    print_option_values(file, command);
    fputs("        if [[ $word == -* ]]; then\n            COMPREPLY=($(compgen -W '", file);
    for (int i = 0; i < CLI_OPTIONS && command->options[i].name != NULL; ++i)
        fprintf(file, "--%s ", command->options[i].name);
    fprintf(file, "--%s' -- \"$word\"))\n", cli_help_option.name);
    if (command->slots[0].name != NULL) {
        fputs("        else\n            ", file);
        print_reply(file, command->slots[0].kind, command->slots[0].words, NULL);
        fputc('\n', file);
    }
    fputs("        fi ;;\n", file);
}

static void print_bash(FILE *file)
{
    fputs("# bash completion of pellicle; load it with: source <(pellicle completion bash)\n"
          "_pellicle() {\n"
          "    local word=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]}\n"
          "    COMPREPLY=()\n"
          "    if [ \"$COMP_CWORD\" -eq 1 ]; then\n"
          "        COMPREPLY=($(compgen -W '",
          file);
    print_words(file, cli_command_names);
    fputs(" --help --version' -- \"$word\"))\n        return\n    fi\n    case \"${COMP_WORDS[1]}\" in\n", file);
    for (int i = 0; cli_command_at(i) != NULL; ++i)
        print_command(file, cli_command_at(i));
    fputs("    esac\n}\ncomplete -F _pellicle pellicle\n", file);
}

/* ---- zsh: the arguments of each command for _arguments ---- */

/* text inside single quotes; letters of `special` get a backslash */
static void print_quoted(FILE *file, const char *text, const char *special)
{
    for (; *text != '\0'; ++text) {
        if (*text == '\'')
            fputs("'\\''", file);
        else if (*text == '\n')
            fputc(' ', file);
        else
            fprintf(file, strchr(special, *text) != NULL ? "\\%c" : "%c", *text);
    }
}

/* ":what:how to complete" of one kind of value */
static void print_zsh_value(FILE *file, const char *what, cli_kind kind, cli_words *words,
                            void (*print_keys)(FILE *file))
{
    fputc(':', file);
    print_quoted(file, what != NULL ? what : "", ":\\");
    switch (kind) {
    case CLI_FILE:
        fputs(":_files", file);
        break;
    case CLI_FOLDER:
        fputs(":_files -/", file);
        break;
    case CLI_SCENE:
        fputs(":_files -g \"*.(yaml|yml|json)(-.)\"", file);
        break;
    case CLI_SETTING:
        fputs(":{compadd -S = -- ", file);
        print_keys(file);
        fputs("}", file);
        break;
    case CLI_WORD:
        fputs(":(", file);
        print_words(file, words);
        fputc(')', file);
        break;
    case CLI_FLAG:
    case CLI_TEXT:
    case CLI_LENGTH:
    case CLI_COUNT:
        fputs(": ", file);
        break;
    }
}

static void print_zsh_option(FILE *file, const cli_option *option)
{
    for (int form = option->letter != 0 ? 0 : 1; form < 2; ++form) {
        fprintf(file, " \\\n        '%s", option->repeated ? "*" : "");
        if (form == 0)
            fprintf(file, "-%c", option->letter);
        else
            fprintf(file, "--%s", option->name);
        fputs("[", file);
        print_quoted(file, option->doc, "[]\\");
        fputc(']', file);
        if (option->kind != CLI_FLAG)
            print_zsh_value(file, option->value, option->kind, option->words, option->print_keys);
        fputc('\'', file);
    }
}

static void print_zsh(FILE *file)
{
    fputs("#compdef pellicle\n"
          "# zsh completion of pellicle; load it with: source <(pellicle completion zsh)\n"
          "_pellicle() {\n"
          "    if (( CURRENT == 2 )); then\n"
          "        local -a commands=(",
          file);
    for (int i = 0; cli_command_at(i) != NULL; ++i) {
        fprintf(file, "\n            '%s:", cli_command_at(i)->name);
        print_quoted(file, cli_command_at(i)->summary, ":\\");
        fputc('\'', file);
    }
    fputs(")\n        _describe command commands\n        return\n    fi\n"
          "    local command=$words[2]\n    shift words\n    (( CURRENT-- ))\n    case $command in\n",
          file);
    for (int i = 0; cli_command_at(i) != NULL; ++i) {
        const cli_command *command = cli_command_at(i);
        fprintf(file, "    %s)\n        _arguments -s -S", command->name);
        for (int k = 0; k < CLI_OPTIONS && command->options[k].name != NULL; ++k)
            print_zsh_option(file, &command->options[k]);
        print_zsh_option(file, &cli_help_option);
        for (int k = 0; k < CLI_SLOTS && command->slots[k].name != NULL; ++k) {
            const cli_slot *slot = &command->slots[k];
            fputs(" \\\n        '", file);
            if (slot->repeated)
                fputc('*', file);
            else
                fprintf(file, "%d%s", k + 1, slot->optional ? ":" : "");
            print_zsh_value(file, slot->name, slot->kind, slot->words, NULL);
            fputc('\'', file);
        }
        fputs(" ;;\n", file);
    }
    fputs("    esac\n}\ncompdef _pellicle pellicle\n", file);
}

/* ---- fish: one line for each option ---- */

/* the choices after -a; nothing where any text will do */
static void print_fish_value(FILE *file, cli_kind kind, cli_words *words, void (*print_keys)(FILE *file))
{
    switch (kind) {
    case CLI_FILE:
    case CLI_SCENE:
        fputs(" -F", file);
        break;
    case CLI_FOLDER:
        fputs(" -a '(__fish_complete_directories)'", file);
        break;
    case CLI_SETTING:
        fputs(" -a '", file);
        print_keys(file);
        fputs("'", file);
        break;
    case CLI_WORD:
        fputs(" -a '", file);
        print_words(file, words);
        fputs("'", file);
        break;
    case CLI_FLAG:
    case CLI_TEXT:
    case CLI_LENGTH:
    case CLI_COUNT:
        break;
    }
}

static void print_fish_option(FILE *file, const cli_command *command, const cli_option *option)
{
    fprintf(file, "complete -c pellicle -n '__fish_seen_subcommand_from %s' -l %s", command->name, option->name);
    if (option->letter != 0)
        fprintf(file, " -s %c", option->letter);
    if (option->kind != CLI_FLAG)
        fputs(" -r", file);
    print_fish_value(file, option->kind, option->words, option->print_keys);
    fputs(" -d '", file);
    for (const char *c = option->doc; *c != '\0'; ++c)
        fprintf(file, *c == '\'' || *c == '\\' ? "\\%c" : "%c", *c == '\n' ? ' ' : *c);
    fputs("'\n", file);
}

static void print_fish(FILE *file)
{
    fputs("# fish completion of pellicle; load it with: pellicle completion fish | source\n"
          "complete -c pellicle -f\n",
          file);
    for (int i = 0; cli_command_at(i) != NULL; ++i) {
        const cli_command *command = cli_command_at(i);
        fprintf(file, "complete -c pellicle -n __fish_use_subcommand -a %s -d '", command->name);
        for (const char *c = command->summary; *c != '\0'; ++c)
            fprintf(file, *c == '\'' || *c == '\\' ? "\\%c" : "%c", *c);
        fputs("'\n", file);
        for (int k = 0; k < CLI_OPTIONS && command->options[k].name != NULL; ++k)
            print_fish_option(file, command, &command->options[k]);
        print_fish_option(file, command, &cli_help_option);
        if (command->slots[0].name == NULL)
            continue;
        fprintf(file, "complete -c pellicle -n '__fish_seen_subcommand_from %s'", command->name);
        print_fish_value(file, command->slots[0].kind, command->slots[0].words, NULL);
        fputc('\n', file);
    }
}

/* ---- the table of shells ---- */

static const struct {
    const char *name;
    void (*print)(FILE *file);
} shells[] = {{"bash", print_bash}, {"zsh", print_zsh}, {"fish", print_fish}};
enum { SHELL_COUNT = sizeof shells / sizeof *shells };

const char *cli_shell_names(int index)
{
    return index < SHELL_COUNT ? shells[index].name : NULL;
}

int cli_completion(const cli_call *call)
{
    for (int i = 0; i < SHELL_COUNT; ++i) {
        if (strcmp(call->arguments[0], shells[i].name) == 0)
            shells[i].print(stdout);
    }
    return CLI_DONE;
}
