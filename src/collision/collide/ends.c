/* The lines along two edges a + s u and b + t v are nearest to each other at shares s and t of them; if one of these is
   not inside, the edges meet at an end. All is multiplied by the squared sine of their angle (times u.u v.v): */
#include "collide/ends.h"

#include "geom/wide4.h"

/* weights of a closest point that is not at an end are larger */
#define INSIDE 1e-3
/* sine of the angle below which edges are parallel */
#define PARALLEL 0.01

WIDE4_INLINE wide4 dot(const wide4 a[3], const wide4 b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

WIDE4_INLINE void subtract(const wide4 a[3], const wide4 b[3], wide4 difference[3])
{
    for (int k = 0; k < 3; k++)
        difference[k] = a[k] - b[k];
}

/* where the ends of four pairs are */
WIDE4_INLINE void load(const double (*x)[3], const int32_t (*points)[4], const int32_t lanes[4], wide4 ends[4][3])
{
    for (int i = 0; i < 4; i++) {
        const double *const at[4] = {x[points[lanes[0]][i]], x[points[lanes[1]][i]], x[points[lanes[2]][i]],
                                     x[points[lanes[3]][i]]};
        wide4_load_points(at, ends[i]);
    }
}

/* m, the most that the ends of both edges come nearer to each other; what they have in common brings them no nearer */
WIDE4_INLINE wide4 longest_approach(const wide4 start[4][3], const wide4 end[4][3])
{
    wide4 way[4][3], apart[3], most = wide4_set(0);
    for (int i = 0; i < 4; i++)
        subtract(end[i], start[i], way[i]);
    for (int i = 0; i < 2; i++)
        for (int j = 2; j < 4; j++) {
            subtract(way[i], way[j], apart);
            most = wide4_max(dot(apart, apart), most);
        }
    return wide4_sqrt(most);
}

/* whether their ends keep edges apart that hardly slide */
WIDE4_INLINE wide4_mask are_kept(const wide4 x[4][3], wide4 room)
{
    wide4 u[3], v[3], way[3];
    subtract(x[1], x[0], u);
    subtract(x[3], x[2], v);
    subtract(x[2], x[0], way);
    wide4 uu = dot(u, u), vv = dot(v, v), uv = dot(u, v), sine = uu * vv - uv * uv, least = INSIDE * sine;
    wide4 along_u = dot(way, u), along_v = dot(way, v);
    wide4 s = along_u * vv - along_v * uv, t = along_u * uv - along_v * uu;
    wide4 cross[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    wide4 across = dot(way, cross);
    wide4_mask at_end = (s < least) | (t < least) | (s > sine - least) | (t > sine - least);
    wide4_mask have_room = across * across >= room * room * sine;
    return (sine < PARALLEL * PARALLEL * uu * vv) | (at_end & have_room);
}

int32_t pel_edges_to_measure(const pel_edge_pairs *pairs, int32_t *numbers)
{
    int32_t count = 0;
    for (int32_t i = 0; i < pairs->count; i += WIDE4_WIDTH) {
        int32_t lanes[WIDE4_WIDTH], wide = pairs->count - i < WIDE4_WIDTH ? pairs->count - i : WIDE4_WIDTH;
        wide4 start[4][3], end[4][3], room;
        for (int lane = 0; lane < WIDE4_WIDTH; lane++) {
            lanes[lane] = lane < wide ? i + lane : i;
            room[lane] = pairs->rooms[lanes[lane]];
        }
        load(pairs->start, pairs->points, lanes, start);
        load(pairs->end, pairs->points, lanes, end);
        wide4_mask hardly = longest_approach((const wide4(*)[3])start, (const wide4(*)[3])end) < pairs->slide;
        wide4_mask kept = hardly & are_kept((const wide4(*)[3])start, room);
        for (int lane = 0; lane < wide; lane++) {
            numbers[count] = i + lane;
            count += kept[lane] == 0;
        }
    }
    return count;
}
