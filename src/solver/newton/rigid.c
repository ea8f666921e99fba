/* Rigid bodies among the unknowns of Newton's method.

   Energy and gradient are those of the vertices x = p + R X, wherever these come from: springs of inertia, loads,
   contacts, ties. A system has six unknowns of each body: the way w of the pivot and the rotation vector t, which move
   a vertex with the arm r by w + t x r. With J = (I, -[r]) of each vertex forces become J^T f, blocks of the matrix
   J_i^T K J_j. The six stand in the places of two vertices (t times a length, so that all are in metres); the others
   have a row of zeros and one. After each step R is the rotation that fits the vertices best, and the vertices go to
   their places: ways along a step are straight only to first order.

   The springs of inertia of the vertices have the mass and the center of the body, but their moments of inertia are
   others: the difference acts on R alone. The springs end at points p' + R' X, so the energy of a body with the second
   moments C about the pivot is half of rate^2 tr (R - R') C (R - R')^T, for any rotation between. In statics the
   second derivative of the turn, with the forces at hand, belongs to the matrix: sum of sym(r g^T) - (r . g) I. */
#include "base/assert.h"
#include "base/memory.h"
#include "base/status.h"
#include "newton/run.h"

#include <math.h>
#include <string.h>

enum { MOST_NODES = 8 };
/* of their sum, on the diagonal of second moments of pins on a line */
#define SPREAD 1e-9
/* of the weight over the size */
#define NEUTRAL 1e-6

/* ---- vectors ---- */

static void reduce_forces(const pel_newton_rigids *rigids, const pel_newton_rigid *rigid, double *vector)
{
    double force[3] = {0}, torque[3] = {0}, turn[3];
    for (int32_t v = rigid->body->begin; v < rigid->body->end; v++) {
        double *own = vector + 3 * (size_t)v;
        pel_vec3_cross(rigids->arms[v], own, turn);
        pel_vec3_add(force, own, force);
        pel_vec3_add(torque, turn, torque);
        pel_vec3_set(own, 0, 0, 0);
    }
    pel_vec3_copy(force, vector + 3 * (size_t)rigid->at);
    for (int k = 0; k < 3; k++)
        vector[3 * (size_t)rigid->turn + (size_t)k] = pel_vec3_dot(rigid->axes[k], torque) / rigid->length;
}

static void take_six(const pel_newton_rigid *rigid, const double *vector, double scale, double way[3], double turn[3])
{
    pel_vec3_copy(vector + 3 * (size_t)rigid->at, way);
    pel_vec3_set(turn, 0, 0, 0);
    for (int k = 0; k < 3; k++)
        pel_vec3_along(turn, scale * vector[3 * (size_t)rigid->turn + (size_t)k], rigid->axes[k], turn);
}

static void expand_ways(const pel_newton_rigids *rigids, const pel_newton_rigid *rigid, double *vector)
{
    double way[3], turn[3], aside[3];
    take_six(rigid, vector, 1 / rigid->length, way, turn);
    for (int32_t v = rigid->body->begin; v < rigid->body->end; v++) {
        pel_vec3_cross(turn, rigids->arms[v], aside);
        pel_vec3_add(way, aside, vector + 3 * (size_t)v);
    }
}

/* whether a vertex carries what is spread: the pins of a body that has some, else all */
static bool carries(const pel_newton_rigids *rigids, const pel_rigid *body, int32_t v)
{
    PEL_ASSERT(v >= body->begin && v < body->end);
    return (double)rigids->masses[v] > 0 && (body->shape->is_free || !(rigids->bodies->inverse_mass[v] > 0));
}

/* the middle of the arms of these, and the sum of |x|^2 - x x^T of arms from there; returns their number */
static int32_t find_spread(const pel_newton_rigids *rigids, const pel_rigid *body, double middle[3],
                           double spread[3][3])
{
    int32_t count = 0;
    double x[3];
    pel_vec3_set(middle, 0, 0, 0);
    for (int32_t v = body->begin; v < body->end; v++)
        if (carries(rigids, body, v)) {
            pel_vec3_add(middle, rigids->arms[v], middle);
            count++;
        }
    pel_vec3_scale(middle, count > 0 ? 1.0 / count : 0, middle);
    for (int32_t v = body->begin; v < body->end; v++) {
        if (!carries(rigids, body, v))
            continue;
        pel_vec3_subtract(rigids->arms[v], middle, x);
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++)
                spread[a][b] += (a == b ? pel_vec3_squared_length(x) : 0) - x[a] * x[b];
    }
    double trace = spread[0][0] + spread[1][1] + spread[2][2];
    for (int a = 0; a < 3; a++)
        spread[a][a] += SPREAD * trace;
    return count;
}

