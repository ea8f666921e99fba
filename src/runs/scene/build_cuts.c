/* Cuts and seams of a scene: before anything reads the meshes of bodies, those that tear become finer, and vertices
   move onto the paths. */
#include "scene/build.h"

#include "base/memory.h"
#include "keys/validate.h"
#include "mesh/path.h"
#include "scene/mesh.h"
#include "scene/region.h"
#include "subdivide/local.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static pel_status fail_value(pel_scene_reader *reader, const pel_scene_value *value, const char *what,
                             const char *remedy)
{
    pel_scene_fail(reader, &value->place, "%s", what);
    pel_fail_remedy(reader->error, "%s", remedy);
    return PEL_BAD_SCENE;
}

/* ---- finer before they tear ---- */

/* bytes of the levels of detail of a body */
#define MEMORY ((size_t)1 << 30)

typedef struct fine_region {
    const uint8_t *has; /* (triangles of the mesh before) */
    int32_t level;
} fine_region;

static bool divides(const void *user, int32_t level, int32_t triangle, double edge, const double center[3])
{
    (void)edge, (void)center;
    const fine_region *region = user;
    return level < region->level && region->has[triangle >> 2 * level];
}

/* a body may tear */
static bool has_toughness(const pel_scene_value *body)
{
    return pel_scene_value_at(body, "membrane.toughness") != NULL ||
           pel_scene_value_at(body, "springs.toughness") != NULL;
}

/* keys of a body that go with the number of its vertices */
static pel_status check_finer(pel_scene_reader *reader, const pel_scene_value *body, const pel_mesh *mesh)
{
    static const char *const keys[][2] = {
        {"refine", "leave one of both out"},
        {"rest", "subdivide both meshes (pellicle subdivide), and leave tear.level out"},
        {"volume", "leave one of both out: a body with a volume does not tear"},
        {"follow", "leave one of both out"},
        {"mass.per_vertex", ""},
        {"volumetric.stiffness", "give volumetric.young"},
    };
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++) {
        const pel_scene_value *value = pel_scene_value_at(body, keys[k][0]);
        if (value == NULL)
            continue;
        pel_scene_fail(reader, &value->key_place, "'%s' and tear.level exclude each other: the mesh becomes finer",
                       keys[k][0]);
        pel_fail_remedy(reader->error, "%s", keys[k][1]);
        if (strcmp(keys[k][0], "mass.per_vertex") == 0)
            pel_fail_remedy(reader->error, "give mass: { total: %.17g }, that of its %d vertices",
                            value->number * mesh->vertex_count, (int)mesh->vertex_count);
        return PEL_BAD_SCENE;
    }
    return PEL_OK;
}

/* the triangles at the vertices of tear.region; all without one */
static pel_status mark_region(const pel_scene_part *source, const pel_scene_value *region, uint8_t *has)
{
    const pel_mesh *mesh = source->mesh;
    pel_scene_region found = {0};
    uint8_t *marks = NULL;
    pel_status status = region != NULL ? pel_scene_region_find(source->reader, region, mesh, &found) : PEL_OK;
    if (status != PEL_OK || found.vertices == NULL) {
        memset(has, 1, (size_t)mesh->triangle_count);
        return status;
    }
    marks = pel_allocate((size_t)mesh->vertex_count, 1);
    if (marks == NULL)
        return pel_fail_memory(source->reader->error);
    for (int32_t i = 0; i < found.count; i++)
        marks[found.vertices[i]] = 1;
    for (int32_t t = 0; t < mesh->triangle_count; t++)
        has[t] = marks[mesh->triangles[t][0]] | marks[mesh->triangles[t][1]] | marks[mesh->triangles[t][2]];
    pel_free(marks);
    return PEL_OK;
}

