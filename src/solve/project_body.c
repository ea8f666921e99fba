/* Which constraints a body has under a method, and their numbers. */
#include "base/memory.h"
#include "base/status.h"
#include "math/vec3.h"
#include "measure/element.h"
#include "model/shell.h"
#include "solve/project.h"

#include <string.h>

/* vertices of a piece: its records and constraints fit the nearer caches, and it is worth a thread */
enum { PIECE_SIZE = 2048 };

/* what building a body hands around */
typedef struct plan {
    const pel_model *model;
    const pel_body *body;
    const pel_solver_def *solver;
    pel_project_body *made;
    pel_build_scratch *scratch;
    bool compliant, with_multipliers;
    int32_t first_place, place_count;
} plan;

static double edge_stiffness(const plan *p, int32_t slot, int32_t lane)
{
    return p->body->uniform_spring >= 0 ? p->body->uniform_spring : (double)p->model->stiffnesses[slot][lane];
}

static bool can_move(const plan *p, const int32_t *places, int count)
{
    for (int k = 0; k < count; k++)
        if (p->model->inverse_mass[places[k]] > 0)
            return true;
    return false;
}

static void add_constraint(plan *p, const int32_t *places, int arity, int32_t origin, int32_t *count)
{
    if (!can_move(p, places, arity))
        return;
    memcpy(p->scratch->vertices + (size_t)*count * (size_t)arity, places, (size_t)arity * sizeof *places);
    p->scratch->origins[(*count)++] = origin;
}

/* ---- lists ---- */

static int32_t list_edges(plan *p)
{
    const pel_model *model = p->model;
    int32_t count = 0;
    for (int32_t v = p->first_place; v < p->first_place + p->place_count; v++) {
        int32_t slice = v / PEL_WIDTH, lane = v % PEL_WIDTH;
        for (int32_t slot = model->slot_begin[slice]; slot < model->slot_end[slice]; slot++) {
            const int32_t ends[2] = {v, model->neighbours[slot][lane]};
            bool all = p->solver->method == PEL_METHOD_PBD_DISTANCE;
            if (ends[1] > v && (all || edge_stiffness(p, slot, lane) > 0))
                add_constraint(p, ends, 2, slot * PEL_WIDTH + lane, &count);
        }
    }
    return count;
}

static int32_t list_triangles(plan *p)
{
    const pel_shell *shell = p->body->shell;
    int32_t count = 0;
    for (int32_t t = 0; t < shell->triangle_count; t++)
        if (shell->triangles[t].rest.area > 0)
            add_constraint(p, shell->triangles[t].vertices, 3, t, &count);
    return count;
}

static int32_t list_pressed(plan *p)
{
    const pel_shell *shell = p->body->shell;
    int32_t count = 0;
    for (int32_t t = 0; t < shell->triangle_count; t++)
        if (shell->pressure_weights == NULL || shell->pressure_weights[t] != 0)
            add_constraint(p, shell->triangles[t].vertices, 3, t, &count);
    return count;
}

static int32_t list_hinges(plan *p)
{
    const pel_shell *shell = p->body->shell;
    int32_t count = 0;
    for (int32_t h = 0; h < shell->hinge_count; h++)
        if (!p->compliant || shell->hinges[h].stiffness > 0)
            add_constraint(p, shell->hinges[h].vertices, 4, h, &count);
    return count;
}

static int32_t list_fibres(plan *p, const pel_shell_region *region)
{
    int32_t count = 0;
    for (int32_t f = 0; f < region->fibre_count; f++) {
        const pel_shell_triangle *triangle = &p->body->shell->triangles[region->fibres[f].triangle];
        if (triangle->rest.area > 0)
            add_constraint(p, triangle->vertices, 3, f, &count);
    }
    return count;
}

/* ---- numbers ---- */

static pel_real *number_at(const pel_batch *batch, int32_t lane_index, int j)
{
    size_t block = (size_t)lane_index / PEL_BLOCK, lane = (size_t)lane_index % PEL_BLOCK;
    return &batch->numbers[(block * (size_t)batch->number_count + (size_t)j) * PEL_BLOCK + lane];
}