/* the least forces with the sum and the torque of the six */
static void spread_forces(const pel_newton_rigids *rigids, const pel_newton_rigid *rigid, double *vector)
{
    const pel_rigid *body = rigid->body;
    double force[3], torque[3], middle[3], x[3], own[3], spread[3][3] = {{0}}, inverse[3][3], turn[3];
    take_six(rigid, vector, rigid->length, force, torque);
    int32_t count = find_spread(rigids, body, middle, spread);
    pel_vec3_cross(middle, force, own);
    pel_vec3_subtract(torque, own, torque);
    pel_inertia_invert((const double(*)[3])spread, inverse);
    for (int a = 0; a < 3; a++)
        turn[a] = pel_vec3_dot(inverse[a], torque);
    for (int32_t v = body->begin; v < body->end; v++) {
        pel_vec3_subtract(rigids->arms[v], middle, x);
        pel_vec3_cross(turn, x, own);
        pel_vec3_along(own, count > 0 ? 1.0 / count : 0, force, own);
        pel_vec3_scale(own, carries(rigids, body, v) ? 1 : 0, vector + 3 * (size_t)v);
    }
}

/* ---- frames ---- */

static void turn_back(const pel_newton_frames *frames, double *vector)
{
    for (int32_t f = 0; f < frames->count; f++) {
        double *x = vector + 3 * (size_t)frames->vertices[f], turned[3] = {0};
        for (int k = 0; k < 3; k++)
            pel_vec3_along(turned, x[k], frames->axes[f][k], turned);
        pel_vec3_copy(turned, x);
    }
}

void pel_newton_frames_turn(const pel_newton_frames *frames, double *vector)
{
    for (int32_t f = 0; f < frames->count; f++) {
        double *x = vector + 3 * (size_t)frames->vertices[f], turned[3];
        for (int k = 0; k < 3; k++)
            turned[k] = pel_vec3_dot(frames->axes[f][k], x);
        pel_vec3_copy(turned, x);
    }
    for (int32_t i = 0; frames->rigids != NULL && i < frames->rigids->count; i++)
        reduce_forces(frames->rigids, &frames->rigids->items[i], vector);
}

void pel_newton_frames_turn_back(const pel_newton_frames *frames, double *vector)
{
    turn_back(frames, vector);
    for (int32_t i = 0; frames->rigids != NULL && i < frames->rigids->count; i++)
        expand_ways(frames->rigids, &frames->rigids->items[i], vector);
}

void pel_newton_frames_turn_forces_back(const pel_newton_frames *frames, double *vector)
{
    turn_back(frames, vector);
    for (int32_t i = 0; frames->rigids != NULL && i < frames->rigids->count; i++)
        spread_forces(frames->rigids, &frames->rigids->items[i], vector);
}

/* ---- energy and forces ---- */

/* the pivot goes where the origin has gone, about which the body turns */
static void follow_origin(const pel_newton_rigids *rigids, const pel_newton_rigid *rigid, const double *unknowns)
{
    pel_rigid *body = rigid->body;
    double arm[3], way[3], origin[3] = {0};
    for (int32_t v = body->begin; v < body->end; v++) {
        pel_vertex_position(rigids->bodies->rest, v, arm);
        pel_vec3_subtract(arm, rigid->middle, arm);
        double share = (double)rigids->masses[v] * (rigid->share + pel_vec3_dot(rigid->tilt, arm));
        pel_vec3_along(origin, share, unknowns + 3 * (size_t)v, origin);
    }
    pel_vec3_subtract(body->shape->pivot, rigid->origin, arm);
    for (int k = 0; k < 3; k++)
        way[k] = pel_vec3_dot(body->matrix[k], arm);
    pel_vec3_add(origin, way, body->state.pivot);
}

