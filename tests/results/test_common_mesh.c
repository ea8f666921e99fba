/* Random fronts of two bodies with random places of their vertices: on the common mesh every frame has the surface that
   it had, triangle by triangle. */
#include "check.h"

#include "failing_malloc.h"
#include "pellicle/export.h"
#include "pellicle/mesh_io.h"
#include "pellicle/results.h"
#include "pellicle/shape.h"
#include "pellicle/sim_surface.h"
#include "pellicle/topology.h"
#include "random.h"
#include "results/common_mesh.h"

#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

enum { FRAMES = 6, LEVELS = 3, ROWS_MAX = 20000 };

/* defects of the frames of a folder */
typedef enum damage { NO_DAMAGE, NO_FIELDS, BAD_WEIGHT, BAD_CORNER, OTHER_PLACE } damage;

static char folder[64];

static const char *in_folder(char path[128], const char *name)
{
    snprintf(path, 128, "%s/%s", folder, name);
    return path;
}

/* ---- making frames ---- */

typedef struct bodies {
    pel_mesh *meshes[2];
    pel_model *model;
    pel_sim *sim;
} bodies;

/* a ball and a plate with a boundary */
static bodies make_bodies(void)
{
    bodies made;
    pel_shape_def ball = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE),
                  plate = pel_shape_def_default(PEL_SHAPE_GRID);
    ball.frequency = 2;
    plate.nx = 3;
    plate.ny = 2;
    assert_int_equal(pel_shape_create(&ball, &made.meshes[0], NULL), PEL_OK);
    assert_int_equal(pel_shape_create(&plate, &made.meshes[1], NULL), PEL_OK);
    pel_body_def defs[2];
    for (int b = 0; b < 2; b++) {
        defs[b] = pel_body_def_default();
        defs[b].name = b == 0 ? "ball" : "plate";
        defs[b].mesh = made.meshes[b];
        defs[b].refine.levels = LEVELS;
    }
    pel_model_def model = pel_model_def_default();
    model.bodies = defs;
    model.body_count = 2;
    assert_int_equal(pel_model_create(&model, &made.model, NULL), PEL_OK);
    pel_sim_def sim = pel_sim_def_default();
    sim.model = made.model;
    sim.thread_count = 1;
    assert_int_equal(pel_sim_create(&sim, &made.sim, NULL), PEL_OK);
    return made;
}

static void free_bodies(bodies *made)
{
    pel_sim_destroy(made->sim);
    pel_model_destroy(made->model);
    pel_mesh_destroy(made->meshes[0]);
    pel_mesh_destroy(made->meshes[1]);
}

/* asks for other levels around a few vertices of each body */
static void change_fronts(const bodies *made, random_state *random)
{
    for (int32_t b = 0; b < 2; b++)
        for (int i = 0; i < 5; i++) {
            int32_t vertex = (int32_t)random_integer(random, 0, made->meshes[b]->vertex_count - 1);
            int32_t level = (int32_t)random_integer(random, 0, LEVELS);
            assert_int_equal(pel_sim_refine(made->sim, b, vertex, level, NULL), PEL_OK);
        }
}

typedef struct frame_data {
    double positions[3 * ROWS_MAX], corners[3 * ROWS_MAX], weights[3 * ROWS_MAX], body[ROWS_MAX], heat[ROWS_MAX];
    int32_t triangles[6 * ROWS_MAX], places[ROWS_MAX];
    int32_t vertex_count, triangle_count;
} frame_data;

static void append_body(const bodies *made, int32_t b, random_state *random, frame_data *data)
{
    int32_t first = data->vertex_count, count = pel_sim_vertex_count(made->sim, b);
    int32_t *triangles = data->triangles + 3 * (size_t)data->triangle_count;
    int32_t triangle_count = pel_sim_triangle_count(made->sim, b);
    assert_true(first + count <= ROWS_MAX);
    pel_sim_get_positions(made->sim, b, data->positions + 3 * (size_t)first);
    pel_sim_get_mesh_places(made->sim, b, data->places, data->weights + 3 * (size_t)first);
    pel_sim_get_triangles(made->sim, b, triangles);
    for (int32_t i = 0; i < 3 * triangle_count; i++)
        triangles[i] += first;
    for (int32_t r = 0; r < count; r++) {
        int32_t row = first + r;
        data->body[row] = b;
        for (int i = 0; i < 3; i++) {
            data->positions[3 * row + i] += random_between(random, -0.1, 0.1) + 5 * b;
            data->corners[3 * row + i] = made->meshes[b]->triangles[data->places[r]][i];
        }
        /* linear in space */
        data->heat[row] = 1 + 2 * data->positions[3 * row] - data->positions[3 * row + 2];
    }
    data->vertex_count += count;
    data->triangle_count += triangle_count;
}