static void fill_edge(const plan *p, const pel_batch *batch, int32_t i)
{
    int32_t slot = batch->sources[i] / PEL_WIDTH, lane = batch->sources[i] % PEL_WIDTH;
    *number_at(batch, i, 0) = p->model->rest_lengths[slot][lane];
    if (p->compliant)
        *number_at(batch, i, 1) = (pel_real)(1 / edge_stiffness(p, slot, lane));
}

static void fill_triangle(const plan *p, const pel_batch *batch, int32_t i)
{
    const pel_shell_triangle *t = &p->body->shell->triangles[batch->sources[i]];
    for (int j = 0; j < 3; j++)
        *number_at(batch, i, j) = (pel_real)t->rest.inverse[j];
    if (!p->compliant || batch->kind == PEL_CONSTRAINT_LIMIT)
        return;
    double stiffness = t->rest.area * t->young * t->thickness;
    int traits = pel_membrane_law_traits((pel_membrane_kind)(batch->kind - PEL_CONSTRAINT_STRAIN));
    *number_at(batch, i, 3) =
        (pel_real)((traits & PEL_LAW_CONSTANT_TANGENT) != 0 ? 1 / stiffness : batch->law.modulus * stiffness);
}

static void fill_pressed(const plan *p, const pel_batch *batch, int32_t i)
{
    const double *weights = p->body->shell->pressure_weights;
    *number_at(batch, i, 0) = (pel_real)(weights != NULL ? weights[batch->sources[i]] : 1);
}

static void fill_hinge(const plan *p, const pel_batch *batch, int32_t i)
{
    const pel_shell *shell = p->body->shell;
    const pel_shell_hinge *h = &shell->hinges[batch->sources[i]];
    if (shell->bending == PEL_BENDING_HINGE) {
        *number_at(batch, i, 0) = (pel_real)cos(h->hinge.rest_angle);
        *number_at(batch, i, 1) = (pel_real)sin(h->hinge.rest_angle);
        if (p->compliant)
            *number_at(batch, i, 2) = (pel_real)(1 / (h->stiffness * h->hinge.factor));
        return;
    }
    for (int j = 0; j < 3; j++)
        *number_at(batch, i, j) = (pel_real)h->isometric.weight[j + 1];
    double square = shell->bending == PEL_BENDING_ISOMETRIC ? 0 : 2 * h->isometric.rest_energy / h->isometric.factor;
    /* E = D / 3 times factor / 2 |K x|^2 stands for a plate (theory page, section 5) */
    *number_at(batch, i, 3) = (pel_real)(p->compliant ? 3 / (h->stiffness * h->isometric.factor) : square);
}

static void set_direction(const pel_batch *batch, int32_t i, const pel_rest_triangle *rest, const double direction[2])
{
    *number_at(batch, i, 0) = (pel_real)(rest->inverse[0] * direction[0] + rest->inverse[1] * direction[1]);
    *number_at(batch, i, 1) = (pel_real)(rest->inverse[2] * direction[1]);
}

static void fill_fibre(const plan *p, const pel_batch *batch, const pel_shell_region *region, int32_t i)
{
    const pel_shell_fibre *fibre = &region->fibres[batch->sources[i]];
    const pel_rest_triangle *rest = &p->body->shell->triangles[fibre->triangle].rest;
    set_direction(batch, i, rest, fibre->direction);
    if (batch->kind == PEL_CONSTRAINT_CAVE) {
        pel_project_cave_fill(p->made, p->body->shell, batch, i);
        return;
    }
    bool soft = batch->kind == PEL_CONSTRAINT_FIBRE_COMPLIANT || batch->kind == PEL_CONSTRAINT_FIBRE_SQUARE_COMPLIANT;
    *number_at(batch, i, 2) =
        (pel_real)(soft ? 1 / (rest->area * region->def.stiffness * fibre->weight) : fibre->weight);
}

/* ---- batches ---- */

/* the constraints of a batch into the scratch; returns how many */
static int32_t list_constraints(plan *p, const pel_batch *batch)
{
    if (batch->arity == 2)
        return list_edges(p);
    if (batch->arity == 4)
        return list_hinges(p);
    if (batch->region >= 0)
        return list_fibres(p, &p->body->shell->regions[batch->region]);
    return batch->kind == PEL_CONSTRAINT_PRESSURE ? list_pressed(p) : list_triangles(p);
}

