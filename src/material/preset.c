#include "pellicle/preset.h"

#include <string.h>

#define STVK PEL_MEMBRANE_STVK
#define MOONEY PEL_MEMBRANE_MOONEY_RIVLIN
#define NEO_HOOKEAN PEL_MEMBRANE_NEO_HOOKEAN

static const pel_material_preset presets[] = {
    {"lens-capsule",
     {STVK, 1.5e6, 0.47, 13e-6, 0},
     1050,
     "capsule of a human eye lens in old age, front pole",
     "young, poisson: Fisher 1969, J. Physiol. 201; thickness: Barraquer et al. 2006, IOVS 47; density: as soft "
     "tissue"},
    {"skin",
     {STVK, 1.3e5, 0.48, 1.5e-3, 0},
     1100,
     "skin of the forearm, small strains",
     "young: Diridollou et al. 2000, Skin Res. Technol. 6 (129 kPa by suction); thickness, density: usual values"},
    {"rubber",
     {MOONEY, 1.2e6, 0.5, 1e-3, 0.1},
     930,
     "vulcanised natural rubber sheet",
     "young: 3 x shear modulus 0.39 MPa of Treloar 1944, Trans. Faraday Soc. 40; thickness: chosen"},
    {"latex-balloon",
     {MOONEY, 9.9e5, 0.5, 2.5e-4, 0.1},
     930,
     "toy balloon before it is blown up",
     "Mueller, Strehlow 2004, Rubber and Rubber Balloons: s+ 3 bar, s- -0.3 bar; thickness: usual value"},
    {"silicone",
     {NEO_HOOKEAN, 1.2e5, 0.49, 2e-3, 0},
     1070,
     "very soft silicone rubber (shore 00-30)",
     "young: from the maker's stress at 100 % (69 kPa, Ecoflex 00-30) by neo-Hooke; density: the same sheet"},
    {"paper",
     {STVK, 3e9, 0.3, 1e-4, 0},
     800,
     "office paper, 80 g/m2, as if it were isotropic",
     "young: order of Alava, Niskanen 2006, Rep. Prog. Phys. 69; thickness, density: 80 g/m2 at 0.1 mm"},
    {"polyester-film",
     {STVK, 4.9e9, 0.38, 23e-6, 0},
     1390,
     "biaxially drawn PET film",
     "maker's data sheet of Mylar A (machine direction); poisson: usual value"},
    {"aluminium-foil",
     {STVK, 7e10, 0.33, 16e-6, 0},
     2700,
     "household foil; elastic only, it has no creases that stay",
     "young, poisson, density: Davis 1993, Aluminum and Aluminum Alloys; thickness: usual value"},
    {"steel-sheet",
     {STVK, 2.1e11, 0.3, 5e-4, 0},
     7850,
     "half a millimetre of structural steel",
     "young, poisson, density: EN 1993-1-1, 3.2.6; thickness: chosen"},
};

const pel_material_preset *pel_material_presets(int32_t *count)
{
    *count = (int32_t)(sizeof presets / sizeof presets[0]);
    return presets;
}

const pel_material_preset *pel_material_preset_find(const char *name)
{
    for (size_t i = 0; i < sizeof presets / sizeof presets[0]; i++)
        if (strcmp(presets[i].name, name) == 0)
            return &presets[i];
    return NULL;
}
