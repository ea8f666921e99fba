/* All membrane laws, and the one of a kind that is known when the kernel is compiled. */
#ifndef PEL_LAW_LAWS_H
#define PEL_LAW_LAWS_H

#include "law/files.h"
#include "pellicle/kinds.h"

PEL_INLINE void pel_respond(pel_membrane_kind kind, const pel_lane *numbers, const pel_strain *s, pel_response *r)
{
    switch (kind) {
#define PEL_RESPOND(KIND, law, name)                                                                                   \
    case PEL_MEMBRANE_##KIND:                                                                                          \
        pel_law_##law(numbers, s, r);                                                                                  \
        return;
        PEL_MEMBRANE_LAWS(PEL_RESPOND)
#undef PEL_RESPOND
    }
    *r = (pel_response){.energy = pel_lane_splat(0)}; /* no law */
}

PEL_INLINE int pel_law_traits(pel_membrane_kind kind)
{
    switch (kind) {
#define PEL_TRAITS(KIND, law, name)                                                                                    \
    case PEL_MEMBRANE_##KIND:                                                                                          \
        return pel_law_##law##_traits;
        PEL_MEMBRANE_LAWS(PEL_TRAITS)
#undef PEL_TRAITS
    }
    return 0;
}

#endif