pel_status pel_scene_refine_torn(pel_scene_reader *reader, const pel_scene_value *root, const pel_scene_value *body,
                                 pel_mesh **mesh)
{
    const pel_scene_value *level = pel_scene_value_at(root, "tear.level");
    const pel_scene_part source = {reader, body, *mesh};
    if (!(level->number > 0) || reader->made != NULL || !has_toughness(body))
        return PEL_OK;
    pel_mesh *fine = NULL;
    uint8_t *has = NULL;
    pel_status status = check_finer(reader, body, *mesh);
    if (status == PEL_OK) {
        has = pel_allocate((size_t)(*mesh)->triangle_count, 1);
        status = has != NULL ? PEL_OK : pel_fail_memory(reader->error);
    }
    if (status == PEL_OK)
        status = mark_region(&source, pel_scene_value_at(root, "tear.region"), has);
    if (status == PEL_OK) {
        const fine_region region = {has, (int32_t)level->number};
        const pel_local_def def = {divides, &region, true, region.level, MEMORY, true};
        status = pel_mesh_subdivide_locally(*mesh, &def, &fine, reader->error);
        if (status == PEL_BAD_ARGUMENT) {
            status = pel_scene_fail_at(reader, &level->place);
            pel_fail_remedy(reader->error, "give a lower tear.level, or a coarser mesh");
        }
    }
    if (status == PEL_OK) {
        pel_log_line(reader->log, "body '%s' is made finer where it tears: %d triangles in place of %d",
                     pel_scene_value_entry(body, "name")->text, (int)fine->triangle_count,
                     (int)(*mesh)->triangle_count);
        status = pel_scene_keep_welding(reader, *mesh, fine);
        pel_mesh_destroy(*mesh);
        *mesh = fine;
    }
    pel_free(has);
    return status;
}

/* tear.level makes the mesh of some body finer */
static pel_status check_level(pel_scene_reader *reader, const pel_scene_value *root)
{
    const pel_scene_value *level = pel_scene_value_at(root, "tear.level"),
                          *region = pel_scene_value_at(root, "tear.region");
    if (region != NULL && !(level->number > 0))
        return fail_value(reader, region, "a region without tear.level", "add `level: 1` or more, or leave it out");
    bool any = !(level->number > 0);
    for (const pel_scene_value *body = pel_scene_value_entry(root, "bodies")->first; body != NULL; body = body->next)
        any = any || has_toughness(body);
    return any ? PEL_OK
               : fail_value(reader, level, "no body has a toughness, so none tears",
                            "give a body membrane.toughness or springs.toughness, or leave tear.level out");
}

/* ---- paths ---- */

/* a path as vertices, in the arena of the reader */
typedef struct vertex_path {
    const int32_t *vertices;
    int32_t count;
} vertex_path;

/* numbers of vertices; the simulation checks that edges join them */
static pel_status read_numbers(pel_scene_reader *reader, const pel_scene_value *path, const pel_mesh *mesh,
                               vertex_path *trail)
{
    int32_t *vertices = pel_arena_take(reader->arena, (size_t)pel_scene_value_count(path), sizeof *vertices);
    if (vertices == NULL)
        return pel_fail_memory(reader->error);
    for (const pel_scene_value *child = path->first; child != NULL; child = child->next) {
        if (child->kind == PEL_SCENE_LIST)
            return fail_value(reader, child, "a path has points and vertices", "give points only, or vertices only");
        if (child->number < 0 || child->number >= mesh->vertex_count) {
            pel_scene_fail(reader, &child->place, "the mesh has no vertex %.0f", child->number);
            pel_fail_remedy(reader->error, "give numbers from 0 to %d", (int)mesh->vertex_count - 1);
            return PEL_BAD_SCENE;
        }
        vertices[trail->count++] = (int32_t)child->number;
    }
    trail->vertices = vertices;
    return PEL_OK;
}

static pel_status keep_vertices(pel_scene_reader *reader, const pel_path_trace *trace, vertex_path *trail)
{
    size_t size = (size_t)trace->count * sizeof *trace->vertices;
    int32_t *vertices = pel_arena_take(reader->arena, size, 1);
    if (vertices == NULL)
        return pel_fail_memory(reader->error);
    memcpy(vertices, trace->vertices, size);
    trail->vertices = vertices;
    trail->count = trace->count;
    return PEL_OK;
}

static pel_status read_points(pel_scene_reader *reader, const pel_scene_value *path, pel_mesh *mesh, uint8_t *marks,
                              vertex_path *trail)
{
    int32_t count = 0;
    double(*points)[3] = pel_arena_take(reader->arena, (size_t)pel_scene_value_count(path), sizeof *points);
    pel_path_trace trace = {0};
    pel_topology *topology = NULL;
    if (points == NULL)
        return pel_fail_memory(reader->error);
    for (const pel_scene_value *child = path->first; child != NULL; child = child->next) {
        if (child->kind != PEL_SCENE_LIST)
            return fail_value(reader, child, "a path has points and vertices", "give points only, or vertices only");
        pel_scene_value_numbers(child, points[count++]);
        if (count > 1 && memcmp(points[count - 1], points[count - 2], sizeof *points) == 0)
            return fail_value(reader, child, "two points of the path are the same", "leave one of them out");
    }
    pel_status status = pel_topology_create(mesh, &topology, reader->error);
    if (status == PEL_OK)
        status = pel_path_trace_points(mesh, topology, (const double(*)[3])(void *)points, count, marks, &trace,
                                       reader->error);
    if (status == PEL_OK)
        status = keep_vertices(reader, &trace, trail);
    else if (status == PEL_BAD_ARGUMENT)
        status = pel_scene_fail_at(reader, &pel_scene_value_element(path, trace.failed_point)->place);
    pel_free(trace.vertices);
    pel_topology_destroy(topology);
    return status;
}

