/* Masses and springs of a body, with default sizes from the mesh: so any mesh has the response of its tissue,
   independent of size and fineness. */
#include "scene/build.h"
#include "scene/table.h"

#include "pellicle/measure.h"
#include "pellicle/topology.h"

#include <math.h>

/* a closed surface that encloses less than this share of area^1.5 is flat; a ball has 0.094 */
#define LEAST_FILLING 1e-6
/* thickness of the skin and of open sheets, over the radius */
#define SKIN_SHARE 0.1

typedef struct body_size {
    double radius; /* of a ball with the same volume over area, or, of an open surface, with the same area [m] */
    double filled; /* thickness of a sheet with the mass of the filling or, for an open surface, of the skin */
} body_size;

/* a mesh that has no topology is told by the model, with its element */
static pel_status is_closed(const pel_mesh *mesh, bool *closed, pel_error *error)
{
    pel_topology *topology = NULL;
    pel_status status = pel_topology_create(mesh, &topology, error);
    *closed = status == PEL_OK && topology->boundary_edge_count == 0;
    pel_topology_destroy(topology);
    return status == PEL_OUT_OF_MEMORY ? status : PEL_OK;
}

static pel_status measure(const pel_scene_body_source *source, body_size *size)
{
    const pel_mesh *mesh = source->mesh;
    bool closed;
    pel_status status = is_closed(mesh, &closed, source->reader->error);
    if (status != PEL_OK)
        return status;
    double area = pel_surface_area(mesh->positions[0], mesh->triangles[0], mesh->triangle_count);
    double volume = fabs(pel_surface_volume(mesh->positions[0], mesh->triangles[0], mesh->triangle_count, NULL));
    bool is_filled = closed && volume > LEAST_FILLING * area * sqrt(area);
    size->radius = is_filled ? 3 * volume / area : sqrt(area / (4 * 3.14159265358979323846));
    size->filled = is_filled ? volume / area : SKIN_SHARE * size->radius;
    return PEL_OK;
}

static bool is_auto(const pel_scene_value *map, const char *key)
{
    const pel_scene_value *value = map != NULL ? pel_scene_value_entry(map, key) : NULL;
    return value != NULL && value->form == PEL_FORM_WORD;
}

static pel_status build_mass(const pel_scene_body_source *source, const body_size *size, pel_body_def *body)
{
    static const struct {
        const char *key;
        pel_mass_kind kind;
    } kinds[] = {{"per_vertex", PEL_MASS_PER_VERTEX}, {"total", PEL_MASS_TOTAL}, {"density", PEL_MASS_DENSITY}};
    const pel_scene_value *mass = pel_scene_value_entry(source->value, "mass");
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        const pel_scene_value *value = pel_scene_value_entry(mass, kinds[i].key);
        if (value == NULL)
            continue;
        body->mass_kind = kinds[i].kind;
        body->mass = value->number;
    }
    if (!is_auto(mass, "thickness"))
        return pel_scene_build_quantity(source, mass, "thickness", "bodies[].mass", &body->thickness);
    body->thickness = (pel_quantity){.value = size->filled};
    return PEL_OK;
}

/* `length` is the thickness of springs and the depth of volumetric ones: 0 if numbers are per edge and vertex */
static pel_status build_springs(const pel_scene_body_source *source, const char *group, const char *length_key,
                                double automatic, pel_quantity *stiffness, pel_quantity *damping, double *length)
{
    const pel_scene_value *map = pel_scene_value_entry(source->value, group);
    char row_path[32];
    snprintf(row_path, sizeof row_path, "bodies[].%s", group);
    bool by_young = map != NULL && pel_scene_value_entry(map, "young") != NULL;
    *length = by_young ? automatic : 0;
    if (by_young && !is_auto(map, length_key))
        *length = pel_scene_value_number(map, length_key);
    pel_status status = pel_scene_build_quantity(source, map, by_young ? "young" : "stiffness", row_path, stiffness);
    return status == PEL_OK ? pel_scene_build_quantity(source, map, by_young ? "drag" : "damping", row_path, damping)
                            : status;
}

pel_status pel_scene_build_tissue(const pel_scene_body_source *source, pel_body_def *body)
{
    const pel_scene_value *mass = pel_scene_value_entry(source->value, "mass"),
                          *springs = pel_scene_value_entry(source->value, "springs"),
                          *filling = pel_scene_value_entry(source->value, "volumetric");
    body_size size = {0};
    pel_status status = PEL_OK;
    if (is_auto(mass, "thickness") || is_auto(springs, "thickness") || is_auto(filling, "depth"))
        status = measure(source, &size);
    if (status == PEL_OK)
        status = build_mass(source, &size, body);
    if (status == PEL_OK)
        status = build_springs(source, "springs", "thickness", SKIN_SHARE * size.radius, &body->spring_stiffness,
                               &body->spring_damping, &body->spring_thickness);
    if (status == PEL_OK)
        status = build_springs(source, "volumetric", "depth", size.radius, &body->volumetric_stiffness,
                               &body->volumetric_damping, &body->volumetric_depth);
    return status;
}
