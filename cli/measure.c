#include "commands.h"
#include "diagnostics.h"

#include <pellicle/measure.h>
#include <pellicle/mesh_check.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* a mesh and its measures */
typedef struct measured {
    pel_mesh *mesh;
    pel_topology *topology;
    pel_mesh_report *report;
    pel_curvature_summary summary;
} measured;

static bool has_volume(const measured *m)
{
    return m->report->closed && m->report->oriented;
}

/* total curvature by Gauss and Bonnet */
static double expected_total(const measured *m)
{
    return 2 * 3.14159265358979323846 * m->report->euler_characteristic;
}

static void print_measures(const char *path, const measured *m)
{
    const pel_curvature_summary *s = &m->summary;
    printf("%s\n", path);
    printf("  area                        %.9g\n", m->report->area);
    if (has_volume(m))
        printf("  volume                      %.9g\n", m->report->volume);
    if (s->inner_vertex_count > 0) {
        printf("  mean curvature              %.6g to %.6g, mean %.6g\n", s->mean_curvature_min, s->mean_curvature_max,
               s->mean_curvature_mean);
        printf("  integral of mean curvature  %.9g\n", s->mean_curvature_integral);
        printf("  Gaussian curvature          %.6g to %.6g, mean %.6g\n", s->gaussian_curvature_min,
               s->gaussian_curvature_max, s->gaussian_curvature_mean);
    }
    printf("  total Gaussian curvature    %.12g, 2 pi times the Euler number %d; off by %.1e\n", s->total_curvature,
           (int)m->report->euler_characteristic, fabs(s->total_curvature - expected_total(m)));
    if (!m->report->closed)
        printf("  boundary                    %d of %d vertices are excluded from the curvatures, but not from their "
               "total\n",
               (int)(m->report->vertex_count - s->inner_vertex_count), (int)m->report->vertex_count);
}

/* null when all vertices are on a boundary */
static void write_curvature(pel_json *json, const char *key, const pel_curvature_summary *summary, double value)
{
    if (summary->inner_vertex_count > 0)
        pel_json_number(json, key, value);
    else
        pel_json_null(json, key);
}

static void write_measures(const char *path, const measured *m)
{
    const pel_curvature_summary *s = &m->summary;
    pel_json json = {.file = stdout, .style = PEL_JSON_INDENTED};
    pel_json_open(&json, NULL, '{');
    pel_json_text(&json, "file", path);
    pel_json_integer(&json, "vertices", m->report->vertex_count);
    pel_json_integer(&json, "inner_vertices", s->inner_vertex_count);
    pel_json_integer(&json, "triangles", m->report->triangle_count);
    pel_json_number(&json, "area", m->report->area);
    if (has_volume(m))
        pel_json_number(&json, "volume", m->report->volume);
    else
        pel_json_null(&json, "volume");
    write_curvature(&json, "mean_curvature_min", s, s->mean_curvature_min);
    write_curvature(&json, "mean_curvature_mean", s, s->mean_curvature_mean);
    write_curvature(&json, "mean_curvature_max", s, s->mean_curvature_max);
    write_curvature(&json, "mean_curvature_integral", s, s->mean_curvature_integral);
    write_curvature(&json, "gaussian_curvature_min", s, s->gaussian_curvature_min);
    write_curvature(&json, "gaussian_curvature_mean", s, s->gaussian_curvature_mean);
    write_curvature(&json, "gaussian_curvature_max", s, s->gaussian_curvature_max);
    pel_json_number(&json, "total_gaussian_curvature", s->total_curvature);
    pel_json_integer(&json, "euler_characteristic", m->report->euler_characteristic);
    pel_json_number(&json, "gauss_bonnet_error", fabs(s->total_curvature - expected_total(m)));
    pel_json_close(&json, '}');
}

