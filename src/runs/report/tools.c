/* Tools in a report: each as one surface about its middle and, for each kept frame, the rigid motion that puts it where
   it is then, nine numbers of a rotation by rows and three of the place of the middle. The files of a run hold surfaces
   where they are; the motion follows from three vertices far from each other. */
#include "report/read.h"

#include "base/memory.h"
#include "math/vec3.h"

#include <math.h>

/* three vertices that are not on a line */
typedef struct triad {
    int32_t vertices[3];
} triad;

static void middle_of(const pel_mesh *mesh, double middle[3])
{
    pel_vec3_set(middle, 0, 0, 0);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        pel_vec3_along(middle, 1.0 / mesh->vertex_count, mesh->positions[v], middle);
}

/* vertex 0, the one farthest from it, and the one farthest from the line through both */
static triad choose_triad(const pel_mesh *mesh)
{
    triad chosen = {{0, 0, 0}};
    double farthest = 0, largest = 0;
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        double distance = pel_vec3_distance(mesh->positions[v], mesh->positions[0]);
        if (distance > farthest) {
            farthest = distance;
            chosen.vertices[1] = v;
        }
    }
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        double area =
            pel_vec3_triangle_area(mesh->positions[0], mesh->positions[chosen.vertices[1]], mesh->positions[v]);
        if (area > largest) {
            largest = area;
            chosen.vertices[2] = v;
        }
    }
    return chosen;
}

/* the frame that they span: unit vectors by rows */
static void frame_of(const pel_mesh *mesh, const triad *of, double rows[3][3])
{
    const double *a = mesh->positions[of->vertices[0]], *b = mesh->positions[of->vertices[1]];
    pel_vec3_subtract(b, a, rows[0]);
    pel_vec3_normalize(rows[0]);
    pel_vec3_triangle_normal(a, b, mesh->positions[of->vertices[2]], rows[2]);
    pel_vec3_normalize(rows[2]);
    pel_vec3_cross(rows[2], rows[0], rows[1]);
}

/* rotation (9) by rows from the base to the present surface, then the place of its middle */
static void put_pose(pel_json *json, const pel_mesh *base, const pel_mesh *now, const triad *of)
{
    double before[3][3], after[3][3], middle[3];
    frame_of(base, of, before);
    frame_of(now, of, after);
    middle_of(now, middle);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            double sum = 0;
            for (int r = 0; r < 3; r++)
                sum += after[r][i] * before[r][k];
            pel_json_print(json, "%s%.6g", i + k > 0 ? "," : "[", sum);
        }
    pel_json_print(json, ",%.7g,%.7g,%.7g]", middle[0], middle[1], middle[2]);
}

static void put_surface(pel_json *json, const char *name, const pel_mesh *mesh)
{
    double middle[3], x[3];
    middle_of(mesh, middle);
    pel_json_print(json, "{\"name\":");
    pel_json_put_text(json, name);
    pel_json_print(json, ",\"positions\":[");
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        pel_vec3_subtract(mesh->positions[v], middle, x);
        pel_json_print(json, "%s%.6g,%.6g,%.6g", v > 0 ? "," : "", x[0], x[1], x[2]);
    }
    pel_json_print(json, "],\"triangles\":[");
    for (int32_t t = 0; t < mesh->triangle_count; t++)
        pel_json_print(json, "%s%d,%d,%d", t > 0 ? "," : "", (int)mesh->triangles[t][0], (int)mesh->triangles[t][1],
                       (int)mesh->triangles[t][2]);
    pel_json_print(json, "],\"poses\":[");
}

/* the first kept frame with the tool, and its surface there; null if there is none */
static pel_status find_first(const pel_report_run *run, int32_t tool, pel_mesh **base, pel_error *error)
{
    pel_status status = PEL_OK;
    *base = NULL;
    for (int32_t f = 0; status == PEL_OK && *base == NULL && f < run->frames->frame_count; f++)
        if (pel_report_run_keeps(run, f))
            status = pel_frames_read_tool(run->frames, f, tool, base, error);
    return status;
}

/* skip tools that are in no kept frame; frames without a tool have no pose */
static pel_status put_tool(pel_report_run *run, int32_t tool, pel_error *error)
{
    pel_json *json = &run->json;
    pel_mesh *base, *now = NULL;
    pel_status status = find_first(run, tool, &base, error);
    if (status != PEL_OK || base == NULL)
        return status;
    const triad of = choose_triad(base);
    if (json->text != NULL && json->text[json->length - 1] == '}')
        pel_json_print(json, ",\n");
    put_surface(json, run->frames->tool_names[tool], base);
    const char *separator = "";
    for (int32_t f = 0; status == PEL_OK && f < run->frames->frame_count; f++) {
        if (!pel_report_run_keeps(run, f))
            continue;
        status = pel_frames_read_tool(run->frames, f, tool, &now, error);
        pel_json_print(json, "%s", separator);
        if (now != NULL && now->vertex_count == base->vertex_count)
            put_pose(json, base, now, &of);
        else
            pel_json_print(json, "null");
        separator = ",";
        pel_mesh_destroy(now);
    }
    pel_json_print(json, "]}");
    pel_mesh_destroy(base);
    return status;
}

pel_status pel_report_run_put_tools(pel_report_run *run, pel_error *error)
{
    pel_json *json = &run->json;
    pel_status status = PEL_OK;
    pel_json_print(json, ",\n\"tools\":[");
    for (int32_t i = 0; status == PEL_OK && i < run->frames->tool_count; i++)
        status = put_tool(run, i, error);
    pel_json_print(json, "]");
    return status;
}
