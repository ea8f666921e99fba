/* Scenes in which surfaces touch, and the run that counts intersections after every step. */
#ifndef PEL_TESTS_SIM_CONTACT_SCENE_H
#define PEL_TESTS_SIM_CONTACT_SCENE_H

#include "pellicle/geometry.h"
#include "pellicle/shape.h"
#include "pellicle/sim_contact.h"
#include "pellicle/sim_ledger.h"
#include "pellicle/sim_surface.h"
#include "sim/fixture.h"
#include "stage/stage.h"

enum { SCENE_BODIES = 3, SCENE_TOOLS = 2, SCENE_KEYS = 3 };

typedef struct contact_scene {
    pel_mesh *meshes[SCENE_BODIES];
    pel_mesh *tool_mesh;
    int32_t *pinned;
    pel_body_def bodies[SCENE_BODIES];
    int32_t body_count;
    pel_tool_def tools[SCENE_TOOLS];
    pel_pose_key keys[SCENE_TOOLS][SCENE_KEYS];
    pel_model *model;
    pel_sim_def def;
    double gravity, gravity_along; /* m/s2 along z and x */
} contact_scene;

static inline void scene_body(contact_scene *scene, pel_mesh *mesh)
{
    pel_body_def *body = &scene->bodies[scene->body_count];
    scene->meshes[scene->body_count++] = mesh;
    *body = pel_body_def_default();
    body->name = (const char *[]){"first", "second", "third"}[scene->body_count - 1];
    body->mesh = mesh;
    body->mass = 0.01;
    body->spring_stiffness.value = 30;
    body->spring_damping.value = 0.05;
    body->volumetric_stiffness.value = 0;
}

static inline void scene_begin(contact_scene *scene, pel_method method)
{
    memset(scene, 0, sizeof *scene);
    scene->def = pel_sim_def_default();
    scene->def.solver.method = method;
    scene->def.solver.dt = method == PEL_METHOD_EXPLICIT ? 2e-3 : 1e-2;
    scene->def.contact.enabled = true;
    scene->def.thread_count = 1;
}

static inline pel_tool_def *scene_tool(contact_scene *scene, pel_tool_shape shape)
{
    int32_t i = scene->def.tool_count++;
    pel_tool_def *tool = &scene->tools[i];
    *tool = pel_tool_def_default();
    tool->name = i == 0 ? "upper" : "lower";
    tool->shape = shape;
    tool->keys = scene->keys[i];
    scene->def.tools = scene->tools;
    return tool;
}

/* straight from z = from to z = to until `time`, at x, y */
static inline void scene_move(contact_scene *scene, int32_t tool, double x, double y, double from, double to,
                              double time)
{
    pel_pose_key *keys = scene->keys[tool];
    keys[0] = (pel_pose_key){0, {x, y, from}, {0, 0, 0, 1}, {0}};
    keys[1] = (pel_pose_key){time, {x, y, to}, {0, 0, 0, 1}, {0}};
    scene->tools[tool].key_count = 2;
}

static inline pel_sim *scene_create(contact_scene *scene)
{
    pel_model_def def = pel_model_def_default();
    def.bodies = scene->bodies;
    def.body_count = scene->body_count;
    def.gravity[2] = scene->gravity;
    def.gravity[0] = scene->gravity_along;
    pel_error error;
    char text[800];
    pel_status status = pel_model_create(&def, &scene->model, &error);
    if (status != PEL_OK)
        print_error("%s\n", pel_error_text(&error, text, sizeof text));
    assert_int_equal(status, PEL_OK);
    scene->def.model = scene->model;
    return make_sim(&scene->def);
}

static inline void scene_end(contact_scene *scene, pel_sim *sim)
{
    pel_sim_destroy(sim);
    pel_model_destroy(scene->model);
    for (int i = 0; i < SCENE_BODIES; i++)
        pel_mesh_destroy(scene->meshes[i]);
    pel_mesh_destroy(scene->tool_mesh);
    free(scene->pinned);
}

/* steps, and asserts that no two triangles cut each other (make nightly: after any of them); returns the most contacts
 * at once */
static inline int64_t run_free(pel_sim *sim, int count)
{
    int64_t most = 0;
    for (int n = 0; n < count; n++) {
        run_steps(sim, 1);
        int64_t pairs = 0;
        if (n % LONG(1, ROUNDS(5, 10)) == 0 || n == count - 1)
            assert_int_equal(pel_sim_intersections(sim, &pairs, NULL), PEL_OK);
        if (pairs != 0)
            print_error("step %d: %lld pairs\n", n, (long long)pairs);
        assert_int_equal(pairs, 0);
        pel_sim_measures measures;
        pel_sim_measure(sim, &measures);
        most = measures.contact_count > most ? measures.contact_count : most;
    }
    return most;
}

static inline pel_contact_statistics statistics_of(const pel_sim *sim)
{
    pel_contact_statistics statistics;
    pel_sim_get_contact_statistics(sim, &statistics);
    return statistics;
}

static inline pel_mesh *make_shape(pel_shape_kind kind)
{
    pel_shape_def def = pel_shape_def_default(kind);
    pel_mesh *mesh;
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    return mesh;
}

static inline pel_mesh *make_moved_sphere(int32_t frequency, double x, double y, double z)
{
    pel_mesh *mesh = make_sphere(frequency);
    pel_transform transform = pel_transform_default();
    transform.translation[0] = x;
    transform.translation[1] = y;
    transform.translation[2] = z;
    assert_int_equal(pel_mesh_transform(mesh, &transform, NULL), PEL_OK);
    return mesh;
}

