#include "sim/topology.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "model/origin.h"
#include "tear/growth.h"

#include <math.h>
#include <string.h>

static const pel_body_def *def_of(const pel_sim *sim, int32_t body)
{
    return &sim->given->def.bodies[body];
}

/* ---- in snapshots ---- */

/* writes a number, or compares it with the one that is there */
typedef struct pen {
    pel_cursor *at;
    bool compares, differs;
} pen;

static void put(pen *p, int32_t number)
{
    int32_t there = number;
    if (p->differs)
        return;
    pel_transfer(p->at, &there, sizeof there);
    p->differs = p->compares && (p->at->is_short || there != number);
}

static int32_t count_corners(const pel_mesh *mesh, int32_t base_count)
{
    int32_t count = 0;
    for (int32_t c = 0; c < 3 * mesh->triangle_count; c++)
        count += mesh->triangles[c / 3][c % 3] >= base_count;
    return count;
}

/* rest positions of the vertices before all cuts, which tears move; of their copies they are the same */
static void put_rest(pen *p, const pel_mesh *mesh, int32_t base_count)
{
    for (int32_t v = 0; v < base_count && !p->differs; v++) {
        double x[3];
        memcpy(x, mesh->positions[v], sizeof x);
        pel_transfer(p->at, x, sizeof x);
        p->differs = p->compares && (p->at->is_short || memcmp(x, mesh->positions[v], sizeof x) != 0);
    }
}

static void put_released(pen *p, const pel_body_def *def)
{
    if (!(def->adhesion > 0))
        return;
    put(p, def->released_count);
    for (int32_t i = 0; i < def->released_count; i++)
        put(p, def->released[i]);
}

static void put_body(pen *p, const pel_body_def *def, bool has_rest)
{
    const pel_mesh *mesh = def->mesh;
    int32_t base_count = pel_origins_base_count(def);
    put_released(p, def);
    if (has_rest)
        put_rest(p, mesh, base_count);
    put(p, mesh->vertex_count - base_count);
    if (mesh->vertex_count == base_count)
        return;
    for (int32_t v = base_count; v < mesh->vertex_count; v++)
        put(p, def->origins[v]);
    put(p, count_corners(mesh, base_count));
    for (int32_t c = 0; c < 3 * mesh->triangle_count; c++)
        if (mesh->triangles[c / 3][c % 3] >= base_count) {
            put(p, c);
            put(p, mesh->triangles[c / 3][c % 3]);
        }
}

/* tears do, and blades, which come and go while a simulation runs */
static bool may_move_rest(const pel_sim *sim, int32_t body)
{
    return sim->given->bodies[body].detail == NULL;
}

static bool put_all(pel_cursor *at, const pel_sim *sim, bool compares)
{
    pen p = {.at = at, .compares = compares};
    put(&p, sim->cuts_done);
    for (int32_t b = 0; b < sim->given->body_count; b++)
        put_body(&p, def_of(sim, b), may_move_rest(sim, b));
    return !p.differs;
}

void pel_tear_transfer(pel_cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    if (sim->tear == NULL)
        return;
    pel_transfer(at, (pel_tear_drop *)(uintptr_t)&sim->tear_drop, sizeof sim->tear_drop);
    pel_transfer(at, (pel_score_sums *)(uintptr_t)&sim->score, sizeof sim->score);
}

void pel_topology_transfer(pel_cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    put_all(at, sim, false);
}

bool pel_topology_is_present(pel_cursor *at, const pel_sim *sim)
{
    PEL_ASSERT(at->load);
    return put_all(at, sim, true);
}

/* ---- surfaces ---- */

pel_status pel_surfaces_begin(const pel_sim *sim, pel_surfaces *surfaces, pel_error *error)
{
    int32_t count = sim->given->body_count;
    *surfaces = (pel_surfaces){.body_count = count, .cuts_done = sim->cuts_done};
    return PEL_ALLOCATE_ALL(PEL_ROOM(surfaces->meshes, count), PEL_ROOM(surfaces->origins, count),
                            PEL_ROOM(surfaces->sources, count), PEL_ROOM(surfaces->kept_counts, count),
                            PEL_ROOM(surfaces->moves, count), PEL_ROOM(surfaces->move_counts, count),
                            PEL_ROOM(surfaces->released, count), PEL_ROOM(surfaces->released_counts, count))
               ? PEL_OK
               : pel_fail_memory(error);
}