static void fill_number(const plan *p, const pel_batch *batch, int32_t i)
{
    if (batch->arity == 2)
        fill_edge(p, batch, i);
    else if (batch->arity == 4)
        fill_hinge(p, batch, i);
    else if (batch->region >= 0)
        fill_fibre(p, batch, &p->body->shell->regions[batch->region], i);
    else if (batch->kind == PEL_CONSTRAINT_PRESSURE)
        fill_pressed(p, batch, i);
    else
        fill_triangle(p, batch, i);
}

/* lays out the constraints that the body has at present */
static pel_status fill_batch(plan *p, pel_batch *batch, pel_error *error)
{
    int32_t count = list_constraints(p, batch);
    pel_status status =
        pel_batch_build(batch, p->made, p->first_place, p->place_count, count, p->with_multipliers, p->scratch, error);
    if (batch->kind == PEL_CONSTRAINT_CAVE)
        pel_project_cave_measure(p->made, p->body->shell, p->first_place, p->place_count);
    for (int32_t i = 0; status == PEL_OK && i < batch->block_count * PEL_BLOCK; i++)
        fill_number(p, batch, i);
    return status;
}

/* edges of the body, at most */
static int32_t edge_limit(const plan *p)
{
    int32_t first = p->first_place / PEL_WIDTH, slices = p->place_count / PEL_WIDTH;
    /* each stands at both of its ends */
    return (p->model->slot_begin[first + slices] - p->model->slot_begin[first]) * PEL_WIDTH / 2;
}

/* edges, and triangles, at a vertex on any surface that the body can have */
static int32_t valence_limit(const plan *p)
{
    int32_t most = 0, first = p->first_place / PEL_WIDTH;
    for (int32_t s = first; s < first + p->place_count / PEL_WIDTH; s++) {
        int32_t room = p->model->slot_begin[s + 1] - p->model->slot_begin[s];
        most = room > most ? room : most;
    }
    return most;
}

/* room for whatever the surface of a body that refines can become */
static pel_status reserve_batch(const plan *p, pel_batch *batch, pel_error *error)
{
    const pel_shell *shell = p->body->shell;
    int32_t valence = valence_limit(p), bundles = 2 * p->made->piece_count, limit = 0;
    if (batch->arity == 2)
        limit = edge_limit(p);
    else if (batch->arity == 4)
        limit = shell->hinge_limit;
    else
        limit = batch->region >= 0 ? shell->regions[batch->region].fibre_limit : shell->triangle_limit;
    /* a hinge has edges at two of its vertices, and lies across from the two others */
    int32_t bound = pel_batch_bound(batch, limit, bundles, batch->arity == 4 ? 2 * valence : valence);
    return pel_batch_reserve(batch, bound, bundles, p->with_multipliers, error);
}

static pel_status make_batch(plan *p, pel_batch *made, pel_batch batch, int32_t region, pel_error *error)
{
    *made = batch;
    made->region = region;
    pel_status status = p->body->front != NULL ? reserve_batch(p, made, error) : PEL_OK;
    return status == PEL_OK ? fill_batch(p, made, error) : status;
}

static pel_status add_batch(plan *p, pel_batch batch, int32_t region, pel_error *error)
{
    return make_batch(p, &p->made->batches[p->made->batch_count++], batch, region, error);
}

/* the vertex-normal form needs sums around each vertex first: it is left to force/shell_force.c */
static pel_status make_pressure(plan *p, pel_error *error)
{
    const pel_shell *shell = p->body->shell;
    if (shell == NULL || shell->pressure.kind == PEL_PRESSURE_NONE || shell->pressure.form != PEL_PRESSURE_CONSISTENT)
        return PEL_OK;
    p->made->pressure = pel_allocate(1, sizeof *p->made->pressure);
    if (p->made->pressure == NULL)
        return pel_fail_memory(error);
    pel_batch batch = {.kind = PEL_CONSTRAINT_PRESSURE, .arity = 3, .number_count = 1};
    return make_batch(p, p->made->pressure, batch, -1, error);
}

