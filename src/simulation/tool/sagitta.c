/* Spheres and capsules on filled tissue are kept out of its vertices, and triangles may cut into them as far as a flat
   triangle with its corners on the tool does, by the sagitta R - sqrt(R^2 - r^2). r is the circumradius of the
   equilateral triangle with the same sum of squared edges; that of a right-angled triangle is larger.

   The filling is an elastic foundation, lumped at the vertices. Vertices at the depth of the tool sample its pressure,
   so that its force has no error of first order in their spacing. Keeping whole triangles out would also displace
   vertices beside the tool: with edges of two thirds of the radius the force was 1.7 times too high. A triangle stops
   the tool only beyond the sagitta, where the tool passes between vertices. */
#include "tool/sagitta.h"

#include "base/assert.h"
#include "math/extremes.h"
#include "tool/pose.h"

/* r^2 over that at rest: edges stretch between pressed vertices */
#define STRETCH 1.2
/* Radii of the tool over r: triangles cut in to the full from this on, and not at all up to that. A tool of less than
   an edge would fall between the vertices. */
#define FULL_RATIO 2.5
#define LEAST_RATIO 2.0

/* At rest: a solid that follows the surface would have more than one state of balance. */
static double circle_square(const pel_sim *sim, const int32_t corners[3])
{
    double x[3][3], sum = 0;
    for (int c = 0; c < 3; c++)
        pel_vertex_position(sim->model->rest, corners[c], x[c]);
    for (int c = 0; c < 3; c++) {
        double edge = pel_vec3_distance(x[c], x[(c + 1) % 3]);
        sum += edge * edge;
    }
    return sum / 9;
}

bool pel_tool_cuts(const pel_sim *sim, const pel_tool *tool, int32_t v)
{
    PEL_ASSERT_INDEX(v, sim->model->vertex_count);
    return sim->contacts == NULL && pel_tool_is_round(tool) &&
           sim->model->bodies[sim->model->body_of_slice[v / PEL_WIDTH]].is_foundation;
}

pel_solid pel_tool_triangle_solid(const pel_sim *sim, const pel_tool *tool, int32_t t)
{
    const int32_t *corners = sim->model->triangles[t];
    pel_solid solid = pel_tool_press_solid(sim, tool, corners[0]);
    if (!pel_tool_cuts(sim, tool, corners[0]))
        return solid;
    double circle = circle_square(sim, corners), square = solid.radius * solid.radius;
    double ratio = solid.radius / sqrt(circle);
    double share = pel_min(pel_max((ratio - LEAST_RATIO) / (FULL_RATIO - LEAST_RATIO), 0), 1);
    if (share > 0)
        solid.radius -= share * (solid.radius - sqrt(square - STRETCH * circle));
    return solid;
}
