/* Do two triangles have a point in common? Decided by signs of exact determinants only, for all finite input: triangles
   that touch or overlap in a plane, and triangles that are segments or points, included.

   Two sets that are not single points meet exactly when an edge of one meets the other, so everything reduces to a
   closed segment against a closed triangle, and a closed segment against a closed segment. */
#include <math.h>
#include <string.h>

#include "pellicle/geometry.h"

#include "math/extremes.h"

typedef struct triangle {
    const double *corner[3];
    int axis; /* dropping this coordinate leaves a triangle with area; -1: it has none */
} triangle;

/* orientation without coordinate `axis` */
static int orient_dropping(int axis, const double *a, const double *b, const double *c)
{
    int x = (axis + 1) % 3, y = (axis + 2) % 3;
    const double p[2] = {a[x], a[y]}, q[2] = {b[x], b[y]}, r[2] = {c[x], c[y]};
    return pel_orient2d(p, q, r);
}

/* an axis along which three points have area; -1 when they are on a line */
static int find_axis(const double *a, const double *b, const double *c)
{
    for (int axis = 0; axis < 3; axis++)
        if (orient_dropping(axis, a, b, c) != 0)
            return axis;
    return -1;
}

/* p, on the line of a, b, lies between them */
static bool is_between(const double *p, const double *a, const double *b)
{
    for (int k = 0; k < 3; k++)
        if ((p[k] < a[k] && p[k] < b[k]) || (p[k] > a[k] && p[k] > b[k]))
            return false;
    return true;
}

/* four points on one plane that stay distinct without the coordinate `axis` */
static bool plane_segments_meet(int axis, const double *a, const double *b, const double *c, const double *d)
{
    int abc = orient_dropping(axis, a, b, c), abd = orient_dropping(axis, a, b, d);
    int cda = orient_dropping(axis, c, d, a), cdb = orient_dropping(axis, c, d, b);
    if (abc * abd < 0 && cda * cdb < 0)
        return true;
    return (abc == 0 && is_between(c, a, b)) || (abd == 0 && is_between(d, a, b)) ||
           (cda == 0 && is_between(a, c, d)) || (cdb == 0 && is_between(b, c, d));
}

static bool segments_meet(const double *a, const double *b, const double *c, const double *d)
{
    int axis = find_axis(a, b, c);
    if (axis < 0)
        axis = find_axis(a, b, d);
    if (axis < 0)
        axis = find_axis(c, d, a);
    if (axis >= 0)
        return pel_orient3d(a, b, c, d) == 0 && plane_segments_meet(axis, a, b, c, d);
    /* all on one line, or a = b and c = d */
    return is_between(a, c, d) || is_between(b, c, d) || is_between(c, a, b) || is_between(d, a, b);
}

/* p is on the plane of a triangle with area, nothing falls together without `axis` */
static bool plane_point_in_triangle(int axis, const double *p, const triangle *t)
{
    int signs[3];
    for (int i = 0; i < 3; i++)
        signs[i] = orient_dropping(axis, t->corner[i], t->corner[(i + 1) % 3], p);
    return (signs[0] >= 0 && signs[1] >= 0 && signs[2] >= 0) || (signs[0] <= 0 && signs[1] <= 0 && signs[2] <= 0);
}

/* segment against a triangle with area; a_side, b_side: orient3d of the triangle and the end */
static bool segment_meets_triangle(const double *a, const double *b, int a_side, int b_side, const triangle *t)
{
    if (a_side * b_side > 0)
        return false;
    if (a_side == 0 && b_side == 0) {
        if (plane_point_in_triangle(t->axis, a, t))
            return true;
        for (int i = 0; i < 3; i++)
            if (plane_segments_meet(t->axis, a, b, t->corner[i], t->corner[(i + 1) % 3]))
                return true;
        return false;
    }
    int signs[3];
    for (int i = 0; i < 3; i++)
        signs[i] = pel_orient3d(a, b, t->corner[i], t->corner[(i + 1) % 3]);
    return (signs[0] >= 0 && signs[1] >= 0 && signs[2] >= 0) || (signs[0] <= 0 && signs[1] <= 0 && signs[2] <= 0);
}

static void triangle_set(triangle *t, const double corners[3][3])
{
    for (int i = 0; i < 3; i++)
        t->corner[i] = corners[i];
    t->axis = find_axis(corners[0], corners[1], corners[2]);
}

/* sides of the corners of a against the plane of b, which has area and the first shared_count corners of a too; false
   when all are on one side */
