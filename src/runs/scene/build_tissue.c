/* Masses and springs of a body, with default sizes from the mesh: so any mesh has the response of its tissue,
   independent of size and fineness. */
#include "keys/table.h"
#include "scene/build.h"

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

static pel_status measure(const pel_scene_part *source, body_size *size)
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

static pel_mass_kind mass_kind(const pel_scene_value *mass)
{
    if (pel_scene_value_entry(mass, "per_vertex") != NULL)
        return PEL_MASS_PER_VERTEX;
    return pel_scene_value_entry(mass, "total") != NULL ? PEL_MASS_TOTAL : PEL_MASS_DENSITY;
}

pel_status pel_scene_build_tissue(const pel_scene_part *source, pel_body_def *body)
{
    const pel_scene_value *mass = pel_scene_value_entry(source->value, "mass"),
                          *springs = pel_scene_value_entry(source->value, "springs"),
                          *filling = pel_scene_value_entry(source->value, "volumetric");
    body_size size = {0};
    pel_status status = PEL_OK;
    body->mass_kind = mass_kind(mass);
    if (is_auto(mass, "thickness") || is_auto(springs, "thickness") || is_auto(filling, "depth"))
        status = measure(source, &size);
    if (is_auto(mass, "thickness"))
        body->thickness = (pel_quantity){.value = size.filled};
    if (is_auto(springs, "thickness"))
        body->spring_thickness = SKIN_SHARE * size.radius;
    if (is_auto(filling, "depth"))
        body->volumetric_depth = size.radius;
    return status;
}
