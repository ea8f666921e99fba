#include "observe/pick.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "bvh/ray.h"
#include "math/extremes.h"
#include "pellicle/sim_surface.h"
#include "stage/stage.h"
#include "stage/surface_view.h"

#include <string.h>

struct pel_picker {
    int64_t revision; /* of the surfaces, summed up */
    pel_tree *tree;
    pel_box *boxes;          /* (vertex_count) */
    double (*positions)[3];  /* (vertex_count) all bodies */
    int32_t (*triangles)[3]; /* (triangle_count) */
    int32_t *begin;          /* (body_count + 1) first vertex of each body */
    int32_t *first;          /* (body_count + 1) first triangle */
};

static void empty(pel_picker *picker)
{
    pel_tree_destroy(picker->tree);
    PEL_FREE_ALL(picker->boxes, picker->positions, picker->triangles, picker->begin, picker->first);
    *picker = (pel_picker){.revision = -1};
}

void pel_picker_destroy(pel_picker *picker)
{
    if (picker == NULL)
        return;
    empty(picker);
    pel_free(picker);
}

static int64_t revision_of(const pel_sim *sim)
{
    int64_t sum = 0;
    for (int32_t b = 0; b < sim->model->body_count; b++)
        sum += pel_sim_surface_revision(sim, b);
    return sum;
}

static void read_positions(const pel_sim *sim, pel_picker *picker)
{
    for (int32_t b = 0; b < sim->model->body_count; b++)
        pel_sim_get_positions(sim, b, picker->positions[picker->begin[b]]);
}

static pel_status fill(const pel_sim *sim, pel_picker *picker, pel_error *error)
{
    int32_t body_count = sim->model->body_count;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(picker->begin, (size_t)body_count + 1),
                          PEL_ROOM(picker->first, (size_t)body_count + 1)))
        return pel_fail_memory(error);
    for (int32_t b = 0; b < body_count; b++) {
        picker->begin[b + 1] = picker->begin[b] + pel_sim_vertex_count(sim, b);
        picker->first[b + 1] = picker->first[b] + pel_sim_triangle_count(sim, b);
    }
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(picker->positions, picker->begin[body_count]),
                          PEL_ROOM_ALIGNED(picker->boxes, picker->begin[body_count]),
                          PEL_ROOM(picker->triangles, picker->first[body_count])))
        return pel_fail_memory(error);
    read_positions(sim, picker);
    for (int32_t b = 0; b < body_count; b++) {
        pel_sim_get_triangles(sim, b, picker->triangles[picker->first[b]]);
        for (int32_t t = picker->first[b]; t < picker->first[b + 1]; t++)
            for (int c = 0; c < 3; c++)
                picker->triangles[t][c] += picker->begin[b];
    }
    return pel_tree_create((const double(*)[3])picker->positions, picker->begin[body_count],
                           (const int32_t(*)[3])picker->triangles, picker->first[body_count], PEL_TREE_TRIANGLES,
                           &picker->tree, error);
}

static pel_status follow_surface(pel_sim *sim, pel_error *error)
{
    if (sim->picker == NULL) {
        sim->picker = pel_allocate(1, sizeof *sim->picker);
        if (sim->picker == NULL)
            return pel_fail_memory(error);
        sim->picker->revision = -1;
    }
    pel_picker *picker = sim->picker;
    if (picker->revision == revision_of(sim))
        return PEL_OK;
    empty(picker);
    pel_status status = fill(sim, picker, error);
    picker->revision = status == PEL_OK ? revision_of(sim) : -1;
    return status;
}

/* boxes of the present positions about the first vertex */
static void fit(const pel_sim *sim, pel_picker *picker)
{
    read_positions(sim, picker);
    const double *center = picker->positions[0];
    for (int32_t v = 0; v < picker->begin[sim->model->body_count]; v++)
        for (int k = 0; k < 3; k++) {
            float x = (float)(picker->positions[v][k] - center[k]);
            picker->boxes[v].low[k] = nextafterf(x, -HUGE_VALF);
            picker->boxes[v].high[k] = nextafterf(x, HUGE_VALF);
        }
    pel_tree_refit(picker->tree, picker->boxes, sim->pool);
}

