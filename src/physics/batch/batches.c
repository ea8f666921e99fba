/* Size of pieces, from the mesh alone, so that sums do not depend on the number of threads. A piece is a run of the
   model's order, which goes in rings: it wants some dozen rings for its inside to outweigh its seams, and at least two
   widths of a ring, or hinges reach beyond the next piece and fall into the last bundle, which runs alone. A ring of a
   compact surface is up to 1.8 sqrt(V) wide (2.5 on a cylinder with wide caps), hence 4 sqrt(V). Their number is even,
   so that seams of two phases are as many and threads have equal shares; fewer than 2 x 512 vertices are one piece.

   Share of the elements in the last bundle, hinges: 2,048 vertices a piece whatever the mesh 34 % on a cylinder of 1.5
   million vertices, 1.3 % now; 0 on grids, spheres, tori and cylinders from 10 to 260 thousand vertices. One width of
   a ring as the size: 5 to 30 %.

   Tried and lost, pbd sweep of membrane and hinges in double, least of 40 interleaved runs, two threads against one
   (they also cost one thread 3 %): patches of 512 or 1,024 vertices along a Hilbert curve, whose seams (13 to 17 % of
   the elements, on any size) are swept in 7 + 14 global colours. 20,480 triangles: 1.07 and 1.11 times as fast, pieces
   of now 1.75, of 2,048 vertices 1.45; 5,120 triangles: 0.99, now 1.54, one piece 1.00. A barrier per colour costs a
   small body more than its seams take; the curve pays where barriers are cheap. */
#include "batch/batches.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "math/extremes.h"
#include "math/functions.h"
#include "measure/element.h"
#include "model/shell.h"

#include <math.h>
#include <string.h>

/* vertices of a piece: it is worth a thread; its records and elements fit the nearer caches */
enum { PIECE_LEAST = 512, PIECE_MOST = 2048 };

/* arguments of the functions that build a body */
typedef struct plan {
    const pel_model *model;
    const pel_body *body;
    pel_body_batches *made;
    pel_method method;
    bool projects; /* skip vertices that cannot move */
    bool literal;  /* pbd: energies are the constraints */
    int32_t first_place, place_count;
} plan;

static double edge_stiffness(const plan *p, int32_t slot, int32_t lane)
{
    return p->body->uniform_spring >= 0 ? p->body->uniform_spring : (double)p->model->stiffnesses[slot][lane];
}

static bool may_matter(const plan *p, const int32_t *places, int count)
{
    for (int k = 0; k < count; k++)
        if (!p->projects || p->model->inverse_mass[places[k]] > 0)
            return true;
    return false;
}

static void push_element(plan *p, const int32_t *places, int arity, int32_t origin, int32_t *count)
{
    PEL_ASSERT(*count < p->made->scratch->count_limit);
    PEL_ASSERT(arity >= 2 && arity <= 4);
    memcpy(p->made->scratch->vertices + (size_t)*count * (size_t)arity, places, (size_t)arity * sizeof *places);
    p->made->scratch->origins[(*count)++] = origin;
}

static void add_element(plan *p, const int32_t *places, int arity, int32_t origin, int32_t *count)
{
    if (may_matter(p, places, arity))
        push_element(p, places, arity, origin, count);
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
            bool all = p->method == PEL_METHOD_PBD_DISTANCE;
            if (ends[1] > v && (all || edge_stiffness(p, slot, lane) > 0))
                add_element(p, ends, 2, slot * PEL_WIDTH + lane, &count);
        }
    }
    return count;
}

static int32_t list_triangles(plan *p)
{
    const pel_shell *shell = p->body->shell;
    int32_t count = 0;
    for (int32_t t = 0; t < shell->triangle_count; t++)
        if (pel_shell_rest(shell, t).area > 0)
            add_element(p, shell->corners[t], 3, t, &count);
    return count;
}

/* also fixed vertices: the volume depends on all */
static int32_t list_pressed(plan *p)
{
    const pel_shell *shell = p->body->shell;
    int32_t count = 0;
    for (int32_t t = 0; t < shell->triangle_count; t++)
        if (shell->pressure_weights == NULL || shell->pressure_weights[t] != 0)
            push_element(p, shell->corners[t], 3, t, &count);
    return count;
}

static int32_t list_hinges(plan *p)
{
    const pel_shell *shell = p->body->shell;
    int32_t count = 0;
    for (int32_t h = 0; h < shell->hinge_count; h++)
        if (p->literal || pel_shell_hinge_stiffness(shell, h) > 0)
            add_element(p, pel_shell_hinge_of(shell, h).vertices, 4, h, &count);
    return count;
}

