/* `refine: auto`: bodies whose meshes are made finer around small loads and tools, before anything else is made. Of
   solids see choice/solid_spots.c.

   Elements with the edges e give a deflection under a force P normal to a plate that is too large by 0.15 P e^2 / D
   (src/runs/run/warnings_shell.c). On a shell of thickness h and radius R such a dent is sqrt(R h) wide, on a plate a
   part of its size: the bending length. Edges are FINEST of it at the load and GRADE of the distance from there, up to
   REACH bending lengths. Over a region of radius r the error is that of edges e^2 / r. */
#include "scene/build.h"

#include "base/memory.h"
#include "choice/solid_spots.h"
#include "field/radius.h"
#include "geom/solid.h"
#include "math/extremes.h"
#include "math/functions.h"
#include "math/pose.h"
#include "math/vec3.h"
#include "mesh/figures.h"
#include "model/quantity.h"
#include "pellicle/tool.h"
#include "scene/mesh.h"
#include "subdivide/local.h"

#include <math.h>

/* of the bending length: edges at a load, and how far from it they are finer */
#define FINEST 0.08
#define REACH 3.0
/* edges over their distance from a load */
#define GRADE 0.2
/* of the size of a body: the bending length of a plate */
#define PLATE 0.28
/* edges around a vertex that tell the curvature there */
#define NEAR 3.0
/* of a force: its part across the surface that bends it */
#define ACROSS 0.1
/* bytes of the levels of detail of a body */
#define MEMORY ((size_t)1 << 30)
enum { MOST_LEVELS = 6, POSES_BETWEEN = 8 };

/* a place where a body is finer */
typedef struct fine_spot {
    double point[3], radius; /* of the region of a load */
    double finest, length;   /* edges there; the bending length */
} fine_spot;

typedef struct body_spots {
    const pel_body_def *body;
    const pel_topology *topology;
    double thickness; /* of a plate that bends and stretches as the body */
    fine_spot *spots; /* (room) */
    int32_t count, room;
} body_spots;

static bool divides(const void *user, int32_t level, int32_t triangle, double edge, const double center[3])
{
    (void)level, (void)triangle;
    const body_spots *spots = user;
    for (int32_t s = 0; s < spots->count; s++) {
        const fine_spot *spot = &spots->spots[s];
        double distance = pel_vec3_distance(center, spot->point) - spot->radius;
        if (distance < REACH * spot->length && edge > pel_max(spot->finest, GRADE * distance))
            return true;
    }
    return false;
}

/* the plate that has the body's stiffnesses against stretching and bending */
static double thickness_of(const pel_body_def *body)
{
    const pel_membrane_def *membrane = &body->shell.membrane;
    int32_t count = body->mesh->vertex_count;
    double thickness = pel_quantity_mean(&membrane->thickness, count);
    double stiffness = pel_quantity_mean(&body->shell.bending.stiffness, count);
    if (!(stiffness > 0))
        return thickness;
    double young = pel_quantity_mean(&membrane->young, count), poisson = membrane->poisson;
    return sqrt(12 * (1 - poisson * poisson) * stiffness / (young * thickness));
}

/* adds a spot, unless the mesh is fine enough there or another spot sees to it */
static bool add_spot(body_spots *spots, const double point[3], double radius)
{
    double curvature_radius, edge, far = NEAR * pel_mesh_diagonal(spots->body->mesh);
    pel_mesh_mean_radius(spots->body->mesh, spots->topology, point, (double)HUGE_VAL, &curvature_radius, &edge);
    pel_mesh_mean_radius(spots->body->mesh, spots->topology, point, pel_min(NEAR * edge + radius, far),
                         &curvature_radius, &edge);
    fine_spot spot = {.radius = radius};
    spot.length = pel_min(sqrt(curvature_radius * spots->thickness), PLATE * pel_mesh_diagonal(spots->body->mesh));
    spot.finest = FINEST * spot.length;
    spot.finest = pel_max(spot.finest, sqrt(spot.finest * radius));
    pel_vec3_copy(point, spot.point);
    for (int32_t s = 0; s < spots->count; s++)
        if (pel_vec3_distance(spots->spots[s].point, point) < spots->spots[s].finest &&
            spots->spots[s].radius >= radius)
            return false;
    if (spots->count == spots->room || !(edge > spot.finest))
        return false;
    spots->spots[spots->count++] = spot;
    return true;
}

