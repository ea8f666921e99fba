/* The closed surfaces that the experiments deform: scans in a folder that the user has, blends that the
   program makes itself, or a mesh of the user. All are turned upright, centred and scaled to 2 m; each gets a pressure
   that suits the length of its edges, and a cap, the part of its surface that is most like a part of a sphere. */
#include "papers/lab/body.h"

#include <pellicle/error.h>
#include <pellicle/mesh_check.h>
#include <pellicle/mesh_io.h>
#include <pellicle/shape.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* longest side, and radius of the cap [m] */
#define SIZE 2.0
#define CAP 0.35
/* pbd is scale covariant (b-figure13): what a pressure does to a triangle depends on pressure over edge length. With
   one pressure for all, bodies of fine triangles collapse in the same number of sweeps [Pa/m] */
#define PRESSURE_PER_EDGE (3 / 0.05)

/* rotations as a scene writes them: none, y up to z up, the same and turned to the front, x up to z up */
static const struct {
    const char *text;
    double quaternion[4];
} turns[] = {
    {"", {0, 0, 0, 1}},
    {", rotate: { axis: [1, 0, 0], angle: 90 }", {0.70710678118654752, 0, 0, 0.70710678118654752}},
    {", rotate: { axis: [0, 1, 1], angle: 180 }", {0, 0.70710678118654752, 0.70710678118654752, 0}},
    {", rotate: { axis: [0, 1, 0], angle: -90 }", {0, -0.70710678118654752, 0, 0.70710678118654752}},
};

enum { UPRIGHT, Y_UP, Y_UP_BACK, X_UP };

static const struct {
    const char *name;
    int turn;
} scans[] = {
    {"goat-head", Y_UP},      {"koala", UPRIGHT},       {"spot", Y_UP_BACK},       {"cat", Y_UP},
    {"nefertiti-head", Y_UP}, {"gallbladder", UPRIGHT}, {"liver-coarse", UPRIGHT},
};

static const char *const blends[] = {"head", "animal", "liver"};

enum { SCANS = sizeof scans / sizeof *scans, BLENDS = sizeof blends / sizeof *blends };

/* ---- the cap ---- */

/* solves the symmetric system a x = b of four unknowns; false when it is singular */
static bool solve_4(double a[4][5])
{
    for (int i = 0; i < 4; i++) {
        int pivot = i;
        for (int k = i + 1; k < 4; k++)
            if (fabs(a[k][i]) > fabs(a[pivot][i]))
                pivot = k;
        if (fabs(a[pivot][i]) < 1e-14)
            return false;
        for (int c = 0; c < 5; c++) {
            double kept = a[i][c];
            a[i][c] = a[pivot][c];
            a[pivot][c] = kept;
        }
        for (int k = 0; k < 4; k++) {
            double factor = k == i ? 0 : a[k][i] / a[i][i];
            for (int c = i; c < 5; c++)
                a[k][c] -= factor * a[i][c];
        }
    }
    for (int i = 0; i < 4; i++)
        a[i][4] /= a[i][i];
    return true;
}

/* direction to the camera of the pictures: 35 degrees from the front, 20 above the horizon */
static const double to_camera[3] = {0.539, -0.770, 0.342};

static bool is_seen(const double normal[3])
{
    double length = 0, along = 0;
    for (int i = 0; i < 3; i++) {
        length += normal[i] * normal[i];
        along += normal[i] * to_camera[i];
    }
    return along > 0.3 * sqrt(length);
}

/* The part of a surface about a vertex. */
typedef struct patch {
    int32_t *vertices; /* (count), of (vertex_count); the vertex comes first */
    int32_t count;
    bool *marked; /* (vertex_count) true for these */
} patch;

static void destroy_patch(patch *part)
{
    free(part->vertices);
    free(part->marked);
}

static pel_status create_patch(int32_t vertex_count, patch *part, pel_error *error)
{
    *part = (patch){.vertices = calloc((size_t)vertex_count, sizeof *part->vertices),
                    .marked = calloc((size_t)vertex_count, sizeof *part->marked)};
    if (part->vertices != NULL && part->marked != NULL)
        return PEL_OK;
    destroy_patch(part);
    return pel_fail_memory(error);
}

static double square_distance(const double a[3], const double b[3])
{
    double square = 0;
    for (int i = 0; i < 3; i++)
        square += (a[i] - b[i]) * (a[i] - b[i]);
    return square;
}

