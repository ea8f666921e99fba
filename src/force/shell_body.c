#include "force/shell_body.h"

#include "base/memory.h"
#include "base/status.h"
#include "force/pressure.h"
#include "measure/element.h"

#include <math.h>
#include <string.h>

const pel_shell_body *pel_shell_body_of(const pel_shell_forces *forces, int32_t body)
{
    for (int32_t i = 0; forces != NULL && i < forces->count; i++)
        if (forces->bodies[i].body == body)
            return &forces->bodies[i];
    return NULL;
}

/* bending needs a stiffness when forces are asked for */
static pel_status check_bending(const pel_shell_body *own, pel_error *error)
{
    const pel_shell *shell = own->shell;
    for (int32_t i = 0; i < shell->hinge_count; i++) {
        if (shell->has_membrane || shell->hinges[i].stiffness > 0)
            continue;
        pel_fail(error, PEL_BAD_ARGUMENT, "bending has no stiffness");
        pel_fail_element(error, "body", own->body);
        pel_fail_remedy(error, "give the bending a stiffness above 0 [N m], or the body a membrane");
        return PEL_BAD_ARGUMENT;
    }
    return PEL_OK;
}

static void set_law(pel_shell_body *own)
{
    pel_membrane_material material = own->shell->material;
    material.young = material.thickness = 1;
    own->law = pel_membrane_law_of(&material);
    own->stiffness = pel_membrane_law_stiffness(&own->law);
}

/* Lists by owner: counts stand two places after their owner's number, sums make them begins one place after; filling
   moves each up to the begin of the next owner, so that begin[owner] .. begin[owner + 1] is right in the end. */
static void sum_counts(int32_t *begin, int32_t owner_count)
{
    for (int32_t i = 0; i < owner_count; i++)
        begin[i + 2] += begin[i + 1];
}

/* fibres that give forces */
static int32_t force_fibre_count(const pel_shell_region *region)
{
    return region->def.mode != PEL_FIBRE_CAVE ? region->fibre_count : 0;
}

static pel_status make_fibres(pel_shell_body *own, pel_error *error)
{
    const pel_shell *shell = own->shell;
    size_t count = 0;
    for (int32_t r = 0; r < shell->region_count; r++)
        if (force_fibre_count(&shell->regions[r]) > 0)
            count += (size_t)shell->regions[r].fibre_limit;
    if (count == 0)
        return PEL_OK;
    own->fibre_begin = pel_allocate((size_t)shell->triangle_limit + 2, sizeof *own->fibre_begin);
    own->fibres = pel_allocate(count, sizeof *own->fibres);
    return own->fibre_begin != NULL && own->fibres != NULL ? PEL_OK : pel_fail_memory(error);
}

/* the fibres of all regions by triangle */
static void fill_fibres(pel_shell_body *own)
{
    const pel_shell *shell = own->shell;
    if (own->fibre_begin == NULL)
        return;
    memset(own->fibre_begin, 0, ((size_t)shell->triangle_count + 2) * sizeof *own->fibre_begin);
    for (int32_t r = 0; r < shell->region_count; r++)
        for (int32_t i = 0; i < force_fibre_count(&shell->regions[r]); i++)
            own->fibre_begin[shell->regions[r].fibres[i].triangle + 2]++;
    sum_counts(own->fibre_begin, shell->triangle_count);
    for (int32_t r = 0; r < shell->region_count; r++)
        for (int32_t i = 0; i < force_fibre_count(&shell->regions[r]); i++) {
            const pel_shell_fibre *fibre = &shell->regions[r].fibres[i];
            pel_triangle_fibre *made = &own->fibres[own->fibre_begin[fibre->triangle + 1]++];
            *made = (pel_triangle_fibre){.region = r, .stiffness = shell->regions[r].def.stiffness * fibre->weight};
            memcpy(made->direction, fibre->direction, sizeof made->direction);
        }
}

/* ---- rows ---- */

/* counts the rows of each vertex, or lists them; triangles come first */
static void visit_row(pel_shell_body *own, int32_t place, size_t row, bool list)
{
    int32_t *begin = &own->gather_begin[place - own->first_place];
    if (list)
        own->gather[begin[1]++] = (int32_t)row;
    else
        begin[2]++;
}

static void visit_rows(pel_shell_body *own, bool list)
{
    const pel_shell *shell = own->shell;
    for (int32_t lane = 0; lane < 3 * shell->triangle_count; lane++) {
        int32_t row = pel_row_of(lane / 3, 3, lane % 3);
        visit_row(own, own->triangle_steps[row] / PEL_STEP, (size_t)row, list);
    }
    for (int32_t lane = 0; lane < 4 * shell->hinge_count; lane++) {
        int32_t row = pel_row_of(lane / 4, 4, lane % 4);
        visit_row(own, own->hinge_steps[row] / PEL_STEP, own->first_hinge_row + (size_t)row, list);
    }
}

