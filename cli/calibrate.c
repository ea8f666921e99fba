/* The fit itself is Python's (pellicle.calibrate, on scipy); this finds a Python that has the package. */
#include "commands.h"
#include "diagnostics.h"

#include <pellicle/study.h>

#include <limits.h>
#include <stdlib.h>
#include <string.h>
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
    char *words[] = {name, "-P", "-c",
                     "import sys\ntry:\n    import pellicle, scipy\nexcept ImportError:\n    sys.exit(1)", NULL};
    return run_python(python, words) == 0;
}

/* $PELLICLE_PYTHON, else the first that can do it */
static const char *find_python(void)
{
    static const char *const known[] = {"python3", "/usr/bin/python3"};
    static const char *const beside[] = {"venv/bin/python3", "../venv/bin/python3", "python3"};
    static char path[PATH_MAX + 32];
    char program[PATH_MAX] = "";
    const char *chosen = getenv("PELLICLE_PYTHON");
    if (chosen != NULL)
        return can_fit(chosen) ? chosen : NULL;
    /* that of `make python` or of the wheel, beside the program */
    const ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    char *slash = length > 0 ? strrchr(program, '/') : NULL;
    for (size_t i = 0; slash != NULL && i < sizeof beside / sizeof *beside; i++) {
        snprintf(path, sizeof path, "%.*s/%s", (int)(slash - program), program, beside[i]);
        if (access(path, X_OK) == 0 && can_fit(path))
            return path;
    }
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
        cli_complain("calibration needs a Python of 3.11 or later with the packages pellicle and scipy. install them "
                     "with 'make python' "
                     "or 'pip install .', then name the program in the environment variable PELLICLE_PYTHON");
        return CLI_FAILED;
    }
    const char *output = cli_value(call, "output");
    words[count++] = (char *)python;
    words[count++] = "-P";
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
    const int status = run_python(python, words);
    char result[PATH_MAX];
    if (status == CLI_DONE && output != NULL &&
        (snprintf(result, sizeof result, "%s/fit.json", output) >= (int)sizeof result || access(result, R_OK) != 0)) {
        cli_complain("%s ended without a result: there is no %s. check what it imports", python, result);
        return CLI_FAILED;
    }
    return status;
}
