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
    {"bending_energy", 1, "J",
     "a quarter of the bending energy of each hinge at the vertex, a third of that of each triangle of "
     "midedge"},
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
     "mean tension of springs, membrane and fibres: half of force times length of each spring at the vertex, and a "
     "third "
     "of that of each triangle, over twice a third of the triangles' areas; positive where it is stretched"},
    {"strain", 6, "", "shell: Green strain, xx, yy, zz, xy, yz, xz in the plane at rest"},
    {"piola_stress", 6, "Pa", "shell: second Piola-Kirchhoff stress of membrane and fibres, in the plane at rest"},
    {"cauchy_stress", 6, "Pa", "shell: true stress of membrane and fibres, in the present plane"},
    {"membrane_force", 6, "N/m", "shell: resultant N, the cauchy_stress times the present thickness"},
    {"bending_moment", 6, "N", "shell: resultant M of bending, positive where it stretches the outer side"},
    {"principal_strain", 2, "", "shell: principal values of the strain, larger first"},
    {"principal_stress", 2, "Pa", "shell: principal values of the cauchy_stress, larger first"},
    {"principal_direction", 3, "", "shell: unit direction of the larger principal stress"},
    {"von_mises_top", 1, "Pa", "shell: von Mises stress on the outer side, from N / h + 6 M / h^2"},
    {"von_mises_bottom", 1, "Pa", "shell: von Mises stress on the inner side, from N / h - 6 M / h^2"},
    {"membrane_energy_density", 1, "J/m2", "shell: membrane energy per area at rest"},
    {"bending_energy_density", 1, "J/m2", "shell: bending energy per area at rest"},
    {"fibre_energy_density", 1, "J/m2", "shell: energy of fibres per area at rest"},
};

int pel_run_field_find(const char *name)
{
    int field = 0;
    while (field < PEL_RUN_FIELD_COUNT && strcmp(pel_run_fields[field].name, name) != 0)
        field++;
    return field;
}