static int32_t list_tetrahedra(plan *p)
{
    const pel_shell *shell = p->body->shell;
    int32_t count = 0;
    for (int32_t t = 0; t < shell->tetrahedron_count; t++)
        add_element(p, shell->tetrahedra[t], 4, t, &count);
    return count;
}

static int32_t list_fibres(plan *p, const pel_shell_region *region)
{
    int32_t count = 0;
    for (int32_t f = 0; f < region->fibre_count; f++) {
        int32_t t = pel_shell_fibre_triangle(region, f);
        if (pel_shell_rest(p->body->shell, t).area > 0)
            add_element(p, p->body->shell->corners[t], 3, f, &count);
    }
    return count;
}

/* ---- numbers ---- */

static void fill_edge(const plan *p, const pel_batch *batch, int32_t i)
{
    PEL_ASSERT_INDEX(i, batch->block_count * PEL_BLOCK);
    int32_t slot = batch->sources[i] / PEL_WIDTH, lane = batch->sources[i] % PEL_WIDTH;
    int32_t place = batch->steps[i / PEL_BLOCK * 2 * PEL_BLOCK + i % PEL_BLOCK] / PEL_STEP;
    *pel_batch_number(batch, i, 0) = pel_model_rest_length(p->model, slot, place);
    if (batch->kind == PEL_CONSTRAINT_SPRING)
        *pel_batch_number(batch, i, 1) = (pel_real)(1 / edge_stiffness(p, slot, lane));
}

/* flows: of the state; null = the shape at rest */
static void fill_triangle(const pel_shell *shell, const pel_flow *flows, const pel_batch *batch, int32_t i)
{
    PEL_ASSERT_INDEX(i, batch->block_count * PEL_BLOCK);
    const pel_rest_triangle rest = pel_shell_rest_now(shell, batch->sources[i], flows);
    for (int j = 0; j < 3; j++)
        *pel_batch_number(batch, i, j) = (pel_real)rest.inverse[j];
    if (batch->kind == PEL_CONSTRAINT_LIMIT)
        return;
    pel_shell_sheet sheet = pel_shell_sheet_of(shell, batch->sources[i]);
    double stiffness = rest.area * sheet.young * sheet.thickness;
    int traits = pel_membrane_law_traits(shell->law.kind);
    if ((traits & PEL_LAW_CONSTANT_TANGENT) == 0)
        stiffness *= batch->law.modulus;
    *pel_batch_number(batch, i, 3) = (pel_real)(pel_law_has_compliance(traits) ? 1 / stiffness : stiffness);
    const pel_membrane_law law = pel_shell_law_now(shell, batch->sources[i], flows);
    for (int j = PEL_TRIANGLE_NUMBERS; j < batch->number_count; j++)
        *pel_batch_number(batch, i, j) = (pel_real)law.numbers[j - PEL_TRIANGLE_NUMBERS];
}

static void fill_pressed(const plan *p, const pel_batch *batch, int32_t i)
{
    PEL_ASSERT_INDEX(i, batch->block_count * PEL_BLOCK);
    if (batch->number_count > 0)
        *pel_batch_number(batch, i, 0) = (pel_real)p->body->shell->pressure_weights[batch->sources[i]];
}

static void fill_angle(const pel_batch *batch, const pel_shell *shell, const pel_record *rest, pel_shell_hinge *h,
                       const pel_fold *folds, int32_t i)
{
    PEL_ASSERT_INDEX(i, batch->block_count * PEL_BLOCK);
    if (folds != NULL)
        h->fold = folds[shell->first_fold + h->number].angle;
    const pel_hinge stencil = pel_shell_angle(shell, rest, h);
    *pel_batch_number(batch, i, 0) = (pel_real)pel_cos(stencil.rest_angle);
    *pel_batch_number(batch, i, 1) = (pel_real)pel_sin(stencil.rest_angle);
    *pel_batch_number(batch, i, 2) = (pel_real)(1 / (h->stiffness * stencil.factor));
    if (batch->kind == PEL_CONSTRAINT_FOLD)
        *pel_batch_number(batch, i, 3) =
            (pel_real)(folds != NULL ? pel_shell_yield(shell, h->number, folds).angle : shell->yield_angles[h->number]);
}