/* ---- loads ---- */

static void normal_at(const pel_mesh *mesh, int32_t vertex, double normal[3])
{
    pel_vec3_set(normal, 0, 0, 0);
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        const int32_t *v = mesh->triangles[t];
        double own[3];
        if (v[0] != vertex && v[1] != vertex && v[2] != vertex)
            continue;
        pel_vec3_triangle_normal(mesh->positions[v[0]], mesh->positions[v[1]], mesh->positions[v[2]], own);
        pel_vec3_add(normal, own, normal);
    }
    pel_vec3_normalize(normal);
}

/* the centre of the vertices of a load, and the radius of a disc that is as wide */
static double center_of(const pel_mesh *mesh, const pel_load_def *load, double center[3])
{
    double sum = 0, square = 0;
    pel_vec3_set(center, 0, 0, 0);
    for (int32_t i = 0; i < load->vertex_count; i++) {
        double weight = load->weights != NULL ? load->weights[i] : 1;
        pel_vec3_along(center, weight, mesh->positions[load->vertices[i]], center);
        sum += weight;
    }
    if (!(sum > 0))
        return -1;
    pel_vec3_scale(center, 1 / sum, center);
    for (int32_t i = 0; i < load->vertex_count; i++) {
        double distance = pel_vec3_distance(center, mesh->positions[load->vertices[i]]);
        square += (load->weights != NULL ? load->weights[i] : 1) * distance * distance;
    }
    return sqrt(2 * square / sum);
}

static void add_load(body_spots *spots, const pel_load_def *load)
{
    const pel_mesh *mesh = spots->body->mesh;
    double normal[3], center[3], force = pel_vec3_length(load->force);
    bool is_force = load->kind == PEL_LOAD_TOTAL || load->kind == PEL_LOAD_PER_VERTEX;
    if (!is_force || load->vertices == NULL || load->vertex_count >= mesh->vertex_count || !(force > 0))
        return;
    double radius = center_of(mesh, load, center);
    normal_at(mesh, load->vertices[0], normal);
    if (radius >= 0 && fabs(pel_vec3_dot(normal, load->force)) > ACROSS * force)
        add_spot(spots, center, load->vertex_count > 1 ? radius : 0);
}

/* ---- tools ---- */

/* the vertex that is deepest in a tool at a time; -1 = none */
static int32_t deepest_in(const pel_mesh *mesh, const pel_tool_def *tool, double time)
{
    const pel_solid solid = pel_solid_of(tool);
    double position[3], rotation[4], least = tool->grasp ? tool->reach : 0;
    int32_t deepest = -1;
    pel_tool_def_pose(tool, time, position, rotation);
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        double p[3], normal[3];
        pel_vec3_subtract(mesh->positions[v], position, p);
        pel_rotate_back(rotation, p, p);
        double distance = pel_solid_distance(&solid, p, normal);
        if (distance < least) {
            least = distance;
            deepest = v;
        }
    }
    return deepest;
}

static void add_tool(body_spots *spots, const pel_tool_def *tool)
{
    const pel_mesh *mesh = spots->body->mesh;
    for (int32_t k = 0; k < tool->key_count; k++) {
        double from = tool->keys[k].time, until = k + 1 < tool->key_count ? tool->keys[k + 1].time : from;
        for (int32_t i = 0; i < (until > from ? POSES_BETWEEN : 1); i++) {
            int32_t v = deepest_in(mesh, tool, from + (until - from) * i / POSES_BETWEEN);
            if (v >= 0)
                add_spot(spots, mesh->positions[v], 0);
        }
    }
}