static void add_vertex(patch *part, int32_t v)
{
    part->marked[v] = true;
    part->vertices[part->count++] = v;
}

/* the vertices that edges within the ball connect with its middle v: not those of another wall nearby */
static void gather(const pel_topology *topology, const double (*x)[3], int32_t v, double radius, patch *part)
{
    for (int32_t i = 0; i < part->count; i++)
        part->marked[part->vertices[i]] = false;
    part->count = 0;
    add_vertex(part, v);
    for (int32_t i = 0; i < part->count; i++) {
        int32_t first = topology->corner_of_vertex[part->vertices[i]], h = first;
        while (h >= 0) {
            int32_t w = pel_half_edge_target(topology, h);
            if (!part->marked[w] && square_distance(x[w], x[v]) <= radius * radius)
                add_vertex(part, w);
            h = pel_half_edge_turn(topology, h);
            if (h == first)
                break;
        }
    }
}

/* distance of a part about v from the sphere that fits it best, over how far that sphere bulges there; infinite where
   it bulges inward */
static double roundness(const pel_mesh *mesh, const patch *part, const double normal[3])
{
    double a[4][5] = {{0}}, far = 0;
    const double *at = mesh->positions[part->vertices[0]];
    for (int pass = 0; pass < 2; pass++) {
        for (int32_t p = 0; p < part->count; p++) {
            double x[4] = {0, 0, 0, 1}, square = 0;
            for (int i = 0; i < 3; i++) {
                x[i] = mesh->positions[part->vertices[p]][i] - at[i];
                square += x[i] * x[i];
            }
            if (pass == 1) {
                double off = square - a[3][4];
                for (int i = 0; i < 3; i++)
                    off -= x[i] * a[i][4];
                far += off * off;
                continue;
            }
            for (int i = 0; i < 4; i++) {
                a[i][4] += x[i] * square;
                for (int k = 0; k < 4; k++)
                    a[i][k] += x[i] * x[k];
            }
        }
        if (pass == 0 && (part->count < 12 || !solve_4(a)))
            return (double)HUGE_VAL;
    }
    /* |x|^2 = 2 c x + k: twice the centre, and k */
    double radius = 0, outward = 0;
    for (int i = 0; i < 3; i++) {
        radius += a[i][4] * a[i][4] / 4;
        outward -= a[i][4] * normal[i];
    }
    radius = sqrt(radius + a[3][4]);
    if (!(outward > 0) || !(radius > 0.7 * CAP))
        return (double)HUGE_VAL;
    return sqrt(far / part->count) / (2 * radius) / (CAP * CAP / (2 * radius));
}

/* normals times twice the area */
static void sum_normals(const pel_mesh *mesh, double (*normals)[3])
{
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        const double *x[3];
        for (int k = 0; k < 3; k++)
            x[k] = mesh->positions[mesh->triangles[t][k]];
        for (int i = 0; i < 3; i++) {
            int j = (i + 1) % 3, k = (i + 2) % 3;
            double area = (x[1][j] - x[0][j]) * (x[2][k] - x[0][k]) - (x[1][k] - x[0][k]) * (x[2][j] - x[0][j]);
            for (int c = 0; c < 3; c++)
                normals[mesh->triangles[t][c]][i] += area;
        }
    }
}

/* the vertex about which the surface is roundest: one that the camera sees, if there is one */
static int32_t find_roundest(const pel_mesh *mesh, const pel_topology *topology, const double (*normals)[3],
                             patch *part)
{
    enum { CANDIDATES = 300 };
    double best = (double)HUGE_VAL;
    int32_t chosen = 0, stride = mesh->vertex_count / CANDIDATES + 1;
    const double(*x)[3] = (const double(*)[3])mesh->positions;
    for (int32_t v = 0; v < mesh->vertex_count; v += stride) {
        if (!is_seen(normals[v]) && isfinite(best))
            continue;
        gather(topology, x, v, CAP, part);
        double off = roundness(mesh, part, normals[v]) + (is_seen(normals[v]) ? 0 : 1e3);
        if (off < best) {
            best = off;
            chosen = v;
        }
    }
    return chosen;
}

