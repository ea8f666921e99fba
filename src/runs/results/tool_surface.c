#include "results/tool_surface.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "math/functions.h"
#include "results/folder.h"
#include "tool/tool.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* of a ball: rings of vertices between the poles, and vertices of a ring */
enum { RINGS = 11, SIDES = 24 };
static const double PI = 3.14159265358979323846;

struct pel_tool_surface {
    char name[PEL_NAME_SIZE];
    pel_solid solid;      /* that the surface was made of */
    const pel_mesh *mesh; /* of the tool; null = the solid */
    bool is_there;        /* in the last reading */
    pel_pose pose;        /* then */
    int32_t vertex_count, triangle_count;
    double (*local)[3];     /* (vertex_count) in the tool's frame */
    double (*positions)[3]; /* (vertex_count) at the pose */
    int32_t (*triangles)[3];
};

/* ---- shapes ---- */

static void free_shape(pel_tool_surface *surface)
{
    PEL_FREE_ALL(surface->local, surface->positions, surface->triangles);
    surface->local = surface->positions = NULL;
    surface->triangles = NULL;
}

static pel_status make_room(pel_tool_surface *surface, int32_t vertex_count, int32_t triangle_count, pel_error *error)
{
    free_shape(surface);
    surface->vertex_count = vertex_count;
    surface->triangle_count = triangle_count;
    bool made = PEL_ALLOCATE_ALL(PEL_ROOM(surface->local, vertex_count), PEL_ROOM(surface->positions, vertex_count),
                                 PEL_ROOM(surface->triangles, triangle_count));
    return made ? PEL_OK : pel_fail_memory(error);
}

static void set_triangle(int32_t *triangle, int32_t a, int32_t b, int32_t c)
{
    triangle[0] = a;
    triangle[1] = b;
    triangle[2] = c;
}

/* two half balls apart, from the lower pole to the upper one; of a capsule the ring in the middle stands twice */
static pel_status make_capsule(pel_tool_surface *surface, pel_error *error)
{
    const pel_solid *solid = &surface->solid;
    double half = solid->kind == PEL_SOLID_CAPSULE ? solid->half_length : 0;
    const int circles = half > 0 ? RINGS + 1 : RINGS;
    pel_status status = make_room(surface, circles * SIDES + 2, 2 * circles * SIDES, error);
    if (status != PEL_OK)
        return status;
    for (int r = 0; r < circles; r++) {
        int upper = half > 0 && r >= circles / 2;
        double latitude = PI * ((r - upper + 1.0) / (RINGS + 1.0) - 0.5);
        for (int s = 0; s < SIDES; s++) {
            double longitude = 2 * PI * s / SIDES, across = solid->radius * pel_cos(latitude);
            pel_vec3_set(surface->local[r * SIDES + s], across * pel_cos(longitude), across * pel_sin(longitude),
                         solid->radius * pel_sin(latitude) + (upper ? half : -half));
        }
    }
    int32_t low = circles * SIDES, high = low + 1, t = 0;
    pel_vec3_set(surface->local[low], 0, 0, -half - solid->radius);
    pel_vec3_set(surface->local[high], 0, 0, half + solid->radius);
    for (int s = 0; s < SIDES; s++) {
        int next = (s + 1) % SIDES, last = (circles - 1) * SIDES;
        set_triangle(surface->triangles[t++], low, next, s);
        set_triangle(surface->triangles[t++], high, last + s, last + next);
        for (int r = 0; r + 1 < circles; r++) {
            int a = r * SIDES + s, b = r * SIDES + next;
            set_triangle(surface->triangles[t++], a, b, b + SIDES);
            set_triangle(surface->triangles[t++], a, b + SIDES, a + SIDES);
        }
    }
    return PEL_OK;
}

