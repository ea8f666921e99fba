/* Where the camera stands so that everything is seen. */
#ifndef PELLICLE_VIEW_CAMERA_H
#define PELLICLE_VIEW_CAMERA_H

#include "pellicle/render.h"

typedef struct view_camera {
    double axes[3][3];    /* unit vectors in the world: right, up, towards the camera */
    int32_t up;           /* axis of the world that points up: 0 x, 1 y, 2 z */
    double center[3];     /* the point in front of the camera, along the axes */
    double distance;      /* from there to the camera */
    double near, far;     /* distances from the camera between which everything lies */
    double tangents[2];   /* of half the angle of view, across and up */
    double fit_bounds[4]; /* while fitting: largest and least a + tangent f, across and up */
    double depths[2];     /* while fitting: least and largest f of the points that must be visible, */
    double all_depths[2]; /* and of all that is drawn */
} view_camera;

/* Begins fitting for a picture of that shape. */
void view_camera_begin(view_camera *camera, const pel_camera_angle *angle, int32_t up, int32_t width, int32_t height);
/* adds a ball of that radius (0 = a point) around a point to the points that must be visible */
void view_camera_see(view_camera *camera, const double point[3], double radius);
/* adds it to the points drawn, which may lie outside the picture */
void view_camera_reach(view_camera *camera, const double point[3], double radius);
/* Sets center, distance, near and far. */
void view_camera_fit(view_camera *camera, double zoom);

/* the point along the axes of the camera, relative to the center */
void view_camera_turn(const view_camera *camera, const double point[3], double turned[3]);
/* the matrix from there to the picture, column by column as OpenGL wants it */
void view_camera_project(const view_camera *camera, float matrix[16]);

#endif
