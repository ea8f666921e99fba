#include "primitive/shape_build.h"

#include "base/status.h"
#include "math/vec3.h"
#include "mesh/allocate.h"

/* coordinate of step i of count across a width about 0; the ends are exact */
static double across(double width, double i, int32_t count)
{
    return width * (i / (double)count - 0.5);
}

static int32_t row_length(const pel_shape_def *def, int32_t j)
{
    bool shifted = def->diagonals == PEL_GRID_EQUILATERAL && j % 2 == 1;
    return def->nx + (shifted ? 2 : 1);
}

static void fill_positions(const pel_shape_def *def, double (*positions)[3])
{
    for (int32_t j = 0; j <= def->ny; j++) {
        int32_t length = row_length(def, j);
        double y = across(def->size_y, j, def->ny);
        for (int32_t i = 0; i < length; i++) {
            /* a shifted row has its points at 0, 1/2, 3/2, ..., nx - 1/2, nx */
            double step = i;
            if (length == def->nx + 2)
                step = i == 0 ? 0 : i == def->nx + 1 ? def->nx : i - 0.5;
            pel_vec3_set(*positions++, across(def->size_x, step, def->nx), y, 0);
        }
    }
}

static void fill_square_cells(const pel_shape_def *def, int32_t (*triangles)[3])
{
    int32_t width = def->nx + 1;
    for (int32_t j = 0; j < def->ny; j++) {
        for (int32_t i = 0; i < def->nx; i++) {
            int32_t a = j * width + i, b = a + 1, c = b + width, d = a + width;
            bool other_way = def->diagonals == PEL_GRID_UNION_JACK && (i + j) % 2 == 1;
            pel_shape_put_triangle(&triangles, a, b, other_way ? d : c);
            pel_shape_put_triangle(&triangles, other_way ? b : a, c, d);
        }
    }
}

/* alternating rows of nx + 1 and nx + 2 points: a zigzag that begins and ends in the longer one */
static void fill_shifted_rows(const pel_shape_def *def, int32_t (*triangles)[3])
{
    int32_t first = 0;
    for (int32_t j = 0; j < def->ny; j++) {
        int32_t lower = first, upper = first + row_length(def, j);
        first = upper;
        if (j % 2 == 0) {
            for (int32_t i = 0; i <= def->nx; i++) {
                pel_shape_put_triangle(&triangles, lower + i, upper + i + 1, upper + i);
                if (i < def->nx)
                    pel_shape_put_triangle(&triangles, lower + i, lower + i + 1, upper + i + 1);
            }
        } else {
            for (int32_t i = 0; i <= def->nx; i++) {
                pel_shape_put_triangle(&triangles, lower + i, lower + i + 1, upper + i);
                if (i < def->nx)
                    pel_shape_put_triangle(&triangles, lower + i + 1, upper + i + 1, upper + i);
            }
        }
    }
}

pel_status pel_shape_grid(const pel_shape_def *def, pel_mesh **mesh, pel_error *error)
{
    int64_t nx = def->nx, ny = def->ny;
    bool shifted = def->diagonals == PEL_GRID_EQUILATERAL;
    int64_t vertex_count = (nx + 1) * (ny + 1) + (shifted ? (ny + 1) / 2 : 0);
    int64_t triangle_count = shifted ? ny * (2 * nx + 1) : 2 * nx * ny;
    pel_status status = pel_shape_check_size(vertex_count, triangle_count, error);
    if (status != PEL_OK)
        return status;
    pel_mesh *made = pel_mesh_allocate((int32_t)vertex_count, (int32_t)triangle_count);
    if (made == NULL)
        return pel_fail_memory(error);
    fill_positions(def, made->positions);
    if (shifted)
        fill_shifted_rows(def, made->triangles);
    else
        fill_square_cells(def, made->triangles);
    *mesh = made;
    return PEL_OK;
}