/* all vertices of the ball as a ball, else their numbers */
static pel_status write_cap(const pel_mesh *mesh, const patch *part, lab_body *body, pel_error *error)
{
    static const char key[] = "bodies.0.anisotropy.region=";
    const double *at = body->cap_center;
    int32_t inside = 0;
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        inside += square_distance(mesh->positions[v], at) <= CAP * CAP;
    size_t size = 160 + 12 * (size_t)part->count;
    body->cap = malloc(size);
    if (body->cap == NULL)
        return pel_fail_memory(error);
    if (inside == part->count) {
        snprintf(body->cap, size, "%s{ sphere: { center: [%.6g, %.6g, %.6g], radius: %g } }", key, at[0], at[1], at[2],
                 CAP);
        return PEL_OK;
    }
    size_t length = (size_t)snprintf(body->cap, size, "%s{ vertices: ", key);
    for (int32_t v = 0, written = 0; v < mesh->vertex_count; v++)
        if (part->marked[v])
            length += (size_t)snprintf(body->cap + length, size - length, "%s%d", written++ > 0 ? "," : "[", (int)v);
    snprintf(body->cap + length, size - length, "] }");
    return PEL_OK;
}

static pel_status find_cap(const pel_mesh *mesh, lab_body *body, pel_error *error)
{
    pel_topology *topology;
    patch part = {0};
    pel_status status = pel_topology_create(mesh, &topology, error);
    if (status != PEL_OK)
        return status;
    double(*normals)[3] = calloc((size_t)mesh->vertex_count, sizeof *normals);
    status = normals != NULL ? create_patch(mesh->vertex_count, &part, error) : pel_fail_memory(error);
    if (status == PEL_OK) {
        sum_normals(mesh, normals);
        int32_t chosen = find_roundest(mesh, topology, (const double(*)[3])normals, &part);
        gather(topology, (const double(*)[3])mesh->positions, chosen, CAP, &part);
        memcpy(body->cap_center, mesh->positions[chosen], sizeof body->cap_center);
        body->cap_radius = CAP;
        double length = sqrt(square_distance(normals[chosen], (const double[3]){0}));
        for (int i = 0; i < 3; i++)
            body->cap_normal[i] = normals[chosen][i] / length;
        status = write_cap(mesh, &part, body, error);
    }
    destroy_patch(&part);
    free(normals);
    pel_topology_destroy(topology);
    return status;
}

pel_status lab_mark_cap(const lab_body *body, const pel_topology *topology, const double (*rest)[3], bool *marked,
                        pel_error *error)
{
    patch part;
    int32_t nearest = 0;
    pel_status status = create_patch(topology->vertex_count, &part, error);
    if (status != PEL_OK)
        return status;
    for (int32_t v = 1; v < topology->vertex_count; v++)
        if (square_distance(rest[v], body->cap_center) < square_distance(rest[nearest], body->cap_center))
            nearest = v;
    gather(topology, rest, nearest, body->cap_radius, &part);
    memcpy(marked, part.marked, (size_t)topology->vertex_count * sizeof *marked);
    destroy_patch(&part);
    return PEL_OK;
}

/* ---- the mesh ---- */

/* source is "file: ..." or "shape: ..." */
static pel_status fit(pel_mesh *mesh, const char *source, int turn, lab_body *body, pel_error *error)
{
    pel_transform upright = pel_transform_default(), fitted = pel_transform_default();
    double low[3], high[3], size = 0;
    memcpy(upright.rotation, turns[turn].quaternion, sizeof upright.rotation);
    pel_status status = pel_mesh_transform(mesh, &upright, error);
    if (status != PEL_OK)
        return status;
    pel_mesh_box(mesh, low, high);
    for (int i = 0; i < 3; i++)
        size = fmax(size, high[i] - low[i]);
    for (int i = 0; i < 3; i++) {
        fitted.scale[i] = SIZE / size;
        fitted.translation[i] = -0.5 * (low[i] + high[i]) * fitted.scale[i];
    }
    status = pel_mesh_transform(mesh, &fitted, error);
    if (status != PEL_OK)
        return status;
    snprintf(body->mesh, sizeof body->mesh, "bodies.0.mesh={ %s, scale: %.9g%s, translate: [%.9g, %.9g, %.9g] }",
             source, fitted.scale[0], turns[turn].text, fitted.translation[0], fitted.translation[1],
             fitted.translation[2]);
    return find_cap(mesh, body, error);
}

/* "file: "..."", escaped for YAML */
static void quote(const char *path, char *text, size_t size)
{
    size_t length = (size_t)snprintf(text, size, "file: \"");
    for (; *path != '\0' && length + 4 < size; path++) {
        if (*path == '"' || *path == '\\')
            text[length++] = '\\';
        text[length++] = *path;
    }
    snprintf(text + length, size - length, "\"");
}