static void write_frame(const frame_data *data, int frame, damage bad)
{
    char path[128], name[32];
    const pel_vtp_field fields[4] = {{"heat", 1, data->heat},
                                     {"body", 1, data->body},
                                     {"mesh_vertices", 3, data->corners},
                                     {"mesh_weights", 3, data->weights}};
    const pel_vtp vtp = {.vertex_count = data->vertex_count,
                         .triangle_count = data->triangle_count,
                         .positions = data->positions,
                         .triangles = data->triangles,
                         .fields = fields,
                         .field_count = bad == NO_FIELDS && frame == 3 ? 3 : 4,
                         .time = 0.5 * frame,
                         .float64 = true};
    snprintf(name, sizeof name, "frames/f%05d.vtp", frame);
    assert_int_equal(pel_vtp_write(in_folder(path, name), &vtp, NULL), PEL_OK);
}

static void damage_frame(frame_data *data, damage bad)
{
    int32_t last = data->vertex_count - 1;
    if (bad == BAD_WEIGHT)
        data->weights[3 * last] = 0.3;
    else if (bad == BAD_CORNER)
        data->corners[3 * last + 1] = 1000;
    else if (bad == OTHER_PLACE)
        for (int i = 0; i < 3; i++)
            data->weights[3 * last + i] = i == 0;
}

/* a folder of frames, the first of them unrefined */
static void make_run(uint64_t seed, damage bad)
{
    char path[128], texts[FRAMES][32];
    const char *names[FRAMES];
    double times[FRAMES];
    random_state random = {seed};
    bodies made = make_bodies();
    frame_data *data = malloc(sizeof *data);
    assert_non_null(data);
    strcpy(folder, "common_XXXXXX");
    assert_non_null(mkdtemp(folder));
    assert_int_equal(mkdir(in_folder(path, "frames"), 0777), 0);
    for (int f = 0; f < FRAMES; f++) {
        data->vertex_count = data->triangle_count = 0;
        if (f > 0)
            change_fronts(&made, &random);
        for (int32_t b = 0; b < 2; b++)
            append_body(&made, b, &random, data);
        if (f == 3)
            damage_frame(data, bad);
        write_frame(data, f, bad);
        snprintf(texts[f], sizeof texts[f], "frames/f%05d.vtp", f);
        names[f] = texts[f];
        times[f] = 0.5 * f;
    }
    assert_int_equal(pel_pvd_write(in_folder(path, "frames.pvd"), names, times, FRAMES, NULL), PEL_OK);
    free(data);
    free_bodies(&made);
}

static void remove_run(void)
{
    char command[128];
    snprintf(command, sizeof command, "rm -r '%s'", folder);
    assert_int_equal(system(command), 0);
}

/* ---- the oracle ---- */