static void fill_hinge(const plan *p, const pel_batch *batch, int32_t i)
{
    PEL_ASSERT_INDEX(i, batch->block_count * PEL_BLOCK);
    const pel_shell *shell = p->body->shell;
    pel_shell_hinge h = pel_shell_hinge_of(shell, batch->sources[i]);
    if (shell->bending->is_angle) {
        fill_angle(batch, shell, p->model->rest, &h, NULL, i);
        return;
    }
    const pel_bending_isometric stencil = pel_shell_isometric(p->model->rest, &h);
    for (int j = 0; j < 3; j++)
        *pel_batch_number(batch, i, j) = (pel_real)stencil.weight[j + 1];
    /* E = D / 3 times factor / 2 |K x|^2 represents a plate (theory page, section 5) */
    *pel_batch_number(batch, i, 3) = (pel_real)(3 / (h.stiffness * stencil.factor));
    double square = shell->bending->form == PEL_BENDING_LITERAL ? 0 : 2 * stencil.rest_energy / stencil.factor;
    *pel_batch_number(batch, i, 4) = (pel_real)square;
}

static void set_direction(const pel_batch *batch, int32_t i, const pel_rest_triangle *rest, const double direction[2])
{
    PEL_ASSERT_INDEX(i, batch->block_count * PEL_BLOCK);
    *pel_batch_number(batch, i, 0) = (pel_real)(rest->inverse[0] * direction[0] + rest->inverse[1] * direction[1]);
    *pel_batch_number(batch, i, 1) = (pel_real)(rest->inverse[2] * direction[1]);
}

/* weight and shares of a triangle that caves in */
static void fill_cave(const plan *p, const pel_batch *batch, const pel_shell_fibre *fibre, double area, int32_t i)
{
    PEL_ASSERT(area > 0);
    PEL_ASSERT_INDEX(i, batch->block_count * PEL_BLOCK);
    const int32_t *corners = p->body->shell->corners[fibre->triangle];
    *pel_batch_number(batch, i, PEL_CAVE_WEIGHT) = (pel_real)fibre->weight;
    for (int k = 0; k < 3; k++) {
        *pel_batch_number(batch, i, PEL_CAVE_SHARE + k) =
            (pel_real)(area / p->made->areas[corners[k] - p->first_place]);
        *pel_batch_number(batch, i, PEL_CAVE_WAY + k) = 0;
    }
}

/* push and bound of a triangle whose energy has its gradient along the normal */
static void fill_normal(const pel_batch *batch, const pel_anisotropy_def *def, const pel_shell_fibre *fibre,
                        double area, int32_t i)
{
    PEL_ASSERT_INDEX(i, batch->block_count * PEL_BLOCK);
    double edge = sqrt(4 / sqrt(3.0) * area); /* of a regular triangle of its area */
    *pel_batch_number(batch, i, PEL_NORMAL_PUSH) = (pel_real)(fibre->weight * area * def->stiffness / def->gradient);
    *pel_batch_number(batch, i, PEL_NORMAL_MOST) = (pel_real)(def->max_step * edge);
    *pel_batch_number(batch, i, PEL_NORMAL_LIMITED) = 0;
}

static void fill_fibre(const plan *p, const pel_batch *batch, const pel_shell_region *region, int32_t i)
{
    PEL_ASSERT_INDEX(i, batch->block_count * PEL_BLOCK);
    const pel_shell_fibre fibre = pel_shell_fibre_of(p->body->shell, region, batch->sources[i]);
    const pel_rest_triangle rest = pel_shell_rest(p->body->shell, fibre.triangle);
    set_direction(batch, i, &rest, fibre.direction);
    if (batch->kind == PEL_CONSTRAINT_CAVE) {
        fill_cave(p, batch, &fibre, rest.area, i);
        return;
    }
    if (region->def.mode == PEL_FIBRE_NORMAL) {
        fill_normal(batch, &region->def, &fibre, rest.area, i);
        return;
    }
    *pel_batch_number(batch, i, 2) = (pel_real)(1 / (rest.area * region->def.stiffness * fibre.weight));
    if (batch->number_count == PEL_FIBRE_WEIGHTED_NUMBERS)
        *pel_batch_number(batch, i, 3) = (pel_real)fibre.weight;
}

static void fill_tetra(const plan *p, const pel_batch *batch, int32_t i)
{
    PEL_ASSERT_INDEX(i, batch->block_count * PEL_BLOCK);
    pel_rest_tetra rest;
    const double scale = pel_filled_rest(p->body->shell, p->model->rest, batch->sources[i], &rest);
    for (int j = 0; j < 9; j++)
        *pel_batch_number(batch, i, j) = (pel_real)rest.gradients[j / 3][j % 3];
    *pel_batch_number(batch, i, 9) = (pel_real)(1 / scale);
}

/* ---- batches ---- */