static pel_status read_path(pel_scene_reader *reader, const pel_scene_value *path, pel_mesh *mesh, uint8_t *marks,
                            vertex_path *trail)
{
    return path->first->kind == PEL_SCENE_LIST ? read_points(reader, path, mesh, marks, trail)
                                               : read_numbers(reader, path, mesh, trail);
}

/* whether a cut or seam is of this body */
static pel_status find_owner(pel_scene_reader *reader, const pel_scene_value *value, const char *what,
                             const pel_scene_owner *of, bool *is_own)
{
    char text[80];
    const pel_scene_value *owner = pel_scene_value_entry(value, "body");
    *is_own = owner == NULL || strcmp(owner->text, of->name) == 0;
    if (*is_own && of->mesh->tetrahedron_count > 0) {
        snprintf(text, sizeof text, "a %s of a body with `volume`, which cannot be opened", what);
        return fail_value(reader, value, text, "leave it out, or the volume");
    }
    if (owner != NULL || of->count == 1)
        return PEL_OK;
    snprintf(text, sizeof text, "the %s does not say which body it opens", what);
    return fail_value(reader, value, text, "add `body` with its name");
}

static pel_status read_cut(pel_scene_reader *reader, const pel_scene_value *value, const pel_scene_owner *of,
                           uint8_t *marks, pel_cut_def *cut)
{
    const pel_scene_part part = {reader, value, NULL};
    vertex_path found = {0};
    *cut = (pel_cut_def){0};
    pel_status status = pel_scene_read_members(&part, PEL_DEF_CUT, cut);
    if (status == PEL_OK)
        status = read_path(reader, pel_scene_value_entry(value, "path"), of->mesh, marks, &found);
    cut->body = of->body;
    cut->vertices = found.vertices;
    cut->vertex_count = found.count;
    return status;
}

static pel_status read_seam(pel_scene_reader *reader, const pel_scene_value *value, const pel_scene_owner *of,
                            uint8_t *marks, pel_seam_def *seam)
{
    const pel_scene_part part = {reader, value, of->mesh};
    const pel_scene_value *path = pel_scene_value_entry(value, "path");
    vertex_path found = {0};
    *seam = pel_seam_def_default();
    pel_status status = pel_scene_read_members(&part, PEL_DEF_SEAM, seam);
    if (status == PEL_OK && seam->strength == 0 && seam->opens_at < 0)
        return fail_value(reader, value, "the seam never opens", "add `strength` (N/m) or `opens_at` (s)");
    if (status == PEL_OK && path != NULL)
        status = read_path(reader, path, of->mesh, marks, &found);
    seam->body = of->body;
    seam->path = found.vertices;
    seam->path_count = found.count;
    return status;
}

static pel_status read_cuts(pel_scene_reader *reader, const pel_scene_value *list, const pel_scene_owner *of,
                            uint8_t *marks, pel_cut_def *cuts)
{
    pel_status status = PEL_OK;
    double before = 0;
    for (const pel_scene_value *value = list->first; status == PEL_OK && value != NULL; value = value->next, cuts++) {
        bool is_own = false;
        double at = pel_scene_value_number(value, "at");
        if (at < before)
            return fail_value(reader, pel_scene_value_entry(value, "at"), "a cut is earlier than the one before",
                              "give the cuts in the order of their times");
        status = find_owner(reader, value, "cut", of, &is_own);
        if (status == PEL_OK && is_own)
            status = read_cut(reader, value, of, marks, cuts);
        before = at;
    }
    return status;
}

/* paths first: they move vertices, which regions find */
static pel_status read_seams(pel_scene_reader *reader, const pel_scene_value *list, const pel_scene_owner *of,
                             uint8_t *marks, pel_seam_def *seams)
{
    pel_status status = PEL_OK;
    bool is_own = false;
    pel_seam_def *seam = seams;
    for (const pel_scene_value *value = list->first; status == PEL_OK && value != NULL; value = value->next, seam++) {
        status = find_owner(reader, value, "seam", of, &is_own);
        if (status == PEL_OK && is_own)
            status = read_seam(reader, value, of, marks, seam);
    }
    for (const pel_scene_value *value = list->first; status == PEL_OK && value != NULL; value = value->next, seams++) {
        const pel_scene_part part = {reader, value, of->mesh};
        status = find_owner(reader, value, "seam", of, &is_own);
        if (status == PEL_OK && is_own)
            status = pel_scene_read_vertices(&part, pel_scene_value_entry(value, "vertices"), &seams->vertices,
                                             &seams->vertex_count);
    }
    return status;
}

