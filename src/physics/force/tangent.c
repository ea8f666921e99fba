#include "force/tangent.h"

#include "base/assert.h"
#include "force/pressure.h"
#include "force/tangent_body.h"
#include "math/vec3.h"

#include <string.h>

/* the element at hand: its vertices, its part of the step, and where its derivatives go */
typedef struct tangent_element {
    double x[PEL_TANGENT_UNKNOWNS], step[PEL_TANGENT_UNKNOWNS];
    pel_tangent_sum sum;
    double strain[PEL_VISCOUS_NUMBERS]; /* of elements with one strain */
} tangent_element;

/* ---- elements ---- */

static double curve_value(const pel_curve *curve, double time)
{
    return pel_curve_value(curve->keys, curve->key_count, time);
}

static pel_tangent_request request_of(const pel_tangent_loop *loop, tangent_element *element, int32_t stress)
{
    const double *viscous = loop->input->viscous;
    return (pel_tangent_request){
        .kind = loop->input->kind,
        .stress = loop->input->stresses != NULL ? loop->input->stresses + stress : NULL,
        .step = loop->step != NULL ? element->step : NULL,
        .extrapolated = loop->stresses != NULL ? loop->stresses + stress : NULL,
        .viscous = viscous != NULL ? viscous + PEL_VISCOUS_NUMBERS * (size_t)stress : NULL,
        .rate = loop->input->rate,
        .strain = loop->viscous != NULL ? element->strain : NULL,
    };
}

/* after an element with one strain */
static void refer(const pel_tangent_loop *loop, const tangent_element *element, int32_t stress, double retardation)
{
    if (loop->viscous != NULL)
        pel_tangent_refer(loop, stress, retardation, element->strain);
}

/* a follower force, which has no stress */
static void add_push(const pel_tangent_loop *loop, const pel_anisotropy_def *def, const pel_line *line, int32_t stress,
                     const tangent_element *element)
{
    const pel_tangent_request request = {.kind = loop->input->kind};
    if (loop->stresses != NULL)
        loop->stresses[stress] = 0;
    if (loop->viscous != NULL)
        memset(loop->viscous + PEL_VISCOUS_NUMBERS * (size_t)stress, 0, PEL_VISCOUS_NUMBERS * sizeof(double));
    if (pel_tangent_sums(loop) && !loop->input->leaves_followers)
        pel_push_tangent(line, def->stiffness / (3 * def->gradient), element->x, &request, &element->sum);
}

static double add_fibres(const pel_tangent_loop *loop, const pel_tangent_shell *own, int32_t t, int32_t stress,
                         tangent_element *element)
{
    PEL_ASSERT_INDEX(t, own->shell->triangle_count);
    double energy = 0;
    for (int32_t i = own->fibre_begin[t]; i < own->fibre_begin[t + 1]; i++) {
        const pel_tangent_fibre *fibre = &own->fibres[i];
        const pel_shell_region *region = &own->shell->regions[fibre->region];
        bool active = region->def.mode == PEL_FIBRE_ACTIVE, squared = !active && region->def.kind == PEL_FIBRE_STVK;
        const bool is_muscle = region->def.mode == PEL_FIBRE_MUSCLE;
        const double amount =
            active || is_muscle ? region->amount * curve_value(&region->course, loop->input->span.time) : 1;
        const pel_line line =
            is_muscle ? pel_line_of_muscle(&own->rests[t], amount * fibre->stiffness, region->def.optimum,
                                           region->def.width, fibre->direction)
                      : pel_line_of_fibre(&own->rests[t], squared, fibre->stiffness, amount, fibre->direction);
        if (region->def.mode == PEL_FIBRE_NORMAL) {
            add_push(loop, &region->def, &line, stress + i - own->fibre_begin[t], element);
            continue;
        }
        const pel_tangent_request request = request_of(loop, element, stress + i - own->fibre_begin[t]);
        energy += pel_line_tangent(&line, element->x, &request, &element->sum);
        refer(loop, element, stress + i - own->fibre_begin[t], 0);
    }
    return energy;
}