static pel_status make_rows(pel_shell_body *own, pel_error *error)
{
    const pel_shell *shell = own->shell;
    size_t triangles = PEL_BLOCK * (size_t)pel_block_count(shell->triangle_limit);
    size_t hinges = PEL_BLOCK * (size_t)pel_block_count(shell->hinge_limit), rows = 3 * triangles + 4 * hinges;
    int32_t most = shell->triangle_limit > shell->hinge_limit ? shell->triangle_limit : shell->hinge_limit;
    own->rows = pel_allocate_aligned(rows, sizeof *own->rows);
    own->first_hinge_row = 3 * triangles;
    own->gather = pel_allocate(rows, sizeof *own->gather);
    own->gather_begin = pel_allocate((size_t)own->place_count + 2, sizeof *own->gather_begin);
    own->sums = pel_allocate((size_t)own->place_count, sizeof *own->sums);
    own->energies = pel_allocate((size_t)pel_shell_chunk_count(most, PEL_SHELL_CHUNK), sizeof *own->energies);
    own->triangle_at = pel_allocate(triangles, sizeof *own->triangle_at);
    own->hinge_at = pel_allocate(hinges, sizeof *own->hinge_at);
    own->triangle_steps = pel_allocate_aligned(3 * triangles, sizeof *own->triangle_steps);
    own->triangle_numbers = pel_allocate_aligned(PEL_TRIANGLE_NUMBERS * triangles, sizeof *own->triangle_numbers);
    own->hinge_steps = pel_allocate_aligned(4 * hinges, sizeof *own->hinge_steps);
    own->hinge_numbers = pel_allocate_aligned(PEL_HINGE_NUMBERS * hinges, sizeof *own->hinge_numbers);
    bool normal_form = shell->pressure.kind != PEL_PRESSURE_NONE && shell->pressure.form == PEL_PRESSURE_VERTEX_NORMAL;
    if (normal_form)
        own->area_vectors = pel_allocate_aligned(triangles, sizeof *own->area_vectors);
    if (own->rows == NULL || own->gather == NULL || own->gather_begin == NULL || own->sums == NULL ||
        own->energies == NULL || own->triangle_at == NULL || own->hinge_at == NULL || own->triangle_steps == NULL ||
        own->triangle_numbers == NULL || own->hinge_steps == NULL || own->hinge_numbers == NULL ||
        (normal_form && own->area_vectors == NULL))
        return pel_fail_memory(error);
    return PEL_OK;
}

static void fill_rows(pel_shell_body *own)
{
    memset(own->gather_begin, 0, ((size_t)own->place_count + 2) * sizeof *own->gather_begin);
    visit_rows(own, false);
    sum_counts(own->gather_begin, own->place_count);
    visit_rows(own, true);
}

/* ---- blocks ---- */

static int32_t lowest_place(const int32_t *vertices, int arity)
{
    int32_t least = vertices[0];
    for (int k = 1; k < arity; k++)
        least = vertices[k] < least ? vertices[k] : least;
    return least;
}

/* elements by the lowest of their places, by counting; vertices stand `stride` bytes apart */
static void sort_elements(pel_shell_body *own, const int32_t *vertices, size_t stride, int32_t count, int arity,
                          int32_t *element_at)
{
    int32_t *begin = own->gather_begin; /* filled later */
    memset(begin, 0, ((size_t)own->place_count + 2) * sizeof *begin);
    for (int pass = 0; pass < 2; pass++) {
        const char *at = (const char *)vertices;
        for (int32_t i = 0; i < count; i++, at += stride) {
            int32_t *first = begin + lowest_place((const int32_t *)(const void *)at, arity) - own->first_place;
            if (pass == 0)
                first[2]++;
            else
                element_at[first[1]++] = i;
        }
        if (pass == 0)
            sum_counts(begin, own->place_count);
    }
}

/* numbers of an element as a lane; only its places when there are no numbers for it */
static void fill_lane(int32_t *steps, pel_real *numbers, int32_t lane, int arity, int count, const int32_t *vertices,
                      const double *given)
{
    for (int k = 0; k < arity; k++)
        steps[pel_row_of(lane, arity, k)] = PEL_STEP * vertices[k];
    for (int j = 0; j < count; j++)
        numbers[pel_row_of(lane, count, j)] = given != NULL ? (pel_real)given[j] : 0;
}

static void find_triangle_numbers(const pel_shell_body *own, int32_t t, double numbers[PEL_TRIANGLE_NUMBERS])
{
    const pel_shell *shell = own->shell;
    const pel_rest_triangle *rest = &shell->triangles[t].rest;
    memcpy(numbers, rest->inverse, sizeof rest->inverse);
    numbers[3] = shell->has_membrane ? rest->area * pel_shell_law(own, t).modulus : 0;
    numbers[4] = shell->pressure_weights != NULL ? shell->pressure_weights[t] : 1;
    numbers[5] = 1;
}