static pel_status add_membrane(plan *p, pel_error *error)
{
    pel_membrane_material material = p->body->shell->material;
    material.young = material.thickness = 1;
    pel_membrane_law law = pel_membrane_law_of(&material);
    pel_batch batch = {.arity = 3, .number_count = p->compliant ? 4 : 3, .multiplier_count = 3};
    batch.kind =
        (pel_constraint)((int)(p->compliant ? PEL_CONSTRAINT_STRAIN : PEL_CONSTRAINT_MEMBRANE) + (int)law.kind);
    batch.law.modulus = law.modulus;
    batch.law.poisson = (pel_real)law.poisson;
    for (int i = 0; i < PEL_LAW_NUMBERS; i++)
        batch.law.numbers[i] = (pel_real)law.numbers[i];
    return add_batch(p, batch, -1, error);
}

/* after everything else that acts on the triangles, so that a sweep ends with it */
static pel_status add_limit(plan *p, pel_error *error)
{
    double limit = p->body->shell->strain_limit, least = 1 - limit, most = 1 + limit;
    pel_batch batch = {.kind = PEL_CONSTRAINT_LIMIT, .arity = 3, .number_count = 3};
    batch.law.least_strain = (pel_real)(0.5 * (least * least - 1));
    batch.law.most_strain = (pel_real)(0.5 * (most * most - 1));
    return add_batch(p, batch, -1, error);
}

static pel_status add_bending(plan *p, pel_error *error)
{
    const pel_shell *shell = p->body->shell;
    bool hinge = shell->bending == PEL_BENDING_HINGE;
    pel_batch batch = {.arity = 4, .number_count = 4, .multiplier_count = 3};
    batch.kind = p->compliant ? PEL_CONSTRAINT_ISOMETRIC_COMPLIANT : PEL_CONSTRAINT_ISOMETRIC;
    if (hinge) {
        batch.kind = p->compliant ? PEL_CONSTRAINT_ANGLE_COMPLIANT : PEL_CONSTRAINT_ANGLE;
        batch.number_count = p->compliant ? 3 : 2;
        batch.multiplier_count = 1;
    }
    return add_batch(p, batch, -1, error);
}

static pel_status add_region(plan *p, int32_t r, pel_error *error)
{
    const pel_shell_region *region = &p->body->shell->regions[r];
    bool squared = region->def.kind == PEL_FIBRE_STVK && region->def.mode != PEL_FIBRE_ACTIVE;
    pel_batch batch = {.arity = 3, .number_count = 3, .multiplier_count = 1, .law.rest_length = 1};
    if (region->def.mode == PEL_FIBRE_CAVE)
        batch = (pel_batch){.kind = PEL_CONSTRAINT_CAVE, .arity = 3, .number_count = PEL_CAVE_NUMBERS};
    else if (p->compliant)
        batch.kind = squared ? PEL_CONSTRAINT_FIBRE_SQUARE_COMPLIANT : PEL_CONSTRAINT_FIBRE_COMPLIANT;
    else
        batch.kind = squared ? PEL_CONSTRAINT_FIBRE_SQUARE : PEL_CONSTRAINT_FIBRE;
    return add_batch(p, batch, r, error);
}

static bool has_springs(const plan *p)
{
    return p->solver->method == PEL_METHOD_PBD_DISTANCE || p->body->uniform_spring != 0;
}

static pel_status add_batches(plan *p, pel_error *error)
{
    const pel_shell *shell = p->solver->method == PEL_METHOD_PBD_DISTANCE ? NULL : p->body->shell;
    int32_t most = 2 + (shell != NULL ? 2 + shell->region_count : 0);
    p->made->batches = pel_allocate((size_t)most, sizeof *p->made->batches);
    p->made->is_on = pel_allocate((size_t)most, sizeof *p->made->is_on);
    if (p->made->batches == NULL || p->made->is_on == NULL)
        return pel_fail_memory(error);
    pel_status status = PEL_OK;
    if (has_springs(p))
        status = add_batch(p,
                           (pel_batch){.kind = p->compliant ? PEL_CONSTRAINT_SPRING : PEL_CONSTRAINT_DISTANCE,
                                       .arity = 2,
                                       .number_count = p->compliant ? 2 : 1,
                                       .multiplier_count = 1},
                           -1, error);
    if (shell == NULL)
        return status;
    if (status == PEL_OK && shell->has_membrane)
        status = add_membrane(p, error);
    if (status == PEL_OK && shell->bending != PEL_BENDING_OFF)
        status = add_bending(p, error);
    for (int32_t r = 0; status == PEL_OK && r < shell->region_count; r++)
        if (shell->regions[r].def.mode != PEL_FIBRE_CURL)
            status = add_region(p, r, error);
    if (status == PEL_OK && shell->strain_limit > 0)
        status = add_limit(p, error);
    return status;
}

