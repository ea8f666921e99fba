/* Pellicle: includes all headers of the core library. Scene files, other mesh formats and runs are in pellicle/scene.h,
   pellicle/import.h and pellicle/run.h. */
#ifndef PELLICLE_H
#define PELLICLE_H

#include "base.h"
#include "bending.h"
#include "collide.h"
#include "element.h"
#include "error.h"
#include "export.h"
#include "frames.h"
#include "geometry.h"
#include "haptic.h"
#include "intersect.h"
#include "json.h"
#include "live.h"
#include "material.h"
#include "measure.h"
#include "mesh.h"
#include "mesh_check.h"
#include "mesh_io.h"
#include "model.h"
#include "observe.h"
#include "parallel.h"
#include "potential.h"
#include "preset.h"
#include "region.h"
#include "results.h"
#include "sequence.h"
#include "shape.h"
#include "shell.h"
#include "sim.h"
#include "subdivide.h"
#include "topology.h"
#include "volume.h"

#endif
