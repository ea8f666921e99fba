#include "commands.h"
#include "common.h"

int cli_run(const cli_call *call)
{
    (void)call;
    return cli_complain("this build has no runs yet. merge the results branch");
}
