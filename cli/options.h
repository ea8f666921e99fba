/* The command line described as data. One table of commands (table.c) drives parsing, help and shell completion. */
#ifndef PELLICLE_CLI_OPTIONS_H
#define PELLICLE_CLI_OPTIONS_H

#include <stdbool.h>
#include <stdio.h>

/* exit statuses of the program */
enum { CLI_DONE = 0, CLI_FAILED = 1, CLI_BAD_INPUT = 2 };

/* kind of a value: its check and completion */
typedef enum cli_kind {
    CLI_FLAG,    /* no value */
    CLI_COUNT,   /* whole number from 1 */
    CLI_LENGTH,  /* number from 0 */
    CLI_SETTING, /* key=value */
    CLI_TEXT,    /* any text but none */
    CLI_WORD,    /* one of `words` */
    CLI_FILE,
    CLI_SCENE, /* a file, .yaml .yml .json first */
    CLI_FOLDER
} cli_kind;

/* the index-th known word, null past the last */
typedef const char *cli_words(int index);

typedef struct cli_option {
    const char *name; /* long name without dashes */
    char letter;      /* short name, 0 = none */
    cli_kind kind;
    bool repeated;     /* may be given more than once */
    const char *value; /* placeholder of the value in the help, null for a flag */
    const char *doc;
    cli_words *words;               /* the choices of a CLI_WORD */
    void (*print_keys)(FILE *file); /* writes the keys of a CLI_SETTING, one a line, for completion */
} cli_option;

/* an argument without dashes */
typedef struct cli_slot {
    const char *name;
    cli_kind kind;
    bool optional;
    bool repeated;    /* the last slot may take any number of arguments */
    const char *noun; /* name of a CLI_WORD in errors */
    cli_words *words;
} cli_slot;

enum { CLI_SLOTS = 2, CLI_OPTIONS = 28, CLI_WORDS = 256, CLI_ARGUMENTS = 64 };

typedef struct cli_call cli_call;

typedef struct cli_command {
    const char *name;
    const char *summary;             /* one line */
    const char *text;                /* paragraphs, wrapped when printed */
    const char *examples;            /* one command a line */
    cli_slot slots[CLI_SLOTS];       /* ends at the first without a name */
    cli_option options[CLI_OPTIONS]; /* likewise */
    void (*more_help)(FILE *file);   /* nullable */
    int (*run)(const cli_call *call);
} cli_command;

/* one option as it was given */
typedef struct cli_given {
    const cli_option *option;
    const char *value; /* null for a flag */
} cli_given;

/* a parsed command line; the strings belong to main */
struct cli_call {
    const cli_command *command;
    const char *arguments[CLI_ARGUMENTS]; /* null = not given */
    int argument_count;
    const cli_given *given; /* (given_count) in the order of the command line */
    int given_count;
};

/* the table (table.c); past the last command null */
const cli_command *cli_command_at(int index);
/* the command of that name, or null */
const cli_command *cli_command_find(const char *name);
cli_words cli_command_names;

/* options that every command has */
extern const cli_option cli_help_option;

/* Parses the arguments after the command's name into call (given has at least argument_count entries). On an error
   prints it to stderr and returns false. `*help` is set if --help is among the options. */
bool cli_parse(const cli_command *command, int argument_count, char *const *arguments, cli_given *given, cli_call *call,
               bool *help);

bool cli_has(const cli_call *call, const char *option);
/* the last value given for the option, or null */
const char *cli_value(const cli_call *call, const char *option);
/* the same for a CLI_COUNT; 0 when not given */
int cli_count(const cli_call *call, const char *option);
/* the same for a CLI_LENGTH */
double cli_number(const cli_call *call, const char *option);
/* copies the values of a repeated option to values (given_count), returns how many */
int cli_values(const cli_call *call, const char *option, const char **values);

/* the known word nearest to text, null when none is near */
const char *cli_nearest(const char *text, cli_words *words);

/* "error: ..." on stderr; returns CLI_BAD_INPUT */
int cli_complain(const char *format, ...)
#if defined(__GNUC__)
    __attribute__((format(printf, 1, 2)))
#endif
    ;

#endif
