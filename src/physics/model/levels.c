#include "model/levels.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "math/vec3.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static pel_status refuse(pel_error *error, int32_t body, const char *name, double value, const char *rule)
{
    return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", body, rule, "refine: %s is %g", name, value);
}

/* a criterion with two thresholds */
static pel_status check_thresholds(int32_t body, const char *high_name, double high, const char *low_name, double low,
                                   pel_error *error)
{
    char rule[80];
    if (!(high >= 0 && isfinite(high)))
        return refuse(error, body, high_name, high, "give a number of at least 0");
    snprintf(rule, sizeof rule, "give a number of at least 0 and less than %s (%g)", high_name, high);
    if (!(low >= 0 && isfinite(low)) || (high > 0 && !(low < high)))
        return refuse(error, body, low_name, low, rule);
    return PEL_OK;
}

static pel_status check_region(const pel_refine_def *def, int32_t body, int32_t vertex_count, pel_error *error)
{
    if (def->region_count < 0 || (def->region_count > 0 && def->region == NULL))
        return refuse(error, body, "region_count", def->region_count, "give the vertices of the region with it");
    if (def->region_levels < 0 || def->region_levels > def->levels)
        return refuse(error, body, "region_levels", def->region_levels, "give 1 to the number of levels, or 0 for all");
    for (int32_t i = 0; i < def->region_count; i++)
        if (def->region[i] < 0 || def->region[i] >= vertex_count)
            return refuse(error, body, "vertex of the region", def->region[i], "give vertices of the body's mesh");
    return PEL_OK;
}

pel_status pel_refine_check(const pel_refine_def *def, int32_t body, int32_t vertex_count, pel_error *error)
{
    if (def->levels < 0 || def->levels > PEL_LOD_DEPTH_LIMIT)
        return refuse(error, body, "levels", def->levels, "give 0 (no refinement) to 12 levels; 1 to 3 are usual");
    if (def->levels == 0)
        return PEL_OK;
    if (PEL_IS_NO_CHOICE(def->springs, PEL_REFINE_UNCHANGED + 1))
        return refuse(error, body, "springs", (double)def->springs, "give one of pel_refine_springs");
    pel_status status = check_thresholds(body, "above", def->above, "below", def->below, error);
    if (status == PEL_OK)
        status = check_thresholds(body, "curvature_above", def->curvature_above, "curvature_below",
                                  def->curvature_below, error);
    if (status == PEL_OK)
        status = check_region(def, body, vertex_count, error);
    if (status != PEL_OK)
        return status;
    if (!(def->near_tools >= 0 && isfinite(def->near_tools)))
        return refuse(error, body, "near_tools", def->near_tools, "give a distance of at least 0");
    if (def->rings < 1 || def->rings > 3)
        return refuse(error, body, "rings", def->rings, "give 1 to 3 rings");
    if (def->dwell < 0)
        return refuse(error, body, "dwell", def->dwell, "give a number of steps of at least 0");
    if (def->interval < 1)
        return refuse(error, body, "interval", def->interval, "give at least 1 step");
    if (def->budget < 0)
        return refuse(error, body, "budget", def->budget, "give a number of triangles, or 0 for no limit");
    return PEL_OK;
}

int32_t pel_levels_base_edge(const pel_body_levels *detail, int32_t level, int32_t t, int k)
{
    for (; level > 0; level--) {
        int child = t % 4;
        k = (child == 3 ? k + 2 : k + child) % 3;
        t = pel_lod_parent(t);
    }
    return detail->forest->levels[0]->edge_of_half_edge[3 * t + k];
}

static bool allocate(pel_body_levels *detail)
{
    const pel_topology *base = detail->forest->levels[0];
    size_t fine_count = (size_t)detail->forest->levels[detail->forest->depth]->vertex_count;
    return PEL_ALLOCATE_ALL(PEL_ROOM(detail->areas, base->triangle_count),
                            PEL_ROOM(detail->vertex_areas, base->vertex_count), PEL_ROOM(detail->densities, fine_count),
                            PEL_ROOM(detail->stiffnesses, base->edge_count), PEL_ROOM(detail->moduli, base->edge_count),
                            PEL_ROOM(detail->pinned, fine_count));
}

static void measure_areas(pel_body_levels *detail)
{
    const pel_topology *base = detail->forest->levels[0];
    const double(*x)[3] = (const double(*)[3])detail->forest->rest_positions;
    for (int32_t t = 0; t < base->triangle_count; t++) {
        const int32_t *v = base->triangles[t];
        detail->areas[t] = pel_vec3_triangle_area(x[v[0]], x[v[1]], x[v[2]]);
        for (int c = 0; c < 3; c++)
            detail->vertex_areas[v[c]] += detail->areas[t];
    }
}