/* adds the measures as fields; values has room for a vector on each vertex */
static pel_status add_measures(const measured *m, double *values, pel_error *error)
{
    const double *x = m->mesh->positions[0];
    pel_surface_vertex_areas(m->topology, x, values);
    pel_status status = pel_mesh_add_field(m->mesh, "area", 1, values, error);
    pel_surface_normals(m->topology, x, PEL_NORMAL_ANGLE, values);
    if (status == PEL_OK)
        status = pel_mesh_add_field(m->mesh, "normal", 3, values, error);
    pel_surface_mean_curvature(m->topology, x, values, NULL);
    if (status == PEL_OK)
        status = pel_mesh_add_field(m->mesh, "mean_curvature", 1, values, error);
    pel_surface_gaussian_curvature(m->topology, x, values, NULL);
    return status == PEL_OK ? pel_mesh_add_field(m->mesh, "gaussian_curvature", 1, values, error) : status;
}

static pel_status add_pressure(const measured *m, double pressure, double *values, pel_error *error)
{
    const double *x = m->mesh->positions[0];
    pel_surface_pressure(m->topology, x, pressure, PEL_PRESSURE_CONSISTENT, values, NULL, NULL);
    pel_status status = pel_mesh_add_field(m->mesh, "pressure_force", 3, values, error);
    pel_surface_pressure(m->topology, x, pressure, PEL_PRESSURE_CONSISTENT, NULL, values, NULL);
    if (status == PEL_OK)
        status = pel_mesh_add_field(m->mesh, "pressure_magnitude", 1, values, error);
    pel_surface_pressure(m->topology, x, pressure, PEL_PRESSURE_CONSISTENT, NULL, NULL, values);
    return status == PEL_OK ? pel_mesh_add_field(m->mesh, "pressure_direction", 1, values, error) : status;
}

static int write_fields(const cli_call *call, const measured *m, const char *path)
{
    pel_error error;
    double *values = calloc((size_t)m->mesh->vertex_count, 3 * sizeof *values);
    pel_status status = values != NULL ? add_measures(m, values, &error) : pel_fail_memory(&error);
    if (status == PEL_OK && cli_has(call, "pressure"))
        status = add_pressure(m, cli_number(call, "pressure"), values, &error);
    free(values);
    if (status == PEL_OK)
        status = pel_mesh_write(path, PEL_FORMAT_AUTO, m->mesh, &cli_notes, &error);
    return status == PEL_OK ? CLI_DONE : cli_report(&error);
}

static int measure(const cli_call *call, measured *m)
{
    const char *path = call->arguments[0], *out = cli_value(call, "output");
    pel_error error;
    pel_status status = pel_topology_create(m->mesh, &m->topology, &error);
    if (status == PEL_OK)
        status = pel_mesh_check(m->mesh, &m->report, &error);
    if (status != PEL_OK) {
        cli_name_file(&error, path);
        return cli_report(&error);
    }
    if (m->report->issues[PEL_ISSUE_INSIDE_OUT].count > 0)
        fprintf(stderr,
                "note: the surface faces inward, which changes signs. 'pellicle check %s --fix OUT' turns it outward\n",
                path);
    pel_surface_curvature_summary(m->topology, m->mesh->positions[0], &m->summary);
    int done = out != NULL ? write_fields(call, m, out) : CLI_DONE;
    if (done != CLI_DONE)
        return done;
    if (cli_has(call, "json"))
        write_measures(path, m);
    else
        print_measures(path, m);
    return CLI_DONE;
}

int cli_measure(const cli_call *call)
{
    const char *out = cli_value(call, "output");
    pel_mesh_format format = out != NULL ? pel_mesh_format_of_path(out) : PEL_FORMAT_VTP;
    if (format != PEL_FORMAT_VTP && format != PEL_FORMAT_PLY)
        return cli_complain("'%s' cannot hold vertex fields. end the name in .vtp or .ply", out);
    if (out == NULL && cli_has(call, "pressure"))
        return cli_complain("option '--pressure' is about the file that is written. add '-o OUT.vtp'");
    measured m = {0};
    int status;
    m.mesh = cli_read_mesh(call->arguments[0], &cli_notes, NULL, &status);
    if (m.mesh != NULL)
        status = measure(call, &m);
    pel_mesh_report_destroy(m.report);
    pel_topology_destroy(m.topology);
    pel_mesh_destroy(m.mesh);
    return status;
}