/* where the origin is */
static void find_origin(const pel_newton_rigid *rigid, double origin[3])
{
    const pel_rigid *body = rigid->body;
    double arm[3];
    pel_vec3_subtract(rigid->origin, body->shape->pivot, arm);
    for (int k = 0; k < 3; k++)
        origin[k] = body->state.pivot[k] + pel_vec3_dot(body->matrix[k], arm);
}

void pel_newton_rigids_follow(newton_run *run)
{
    double origin[3];
    const pel_newton_rigids *rigids = run->problem->frames.rigids;
    for (int32_t i = 0; rigids != NULL && i < rigids->count; i++) {
        pel_rigid *body = rigids->items[i].body;
        pel_rigid_fit_to(body, rigids->bodies, rigids->masses, run->unknowns, false);
        if (rigids->items[i].share > 0)
            follow_origin(rigids, &rigids->items[i], run->unknowns);
        pel_rigid_place_in(body, rigids->bodies, run->unknowns);
        find_origin(&rigids->items[i], origin);
        for (int32_t v = body->begin; v < body->end; v++)
            pel_vec3_subtract(run->unknowns + 3 * (size_t)v, origin, rigids->arms[v]);
    }
}

/* energy of the inertia that vertices lack, and its torque: sum over columns of R_k x ((R - target) lack)_k */
static double find_torque(pel_newton_rigid *rigid)
{
    const double(*r)[3] = (const double(*)[3])rigid->body->matrix;
    double energy = 0, pull[3][3];
    for (int i = 0; i < 3; i++) {
        double way[3];
        pel_vec3_subtract(r[i], rigid->target[i], way);
        for (int k = 0; k < 3; k++)
            pull[i][k] = pel_vec3_dot(way, rigid->lack[k]);
        energy += 0.5 * pel_vec3_dot(way, pull[i]);
    }
    pel_vec3_set(rigid->torque, 0, 0, 0);
    for (int k = 0; k < 3; k++) {
        const double column[3] = {r[0][k], r[1][k], r[2][k]}, own[3] = {pull[0][k], pull[1][k], pull[2][k]};
        double turn[3];
        pel_vec3_cross(column, own, turn);
        pel_vec3_add(rigid->torque, turn, rigid->torque);
    }
    return energy;
}

/* ---- rows ---- */

static pel_newton_rigid *item_of(const pel_newton_rigids *rigids, const pel_rigid *body)
{
    for (int32_t i = 0; body != NULL && i < rigids->count; i++)
        if (rigids->items[i].body == body)
            return &rigids->items[i];
    return NULL;
}

/* of the error, by the rotation vector about the origin, and the arm from there */
static void row_turn(const pel_newton_rigid *rigid, const pel_newton_row *row, int side, double arm[3], double turn[3])
{
    double origin[3], lever[3];
    find_origin(rigid, origin);
    pel_vec3_subtract(row->points[side], origin, arm);
    pel_vec3_cross(arm, row->force, lever);
    pel_vec3_cross(row->directors[0], row->directors[1], turn);
    pel_vec3_add(turn, row->torque, turn);
    pel_vec3_add(turn, lever, turn);
    pel_vec3_scale(turn, side == 0 ? 1 : -1, turn);
}

static void push(pel_newton_rigid *rigid, const pel_newton_row *row, int side)
{
    double arm[3], turn[3], along = side == 0 ? row->present : -row->present;
    row_turn(rigid, row, side, arm, turn);
    pel_vec3_along(rigid->force, along, row->force, rigid->force);
    pel_vec3_along(rigid->torque, row->present, turn, rigid->torque);
    for (int a = 0; a < 3; a++) {
        pel_vec3_along(rigid->moment[a], along * arm[a], row->force, rigid->moment[a]);
        pel_vec3_along(rigid->moment[a], row->present * row->directors[side][a], row->directors[1 - side],
                       rigid->moment[a]);
    }
}

static double measure_rows(const pel_newton_rigids *rigids)
{
    double energy = 0;
    if (rigids->row_count > 0)
        rigids->place_rows(rigids->rows_context);
    for (int32_t i = 0; i < rigids->row_count; i++) {
        pel_newton_row *row = &rigids->rows[i];
        double load = row->load + row->stiffness * row->error;
        row->present = load < row->least ? row->least : load > row->most ? row->most : load;
        energy += row->present * (load - 0.5 * row->present) / row->stiffness;
        for (int side = 0; side < 2; side++) {
            pel_newton_rigid *rigid = item_of(rigids, row->bodies[side]);
            if (rigid != NULL)
                push(rigid, row, side);
        }
    }
    return energy;
}

