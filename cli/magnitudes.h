/* What `pellicle check SCENE` says of a scene before it runs: magnitudes of each body, and what a run costs. */
#ifndef PELLICLE_CLI_MAGNITUDES_H
#define PELLICLE_CLI_MAGNITUDES_H

#include <pellicle/json.h>
#include <pellicle/scene.h>

/* Prints them, or writes them to json (nullable): an entry for each body, and the cost. The simulation is that of the
   scene at its start; some steps of it are done. */
void cli_tell_magnitudes(const pel_scene *scene, pel_sim *sim, pel_json *json);

#endif
