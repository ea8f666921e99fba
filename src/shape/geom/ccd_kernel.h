/* The kernel of continuous collision detection, as text: src/shape/geom/ccd_pair.h includes it once for double and once
   for wide4, so that one query and four queries are computed by the same operations in the same order. It needs
   CCD_INLINE, REAL, NAME(function), real_set, real_abs, real_min, real_max, real_sqrt and real_if_less. No include
   guard on purpose. */

typedef struct NAME(ccd_pair) {
    REAL offset[2][3], edge1[2][3], edge2[2][3]; /* [time 0 and 1] */
} NAME(ccd_pair);

/* Bernstein coefficients of the coplanarity cubic times 3, and how far from zero a coefficient proves anything */
typedef struct NAME(ccd_cubic) {
    REAL coefficient[4];
    REAL band;
} NAME(ccd_cubic);

CCD_INLINE REAL NAME(dot)(const REAL a[3], const REAL b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

CCD_INLINE void NAME(cross)(const REAL a[3], const REAL b[3], REAL product[3])
{
    product[0] = a[1] * b[2] - a[2] * b[1];
    product[1] = a[2] * b[0] - a[0] * b[2];
    product[2] = a[0] * b[1] - a[1] * b[0];
}

/* differences of the four points at one time (0 or 1) */
CCD_INLINE void NAME(ccd_pair_set)(NAME(ccd_pair) * pair, int time, REAL points[4][3], bool edge_edge)
{
    for (int k = 0; k < 3; k++) {
        if (edge_edge) {
            pair->offset[time][k] = points[0][k] - points[2][k];
            pair->edge1[time][k] = points[1][k] - points[0][k];
            pair->edge2[time][k] = points[2][k] - points[3][k];
        } else {
            pair->offset[time][k] = points[0][k] - points[1][k];
            pair->edge1[time][k] = points[1][k] - points[2][k];
            pair->edge2[time][k] = points[1][k] - points[3][k];
        }
    }
}

/* largest coordinate at both times */
CCD_INLINE REAL NAME(largest)(const REAL vectors[2][3])
{
    REAL start = real_max(real_max(real_abs(vectors[0][0]), real_abs(vectors[0][1])), real_abs(vectors[0][2]));
    REAL end = real_max(real_max(real_abs(vectors[1][0]), real_abs(vectors[1][1])), real_abs(vectors[1][2]));
    return real_max(start, end);
}

CCD_INLINE void NAME(ccd_pair_cubic)(const NAME(ccd_pair) * pair, double min_separation, NAME(ccd_cubic) * cubic)
{
    REAL n0[3], n1[3], p[3], q[3];
    NAME(cross)(pair->edge1[0], pair->edge2[0], n0);
    NAME(cross)(pair->edge1[1], pair->edge2[1], n1);
    NAME(cross)(pair->edge1[0], pair->edge2[1], p);
    NAME(cross)(pair->edge1[1], pair->edge2[0], q);
    for (int k = 0; k < 3; k++)
        p[k] = p[k] + q[k]; /* twice the middle coefficient of the normal */
    REAL b0 = 3.0 * NAME(dot)(n0, pair->offset[0]);
    REAL b1 = NAME(dot)(p, pair->offset[0]) + NAME(dot)(n0, pair->offset[1]);
    REAL b2 = NAME(dot)(p, pair->offset[1]) + NAME(dot)(n1, pair->offset[0]);
    REAL b3 = 3.0 * NAME(dot)(n1, pair->offset[1]);
    REAL size12 = NAME(largest)(pair->edge1) * NAME(largest)(pair->edge2);
    REAL band = CCD_CUBIC_ERROR * (size12 + CCD_TINY_PRODUCT) * NAME(largest)(pair->offset) + CCD_TINY;
    if (min_separation > 0) {
        REAL middle = 0.25 * NAME(dot)(p, p);
        REAL squared = real_max(middle, real_max(NAME(dot)(n0, n0), NAME(dot)(n1, n1)));
        REAL normal = real_sqrt(squared) + CCD_NORMAL_ERROR * size12 + CCD_TINY_NORMAL;
        band = band + (3.0 * CCD_ROUND_UP * min_separation) * normal;
    }
    /* NaN if any number above is NaN or overflowed: then nothing is proved */
    cubic->band = band + 0.0 * ((b0 + b1) + (b2 + b3));
    cubic->coefficient[0] = b0;
    cubic->coefficient[1] = b1;
    cubic->coefficient[2] = b2;
    cubic->coefficient[3] = b3;
}

/* positive = all coefficients lie on one side of zero, beyond the band */
CCD_INLINE REAL NAME(ccd_cubic_margin)(const REAL b[4], REAL band)
{
    REAL low = real_min(real_min(b[0], b[1]), real_min(b[2], b[3]));
    REAL high = real_max(real_max(b[0], b[1]), real_max(b[2], b[3]));
    return real_max(low, -high) - band;
}

/* bound of the rounding error of a coordinate of any corner at any time; NaN or infinite when a difference is */
CCD_INLINE REAL NAME(ccd_pair_error)(const NAME(ccd_pair) * pair)
{
    REAL sum = real_set(0);
    for (int time = 0; time < 2; time++)
        for (int k = 0; k < 3; k++)
            sum = sum + (pair->offset[time][k] + (pair->edge1[time][k] + pair->edge2[time][k]));
    REAL size = NAME(largest)(pair->offset) + (NAME(largest)(pair->edge1) + NAME(largest)(pair->edge2));
    return CCD_CORNER_ERROR * size + 0.0 * sum;
}

/* the same pair between two times of its step; error bounds of the whole step */
CCD_INLINE void NAME(ccd_pair_part)(const NAME(ccd_pair) * pair, REAL begin, REAL end, NAME(ccd_pair) * part)
{
    const REAL times[2] = {begin, end};
    for (int time = 0; time < 2; time++)
        for (int k = 0; k < 3; k++) {
            REAL late = times[time], early = 1 - late;
            part->offset[time][k] = early * pair->offset[0][k] + late * pair->offset[1][k];
            part->edge1[time][k] = early * pair->edge1[0][k] + late * pair->edge1[1][k];
            part->edge2[time][k] = early * pair->edge2[0][k] + late * pair->edge2[1][k];
        }
}

/* the corners (8 for edge-edge, 6 for vertex-face) of the swept difference; returns how many */
CCD_INLINE int NAME(ccd_pair_corners)(const NAME(ccd_pair) * pair, bool edge_edge, REAL corners[8][3])
{
    for (int time = 0; time < 2; time++)
        for (int k = 0; k < 3; k++) {
            REAL offset = pair->offset[time][k], along1 = offset + pair->edge1[time][k];
            corners[time][k] = offset;
            corners[2 + time][k] = along1;
            corners[4 + time][k] = offset + pair->edge2[time][k];
            if (edge_edge)
                corners[6 + time][k] = along1 + pair->edge2[time][k];
        }
    return edge_edge ? 8 : 6;
}

/* bound that the products of a direction with all corners must exceed to prove freedom */
CCD_INLINE REAL NAME(ccd_axis_threshold)(const REAL direction[3], REAL error, double min_separation)
{
    REAL sum = real_abs(direction[0]) + (real_abs(direction[1]) + real_abs(direction[2]));
    REAL threshold = error * sum + CCD_TINY;
    threshold = threshold + 0.0 * (0x1p60 * threshold); /* NaN where a dot product may have overflowed */
    if (min_separation > 0)
        threshold = threshold +
                    (CCD_ROUND_UP * min_separation) * (real_sqrt(NAME(dot)(direction, direction)) + CCD_TINY_NORMAL);
    return threshold;
}

/* positive = the plane through the origin across `direction`, moved by min_separation, has all corners on one side */
CCD_INLINE REAL NAME(ccd_axis_margin)(REAL corners[8][3], int corner_count, REAL direction[3], REAL error,
                                      double min_separation)
{
    REAL low = NAME(dot)(direction, corners[0]), high = low;
    for (int i = 1; i < corner_count; i++) {
        REAL along = NAME(dot)(direction, corners[i]);
        low = real_min(low, along);
        high = real_max(high, along);
    }
    return real_max(low, -high) - NAME(ccd_axis_threshold)(direction, error, min_separation);
}

/* the same for the coordinate axes, all three */
CCD_INLINE REAL NAME(ccd_box_margin)(REAL corners[8][3], int corner_count, REAL error, double min_separation)
{
    REAL best = real_set(-1);
    for (int k = 0; k < 3; k++) {
        REAL low = corners[0][k], high = low;
        for (int i = 1; i < corner_count; i++) {
            low = real_min(low, corners[i][k]);
            high = real_max(high, corners[i][k]);
        }
        REAL margin = real_max(low, -high) - (error + CCD_ROUND_UP * min_separation);
        best = real_max(margin, best); /* drops a NaN margin */
    }
    return best;
}

/* axes worth trying on a step or a part of it: the normal at its middle, across each edge in that plane, the normals at
   both ends. Positive = one of them proves freedom. */
CCD_INLINE REAL NAME(ccd_hull_margin)(const NAME(ccd_pair) * pair, REAL corners[8][3], int count, REAL error,
                                      double min_separation)
{
    const bool edge_edge = count == 8;
    REAL axis[3], edge1[3], edge2[3], normal[3];
    REAL best = NAME(ccd_box_margin)(corners, count, error, min_separation);
    for (int k = 0; k < 3; k++) {
        edge1[k] = pair->edge1[0][k] + pair->edge1[1][k];
        edge2[k] = pair->edge2[0][k] + pair->edge2[1][k];
    }
    NAME(cross)(edge1, edge2, normal);
    best = real_max(NAME(ccd_axis_margin)(corners, count, normal, error, min_separation), best);
    NAME(cross)(normal, edge1, axis);
    best = real_max(NAME(ccd_axis_margin)(corners, count, axis, error, min_separation), best);
    NAME(cross)(normal, edge2, axis);
    best = real_max(NAME(ccd_axis_margin)(corners, count, axis, error, min_separation), best);
    if (!edge_edge) {
        for (int k = 0; k < 3; k++)
            edge1[k] = edge1[k] - edge2[k];
        NAME(cross)(normal, edge1, axis);
        best = real_max(NAME(ccd_axis_margin)(corners, count, axis, error, min_separation), best);
    }
    for (int time = 0; time < 2; time++) {
        NAME(cross)(pair->edge1[time], pair->edge2[time], axis);
        best = real_max(NAME(ccd_axis_margin)(corners, count, axis, error, min_separation), best);
    }
    return best;
}

/* axes towards the point of the hull that is nearest to the origin, by the descent of Gilbert 1966: from a point of the
   hull to the nearest one on the way to the corner that is farthest down along it. Positive = one proves freedom. */
CCD_INLINE REAL NAME(ccd_descent_margin)(REAL corners[8][3], int count, REAL error, double min_separation)
{
    REAL nearest[3], best = real_set(-1);
    for (int k = 0; k < 3; k++) {
        REAL sum = corners[0][k];
        for (int i = 1; i < count; i++)
            sum = sum + corners[i][k];
        nearest[k] = sum * (1.0 / count);
    }
    for (int step = 0;; step++) {
        REAL low = NAME(dot)(nearest, corners[0]), way[3];
        for (int k = 0; k < 3; k++)
            way[k] = corners[0][k];
        for (int i = 1; i < count; i++) {
            REAL along = NAME(dot)(nearest, corners[i]);
            for (int k = 0; k < 3; k++)
                way[k] = real_if_less(along, low, corners[i][k], way[k]);
            low = real_min(along, low);
        }
        best = real_max(low - NAME(ccd_axis_threshold)(nearest, error, min_separation), best);
        if (step == CCD_DESCENT_STEPS)
            return best;
        for (int k = 0; k < 3; k++)
            way[k] = way[k] - nearest[k];
        REAL share = real_min(-NAME(dot)(nearest, way) / NAME(dot)(way, way), real_set(1));
        for (int k = 0; k < 3; k++)
            nearest[k] = nearest[k] + share * way[k];
    }
}