/* what a triangle has besides membrane and mid-edge bending */
static bool has_more(const pel_tangent_loop *loop, const pel_tangent_shell *own)
{
    return own->fibre_begin != NULL || (own->pressure != 0 && pel_tangent_sums(loop));
}

static void add_triangle(const pel_tangent_loop *loop, const pel_tangent_part *part, int32_t t,
                         tangent_element *element, pel_tangent_energy *energy)
{
    const pel_tangent_shell *own = &loop->tangent->shells[part->shell];
    const pel_shell *shell = own->shell;
    if (own->fibre_begin != NULL)
        energy->fibres += add_fibres(loop, own, t, pel_tangent_stress(own, part, t) + part->strains, element);
    if (own->pressure != 0 && pel_tangent_sums(loop)) {
        double weight = shell->pressure_weights != NULL ? shell->pressure_weights[t] : 1;
        const pel_tangent_request request = {.kind = loop->input->kind};
        pel_tangent_sum sum = element->sum;
        if (own->normal_pressure[0] != NULL)
            sum.gradient = NULL;
        pel_pressure_tangent(weight * own->pressure, element->x, &request, &sum);
    }
}

static double add_angle(const pel_tangent_loop *loop, const pel_tangent_shell *own, int32_t i,
                        const tangent_element *element, const pel_tangent_request *request)
{
    const pel_shell *shell = own->shell;
    const double stiffness = pel_shell_hinge_stiffness(shell, i);
    const pel_fold *folds = loop->input->state != NULL ? loop->input->state->plastic.folds : NULL;
    if (shell->yield_angles == NULL || folds == NULL)
        return pel_hinge_tangent(&own->hinges[i], stiffness, element->x, request, &element->sum);
    const pel_yield yield = pel_shell_yield(shell, i, folds);
    pel_hinge hinge = own->hinges[i];
    hinge.rest_angle += folds[shell->first_fold + i].angle;
    return pel_fold_tangent(&hinge, &yield, stiffness, element->x, request, &element->sum);
}

static void add_hinge(const pel_tangent_loop *loop, const pel_tangent_part *part, int32_t i, tangent_element *element,
                      pel_tangent_energy *energy)
{
    PEL_ASSERT_INDEX(i, part->count);
    const pel_tangent_shell *own = &loop->tangent->shells[part->shell];
    const pel_shell *shell = own->shell;
    const int32_t stress = part->first_stress + i * part->strains;
    const pel_tangent_request request = request_of(loop, element, stress);
    if (own->hinges != NULL) {
        energy->bending += add_angle(loop, own, i, element, &request);
        refer(loop, element, stress, shell->bending_retardation);
        return;
    }
    const pel_shell_hinge hinge = pel_shell_hinge_of(shell, i);
    const pel_bending_isometric stencil = pel_shell_isometric(loop->tangent->model->rest, &hinge);
    const pel_line line = pel_line_of_isometric(&stencil, hinge.stiffness);
    energy->bending += pel_line_tangent(&line, element->x, &request, &element->sum);
    if (shell->bending->form == PEL_BENDING_REST_SUBTRACTED)
        energy->bending -= hinge.stiffness / 3 * stencil.rest_energy;
}

/* has no strains of its own: neither mixed integration points nor rates */
static void add_tetra(const pel_tangent_loop *loop, const pel_tangent_part *part, int32_t t, tangent_element *element,
                      pel_tangent_energy *energy)
{
    PEL_ASSERT_INDEX(t, part->count);
    const pel_tangent_shell *own = &loop->tangent->shells[part->shell];
    energy->volume += pel_tetra_tangent(&own->tetras[t], &own->shell->solid, own->tetra_scales[t], element->x,
                                        loop->input->kind, &element->sum);
}

