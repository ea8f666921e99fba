#include "pellicle/preset.h"

#include <string.h>

#define NEO_HOOKEAN(e, nu, h)                                                                                          \
    {                                                                                                                  \
        .kind = PEL_MEMBRANE_NEO_HOOKEAN, .young = (e), .poisson = (nu), .thickness = (h)                              \
    }
#define MOONEY(e, nu, h, ratio)                                                                                        \
    {                                                                                                                  \
        .kind = PEL_MEMBRANE_MOONEY_RIVLIN, .young = (e), .poisson = (nu), .thickness = (h), .mooney_ratio = (ratio)   \
    }
/* Cloth that was measured as C11, C22, C12 and C33 [N/m] at small strain, the warp being the stiffer direction. */
#define WOVEN(c11, c22, c12, c33, h)                                                                                   \
    {                                                                                                                  \
        .kind = PEL_MEMBRANE_ORTHOTROPIC, .young = ((c11) - (c12) * (c12) / (c22)) / (h),                              \
        .weft = ((c22) - (c12) * (c12) / (c11)) / (h), .poisson = (c12) / (c22), .shear = (c33) / (h),                 \
        .thickness = (h)                                                                                               \
    }

/* Values without a source are called illustrative. "Order of magnitude": the work treats this kind of material but does
   not state the number itself. */
static const pel_material_preset presets[] = {
    {"lens-capsule",
     NEO_HOOKEAN(1.5e6, 0.47, 15e-6),
     1050,
     {0, 0},
     "capsule of a human eye lens in old age, front pole",
     "young, poisson: Fisher 1969, J. Physiol. 201:1 (6 MPa in childhood, 3 at 60 years, 1.5 in extreme old age; "
     "0.47 at all ages); thickness: Barraquer et al. 2006, IOVS 47:2053 (11 to 15 um at the front pole, rising with "
     "age); density: illustrative"},
    {"skin",
     NEO_HOOKEAN(1.29e5, 0.48, 1.5e-3),
     1100,
     {0, 0},
     "skin of the forearm, small strains",
     "young: Diridollou et al. 2000, Skin Res. Technol. 6:214 (129 +- 88 kPa by suction, 10 men); thickness, density: "
     "in the ranges of Ye, De 2017, Burns 43:909, table 1 (dermis 1 to 4 mm, skin 1093 to 1190 kg/m3); poisson: "
     "illustrative, nearly incompressible"},
    {"rubber",
     MOONEY(3 * 0.39e6, 0.5, 1e-3, 0.1),
     930,
     {0, 0},
     "vulcanised natural rubber sheet",
     "young: order of magnitude, three times a shear modulus of 0.39 MPa, as theory is usually fitted to the 8 % "
     "sulphur rubber of Treloar 1944, Trans. Faraday Soc. 40:59; ratio: as latex-balloon; density: natural rubber; "
     "thickness: illustrative"},
    {"latex-balloon",
     MOONEY(3 * (3e5 + 0.3e5), 0.5, 2.5e-4, 0.1),
     930,
     {0, 0},
     "toy balloon before it is blown up",
     "young, ratio: order of magnitude, after the Mooney-Rivlin balloons of Mueller, Strehlow 2004, Rubber and Rubber "
     "Balloons, Lecture Notes in Physics 637 (s+ of 3 bar, s- a tenth of it: a shear modulus of 0.33 MPa); density: "
     "natural rubber; thickness: illustrative"},
    {"silicone",
     NEO_HOOKEAN(1.18e5, 0.49, 2e-3),
     1070,
     {0, 0},
     "very soft silicone rubber (shore 00-30)",
     "young, density: order of magnitude, what makers of such rubbers state (69 kPa at 100 % stretch, which neo-Hooke "
     "gives for a shear modulus of 39 kPa; 1.07 g/cm3); poisson: nearly incompressible; thickness: illustrative"},
    {"paper",
     NEO_HOOKEAN(3e9, 0.3, 1e-4),
     800,
     {0, 0},
     "office paper, 80 g/m2, as if it were isotropic",
     "density: 80 g/m2 at 0.1 mm; young: order of magnitude, machine-made paper is stiffer along the machine and "
     "softer across; poisson: illustrative"},
    {"polyester-film",
     NEO_HOOKEAN(4.9e9, 0.38, 23e-6),
     1390,
     {0, 0},
     "biaxially drawn PET film",
     "all: data sheet H-37232-3 of Mylar 92A, DuPont Teijin Films (710 and 740 kpsi along and across: 4.9 and 5.1 GPa; "
     "0.38 before it yields; 1.390 g/cm3; gauge 92 is 23 um)"},
    {"aluminium-foil",
     NEO_HOOKEAN(7e10, 0.33, 16e-6),
     2700,
     {0, 0},
     "household foil; elastic only, it has no creases that stay",
     "young, poisson, density: as handbooks give them for aluminium; thickness: standard household foil, 0.016 mm"},
    {"steel-sheet",
     NEO_HOOKEAN(2.1e11, 0.3, 5e-4),
     7850,
     {0, 0},
     "half a millimetre of structural steel",
     "young, poisson: EN 1993-1-1, 3.2.6; density: EN 1991-1-1, table A.4 (77 to 78.5 kN/m3); thickness: illustrative"},
    {"denim",
     WOVEN(1013.89, 205.352, 10.2341, 53.3872, 8e-4),
     0.324 / 8e-4,
     {64.1965e-6, 19.8247e-6},
     "denim of 11 oz: 99 % cotton, 1 % spandex",
     "stiffness: sample 11oz-black-denim of Wang, O'Brien, Ramamoorthi 2011, ACM Trans. Graph. 30(4):71, at small "
     "strain (C11, C22, C12, C33 "
     "of 1014, 205, 10.2 and 53.4 N/m; bending of 64.2e-6 and 19.8e-6 N m), as its authors give it for ARCSim; mass: "
     "the same, 0.324 kg/m2; thickness: illustrative, "
     "young, weft, shear and density are per thickness"},
    {"tablecloth",
     WOVEN(2027.49, 2002.09, 0.345588, 19.189, 2.5e-4),
     0.128 / 2.5e-4,
     {51.7138e-6, 15.2217e-6},
     "woven polyester of a tablecloth, which shears a hundred times more easily than it stretches",
     "stiffness: sample white-dots-on-blk of Wang, O'Brien, Ramamoorthi 2011, ACM Trans. Graph. 30(4):71, at small "
     "strain (C11, C22, C12, C33 "
     "of 2027, 2002, 0.35 and 19.2 N/m; bending of 51.7e-6 and 15.2e-6 N m), as its authors give it for ARCSim; mass: "
     "the same, 0.128 kg/m2; thickness: illustrative, "
     "young, weft, shear and density are per thickness"},
    {"rib-knit",
     WOVEN(65.166, 42.871, -0.234556, 83.1756, 1e-3),
     0.276 / 1e-3,
     {46.2376e-6, 80.7267e-6},
     "rib knit of underwear: 95 % cotton, 5 % spandex",
     "stiffness: sample ivory-rib-knit of Wang, O'Brien, Ramamoorthi 2011, ACM Trans. Graph. 30(4):71, at small strain "
     "(C11, C22, C12, C33 "
     "of 65.2, 42.9, -0.23 and 83.2 N/m; bending of 46.2e-6 and 80.7e-6 N m), as its authors give it for ARCSim; mass: "
     "the same, 0.276 kg/m2; thickness: illustrative, "
     "young, weft, shear and density are per thickness"},
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