/* of the error, by the six unknowns */
static void row_six(const pel_newton_rigid *rigid, const pel_newton_row *row, int side, double six[2][3])
{
    double arm[3], turn[3];
    row_turn(rigid, row, side, arm, turn);
    pel_vec3_scale(row->force, side == 0 ? 1 : -1, six[0]);
    for (int k = 0; k < 3; k++)
        six[1][k] = pel_vec3_dot(rigid->axes[k], turn) / rigid->length;
}

double pel_newton_rigids_measure(newton_run *run)
{
    const pel_newton_rigids *rigids = run->problem->frames.rigids;
    double energy = 0;
    for (int32_t i = 0; rigids != NULL && i < rigids->count; i++) {
        pel_newton_rigid *rigid = &rigids->items[i];
        memset(rigid->moment, 0, sizeof rigid->moment);
        pel_vec3_set(rigid->force, 0, 0, 0);
        for (int32_t v = rigid->body->begin; v < rigid->body->end; v++)
            for (int a = 0; a < 3; a++)
                pel_vec3_along(rigid->moment[a], rigids->arms[v][a], run->newton->gradient + 3 * (size_t)v,
                               rigid->moment[a]);
        energy += find_torque(rigid);
    }
    return rigids != NULL ? energy + measure_rows(rigids) : energy;
}

void pel_newton_rigids_add_torques(newton_run *run)
{
    const pel_newton_rigids *rigids = run->problem->frames.rigids;
    for (int32_t i = 0; rigids != NULL && i < rigids->count; i++) {
        const pel_newton_rigid *rigid = &rigids->items[i];
        double *turn = run->newton->gradient + 3 * (size_t)rigid->turn;
        double *way = run->newton->gradient + 3 * (size_t)rigid->at;
        pel_vec3_add(way, rigid->force, way);
        for (int k = 0; k < 3; k++)
            turn[k] += pel_vec3_dot(rigid->axes[k], rigid->torque) / rigid->length;
    }
}

/* ---- matrix ---- */

static pel_newton_rigid *rigid_of(const pel_newton_rigids *rigids, int32_t node)
{
    for (int32_t i = 0; pel_rigid_of(rigids->bodies, node) != NULL && i < rigids->count; i++)
        if (node >= rigids->items[i].body->begin && node < rigids->items[i].body->end)
            return &rigids->items[i];
    return NULL;
}

static double *block_of(const pel_matrix *matrix, int32_t i, int32_t j)
{
    int32_t block = pel_matrix_block(matrix, i, j);
    PEL_ASSERT(block >= 0);
    return matrix->values + matrix->block_start[block];
}

