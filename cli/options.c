#include "options.h"

#include <pellicle/base.h>

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

int cli_complain(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    fputs("error: ", stderr);
    vfprintf(stderr, format, arguments);
    fputc('\n', stderr);
    va_end(arguments);
    return CLI_BAD_INPUT;
}

const char *cli_nearest(const char *text, cli_words *words)
{
    const char *names[CLI_WORDS];
    size_t count = 0;
    while (count < CLI_WORDS && words((int)count) != NULL) {
        names[count] = words((int)count);
        ++count;
    }
    return pel_nearest_name(text, names, count);
}

/* state of the parser: its position and output */
typedef struct parser {
    const cli_command *command;
    int count, next;
    char *const *arguments;
    cli_given *given;
    cli_call *call;
    bool help;
} parser;

static const cli_option *find_option(const cli_command *command, const char *name, size_t length, char letter)
{
    if (letter == cli_help_option.letter || (length == 4 && name != NULL && strncmp(name, "help", 4) == 0))
        return &cli_help_option;
    for (int i = 0; i < CLI_OPTIONS && command->options[i].name != NULL; ++i) {
        const cli_option *option = &command->options[i];
        if (name != NULL ? strlen(option->name) == length && strncmp(option->name, name, length) == 0
                         : option->letter == letter)
            return option;
    }
    return NULL;
}

/* says which known option the first `length` letters of name are near to, or where the list is */
static bool unknown_option(const cli_command *command, const char *name, size_t length)
{
    const char *names[CLI_OPTIONS + 1] = {cli_help_option.name};
    size_t count = 1;
    for (; count <= CLI_OPTIONS && command->options[count - 1].name != NULL; ++count)
        names[count] = command->options[count - 1].name;
    char typed[64];
    snprintf(typed, sizeof typed, "%.*s", length < 60 ? (int)length : 60, name);
    const char *nearest = pel_nearest_name(typed, names, count);
    if (nearest != NULL)
        cli_complain("unknown option '--%s' of 'pellicle %s'. did you mean '--%s'?", typed, command->name, nearest);
    else
        cli_complain("unknown option '--%s' of 'pellicle %s'. see 'pellicle %s --help'", typed, command->name,
                     command->name);
    return false;
}

static bool check_word(const char *noun, const char *value, cli_words *words)
{
    for (int i = 0; words(i) != NULL; ++i) {
        if (strcmp(words(i), value) == 0)
            return true;
    }
    const char *nearest = cli_nearest(value, words);
    if (nearest != NULL) {
        cli_complain("unknown %s '%s'. did you mean '%s'?", noun, value, nearest);
        return false;
    }
    fprintf(stderr, "error: unknown %s '%s'. choose one of", noun, value);
    for (int i = 0; words(i) != NULL; ++i)
        fprintf(stderr, "%s %s", i > 0 ? "," : "", words(i));
    fputc('\n', stderr);
    return false;
}

/* refuses values that are invalid for any command; noun is the name of a word */
static bool check_value(const char *place, const char *noun, cli_kind kind, const char *value, cli_words *words)
{
    char *end = NULL;
    if (kind == CLI_COUNT) {
        long number = strtol(value, &end, 10);
        if (*value == '\0' || *end != '\0' || number < 1 || number > 1000000000)
            return cli_complain("%s is '%s'. give a whole number from 1", place, value), false;
    } else if (kind == CLI_LENGTH) {
        double number = strtod(value, &end);
        if (*value == '\0' || *end != '\0' || !isfinite(number) || number < 0.0)
            return cli_complain("%s is '%s'. give a number from 0", place, value), false;
    } else if (kind == CLI_SETTING) {
        const char *equals = strchr(value, '=');
        if (equals == NULL || equals == value)
            return cli_complain("%s is '%s'. write key=value", place, value), false;
    } else if (kind == CLI_WORD) {
        return check_word(noun, value, words);
    } else if (*value == '\0') {
        return cli_complain("%s is empty. give a name", place), false;
    }
    return true;
}

