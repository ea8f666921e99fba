/* Meshes that are known to be free of self-intersections: those of the repository, and real ones of ../shared/data if
   available. */
#include "check.h"

#include <stdbool.h>
#include <stdlib.h>

#include "pellicle/geometry.h"
#include "source_dir.h"

typedef struct surface {
    int vertex_count, triangle_count;
    double (*positions)[3];
    int (*triangles)[3];
} surface;

/* just enough of OBJ: lines "v x y z" and "f a b c" */
static bool read_surface(const char *name, surface *mesh)
{
    enum { LIMIT = 20000 };
    char path[1024], line[256];
    snprintf(path, sizeof path, PEL_SOURCE_DIR "/%s", name);
    FILE *file = fopen(path, "r");
    if (file == NULL)
        return false;
    mesh->positions = calloc(LIMIT, sizeof *mesh->positions);
    mesh->triangles = calloc(LIMIT, sizeof *mesh->triangles);
    mesh->vertex_count = mesh->triangle_count = 0;
    while (fgets(line, sizeof line, file) != NULL) {
        double *x = mesh->positions[mesh->vertex_count];
        int *t = mesh->triangles[mesh->triangle_count];
        if (mesh->vertex_count < LIMIT - 1 && sscanf(line, "v %lf %lf %lf", &x[0], &x[1], &x[2]) == 3)
            mesh->vertex_count++;
        else if (mesh->triangle_count < LIMIT - 1 && sscanf(line, "f %d%*s %d%*s %d", &t[0], &t[1], &t[2]) == 3)
            mesh->triangle_count++;
        else if (mesh->triangle_count < LIMIT - 1 && sscanf(line, "f %d %d %d", &t[0], &t[1], &t[2]) == 3)
            mesh->triangle_count++;
    }
    fclose(file);
    return mesh->triangle_count > 0;
}

/* Corners of both triangles, common ones first and in the same order; returns how many are common. */
static int common_first(const surface *mesh, int s, int t, double a[3][3], double b[3][3])
{
    int a_order[3], b_order[3], shared = 0, a_rest = 2, b_rest = 2;
    bool b_used[3] = {false, false, false};
    for (int i = 0; i < 3; i++) {
        int match = -1;
        for (int j = 0; j < 3; j++)
            if (mesh->triangles[s][i] == mesh->triangles[t][j])
                match = j;
        if (match < 0) {
            a_order[a_rest--] = mesh->triangles[s][i];
            continue;
        }
        b_used[match] = true;
        a_order[shared] = b_order[shared] = mesh->triangles[s][i];
        shared++;
    }
    for (int j = 0; j < 3; j++)
        if (!b_used[j])
            b_order[b_rest--] = mesh->triangles[t][j];
    for (int i = 0; i < 3; i++) {
        memcpy(a[i], mesh->positions[a_order[i] - 1], sizeof a[i]);
        memcpy(b[i], mesh->positions[b_order[i] - 1], sizeof b[i]);
    }
    return shared;
}

static int count_intersections(const surface *mesh)
{
    int count = 0;
    for (int s = 0; s < mesh->triangle_count; s++)
        for (int t = s + 1; t < mesh->triangle_count; t++) {
            double a[3][3], b[3][3];
            int shared = common_first(mesh, s, t, a, b);
            count += pel_triangles_intersect_beyond((const double(*)[3])a, (const double(*)[3])b, shared);
        }
    return count;
}

static void check_mesh(const char *name)
{
    surface mesh = {0};
    if (!read_surface(name, &mesh))
        return;
    assert_int_equal(count_intersections(&mesh), 0);
    /* one vertex pushed through to the other side of the body */
    double *x = mesh.positions[0];
    const double *far = mesh.positions[0];
    for (int v = 1; v < mesh.vertex_count; v++) {
        double d = hypot(hypot(mesh.positions[v][0] - x[0], mesh.positions[v][1] - x[1]), mesh.positions[v][2] - x[2]);
        double best = hypot(hypot(far[0] - x[0], far[1] - x[1]), far[2] - x[2]);
        far = d > best ? mesh.positions[v] : far;
    }
    for (int k = 0; k < 3; k++)
        x[k] += 1.25 * (far[k] - x[k]);
    assert_true(count_intersections(&mesh) > 0);
    free(mesh.positions);
    free(mesh.triangles);
}

static void test_tree(void **unused)
{
    (void)unused;
    static const char *const names[] = {"tests/data/bean.obj", "tests/data/sac.obj"};
    for (int i = 0; i < 2; i++) {
        surface mesh = {0};
        assert_true(read_surface(names[i], &mesh));
        free(mesh.positions);
        free(mesh.triangles);
        check_mesh(names[i]);
    }
}

static void test_sphere(void **unused)
{
    (void)unused;
    check_mesh("../shared/data/sphere-252.obj");
}

static void test_liver(void **unused)
{
    (void)unused;
    check_mesh("../shared/data/liver-coarse.obj");
}

static void test_gallbladder(void **unused)
{
    (void)unused;
    check_mesh("../shared/data/gallbladder.obj");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tree),
        cmocka_unit_test(test_sphere),
        cmocka_unit_test(test_liver),
        cmocka_unit_test(test_gallbladder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