pel_status pel_scene_build_cuts(pel_scene_reader *reader, const pel_scene_value *root, const pel_scene_owner *of,
                                pel_sim_def *sim)
{
    uint8_t *marks = pel_allocate((size_t)of->mesh->vertex_count, 1);
    pel_status status = marks != NULL ? PEL_OK : pel_fail_memory(reader->error);
    if (status == PEL_OK)
        status = read_cuts(reader, pel_scene_value_entry(root, "cuts"), of, marks, (pel_cut_def *)(uintptr_t)sim->cuts);
    if (status == PEL_OK)
        status =
            read_seams(reader, pel_scene_value_entry(root, "seams"), of, marks, (pel_seam_def *)(uintptr_t)sim->seams);
    pel_free(marks);
    return status;
}

pel_status pel_scene_take_cuts(pel_scene_reader *reader, const pel_scene_value *root, pel_sim_def *sim)
{
    int32_t cut_count = pel_scene_value_count(pel_scene_value_entry(root, "cuts"));
    int32_t seam_count = pel_scene_value_count(pel_scene_value_entry(root, "seams"));
    pel_cut_def *cuts = pel_arena_take(reader->arena, (size_t)cut_count, sizeof *cuts);
    pel_seam_def *seams = pel_arena_take(reader->arena, (size_t)seam_count, sizeof *seams);
    if (cuts == NULL || seams == NULL)
        return pel_fail_memory(reader->error);
    sim->cuts = cuts;
    sim->cut_count = cut_count;
    sim->seams = seams;
    sim->seam_count = seam_count;
    return PEL_OK;
}

/* that there is a body of its name, which may open */
static pel_status check_owner(pel_scene_reader *reader, const pel_scene *scene, const pel_scene_value *value,
                              const char *what, bool is_found, int32_t body)
{
    enum { MOST_NAMES = 64 };
    const char *names[MOST_NAMES];
    char text[80];
    size_t count = 0;
    const pel_scene_value *owner = pel_scene_value_entry(value, "body");
    for (int32_t b = 0; b < scene->model.body_count && count < MOST_NAMES; b++)
        names[count++] = scene->model.bodies[b].name;
    if (!is_found)
        return pel_scene_fail_name(reader, &owner->place, "body", owner->text, names, count);
    const pel_body_def *def = &scene->model.bodies[body];
    if (!(def->fluid_density > 0) || isfinite(def->fluid_level))
        return PEL_OK;
    snprintf(text, sizeof text, "the %s opens a body that a liquid fills", what);
    return fail_value(reader, value, text,
                      "give fluid.level, the height of the liquid's surface, or leave `fluid` out");
}

/* bodies that need a closed surface; a cut in the middle of a run is refused then */
static pel_status check_volume(pel_scene_reader *reader, const pel_scene *scene, const pel_scene_value *value,
                               int32_t body)
{
    pel_pressure_kind kind = scene->model.bodies[body].shell.pressure.kind;
    if (kind != PEL_PRESSURE_GAS && kind != PEL_PRESSURE_VOLUME)
        return PEL_OK;
    return fail_value(reader, value, "the seam opens a body that encloses a gas or has a target volume",
                      "give its pressure as a number or keys");
}

pel_status pel_scene_check_cuts(pel_scene_reader *reader, const pel_scene_value *root, const pel_scene *scene)
{
    const pel_cut_def *cut = scene->sim.cuts;
    const pel_seam_def *seam = scene->sim.seams;
    pel_status status = check_level(reader, root);
    for (const pel_scene_value *value = pel_scene_value_entry(root, "cuts")->first; status == PEL_OK && value != NULL;
         value = value->next, cut++)
        status = check_owner(reader, scene, value, "cut", cut->vertices != NULL, cut->body);
    for (const pel_scene_value *value = pel_scene_value_entry(root, "seams")->first; status == PEL_OK && value != NULL;
         value = value->next, seam++) {
        status = check_owner(reader, scene, value, "seam", seam->path != NULL || seam->vertices != NULL, seam->body);
        if (status == PEL_OK)
            status = check_volume(reader, scene, value, seam->body);
    }
    return status;
}
