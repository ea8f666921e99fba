/* What a state remembers of sheets that yield or grow: of each hinge its fold (measure/fold.h), of each triangle its
   flow. */
#ifndef PEL_MEASURE_PLASTIC_H
#define PEL_MEASURE_PLASTIC_H

#include "measure/fold.h"

/* a triangle of a sheet that yields (law/elastoplastic.h) or grows */
typedef struct pel_flow {
    double inverse[3]; /* of the matrix of its present shape without stress, as of pel_rest_triangle [1/m] */
    double slip;       /* plastic strain, summed up */
    double growth;     /* of its area without stress; slip alone leaves it 1 */
} pel_flow;

/* of all bodies; both null where none yields or grows */
typedef struct pel_plastic {
    pel_fold *folds; /* (pel_model_fold_count) */
    pel_flow *flows; /* (pel_model_flow_count) */
} pel_plastic;

#endif