static void add_star(const pel_tangent_loop *loop, const pel_tangent_part *part, int32_t i, const pel_tangent_sum *sum,
                     pel_tangent_energy *energy)
{
    PEL_ASSERT_INDEX(i, part->count);
    const pel_shell *shell = loop->tangent->shells[part->shell].shell;
    double x[3 * PEL_STAR_NODES];
    pel_tangent_points(loop->input->unknowns, loop->tangent->nodes + loop->tangent->node_begin[part->first + i],
                       part->nodes, x);
    energy->volume += pel_star_tangent(shell->stars, part->first_star + i, &shell->solid, x, loop->input->kind, sum);
}

static double factor_of(const pel_tangent_loop *loop, int32_t body, pel_parameter parameter)
{
    return loop->input->state != NULL ? loop->input->state->factors[body][parameter] : 1;
}

static void add_spring(const pel_tangent_loop *loop, const pel_tangent_part *part, int32_t i, tangent_element *element,
                       pel_tangent_energy *energy)
{
    PEL_ASSERT_INDEX(i, part->count);
    const pel_tangent_spring *spring = &loop->tangent->springs[i];
    const pel_line line = pel_line_of_spring(spring->stiffness * factor_of(loop, spring->body, PEL_SPRING_STIFFNESS),
                                             spring->rest_length);
    const int32_t stress = part->first_stress + i * part->strains;
    const pel_tangent_request request = request_of(loop, element, stress);
    energy->springs += pel_line_tangent(&line, element->x, &request, &element->sum);
    refer(loop, element, stress, loop->tangent->model->bodies[spring->body].spring_retardation);
}

/* a spring of length 0 from a vertex to a point */
static double add_point_spring(double stiffness, const double point[3], const tangent_element *element)
{
    double offset[3];
    pel_vec3_subtract(element->x, point, offset);
    for (int c = 0; c < 3; c++) {
        if (element->sum.gradient != NULL)
            element->sum.gradient[c] += stiffness * offset[c];
        if (element->sum.hessian != NULL)
            element->sum.hessian[4 * c] += stiffness;
    }
    return 0.5 * stiffness * pel_vec3_squared_length(offset);
}

static void add_point(const pel_tangent_loop *loop, int32_t i, const tangent_element *element,
                      pel_tangent_energy *energy)
{
    const pel_model *model = loop->tangent->model;
    int32_t v = loop->tangent->points[i], body = model->body_of_slice[v / PEL_WIDTH];
    double rest[3], stiffness = (double)model->rest[v][3];
    if (stiffness != 0) {
        pel_vertex_position(model->rest, v, rest);
        energy->springs += add_point_spring(stiffness * factor_of(loop, body, PEL_VOLUMETRIC_STIFFNESS), rest, element);
    }
    if (loop->input->point_stiffness != NULL && loop->input->point_stiffness[v] != 0)
        energy->points += add_point_spring(loop->input->point_stiffness[v], loop->input->points[v], element);
}

static void load_element(const pel_tangent_loop *loop, const pel_tangent_part *part, int32_t number,
                         tangent_element *element)
{
    const pel_tangent *tangent = loop->tangent;
    const int32_t *nodes = tangent->nodes + tangent->node_begin[number];
    int vertices = (part->unknowns - part->nodes) / 2;
    size_t edges = 2 * (size_t)tangent->pattern.vertex_count;
    pel_tangent_points(loop->input->unknowns, nodes, vertices, element->x);
    if (loop->step != NULL) {
        pel_tangent_points(loop->step, nodes, vertices, element->step);
        for (int k = vertices; k < part->nodes; k++)
            element->step[2 * vertices + k] = loop->step[edges + (size_t)nodes[k]];
    }
}

