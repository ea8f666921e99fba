/* drag [MESH]: holds a soft body by a spring at the point where a ray meets it, pulls, makes the body softer during the
   pull, releases it, and restores the initial state. The body is a ball of 1 m radius, or the mesh. */
#include <inttypes.h>
#include <pellicle/pellicle.h>
#include <stdio.h>
#include <stdlib.h>

static void check(pel_status status, const pel_error *error)
{
    char text[800];
    if (status == PEL_OK)
        return;
    fprintf(stderr, "%s\n", pel_error_text(error, text, sizeof text));
    exit(1);
}

/* takes steps with the end of the spring at a target [m] and prints the result; changes are made between two steps */
static void pull(pel_sim *sim, pel_drag *drag, const double target[3], int steps)
{
    pel_error error;
    pel_drag_reading hand;
    for (int step = 0; step < steps; step++) {
        check(pel_drag_move(drag, target, &error), &error);
        check(pel_sim_step(sim, &error), &error);
    }
    pel_drag_get(drag, &hand);
    printf(
        "%.2f s: target z %.3f m, surface z %.3f m, force of the spring %.3f N, of the surface %.3f N, %d vertices\n",
        pel_sim_time(sim), hand.target[2], hand.point[2], hand.force[2], hand.reaction[2], (int)hand.held_count);
}

int main(int argc, char **argv)
{
    pel_error error;
    pel_mesh *mesh;
    pel_shape_def shape = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    check(argc > 1 ? pel_mesh_read(argv[1], PEL_FORMAT_AUTO, NULL, &mesh, &error)
                   : pel_shape_create(&shape, &mesh, &error),
          &error);
    pel_body_def body = pel_body_def_default();
    body.name = "body";
    body.mesh = mesh;
    pel_model_def model_def = pel_model_def_default();
    model_def.bodies = &body;
    model_def.body_count = 1;
    pel_model *model;
    check(pel_model_create(&model_def, &model, &error), &error);
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    pel_sim *sim;
    check(pel_sim_create(&def, &sim, &error), &error);
    pel_snapshot *start;
    check(pel_snapshot_create(sim, &start, &error), &error);
    uint64_t hash = pel_sim_hash(sim);

    /* a ray from above through the middle of the body, as a mouse click would give */
    double low[3], high[3];
    for (int i = 0; i < 3; i++) {
        low[i] = high[i] = mesh->positions[0][i];
        for (int32_t v = 1; v < mesh->vertex_count; v++) {
            low[i] = mesh->positions[v][i] < low[i] ? mesh->positions[v][i] : low[i];
            high[i] = mesh->positions[v][i] > high[i] ? mesh->positions[v][i] : high[i];
        }
    }
    const double height = high[2] - low[2], down[3] = {0, 0, -1};
    const double eye[3] = {(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, high[2] + height};
    pel_pick_hit hit;
    check(pel_pick(sim, eye, down, &hit, &error), &error);
    if (!hit.is_hit) {
        fprintf(stderr,
                "error: the ray from above through the middle does not meet the body. use a mesh that it meets\n");
        return 1;
    }
    printf("the ray meets triangle %d at (%.3f, %.3f, %.3f) m\n", (int)hit.triangle, hit.point[0], hit.point[1],
           hit.point[2]);

    /* pull by a spring of 5 N/m until spring and surface are in equilibrium */
    pel_drag *drag;
    check(pel_drag_begin(sim, &hit, 5, 0.1 * height, &drag, &error), &error);
    const double target[3] = {hit.point[0], hit.point[1], hit.point[2] + 0.2 * height};
    pull(sim, drag, target, 300);
    /* halve the stiffnesses of the body: the surface moves closer to the target */
    check(pel_set_parameter(sim, "bodies.body.springs.stiffness", 1.5, &error), &error);
    check(pel_set_parameter(sim, "bodies.body.volumetric.stiffness", 0.75, &error), &error);
    pull(sim, drag, target, 300);

    /* read a field by name, release the surface, and restore the initial state */
    int32_t field = pel_field_find("displacement");
    double *values = malloc((size_t)pel_sim_vertex_count(sim, 0) * 3 * sizeof *values), farthest = 0;
    check(pel_observe(sim, field, 0, values, &error), &error);
    for (int32_t v = 0; v < pel_sim_vertex_count(sim, 0); v++)
        farthest = values[3 * v + 2] > farthest ? values[3 * v + 2] : farthest;
    printf("largest upward %s: %.3f %s\n", pel_field_at(field)->name, farthest, pel_field_at(field)->unit);
    free(values);
    check(pel_drag_end(drag, &error), &error);
    check(pel_snapshot_restore(sim, start, &error), &error);
    printf("restored: %s\n",
           pel_sim_hash(sim) == hash ? "the same bits as at the start" : "other bits than at the start");
    pel_snapshot_destroy(start);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}