static pel_status make_box(pel_tool_surface *surface, pel_error *error)
{
    /* bit k of a corner: on the upper side of axis k */
    static const int32_t faces[12][3] = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                                         {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
    pel_status status = make_room(surface, 8, 12, error);
    if (status != PEL_OK)
        return status;
    memcpy(surface->triangles, faces, sizeof faces);
    for (int corner = 0; corner < 8; corner++)
        for (int k = 0; k < 3; k++)
            surface->local[corner][k] =
                corner >> k & 1 ? surface->solid.half_extents[k] : -surface->solid.half_extents[k];
    return PEL_OK;
}

static pel_status make_shape(pel_tool_surface *surface, const pel_tool *tool, pel_error *error)
{
    surface->solid = tool->solid;
    surface->mesh = tool->mesh;
    if (tool->mesh == NULL)
        return tool->solid.kind == PEL_SOLID_BOX ? make_box(surface, error) : make_capsule(surface, error);
    pel_status status = make_room(surface, tool->mesh->vertex_count, tool->mesh->triangle_count, error);
    if (status != PEL_OK)
        return status;
    memcpy(surface->local, tool->mesh->positions, (size_t)surface->vertex_count * sizeof *surface->local);
    memcpy(surface->triangles, tool->mesh->triangles, (size_t)surface->triangle_count * sizeof *surface->triangles);
    return PEL_OK;
}

static bool has_shape_of(const pel_tool_surface *surface, const pel_tool *tool)
{
    const pel_solid *a = &surface->solid, *b = &tool->solid;
    return surface->triangles != NULL && surface->mesh == tool->mesh && a->kind == b->kind && a->radius == b->radius &&
           a->half_length == b->half_length && memcmp(a->half_extents, b->half_extents, sizeof a->half_extents) == 0;
}

/* ---- the list ---- */

void pel_tool_surfaces_destroy(pel_tool_surfaces *surfaces)
{
    for (int32_t i = 0; i < surfaces->count; i++)
        free_shape(&surfaces->list[i]);
    pel_free(surfaces->list);
    *surfaces = (pel_tool_surfaces){0};
}

const char *pel_tool_surface_name(const pel_tool_surfaces *surfaces, int32_t tool)
{
    return surfaces->list[tool].name;
}

pel_status pel_tool_surfaces_know(pel_tool_surfaces *surfaces, const char *name, pel_error *error)
{
    void *list = surfaces->list;
    if (!pel_reserve(&list, &surfaces->capacity, (size_t)surfaces->count + 1, sizeof *surfaces->list))
        return pel_fail_memory(error);
    surfaces->list = list;
    pel_tool_surface *made = &surfaces->list[surfaces->count++];
    *made = (pel_tool_surface){.is_there = false};
    snprintf(made->name, sizeof made->name, "%s", name);
    return PEL_OK;
}

static pel_status read_tool(pel_tool_surfaces *surfaces, const pel_tool *tool, pel_error *error)
{
    int32_t i = 0;
    while (i < surfaces->count && strcmp(surfaces->list[i].name, tool->name) != 0)
        i++;
    pel_status status = i == surfaces->count ? pel_tool_surfaces_know(surfaces, tool->name, error) : PEL_OK;
    if (status != PEL_OK)
        return status;
    pel_tool_surface *surface = &surfaces->list[i];
    surface->pose = tool->pose;
    surface->is_there = true;
    return has_shape_of(surface, tool) ? PEL_OK : make_shape(surface, tool, error);
}

pel_status pel_tool_surfaces_read(pel_tool_surfaces *surfaces, const pel_sim *sim, pel_error *error)
{
    pel_status status = PEL_OK;
    surfaces->time = pel_sim_time(sim);
    for (int32_t i = 0; i < surfaces->count; i++)
        surfaces->list[i].is_there = false;
    for (int32_t i = 0; status == PEL_OK && i < sim->tools->count; i++)
        if (sim->tools->items[i].support == NULL)
            status = read_tool(surfaces, &sim->tools->items[i], error);
    return status;
}

/* ---- files ---- */

static pel_status write_tool(const pel_tool_surface *surface, double time, const pel_output_def *output,
                             const char *path, pel_error *error)
{
    for (int32_t v = 0; v < surface->vertex_count; v++)
        pel_pose_to_world(&surface->pose, surface->local[v], surface->positions[v]);
    const pel_vtp vtp = {
        .vertex_count = surface->vertex_count,
        .triangle_count = surface->triangle_count,
        .positions = surface->positions[0],
        .triangles = surface->triangles[0],
        .time = time,
        .compress = output->compress,
        .float64 = output->float64,
    };
    return pel_vtp_write(path, &vtp, error);
}

pel_status pel_tool_surfaces_write(const pel_tool_surfaces *surfaces, const pel_output_def *output, const char *folder,
                                   int64_t frame, pel_error *error)
{
    char path[PEL_RUN_FILE_SIZE];
    pel_status status = PEL_OK;
    for (int32_t i = 0; status == PEL_OK && i < surfaces->count; i++)
        if (surfaces->list[i].is_there)
            status = write_tool(&surfaces->list[i], surfaces->time, output, pel_run_tool_path(path, folder, frame, i),
                                error);
    if (status != PEL_OK)
        pel_tool_surfaces_remove(surfaces, folder, frame);
    return status;
}

void pel_tool_surfaces_remove(const pel_tool_surfaces *surfaces, const char *folder, int64_t frame)
{
    char path[PEL_RUN_FILE_SIZE];
    for (int32_t i = 0; i < surfaces->count; i++)
        unlink(pel_run_tool_path(path, folder, frame, i));
}
