/* A box: the points of a lattice of nx x ny x nz cells that lie on its faces, in layers from below. The lowest and the
   highest layer are whole, those between are rings. */
#include "primitive/shape_build.h"

#include "base/status.h"
#include "math/vec3.h"
#include "mesh/allocate.h"

typedef struct box_lattice {
    int32_t cells[3];
    int32_t layer, ring; /* points of a whole layer, and of its rim */
} box_lattice;

/* around the rim from the corner (0, 0), counter-clockwise seen from above */
static int32_t rim_place(const box_lattice *box, int32_t i, int32_t j)
{
    const int32_t nx = box->cells[0], ny = box->cells[1];
    if (j == 0)
        return i;
    if (i == nx)
        return nx + j;
    return j == ny ? 2 * nx + ny - i : 2 * nx + 2 * ny - j;
}

static int32_t number_of(const box_lattice *box, const int32_t p[3])
{
    const int32_t nz = box->cells[2], k = p[2];
    if (k > 0 && k < nz)
        return box->layer + (k - 1) * box->ring + rim_place(box, p[0], p[1]);
    return (k == 0 ? 0 : box->layer + (nz - 1) * box->ring) + p[1] * (box->cells[0] + 1) + p[0];
}

static void fill_positions(const box_lattice *box, const double size[3], double (*positions)[3])
{
    int32_t p[3];
    for (p[2] = 0; p[2] <= box->cells[2]; p[2]++)
        for (p[1] = 0; p[1] <= box->cells[1]; p[1]++)
            for (p[0] = 0; p[0] <= box->cells[0]; p[0]++) {
                bool is_outside = false;
                double x[3];
                for (int c = 0; c < 3; c++) {
                    is_outside |= p[c] == 0 || p[c] == box->cells[c];
                    x[c] = size[c] * (p[c] / (double)box->cells[c] - 0.5);
                }
                if (is_outside)
                    pel_vec3_set(positions[number_of(box, p)], x[0], x[1], x[2]);
            }
}

/* a face with its normal along an axis; diagonals alternate, so that no direction is preferred */
static void fill_face(const box_lattice *box, int axis, bool is_far, int32_t (**triangles)[3])
{
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (int32_t j = 0; j < box->cells[v]; j++)
        for (int32_t i = 0; i < box->cells[u]; i++) {
            int32_t corner[4];
            for (int n = 0; n < 4; n++) {
                int32_t p[3];
                p[axis] = is_far ? box->cells[axis] : 0;
                p[u] = i + (n == 1 || n == 2);
                p[v] = j + (n >= 2);
                /* outward: turned on the near face */
                corner[is_far ? n : 3 - n] = number_of(box, p);
            }
            const int first = (i + j) % 2;
            pel_shape_put_triangle(triangles, corner[first], corner[first + 1], corner[first + 2]);
            pel_shape_put_triangle(triangles, corner[first], corner[first + 2], corner[(first + 3) % 4]);
        }
}

pel_status pel_shape_box(const pel_shape_def *def, pel_mesh **mesh, pel_error *error)
{
    const int64_t nx = def->nx, ny = def->ny, nz = def->nz, faces = nx * ny + ny * nz + nz * nx;
    const double size[3] = {def->size_x, def->size_y, def->size_z};
    pel_status status = pel_shape_check_size(2 * faces + 2, 4 * faces, error);
    if (status != PEL_OK)
        return status;
    const box_lattice box = {.cells = {def->nx, def->ny, def->nz},
                             .layer = (int32_t)((nx + 1) * (ny + 1)),
                             .ring = (int32_t)(2 * (nx + ny))};
    pel_mesh *made = pel_mesh_allocate((int32_t)(2 * faces + 2), (int32_t)(4 * faces));
    if (made == NULL)
        return pel_fail_memory(error);
    int32_t(*next)[3] = made->triangles;
    fill_positions(&box, size, made->positions);
    for (int axis = 0; axis < 3; axis++)
        for (int far = 0; far < 2; far++)
            fill_face(&box, axis, far == 1, &next);
    *mesh = made;
    return PEL_OK;
}
