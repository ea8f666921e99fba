#include "boundary/edge_load.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/status.h"
#include "boundary/loads.h"
#include "newton/newton.h"
#include "newton/run.h"

#include <string.h>

/* a lip of a cut is no border that loads act on */
static bool is_cut(const pel_sim *sim, const pel_tangent_edge *edge)
{
    const pel_body *body = &sim->model->bodies[edge->body];
    const int32_t *v = body->mesh->triangles[edge->triangles[0]], tip = sim->model->mesh_vertex[edge->vertices[2]];
    int corner = v[0] == tip ? 1 : v[1] == tip ? 2 : 0;
    return pel_is_lip(body, 3 * edge->triangles[0] + corner);
}

/* the edges of one load that `marks` (vertex_count) has both ends of */
static pel_status list_edges(pel_sim *sim, int32_t l, const uint8_t *marks, pel_error *error)
{
    PEL_ASSERT_INDEX(l, sim->loads->count);
    pel_newton *newton = sim->newton;
    const pel_tangent_edge *edges = pel_tangent_edges_of(pel_newton_tangent(newton));
    int32_t before = sim->loads->edge_load_count;
    for (int32_t e = 0; e < pel_newton_pattern(newton)->edge_count; e++) {
        const int32_t *ends = edges[e].vertices;
        double from[3], to[3];
        if (edges[e].triangles[1] >= 0 || edges[e].body != sim->loads->items[l].body || !marks[ends[0]] ||
            !marks[ends[1]] || is_cut(sim, &edges[e]))
            continue;
        pel_edge_load *made = &sim->loads->edge_loads[sim->loads->edge_load_count++];
        *made = (pel_edge_load){.load = l, .edge = e};
        pel_vertex_position(sim->model->rest, ends[0], from);
        pel_vertex_position(sim->model->rest, ends[1], to);
        pel_vec3_subtract(to, from, made->along);
    }
    if (sim->loads->edge_load_count > before)
        return PEL_OK;
    return pel_refuse_element(error, PEL_BAD_ARGUMENT, "load", l,
                              "choose a region with both ends of boundary edges of such a body",
                              "moment acts on no boundary edge of a body with bending model midedge");
}

pel_status pel_edge_loads_create(pel_sim *sim, const pel_sim_def *def, pel_error *error)
{
    int32_t count = 0;
    for (int32_t l = 0; l < def->load_count; l++)
        count += def->loads[l].kind == PEL_LOAD_MOMENT;
    if (count == 0)
        return PEL_OK;
    for (int32_t l = 0; !sim->stepper->turns_edges && l < def->load_count; l++)
        if (def->loads[l].kind == PEL_LOAD_MOMENT)
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "load", l, "use the method static or implicit",
                                      "this method does not support moments on edges");
    for (int32_t l = 0; l < def->load_count; l++)
        if (def->loads[l].kind == PEL_LOAD_MOMENT && sim->model->bodies[def->loads[l].body].detail != NULL)
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "load", l, "leave out refine of the body",
                                      "moments act on edges of a body that refines");
    size_t edges = (size_t)pel_newton_pattern(sim->newton)->edge_count;
    uint8_t *marks = pel_allocate((size_t)sim->model->vertex_count, sizeof *marks);
    sim->loads->edge_loads = pel_allocate((size_t)count * edges, sizeof *sim->loads->edge_loads);
    pel_status status = marks != NULL && sim->loads->edge_loads != NULL ? PEL_OK : pel_fail_memory(error);
    for (int32_t l = 0; status == PEL_OK && l < def->load_count; l++) {
        if (def->loads[l].kind != PEL_LOAD_MOMENT)
            continue;
        memset(marks, 0, (size_t)sim->model->vertex_count);
        for (int32_t i = 0; i < sim->loads->items[l].vertex_count; i++) {
            marks[sim->loads->items[l].vertices[i]] = 1;
            sim->loads->items[l].weights[i] = 0;
        }
        status = list_edges(sim, l, marks, error);
    }
    pel_free(marks);
    return status;
}

void pel_edge_loads_destroy(pel_sim *sim)
{
    pel_free(sim->loads->edge_loads);
}

/* N m, of an edge over a span */
static double moment_of(const pel_sim *sim, const pel_edge_load *at, pel_span span)
{
    const pel_load *load = &sim->loads->items[at->load];
    return pel_load_factor(sim, load, span) * pel_vec3_dot(load->force, at->along);
}

double pel_edge_load_product(const pel_sim *sim, int32_t load, pel_span span, const double *turns)
{
    PEL_ASSERT_INDEX(load, sim->loads->count);
    double sum = 0;
    for (int32_t i = 0; i < sim->loads->edge_load_count; i++)
        if (sim->loads->edge_loads[i].load == load)
            sum += moment_of(sim, &sim->loads->edge_loads[i], span) * turns[sim->loads->edge_loads[i].edge];
    return sum;
}

void pel_edge_loads_add(const pel_sim *sim, pel_span span, double *moments)
{
    for (int32_t i = 0; i < sim->loads->edge_load_count; i++)
        moments[sim->loads->edge_loads[i].edge] += moment_of(sim, &sim->loads->edge_loads[i], span);
}

void pel_edge_loads_add_work(pel_sim *sim, pel_span span, const double *turns)
{
    for (int32_t i = 0; i < sim->loads->edge_load_count; i++) {
        const pel_edge_load *at = &sim->loads->edge_loads[i];
        /* statics pass through the moments on the way to those of the end */
        double mean =
            pel_sim_has_velocity(sim)
                ? moment_of(sim, at, span)
                : 0.5 * (moment_of(sim, at, pel_instant(span.time - sim->step.dt)) + moment_of(sim, at, span));
        sim->loads->edge_load_work += mean * turns[at->edge];
    }
}