/* element i of a part: adds its derivatives to `sum`, of a triangle those besides pel_tangent_triangles */
static void add_element(const pel_tangent_loop *loop, const pel_tangent_part *part, int32_t i, pel_tangent_sum sum,
                        pel_tangent_energy *energy)
{
    PEL_ASSERT_INDEX(i, part->count);
    tangent_element element;
    if (part->kind == PEL_TANGENT_PART_STARS) {
        add_star(loop, part, i, &sum, energy);
        return;
    }
    element.sum = sum;
    load_element(loop, part, part->first + i, &element);
    if (part->kind == PEL_TANGENT_PART_TRIANGLES)
        add_triangle(loop, part, i, &element, energy);
    else if (part->kind == PEL_TANGENT_PART_TETRAHEDRA)
        add_tetra(loop, part, i, &element, energy);
    else if (part->kind == PEL_TANGENT_PART_HINGES)
        add_hinge(loop, part, i, &element, energy);
    else if (part->kind == PEL_TANGENT_PART_SPRINGS)
        add_spring(loop, part, i, &element, energy);
    else
        add_point(loop, i, &element, energy);
}

/* elements of a part: sets their gradients or matrices, where they are not null */
static void evaluate_elements(const pel_tangent_loop *loop, const pel_tangent_part *part, const int32_t *elements,
                              int32_t count, double *gradients, double *matrices, pel_tangent_energy *energy)
{
    const bool are_triangles = part->kind == PEL_TANGENT_PART_TRIANGLES;
    const size_t n = (size_t)part->unknowns;
    if (part->kind == PEL_TANGENT_PART_TETRAHEDRA && matrices == NULL) {
        pel_tangent_tetrahedra(loop, part, elements, count, gradients, energy);
        return;
    }
    if (are_triangles)
        pel_tangent_triangles(loop, part, elements, count, gradients, matrices, energy);
    else if (gradients != NULL)
        memset(gradients, 0, (size_t)count * n * sizeof *gradients);
    else if (matrices != NULL)
        memset(matrices, 0, (size_t)count * n * n * sizeof *matrices);
    if (are_triangles && !has_more(loop, &loop->tangent->shells[part->shell]))
        return;
    for (int32_t k = 0; k < count; k++) {
        const pel_tangent_sum sum = {gradients != NULL ? gradients + (size_t)k * n : NULL,
                                     matrices != NULL ? matrices + (size_t)k * n * n : NULL, part->unknowns};
        add_element(loop, part, elements[k], sum, energy);
    }
}

void pel_tangent_matrices(void *context, const int32_t *elements, int32_t count, double *blocks)
{
    pel_tangent *tangent = context;
    const pel_tangent_loop loop = {.tangent = tangent, .input = &tangent->input};
    pel_tangent_energy energy = {0};
    int32_t of_part[PEL_TANGENT_CHUNK], found;
    for (int32_t k = 0; k < count; k += found) {
        const pel_tangent_part *part = tangent->parts;
        while (elements[k] >= part->first + part->count)
            part++;
        for (found = 0; k + found < count && found < PEL_TANGENT_CHUNK; found++) {
            of_part[found] = elements[k + found] - part->first;
            if (of_part[found] < 0 || of_part[found] >= part->count)
                break;
        }
        evaluate_elements(&loop, part, of_part, found, NULL, blocks, &energy);
        blocks += (size_t)found * (size_t)part->unknowns * (size_t)part->unknowns;
    }
}

static void element_chunk(void *context, int32_t chunk)
{
    const pel_tangent_loop *loop = context;
    const pel_tangent *tangent = loop->tangent;
    const pel_tangent_part *part = tangent->parts;
    while (chunk >= part->first_chunk + pel_tangent_chunk_count(part->count))
        part++;
    pel_tangent_energy energy = {0};
    int32_t first = (chunk - part->first_chunk) * PEL_TANGENT_CHUNK, elements[PEL_TANGENT_CHUNK], count = 0;
    while (count < PEL_TANGENT_CHUNK && first + count < part->count) {
        elements[count] = first + count;
        count++;
    }
    double *gradients = NULL;
    if (loop->gradient != NULL)
        gradients = tangent->rows + part->first_row + (size_t)first * (size_t)part->unknowns;
    evaluate_elements(loop, part, elements, count, gradients, NULL, &energy);
    tangent->energies[chunk] = energy;
}