/* J of a node for the s-th of the nodes that stand for it: column-major */
static int32_t find_part(const pel_newton_rigids *rigids, const pel_newton_rigid *rigid, int32_t node, int s,
                         double j[9])
{
    static const double unit[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    memcpy(j, unit, sizeof unit);
    if (rigid == NULL || s == 0)
        return rigid == NULL ? node : rigid->at;
    for (int k = 0; k < 3; k++) {
        pel_vec3_cross(rigid->axes[k], rigids->arms[node], j + 3 * k);
        pel_vec3_scale(j + 3 * k, 1 / rigid->length, j + 3 * k);
    }
    return rigid->turn;
}

/* adds J_i^T K J_j, all of three by three and column-major */
static void add_product(const double left[9], const double k[9], const double right[9], double *sum)
{
    double product[9];
    for (int b = 0; b < 3; b++)
        for (int a = 0; a < 3; a++)
            product[a + 3 * b] = k[a] * right[3 * b] + k[a + 3] * right[3 * b + 1] + k[a + 6] * right[3 * b + 2];
    for (int b = 0; b < 3; b++)
        for (int a = 0; a < 3; a++)
            sum[a + 3 * b] += pel_vec3_dot(left + 3 * a, product + 3 * b);
}

static void move_block(const newton_run *run, int32_t i, int32_t j, const double *values)
{
    const pel_newton_rigids *rigids = run->problem->frames.rigids;
    const pel_newton_rigid *row = rigid_of(rigids, i), *column = rigid_of(rigids, j);
    double left[9], right[9], any = 0;
    for (int k = 0; k < 9; k++)
        any += fabs(values[k]);
    for (int s = 0; any > 0 && s < (row != NULL ? 2 : 1); s++)
        for (int t = 0; t < (column != NULL ? 2 : 1); t++) {
            int32_t a = find_part(rigids, row, i, s, left), b = find_part(rigids, column, j, t, right);
            add_product(left, values, right, block_of(run->newton->matrix, a, b));
        }
}

/* N/m, of statics: where nothing turns a body (about the vertical through a ball joint) the matrix stays positive;
   small next to how its weight turns it back */
static double neutral_stiffness(const newton_run *run, const pel_newton_rigid *rigid)
{
    double sum = 0;
    for (int32_t v = rigid->body->begin; run->problem->force != NULL && v < rigid->body->end; v++)
        sum += pel_vec3_length(run->problem->force + 3 * (size_t)v);
    return run->problem->is_dynamic ? 0 : NEUTRAL * sum / rigid->length;
}

/* second derivatives of the inertia that vertices lack, and in statics of turns under the forces at hand */
static void add_own(const newton_run *run, const pel_newton_rigid *rigid)
{
    const double(*r)[3] = (const double(*)[3])rigid->body->matrix;
    bool turns = !run->problem->is_dynamic && run->kind == PEL_TANGENT_EXACT;
    double sum[3][3] = {{0}}, lack[3][3], trace = 0, force = turns ? 1 : 0, neutral = neutral_stiffness(run, rigid);
    double *block = block_of(run->newton->matrix, rigid->turn, rigid->turn);
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            lack[a][b] = pel_vec3_dot(r[a], rigid->lack[b]);
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            sum[a][b] = 0.5 * force * (rigid->moment[a][b] + rigid->moment[b][a]) - pel_vec3_dot(lack[a], r[b]);
    for (int k = 0; k < 3; k++)
        trace += sum[k][k];
    for (int a = 0; a < 3; a++)
        sum[a][a] -= trace;
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) {
            double turned[3];
            for (int k = 0; k < 3; k++)
                turned[k] = pel_vec3_dot(sum[k], rigid->axes[b]);
            block[a + 3 * b] += pel_vec3_dot(rigid->axes[a], turned) / (rigid->length * rigid->length);
        }
    for (int a = 0; a < 3; a++)
        block[4 * a] += neutral;
}

/* stiffness times the squares of rows that follow their errors */
static void add_row(const pel_newton_rigids *rigids, const pel_newton_row *row, pel_matrix *matrix)
{
    const pel_newton_rigid *items[2] = {item_of(rigids, row->bodies[0]), item_of(rigids, row->bodies[1])};
    double six[2][2][3], load = row->load + row->stiffness * row->error;
    if (load != row->present)
        return;
    for (int side = 0; side < 2; side++)
        if (items[side] != NULL)
            row_six(items[side], row, side, six[side]);
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) {
            const pel_newton_rigid *left = items[i / 2], *right = items[j / 2];
            if (left == NULL || right == NULL)
                continue;
            double *block = block_of(matrix, i % 2 ? left->turn : left->at, j % 2 ? right->turn : right->at);
            for (int a = 0; a < 3; a++)
                for (int b = 0; b < 3; b++)
                    block[a + 3 * b] += row->stiffness * six[i / 2][i % 2][a] * six[j / 2][j % 2][b];
        }
}

void pel_newton_rigids_reduce(newton_run *run)
{
    const pel_newton_rigids *rigids = run->problem->frames.rigids;
    pel_newton *newton = run->newton;
    const pel_matrix *matrix = newton->matrix;
    size_t count = 0;
    if (rigids == NULL || run->status != PEL_OK)
        return;
    if (!pel_reserve((void **)&newton->blocks, &newton->block_capacity, (size_t)matrix->block_count * 9,
                     sizeof *newton->blocks)) {
        run->status = pel_fail_memory(run->error);
        return;
    }
    for (int pass = 0; pass < 2; pass++) {
        count = 0;
        for (int32_t i = 0; i < newton->pattern->vertex_count; i++)
            for (int32_t k = matrix->row_start[i]; k < matrix->row_start[i + 1]; k++) {
                int32_t j = matrix->column[k];
                if (j >= newton->pattern->vertex_count || (rigid_of(rigids, i) == NULL && rigid_of(rigids, j) == NULL))
                    continue;
                double *values = matrix->values + matrix->block_start[k], *kept = newton->blocks + 9 * count++;
                if (pass == 0)
                    memcpy(kept, values, 9 * sizeof *kept);
                for (int c = 0; c < 9 && pass == 0; c++)
                    values[c] = 0;
                if (pass == 1)
                    move_block(run, i, j, kept);
            }
    }
    for (int32_t i = 0; i < rigids->count; i++)
        add_own(run, &rigids->items[i]);
    for (int32_t i = 0; i < rigids->row_count; i++)
        add_row(rigids, &rigids->rows[i], newton->matrix);
}

