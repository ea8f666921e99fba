/* The bash completion: one case for each command, made from the table. */
#include "help.h"

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

void cli_print_completion(FILE *file)
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
