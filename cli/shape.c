#include "commands.h"
#include "diagnostics.h"
#include "help.h"

#include <pellicle/shape.h>

#include <string.h>

const char *cli_shape_names(int index)
{
    const pel_shape_info *info = index < PEL_SHAPE_COUNT ? pel_shape_info_of((pel_shape_kind)index) : NULL;
    return info != NULL ? info->name : NULL;
}

/* whether a shape before `kind` has the parameter already */
static bool is_known_earlier(int kind, const char *name)
{
    for (int i = 0; i < kind; ++i) {
        const pel_shape_info *info = pel_shape_info_of((pel_shape_kind)i);
        for (int p = 0; p < info->parameter_count; ++p) {
            if (strcmp(info->parameters[p].name, name) == 0)
                return true;
        }
    }
    return false;
}

void cli_print_shape_keys(FILE *file)
{
    for (int kind = 0; kind < PEL_SHAPE_COUNT; ++kind) {
        const pel_shape_info *info = pel_shape_info_of((pel_shape_kind)kind);
        for (int p = 0; p < info->parameter_count; ++p) {
            if (!is_known_earlier(kind, info->parameters[p].name))
                fprintf(file, "%s\n", info->parameters[p].name);
        }
    }
}

/* "1 to 400", "more than 0", or the choices */
static void print_range(FILE *file, const pel_shape_parameter *parameter)
{
    if (parameter->type == PEL_SHAPE_CHOICE) {
        for (int i = 0; i <= (int)parameter->maximum; ++i)
            fprintf(file, "%s%s", i > 0 ? " | " : "", parameter->choices[i]);
    } else if (parameter->type == PEL_SHAPE_BOOLEAN) {
        fputs("true | false", file);
    } else {
        bool bounded = parameter->maximum < 1e9;
        fprintf(file,
                parameter->exclusive_minimum ? "more than %g"
                : bounded                    ? "%g"
                                             : "%g or more",
                parameter->minimum);
        if (bounded)
            fprintf(file, parameter->exclusive_minimum ? ", at most %.0f" : " to %.0f", parameter->maximum);
    }
}

static void print_parameter(FILE *file, const pel_shape_def *def, const pel_shape_parameter *parameter)
{
    char value[64], setting[PEL_NAME_SIZE + 64];
    double number = parameter->default_value;
    if (parameter->type == PEL_SHAPE_NUMBER)
        snprintf(value, sizeof value, "%g", number);
    else
        pel_shape_get(def, parameter, value, sizeof value);
    snprintf(setting, sizeof setting, "%s=%s", parameter->name, value);
    fprintf(file, "      %-26s %s%s%s%s (", setting, parameter->doc, *parameter->unit != '\0' ? " [" : "",
            parameter->unit, *parameter->unit != '\0' ? "]" : "");
    print_range(file, parameter);
    fputs(")\n", file);
}

static void print_shapes(FILE *file)
{
    for (int kind = 0; kind < PEL_SHAPE_COUNT; ++kind) {
        const pel_shape_info *info = pel_shape_info_of((pel_shape_kind)kind);
        pel_shape_def def = pel_shape_def_default((pel_shape_kind)kind);
        int column = fprintf(file, "  %s", info->name);
        cli_print_wrapped(file, info->doc, column, 20);
        for (int p = 0; p < info->parameter_count; ++p)
            print_parameter(file, &def, &info->parameters[p]);
    }
}

void cli_shape_help(FILE *file)
{
    fputs("\nshapes, with the defaults of their parameters:\n", file);
    print_shapes(file);
}

/* "key=value" as given after --set */
static pel_status apply_setting(pel_shape_def *def, const char *setting, pel_error *error)
{
    char key[PEL_NAME_SIZE];
    const char *equals = strchr(setting, '=');
    int length = (int)(equals - setting);
    snprintf(key, sizeof key, "%.*s", length < PEL_NAME_SIZE ? length : PEL_NAME_SIZE - 1, setting);
    return pel_shape_set(def, key, equals + 1, error);
}

static pel_status make_shape(const cli_call *call, pel_mesh **mesh, pel_error *error)
{
    pel_shape_def def;
    pel_status status = pel_shape_def_of_name(call->arguments[0], &def, error);
    for (int i = 0; status == PEL_OK && i < call->given_count; ++i) {
        if (strcmp(call->given[i].option->name, "set") == 0)
            status = apply_setting(&def, call->given[i].value, error);
    }
    return status == PEL_OK ? pel_shape_create(&def, mesh, error) : status;
}

int cli_shape(const cli_call *call)
{
    if (cli_has(call, "list")) {
        print_shapes(stdout);
        return CLI_DONE;
    }
    const char *path = cli_value(call, "output");
    if (call->arguments[0] == NULL)
        return cli_complain("'pellicle shape' needs the name of a shape. 'pellicle shape --list' prints them");
    if (path == NULL)
        return cli_complain("'pellicle shape' needs a file to write. add '-o %s.ply'", call->arguments[0]);
    pel_mesh_format format;
    if (!cli_output_format(call, path, &format))
        return CLI_BAD_INPUT;
    pel_mesh *mesh = NULL;
    pel_error error;
    if (make_shape(call, &mesh, &error) != PEL_OK)
        return cli_report(&error);
    int status = cli_write_mesh(path, format, mesh, &cli_notes, false);
    pel_mesh_destroy(mesh);
    return status;
}
