/* A tool that is pressed into a solid cuts a disc of radius w out of the surface at rest; by Hertz they touch in a disc
   of half that area. Edges are a share of w there, and grow with the distance from the tool. Force of a sphere that is
   pressed a tenth of its radius into a block, over that on fine meshes (tetrahedra):

       edge / w, growth            linear            smooth
       (not refined, 1.7 and 1.1)  1.62, 1.40
       0.35, 0.8                   1.06 (13,880)     0.99 (13,880)
       0.35, 0.6                   1.04 (20,188)
       0.25, 0.6                   1.03 (25,948)
       0.25, 0.4                   1.015 (48,572)    */
#include "choice/solid_spots.h"

#include "base/memory.h"
#include "base/status.h"
#include "geom/solid.h"
#include "math/extremes.h"
#include "math/pose.h"
#include "math/vec3.h"
#include "tetra/bisect.h"

#include <math.h>

/* edges: of w; of their distance from the tool */
#define FINEST 0.25
#define GRADE 0.5
#define FINEST_SMOOTH 0.35
#define GRADE_SMOOTH 0.8
enum { HALVINGS = 8, POSES_BETWEEN = 8, MOST_TETRAHEDRA = 150000 };
/* edges are longer by this factor, until the tetrahedra are few enough */
#define COARSER 1.25

/* a tool at a time */
typedef struct pressing_pose {
    pel_solid solid;
    double position[3], rotation[4];
    double edge; /* wanted there */
} pressing_pose;

typedef struct pressing_poses {
    pressing_pose *poses; /* (count) */
    int32_t count;
    double finest, grade;
    double factor; /* on all edges, so that the tetrahedra are few enough */
} pressing_poses;

static double distance_from(const pressing_pose *pose, const double point[3])
{
    double p[3], normal[3];
    pel_vec3_subtract(point, pose->position, p);
    pel_rotate_back(pose->rotation, p, p);
    return pel_solid_distance(&pose->solid, p, normal);
}

static double wanted_edge(void *user, const double center[3])
{
    const pressing_poses *all = user;
    double least = (double)HUGE_VAL;
    for (int32_t i = 0; i < all->count; i++) {
        const pressing_pose *pose = &all->poses[i];
        least = pel_min(least, all->factor * pel_max(pose->edge, all->grade * distance_from(pose, center)));
    }
    return least;
}

/* m2 of a triangle inside of a tool; it is halved so many times where it crosses the tool's surface */
static double part_inside(const pressing_pose *pose, const double x[3][3], int halvings)
{
    double center[3], normal[3], size = 0;
    for (int k = 0; k < 3; k++)
        center[k] = (x[0][k] + x[1][k] + x[2][k]) / 3;
    for (int i = 0; i < 3; i++)
        size = pel_max(size, pel_vec3_distance(center, x[i]));
    const double distance = distance_from(pose, center);
    if (distance > size || (halvings == 0 && distance > 0))
        return 0;
    if (distance < -size || halvings == 0) {
        pel_vec3_triangle_normal(x[0], x[1], x[2], normal);
        return 0.5 * pel_vec3_length(normal);
    }
    double middle[3][3], sum = 0;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            middle[i][k] = 0.5 * (x[i][k] + x[(i + 1) % 3][k]);
    for (int i = 0; i < 3; i++) {
        double corner[3][3];
        pel_vec3_copy(x[i], corner[0]);
        pel_vec3_copy(middle[i], corner[1]);
        pel_vec3_copy(middle[(i + 2) % 3], corner[2]);
        sum += part_inside(pose, (const double(*)[3])corner, halvings - 1);
    }
    return sum + part_inside(pose, (const double(*)[3])middle, halvings - 1);
}

static double area_inside(const pel_mesh *surface, const pressing_pose *pose)
{
    double sum = 0;
    for (int32_t t = 0; t < surface->triangle_count; t++) {
        double x[3][3];
        for (int i = 0; i < 3; i++)
            pel_vec3_copy(surface->positions[surface->triangles[t][i]], x[i]);
        sum += part_inside(pose, (const double(*)[3])x, HALVINGS);
    }
    return sum;
}

