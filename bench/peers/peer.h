/* One level of modified butterfly by several programs, from indexed triangles to positions. */
#ifndef PEL_BENCH_PEER_H
#define PEL_BENCH_PEER_H

#include "bench/bench.h"

#include <vector>

struct soup {
    std::vector<double> positions; /* x y z of each vertex */
    std::vector<int> triangles;    /* three corners each */
};

/* fills fine, unless null, after the clock has stopped; returns the seconds from soup to fine positions */
double subdivide_openmesh(const soup &coarse, soup *fine);
double subdivide_vtk(const soup &coarse, soup *fine);

#endif