/* the largest list: edges, triangles or hinges */
static int32_t count_limit(const plan *p)
{
    const pel_shell *shell = p->body->shell;
    int32_t most = edge_limit(p);
    if (shell != NULL && shell->triangle_limit > most)
        most = shell->triangle_limit;
    if (shell != NULL && shell->hinge_limit > most)
        most = shell->hinge_limit;
    return most;
}

static plan plan_of(const pel_model *model, int32_t body, const pel_solver_def *solver, pel_project_body *made)
{
    const pel_body *b = &model->bodies[body];
    plan p = {.model = model, .body = b, .solver = solver, .made = made, .scratch = made->scratch};
    p.compliant = solver->method == PEL_METHOD_XPBD;
    p.with_multipliers = p.compliant && solver->iterations > 1;
    p.first_place = b->slice_begin * PEL_WIDTH;
    p.place_count = pel_body_place_end(model, body) - p.first_place;
    return p;
}

/* vertices of the mesh stand in rings: pieces are runs of them; finer ones go with one of the mesh nearby */
static void update_pieces(const plan *p)
{
    int32_t mesh_places = (p->body->mesh->vertex_count + PEL_WIDTH - 1) / PEL_WIDTH * PEL_WIDTH;
    for (int32_t i = 0; i < p->place_count; i++) {
        int32_t base = i, v = p->model->mesh_vertex[p->first_place + i], parents[2];
        if (i >= mesh_places && v >= 0) {
            while (pel_lod_forest_vertex_parents(p->body->front->forest, v, parents))
                v = parents[0];
            base = p->body->model_index[v] - p->first_place;
        }
        int32_t piece = base / PIECE_SIZE;
        p->made->piece_of_place[i] = piece < p->made->piece_count ? piece : p->made->piece_count - 1;
    }
}

static bool caves(const pel_shell *shell)
{
    for (int32_t r = 0; shell != NULL && r < shell->region_count; r++)
        if (shell->regions[r].def.mode == PEL_FIBRE_CAVE)
            return true;
    return false;
}

pel_status pel_project_body_create(const pel_model *model, int32_t body, const pel_solver_def *solver,
                                   pel_project_body *made, pel_error *error)
{
    plan p = plan_of(model, body, solver, made);
    int32_t pieces = (p.body->mesh->vertex_count + PIECE_SIZE / 2) / PIECE_SIZE;
    made->piece_count = pieces > 1 ? pieces : 1;
    made->piece_of_place = pel_allocate((size_t)p.place_count, sizeof *made->piece_of_place);
    p.scratch = made->scratch = pel_allocate(1, sizeof *made->scratch);
    if (made->piece_of_place == NULL || made->scratch == NULL)
        return pel_fail_memory(error);
    update_pieces(&p);
    if (caves(p.body->shell)) {
        made->areas = pel_allocate((size_t)p.place_count, sizeof *made->areas);
        if (made->areas == NULL)
            return pel_fail_memory(error);
    }
    pel_status status = pel_build_scratch_create(made->scratch, model, count_limit(&p), 2 * made->piece_count, error);
    if (status == PEL_OK)
        status = add_batches(&p, error);
    if (status == PEL_OK)
        status = make_pressure(&p, error);
    if (status == PEL_OK && p.body->front == NULL) {
        pel_build_scratch_destroy(made->scratch);
        pel_free(made->scratch);
        made->scratch = NULL;
    }
    return status;
}

void pel_project_body_follow(const pel_model *model, int32_t body, const pel_solver_def *solver, pel_project_body *made)
{
    plan p = plan_of(model, body, solver, made);
    update_pieces(&p);
    for (int32_t i = 0; i < made->batch_count; i++)
        fill_batch(&p, &made->batches[i], NULL);
    if (made->pressure != NULL)
        fill_batch(&p, made->pressure, NULL);
}