/* the elements of a batch into the scratch; returns how many */
static int32_t list_elements(plan *p, const pel_batch *batch)
{
    if (batch->arity == 2)
        return list_edges(p);
    if (pel_batch_is_solid(batch))
        return list_tetrahedra(p);
    if (batch->arity == 4)
        return list_hinges(p);
    if (batch->region >= 0)
        return list_fibres(p, &p->body->shell->regions[batch->region]);
    return batch->kind == PEL_CONSTRAINT_PRESSURE ? list_pressed(p) : list_triangles(p);
}

static void fill_number(const plan *p, const pel_batch *batch, int32_t i)
{
    PEL_ASSERT_INDEX(i, batch->block_count * PEL_BLOCK);
    if (batch->arity == 2)
        fill_edge(p, batch, i);
    else if (pel_batch_is_solid(batch))
        fill_tetra(p, batch, i);
    else if (batch->arity == 4)
        fill_hinge(p, batch, i);
    else if (batch->region >= 0)
        fill_fibre(p, batch, &p->body->shell->regions[batch->region], i);
    else if (batch->kind == PEL_CONSTRAINT_PRESSURE)
        fill_pressed(p, batch, i);
    else
        fill_triangle(p->body->shell, NULL, batch, i);
}

/* areas around the vertices */
static void measure_areas(const plan *p)
{
    const pel_shell *shell = p->body->shell;
    for (int32_t i = 0; i < p->place_count; i++)
        p->made->areas[i] = 0;
    for (int32_t t = 0; t < shell->triangle_count; t++) {
        double area = pel_shell_rest(shell, t).area;
        for (int k = 0; k < 3; k++)
            p->made->areas[shell->corners[t][k] - p->first_place] += area;
    }
}

static void fill_numbers(const plan *p, const pel_batch *batch)
{
    for (int32_t i = 0; i < batch->block_count * PEL_BLOCK; i++)
        fill_number(p, batch, i);
}

/* lays out the elements that the body has at present */
static pel_status fill_batch(plan *p, pel_batch *batch, pel_error *error)
{
    int32_t count = list_elements(p, batch);
    pel_status status = pel_batch_build(batch, &p->made->pieces, count, p->made->scratch, error);
    if (batch->kind == PEL_CONSTRAINT_CAVE)
        measure_areas(p);
    if (status == PEL_OK)
        fill_numbers(p, batch);
    return status;
}

