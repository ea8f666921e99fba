/* Claims, the numbers that are judged for them, and the verdicts that follow. */
#include "experiment.h"

#include <math.h>
#include <string.h>

void cli_experiment_claim(cli_experiment *experiment, cli_origin origin, const char *says, const char *reason)
{
    if (experiment->claim_count == CLI_EXPERIMENT_CLAIMS)
        return;
    experiment->claims[experiment->claim_count++] = (cli_claim){origin, says, reason};
}

static void add(cli_experiment *experiment, const char *name, cli_finding finding)
{
    if (experiment->finding_count == CLI_EXPERIMENT_NUMBERS)
        return;
    finding.claim = experiment->claim_count - 1;
    snprintf(finding.name, sizeof finding.name, "%s", name);
    experiment->findings[experiment->finding_count++] = finding;
}

void cli_experiment_check(cli_experiment *experiment, const char *name, double value, double expected, double tolerance,
                          const char *source)
{
    add(experiment, name,
        (cli_finding){
            .value = value, .expected = expected, .tolerance = tolerance, .relation = CLI_EQUAL, .source = source});
}

void cli_experiment_limit(cli_experiment *experiment, const char *name, double value, double limit, const char *source)
{
    add(experiment, name, (cli_finding){.value = value, .expected = limit, .relation = CLI_AT_MOST, .source = source});
}

void cli_experiment_least(cli_experiment *experiment, const char *name, double value, double limit, const char *source)
{
    add(experiment, name, (cli_finding){.value = value, .expected = limit, .relation = CLI_AT_LEAST, .source = source});
}

void cli_experiment_tell(cli_experiment *experiment, const char *name, double value, double expected,
                         const char *source)
{
    add(experiment, name, (cli_finding){.value = value, .expected = expected, .relation = CLI_TOLD, .source = source});
}

bool cli_finding_holds(const cli_finding *finding)
{
    switch (finding->relation) {
    case CLI_EQUAL:
        return fabs(finding->value - finding->expected) <= finding->tolerance;
    case CLI_AT_MOST:
        return finding->value <= finding->expected;
    case CLI_AT_LEAST:
        return finding->value >= finding->expected;
    default:
        return true;
    }
}

/* how many findings are judged for a claim, and how many of them hold */
static void count(const cli_experiment *experiment, int claim, int *judged, int *held)
{
    *judged = *held = 0;
    for (int i = 0; i < experiment->finding_count; i++) {
        const cli_finding *finding = &experiment->findings[i];
        if (finding->claim != claim || finding->relation == CLI_TOLD)
            continue;
        ++*judged;
        *held += cli_finding_holds(finding);
    }
}

/* claims of a paper, and earlier results of this program, refer to their own bodies */
static bool is_excused(const cli_experiment *experiment, const cli_claim *claim)
{
    bool of_bodies = claim->origin == CLI_PAPER || claim->origin == CLI_REGRESSION;
    return (claim->origin == CLI_PAPER && claim->reason != NULL) || (of_bodies && experiment->given_mesh);
}

cli_verdict cli_claim_verdict(const cli_experiment *experiment, int claim)
{
    int judged, held;
    count(experiment, claim, &judged, &held);
    if (judged == 0)
        return CLI_ONLY_TOLD;
    if (held == judged)
        return CLI_HOLDS;
    return is_excused(experiment, &experiment->claims[claim]) ? CLI_DIFFERS : CLI_FAILS;
}

cli_verdict cli_experiment_verdict(const cli_experiment *experiment)
{
    cli_verdict worst = CLI_ONLY_TOLD;
    for (int i = 0; i < experiment->claim_count; i++) {
        cli_verdict verdict = cli_claim_verdict(experiment, i);
        worst = verdict > worst ? verdict : worst;
    }
    return worst;
}

const char *cli_verdict_name(cli_verdict verdict)
{
    static const char *const names[] = {"told", "holds", "differs", "fails"};
    return names[verdict];
}

const char *cli_origin_name(cli_origin origin)
{
    static const char *const names[CLI_ORIGINS] = {"paper", "theory", "reference", "regression"};
    return names[origin];
}

const char *cli_claim_text(const cli_experiment *experiment, int claim, char *text, size_t size)
{
    int judged, held;
    const cli_claim *said = &experiment->claims[claim];
    cli_verdict verdict = cli_claim_verdict(experiment, claim);
    count(experiment, claim, &judged, &held);
    if (verdict == CLI_ONLY_TOLD)
        snprintf(text, size, "told");
    else if (verdict == CLI_DIFFERS)
        snprintf(text, size, "differs (%d of %d hold): %s", held, judged,
                 said->reason != NULL ? said->reason : "not on the mesh that was given");
    else
        snprintf(text, size, "%s (%d of %d)", cli_verdict_name(verdict), held, judged);
    return text;
}