static pel_status choose_pressure(const pel_mesh *mesh, lab_body *body, pel_error *error)
{
    pel_mesh_report *report;
    pel_status status = pel_mesh_check(mesh, &report, error);
    if (status == PEL_OK)
        body->pressure = PRESSURE_PER_EDGE * report->edge_length_median;
    pel_mesh_report_destroy(report);
    return status;
}

static pel_status read_body(const char *path, int turn, lab_body *body, pel_error *error)
{
    char source[LAB_SOURCE_SIZE];
    pel_mesh *mesh;
    pel_status status = pel_mesh_read(path, PEL_FORMAT_AUTO, NULL, &mesh, error);
    quote(path, source, sizeof source);
    if (status == PEL_OK)
        status = fit(mesh, source, turn, body, error);
    if (status == PEL_OK)
        status = choose_pressure(mesh, body, error);
    pel_mesh_destroy(mesh);
    return status;
}

/* in folder/NAME.ply, once for all runs: making it takes as long as a hundred frames */
static pel_status make_blend(const char *folder, int index, lab_body *body, pel_error *error)
{
    char path[LAB_SOURCE_SIZE - 16], source[LAB_SOURCE_SIZE];
    pel_mesh *mesh = NULL;
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_BLEND);
    def.body = (pel_blend_body)index;
    def.size = SIZE;
    def.edge = 0.05;
    pel_status status = pel_shape_create(&def, &mesh, error);
    snprintf(path, sizeof path, "%s/%s.ply", folder, blends[index]);
    if (status == PEL_OK)
        status = pel_mesh_write(path, PEL_FORMAT_PLY, mesh, NULL, error);
    quote(path, source, sizeof source - 16);
    strcat(source, ", weld: false");
    snprintf(body->name, sizeof body->name, "%s", blends[index]);
    body->pressure = PRESSURE_PER_EDGE * def.edge;
    if (status == PEL_OK)
        status = fit(mesh, source, UPRIGHT, body, error);
    pel_mesh_destroy(mesh);
    return status;
}

/* the part of a path between the last slash and the last point */
static void name_of_path(const char *path, char *name, size_t size)
{
    const char *slash = strrchr(path, '/'), *begin = slash != NULL ? slash + 1 : path, *point = strrchr(begin, '.');
    snprintf(name, size, "%.*s", point != NULL && point > begin ? (int)(point - begin) : (int)strlen(begin), begin);
}

static bool can_read(const char *path)
{
    FILE *file = fopen(path, "rb");
    if (file != NULL)
        fclose(file);
    return file != NULL;
}

static pel_status find_scans(const char *data, lab_body *bodies, int *count, pel_error *error)
{
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < SCANS; i++) {
        char path[LAB_SOURCE_SIZE];
        snprintf(path, sizeof path, "%s/%s.obj", data, scans[i].name);
        if (!can_read(path))
            continue;
        lab_body *body = &bodies[(*count)++];
        snprintf(body->name, sizeof body->name, "%s", scans[i].name);
        status = read_body(path, scans[i].turn, body, error);
    }
    if (status == PEL_OK && *count == 0) {
        status = pel_refuse(error, PEL_BAD_FILE,
                            "put goat-head.obj, koala.obj, spot.obj, cat.obj, nefertiti-head.obj, gallbladder.obj "
                            "or liver-coarse.obj there, or omit the folder: the program then generates the bodies",
                            "no scan is in the folder");
        pel_fail_place(error, data, 0, 0);
    }
    return status;
}

pel_status lab_find_bodies(const char *folder, const char *mesh, char up, const char *data, lab_body *bodies,
                           int *count, pel_error *error)
{
    *count = 0;
    if (mesh != NULL) {
        *count = 1;
        name_of_path(mesh, bodies[0].name, sizeof bodies[0].name);
        return read_body(mesh, up == 'x' ? X_UP : up == 'y' ? Y_UP : UPRIGHT, &bodies[0], error);
    }
    if (data != NULL)
        return find_scans(data, bodies, count, error);
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < BLENDS; i++)
        status = make_blend(folder, i, &bodies[(*count)++], error);
    return status;
}

void lab_free_bodies(lab_body *bodies)
{
    for (int i = 0; i < LAB_BODIES; i++) {
        free(bodies[i].cap);
        bodies[i].cap = NULL;
    }
}
