#include "observe/field.h"

#include <string.h>

#define VERTICES PEL_FIELD_ON_VERTICES
#define BOTH PEL_FIELD_ON_BOTH

static const pel_field_info fields[PEL_FIELD_COUNT] = {
    {"displacement", 3, "m", VERTICES, "displacement from the rest position"},
    {"velocity", 3, "m/s", VERTICES, "velocity in the last step"},
    {"force", 3, "N", VERTICES,
     "sum of the forces of springs, shell, pressure, damping, loads and gravity; no contact"},
    {"energy", 1, "J", VERTICES,
     "elastic energy: sum of the next five fields, and a quarter of each tetrahedron at the vertex"},
    {"spring_energy", 1, "J", VERTICES, "half of the elastic energy of each spring at the vertex"},
    {"volumetric_energy", 1, "J", VERTICES, "elastic energy of the volumetric spring"},
    {"membrane_energy", 1, "J", VERTICES, "a third of the membrane energy of each triangle at the vertex"},
    {"bending_energy", 1, "J", VERTICES,
     "a quarter of the bending energy of each hinge at the vertex; with midedge a third of that of each triangle"},
    {"fibre_energy", 1, "J", VERTICES, "a third of the energy of the fibres of each triangle at the vertex"},
    {"pressure", 3, "N", VERTICES, "force of the pressure on the vertex (paper B, figure 2)"},
    {"contact", 1, "", VERTICES, "1 if a tool touches or holds the vertex, or a surface touches it; else 0"},
    {"contact_force", 3, "N", VERTICES,
     "force of contacts on the vertex: of bodies, tools and grasps; mean over the last step under methods with "
     "velocities"},
    {"reaction", 3, "N", VERTICES,
     "force on the vertex of pins, `support` and `supports`; the sum is minus the force of the body on its supports "
     "(BODY_support_force_x, _y, _z in series.csv)"},
    {"level", 1, "", VERTICES, "finest level of detail of the triangles at the vertex; 0: not refined"},
    {"area", 1, "m2", VERTICES, "area of the part of the surface that belongs to the vertex (mixed Voronoi area)"},
    {"normal", 3, "", VERTICES, "unit normal: mean of the normals of the triangles, weighted by their angles"},
    {"mean_curvature", 1, "1/m", VERTICES,
     "mean curvature, positive on a sphere (cotangent Laplacian); 0 on a boundary"},
    {"gaussian_curvature", 1, "1/m2", VERTICES, "Gaussian curvature (angle defect over area)"},
    {"stress", 1, "N/m", VERTICES,
     "mean tension of springs, membrane and fibres; positive if the surface is stretched. The virial, half of force "
     "times length of each spring at the vertex and a third of that of each triangle, over twice a third of the "
     "triangles' areas"},
    {"strain", 6, "", BOTH, "shell: Green strain, xx, yy, zz, xy, yz, xz in the plane at rest"},
    {"piola_stress", 6, "Pa", BOTH,
     "shell: second Piola-Kirchhoff stress of membrane and fibres, in the plane at rest"},
    {"cauchy_stress", 6, "Pa", BOTH, "shell: Cauchy (true) stress of membrane and fibres, in the present plane"},
    {"membrane_force", 6, "N/m", BOTH, "shell: membrane force N, the cauchy_stress times the present thickness"},
    {"bending_moment", 6, "N", BOTH, "shell: bending moment M per length, positive if it stretches the outer side"},
    {"principal_strain", 2, "", BOTH, "shell: principal values of the strain, larger first"},
    {"principal_stress", 2, "Pa", BOTH, "shell: principal values of the cauchy_stress, larger first"},
    {"principal_direction", 3, "", BOTH, "shell: unit direction of the larger principal stress"},
    {"von_mises_top", 1, "Pa", BOTH, "shell: von Mises stress on the outer side, from N / h + 6 M / h^2"},
    {"von_mises_bottom", 1, "Pa", BOTH, "shell: von Mises stress on the inner side, from N / h - 6 M / h^2"},
    {"membrane_energy_density", 1, "J/m2", BOTH, "shell: membrane energy per area at rest"},
    {"bending_energy_density", 1, "J/m2", BOTH, "shell: bending energy per area at rest"},
    {"fibre_energy_density", 1, "J/m2", BOTH, "shell: energy of fibres per area at rest"},
};

int32_t pel_field_count(void)
{
    return PEL_FIELD_COUNT;
}

const pel_field_info *pel_field_at(int32_t field)
{
    return field >= 0 && field < PEL_FIELD_COUNT ? &fields[field] : NULL;
}

int32_t pel_field_find(const char *name)
{
    if (name == NULL)
        return -1;
    for (int32_t f = 0; f < PEL_FIELD_COUNT; f++)
        if (strcmp(fields[f].name, name) == 0)
            return f;
    return -1;
}
