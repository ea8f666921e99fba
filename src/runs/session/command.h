/* A command of a session as words. */
#ifndef PEL_SESSION_COMMAND_H
#define PEL_SESSION_COMMAND_H

#include "pellicle/session.h"

typedef enum pel_command_word {
    PEL_COMMAND_SET,
    PEL_COMMAND_GRAB,
    PEL_COMMAND_GRASP,
    PEL_COMMAND_PRESS,
    PEL_COMMAND_MOVE,
    PEL_COMMAND_RELEASE,
    PEL_COMMAND_PIN,
    PEL_COMMAND_UNPIN,
    PEL_COMMAND_INFLATE,
    PEL_COMMAND_CUT,
    PEL_COMMAND_MARK
} pel_command_word;

enum { PEL_COMMAND_NUMBERS = 8 };

typedef struct pel_command {
    pel_command_word word;
    char line[PEL_SESSION_LINE];  /* the words with single spaces between them */
    char name[PEL_SESSION_LINE];  /* path, shape or body */
    char value[PEL_SESSION_LINE]; /* of `set` */
    pel_tool_shape shape;
    double numbers[PEL_COMMAND_NUMBERS];
} pel_command;

/* Parses a line and validates it except for names of paths and bodies. PEL_BAD_ARGUMENT with the syntax of the word. */
pel_status pel_command_parse(const char *line, pel_command *command, pel_error *error);

#endif
