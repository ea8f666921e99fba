/* Pellicle: everything of the core library. Scene files and runs are in pellicle/scene.h. */
#ifndef PELLICLE_H
#define PELLICLE_H

#include "base.h"
#include "material.h"
#include "mesh.h"
#include "mesh_io.h"
#include "model.h"
#include "results.h"
#include "shape.h"
#include "sim.h"
#include "subdivide.h"
#include "topology.h"

#endif
