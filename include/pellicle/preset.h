/* Pellicle: presets of materials of thin sheets, for scenes (membrane: { preset: rubber }), with the sources of the
   numbers. The numbers are means of values that vary widely: use them as a first estimate, not as a measurement. */
#ifndef PELLICLE_PRESET_H
#define PELLICLE_PRESET_H

#include "material.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct pel_material_preset {
    const char *name; /* "rubber" */
    pel_membrane_material material;
    double density;     /* kg/m3 */
    double bending[2];  /* N m, flexural rigidity of warp and weft; 0 = that of the material */
    const char *doc;    /* description, one line */
    const char *source; /* of the numbers, one line */
} pel_material_preset;

/* All presets (*count of them); lives forever. */
PEL_API const pel_material_preset *pel_material_presets(int32_t *count);

/* The preset with this name; null if there is none. */
PEL_API const pel_material_preset *pel_material_preset_find(const char *name);

#ifdef __cplusplus
}
#endif
#endif