/* ---- bodies ---- */

static pel_status refuse(pel_scene_reader *reader, const pel_scene_value *value, const pel_body_def *body,
                         const char *what, const char *remedy)
{
    pel_scene_fail(reader, &value->place, "body '%s' cannot refine automatically: %s", body->name, what);
    pel_fail_remedy(reader->error, "%s", remedy);
    return PEL_BAD_SCENE;
}

static pel_status check_body(pel_scene_reader *reader, const pel_scene *scene, const pel_scene_value *value, int32_t b)
{
    const pel_body_def *body = &scene->model.bodies[b];
    if (body->volume.on)
        return PEL_OK;
    if (!body->shell.membrane.on || body->shell.bending.model == PEL_BENDING_NONE)
        return refuse(reader, value, body, "it has no membrane that bends",
                      "use refine: { levels: 2, near_tools: ... }, or a region, for tissue and springs");
    if (body->mass_kind == PEL_MASS_PER_VERTEX)
        return refuse(reader, value, body, "its mass is given per vertex, and the number of vertices changes",
                      "give mass.density or mass.total");
    for (int32_t c = 0; c < scene->sim.cut_count; c++)
        if (scene->sim.cuts[c].body == b)
            return refuse(reader, value, body, "it has cuts", "subdivide the mesh (pellicle subdivide)");
    for (int32_t s = 0; s < scene->sim.seam_count; s++)
        if (scene->sim.seams[s].body == b)
            return refuse(reader, value, body, "it has seams", "subdivide the mesh (pellicle subdivide)");
    return PEL_OK;
}

static void find_spots(body_spots *spots, const pel_scene *scene, int32_t b)
{
    spots->thickness = thickness_of(spots->body);
    for (int32_t l = 0; l < scene->sim.load_count; l++)
        if (scene->sim.loads[l].body == b)
            add_load(spots, &scene->sim.loads[l]);
    for (int32_t t = 0; t < scene->sim.tool_count; t++) {
        const pel_tool_def *tool = &scene->sim.tools[t];
        if ((tool->body < 0 || tool->body == b) && tool->shape < PEL_TOOL_MESH)
            add_tool(spots, tool);
    }
}

static int32_t levels_of(const body_spots *spots)
{
    const pel_mesh *mesh = spots->body->mesh;
    double most = 1;
    for (int32_t t = 0; t < mesh->triangle_count; t++)
        for (int i = 0; i < 3; i++)
            for (int32_t s = 0; s < spots->count; s++) {
                const double *a = mesh->positions[mesh->triangles[t][i]];
                double edge = pel_vec3_distance(a, mesh->positions[mesh->triangles[t][(i + 1) % 3]]);
                if (pel_vec3_distance(a, spots->spots[s].point) <= edge + spots->spots[s].radius)
                    most = pel_max(most, edge / spots->spots[s].finest);
            }
    return (int32_t)pel_min(ceil(pel_log2(most)), MOST_LEVELS);
}