/* the vertex of the mesh that is nearest to the place at rest */
static int32_t nearest_mesh_vertex(const pel_sim *sim, const pel_pick_hit *hit)
{
    int best = 0;
    for (int c = 1; c < 3; c++)
        if (hit->weights[c] > hit->weights[best])
            best = c;
    int32_t index = pel_output_model_index(sim, hit->body, hit->vertices[best]);
    int32_t v = sim->model->mesh_vertex[index];
    const pel_mesh *mesh = sim->given->bodies[hit->body].mesh;
    if (v < mesh->vertex_count)
        return v;
    /* a finer vertex: the nearest one of the mesh at rest */
    double x[3], least = HUGE_VAL;
    int32_t nearest = 0;
    pel_vertex_position(sim->model->rest, index, x);
    for (int32_t m = 0; m < mesh->vertex_count; m++) {
        double distance = pel_vec3_distance(mesh->positions[m], x);
        if (distance < least) {
            least = distance;
            nearest = m;
        }
    }
    return nearest;
}

static void describe(const pel_sim *sim, const pel_picker *picker, const pel_ray *ray, const pel_ray_hit *found,
                     pel_pick_hit *hit)
{
    while (found->triangle >= picker->first[hit->body + 1])
        hit->body++;
    hit->is_hit = true;
    hit->triangle = found->triangle - picker->first[hit->body];
    hit->distance = pel_max(found->distance * pel_vec3_length(ray->direction), 0);
    const int32_t *corners = picker->triangles[found->triangle];
    const double(*x)[3] = (const double(*)[3])picker->positions;
    double first[3], second[3];
    for (int c = 0; c < 3; c++) {
        hit->vertices[c] = corners[c] - picker->begin[hit->body];
        hit->weights[c] = found->weights[c];
        pel_vec3_along(hit->point, hit->weights[c], x[corners[c]], hit->point);
    }
    pel_vec3_subtract(x[corners[1]], x[corners[0]], first);
    pel_vec3_subtract(x[corners[2]], x[corners[0]], second);
    pel_vec3_cross(first, second, hit->normal);
    pel_vec3_normalize(hit->normal);
    hit->mesh_vertex = nearest_mesh_vertex(sim, hit);
}

/* The ray with a direction of length 1; lengths that overflow when squared are scaled before. */
static pel_status make_ray(const double origin[3], const double direction[3], pel_ray *ray, pel_error *error)
{
    double largest = pel_max(fabs(direction[0]), pel_max(fabs(direction[1]), fabs(direction[2]))), scaled[3];
    bool is_finite = true;
    for (int k = 0; k < 3; k++)
        is_finite &= isfinite(origin[k]) && isfinite(direction[k]);
    if (!is_finite || !(largest > 0))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give a finite origin and a direction of any length but 0",
                          "the ray is not finite or has no direction");
    if (!isfinite(pel_vec3_length(origin)))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give an origin near the bodies",
                          "the origin of the ray is too far away: %g, %g, %g", origin[0], origin[1], origin[2]);
    for (int k = 0; k < 3; k++)
        scaled[k] = direction[k] / largest;
    pel_vec3_copy(origin, ray->origin);
    pel_vec3_scale(scaled, 1 / pel_vec3_length(scaled), ray->direction);
    return PEL_OK;
}

pel_status pel_pick(pel_sim *sim, const double origin[3], const double direction[3], pel_pick_hit *hit,
                    pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    PEL_REFUSE_NULL(origin, error);
    PEL_REFUSE_NULL(direction, error);
    PEL_REFUSE_NULL(hit, error);
    pel_ray ray;
    memset(hit, 0, sizeof *hit);
    pel_status status = make_ray(origin, direction, &ray, error);
    if (status == PEL_OK)
        status = follow_surface(sim, error);
    if (status != PEL_OK)
        return status;
    fit(sim, sim->picker);
    pel_ray_hit found =
        pel_tree_cast(sim->picker->tree, (const double(*)[3])sim->picker->positions, sim->picker->positions[0], &ray);
    if (found.triangle >= 0)
        describe(sim, sim->picker, &ray, &found, hit);
    return PEL_OK;
}
