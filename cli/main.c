#include "commands.h"
#include "help.h"

#include <pellicle/base.h>
#include <pellicle/import.h>

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* A standard stream that whoever started the program closed: the next file that is opened would take its number, and
   messages would be written into that file. What is written to such a stream fails. */
static void keep_standard_streams(void)
{
    int number = open("/dev/null", O_RDONLY);
    while (number >= 0 && number < 3)
        number = open("/dev/null", O_RDONLY);
    if (number >= 3)
        close(number);
}

/* output that did not reach its place (disk full, closed pipe) is a failure */
static int close_output(int status)
{
    if (fflush(stdout) == 0 && ferror(stdout) == 0)
        return status;
    cli_complain("standard output: %s. free some space or send it elsewhere", strerror(errno));
    return CLI_FAILED;
}

static int run_command(const cli_command *command, int count, char *const *arguments)
{
    cli_given *given = calloc((size_t)count + 1, sizeof *given);
    if (given == NULL) {
        cli_complain("out of memory");
        return CLI_FAILED;
    }
    cli_call call;
    bool help = false;
    int status = CLI_BAD_INPUT;
    if (cli_parse(command, count, arguments, given, &call, &help)) {
        status = CLI_DONE;
        if (help)
            cli_print_help(stdout, command);
        else
            status = command->run(&call);
    }
    free(given);
    return status;
}

static int unknown_command(const char *name)
{
    const char *nearest = cli_nearest(name, cli_command_names);
    if (nearest != NULL)
        return cli_complain("unknown command '%s'. did you mean '%s'?", name, nearest);
    return cli_complain("unknown command '%s'. 'pellicle --help' lists the commands", name);
}

int main(int argc, char **argv)
{
    const char *first = argc > 1 ? argv[1] : "";
    keep_standard_streams();
    /* a file beyond `ulimit -f` is a failed write with a message, as on a full disk */
    signal(SIGXFSZ, SIG_IGN);
    if (*first == '\0') {
        cli_print_overview(stderr);
        return CLI_BAD_INPUT;
    }
    if (strcmp(first, "--help") == 0 || strcmp(first, "-h") == 0) {
        cli_print_overview(stdout);
        return close_output(CLI_DONE);
    }
    if (strcmp(first, "--version") == 0 || strcmp(first, "-V") == 0) {
        puts("pellicle " PEL_VERSION);
        return close_output(CLI_DONE);
    }
    /* hidden: started by pel_mesh_import */
    if (argc == 3 && strcmp(first, "--import-child") == 0)
        return pel_mesh_import_child(argv[2]);
    const cli_command *command = cli_command_find(first);
    if (command == NULL)
        return unknown_command(first);
    return close_output(run_command(command, argc - 2, argv + 2));
}