/* edges of the body, at most */
static int32_t edge_limit(const plan *p)
{
    int32_t first = p->first_place / PEL_WIDTH, slices = p->place_count / PEL_WIDTH;
    /* each is stored at both of its ends */
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

/* room for any surface of a body that refines */
static pel_status reserve_batch(const plan *p, pel_batch *batch, pel_error *error)
{
    const pel_shell *shell = p->body->shell;
    int32_t valence = valence_limit(p), bundles = pel_bundle_count(&p->made->pieces), limit = 0;
    if (batch->arity == 2)
        limit = edge_limit(p);
    else if (batch->arity == 4)
        limit = shell->hinge_limit;
    else
        limit = batch->region >= 0 ? shell->regions[batch->region].fibre_limit : shell->triangle_limit;
    /* a hinge has edges at two of its vertices, and lies across from the two others */
    int32_t bound = pel_batch_bound(batch, limit, bundles, batch->arity == 4 ? 2 * valence : valence);
    return pel_batch_reserve(batch, bound, bundles, error);
}

static pel_status add_batch(plan *p, pel_batch batch, pel_error *error)
{
    pel_batch *made = &p->made->batches[p->made->batch_count++];
    *made = batch;
    pel_status status = p->body->front != NULL ? reserve_batch(p, made, error) : PEL_OK;
    return status == PEL_OK ? fill_batch(p, made, error) : status;
}

static pel_status add_springs(plan *p, pel_error *error)
{
    bool compliant = p->method == PEL_METHOD_XPBD;
    pel_batch batch = {.arity = 2, .region = -1, .is_projected = true, .number_count = compliant ? 2 : 1};
    batch.kind = compliant ? PEL_CONSTRAINT_SPRING : PEL_CONSTRAINT_DISTANCE;
    batch.multiplier_count = 1;
    return add_batch(p, batch, error);
}

/* shells that the method sweeps over */
static bool projects_shells(const plan *p)
{
    return p->method == PEL_METHOD_PBD || p->method == PEL_METHOD_XPBD;
}

static pel_status add_membrane(plan *p, pel_error *error)
{
    const pel_membrane_law law = p->body->shell->law;
    pel_batch batch = {.arity = 3, .multiplier_count = 3, .region = -1};
    batch.number_count = pel_triangle_numbers(pel_membrane_law_traits(law.kind));
    batch.kind = (pel_constraint)((int)(p->literal ? PEL_CONSTRAINT_MEMBRANE : PEL_CONSTRAINT_STRAIN) + (int)law.kind);
    batch.is_projected = projects_shells(p);
    batch.law.modulus = law.modulus;
    batch.law.poisson = (pel_real)law.poisson;
    for (int i = 0; i < PEL_LAW_NUMBERS; i++)
        batch.law.numbers[i] = (pel_real)law.numbers[i];
    return add_batch(p, batch, error);
}

/* after everything else that acts on the triangles, so that a sweep ends with it */
static pel_status add_limit(plan *p, pel_error *error)
{
    double limit = p->body->shell->strain_limit, least = 1 - limit, most = 1 + limit;
    pel_batch batch = {.kind = PEL_CONSTRAINT_LIMIT, .arity = 3, .number_count = 3, .region = -1, .is_projected = true};
    batch.law.least_strain = (pel_real)(0.5 * (least * least - 1));
    batch.law.most_strain = (pel_real)(0.5 * (most * most - 1));
    return add_batch(p, batch, error);
}

static pel_status add_bending(plan *p, pel_error *error)
{
    const pel_shell *shell = p->body->shell;
    bool hinge = shell->bending->is_angle;
    pel_batch batch = {.arity = 4, .region = -1, .is_projected = projects_shells(p)};
    batch.kind = p->literal ? PEL_CONSTRAINT_ISOMETRIC : PEL_CONSTRAINT_ISOMETRIC_COMPLIANT;
    if (hinge)
        batch.kind = p->literal ? PEL_CONSTRAINT_ANGLE : PEL_CONSTRAINT_ANGLE_COMPLIANT;
    batch.number_count = hinge ? PEL_ANGLE_NUMBERS : PEL_ISOMETRIC_NUMBERS;
    batch.multiplier_count = hinge ? 1 : 3;
    if (shell->yield_angles != NULL && !p->literal) {
        batch.kind = PEL_CONSTRAINT_FOLD;
        batch.number_count = PEL_FOLD_NUMBERS;
        batch.law.fold_share = (pel_real)pel_fold_share(shell->hardening);
    }
    return add_batch(p, batch, error);
}

static pel_status add_solid(plan *p, pel_error *error)
{
    const pel_shell *shell = p->body->shell;
    pel_batch batch = {.arity = 4, .number_count = PEL_SOLID_NUMBERS, .multiplier_count = 2, .region = -1};
    batch.kind = (pel_constraint)((int)PEL_CONSTRAINT_SOLID + (int)shell->solid.kind);
    batch.is_projected = projects_shells(p);
    batch.law.solid = shell->solid;
    return add_batch(p, batch, error);
}

bool pel_batch_is_plastic(const pel_batch *batch, const pel_shell *shell)
{
    return shell != NULL &&
           (batch->kind == PEL_CONSTRAINT_FOLD || (pel_batch_is_membrane(batch) && pel_shell_flows(shell)) ||
            (batch->kind == PEL_CONSTRAINT_LIMIT && shell->growths != NULL));
}

static bool changes(const plan *p, const pel_batch *batch)
{
    return pel_batch_is_plastic(batch, p->body->shell) || batch->kind == PEL_CONSTRAINT_CAVE ||
           (batch->region >= 0 && p->body->shell->regions[batch->region].def.direction == PEL_FIBRE_PRINCIPAL);
}

/* the batch of the membrane, when it has all triangles and no event changes them; else null */
static const pel_batch *whole_membrane(const plan *p)
{
    int32_t count = 0;
    for (int32_t i = 0; p->body->front == NULL && i < p->made->batch_count; i++) {
        const pel_batch *batch = &p->made->batches[i];
        if (batch->arity != 3 || batch->region >= 0 || batch->kind == PEL_CONSTRAINT_LIMIT)
            continue;
        for (int32_t block = 0; block < batch->block_count; block++)
            count += batch->lane_counts[block];
        return count == p->body->shell->triangle_count ? batch : NULL;
    }
    return NULL;
}

/* a batch of the very triangles of another one */
static pel_status add_shared(plan *p, pel_batch batch, const pel_batch *other, pel_error *error)
{
    pel_batch *made = &p->made->batches[p->made->batch_count++];
    *made = batch;
    pel_batch_share(made, other);
    if (made->number_count == 0)
        return PEL_OK;
    size_t lanes = (size_t)made->capacity * PEL_BLOCK;
    made->numbers = pel_allocate_aligned(lanes * (size_t)made->number_count, sizeof *made->numbers);
    if (made->numbers == NULL)
        return pel_fail_memory(error);
    fill_numbers(p, made);
    return PEL_OK;
}

static pel_status add_region(plan *p, int32_t r, pel_error *error)
{
    const pel_shell_region *region = &p->body->shell->regions[r];
    bool squared = region->def.kind == PEL_FIBRE_STVK && region->def.mode != PEL_FIBRE_ACTIVE;
    pel_batch batch = {.arity = 3, .number_count = PEL_FIBRE_NUMBERS, .multiplier_count = 1, .law.rest_length = 1};
    batch.kind = squared ? PEL_CONSTRAINT_FIBRE_SQUARE_COMPLIANT : PEL_CONSTRAINT_FIBRE_COMPLIANT;
    if (region->def.mode == PEL_FIBRE_CAVE) {
        batch = (pel_batch){.kind = PEL_CONSTRAINT_CAVE, .arity = 3, .number_count = PEL_CAVE_NUMBERS};
    } else if (region->def.mode == PEL_FIBRE_NORMAL) {
        batch = (pel_batch){.kind = squared ? PEL_CONSTRAINT_NORMAL_SQUARE : PEL_CONSTRAINT_NORMAL,
                            .arity = 3,
                            .number_count = PEL_NORMAL_NUMBERS};
    } else if (region->def.mode == PEL_FIBRE_MUSCLE) {
        batch.kind = PEL_CONSTRAINT_MUSCLE;
        batch.law.optimum = (pel_real)region->def.optimum;
        batch.law.width = (pel_real)region->def.width;
    } else if (p->literal) {
        batch.kind = squared ? PEL_CONSTRAINT_FIBRE_SQUARE : PEL_CONSTRAINT_FIBRE;
        batch.number_count = PEL_FIBRE_WEIGHTED_NUMBERS;
    }
    batch.region = r;
    /* the normal gradient is a constraint of pbd and a force of the other methods */
    batch.is_projected = region->def.mode == PEL_FIBRE_NORMAL ? p->literal : projects_shells(p);
    const pel_batch *membrane = region->triangles == NULL && !changes(p, &batch) ? whole_membrane(p) : NULL;
    return membrane != NULL ? add_shared(p, batch, membrane, error) : add_batch(p, batch, error);
}

static pel_status add_pressure(plan *p, pel_error *error)
{
    bool weighted = p->body->shell->pressure_weights != NULL;
    pel_batch batch = {.kind = PEL_CONSTRAINT_PRESSURE, .arity = 3, .number_count = weighted, .region = -1};
    const pel_batch *membrane = weighted ? NULL : whole_membrane(p);
    if (membrane == NULL)
        return add_batch(p, batch, error);
    return add_shared(p, batch, membrane, error);
}

/* curls are in the rest angles; caving in is a rule of projection and gives no force */
static bool has_elements(const plan *p, const pel_shell_region *region)
{
    return region->def.mode != PEL_FIBRE_CURL && (region->def.mode != PEL_FIBRE_CAVE || projects_shells(p));
}

static pel_status add_batches(plan *p, pel_error *error)
{
    const pel_shell *shell = p->body->shell;
    int32_t most = 2 + (shell != NULL ? 4 + shell->region_count : 0);
    p->made->batches = pel_allocate((size_t)most, sizeof *p->made->batches);
    if (p->made->batches == NULL)
        return pel_fail_memory(error);
    pel_status status = PEL_OK;
    if (p->projects && (p->method == PEL_METHOD_PBD_DISTANCE || p->body->uniform_spring != 0))
        status = add_springs(p, error);
    if (shell == NULL)
        return status;
    if (status == PEL_OK && shell->has_membrane)
        status = add_membrane(p, error);
    if (status == PEL_OK && shell->tetrahedron_count > 0 && shell->stars == NULL)
        status = add_solid(p, error);
    if (status == PEL_OK && shell->bending->has_hinges)
        status = add_bending(p, error);
    for (int32_t r = 0; status == PEL_OK && r < shell->region_count; r++)
        if (has_elements(p, &shell->regions[r]))
            status = add_region(p, r, error);
    if (status == PEL_OK && shell->strain_limit > 0 && projects_shells(p))
        status = add_limit(p, error);
    if (status == PEL_OK && shell->pressure.kind != PEL_PRESSURE_NONE)
        status = add_pressure(p, error);
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
    if (shell != NULL && shell->tetrahedron_count > most)
        most = shell->tetrahedron_count;
    return most;
}

static plan plan_of(pel_batches *batches, int32_t body)
{
    PEL_ASSERT_INDEX(body, batches->model->body_count);
    const pel_model *model = batches->model;
    plan p = {.model = model, .body = &model->bodies[body], .method = batches->method, .made = &batches->bodies[body]};
    p.literal = p.method == PEL_METHOD_PBD;
    p.projects = batches->is_projected;
    p.first_place = p.body->slice_begin * PEL_WIDTH;
    p.place_count = pel_body_place_end(model, body) - p.first_place;
    return p;
}

static int32_t piece_count_of(int32_t vertex_count)
{
    if (vertex_count < 2 * PIECE_LEAST)
        return 1;
    double size = pel_min(pel_max(vertex_count / 10.0, PIECE_LEAST), PIECE_MOST);
    return 2 * (int32_t)(vertex_count / (2 * pel_max(size, 4 * sqrt(vertex_count))) + 0.5);
}

/* vertices of the mesh are ordered in rings: pieces are runs of them; finer ones join a mesh vertex nearby */
static void update_pieces(const plan *p)
{
    pel_pieces *pieces = &p->made->pieces;
    int64_t vertices = p->body->mesh->vertex_count, mesh_places = (vertices + PEL_WIDTH - 1) / PEL_WIDTH * PEL_WIDTH;
    for (int32_t i = 0; i < p->place_count; i++) {
        int32_t base = i, v = p->model->mesh_vertex[p->first_place + i], parents[2];
        if (i >= mesh_places && v >= 0) {
            while (pel_lod_forest_vertex_parents(p->body->front->forest, v, parents))
                v = parents[0];
            base = p->body->model_index[v] - p->first_place;
        }
        int32_t piece = (int32_t)((int64_t)base * pieces->piece_count / vertices);
        pieces->piece_of_place[i] = piece < pieces->piece_count ? piece : pieces->piece_count - 1;
    }
}

/* frees memory that only bodies that refine need again */
static void end_build(plan *p)
{
    if (p->body->front != NULL)
        return;
    for (int32_t i = 0; i < p->made->batch_count; i++)
        if (!changes(p, &p->made->batches[i])) {
            if (!p->made->batches[i].is_shared)
                pel_free(p->made->batches[i].sources);
            p->made->batches[i].sources = NULL;
        }
    pel_build_scratch_destroy(p->made->scratch);
    pel_free(p->made->scratch);
    p->made->scratch = NULL;
}

static pel_status create_body(plan *p, pel_error *error)
{
    pel_body_batches *made = p->made;
    made->pieces = (pel_pieces){.piece_count = piece_count_of(p->body->mesh->vertex_count)};
    PEL_ASSERT(made->pieces.piece_count == 1 || made->pieces.piece_count % 2 == 0);
    made->pieces.first_place = p->first_place;
    made->pieces.place_count = p->place_count;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(made->pieces.piece_of_place, p->place_count), PEL_ROOM(made->scratch, 1)))
        return pel_fail_memory(error);
    update_pieces(p);
    if (p->body->shell != NULL && pel_shell_has_mode(p->body->shell, PEL_FIBRE_CAVE)) {
        made->areas = pel_allocate((size_t)p->place_count, sizeof *made->areas);
        if (made->areas == NULL)
            return pel_fail_memory(error);
    }
    pel_status status = pel_build_scratch_create(made->scratch, &made->pieces, count_limit(p), error);
    if (status == PEL_OK)
        status = add_batches(p, error);
    if (status == PEL_OK)
        end_build(p);
    return status;
}

