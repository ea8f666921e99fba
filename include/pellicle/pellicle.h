/* Pellicle: everything of the core library. Scene files and runs are in pellicle/scene.h. */
#ifndef PELLICLE_H
#define PELLICLE_H

#include "base.h"
#include "mesh.h"
#include "mesh_check.h"
#include "mesh_io.h"
#include "model.h"
#include "results.h"
#include "shape.h"
#include "sim.h"
#include "topology.h"

#endif
