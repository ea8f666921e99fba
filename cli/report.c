#include "commands.h"
#include "diagnostics.h"

#include <pellicle/report.h>

#include <stdlib.h>
#include <string.h>

enum { PATH_SIZE = 4096 };

static int write_report(const cli_call *call, const pel_report_def *def)
{
    char inside[PATH_SIZE];
    const char *out = cli_value(call, "output");
    if (out == NULL) {
        if (snprintf(inside, sizeof inside, "%s/report.html", def->folders[0]) >= (int)sizeof inside)
            return cli_complain("the name of the folder is too long. name the page with -o");
        out = inside;
    }
    pel_report_summary summary;
    pel_error error;
    if (pel_report_write(out, def, &summary, &error) != PEL_OK)
        return cli_report(&error);
    if (!cli_has(call, "quiet"))
        printf("%s: %d %s, %lld of %lld frames, %.1f MB\n", out, (int)def->folder_count,
               def->folder_count == 1 ? "run" : "runs", (long long)summary.frame_count, (long long)summary.frame_total,
               1e-6 * (double)summary.size);
    return CLI_DONE;
}

int cli_report_page(const cli_call *call)
{
    char page[PATH_SIZE];
    pel_report_def def = pel_report_def_default();
    def.page = cli_value(call, "page");
    if (def.page == NULL)
        def.page = cli_share_path(page, sizeof page, "report.html");
    if (def.page == NULL)
        return cli_complain("the report page has not been built. build it once with 'make web' (it takes the Debian "
                            "packages nodejs and npm), then 'make install', or name it with --page");
    if (cli_has(call, "limit"))
        def.size_limit = (int64_t)1000000 * cli_count(call, "limit");
    if (!cli_has(call, "quiet"))
        def.log = &cli_notes;
    size_t room = (size_t)call->given_count + 1;
    const char **names = calloc(room, sizeof *names);
    if (names == NULL) {
        cli_complain("out of memory");
        return CLI_FAILED;
    }
    def.folders = call->arguments;
    def.folder_count = call->argument_count;
    def.fields = names;
    def.field_count = cli_values(call, "field", names);
    int status = write_report(call, &def);
    free(names);
    return status;
}