static void destroy_body(pel_body_batches *body)
{
    for (int32_t i = 0; i < body->batch_count; i++)
        pel_batch_destroy(&body->batches[i]);
    if (body->scratch != NULL)
        pel_build_scratch_destroy(body->scratch);
    PEL_FREE_ALL(body->scratch, body->batches, body->areas, body->pieces.piece_of_place);
}

/* ---- all bodies ---- */

/* the number of bundles of a phase: pieces, even seams, odd seams, the rest */
static int32_t bundles_of_phase(const pel_body_batches *body, int phase)
{
    int32_t pieces = body->pieces.piece_count, seams = pieces - 1;
    const int32_t counts[PEL_PHASE_COUNT] = {pieces, (seams + 1) / 2, seams / 2, seams > 0};
    return counts[phase];
}

static int32_t bundle_number(const pel_body_batches *body, int phase, int32_t i)
{
    PEL_ASSERT_INDEX(phase, PEL_PHASE_COUNT);
    PEL_ASSERT_INDEX(i, bundles_of_phase(body, phase));
    int32_t pieces = body->pieces.piece_count;
    const int32_t numbers[PEL_PHASE_COUNT] = {i, pieces + 2 * i, pieces + 2 * i + 1, 2 * pieces - 1};
    return numbers[phase];
}