static pel_status refine_body(pel_scene_reader *reader, const pel_scene *scene, int32_t b, pel_mesh **mesh)
{
    pel_topology *topology = NULL;
    pel_mesh *fine = NULL;
    body_spots spots = {.body = &scene->model.bodies[b], .room = scene->sim.load_count};
    for (int32_t t = 0; t < scene->sim.tool_count; t++)
        spots.room += POSES_BETWEEN * scene->sim.tools[t].key_count;
    spots.spots = pel_allocate((size_t)spots.room, sizeof *spots.spots);
    pel_status status =
        spots.spots != NULL ? pel_topology_create(*mesh, &topology, reader->error) : pel_fail_memory(reader->error);
    spots.topology = topology;
    if (status == PEL_OK)
        find_spots(&spots, scene, b);
    if (status == PEL_OK && spots.count > 0) {
        const pel_local_def def = {
            .divides = divides, .user = &spots, .depth = levels_of(&spots), .memory_limit = MEMORY};
        status = pel_mesh_subdivide_locally(*mesh, &def, &fine, reader->error);
    }
    if (status == PEL_OK && fine != NULL) {
        pel_log_line(reader->log, "body '%s' is refined around %d small loads and tools: %d triangles in place of %d",
                     spots.body->name, (int)spots.count, (int)fine->triangle_count, (int)(*mesh)->triangle_count);
        status = pel_scene_keep_welding(reader, *mesh, fine);
        pel_mesh_destroy(*mesh);
        *mesh = fine;
    } else if (status == PEL_OK) {
        pel_log_line(reader->log, "body '%s' is not refined: no small load and no tool needs shorter edges",
                     spots.body->name);
    }
    pel_topology_destroy(topology);
    pel_free(spots.spots);
    return status;
}

/* with the surface that was filled, made again */
static pel_status refine_solid(pel_scene_reader *reader, pel_scene_value *root, const pel_scene *scene, int32_t b,
                               pel_mesh **mesh)
{
    pel_scene_value *body = pel_scene_value_element(pel_scene_value_entry(root, "bodies"), b);
    pel_mesh *surface = NULL;
    const pel_log *log = reader->log;
    reader->log = NULL;
    pel_status status = pel_scene_mesh(reader, pel_scene_value_entry(body, "mesh"), ".", &surface);
    reader->log = log;
    if (status == PEL_OK)
        status =
            pel_scene_refine_solid(scene, b, surface->tetrahedron_count > 0 ? NULL : surface, mesh, log, reader->error);
    pel_mesh_destroy(surface);
    return status;
}

static const pel_scene_value *refine_of(const pel_scene_value *root, int32_t b)
{
    return pel_scene_value_entry(pel_scene_value_element(pel_scene_value_entry(root, "bodies"), b), "refine");
}

bool pel_scene_is_fine(const pel_scene *scene, int32_t body)
{
    const pel_scene_value *value = refine_of(pel_scene_root(scene), body);
    return value != NULL && value->form == PEL_FORM_WORD;
}

pel_status pel_scene_refine_meshes(pel_scene_reader *reader, pel_scene_value *root, const pel_scene *scene,
                                   pel_mesh **meshes, bool *any)
{
    pel_status status = PEL_OK;
    *any = false;
    for (int32_t b = 0; status == PEL_OK && b < scene->model.body_count; b++) {
        const pel_scene_value *value = refine_of(root, b);
        if (value == NULL || value->form != PEL_FORM_WORD)
            continue;
        *any = true;
        status = check_body(reader, scene, value, b);
        if (status == PEL_OK)
            status = scene->model.bodies[b].volume.on ? refine_solid(reader, root, scene, b, &meshes[b])
                                                      : refine_body(reader, scene, b, &meshes[b]);
    }
    return status;
}

pel_status pel_scene_check_refined_loads(pel_scene_reader *reader, const pel_scene_value *root,
                                         const pel_sim_def *before, const pel_sim_def *after)
{
    const pel_scene_value *list = pel_scene_value_entry(root, "loads");
    for (int32_t l = 0; l < after->load_count; l++) {
        const pel_load_def *load = &after->loads[l];
        if (load->kind != PEL_LOAD_PER_VERTEX || load->vertex_count == before->loads[l].vertex_count)
            continue;
        pel_scene_fail(reader, &pel_scene_value_element(list, l)->place,
                       "load '%s' acts on each of its vertices, and refine: auto makes them %d in place of %d",
                       load->name, (int)load->vertex_count, (int)before->loads[l].vertex_count);
        pel_fail_remedy(reader->error, "give its force in total (per: total), or list its vertices");
        return PEL_BAD_SCENE;
    }
    return PEL_OK;
}