void pel_surfaces_end(pel_surfaces *surfaces)
{
    for (int32_t b = 0; surfaces->meshes != NULL && b < surfaces->body_count; b++) {
        pel_mesh_destroy(surfaces->meshes[b]);
        PEL_FREE_ALL(surfaces->origins[b], surfaces->sources[b], surfaces->moves[b], surfaces->released[b]);
    }
    PEL_FREE_ALL(surfaces->meshes, surfaces->origins, surfaces->sources, surfaces->kept_counts, surfaces->moves,
                 surfaces->move_counts, surfaces->released, surfaces->released_counts);
    *surfaces = (pel_surfaces){0};
}

/* rest positions and fields of the sources */
static pel_status make_mesh(const pel_mesh *old, const double (*rest)[3], int32_t vertex_count, const int32_t *sources,
                            const int32_t (*triangles)[3], pel_mesh **mesh, pel_error *error)
{
    int32_t most = 3;
    for (int32_t f = 0; f < old->field_count; f++)
        most = old->fields[f].component_count > most ? old->fields[f].component_count : most;
    double *values = pel_allocate((size_t)vertex_count * (size_t)most, sizeof *values);
    if (values == NULL)
        return pel_fail_memory(error);
    for (int32_t v = 0; v < vertex_count; v++)
        memcpy(values + 3 * (size_t)v, rest[sources[v]], sizeof *rest);
    pel_status status = pel_mesh_create(values, vertex_count, triangles[0], old->triangle_count, mesh, error);
    for (int32_t f = 0; status == PEL_OK && f < old->field_count; f++) {
        const pel_field *field = &old->fields[f];
        size_t size = (size_t)field->component_count;
        for (int32_t v = 0; v < vertex_count; v++)
            memcpy(values + size * (size_t)v, field->values + size * (size_t)sources[v], size * sizeof *values);
        status = pel_mesh_add_field(*mesh, field->name, field->component_count, values, error);
    }
    pel_free(values);
    return status;
}

/* sources are known */
static pel_status set_surface(pel_surfaces *surfaces, const pel_sim *sim, int32_t body, int32_t vertex_count,
                              const int32_t (*triangles)[3], const double (*rest)[3], pel_error *error)
{
    const pel_body_def *def = def_of(sim, body);
    const int32_t *sources = surfaces->sources[body];
    surfaces->origins[body] = pel_allocate((size_t)vertex_count, sizeof **surfaces->origins);
    if (surfaces->origins[body] == NULL)
        return pel_fail_memory(error);
    for (int32_t v = 0; v < vertex_count; v++)
        surfaces->origins[body][v] = pel_origin_of(def, sources[v]);
    if (rest == NULL)
        rest = (const double(*)[3])def->mesh->positions;
    return make_mesh(def->mesh, rest, vertex_count, sources, triangles, &surfaces->meshes[body], error);
}

pel_status pel_surfaces_set(pel_surfaces *surfaces, const pel_sim *sim, int32_t body, int32_t vertex_count,
                            const int32_t (*triangles)[3], const double (*rest)[3], pel_error *error)
{
    surfaces->kept_counts[body] = def_of(sim, body)->mesh->vertex_count;
    return set_surface(surfaces, sim, body, vertex_count, triangles, rest, error);
}

/* ---- from a snapshot ---- */

static int32_t take(pel_cursor *at)
{
    int32_t number = 0;
    pel_transfer(at, &number, sizeof number);
    return number;
}

static pel_status fail_damage(pel_error *error)
{
    return pel_refuse(error, PEL_BAD_FORMAT, "use another one", "the snapshot is damaged: its cuts are out of range");
}

/* the sources of a body's vertices; 0 or less when numbers are out of range */
static int32_t read_sources(const pel_sim *sim, int32_t body, pel_cursor *at, int32_t **sources)
{
    const pel_body_def *def = def_of(sim, body);
    int32_t base_count = pel_origins_base_count(def), added = take(at);
    if (added < 0 || added > 3 * def->mesh->triangle_count || at->is_short)
        return -1;
    *sources = pel_allocate((size_t)(base_count + added), sizeof **sources);
    for (int32_t v = 0; *sources != NULL && v < base_count + added; v++) {
        (*sources)[v] = v < base_count ? v : take(at);
        if ((*sources)[v] < 0 || (*sources)[v] >= base_count)
            return -1;
    }
    return base_count + added;
}

/* the triangles before all cuts, with the corners that are copies in the snapshot */
static bool read_corners(const pel_sim *sim, int32_t body, pel_cursor *at, const int32_t *sources, int32_t count,
                         int32_t (*triangles)[3])
{
    const pel_body_def *def = def_of(sim, body);
    int32_t base_count = pel_origins_base_count(def), corner_count = 3 * def->mesh->triangle_count;
    for (int32_t c = 0; c < corner_count; c++) {
        int32_t v = def->mesh->triangles[c / 3][c % 3];
        triangles[c / 3][c % 3] = pel_origin_of(def, v);
    }
    for (int32_t left = count > base_count ? take(at) : 0; left > 0; left--) {
        int32_t c = take(at), v = take(at);
        if (at->is_short || c < 0 || c >= corner_count || v < base_count || v >= count ||
            triangles[c / 3][c % 3] != sources[v])
            return false;
        triangles[c / 3][c % 3] = v;
    }
    return true;
}