/* records one option; value is the text after '=' or the letter, null if there is none */
static bool take_option(parser *p, const cli_option *option, const char *value)
{
    char place[80];
    snprintf(place, sizeof place, "option '--%s'", option->name);
    if (option->kind == CLI_FLAG && value != NULL)
        return cli_complain("%s takes no value. leave '=%s' out", place, value), false;
    if (option->kind != CLI_FLAG && value == NULL) {
        if (p->next >= p->count)
            return cli_complain("%s needs a value. write '--%s %s'", place, option->name, option->value), false;
        value = p->arguments[p->next++];
    }
    if (value != NULL && !check_value(place, option->name, option->kind, value, option->words))
        return false;
    if (!option->repeated && option != &cli_help_option && cli_has(p->call, option->name))
        return cli_complain("%s is given twice. give it once", place), false;
    if (option == &cli_help_option)
        p->help = true;
    p->given[p->call->given_count++] = (cli_given){option, value};
    return true;
}

static bool take_long(parser *p, const char *name)
{
    const char *equals = strchr(name, '=');
    size_t length = equals != NULL ? (size_t)(equals - name) : strlen(name);
    const cli_option *option = find_option(p->command, name, length, 0);
    if (option == NULL)
        return unknown_option(p->command, name, length);
    return take_option(p, option, equals != NULL ? equals + 1 : NULL);
}

/* -q, -qj, -o DIR, -oDIR */
static bool take_short(parser *p, const char *letters)
{
    for (; *letters != '\0'; ++letters) {
        const cli_option *option = find_option(p->command, NULL, 0, *letters);
        if (option == NULL) {
            cli_complain("unknown option '-%c' of 'pellicle %s'. see 'pellicle %s --help'", *letters, p->command->name,
                         p->command->name);
            return false;
        }
        if (option->kind != CLI_FLAG)
            return take_option(p, option, letters[1] != '\0' ? letters + 1 : NULL);
        if (!take_option(p, option, NULL))
            return false;
    }
    return true;
}

static bool take_argument(parser *p, const char *text)
{
    int count = p->call->argument_count, i = count < CLI_SLOTS ? count : CLI_SLOTS - 1;
    while (i > 0 && p->command->slots[i].name == NULL)
        --i;
    const cli_slot *slot = &p->command->slots[i];
    if (slot->name != NULL && (i == count || slot->repeated) && count < CLI_ARGUMENTS) {
        p->call->arguments[p->call->argument_count++] = text;
        return check_value(slot->name, slot->noun, slot->kind, text, slot->words);
    }
    cli_complain("too many arguments: '%s'. see 'pellicle %s --help'", text, p->command->name);
    return false;
}

static bool take_all(parser *p)
{
    bool only_arguments = false;
    while (p->next < p->count) {
        const char *text = p->arguments[p->next++];
        bool good = true;
        if (only_arguments || text[0] != '-' || text[1] == '\0')
            good = take_argument(p, text);
        else if (strcmp(text, "--") == 0)
            only_arguments = true;
        else if (text[1] == '-')
            good = take_long(p, text + 2);
        else
            good = take_short(p, text + 1);
        if (!good)
            return false;
    }
    return true;
}

bool cli_parse(const cli_command *command, int argument_count, char *const *arguments, cli_given *given, cli_call *call,
               bool *help)
{
    *call = (cli_call){.command = command, .given = given};
    parser p = {.command = command, .count = argument_count, .arguments = arguments, .given = given, .call = call};
    bool good = take_all(&p);
    *help = p.help;
    if (!good || p.help)
        return good;
    for (int i = 0; i < CLI_SLOTS && command->slots[i].name != NULL; ++i) {
        if (call->arguments[i] == NULL && !command->slots[i].optional)
            return cli_complain("'pellicle %s' needs %s. see 'pellicle %s --help'", command->name,
                                command->slots[i].name, command->name),
                   false;
    }
    return true;
}

const char *cli_value(const cli_call *call, const char *option)
{
    for (int i = call->given_count - 1; i >= 0; --i) {
        if (strcmp(call->given[i].option->name, option) == 0)
            return call->given[i].value;
    }
    return NULL;
}

bool cli_has(const cli_call *call, const char *option)
{
    for (int i = 0; i < call->given_count; ++i) {
        if (strcmp(call->given[i].option->name, option) == 0)
            return true;
    }
    return false;
}

int cli_count(const cli_call *call, const char *option)
{
    const char *value = cli_value(call, option);
    return value != NULL ? atoi(value) : 0;
}

double cli_number(const cli_call *call, const char *option)
{
    const char *value = cli_value(call, option);
    return value != NULL ? strtod(value, NULL) : 0.0;
}

int cli_values(const cli_call *call, const char *option, const char **values)
{
    int count = 0;
    for (int i = 0; i < call->given_count; ++i) {
        if (strcmp(call->given[i].option->name, option) == 0)
            values[count++] = call->given[i].value;
    }
    return count;
}