void pel_levels_spread(const pel_body_levels *detail, int32_t component_count, double *values)
{
    const pel_lod_forest *forest = detail->forest;
    const size_t n = (size_t)component_count;
    for (int32_t v = 0; v < forest->levels[0]->vertex_count; v++)
        for (size_t c = 0; c < n; c++)
            values[(size_t)v * n + c] /= detail->vertex_areas[v];
    for (int32_t l = 0; l < forest->depth; l++) {
        const pel_topology *level = forest->levels[l];
        double *middle = values + (size_t)level->vertex_count * n;
        for (int32_t e = 0; e < level->edge_count; e++, middle += n) {
            int32_t h = level->half_edge_of_edge[e];
            const double *p = values + (size_t)pel_half_edge_origin(level, h) * n;
            const double *q = values + (size_t)pel_half_edge_target(level, h) * n;
            for (size_t c = 0; c < n; c++)
                middle[c] = (p[c] + q[c]) / 2;
        }
    }
}

static void spread_densities(pel_body_levels *detail, const pel_model *model, const pel_body *body)
{
    for (int32_t v = 0; v < body->mesh->vertex_count; v++) {
        int32_t i = body->model_index[v];
        detail->densities[v] = (pel_nodal){(double)model->mass[i], (double)model->damping[i], (double)model->rest[i][3],
                                           (double)model->volumetric_damping[i]};
    }
    pel_levels_spread(detail, sizeof(pel_nodal) / sizeof(double), (double *)detail->densities);
}

void pel_levels_spread_marks(const pel_lod_forest *forest, uint8_t *marks)
{
    for (int32_t l = 0; l < forest->depth; l++) {
        const pel_topology *level = forest->levels[l];
        for (int32_t e = 0; e < level->edge_count; e++) {
            int32_t h = level->half_edge_of_edge[e];
            marks[level->vertex_count + e] =
                marks[pel_half_edge_origin(level, h)] && marks[pel_half_edge_target(level, h)];
        }
    }
}

static void spread_pins(pel_body_levels *detail, const pel_model *model, const pel_body *body)
{
    for (int32_t v = 0; v < body->mesh->vertex_count; v++)
        detail->pinned[v] = model->inverse_mass[body->model_index[v]] == 0;
    pel_levels_spread_marks(detail->forest, detail->pinned);
}

static void fit_moduli(pel_body_levels *detail, const pel_body_def *def)
{
    const pel_topology *base = detail->forest->levels[0];
    const double(*x)[3] = (const double(*)[3])detail->forest->rest_positions;
    for (int32_t e = 0; e < base->edge_count; e++) {
        int32_t h = base->half_edge_of_edge[e], twin = base->twin[h];
        int32_t a = pel_half_edge_origin(base, h), b = pel_half_edge_target(base, h);
        double k = pel_model_rest_stiffness(def, base, e), d[3];
        double area = detail->areas[h / 3] + (twin >= 0 ? detail->areas[twin / 3] : 0);
        pel_vec3_subtract(x[b], x[a], d);
        detail->stiffnesses[e] = k;
        detail->moduli[e] = k * pel_vec3_squared_length(d) / area;
    }
}

pel_status pel_body_detail_create(const pel_body_def *def, pel_model *model, int32_t body, pel_error *error)
{
    PEL_ASSERT_INDEX(body, model->body_count);
    if (def->refine.levels == 0)
        return PEL_OK;
    pel_body_levels *detail = pel_allocate(1, sizeof *detail);
    if (detail == NULL)
        return pel_fail_memory(error);
    model->bodies[body].detail = detail;
    detail->def = def->refine;
    detail->region = pel_allocate((size_t)def->refine.region_count, sizeof *detail->region);
    if (detail->region == NULL)
        return pel_fail_memory(error);
    if (def->refine.region_count > 0)
        memcpy(detail->region, def->refine.region, (size_t)def->refine.region_count * sizeof *detail->region);
    detail->def.region = detail->region;
    pel_status status =
        pel_lod_forest_create(def->mesh, def->refine.levels, def->refine.memory_limit, &detail->forest, error);
    if (status != PEL_OK)
        return status;
    if (!allocate(detail))
        return pel_fail_memory(error);
    measure_areas(detail);
    spread_densities(detail, model, &model->bodies[body]);
    spread_pins(detail, model, &model->bodies[body]);
    fit_moduli(detail, def);
    return PEL_OK;
}

void pel_body_detail_destroy(pel_body_levels *detail)
{
    if (detail == NULL)
        return;
    pel_lod_forest_destroy(detail->forest);
    PEL_FREE_ALL(detail->region, detail->areas, detail->vertex_areas, detail->densities, detail->stiffnesses,
                 detail->moduli, detail->pinned, detail);
}
