#include "results/fields.h"

#include <string.h>

const pel_run_field_info pel_run_fields[PEL_RUN_FIELD_COUNT] = {
    {"displacement", 3, "m", "way from the place at rest"},
    {"velocity", 3, "m/s", "velocity in the last step"},
    {"force", 3, "N", "sum of the forces of springs, shell, pressure, damping, loads and gravity; no contact"},
    {"energy", 1, "J", "elastic energy: the sum of the five that follow"},
    {"spring_energy", 1, "J", "half of the elastic energy of each spring at the vertex"},
    {"volumetric_energy", 1, "J", "elastic energy of the volumetric spring"},
    {"membrane_energy", 1, "J", "a third of the membrane energy of each triangle at the vertex"},
    {"bending_energy", 1, "J", "a quarter of the bending energy of each hinge at the vertex"},
    {"fibre_energy", 1, "J", "a third of the energy of the fibres of each triangle at the vertex"},
    {"pressure", 3, "N", "force of the pressure on the vertex (paper B, figure 2)"},
    {"contact", 1, "", "1 where a tool touches or holds the vertex, or a surface touches it, else 0"},
    {"contact_force", 3, "N",
     "force of contacts on the vertex: of bodies, tools and grasps; mean over the last step where the method has "
     "velocities"},
    {"area", 1, "m2", "area of the surface that is nearest to the vertex (mixed Voronoi area)"},
    {"normal", 3, "", "unit normal, triangles weighted by their angle"},
    {"mean_curvature", 1, "1/m", "mean curvature, positive on a sphere (cotangent Laplacian); 0 on a boundary"},
    {"gaussian_curvature", 1, "1/m2", "Gaussian curvature (angle defect over area)"},
    {"stress", 1, "N/m",
     "mean tension of springs and membrane: half of force times length of each spring at the vertex, and a third of "
     "that "
     "of each triangle, over twice its area; positive where it is stretched"},
};

int pel_run_field_find(const char *name)
{
    int field = 0;
    while (field < PEL_RUN_FIELD_COUNT && strcmp(pel_run_fields[field].name, name) != 0)
        field++;
    return field;
}
