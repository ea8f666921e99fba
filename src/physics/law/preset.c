#include "pellicle/preset.h"

#include <string.h>

#define MOONEY PEL_MEMBRANE_MOONEY_RIVLIN
#define NEO_HOOKEAN PEL_MEMBRANE_NEO_HOOKEAN

/* Values without a source are called illustrative. "Order of magnitude": the work treats this kind of material but does
   not state the number itself. */
static const pel_material_preset presets[] = {
    {"lens-capsule",
     {NEO_HOOKEAN, 1.5e6, 0.47, 15e-6, 0, 0, 0},
     1050,
     "capsule of a human eye lens in old age, front pole",
     "young, poisson: Fisher 1969, J. Physiol. 201:1 (6 MPa in childhood, 3 at 60 years, 1.5 in extreme old age; "
     "0.47 at all ages); thickness: Barraquer et al. 2006, IOVS 47:2053 (11 to 15 um at the front pole, rising with "
     "age); density: illustrative"},
    {"skin",
     {NEO_HOOKEAN, 1.29e5, 0.48, 1.5e-3, 0, 0, 0},
     1100,
     "skin of the forearm, small strains",
     "young: Diridollou et al. 2000, Skin Res. Technol. 6:214 (129 +- 88 kPa by suction, 10 men); thickness, density: "
     "in the ranges of Ye, De 2017, Burns 43:909, table 1 (dermis 1 to 4 mm, skin 1093 to 1190 kg/m3); poisson: "
     "illustrative, nearly incompressible"},
    {"rubber",
     {MOONEY, 3 * 0.39e6, 0.5, 1e-3, 0.1, 0, 0},
     930,
     "vulcanised natural rubber sheet",
     "young: order of magnitude, three times a shear modulus of 0.39 MPa, as theory is usually fitted to the 8 % "
     "sulphur rubber of Treloar 1944, Trans. Faraday Soc. 40:59; ratio: as latex-balloon; density: natural rubber; "
     "thickness: illustrative"},
    {"latex-balloon",
     {MOONEY, 3 * (3e5 + 0.3e5), 0.5, 2.5e-4, 0.1, 0, 0},
     930,
     "toy balloon before it is blown up",
     "young, ratio: order of magnitude, after the Mooney-Rivlin balloons of Mueller, Strehlow 2004, Rubber and Rubber "
     "Balloons, Lecture Notes in Physics 637 (s+ of 3 bar, s- a tenth of it: a shear modulus of 0.33 MPa); density: "
     "natural rubber; thickness: illustrative"},
    {"silicone",
     {NEO_HOOKEAN, 1.18e5, 0.49, 2e-3, 0, 0, 0},
     1070,
     "very soft silicone rubber (shore 00-30)",
     "young, density: order of magnitude, what makers of such rubbers state (69 kPa at 100 % stretch, which neo-Hooke "
     "gives for a shear modulus of 39 kPa; 1.07 g/cm3); poisson: nearly incompressible; thickness: illustrative"},
    {"paper",
     {NEO_HOOKEAN, 3e9, 0.3, 1e-4, 0, 0, 0},
     800,
     "office paper, 80 g/m2, as if it were isotropic",
     "density: 80 g/m2 at 0.1 mm; young: order of magnitude, machine-made paper is stiffer along the machine and "
     "softer across; poisson: illustrative"},
    {"polyester-film",
     {NEO_HOOKEAN, 4.9e9, 0.38, 23e-6, 0, 0, 0},
     1390,
     "biaxially drawn PET film",
     "all: data sheet H-37232-3 of Mylar 92A, DuPont Teijin Films (710 and 740 kpsi along and across: 4.9 and 5.1 GPa; "
     "0.38 before it yields; 1.390 g/cm3; gauge 92 is 23 um)"},
    {"aluminium-foil",
     {NEO_HOOKEAN, 7e10, 0.33, 16e-6, 0, 0, 0},
     2700,
     "household foil; elastic only, it has no creases that stay",
     "young, poisson, density: as handbooks give them for aluminium; thickness: standard household foil, 0.016 mm"},
    {"steel-sheet",
     {NEO_HOOKEAN, 2.1e11, 0.3, 5e-4, 0, 0, 0},
     7850,
     "half a millimetre of structural steel",
     "young, poisson: EN 1993-1-1, 3.2.6; density: EN 1991-1-1, table A.4 (77 to 78.5 kN/m3); thickness: illustrative"},
};

const pel_material_preset *pel_material_presets(int32_t *count)
{
    if (count != NULL)
        *count = (int32_t)(sizeof presets / sizeof presets[0]);
    return presets;
}

const pel_material_preset *pel_material_preset_find(const char *name)
{
    if (name == NULL)
        return NULL;
    for (size_t i = 0; i < sizeof presets / sizeof presets[0]; i++)
        if (strcmp(presets[i].name, name) == 0)
            return &presets[i];
    return NULL;
}
