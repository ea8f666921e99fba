#include "stage/stepper.h"

const pel_stepper *pel_stepper_of(pel_method method)
{
    static const pel_stepper *const kinds[] = {
        [PEL_METHOD_QUASI_STATIC] = &pel_step_quasi_static_kind,
        [PEL_METHOD_EXPLICIT] = &pel_step_explicit_kind,
        [PEL_METHOD_PBD] = &pel_project_pbd_kind,
        [PEL_METHOD_PBD_DISTANCE] = &pel_project_distance_kind,
        [PEL_METHOD_XPBD] = &pel_project_xpbd_kind,
        [PEL_METHOD_DESCENT] = &pel_step_descent_kind,
        [PEL_METHOD_STATIC] = &pel_step_static_kind,
        [PEL_METHOD_IMPLICIT] = &pel_step_implicit_kind,
    };
    return kinds[method];
}