static void subtract(const double a[3], const double b[3], double d[3])
{
    for (int i = 0; i < 3; i++)
        d[i] = a[i] - b[i];
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void area_vector(const pel_mesh *mesh, int32_t t, double n[3])
{
    double u[3], w[3];
    const int32_t *v = mesh->triangles[t];
    subtract(mesh->positions[v[1]], mesh->positions[v[0]], u);
    subtract(mesh->positions[v[2]], mesh->positions[v[0]], w);
    for (int i = 0; i < 3; i++)
        n[i] = (u[(i + 1) % 3] * w[(i + 2) % 3] - u[(i + 2) % 3] * w[(i + 1) % 3]) / 2;
}

static double area_of(const pel_mesh *mesh, int32_t t)
{
    double n[3];
    area_vector(mesh, t, n);
    return sqrt(dot(n, n));
}

/* whether a point lies in a triangle, edges included */
static bool contains(const pel_mesh *mesh, int32_t t, const double p[3])
{
    const double tolerance = 1e-9;
    double n[3], square;
    area_vector(mesh, t, n);
    square = dot(n, n);
    for (int i = 0; i < 3; i++) {
        const double *a = mesh->positions[mesh->triangles[t][i]], *b = mesh->positions[mesh->triangles[t][(i + 1) % 3]];
        double u[3], w[3], c[3];
        subtract(b, a, u);
        subtract(p, a, w);
        for (int k = 0; k < 3; k++)
            c[k] = (u[(k + 1) % 3] * w[(k + 2) % 3] - u[(k + 2) % 3] * w[(k + 1) % 3]) / 2;
        if (dot(c, n) < -tolerance * square)
            return false;
    }
    double w[3];
    subtract(p, mesh->positions[mesh->triangles[t][0]], w);
    return fabs(dot(w, n)) <= tolerance * sqrt(square);
}

/* every triangle of `common` lies in one triangle of `own`, with the same side up, and together they fill each of them
 */
static void check_same_surface(const pel_mesh *common, const pel_mesh *own)
{
    double *filled = calloc((size_t)own->triangle_count, sizeof *filled);
    for (int32_t t = 0; t < common->triangle_count; t++) {
        int32_t in = -1;
        for (int32_t o = 0; in < 0 && o < own->triangle_count; o++) {
            bool inside = true;
            for (int i = 0; inside && i < 3; i++)
                inside = contains(own, o, common->positions[common->triangles[t][i]]);
            in = inside ? o : -1;
        }
        assert_true(in >= 0);
        double n[3], m[3];
        area_vector(common, t, n);
        area_vector(own, in, m);
        assert_true(dot(n, m) > 0);
        filled[in] += area_of(common, t);
    }
    for (int32_t o = 0; o < own->triangle_count; o++)
        assert_near(filled[o] / area_of(own, o), 1, 1e-9);
    free(filled);
}

static void check_heat(const pel_mesh *mesh)
{
    const double *heat = pel_mesh_field(mesh, "heat")->values;
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        assert_near(heat[v], 1 + 2 * mesh->positions[v][0] - mesh->positions[v][2], 1e-9);
}

/* no gap and no T-junction: a ball and a disk */
static void check_topology(const pel_mesh *mesh)
{
    pel_topology *topology;
    assert_int_equal(pel_topology_create(mesh, &topology, NULL), PEL_OK);
    int32_t edges = topology->edge_count;
    assert_int_equal(mesh->vertex_count - edges + mesh->triangle_count, 2 + 1);
    pel_topology_destroy(topology);
}

static void test_same_surface(void **unused)
{
    (void)unused;
    for (uint64_t seed = 1; seed <= (uint64_t)ROUNDS(5, 1); seed++) {
        pel_frames *frames;
        pel_common_mesh *common;
        make_run(seed, NO_DAMAGE);
        assert_int_equal(pel_frames_open(folder, &frames, NULL), PEL_OK);
        assert_int_equal(pel_common_mesh_create(frames, &common, NULL), PEL_OK);
        pel_mesh *first = NULL, *own, *mesh;
        for (int32_t f = 0; f < FRAMES; f++) {
            assert_int_equal(pel_frames_read(frames, f, &own, NULL), PEL_OK);
            assert_int_equal(pel_common_mesh_read(common, f, &mesh, NULL), PEL_OK);
            assert_int_equal(mesh->vertex_count, pel_common_mesh_vertex_count(common));
            assert_true(mesh->triangle_count >= own->triangle_count);
            check_same_surface(mesh, own);
            check_heat(mesh);
            assert_null(pel_mesh_field(mesh, "mesh_weights"));
            if (f == 0) {
                first = mesh;
                check_topology(mesh);
                /* the first frame has the vertices of the meshes alone: they come first, as they are */
                assert_true(mesh->triangle_count > 2 * own->triangle_count);
                for (int32_t v = 0; v < own->vertex_count; v++)
                    for (int i = 0; i < 3; i++)
                        assert_near(mesh->positions[v][i], own->positions[v][i], 0);
            } else {
                assert_int_equal(mesh->triangle_count, first->triangle_count);
                assert_memory_equal(mesh->triangles, first->triangles,
                                    (size_t)mesh->triangle_count * sizeof *mesh->triangles);
                pel_mesh_destroy(mesh);
            }
            pel_mesh_destroy(own);
        }
        pel_mesh_destroy(first);
        pel_common_mesh_destroy(common);
        pel_frames_close(frames);
        remove_run();
    }
}

/* all exports take it */
static void test_exports(void **unused)
{
    (void)unused;
    char pc2[128], glb[128], ply[128], name[PEL_EXPORT_PATH_SIZE];
    pel_frames *frames;
    pel_mesh *first, *last;
    struct stat information;
    make_run(9, NO_DAMAGE);
    assert_int_equal(pel_frames_open(folder, &frames, NULL), PEL_OK);
    assert_int_equal(pel_export_pc2(in_folder(pc2, "a.pc2"), frames, NULL), PEL_OK);
    assert_int_equal(pel_export_glb(in_folder(glb, "a.glb"), frames, NULL), PEL_OK);
    in_folder(ply, "a.ply");
    assert_int_equal(pel_export_sequence(ply, PEL_FORMAT_PLY, frames, NULL, NULL), PEL_OK);
    pel_export_numbered_path(name, ply, 0);
    assert_int_equal(pel_mesh_read(name, PEL_FORMAT_AUTO, NULL, &first, NULL), PEL_OK);
    pel_export_numbered_path(name, ply, FRAMES - 1);
    assert_int_equal(pel_mesh_read(name, PEL_FORMAT_AUTO, NULL, &last, NULL), PEL_OK);
    assert_int_equal(first->vertex_count, last->vertex_count);
    assert_memory_equal(first->triangles, last->triangles, (size_t)first->triangle_count * sizeof *first->triangles);
    check_heat(last);
    assert_int_equal(stat(pc2, &information), 0);
    assert_int_equal(information.st_size, 32 + 12 * FRAMES * first->vertex_count);
    pel_mesh_destroy(first);
    pel_mesh_destroy(last);
    pel_frames_close(frames);
    remove_run();
}

static void test_damaged(void **unused)
{
    (void)unused;
    const damage kinds[] = {NO_FIELDS, BAD_WEIGHT, BAD_CORNER, OTHER_PLACE};
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        pel_frames *frames;
        pel_common_mesh *common;
        pel_error error;
        char path[128];
        make_run(3, kinds[i]);
        assert_int_equal(pel_frames_open(folder, &frames, NULL), PEL_OK);
        assert_int_equal(pel_common_mesh_create(frames, &common, &error), PEL_BAD_FORMAT);
        assert_null(common);
        assert_non_null(strstr(error.file, "f00003.vtp"));
        assert_true(kinds[i] == NO_FIELDS ? strstr(error.what, "mesh_weights") != NULL : error.element >= 0);
        assert_int_equal(pel_export_pc2(in_folder(path, "a.pc2"), frames, &error), PEL_BAD_FORMAT);
        assert_int_equal(access(path, F_OK), -1);
        pel_frames_close(frames);
        remove_run();
    }
}

static pel_status create_and_read(const void *frames, pel_error *error)
{
    pel_common_mesh *common;
    pel_mesh *mesh = NULL;
    pel_status status = pel_common_mesh_create(frames, &common, error);
    if (status == PEL_OK)
        status = pel_common_mesh_read(common, 1, &mesh, error);
    pel_mesh_destroy(mesh);
    pel_common_mesh_destroy(common);
    return status;
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    pel_frames *frames;
    make_run(4, NO_DAMAGE);
    assert_int_equal(pel_frames_open(folder, &frames, NULL), PEL_OK);
    assert_true(for_every_allocation_failure(create_and_read, frames) > 40);
    pel_frames_close(frames);
    remove_run();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_surface),
        cmocka_unit_test(test_exports),
        cmocka_unit_test(test_damaged),
        cmocka_unit_test(test_allocation_failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
