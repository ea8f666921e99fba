#include "results/tool_surface.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "geom/solid_surface.h"
#include "results/folder.h"
#include "results/surface.h"
#include "tool/tool.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

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

static pel_status make_shape(pel_tool_surface *surface, const pel_tool *tool, pel_error *error)
{
    surface->solid = tool->solid;
    surface->mesh = tool->mesh;
    const pel_solid_surface size = tool->mesh != NULL
                                       ? (pel_solid_surface){tool->mesh->vertex_count, tool->mesh->triangle_count}
                                       : pel_solid_surface_size(&tool->solid);
    pel_status status = make_room(surface, size.vertex_count, size.triangle_count, error);
    if (status == PEL_OK && tool->mesh == NULL)
        pel_solid_surface_fill(&tool->solid, surface->local, surface->triangles);
    if (status != PEL_OK || tool->mesh == NULL)
        return status;
    memcpy(surface->local, tool->mesh->positions, (size_t)surface->vertex_count * sizeof *surface->local);
    memcpy(surface->triangles, tool->mesh->triangles, (size_t)surface->triangle_count * sizeof *surface->triangles);
    return PEL_OK;
}

static bool has_shape_of(const pel_tool_surface *surface, const pel_tool *tool)
{
    const pel_solid *a = &surface->solid, *b = &tool->solid;
    return surface->triangles != NULL && surface->mesh == tool->mesh && a->shape == b->shape &&
           a->radius == b->radius && a->half_length == b->half_length &&
           memcmp(a->half_extents, b->half_extents, sizeof a->half_extents) == 0 &&
           memcmp(a->edge, b->edge, sizeof a->edge) == 0 && a->closed == b->closed;
}

pel_status pel_tool_def_surface(const pel_tool_def *def, pel_mesh **mesh, pel_error *error)
{
    PEL_REFUSE_NULL(mesh, error);
    *mesh = NULL;
    PEL_REFUSE_NULL(def, error);
    if (PEL_IS_NO_CHOICE(def->shape, PEL_TOOL_SHAPE_COUNT) || def->shape == PEL_TOOL_SUPPORT ||
        (def->shape == PEL_TOOL_MESH && def->mesh == NULL))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give a shape with a surface, and a mesh for the shape mesh",
                          "the tool has no surface");
    const pel_tool tool = {.solid = pel_solid_of(def), .mesh = (pel_mesh *)(uintptr_t)def->mesh};
    pel_tool_surface surface = {.vertex_count = 0};
    pel_status status = make_shape(&surface, &tool, error);
    if (status == PEL_OK)
        status = pel_mesh_create(surface.local[0], surface.vertex_count, surface.triangles[0], surface.triangle_count,
                                 mesh, error);
    free_shape(&surface);
    return status;
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
        .float64 = output->float64 || pel_positions_need_double(surface->positions[0], surface->vertex_count),
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
