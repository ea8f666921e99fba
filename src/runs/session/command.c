#include "session/command.h"

#include "base/number.h"
#include "base/status.h"
#include "geom/solid.h"
#include "scene/word_mesh.h"

#include <math.h>
#include <string.h>

/* arguments of a word: the number of numbers, and whether a name or the rest of the line precedes them */
typedef struct grammar {
    const char *word, *values;
    int number_count;
    bool has_name, has_rest;
} grammar;

static const grammar words[] = {
    [PEL_COMMAND_SET] = {"set", "PATH VALUE", 0, true, true},
    [PEL_COMMAND_GRAB] = {"grab", "OX OY OZ DX DY DZ STIFFNESS REACH", 8, false, false},
    [PEL_COMMAND_GRASP] = {"grasp", "OX OY OZ DX DY DZ REACH ANEW", 8, false, false},
    [PEL_COMMAND_PRESS] = {"press", "SHAPE RADIUS X Y Z QX QY QZ QW", 8, true, false},
    [PEL_COMMAND_MOVE] = {"move", "X Y Z", 3, false, false},
    [PEL_COMMAND_RELEASE] = {"release", "", 0, false, false},
    [PEL_COMMAND_PIN] = {"pin", "OX OY OZ DX DY DZ REACH", 7, false, false},
    [PEL_COMMAND_UNPIN] = {"unpin", "OX OY OZ DX DY DZ REACH", 7, false, false},
    [PEL_COMMAND_INFLATE] = {"inflate", "BODY PRESSURE", 1, true, false},
    [PEL_COMMAND_CUT] = {"cut", "OX OY OZ DX DY DZ", 6, false, false},
    [PEL_COMMAND_MARK] = {"mark", "", 0, false, false},
};

enum { WORD_COUNT = sizeof words / sizeof *words };

/* Copies the line with single spaces between its words. Printable ASCII only, without quotes and backslashes: scenes
   quote it. */
static pel_status tidy(const char *line, char *out, pel_error *error)
{
    size_t length = 0;
    bool gap = false;
    for (const char *at = line; *at != '\0'; at++) {
        if (*at < ' ' || *at > '~' || *at == '"' || *at == '\\')
            return pel_fail(error, PEL_BAD_ARGUMENT, "a command holds the byte 0x%02x at place %d",
                            (unsigned)(unsigned char)*at, (int)(at - line));
        if (*at == ' ') {
            gap = length > 0;
            continue;
        }
        if (length + 2 + (gap ? 1 : 0) > PEL_SESSION_LINE)
            return pel_fail(error, PEL_BAD_ARGUMENT, "a command is longer than %d bytes", PEL_SESSION_LINE - 1);
        if (gap)
            out[length++] = ' ';
        gap = false;
        out[length++] = *at;
    }
    out[length] = '\0';
    return PEL_OK;
}

/* the next word, "" at the end */
static void take_word(const char **at, char *word)
{
    size_t length = strcspn(*at, " ");
    memcpy(word, *at, length);
    word[length] = '\0';
    *at += length + ((*at)[length] == ' ' ? 1 : 0);
}

static pel_status fail_usage(const grammar *rule, pel_error *error)
{
    return pel_fail(error, PEL_BAD_ARGUMENT, "'%s' takes %s", rule->word,
                    rule->values[0] != '\0' ? rule->values : "no values");
}

static pel_status find_word(const char *word, pel_command *command, pel_error *error)
{
    for (int i = 0; i < WORD_COUNT; i++)
        if (strcmp(words[i].word, word) == 0) {
            command->word = (pel_command_word)i;
            return PEL_OK;
        }
    return pel_refuse(error, PEL_BAD_ARGUMENT,
                      "use set, grab, grasp, press, move, release, pin, unpin, inflate, cut or mark",
                      "'%.40s' is not a command", word);
}

static pel_status take_numbers(const char **at, const grammar *rule, pel_command *command, pel_error *error)
{
    char word[PEL_SESSION_LINE];
    for (int i = 0; i < rule->number_count; i++) {
        take_word(at, word);
        const char *end = word + strlen(word);
        double *number = &command->numbers[i];
        if (word[0] == '\0')
            return fail_usage(rule, error);
        if (pel_number_parse(word, end, number) != end || !isfinite(*number))
            return pel_fail(error, PEL_BAD_ARGUMENT, "'%.40s' is not a number; '%s' takes %s", word, rule->word,
                            rule->values);
    }
    return **at == '\0' ? PEL_OK : fail_usage(rule, error);
}

static pel_status find_shape(pel_command *command, pel_error *error)
{
    command->shape = PEL_TOOL_MESH;
    if (pel_solid_find(command->name, &command->shape) || pel_word_mesh_is_one(command->name))
        return PEL_OK;
    char solids[128] = "";
    for (int i = 0; i < PEL_TOOL_SHAPE_COUNT; i++)
        if (pel_solid_rows[i].distance != NULL)
            snprintf(solids + strlen(solids), sizeof solids - strlen(solids), "%s, ", pel_solid_rows[i].word);
    pel_fail(error, PEL_BAD_ARGUMENT, "'%.40s' is not a shape to press with", command->name);
    pel_fail_remedy(error, "use %storus, cylinder, blend or an OBJ, PLY, STL, OFF or VTP file", solids);
    return PEL_BAD_ARGUMENT;
}

pel_status pel_command_parse(const char *line, pel_command *command, pel_error *error)
{
    char word[PEL_SESSION_LINE];
    *command = (pel_command){0};
    pel_status status = tidy(line, command->line, error);
    if (status != PEL_OK)
        return status;
    const char *at = command->line;
    take_word(&at, word);
    status = find_word(word, command, error);
    if (status != PEL_OK)
        return status;
    const grammar *rule = &words[command->word];
    if (rule->has_name)
        take_word(&at, command->name);
    if (rule->has_name && (command->name[0] == '\0' || (rule->has_rest && *at == '\0')))
        return fail_usage(rule, error);
    if (rule->has_rest) {
        memcpy(command->value, at, strlen(at) + 1);
        return PEL_OK;
    }
    status = take_numbers(&at, rule, command, error);
    return status == PEL_OK && command->word == PEL_COMMAND_PRESS ? find_shape(command, error) : status;
}