double pel_newton_rigids_scale(const newton_run *run)
{
    const pel_newton_rigids *rigids = run->problem->frames.rigids;
    double scale = 0;
    for (int32_t i = 0; rigids != NULL && i < rigids->count; i++) {
        double own = run->result->residual / (rigids->items[i].body->shape->mass * rigids->items[i].length);
        scale = own > scale ? own : scale;
    }
    return scale;
}

/* ---- pattern ---- */

static bool add_coupling(pel_newton *newton, int32_t *count, const int32_t nodes[4])
{
    if (!pel_reserve((void **)&newton->owned, &newton->owned_capacity, (size_t)*count + 1, sizeof *newton->owned))
        return false;
    memcpy(newton->owned[(*count)++], nodes, sizeof *newton->owned);
    return true;
}

/* all pairs of some nodes, by pairs of two */
static bool add_pairs(pel_newton *newton, int32_t *count, int nodes, const int32_t node[MOST_NODES])
{
    bool has_room = true;
    for (int i = 0; i < nodes; i += 2)
        for (int j = i + 2 < nodes || i > 0 ? i + 2 : i; j < nodes; j += 2) {
            const int32_t four[4] = {node[i], node[i + 1 < nodes ? i + 1 : i], node[j],
                                     node[j + 1 < nodes ? j + 1 : j]};
            has_room &= add_coupling(newton, count, four);
        }
    return has_room;
}

/* of both bodies of each joint; rows of one follow each other */
static bool add_joints(pel_newton *newton, int32_t *count, const pel_newton_rigids *rigids)
{
    bool has_room = true;
    for (int32_t i = 0; i < rigids->row_count; i++) {
        const pel_rigid *const *bodies = rigids->rows[i].bodies, *const *last =
                                                                     i > 0 ? rigids->rows[i - 1].bodies : NULL;
        const pel_newton_rigid *a = item_of(rigids, bodies[0]), *b = item_of(rigids, bodies[1]);
        bool is_known = last != NULL && last[0] == bodies[0] && last[1] == bodies[1];
        if (a != NULL && b != NULL && !is_known)
            has_room &= add_pairs(newton, count, 4, (const int32_t[MOST_NODES]){a->at, a->turn, b->at, b->turn});
    }
    return has_room;
}

int32_t pel_newton_rigids_couple(newton_run *run, int32_t at, int32_t count, const int32_t (*couplings)[4])
{
    const pel_newton_rigids *rigids = run->problem->frames.rigids;
    pel_newton *newton = run->newton;
    bool has_room = true;
    bool is_first = at == 0;
    for (int32_t i = 0; is_first && i < rigids->count; i++)
        has_room &= add_pairs(newton, &at, 2, (const int32_t[MOST_NODES]){rigids->items[i].at, rigids->items[i].turn});
    if (is_first)
        has_room &= add_joints(newton, &at, rigids);
    for (int32_t c = 0; c < count; c++) {
        int32_t node[MOST_NODES];
        int nodes = 0;
        bool any = false;
        for (int i = 0; i < 4; i++) {
            const pel_newton_rigid *rigid = rigid_of(rigids, couplings[c][i]);
            node[nodes++] = rigid != NULL ? rigid->at : couplings[c][i];
            if (rigid != NULL)
                node[nodes++] = rigid->turn;
            any |= rigid != NULL;
        }
        has_room &= add_coupling(newton, &at, couplings[c]) && (!any || add_pairs(newton, &at, nodes, node));
    }
    return has_room ? at : -1;
}
