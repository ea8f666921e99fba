/* The fit itself is Python's (pellicle.calibrate, on scipy); this finds a Python that has the package. */
#include "commands.h"
#include "diagnostics.h"

#include <pellicle/study.h>

#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

/* exit statuses of the package, in addition to those of the program */
enum { NO_PROGRAM = 127 };

enum { MOST_WORDS = 16 };

static int run_python(const char *python, char *const *words)
{
    int status;
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        execvp(python, words);
        _exit(NO_PROGRAM);
    }
    if (child < 0 || waitpid(child, &status, 0) < 0)
        return -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : CLI_FAILED;
}

static bool can_fit(const char *python)
{
    char name[4096];
    snprintf(name, sizeof name, "%s", python);
    char *words[] = {name, "-c", "import sys\ntry:\n    import pellicle, scipy\nexcept ImportError:\n    sys.exit(1)",
                     NULL};
    return run_python(python, words) == 0;
}

/* $PELLICLE_PYTHON, else the first that can do it */
static const char *find_python(void)
{
    static const char *const known[] = {"python3", "/usr/bin/python3"};
    const char *chosen = getenv("PELLICLE_PYTHON");
    if (chosen != NULL)
        return can_fit(chosen) ? chosen : NULL;
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (can_fit(known[i]))
            return known[i];
    return NULL;
}

int cli_calibrate(const cli_call *call)
{
    char *json, *words[MOST_WORDS];
    pel_error error;
    int count = 0;
    /* a wrong file is told without Python */
    if (pel_fit_load(call->arguments[0], &json, &error) != PEL_OK)
        return cli_report(&error);
    pel_fit_destroy(json);
    const char *python = find_python();
    if (python == NULL) {
        cli_complain("calibration needs a Python with the packages pellicle and scipy. install them with 'make python' "
                     "or 'pip install .', then name the program in the environment variable PELLICLE_PYTHON");
        return CLI_FAILED;
    }
    const char *output = cli_value(call, "output");
    words[count++] = (char *)python;
    words[count++] = "-m";
    words[count++] = "pellicle";
    words[count++] = "calibrate";
    words[count++] = (char *)call->arguments[0];
    if (output != NULL) {
        words[count++] = "--output";
        words[count++] = (char *)output;
    }
    if (cli_has(call, "json"))
        words[count++] = "--json";
    if (cli_has(call, "quiet"))
        words[count++] = "--quiet";
    words[count] = NULL;
    return run_python(python, words);
}