/* ---- nodes ---- */

static void node_chunk(void *context, int32_t chunk)
{
    const pel_tangent_loop *loop = context;
    const pel_tangent *tangent = loop->tangent;
    int32_t vertices = tangent->pattern.vertex_count, count = vertices + tangent->pattern.edge_count;
    int32_t first = chunk * PEL_TANGENT_CHUNK, end = first + PEL_TANGENT_CHUNK;
    for (int32_t node = first; node < end && node < count; node++) {
        double sum[3] = {0, 0, 0};
        int size = node < vertices ? 3 : 1;
        for (int32_t i = tangent->gather_begin[node]; i < tangent->gather_begin[node + 1]; i++)
            for (int c = 0; c < size; c++)
                sum[c] += tangent->rows[tangent->gather[i] + c];
        size_t at = node < vertices ? 3 * (size_t)node : 2 * (size_t)vertices + (size_t)node;
        memcpy(loop->gradient + at, sum, (size_t)size * sizeof(double));
    }
}

/* ---- pressure ---- */

/* volume about the first corner, so that it is exact far from the origin */
static double shell_volume(const pel_tangent_loop *loop, const pel_tangent_shell *own)
{
    double volume = 0, origin[3] = {0, 0, 0}, x[9];
    for (int32_t t = 0; t < own->shell->triangle_count; t++) {
        pel_tangent_points(loop->input->unknowns, own->shell->corners[t], 3, x);
        if (t == 0)
            pel_vec3_copy(x, origin);
        volume += pel_vec3_cone_volume(origin, x, x + 3, x + 6);
    }
    return volume;
}

/* the vector that a triangle's pressure is multiplied by, on each corner: a sixth of its normal, twice its area long */
static void pressure_vector(const pel_tangent_loop *loop, const pel_tangent_shell *own, int32_t t, double vector[3])
{
    PEL_ASSERT_INDEX(t, own->shell->triangle_count);
    double x[9], weight = own->shell->pressure_weights != NULL ? own->shell->pressure_weights[t] : 1;
    pel_tangent_points(loop->input->unknowns, own->shell->corners[t], 3, x);
    pel_vec3_triangle_normal(x, x + 3, x + 6, vector);
    pel_vec3_scale(vector, weight / 6, vector);
}

static void fill_rank_one(const pel_tangent_loop *loop, const pel_tangent_shell *own, double slope)
{
    pel_rank_one *rank_one = own->rank_one;
    rank_one->coefficient = -slope;
    memset(rank_one->gradient, 0, 3 * (size_t)rank_one->vertex_count * sizeof(double));
    for (int32_t t = 0; t < own->shell->triangle_count; t++) {
        double vector[3];
        pressure_vector(loop, own, t, vector);
        for (int k = 0; k < 3; k++) {
            double *at = rank_one->gradient + 3 * (own->shell->corners[t][k] - rank_one->first_vertex);
            pel_vec3_add(at, vector, at);
        }
    }
}

/* sets the body's pressure; returns its potential */
static double find_pressure(const pel_tangent_loop *loop, pel_tangent_shell *own)
{
    const pel_body *body = &loop->tangent->model->bodies[own->body];
    const pel_shell *shell = own->shell;
    own->pressure = 0;
    bool conservative = pel_pressure_is_conservative(body);
    if (shell->pressure.kind == PEL_PRESSURE_NONE || (loop->input->leaves_followers && !conservative))
        return 0;
    const pel_span span = loop->input->span;
    double volume = body->rest_volume;
    double factor = loop->input->load_factor != NULL ? *loop->input->load_factor : 1;
    if (conservative || own->rank_one != NULL)
        volume = shell_volume(loop, own);
    own->pressure = pel_pressure_difference(shell, span, factor, volume, body->rest_volume);
    if (own->rank_one != NULL && loop->gradient != NULL)
        fill_rank_one(loop, own, pel_pressure_slope(shell, volume, body->rest_volume));
    return conservative ? pel_pressure_potential(shell, span, factor, volume, body->rest_volume) : 0;
}