/* adds the poses in which a tool presses the surface; the widest one tells the edges of all */
static void add_tool(pressing_poses *all, const pel_tool_def *tool, const pel_mesh *surface)
{
    const int32_t begin = all->count;
    double most = 0;
    for (int32_t k = 0; k < tool->key_count; k++) {
        const double from = tool->keys[k].time, until = k + 1 < tool->key_count ? tool->keys[k + 1].time : from;
        for (int32_t i = 0; i < (until > from ? POSES_BETWEEN : 1); i++) {
            pressing_pose *pose = &all->poses[all->count];
            pose->solid = pel_solid_of(tool);
            pel_tool_def_pose(tool, from + (until - from) * i / POSES_BETWEEN, pose->position, pose->rotation);
            const double area = area_inside(surface, pose);
            all->count += area > 0;
            most = pel_max(most, area);
        }
    }
    for (int32_t i = begin; i < all->count; i++)
        all->poses[i].edge = all->finest * sqrt(most / 3.14159265358979323846);
}

static pel_status find_poses(const pel_scene *scene, int32_t body, const pel_mesh *surface, pressing_poses *all,
                             pel_error *error)
{
    size_t room = 0;
    for (int32_t t = 0; t < scene->sim.tool_count; t++)
        room += POSES_BETWEEN * (size_t)scene->sim.tools[t].key_count;
    all->poses = pel_allocate(room + 1, sizeof *all->poses);
    if (all->poses == NULL)
        return pel_fail_memory(error);
    for (int32_t t = 0; t < scene->sim.tool_count; t++) {
        const pel_tool_def *tool = &scene->sim.tools[t];
        if ((tool->body < 0 || tool->body == body) && tool->shape < PEL_TOOL_MESH && !tool->grasp)
            add_tool(all, tool, surface);
    }
    return PEL_OK;
}

static pel_status bisect(const pel_mesh *mesh, const pel_mesh *surface, pressing_poses *all, pel_mesh **fine,
                         pel_error *error)
{
    const pel_bisect_def def = {wanted_edge, all, surface, MOST_TETRAHEDRA + 2 * mesh->tetrahedron_count};
    pel_status status = PEL_OK;
    *fine = NULL;
    for (all->factor = 1;; all->factor *= COARSER) {
        status = pel_mesh_bisect(mesh, &def, fine, error);
        if (status != PEL_OK || (*fine)->tetrahedron_count < def.most)
            return status;
        pel_mesh_destroy(*fine);
    }
}

pel_status pel_scene_refine_solid(const pel_scene *scene, int32_t body, const pel_mesh *surface, pel_mesh **mesh,
                                  const pel_log *log, pel_error *error)
{
    const char *name = scene->model.bodies[body].name;
    const bool is_smooth = scene->model.bodies[body].volume.element == PEL_VOLUME_SMOOTH;
    pressing_poses all = {.finest = is_smooth ? FINEST_SMOOTH : FINEST, .grade = is_smooth ? GRADE_SMOOTH : GRADE};
    pel_mesh *fine = NULL;
    pel_status status = find_poses(scene, body, surface != NULL ? surface : *mesh, &all, error);
    if (status == PEL_OK && all.count > 0)
        status = bisect(*mesh, surface, &all, &fine, error);
    pel_free(all.poses);
    if (status != PEL_OK)
        return status;
    if (fine == NULL || fine->tetrahedron_count == (*mesh)->tetrahedron_count) {
        pel_mesh_destroy(fine);
        pel_log_line(log, "body '%s' is not refined: no tool that presses it needs shorter edges", name);
        return PEL_OK;
    }
    pel_log_line(log, "body '%s' is refined where tools press it: %d tetrahedra in place of %d%s", name,
                 (int)fine->tetrahedron_count, (int)(*mesh)->tetrahedron_count,
                 all.factor > 1 ? ", with longer edges than their forces need" : "");
    pel_mesh_destroy(*mesh);
    *mesh = fine;
    return PEL_OK;
}
