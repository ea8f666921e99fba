/* A set of contacts over arrays: noisy sheets, one above the other, and obstacles. */
#ifndef PEL_TESTS_CONTACT_SET_FIXTURE_H
#define PEL_TESTS_CONTACT_SET_FIXTURE_H

#include "check.h"
#include "contact/set.h"
#include "random.h"

#define THICKNESS 0.02

enum { MOST_VERTICES = 256, MOST_SLICES = MOST_VERTICES / PEL_WIDTH, MOST_TRIANGLES = 512, MOST_EDGES = 1024 };

/* bodies and obstacles, as arrays */
typedef struct arrays {
    int32_t vertex_count, body_count, obstacle_count, triangle_count;
    int32_t body_of_slice[MOST_SLICES];
    pel_real mass[MOST_VERTICES], inverse_mass[MOST_VERTICES];
    pel_record rest[MOST_VERTICES], next[MOST_VERTICES], velocity[MOST_VERTICES];
    int32_t triangles[MOST_TRIANGLES][3];
    pel_obstacle obstacles[2];
    pel_contact_group groups[4];
    bool has_layers;
} arrays;

/* a body of rows x rows vertices over the unit square, with noise, at a height; unused vertices fill its last slice */
static inline void add_sheet(arrays *a, int32_t rows, double height, double noise, random_state *random)
{
    int32_t first = a->vertex_count, count = rows * rows;
    for (int32_t i = 0; i < count; i++) {
        double x = (double)(i % rows) / (rows - 1), y = (double)(i / rows) / (rows - 1);
        double z = height + noise * random_between(random, -1, 1);
        double mass = random_between(random, 0.5, 2);
        a->mass[first + i] = (pel_real)mass;
        a->inverse_mass[first + i] = (pel_real)(1 / mass);
        a->rest[first + i] = (pel_record){(pel_real)x, (pel_real)y, (pel_real)z, (pel_real)(1 / mass)};
        a->next[first + i] = a->rest[first + i];
    }
    for (int32_t i = 0; i < (rows - 1) * (rows - 1); i++) {
        int32_t v = first + i / (rows - 1) * rows + i % (rows - 1);
        const int32_t corners[2][3] = {{v, v + 1, v + rows + 1}, {v, v + rows + 1, v + rows}};
        memcpy(a->triangles[a->triangle_count], corners, sizeof corners);
        a->triangle_count += 2;
    }
    int32_t slices = (count + PEL_WIDTH - 1) / PEL_WIDTH;
    for (int32_t s = 0; s < slices; s++)
        a->body_of_slice[first / PEL_WIDTH + s] = a->body_count;
    a->vertex_count += slices * PEL_WIDTH;
    a->groups[a->body_count++] = (pel_contact_group){.thickness = THICKNESS, .friction = 0};
}

/* two sheets, the second one above the first */
static inline void make_sheets(arrays *a, uint64_t seed, int32_t lower_rows, int32_t upper_rows, double height,
                               double noise)
{
    random_state random = {seed};
    *a = (arrays){0};
    add_sheet(a, lower_rows, 0, noise, &random);
    add_sheet(a, upper_rows, height, noise, &random);
}

/* the last groups, so after all sheets */
static inline void add_obstacle(arrays *a, const pel_obstacle *obstacle, double friction)
{
    a->obstacles[a->obstacle_count] = *obstacle;
    a->groups[a->body_count + a->obstacle_count++] = (pel_contact_group){.thickness = THICKNESS, .friction = friction};
}

static inline pel_pose pose_at(double x, double y, double z)
{
    return (pel_pose){.position = {x, y, z}, .rotation = {0, 0, 0, 1}};
}

static inline pel_status make_set(const arrays *a, pel_contact_set **set, pel_error *error)
{
    const pel_contact_set_def def = {
        .vertex_count = a->vertex_count,
        .body_count = a->body_count,
        .body_of_slice = a->body_of_slice,
        .mass = a->mass,
        .inverse_mass = a->inverse_mass,
        .rest = a->rest,
        .triangle_limit = a->triangle_count,
        .obstacles = a->obstacles,
        .obstacle_count = a->obstacle_count,
        .groups = a->groups,
        .thickness = THICKNESS,
        .shortest_edge = 0.05,
        .self = true,
        .between = true,
        .has_layers = a->has_layers,
        .method = PEL_CCD_CONSERVATIVE,
        .limit = 10000,
    };
    pel_status status = pel_contact_set_create(&def, set, error);
    if (status != PEL_OK)
        return status;
    pel_contact_set_place(*set, a->rest, a->next);
    status = pel_contact_surface_begin(*set, error);
    if (status != PEL_OK)
        return status;
    for (int32_t t = 0; t < a->triangle_count; t++)
        pel_contact_surface_add(*set, a->triangles[t]);
    return pel_contact_surface_finish(*set, false, error);
}

static inline pel_contact_set *create(const arrays *a)
{
    pel_contact_set *set;
    pel_error error;
    assert_int_equal(make_set(a, &set, &error), PEL_OK);
    return set;
}

#endif