static void find_hinge_numbers(const pel_shell *shell, const pel_shell_hinge *hinge, double numbers[PEL_HINGE_NUMBERS])
{
    double factor = pel_shell_hinge_factor(shell, hinge);
    memset(numbers, 0, PEL_HINGE_NUMBERS * sizeof *numbers);
    if (shell->bending == PEL_BENDING_HINGE) {
        numbers[0] = cos(hinge->hinge.rest_angle);
        numbers[1] = sin(hinge->hinge.rest_angle);
        numbers[2] = factor * hinge->hinge.factor;
        return;
    }
    memcpy(numbers, hinge->isometric.weight + 1, 3 * sizeof *numbers);
    numbers[3] = factor * hinge->isometric.factor;
    if (shell->bending == PEL_BENDING_ISOMETRIC_REST)
        numbers[4] = 2 * factor * hinge->isometric.rest_energy;
}

/* lanes without an element look at the corners of the last one, with numbers of zero */
static void fill_blocks(pel_shell_body *own)
{
    const pel_shell *shell = own->shell;
    int32_t triangles = shell->triangle_count, hinges = shell->hinge_count;
    sort_elements(own, shell->triangles[0].vertices, sizeof *shell->triangles, triangles, 3, own->triangle_at);
    for (int32_t lane = 0; lane < PEL_BLOCK * pel_block_count(triangles); lane++) {
        int32_t t = own->triangle_at[lane < triangles ? lane : triangles - 1];
        double numbers[PEL_TRIANGLE_NUMBERS];
        find_triangle_numbers(own, t, numbers);
        fill_lane(own->triangle_steps, own->triangle_numbers, lane, 3, PEL_TRIANGLE_NUMBERS,
                  shell->triangles[t].vertices, lane < triangles ? numbers : NULL);
    }
    if (hinges > 0)
        sort_elements(own, shell->hinges[0].vertices, sizeof *shell->hinges, hinges, 4, own->hinge_at);
    for (int32_t lane = 0; lane < PEL_BLOCK * pel_block_count(hinges); lane++) {
        const pel_shell_hinge *hinge = &shell->hinges[own->hinge_at[lane < hinges ? lane : hinges - 1]];
        double numbers[PEL_HINGE_NUMBERS];
        find_hinge_numbers(shell, hinge, numbers);
        fill_lane(own->hinge_steps, own->hinge_numbers, lane, 4, PEL_HINGE_NUMBERS, hinge->vertices,
                  lane < hinges ? numbers : NULL);
    }
}

static void fill_body(pel_shell_body *own)
{
    fill_fibres(own);
    fill_blocks(own);
    fill_rows(own);
}

void pel_shell_forces_rebuild(pel_shell_forces *forces, int32_t body)
{
    for (int32_t i = 0; forces != NULL && i < forces->count; i++)
        if (forces->bodies[i].body == body)
            fill_body(&forces->bodies[i]);
}

pel_status pel_shell_forces_create(const pel_model *model, pel_shell_forces **forces, pel_error *error)
{
    *forces = NULL;
    int32_t count = 0;
    for (int32_t b = 0; b < model->body_count; b++)
        count += model->bodies[b].shell != NULL;
    if (count == 0)
        return PEL_OK;
    pel_shell_forces *made = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    made->model = model;
    made->bodies = pel_allocate((size_t)count, sizeof *made->bodies);
    pel_status status = made->bodies != NULL ? PEL_OK : pel_fail_memory(error);
    for (int32_t b = 0; status == PEL_OK && b < model->body_count; b++) {
        const pel_body *body = &model->bodies[b];
        if (body->shell == NULL)
            continue;
        pel_shell_body *own = &made->bodies[made->count++];
        *own = (pel_shell_body){.shell = body->shell, .body = b, .first_place = body->slice_begin * PEL_WIDTH};
        if (body->shell->pressure.kind != PEL_PRESSURE_NONE)
            own->pressure_part = pel_pressure_is_conservative(body) ? PEL_SHELL_CONSERVATIVE : PEL_SHELL_FOLLOWER;
        own->place_count = pel_body_place_end(model, b) - own->first_place;
        status = check_bending(own, error);
        set_law(own);
        if (status == PEL_OK)
            status = make_fibres(own, error);
        if (status == PEL_OK)
            status = make_rows(own, error);
        if (status == PEL_OK)
            fill_body(own);
    }
    if (status == PEL_OK)
        *forces = made;
    else
        pel_shell_forces_destroy(made);
    return status;
}

void pel_shell_forces_destroy(pel_shell_forces *forces)
{
    if (forces == NULL)
        return;
    for (int32_t i = 0; i < forces->count; i++) {
        pel_shell_body *own = &forces->bodies[i];
        void *arrays[] = {own->fibre_begin, own->fibres,       own->rows,           own->area_vectors,
                          own->energies,    own->gather_begin, own->gather,         own->sums,
                          own->triangle_at, own->hinge_at,     own->triangle_steps, own->triangle_numbers,
                          own->hinge_steps, own->hinge_numbers};
        for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++)
            pel_free(arrays[k]);
    }
    pel_free(forces->bodies);
    pel_free(forces);
}