/* those of the vertices before all cuts */
static bool read_rest(pel_cursor *at, int32_t base_count, double (*rest)[3])
{
    bool is_finite = true;
    pel_transfer(at, rest, (size_t)base_count * sizeof *rest);
    for (int32_t v = 0; v < base_count; v++)
        is_finite &= isfinite(rest[v][0]) && isfinite(rest[v][1]) && isfinite(rest[v][2]);
    return is_finite && !at->is_short;
}

static pel_status read_triangles(pel_surfaces *surfaces, const pel_sim *sim, int32_t body, pel_cursor *at,
                                 const double (*rest)[3], pel_error *error)
{
    const pel_mesh *mesh = def_of(sim, body)->mesh;
    int32_t count = read_sources(sim, body, at, &surfaces->sources[body]);
    if (count < 0)
        return fail_damage(error);
    int32_t(*triangles)[3] = pel_allocate((size_t)mesh->triangle_count, sizeof *triangles);
    pel_status status = PEL_OK;
    if (triangles == NULL || surfaces->sources[body] == NULL)
        status = pel_fail_memory(error);
    else if (!read_corners(sim, body, at, surfaces->sources[body], count, triangles))
        status = fail_damage(error);
    else
        status = set_surface(surfaces, sim, body, count, (const int32_t(*)[3])(void *)triangles, rest, error);
    pel_free(triangles);
    return status;
}

/* vertices of the surface that is read next */
static pel_status read_released(pel_surfaces *surfaces, const pel_sim *sim, int32_t body, pel_cursor *at,
                                pel_error *error)
{
    const pel_body_def *def = def_of(sim, body);
    if (!(def->adhesion > 0))
        return PEL_OK;
    int32_t count = take(at);
    if (at->is_short || count < 0 || count > 3 * def->mesh->triangle_count)
        return fail_damage(error);
    surfaces->released[body] = pel_allocate((size_t)count + 1, sizeof **surfaces->released);
    if (surfaces->released[body] == NULL)
        return pel_fail_memory(error);
    surfaces->released_counts[body] = count;
    for (int32_t i = 0; i < count; i++)
        surfaces->released[body][i] = take(at);
    return at->is_short ? fail_damage(error) : PEL_OK;
}

static pel_status check_released(const pel_surfaces *surfaces, int32_t body, pel_error *error)
{
    for (int32_t i = 0; i < surfaces->released_counts[body]; i++)
        if (surfaces->released[body][i] < 0 || surfaces->released[body][i] >= surfaces->meshes[body]->vertex_count)
            return fail_damage(error);
    return PEL_OK;
}

static pel_status read_surface(pel_surfaces *surfaces, const pel_sim *sim, int32_t body, pel_cursor *at,
                               pel_error *error)
{
    int32_t base_count = pel_origins_base_count(def_of(sim, body));
    surfaces->kept_counts[body] = base_count;
    if (!may_move_rest(sim, body))
        return read_triangles(surfaces, sim, body, at, NULL, error);
    double(*rest)[3] = pel_allocate((size_t)base_count, sizeof *rest);
    if (rest == NULL)
        return pel_fail_memory(error);
    pel_status status = read_rest(at, base_count, rest)
                            ? read_triangles(surfaces, sim, body, at, (const double(*)[3])(void *)rest, error)
                            : fail_damage(error);
    pel_free(rest);
    return status;
}

static pel_status read_body(pel_surfaces *surfaces, const pel_sim *sim, int32_t body, pel_cursor *at, pel_error *error)
{
    pel_status status = read_released(surfaces, sim, body, at, error);
    if (status == PEL_OK)
        status = read_surface(surfaces, sim, body, at, error);
    return status == PEL_OK ? check_released(surfaces, body, error) : status;
}

pel_status pel_surfaces_read(pel_surfaces *surfaces, const pel_sim *sim, pel_cursor *at, pel_error *error)
{
    surfaces->cuts_done = take(at);
    if (at->is_short || surfaces->cuts_done < 0 || surfaces->cuts_done > sim->def.cut_count)
        return fail_damage(error);
    pel_status status = PEL_OK;
    for (int32_t b = 0; status == PEL_OK && b < surfaces->body_count; b++)
        status = read_body(surfaces, sim, b, at, error);
    return status;
}
