/* press [MESH RADIUS]: presses a ball of a radius [m] into a soft body, withdraws it, and prints its depth and force */
#include <pellicle/pellicle.h>
#include <stdio.h>
#include <stdlib.h>

/* functions that can fail return a status and fill the error: problem, place and remedy */
static void check(pel_status status, const pel_error *error)
{
    char text[800];
    if (status == PEL_OK)
        return;
    fprintf(stderr, "%s\n", pel_error_text(error, text, sizeof text));
    exit(1);
}

int main(int argc, char **argv)
{
    pel_error error;
    pel_mesh *mesh;
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    check(argc > 2 ? pel_mesh_read(argv[1], PEL_FORMAT_AUTO, NULL, &mesh, &error)
                   : pel_shape_create(&def, &mesh, &error),
          &error);

    /* the model is constant: meshes, masses and springs. The default body is soft and has volumetric springs */
    pel_body_def body = pel_body_def_default();
    body.name = "body";
    body.mesh = mesh;
    pel_model_def model_def = pel_model_def_default();
    model_def.bodies = &body;
    model_def.body_count = 1;
    pel_model *model;
    check(pel_model_create(&model_def, &model, &error), &error);

    /* the ball starts just above the highest vertex, moves down by half its radius in 1 s, and up again in 1 s */
    const double *top = mesh->positions[0];
    for (int32_t v = 1; v < mesh->vertex_count; v++)
        top = mesh->positions[v][2] > top[2] ? mesh->positions[v] : top;
    const double r = argc > 2 ? atof(argv[2]) : 0.4, x = top[0], y = top[1], z = top[2] + 1.001 * r, low = z - r / 2;
    pel_pose_key keys[] = {
        {0, {x, y, z}, {0, 0, 0, 1}, {0}}, {1, {x, y, low}, {0, 0, 0, 1}, {0}}, {2, {x, y, z}, {0, 0, 0, 1}, {0}}};
    const pel_tool_def ball = {.name = "ball", .radius = r, .keys = keys, .key_count = 3, .body = 0, .press = true};
    /* the simulation: the state of the model, which changes under tools and loads */
    pel_sim_def sim_def = pel_sim_def_default();
    sim_def.model = model;
    sim_def.tools = &ball;
    sim_def.tool_count = 1;
    pel_sim *sim;
    check(pel_sim_create(&sim_def, &sim, &error), &error);
    for (int step = 1; step <= 300; step++) {
        check(pel_sim_step(sim, &error), &error);
        pel_tool_reading felt;
        pel_sim_get_tool(sim, 0, &felt);
        if (step % 25 == 0)
            printf("%.2f s: depth %7.4f m, force %7.4f N\n", pel_sim_time(sim), z - felt.position[2], felt.force[2]);
    }
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}
