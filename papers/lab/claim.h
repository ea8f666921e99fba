/* Claims of an experiment: a statement of a paper, the theory or a reference, the numbers that are judged for it, and
   the verdict. Neither has a limit in number. When memory runs out the experiment fails (lab_experiment.is_incomplete),
   so that no number goes missing silently. */
#ifndef PAPERS_LAB_CLAIM_H
#define PAPERS_LAB_CLAIM_H

#include <stdbool.h>
#include <stddef.h>

typedef struct lab_experiment lab_experiment;

/* Source of a claim. */
typedef enum lab_origin {
    LAB_PAPER,      /* paper A or B says it */
    LAB_THEORY,     /* mechanics, a closed form */
    LAB_REFERENCE,  /* a computation apart from this program, or a published number of others */
    LAB_REGRESSION, /* an earlier result of this program: not a truth, but changes must be noticed */
    LAB_ORIGINS
} lab_origin;

typedef enum lab_relation { LAB_TOLD, LAB_EQUAL, LAB_AT_MOST, LAB_AT_LEAST } lab_relation;

/* A measured number and its expected value. */
typedef struct lab_finding {
    char name[96];
    double value, expected; /* expected is NaN if there is none */
    double tolerance;       /* LAB_EQUAL: largest difference that counts as equal */
    lab_relation relation;  /* LAB_TOLD = not judged */
    const char *source;     /* of the expected number; a literal */
    int claim;              /* that it is judged for */
} lab_finding;

/* Findings that are added after a claim are judged for it. */
typedef struct lab_claim {
    lab_origin origin;
    const char *says;     /* one sentence without a full stop; a literal */
    const char *reason;   /* why a paper's claim does not hold here, when that is known; nullable, a literal */
    bool by_construction; /* it holds by the layout of the program or of the experiment, so that it measures little */
    const char *built;    /* why; a literal */
} lab_claim;

typedef enum lab_verdict {
    LAB_ONLY_TOLD, /* nothing was judged */
    LAB_HOLDS,
    LAB_DIFFERS, /* a paper's claim that does not hold for a known reason, or on bodies of the user */
    LAB_FAILS
} lab_verdict;

/* Begins a claim. reason is nullable. */
void lab_begin_claim(lab_experiment *experiment, lab_origin origin, const char *says, const char *reason);
/* Marks the claim that was begun last: it holds by construction. why: a literal */
void lab_by_construction(lab_experiment *experiment, const char *why);
/* A number that has to be `expected` up to the tolerance. */
void lab_expect(lab_experiment *experiment, const char *name, double value, double expected, double tolerance,
                const char *source);
/* A number that has to be at most, or at least, `limit`. */
void lab_at_most(lab_experiment *experiment, const char *name, double value, double limit, const char *source);
void lab_at_least(lab_experiment *experiment, const char *name, double value, double limit, const char *source);
/* A number that is reported next to another one, or NaN, without a verdict: it depends on the machine, or on values
   missing in the paper. */
void lab_tell(lab_experiment *experiment, const char *name, double value, double expected, const char *source);

bool lab_finding_holds(const lab_finding *finding);
lab_verdict lab_claim_verdict(const lab_experiment *experiment, int claim);
/* the worst of its claims */
lab_verdict lab_experiment_verdict(const lab_experiment *experiment);
/* "holds (3 of 3)", "holds (3 of 3), by construction", "differs (1 of 3 hold): why"; returns text */
const char *lab_claim_text(const lab_experiment *experiment, int claim, char *text, size_t size);
const char *lab_verdict_name(lab_verdict verdict);
const char *lab_origin_name(lab_origin origin);
/* "beside", "=", "<=", ">=" */
const char *lab_relation_sign(lab_relation relation);

#endif