void pel_project_body_destroy(pel_project_body *body)
{
    for (int32_t i = 0; i < body->batch_count; i++)
        pel_batch_destroy(&body->batches[i]);
    if (body->pressure != NULL)
        pel_batch_destroy(body->pressure);
    if (body->scratch != NULL)
        pel_build_scratch_destroy(body->scratch);
    pel_free(body->scratch);
    pel_free(body->pressure);
    pel_free(body->batches);
    pel_free(body->is_on);
    pel_free(body->areas);
    pel_free(body->piece_of_place);
}

/* ---- numbers that change ---- */

static void follow_principal(const pel_batch *batch, const pel_shell *shell, const pel_record *positions)
{
    const pel_shell_region *region = &shell->regions[batch->region];
    for (int32_t i = 0; i < batch->block_count * PEL_BLOCK; i++) {
        const pel_shell_triangle *triangle = &shell->triangles[region->fibres[batch->sources[i]].triangle];
        double x[3][3], direction[2];
        pel_load_points(positions, triangle->vertices, 3, x);
        pel_principal_direction(&triangle->rest, (const double(*)[3])x, direction);
        set_direction(batch, i, &triangle->rest, direction);
    }
}

static void begin_region(pel_batch *batch, const pel_shell *shell, const pel_solver_def *solver, const pel_state *state,
                         double time)
{
    const pel_shell_region *region = &shell->regions[batch->region];
    const pel_anisotropy_def *def = &region->def;
    if (def->mode == PEL_FIBRE_ACTIVE)
        batch->law.rest_length =
            (pel_real)(def->rest_length.value *
                       pel_curve_value(region->rest_length.keys, region->rest_length.key_count, time));
    if (def->direction == PEL_FIBRE_PRINCIPAL)
        follow_principal(batch, shell, state->position);
    if (batch->kind == PEL_CONSTRAINT_CAVE)
        pel_project_cave_begin(batch, shell, state, solver);
}

void pel_project_body_begin(pel_project_body *own, const pel_model *model, int32_t body, const pel_solver_def *solver,
                            const pel_state *state, double time)
{
    const double *factors = state->factors[body];
    double weight = state->bending[body].weight;
    for (int32_t i = 0; i < own->batch_count; i++) {
        pel_batch *batch = &own->batches[i];
        bool paper = batch->kind == PEL_CONSTRAINT_ISOMETRIC || batch->kind == PEL_CONSTRAINT_ANGLE;
        batch->law.weight = (pel_real)weight;
        own->is_on[i] = !(batch->arity == 2 && !(factors[PEL_SPRING_STIFFNESS] > 0)) && !(paper && weight == 0);
        if (batch->region >= 0)
            begin_region(batch, model->bodies[body].shell, solver, state, time);
    }
}

void pel_project_body_set_time(pel_project_body *own, const double *factors, double tau)
{
    for (int32_t i = 0; i < own->batch_count; i++) {
        pel_batch_law *law = &own->batches[i].law;
        double factor = own->batches[i].arity == 2 ? factors[PEL_SPRING_STIFFNESS] : 1;
        law->square_time = (pel_real)(tau * tau * factor);
        law->inverse_square = (pel_real)(1 / (tau * tau * factor));
        law->force_rate = (pel_real)(1 / (tau * tau));
    }
}

static bool has_fixed(const pel_batch *batch, int32_t block, const uint8_t *is_fixed)
{
    const int32_t *steps = batch->steps + (size_t)block * (size_t)batch->arity * PEL_BLOCK;
    for (int32_t i = 0; i < batch->arity * PEL_BLOCK; i++)
        if (is_fixed[steps[i] / PEL_STEP])
            return true;
    return false;
}

void pel_project_body_mark_fixed(pel_project_body *own, const uint8_t *is_fixed)
{
    for (int32_t i = 0; i < own->batch_count; i++) {
        const pel_batch *batch = &own->batches[i];
        /* caving in has no reaction */
        bool reacts = batch->kind != PEL_CONSTRAINT_CAVE;
        for (int32_t block = 0; block < batch->block_count; block++)
            batch->has_fixed[block] = reacts && has_fixed(batch, block, is_fixed);
    }
}
