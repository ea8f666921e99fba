/* Claims, the numbers that are judged for them, and the verdicts that follow. */
#include "papers/lab/experiment.h"

#include <math.h>
#include <stdio.h>

void lab_begin_claim(lab_experiment *experiment, lab_origin origin, const char *says, const char *reason)
{
    void *claims = experiment->claims;
    lab_claim *claim = lab_add_item(experiment, &claims, &experiment->claim_count, sizeof *claim);
    experiment->claims = claims;
    if (claim != NULL)
        *claim = (lab_claim){.origin = origin, .says = says, .reason = reason};
}

void lab_by_construction(lab_experiment *experiment, const char *why)
{
    if (experiment->claim_count == 0)
        return;
    lab_claim *claim = &experiment->claims[experiment->claim_count - 1];
    claim->by_construction = true;
    claim->built = why;
}

static void add(lab_experiment *experiment, const char *name, lab_finding finding)
{
    void *findings = experiment->findings;
    lab_finding *added = lab_add_item(experiment, &findings, &experiment->finding_count, sizeof *added);
    experiment->findings = findings;
    if (added == NULL)
        return;
    finding.claim = experiment->claim_count - 1;
    snprintf(finding.name, sizeof finding.name, "%s", name);
    *added = finding;
}

void lab_expect(lab_experiment *experiment, const char *name, double value, double expected, double tolerance,
                const char *source)
{
    add(experiment, name,
        (lab_finding){
            .value = value, .expected = expected, .tolerance = tolerance, .relation = LAB_EQUAL, .source = source});
}

void lab_at_most(lab_experiment *experiment, const char *name, double value, double limit, const char *source)
{
    add(experiment, name, (lab_finding){.value = value, .expected = limit, .relation = LAB_AT_MOST, .source = source});
}

void lab_at_least(lab_experiment *experiment, const char *name, double value, double limit, const char *source)
{
    add(experiment, name, (lab_finding){.value = value, .expected = limit, .relation = LAB_AT_LEAST, .source = source});
}

void lab_tell(lab_experiment *experiment, const char *name, double value, double expected, const char *source)
{
    add(experiment, name, (lab_finding){.value = value, .expected = expected, .relation = LAB_TOLD, .source = source});
}

bool lab_finding_holds(const lab_finding *finding)
{
    switch (finding->relation) {
    case LAB_EQUAL:
        return fabs(finding->value - finding->expected) <= finding->tolerance;
    case LAB_AT_MOST:
        return finding->value <= finding->expected;
    case LAB_AT_LEAST:
        return finding->value >= finding->expected;
    default:
        return true;
    }
}

/* how many findings are judged for a claim, and how many of them hold */
static void count(const lab_experiment *experiment, int claim, int *judged, int *held)
{
    *judged = *held = 0;
    for (int i = 0; i < experiment->finding_count; i++) {
        const lab_finding *finding = &experiment->findings[i];
        if (finding->claim != claim || finding->relation == LAB_TOLD)
            continue;
        ++*judged;
        *held += lab_finding_holds(finding);
    }
}

/* claims of a paper, and earlier results of this program, refer to their own bodies */
static bool is_excused(const lab_experiment *experiment, const lab_claim *claim)
{
    bool of_bodies = claim->origin == LAB_PAPER || claim->origin == LAB_REGRESSION;
    return (claim->origin == LAB_PAPER && claim->reason != NULL) || (of_bodies && experiment->given_bodies);
}

lab_verdict lab_claim_verdict(const lab_experiment *experiment, int claim)
{
    int judged, held;
    count(experiment, claim, &judged, &held);
    if (judged == 0)
        return LAB_ONLY_TOLD;
    if (held == judged)
        return LAB_HOLDS;
    return is_excused(experiment, &experiment->claims[claim]) ? LAB_DIFFERS : LAB_FAILS;
}

lab_verdict lab_experiment_verdict(const lab_experiment *experiment)
{
    lab_verdict worst = LAB_ONLY_TOLD;
    for (int i = 0; i < experiment->claim_count; i++) {
        lab_verdict verdict = lab_claim_verdict(experiment, i);
        worst = verdict > worst ? verdict : worst;
    }
    return worst;
}

const char *lab_verdict_name(lab_verdict verdict)
{
    static const char *const names[] = {"told", "holds", "differs", "fails"};
    return names[verdict];
}

const char *lab_origin_name(lab_origin origin)
{
    static const char *const names[LAB_ORIGINS] = {"paper", "theory", "reference", "regression"};
    return names[origin];
}

const char *lab_relation_sign(lab_relation relation)
{
    static const char *const signs[] = {"beside", "=", "<=", ">="};
    return signs[relation];
}

const char *lab_claim_text(const lab_experiment *experiment, int claim, char *text, size_t size)
{
    int judged, held;
    const lab_claim *said = &experiment->claims[claim];
    lab_verdict verdict = lab_claim_verdict(experiment, claim);
    count(experiment, claim, &judged, &held);
    if (verdict == LAB_ONLY_TOLD)
        snprintf(text, size, "told");
    else if (verdict == LAB_DIFFERS)
        snprintf(text, size, "differs (%d of %d hold)%s%s%s", held, judged,
                 experiment->given_bodies ? " on bodies that were given" : "",
                 said->reason == NULL       ? ""
                 : experiment->given_bodies ? "; on those of the program: "
                                            : ": ",
                 said->reason != NULL ? said->reason : "");
    else
        snprintf(text, size, "%s (%d of %d)%s%s", lab_verdict_name(verdict), held, judged,
                 said->by_construction ? ", by construction: " : "", said->by_construction ? said->built : "");
    return text;
}
