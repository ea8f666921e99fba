/* Triangles for OpenGL: three corners each, along the axes of the camera. */
#ifndef PELLICLE_VIEW_TRIANGLE_LIST_H
#define PELLICLE_VIEW_TRIANGLE_LIST_H

#include "view/camera.h"

#include "pellicle/mesh.h"
#include "pellicle/tool.h"

typedef struct view_corner {
    float position[3];
    float normal[3]; /* need not have length 1 */
    float value;     /* 0 .. 1 along the color map */
} view_corner;

typedef struct view_triangle_list {
    view_corner *corners; /* (count), three for each triangle */
    size_t count, capacity;
} view_triangle_list;

void view_triangle_list_destroy(view_triangle_list *soup);

/* Each of these empties nothing: it adds. Errors: PEL_OUT_OF_MEMORY. */

/* a surface with values (vertex_count; null = 0) on its vertices; flat: one normal per triangle */
pel_status view_triangle_list_add_mesh(view_triangle_list *soup, const view_camera *camera, const pel_mesh *mesh,
                                       const double *values, bool flat, pel_error *error);

/* a tool where it stands */
pel_status view_triangle_list_add_tool(view_triangle_list *soup, const view_camera *camera, const pel_tool_def *tool,
                                       const double position[3], const double rotation[4], pel_error *error);

/* an arrow from tail to head, at most `width` thick */
pel_status view_triangle_list_add_arrow(view_triangle_list *soup, const view_camera *camera, const double tail[3],
                                        const double head[3], double width, pel_error *error);

/* a disc of that radius across the camera's up axis, values 1 in its middle to 0 at its rim */
pel_status view_triangle_list_add_ground(view_triangle_list *soup, const view_camera *camera, const double center[3],
                                         double radius, pel_error *error);

/* area-weighted normals of the vertices (vertex_count x 3), not of length 1; free with `free`; null = out of memory */
double (*view_mesh_normals(const pel_mesh *mesh))[3];

#endif