/* a unit square of n x n quads, rolled into a U whose legs lie `gap` apart when it is above 0 */
static inline pel_mesh *make_sheet(int n, double gap)
{
    size_t row = (size_t)n + 1;
    double(*x)[3] = malloc(row * row * sizeof *x);
    int32_t(*triangles)[3] = malloc(2 * (size_t)n * (size_t)n * sizeof *triangles);
    double bend = 1.5707963267948966 * gap, leg = (1 - bend) / 2;
    for (size_t i = 0; i < row * row; i++) {
        double u = (double)(i % row) / n, *p = x[i];
        p[0] = u;
        p[1] = (double)(i / row) / n;
        p[2] = 0;
        if (gap > 0 && u > leg + bend) {
            p[0] = 1 - u;
            p[2] = gap;
        } else if (gap > 0 && u > leg) {
            double angle = 2 * (u - leg) / gap;
            p[0] = leg + 0.5 * gap * sin(angle);
            p[2] = 0.5 * gap * (1 - cos(angle));
        }
    }
    for (int32_t q = 0; q < n * n; q++) {
        int32_t a = q / n * (n + 1) + q % n;
        memcpy(triangles[2 * q], (int32_t[3]){a, a + 1, a + n + 2}, sizeof *triangles);
        memcpy(triangles[2 * q + 1], (int32_t[3]){a, a + n + 2, a + n + 1}, sizeof *triangles);
    }
    pel_mesh *mesh;
    assert_int_equal(
        pel_mesh_create((const double *)x, (int32_t)(row * row), (const int32_t *)triangles, 2 * n * n, &mesh, NULL),
        PEL_OK);
    free(x);
    free(triangles);
    return mesh;
}

/* ---- the scenes ---- */

/* the upper leg of a sheet falls on the lower one */
static inline pel_sim *folded_sheet(contact_scene *scene, int n)
{
    scene_begin(scene, PEL_METHOD_EXPLICIT);
    scene_body(scene, make_sheet(n, 0.06));
    const pel_mesh *mesh = scene->meshes[0];
    scene->pinned = malloc((size_t)mesh->vertex_count * sizeof *scene->pinned);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        if (mesh->positions[v][2] == 0)
            scene->pinned[scene->bodies[0].pinned_count++] = v;
    scene->bodies[0].pinned = scene->pinned;
    scene->gravity = -10;
    scene->def.contact.friction = 0.3;
    return scene_create(scene);
}

/* a sphere shell between two plates that leave `gap` */
static inline pel_sim *pressed_flat(contact_scene *scene, pel_method method, int32_t frequency, double gap, int steps)
{
    scene_begin(scene, method);
    scene_body(scene, make_sphere(frequency));
    scene->bodies[0].spring_damping.value = 0.1;
    double time = 0.8 * steps * scene->def.solver.dt;
    for (int i = 0; i < 2; i++) {
        pel_tool_def *tool = scene_tool(scene, PEL_TOOL_BOX);
        tool->half_extents[0] = tool->half_extents[1] = 2;
        tool->half_extents[2] = 0.1;
        double side = i == 0 ? 1 : -1;
        scene_move(scene, i, 0, 0, 1.15 * side, (0.1 + gap / 2) * side, time);
    }
    return scene_create(scene);
}

/* a torus that is pulled to its axis until the hole is shut and it crumples */
static inline pel_sim *tight_ring(contact_scene *scene, double force)
{
    static pel_load_def loads[2];
    static double weights[2][100000];
    scene_begin(scene, PEL_METHOD_EXPLICIT);
    scene_body(scene, make_shape(PEL_SHAPE_TORUS));
    const pel_mesh *mesh = scene->meshes[0];
    assert_true(mesh->vertex_count <= 100000);
    for (int i = 0; i < 2; i++) {
        loads[i] = pel_load_def_default();
        loads[i].kind = PEL_LOAD_PER_VERTEX;
        loads[i].force[i] = -force;
        loads[i].weights = weights[i];
        for (int32_t v = 0; v < mesh->vertex_count; v++)
            weights[i][v] = mesh->positions[v][i];
    }
    scene->def.loads = loads;
    scene->def.load_count = 2;
    return scene_create(scene);
}

/* two spheres that are shot at each other */
static inline pel_sim *two_spheres(contact_scene *scene)
{
    scene_begin(scene, PEL_METHOD_EXPLICIT);
    scene_body(scene, make_sphere(5));
    scene_body(scene, make_moved_sphere(4, 2.05, 0.1, 0.05));
    scene->def.contact.self = true;
    return scene_create(scene);
}

static inline void shoot(pel_sim *sim, int32_t body, double x, double y, double z)
{
    int32_t count = pel_sim_vertex_count(sim, body);
    double *velocities = malloc(3 * (size_t)count * sizeof *velocities);
    for (int32_t v = 0; v < count; v++) {
        velocities[3 * v] = x;
        velocities[3 * v + 1] = y;
        velocities[3 * v + 2] = z;
    }
    assert_int_equal(pel_sim_set_velocities(sim, body, velocities, NULL), PEL_OK);
    free(velocities);
}

/* every vertex gets its own velocity */
static inline void shake(pel_sim *sim, int32_t body, double speed, uint64_t *random)
{
    int32_t count = pel_sim_vertex_count(sim, body);
    double *velocities = malloc(3 * (size_t)count * sizeof *velocities);
    for (int32_t i = 0; i < 3 * count; i++) {
        *random ^= *random << 13;
        *random ^= *random >> 7;
        *random ^= *random << 17;
        velocities[i] = speed * (2 * (double)(*random >> 11) / 9007199254740992.0 - 1);
    }
    assert_int_equal(pel_sim_set_velocities(sim, body, velocities, NULL), PEL_OK);
    free(velocities);
}

#endif
