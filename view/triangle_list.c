#include "view/triangle_list.h"

#include "view/support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void view_triangle_list_destroy(view_triangle_list *soup)
{
    free(soup->corners);
    *soup = (view_triangle_list){0};
}

/* makes room for more corners and returns the first of them, null when out of memory */
static view_corner *add_corners(view_triangle_list *soup, size_t more, pel_error *error)
{
    size_t needed = soup->count + more;
    if (needed > soup->capacity) {
        size_t capacity = needed > 2 * soup->capacity ? needed : 2 * soup->capacity;
        view_corner *grown =
            capacity <= SIZE_MAX / sizeof *grown ? realloc(soup->corners, capacity * sizeof *grown) : NULL;
        if (grown == NULL) {
            pel_fail_memory(error);
            return NULL;
        }
        soup->corners = grown;
        soup->capacity = capacity;
    }
    view_corner *first = soup->corners + soup->count;
    soup->count = needed;
    return first;
}

/* ---- surfaces ---- */

static void cross_of(const pel_mesh *mesh, const int32_t corners[3], double normal[3])
{
    const double *a = mesh->positions[corners[0]], *b = mesh->positions[corners[1]], *c = mesh->positions[corners[2]];
    double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, w[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    for (int i = 0; i < 3; ++i)
        normal[i] = u[(i + 1) % 3] * w[(i + 2) % 3] - u[(i + 2) % 3] * w[(i + 1) % 3];
}

double (*view_mesh_normals(const pel_mesh *mesh))[3]
{
    double(*normals)[3] = view_allocate((size_t)mesh->vertex_count, sizeof *normals);
    for (int32_t t = 0; normals != NULL && t < mesh->triangle_count; ++t) {
        double normal[3];
        cross_of(mesh, mesh->triangles[t], normal);
        for (int i = 0; i < 3; ++i) {
            for (int k = 0; k < 3; ++k)
                normals[mesh->triangles[t][i]][k] += normal[k];
        }
    }
    return normals;
}

/* a direction along the axes of the camera, of length 1 unless it is 0 */
static void turn_normal(const view_camera *camera, const double normal[3], float turned[3])
{
    double length = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    for (int i = 0; i < 3; ++i) {
        const double *axis = camera->axes[i];
        double along = axis[0] * normal[0] + axis[1] * normal[1] + axis[2] * normal[2];
        turned[i] = length > 0 ? (float)(along / length) : 0;
    }
}

static void set_corner(const view_camera *camera, const double position[3], const double normal[3], double value,
                       view_corner *corner)
{
    double turned[3];
    view_camera_turn(camera, position, turned);
    for (int i = 0; i < 3; ++i)
        corner->position[i] = (float)turned[i];
    turn_normal(camera, normal, corner->normal);
    corner->value = (float)value;
}

/* whether the camera sees the triangle's front */
static bool is_front(const view_camera *camera, const view_corner *a, const view_corner *b, const view_corner *c)
{
    const float *p = a->position;
    double u[3], w[3], eye[3] = {-(double)p[0], -(double)p[1], camera->distance - (double)p[2]}, volume = 0;
    for (int i = 0; i < 3; ++i) {
        u[i] = (double)b->position[i] - (double)p[i];
        w[i] = (double)c->position[i] - (double)p[i];
    }
    for (int i = 0; i < 3; ++i)
        volume += eye[i] * (u[(i + 1) % 3] * w[(i + 2) % 3] - u[(i + 2) % 3] * w[(i + 1) % 3]);
    return volume > 0;
}

/* front-facing triangles come first, so that hidden ones need not be shaded */
static void set_triangles(view_corner *first, const view_camera *camera, const pel_mesh *mesh,
                          const view_corner *vertices, bool flat)
{
    view_corner *front = first, *back = first + 3 * (size_t)mesh->triangle_count;
    for (int32_t t = 0; t < mesh->triangle_count; ++t) {
        const int32_t *v = mesh->triangles[t];
        bool seen = is_front(camera, &vertices[v[0]], &vertices[v[1]], &vertices[v[2]]);
        view_corner *corner = seen ? front : back - 3;
        front += seen ? 3 : 0;
        back -= seen ? 0 : 3;
        double normal[3];
        float turned[3];
        if (flat) {
            cross_of(mesh, v, normal);
            turn_normal(camera, normal, turned);
        }
        for (int i = 0; i < 3; ++i) {
            corner[i] = vertices[v[i]];
            if (flat)
                memcpy(corner[i].normal, turned, sizeof turned);
        }
    }
}

pel_status view_triangle_list_add_mesh(view_triangle_list *soup, const view_camera *camera, const pel_mesh *mesh,
                                       const double *values, bool flat, pel_error *error)
{
    size_t vertex_count = (size_t)mesh->vertex_count;
    double(*normals)[3] = view_mesh_normals(mesh);
    view_corner *vertices = view_allocate(vertex_count, sizeof *vertices);
    view_corner *first = add_corners(soup, 3 * (size_t)mesh->triangle_count, error);
    bool good = normals != NULL && vertices != NULL && first != NULL;
    for (size_t v = 0; good && v < vertex_count; ++v)
        set_corner(camera, mesh->positions[v], normals[v], values != NULL ? values[v] : 0, &vertices[v]);
    if (good)
        set_triangles(first, camera, mesh, vertices, flat);
    free(normals);
    free(vertices);
    return good ? PEL_OK : pel_fail_memory(error);
}

/* ---- solids, in their own frame ---- */

/* where a solid stands: columns are its axes */
typedef struct frame {
    const view_camera *camera;
    double axes[3][3];
    double origin[3];
} frame;

static void set_solid_corner(const frame *f, const double position[3], const double normal[3], view_corner *corner)
{
    double moved[3], turned[3];
    for (int i = 0; i < 3; ++i) {
        moved[i] = f->origin[i];
        turned[i] = 0;
        for (int k = 0; k < 3; ++k) {
            moved[i] += f->axes[k][i] * position[k];
            turned[i] += f->axes[k][i] * normal[k];
        }
    }
    set_corner(f->camera, moved, turned, 0, corner);
}

/* A solid of revolution about z. Ring i of the profile (ring_count) is {radius, height, normal outward, normal up};
   corners of equal rings may have different normals. */
static pel_status add_revolved(view_triangle_list *soup, const frame *f, const double (*profile)[4], int ring_count,
                               int sides, pel_error *error)
{
    view_corner *corner = add_corners(soup, 6 * (size_t)(ring_count - 1) * (size_t)sides, error);
    if (corner == NULL)
        return PEL_OUT_OF_MEMORY;
    static const int order[6][2] = {{0, 0}, {0, 1}, {1, 1}, {0, 0}, {1, 1}, {1, 0}};
    for (int ring = 0; ring + 1 < ring_count; ++ring) {
        for (int side = 0; side < sides; ++side) {
            for (int i = 0; i < 6; ++i) {
                const double *row = profile[ring + order[i][0]];
                double angle = 6.283185307179586 * (side + order[i][1]) / sides, c = cos(angle), s = sin(angle);
                set_solid_corner(f, (double[]){row[0] * c, row[0] * s, row[1]},
                                 (double[]){row[2] * c, row[2] * s, row[3]}, corner++);
            }
        }
    }
    return PEL_OK;
}

enum { BALL_RINGS = 33, BALL_SIDES = 64 };

/* a ball, or two halves of one apart: from the lower pole to the upper one */
static pel_status add_capsule(view_triangle_list *soup, const frame *f, double radius, double half_length,
                              pel_error *error)
{
    double profile[BALL_RINGS + 1][4];
    int count = 0;
    for (int i = 0; i < BALL_RINGS; ++i) {
        double angle = 3.141592653589793 * (i / (BALL_RINGS - 1.0) - 0.5), c = cos(angle), s = sin(angle);
        bool middle = 2 * i == BALL_RINGS - 1;
        double shift = i < BALL_RINGS / 2 ? -half_length : half_length;
        if (middle)
            memcpy(profile[count++], (double[]){radius, -half_length, 1, 0}, sizeof profile[0]);
        memcpy(profile[count++], (double[]){radius * c, shift + radius * s, c, s}, sizeof profile[0]);
    }
    return add_revolved(soup, f, (const double(*)[4])profile, count, BALL_SIDES, error);
}

/* each triangle flat, so that edges show */
static pel_status add_mesh(view_triangle_list *soup, const frame *f, const pel_mesh *mesh, pel_error *error)
{
    view_corner *corner = add_corners(soup, 3 * (size_t)mesh->triangle_count, error);
    if (corner == NULL)
        return PEL_OUT_OF_MEMORY;
    for (int32_t t = 0; t < mesh->triangle_count; ++t) {
        const double *a = mesh->positions[mesh->triangles[t][0]], *b = mesh->positions[mesh->triangles[t][1]];
        const double *c = mesh->positions[mesh->triangles[t][2]];
        double u[3], w[3], normal[3];
        for (int i = 0; i < 3; ++i) {
            u[i] = b[i] - a[i];
            w[i] = c[i] - a[i];
        }
        for (int i = 0; i < 3; ++i)
            normal[i] = u[(i + 1) % 3] * w[(i + 2) % 3] - u[(i + 2) % 3] * w[(i + 1) % 3];
        double length = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
        for (int i = 0; i < 3 && length > 0; ++i)
            normal[i] /= length;
        for (int i = 0; i < 3; ++i)
            set_solid_corner(f, mesh->positions[mesh->triangles[t][i]], normal, corner++);
    }
    return PEL_OK;
}

pel_status view_triangle_list_add_tool(view_triangle_list *soup, const view_camera *camera, const pel_tool_def *tool,
                                       const double position[3], const double rotation[4], pel_error *error)
{
    double x = rotation[0], y = rotation[1], z = rotation[2], w = rotation[3];
    frame f = {.camera = camera,
               .axes = {{1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)},
                        {2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)},
                        {2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)}}};
    memcpy(f.origin, position, sizeof f.origin);
    if (tool->shape == PEL_TOOL_SUPPORT)
        return PEL_OK;
    if (tool->shape == PEL_TOOL_SPHERE || tool->shape == PEL_TOOL_CAPSULE)
        return add_capsule(soup, &f, tool->radius, tool->shape == PEL_TOOL_SPHERE ? 0 : tool->half_length, error);
    if (tool->shape == PEL_TOOL_MESH)
        return add_mesh(soup, &f, tool->mesh, error);
    pel_mesh *mesh;
    pel_status status = pel_tool_def_surface(tool, &mesh, error);
    if (status == PEL_OK)
        status = add_mesh(soup, &f, mesh, error);
    pel_mesh_destroy(mesh);
    return status;
}