/* the paper's pressure: a third of the areas around along the vertex's normal */
static void add_normal_pressure(const pel_tangent_loop *loop, const pel_tangent_shell *own)
{
    const pel_model *model = loop->tangent->model;
    int32_t first = model->bodies[own->body].slice_begin * PEL_WIDTH;
    int32_t count = pel_body_place_end(model, own->body) - first;
    for (int i = 0; i < 4; i++)
        memset(own->normal_pressure[i], 0, (size_t)count * sizeof(double));
    for (int32_t t = 0; t < own->shell->triangle_count; t++) {
        double vector[3];
        pressure_vector(loop, own, t, vector);
        for (int k = 0; k < 3; k++) {
            int32_t v = own->shell->corners[t][k] - first;
            for (int c = 0; c < 3; c++)
                own->normal_pressure[c][v] += vector[c];
            own->normal_pressure[3][v] += pel_vec3_length(vector);
        }
    }
    for (int32_t v = 0; v < count; v++) {
        double normal[3] = {own->normal_pressure[0][v], own->normal_pressure[1][v], own->normal_pressure[2][v]};
        double *at = loop->gradient + 3 * ((size_t)first + (size_t)v);
        pel_vec3_normalize(normal);
        pel_vec3_along(at, -own->pressure * own->normal_pressure[3][v], normal, at);
    }
}

/* ---- evaluation ---- */

static pel_tangent_energy run_loop(pel_tangent_loop *loop, pel_pool *pool)
{
    pel_tangent *tangent = loop->tangent;
    pel_tangent_energy energy = {0};
    pel_tangent_find_angles(tangent, loop->input->unknowns, pool);
    for (int32_t i = 0; i < tangent->shell_count && pel_tangent_sums(loop); i++)
        energy.pressure += find_pressure(loop, &tangent->shells[i]);
    pel_pool_run(pool, tangent->chunk_count, element_chunk, loop);
    for (int32_t chunk = 0; chunk < tangent->chunk_count; chunk++) {
        const pel_tangent_energy *own = &tangent->energies[chunk];
        energy.membrane += own->membrane;
        energy.volume += own->volume;
        energy.fibres += own->fibres;
        energy.bending += own->bending;
        energy.edges += own->edges;
        energy.springs += own->springs;
        energy.points += own->points;
    }
    if (loop->gradient == NULL)
        return energy;
    int32_t nodes = tangent->pattern.vertex_count + tangent->pattern.edge_count;
    pel_pool_run(pool, pel_tangent_chunk_count(nodes), node_chunk, loop);
    for (int32_t i = 0; i < tangent->shell_count; i++)
        if (tangent->shells[i].normal_pressure[0] != NULL && tangent->shells[i].pressure != 0)
            add_normal_pressure(loop, &tangent->shells[i]);
    return energy;
}

pel_tangent_energy pel_tangent_evaluate(pel_tangent *tangent, const pel_tangent_input *input, pel_pool *pool,
                                        double *gradient)
{
    tangent->input = *input;
    pel_tangent_loop loop = {.tangent = tangent, .input = input, .gradient = gradient};
    return run_loop(&loop, pool);
}