static bool find_sides(const triangle *a, const triangle *b, int shared_count, int sides[3])
{
    for (int i = 0; i < 3; i++)
        sides[i] = 0;
    for (int i = shared_count; i < 3; i++)
        sides[i] = pel_orient3d(b->corner[0], b->corner[1], b->corner[2], a->corner[i]);
    return !(sides[0] > 0 && sides[1] > 0 && sides[2] > 0) && !(sides[0] < 0 && sides[1] < 0 && sides[2] < 0);
}

/* edge i goes from corner i to the next */
static bool edge_meets(const triangle *a, int i, const int sides[3], const triangle *b)
{
    int j = (i + 1) % 3;
    return segment_meets_triangle(a->corner[i], a->corner[j], sides[i], sides[j], b);
}

static bool any_edge_meets(const triangle *a, const int sides[3], const triangle *b)
{
    return edge_meets(a, 0, sides, b) || edge_meets(a, 1, sides, b) || edge_meets(a, 2, sides, b);
}

/* both are segments or points */
static bool flat_triangles_meet(const triangle *a, const triangle *b)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            if (segments_meet(a->corner[i], a->corner[(i + 1) % 3], b->corner[j], b->corner[(j + 1) % 3]))
                return true;
    return false;
}

static bool boxes_meet(const double a[3][3], const double b[3][3])
{
    for (int k = 0; k < 3; k++) {
        double a_low = pel_min(pel_min(a[0][k], a[1][k]), a[2][k]),
               a_high = pel_max(pel_max(a[0][k], a[1][k]), a[2][k]);
        double b_low = pel_min(pel_min(b[0][k], b[1][k]), b[2][k]),
               b_high = pel_max(pel_max(b[0][k], b[1][k]), b[2][k]);
        if (a_low > b_high || b_low > a_high)
            return false;
    }
    return true;
}

static bool corners_finite(const double a[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            if (!isfinite(a[i][k]))
                return false;
    return true;
}

bool pel_triangles_intersect(const double a[3][3], const double b[3][3])
{
    if (!corners_finite(a) || !corners_finite(b))
        return true;
    if (!boxes_meet(a, b))
        return false;
    triangle ta, tb;
    int a_sides[3], b_sides[3];
    triangle_set(&ta, a);
    triangle_set(&tb, b);
    if (ta.axis < 0 && tb.axis < 0)
        return flat_triangles_meet(&ta, &tb);
    if (tb.axis >= 0 && !find_sides(&ta, &tb, 0, a_sides))
        return false;
    bool one_plane = tb.axis >= 0 && a_sides[0] == 0 && a_sides[1] == 0 && a_sides[2] == 0;
    if (one_plane)
        memset(b_sides, 0, sizeof b_sides);
    else if (ta.axis >= 0 && !find_sides(&tb, &ta, 0, b_sides))
        return false;
    return (tb.axis >= 0 && any_edge_meets(&ta, a_sides, &tb)) || (ta.axis >= 0 && any_edge_meets(&tb, b_sides, &ta));
}

/* corner 0 is common: beyond it the triangles meet when the edge opposite to it in one meets the other */
static bool meet_beyond_vertex(const triangle *a, const triangle *b)
{
    int a_sides[3], b_sides[3];
    if (a->axis < 0 || b->axis < 0)
        return true;
    if (!find_sides(a, b, 1, a_sides) || !find_sides(b, a, 1, b_sides))
        return false;
    return edge_meets(a, 1, a_sides, b) || edge_meets(b, 1, b_sides, a);
}

/* corners 0 and 1 are common: beyond that edge the triangles meet when one is folded onto the other */
static bool meet_beyond_edge(const triangle *a, const triangle *b)
{
    if (a->axis < 0 || b->axis < 0)
        return true;
    /* the cheap test first: in a flat mesh the other one needs exact numbers */
    return orient_dropping(a->axis, a->corner[0], a->corner[1], a->corner[2]) ==
               orient_dropping(a->axis, b->corner[0], b->corner[1], b->corner[2]) &&
           pel_orient3d(a->corner[0], a->corner[1], a->corner[2], b->corner[2]) == 0;
}

bool pel_triangles_intersect_beyond(const double a[3][3], const double b[3][3], int shared_count)
{
    triangle ta, tb;
    if (shared_count <= 0)
        return pel_triangles_intersect(a, b);
    if (shared_count > 2 || !corners_finite(a) || !corners_finite(b))
        return true;
    triangle_set(&ta, a);
    triangle_set(&tb, b);
    return shared_count == 1 ? meet_beyond_vertex(&ta, &tb) : meet_beyond_edge(&ta, &tb);
}
