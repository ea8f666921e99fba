#include "papers/lab/stored.h"

#include <math.h>
#include <string.h>

/* of a number */
#define STORED_TOLERANCE 0.01

static const lab_stored stored[] = {
#include "papers/lab/numbers.inc"
};

int lab_stored_numbers(const lab_stored **numbers)
{
    *numbers = stored;
    return (int)(sizeof stored / sizeof *stored);
}

static const lab_finding *find(const lab_experiment *experiment, const char *name)
{
    for (int i = 0; i < experiment->finding_count; i++)
        if (strcmp(experiment->findings[i].name, name) == 0)
            return &experiment->findings[i];
    return NULL;
}

void lab_judge_stored(lab_experiment *experiment, const lab_stored *numbers, int count)
{
    int known = 0, other = 0;
    for (int i = 0; i < count; i++)
        known += strcmp(numbers[i].experiment, experiment->name) == 0;
    if (known == 0)
        return;
    lab_begin_claim(experiment, LAB_REGRESSION, "all numbers are those of the version before, within 1 %", NULL);
    for (int i = 0; i < count; i++) {
        if (strcmp(numbers[i].experiment, experiment->name) != 0)
            continue;
        const lab_finding *finding = find(experiment, numbers[i].finding);
        double value = finding != NULL ? finding->value : (double)NAN;
        if (fabs(value - numbers[i].value) <= STORED_TOLERANCE * fabs(numbers[i].value))
            continue;
        other++;
        lab_expect(experiment, numbers[i].finding, value, numbers[i].value, STORED_TOLERANCE * fabs(numbers[i].value),
                   "version before");
    }
    lab_at_most(experiment, "numbers that differ", other, 0, "version before");
    lab_tell(experiment, "numbers that are compared", known, (double)NAN, "");
}