void pel_tangent_add_rank_ones(const pel_tangent_pattern *pattern, const uint8_t *fixed, const double *x, double *y)
{
    for (int32_t r = 0; r < pattern->rank_one_count; r++) {
        const pel_rank_one *one = &pattern->rank_ones[r];
        const int32_t begin = 3 * one->first_vertex, count = 3 * one->vertex_count;
        double product = 0;
        for (int32_t i = 0; one->coefficient > 0 && i < count; i++)
            product += fixed[begin + i] ? 0 : one->gradient[i] * x[begin + i];
        for (int32_t i = 0; one->coefficient > 0 && i < count; i++)
            y[begin + i] += fixed[begin + i] ? 0 : one->coefficient * product * one->gradient[i];
    }
}

double pel_tangent_energy_sum(const pel_tangent_energy *energy)
{
    return energy->membrane + energy->volume + energy->fibres + energy->bending + energy->edges + energy->springs +
           energy->points + energy->pressure;
}

/* a loop that leaves the last evaluation as it is */
static pel_tangent_energy run_beside(pel_tangent_loop *loop, pel_pool *pool)
{
    pel_tangent *tangent = loop->tangent;
    size_t bytes = (size_t)tangent->pattern.edge_count * sizeof *tangent->half_angles;
    if (bytes > 0)
        memcpy(tangent->settle[0], tangent->half_angles, bytes);
    const pel_tangent_energy energy = run_loop(loop, pool);
    if (bytes > 0)
        memcpy(tangent->half_angles, tangent->settle[0], bytes);
    return energy;
}

void pel_tangent_extrapolate(pel_tangent *tangent, const pel_tangent_input *input, const double *step, pel_pool *pool,
                             double *stresses)
{
    pel_tangent_loop loop = {.tangent = tangent, .input = input, .step = step, .stresses = stresses};
    run_beside(&loop, pool);
}

/* ---- rates of strain ---- */

bool pel_tangent_is_viscous(const pel_tangent *tangent)
{
    bool any = false;
    for (int32_t b = 0; b < tangent->model->body_count; b++)
        any |= pel_body_is_viscous(&tangent->model->bodies[b]);
    return any;
}

void pel_tangent_refer_rates(pel_tangent *tangent, const pel_tangent_input *input, double weight, bool is_other,
                             pel_pool *pool, double *viscous)
{
    pel_tangent_input own = *input;
    own.kind = PEL_TANGENT_POSITIVE;
    own.viscous = NULL;
    pel_tangent_loop loop = {
        .tangent = tangent, .input = &own, .viscous = viscous, .weight = weight, .is_other = is_other};
    run_beside(&loop, pool);
}

double pel_tangent_viscous_loss(pel_tangent *tangent, const pel_tangent_input *input, pel_pool *pool)
{
    double sum = 0;
    for (int i = 0; i < 2; i++) {
        pel_tangent_input own = *input;
        own.viscous = i == 0 ? input->viscous : NULL;
        own.leaves_followers = true;
        pel_tangent_loop loop = {.tangent = tangent, .input = &own};
        const pel_tangent_energy energy = run_beside(&loop, pool);
        /* twice the part of the energy that the rates are */
        sum += (i == 0 ? 2 : -2) * (energy.membrane + energy.bending + energy.edges + energy.springs);
    }
    return sum;
}

void pel_tangent_follow(pel_tangent *tangent, const double *unknowns)
{
    for (int32_t b = 0; b < tangent->shell_count; b++) {
        const pel_tangent_shell *own = &tangent->shells[b];
        for (int32_t t = 0; own->fibre_begin != NULL && t < own->shell->triangle_count; t++)
            for (int32_t i = own->fibre_begin[t]; i < own->fibre_begin[t + 1]; i++) {
                if (own->shell->regions[own->fibres[i].region].def.direction != PEL_FIBRE_PRINCIPAL)
                    continue;
                double x[3][3];
                pel_tangent_points(unknowns, own->shell->corners[t], 3, x[0]);
                pel_principal_direction(&own->rests[t], (const double(*)[3])x, own->fibres[i].direction);
            }
    }
}