static pel_status make_phases(pel_batches *batches, pel_error *error)
{
    int32_t count = 0, body_count = batches->model->body_count;
    for (int32_t b = 0; b < body_count; b++)
        count += pel_bundle_count(&batches->bodies[b].pieces);
    batches->bundles = pel_allocate((size_t)count, sizeof *batches->bundles);
    if (batches->bundles == NULL)
        return pel_fail_memory(error);
    count = 0;
    for (int phase = 0; phase < PEL_PHASE_COUNT; phase++) {
        batches->phase_begin[phase] = count;
        for (int32_t b = 0; b < body_count; b++)
            for (int32_t i = 0; i < bundles_of_phase(&batches->bodies[b], phase); i++)
                batches->bundles[count++] = (pel_bundle){b, bundle_number(&batches->bodies[b], phase, i)};
    }
    batches->phase_begin[PEL_PHASE_COUNT] = count;
    return PEL_OK;
}

pel_status pel_batches_create(const pel_model *model, pel_method method, pel_batches **batches, pel_error *error)
{
    *batches = NULL;
    pel_batches *made = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    made->model = model;
    made->method = method;
    made->is_projected = method == PEL_METHOD_PBD || method == PEL_METHOD_PBD_DISTANCE || method == PEL_METHOD_XPBD;
    made->bodies = pel_allocate((size_t)model->body_count, sizeof *made->bodies);
    pel_status status = made->bodies != NULL ? PEL_OK : pel_fail_memory(error);
    for (int32_t b = 0; status == PEL_OK && b < model->body_count; b++) {
        plan p = plan_of(made, b);
        status = create_body(&p, error);
    }
    if (status == PEL_OK)
        status = make_phases(made, error);
    if (status != PEL_OK) {
        pel_batches_destroy(made);
        return status;
    }
    PEL_ASSERT_WHOLE(pel_batches_is_valid(made));
    *batches = made;
    return PEL_OK;
}