pel_status view_triangle_list_add_arrow(view_triangle_list *soup, const view_camera *camera, const double tail[3],
                                        const double head[3], double width, pel_error *error)
{
    frame f = {.camera = camera};
    double *z = f.axes[2], *x = f.axes[0], length = 0;
    for (int i = 0; i < 3; ++i) {
        f.origin[i] = tail[i];
        z[i] = head[i] - tail[i];
        length += z[i] * z[i];
    }
    length = sqrt(length);
    if (!(length > 0))
        return PEL_OK;
    int least = 0;
    for (int i = 0; i < 3; ++i) {
        z[i] /= length;
        least = fabs(z[i]) < fabs(z[least]) ? i : least;
    }
    /* x across z, begun from the axis that z is farthest from */
    double along = z[least], size = sqrt(1 - along * along);
    for (int i = 0; i < 3; ++i)
        x[i] = ((i == least ? 1 : 0) - along * z[i]) / size;
    for (int i = 0; i < 3; ++i)
        f.axes[1][i] = z[(i + 1) % 3] * x[(i + 2) % 3] - z[(i + 2) % 3] * x[(i + 1) % 3];
    width = fmin(width, 0.2 * length);
    double shaft = 0.5 * width, point = 3 * width, rim = 0.42 * point, neck = length - point;
    const double profile[8][4] = {{0, 0, 0, -1},           {shaft, 0, 0, -1},      {shaft, 0, 1, 0},
                                  {shaft, neck, 1, 0},     {shaft, neck, 0, -1},   {rim, neck, 0, -1},
                                  {rim, neck, 0.92, 0.39}, {0, length, 0.92, 0.39}};
    return add_revolved(soup, &f, profile, 8, 12, error);
}

/* ---- ground ---- */

pel_status view_triangle_list_add_ground(view_triangle_list *soup, const view_camera *camera, const double center[3],
                                         double radius, pel_error *error)
{
    enum { CELLS = 24 };
    static const int at[6][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
    const int32_t up = camera->up, x = (up + 1) % 3, y = (up + 2) % 3;
    double normal[3] = {up == 0, up == 1, up == 2};
    view_corner *corner = add_corners(soup, (size_t)CELLS * CELLS * 6, error);
    if (corner == NULL)
        return PEL_OUT_OF_MEMORY;
    for (int cell = 0; cell < CELLS * CELLS; ++cell) {
        for (int i = 0; i < 6; ++i) {
            double u = 2.0 * (cell % CELLS + at[i][0]) / CELLS - 1, v = 2.0 * (cell / CELLS + at[i][1]) / CELLS - 1;
            double position[3] = {center[0], center[1], center[2]};
            position[x] += radius * u;
            position[y] += radius * v;
            double fade = fmax(1 - (u * u + v * v), 0);
            set_corner(camera, position, normal, fade * fade * (3 - 2 * fade), corner++);
        }
    }
    return PEL_OK;
}
