/* Bodies filled with tetrahedra, for tests: blocks, their defs and positions. */
#ifndef PEL_TESTS_SOLID_FIXTURE_H
#define PEL_TESTS_SOLID_FIXTURE_H

#include "fixture.h"
#include "pellicle/volume.h"

/* a block with a corner at 0, filled with tetrahedra of about an edge */
static inline pel_mesh *make_block(double x, double y, double z, double edge)
{
    const double points[8][3] = {{0, 0, 0}, {x, 0, 0}, {x, y, 0}, {0, y, 0},
                                 {0, 0, z}, {x, 0, z}, {x, y, z}, {0, y, z}};
    static const int32_t triangles[12][3] = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}, {0, 1, 5}, {0, 5, 4},
                                             {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};
    pel_mesh *surface, *filled;
    assert_int_equal(pel_mesh_create(points[0], 8, triangles[0], 12, &surface, NULL), PEL_OK);
    assert_int_equal(pel_mesh_fill(surface, edge, &filled, NULL), PEL_OK);
    pel_mesh_destroy(surface);
    return filled;
}

static inline pel_body_def solid_body(const pel_mesh *mesh, int kind, double young, double poisson)
{
    pel_body_def body = pel_body_def_default();
    body.name = "solid";
    body.mesh = mesh;
    body.spring_stiffness = body.spring_damping = (pel_quantity){0};
    body.volumetric_stiffness = body.volumetric_damping = (pel_quantity){0};
    body.mass_kind = PEL_MASS_DENSITY;
    body.mass = 1000;
    body.volume.on = true;
    body.volume.kind = (pel_volume_kind)kind;
    body.volume.young.value = young;
    body.volume.poisson = poisson;
    return body;
}

static inline double *positions_of(const stage *s)
{
    double *x = malloc(3 * sizeof *x * (size_t)s->mesh->vertex_count);
    pel_sim_get_positions(s->sim, 0, x);
    return x;
}

#endif