void pel_batches_destroy(pel_batches *batches)
{
    if (batches == NULL)
        return;
    for (int32_t b = 0; batches->bodies != NULL && b < batches->model->body_count; b++)
        destroy_body(&batches->bodies[b]);
    PEL_FREE_ALL(batches->bodies, batches->bundles, batches);
}

void pel_batches_rebuild(pel_batches *batches, int32_t body)
{
    PEL_ASSERT_INDEX(body, batches->model->body_count);
    plan p = plan_of(batches, body);
    if (p.made->batch_count == 0)
        return;
    update_pieces(&p);
    for (int32_t i = 0; i < p.made->batch_count; i++)
        fill_batch(&p, &p.made->batches[i], NULL);
    PEL_ASSERT_WHOLE(pel_batches_is_valid(batches));
}

/* ---- directions ---- */

static void follow_region(const pel_batch *batch, const pel_shell *shell, const pel_record *positions)
{
    const pel_shell_region *region = &shell->regions[batch->region];
    for (int32_t i = 0; i < batch->block_count * PEL_BLOCK; i++) {
        int32_t t = pel_shell_fibre_triangle(region, batch->sources[i]);
        const pel_rest_triangle rest = pel_shell_rest(shell, t);
        double x[3][3], direction[2];
        pel_load_points(positions, shell->corners[t], 3, x);
        pel_principal_direction(&rest, (const double(*)[3])x, direction);
        set_direction(batch, i, &rest, direction);
    }
}

void pel_batches_follow(pel_batches *batches, int32_t body, const pel_record *positions)
{
    PEL_ASSERT_INDEX(body, batches->model->body_count);
    const pel_shell *shell = batches->model->bodies[body].shell;
    const pel_body_batches *own = &batches->bodies[body];
    for (int32_t i = 0; i < own->batch_count; i++) {
        int32_t region = own->batches[i].region;
        if (region >= 0 && shell->regions[region].def.direction == PEL_FIBRE_PRINCIPAL)
            follow_region(&own->batches[i], shell, positions);
    }
}

/* ---- what yields or grows ---- */

void pel_batch_slip(const pel_batches *batches, int32_t body, const pel_batch *batch, int32_t block,
                    const pel_plastic *plastic)
{
    PEL_ASSERT_INDEX(body, batches->model->body_count);
    PEL_ASSERT_INDEX(block, batch->block_count);
    const pel_shell *shell = batches->model->bodies[body].shell;
    for (int32_t i = block * PEL_BLOCK; i < (block + 1) * PEL_BLOCK; i++) {
        if (batch->kind != PEL_CONSTRAINT_FOLD) {
            fill_triangle(shell, plastic->flows, batch, i);
            continue;
        }
        pel_shell_hinge hinge = pel_shell_hinge_of(shell, batch->sources[i]);
        fill_angle(batch, shell, batches->model->rest, &hinge, plastic->folds, i);
    }
}
