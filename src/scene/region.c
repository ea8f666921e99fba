#include "scene/region.h"

#include "math/vec3.h"
#include "scene/mesh.h"

#include <math.h>

/* the test of one region; one of the kinds below is set */
typedef struct region_test {
    const pel_scene_value *sphere, *box;
    double center[3], radius, falloff; /* of the sphere */
    double lowest[3], highest[3];      /* of the box */
    const double *field;
    double above;
} region_test;

static pel_status read_test(pel_scene_reader *reader, const pel_scene_value *value, const pel_mesh *mesh,
                            region_test *test)
{
    const pel_scene_value *field = pel_scene_value_entry(value, "field");
    test->sphere = pel_scene_value_entry(value, "sphere");
    test->box = pel_scene_value_entry(value, "box");
    if (test->sphere != NULL) {
        pel_scene_value_numbers(pel_scene_value_entry(test->sphere, "center"), test->center);
        test->radius = pel_scene_value_number(test->sphere, "radius");
        test->falloff = pel_scene_value_number(value, "falloff");
    }
    if (test->box != NULL) {
        pel_scene_value_numbers(pel_scene_value_entry(test->box, "min"), test->lowest);
        pel_scene_value_numbers(pel_scene_value_entry(test->box, "max"), test->highest);
    }
    if (field == NULL)
        return PEL_OK;
    test->above = pel_scene_value_number(value, "above");
    return pel_scene_field(reader, field, mesh, &test->field);
}

/* 1 up to the radius, smoothly down to 0 at radius + falloff */
static double sphere_weight(const region_test *test, double distance)
{
    double beyond = distance - test->radius;
    if (beyond <= 0)
        return 1;
    if (beyond >= test->falloff)
        return 0;
    double s = beyond / test->falloff;
    return 1 - s * s * (3 - 2 * s);
}

/* 0 = outside */
static double weight_of_vertex(const region_test *test, const pel_mesh *mesh, int32_t v)
{
    const double *x = mesh->positions[v];
    if (test->sphere != NULL)
        return sphere_weight(test, pel_vec3_distance(x, test->center));
    if (test->field != NULL)
        return test->field[v] > test->above ? 1 : 0;
    for (int i = 0; i < 3; i++)
        if (x[i] < test->lowest[i] || x[i] > test->highest[i])
            return 0;
    return 1;
}

static bool take_arrays(pel_scene_reader *reader, int32_t count, pel_scene_region *region)
{
    region->vertices = pel_arena_take(reader->arena, (size_t)count, sizeof *region->vertices);
    if (region->vertices == NULL)
        pel_fail_memory(reader->error);
    return region->vertices != NULL;
}

static pel_status select_by_weight(pel_scene_reader *reader, const pel_scene_value *value, const pel_mesh *mesh,
                                   pel_scene_region *region)
{
    region_test test = {0};
    pel_status status = read_test(reader, value, mesh, &test);
    if (status != PEL_OK)
        return status;
    int32_t count = 0;
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        count += weight_of_vertex(&test, mesh, v) > 0;
    if (!take_arrays(reader, count, region))
        return PEL_OUT_OF_MEMORY;
    if (test.falloff > 0 && (region->weights = pel_arena_take(reader->arena, (size_t)count, sizeof(double))) == NULL)
        return pel_fail_memory(reader->error);
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        double weight = weight_of_vertex(&test, mesh, v);
        if (!(weight > 0))
            continue;
        if (region->weights != NULL)
            region->weights[region->count] = weight;
        region->vertices[region->count++] = v;
    }
    return PEL_OK;
}

static pel_status select_listed(pel_scene_reader *reader, const pel_scene_value *list, const pel_mesh *mesh,
                                pel_scene_region *region)
{
    if (!take_arrays(reader, pel_scene_value_count(list), region))
        return PEL_OUT_OF_MEMORY;
    for (const pel_scene_value *child = list->first; child != NULL; child = child->next) {
        if (child->number >= mesh->vertex_count) {
            pel_scene_fail(reader, &child->place, "the mesh has no vertex %.0f", child->number);
            pel_fail_remedy(reader->error, "give numbers from 0 to %d", (int)mesh->vertex_count - 1);
            return PEL_BAD_SCENE;
        }
        region->vertices[region->count++] = (int32_t)child->number;
    }
    return PEL_OK;
}

static pel_status select_nearest(pel_scene_reader *reader, const pel_scene_value *point_value, const pel_mesh *mesh,
                                 pel_scene_region *region)
{
    double point[3], least = INFINITY;
    pel_scene_value_numbers(point_value, point);
    if (!take_arrays(reader, 1, region))
        return PEL_OUT_OF_MEMORY;
    region->count = 1;
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        double distance = pel_vec3_distance(mesh->positions[v], point);
        if (distance < least) {
            least = distance;
            region->vertices[0] = v;
        }
    }
    return PEL_OK;
}

/* tells where the mesh is, so that the region can be put there */
static pel_status fail_empty(pel_scene_reader *reader, const pel_scene_value *value, const pel_mesh *mesh)
{
    double lowest[3] = {INFINITY, INFINITY, INFINITY}, highest[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        for (int i = 0; i < 3; i++) {
            lowest[i] = fmin(lowest[i], mesh->positions[v][i]);
            highest[i] = fmax(highest[i], mesh->positions[v][i]);
        }
    pel_scene_fail(reader, &value->place, "this region holds no vertex");
    pel_fail_remedy(reader->error, "the mesh reaches from [%g, %g, %g] to [%g, %g, %g] m", lowest[0], lowest[1],
                    lowest[2], highest[0], highest[1], highest[2]);
    return PEL_BAD_SCENE;
}

pel_status pel_scene_region_find(pel_scene_reader *reader, const pel_scene_value *value, const pel_mesh *mesh,
                                 pel_scene_region *region)
{
    *region = (pel_scene_region){.count = mesh->vertex_count};
    if (value->kind != PEL_SCENE_MAP)
        return PEL_OK;
    region->count = 0;
    const pel_scene_value *list = pel_scene_value_entry(value, "vertices");
    const pel_scene_value *point = pel_scene_value_entry(value, "nearest");
    pel_status status;
    if (list != NULL)
        status = select_listed(reader, list, mesh, region);
    else if (point != NULL)
        status = select_nearest(reader, point, mesh, region);
    else
        status = select_by_weight(reader, value, mesh, region);
    return status == PEL_OK && region->count == 0 ? fail_empty(reader, value, mesh) : status;
}
