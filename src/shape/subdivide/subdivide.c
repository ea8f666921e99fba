#include "pellicle/subdivide.h"

#include "base/memory.h"
#include "base/status.h"
#include "mesh/allocate.h"
#include "subdivide/butterfly.h"
#include "subdivide/clamp.h"
#include "subdivide/split.h"

#include <string.h>

static const uint32_t def_cookie = 0x53554244u;

pel_subdivide_def pel_subdivide_def_default(void)
{
    return (pel_subdivide_def){1, true, (size_t)1 << 31, def_cookie};
}

static pel_status check_def(const pel_subdivide_def *def, pel_error *error)
{
    if (def->cookie != def_cookie)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "start from pel_subdivide_def_default()",
                          "subdivision def was not made by pel_subdivide_def_default");
    if (def->levels < 0)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give a number of levels from 0", "cannot subdivide %d times",
                          (int)def->levels);
    return PEL_OK;
}

/* bytes of a vertex of the result */
static size_t vertex_bytes(const pel_mesh *mesh)
{
    size_t components = 3;
    for (int32_t f = 0; f < mesh->field_count; f++)
        components += (size_t)mesh->fields[f].component_count;
    return components * sizeof(double);
}

/* the size of the result, when it fits: the result and the two levels before it are in memory together */
static pel_status plan_size(const pel_mesh *mesh, const pel_topology *base, const pel_subdivide_def *def,
                            pel_level_size *size, pel_error *error)
{
    *size = pel_level_size_of(base);
    size_t before = 0, last = pel_level_size_topology_bytes(*size);
    for (int32_t level = 0; level < def->levels; level++) {
        size_t topologies = before + last;
        *size = pel_level_size_split(*size);
        size_t bytes = topologies + pel_butterfly_bytes(base) + (size_t)size->vertex_count * vertex_bytes(mesh) +
                       (size_t)size->triangle_count * sizeof *mesh->triangles;
        before = last;
        last = pel_level_size_topology_bytes(*size);
        bool too_large = def->memory_limit > 0 && bytes > def->memory_limit;
        if (!pel_level_size_fits(*size) || too_large) {
            pel_fail(error, PEL_BAD_ARGUMENT, "level %d of %d has %lld triangles and needs %.0f MB", (int)level + 1,
                     (int)def->levels, (long long)size->triangle_count, (double)bytes * 1e-6);
            if (too_large)
                pel_fail_remedy(error, "subdivide at most %d times, or allow more than %.0f MB", (int)level,
                                (double)def->memory_limit * 1e-6);
            else
                pel_fail_remedy(error, "subdivide at most %d times", (int)level);
            return PEL_BAD_ARGUMENT;
        }
    }
    return PEL_OK;
}

/* a mesh of the final size with the base's values in its first rows */
static pel_status allocate_fine(const pel_mesh *mesh, pel_level_size size, pel_mesh **fine, pel_error *error)
{
    *fine = pel_mesh_allocate((int32_t)size.vertex_count, (int32_t)size.triangle_count);
    if (*fine == NULL)
        return pel_fail_memory(error);
    memcpy((*fine)->positions, mesh->positions, (size_t)mesh->vertex_count * sizeof *mesh->positions);
    for (int32_t f = 0; f < mesh->field_count; f++) {
        const pel_field *field = &mesh->fields[f];
        pel_status status = pel_mesh_add_field(*fine, field->name, field->component_count, NULL, error);
        if (status != PEL_OK)
            return status;
        size_t bytes = (size_t)mesh->vertex_count * (size_t)field->component_count * sizeof *field->values;
        memcpy((*fine)->fields[f].values, field->values, bytes);
    }
    return PEL_OK;
}

/* values of the vertices that splitting this level adds */
static void fill_level(pel_butterfly *butterfly, const pel_topology *level, bool clamp, pel_mesh *fine)
{
    pel_butterfly_edge_values(butterfly, level, 3, fine->positions[0]);
    for (int32_t f = 0; f < fine->field_count; f++) {
        pel_field *field = &fine->fields[f];
        pel_butterfly_edge_values(butterfly, level, field->component_count, field->values);
        if (clamp)
            pel_clamp_rows(field->values, field->component_count, butterfly->base_vertex_count,
                           level->vertex_count + level->edge_count);
    }
}

/* takes the base topology over */
static pel_status fill_levels(pel_topology *base, const pel_subdivide_def *def, pel_mesh *fine, pel_error *error)
{
    pel_butterfly *butterfly = NULL;
    pel_topology *level = base;
    pel_status status = pel_butterfly_create(base, &butterfly, error);
    for (int32_t l = 0; l < def->levels && status == PEL_OK; l++) {
        fill_level(butterfly, level, def->clamp_fields, fine);
        if (l == def->levels - 1) {
            pel_topology_split_triangles(level, fine->triangles);
            break;
        }
        pel_topology *next = NULL;
        status = pel_topology_split(level, &next, error);
        pel_topology_destroy(level);
        level = next;
    }
    if (def->levels == 0)
        memcpy(fine->triangles, base->triangles, (size_t)base->triangle_count * sizeof *base->triangles);
    pel_topology_destroy(level);
    pel_butterfly_destroy(butterfly);
    return status;
}

pel_status pel_mesh_subdivide_with(const pel_mesh *mesh, const pel_subdivide_def *def, pel_mesh **fine,
                                   pel_error *error)
{
    PEL_REFUSE_NULL(mesh, error);
    PEL_REFUSE_NULL(def, error);
    PEL_REFUSE_NULL(fine, error);
    *fine = NULL;
    pel_status status = check_def(def, error);
    if (status != PEL_OK)
        return status;
    pel_topology *base = NULL;
    status = pel_topology_create(mesh, &base, error);
    if (status != PEL_OK)
        return status;
    pel_level_size size;
    pel_mesh *made = NULL;
    status = plan_size(mesh, base, def, &size, error);
    if (status == PEL_OK)
        status = allocate_fine(mesh, size, &made, error);
    if (status == PEL_OK)
        status = fill_levels(base, def, made, error);
    else
        pel_topology_destroy(base);
    if (status != PEL_OK) {
        pel_mesh_destroy(made);
        return status;
    }
    *fine = made;
    return PEL_OK;
}

pel_status pel_mesh_subdivide(const pel_mesh *mesh, int32_t levels, pel_mesh **fine, pel_error *error)
{
    PEL_REFUSE_NULL(mesh, error);
    PEL_REFUSE_NULL(fine, error);
    pel_subdivide_def def = pel_subdivide_def_default();
    def.levels = levels;
    return pel_mesh_subdivide_with(mesh, &def, fine, error);
}
