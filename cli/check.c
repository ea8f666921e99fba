#include "commands.h"
#include "cracks.h"
#include "diagnostics.h"
#include "intersections.h"
#include "magnitudes.h"
#include "parts.h"

#include <pellicle/mesh_check.h>
#include <pellicle/scene.h>

#include <stdlib.h>
#include <string.h>

/* findings of one kind that are printed one by one */
enum { SHOWN_MAX = 5 };

/* a vertex where the finding can be looked at; -1 = none */
static int32_t vertex_of(const pel_mesh *mesh, const pel_issue_info *info, const pel_issue *issue, int32_t i)
{
    int32_t v = issue->elements[i];
    if (strcmp(info->element_kind, "edge") == 0)
        v = issue->related[i][0];
    else if (strcmp(info->element_kind, "vertex") != 0)
        v = v >= 0 && v < mesh->triangle_count ? mesh->triangles[v][0] : -1;
    return v >= 0 && v < mesh->vertex_count ? v : -1;
}

/* "edge 12 (vertices 3, 4)" */
static void print_element(FILE *file, const pel_issue_info *info, const pel_issue *issue, int32_t i)
{
    int element = (int)issue->elements[i], first = (int)issue->related[i][0], second = (int)issue->related[i][1];
    switch (info->kind) {
    case PEL_ISSUE_NON_MANIFOLD_EDGE:
    case PEL_ISSUE_INCONSISTENT_WINDING:
    case PEL_ISSUE_BOUNDARY_EDGE:
        fprintf(file, "edge %d (vertices %d, %d)", element, first, second);
        break;
    case PEL_ISSUE_NON_ORIENTABLE:
    case PEL_ISSUE_INSIDE_OUT:
        fprintf(file, "component %d (from triangle %d on)", first, element);
        break;
    case PEL_ISSUE_DUPLICATE_TRIANGLE:
        fprintf(file, "triangle %d (like triangle %d)", element, first);
        break;
    case PEL_ISSUE_DUPLICATE_VERTEX:
        fprintf(file, "vertex %d (like vertex %d)", element, first);
        break;
    case PEL_ISSUE_REPEATED_VERTEX:
        fprintf(file, "triangle %d (vertex %d)", element, first);
        break;
    case PEL_ISSUE_BAD_INDEX:
        fprintf(file, "triangle %d (index %d)", element, second);
        break;
    default:
        fprintf(file, "%s %d", info->element_kind, element);
        break;
    }
}

static void print_issue(const char *path, const pel_mesh *mesh, const pel_issue_info *info, const pel_issue *issue)
{
    const char *severity = cli_severity_name(info->severity);
    int32_t shown = issue->listed_count < SHOWN_MAX ? issue->listed_count : SHOWN_MAX;
    for (int32_t i = 0; i < shown; ++i) {
        fprintf(stderr, "%s: %s: ", path, severity);
        print_element(stderr, info, issue, i);
        int32_t v = vertex_of(mesh, info, issue, i);
        if (v >= 0) {
            const double *x = mesh->positions[v];
            fprintf(stderr, " at (%.6g, %.6g, %.6g)", x[0], x[1], x[2]);
        }
        fprintf(stderr, ": %s. %s\n", info->doc, info->remedy);
    }
    if (issue->count > shown)
        fprintf(stderr, "%s: %s: and %d more: %s\n", path, severity, (int)(issue->count - shown), info->doc);
}

/* findings of a mesh */
typedef struct findings {
    pel_mesh_report *report;
    cli_cracks cracks;
    cli_parts parts;
    cli_intersections intersections;
    int32_t fill; /* --fill-holes with this number closes the mesh; 0 = nothing does, or it was not tried */
} findings;

static void print_issues(const char *path, const pel_mesh *mesh, const findings *found)
{
    for (int kind = 0; kind < PEL_ISSUE_COUNT; ++kind) {
        const pel_issue_info *info = pel_issue_info_of((pel_issue_kind)kind);
        const pel_issue *issue = &found->report->issues[kind];
        if (issue->count > 0 && info->severity != PEL_SEVERITY_NOTE) {
            print_issue(path, mesh, info, issue);
        } else if (issue->count > 0) {
            fprintf(stderr, "%s: note: %s: %d of them", path, info->doc, (int)issue->count);
            if (found->fill > 0)
                fprintf(stderr, ". if it is meant to be closed, run `pellicle check FILE --fix OUT --fill-holes %d`",
                        (int)found->fill);
            fputc('\n', stderr);
        }
    }
}

static int64_t count_warnings(const findings *found)
{
    return found->report->warning_count + (found->cracks.count > 0) + found->intersections.count;
}

/* edges that --fill-holes may close at most to be tried: it takes as long as the rest of the check */
enum { FILLED_MAX = 1000 };

/* fills the holes of a mesh that has no other finding: found->fill is set if the result is closed and does not cut
   itself, unlike that of a flat sheet */
static pel_status try_fill(const pel_mesh *mesh, findings *found, pel_error *error)
{
    const pel_mesh_report *report = found->report;
    int32_t rim_edges = report->issues[PEL_ISSUE_BOUNDARY_EDGE].count, longest = 0;
    if (report->error_count + count_warnings(found) > 0 || !found->intersections.looked || rim_edges == 0 ||
        rim_edges > FILLED_MAX)
        return PEL_OK;
    for (int32_t c = 0; c < report->component_count; c++)
        if (report->components[c].boundary_edge_count > longest)
            longest = report->components[c].boundary_edge_count;
    pel_mesh *filled = NULL;
    pel_mesh_report *after = NULL;
    cli_intersections *cuts = calloc(1, sizeof *cuts);
    pel_status status = cuts != NULL ? PEL_OK : pel_fail_memory(error);
    if (status == PEL_OK)
        status = pel_mesh_fill_holes(mesh, longest, &filled, NULL, error);
    if (status == PEL_OK)
        status = pel_mesh_check(filled, &after, error);
    if (status == PEL_OK && after->closed && after->error_count == 0) {
        status = cli_find_intersections(filled, after, cuts, error);
        if (status == PEL_OK && cuts->looked && cuts->count == 0)
            found->fill = longest;
    }
    pel_mesh_report_destroy(after);
    pel_mesh_destroy(filled);
    free(cuts);
    return status;
}

static pel_status find_all(const pel_mesh *mesh, bool with_intersections, findings *found, pel_error *error)
{
    *found = (findings){0};
    pel_status status = pel_mesh_check(mesh, &found->report, error);
    if (status == PEL_OK)
        status = cli_find_cracks(mesh, found->report, &found->cracks, error);
    /* across a crack neighbours count as strangers that touch */
    if (status == PEL_OK && with_intersections && found->cracks.count == 0)
        status = cli_find_intersections(mesh, found->report, &found->intersections, error);
    if (status == PEL_OK && found->cracks.count == 0)
        cli_find_parts(found->report, &found->parts);
    if (status == PEL_OK)
        status = try_fill(mesh, found, error);
    return status;
}

static void print_findings(const char *path, const pel_mesh *mesh, const findings *found)
{
    print_issues(path, mesh, found);
    cli_print_cracks(path, &found->cracks);
    cli_print_parts(path, mesh, &found->parts);
    cli_print_intersections(path, mesh, &found->intersections, SHOWN_MAX);
}

/* the two vertices of each edge */
static void write_edges(pel_json *json, const pel_issue *issue)
{
    pel_json_open(json, "vertices", '[');
    for (int32_t i = 0; i < issue->listed_count; ++i)
        pel_json_numbers(json, NULL, (double[]){issue->related[i][0], issue->related[i][1]}, 2);
    pel_json_close(json, ']');
}

static void write_issue(pel_json *json, const pel_issue_info *info, const pel_issue *issue)
{
    cli_open_issue(json, info, issue->count);
    pel_json_text(json, "element_kind", info->element_kind);
    bool by_component = strcmp(info->element_kind, "component") == 0;
    pel_json_open(json, "elements", '[');
    for (int32_t i = 0; i < issue->listed_count; ++i)
        pel_json_integer(json, NULL, by_component ? issue->related[i][0] : issue->elements[i]);
    pel_json_close(json, ']');
    if (strcmp(info->element_kind, "edge") == 0)
        write_edges(json, issue);
    pel_json_close(json, '}');
}

static void write_issues(pel_json *json, const findings *found)
{
    const pel_mesh_report *report = found->report;
    int64_t warning_count = count_warnings(found);
    pel_json_bool(json, "ok", report->error_count == 0 && warning_count == 0);
    pel_json_integer(json, "error_count", report->error_count);
    pel_json_integer(json, "warning_count", warning_count);
    if (found->intersections.looked)
        pel_json_integer(json, "self_intersections", found->intersections.count);
    else
        pel_json_text(json, "self_intersections", NULL);
    pel_json_open(json, "issues", '[');
    for (int kind = 0; kind < PEL_ISSUE_COUNT; ++kind) {
        if (report->issues[kind].count > 0)
            write_issue(json, pel_issue_info_of((pel_issue_kind)kind), &report->issues[kind]);
    }
    cli_write_cracks(json, &found->cracks);
    cli_write_parts(json, &found->parts);
    cli_write_intersections(json, &found->intersections);
    pel_json_close(json, ']');
}

static void print_verdict(const char *path, const findings *found)
{
    const pel_mesh_report *report = found->report;
    int64_t warning_count = count_warnings(found);
    printf("%s: %d vertices, %d triangles: ", path, (int)report->vertex_count, (int)report->triangle_count);
    if (report->error_count + warning_count == 0)
        printf("fine, %s\n", report->closed ? "closed" : "open");
    else
        printf("%lld %s, %lld %s\n", (long long)report->error_count, report->error_count == 1 ? "error" : "errors",
               (long long)warning_count, warning_count == 1 ? "warning" : "warnings");
}

/* summary of a repair: JSON key and text */
typedef struct deed {
    const char *key, *text;
    int32_t count;
} deed;

static void tell_repair(pel_json *json, const char *out, const pel_repair_summary *summary)
{
    const deed deeds[] = {
        {"bad_triangles", "triangles with bad indices or coordinates dropped", summary->bad_triangles},
        {"degenerate_triangles", "triangles without area dropped", summary->degenerate_triangles},
        {"duplicate_triangles", "duplicate triangles dropped", summary->duplicate_triangles},
        {"welded_vertices", "vertices welded into others", summary->welded_vertices},
        {"dropped_parts", "parts dropped", summary->dropped_parts},
        {"isolated_vertices", "isolated vertices dropped", summary->isolated_vertices},
        {"closed_slits", "triangles without area merged into their neighbours", summary->closed_slits},
        {"cut_vertices", "vertices copied to cut pieces apart", summary->cut_vertices},
        {"turned_triangles", "triangles turned around", summary->turned_triangles},
        {"outward_components", "components turned outward", summary->outward_components},
    };
    if (json != NULL)
        pel_json_open(json, "repair", '{');
    for (size_t i = 0; i < sizeof deeds / sizeof *deeds; ++i) {
        if (json != NULL)
            pel_json_integer(json, deeds[i].key, deeds[i].count);
        else if (deeds[i].count > 0)
            printf("%s: %s: %d\n", out, deeds[i].text, (int)deeds[i].count);
    }
    if (json != NULL)
        pel_json_close(json, '}');
    else if (!summary->changed)
        printf("%s: nothing to repair\n", out);
}

static void tell_fill(pel_json *json, const char *out, const pel_fill_summary *summary)
{
    if (json != NULL) {
        pel_json_open(json, "fill", '{');
        pel_json_integer(json, "filled_holes", summary->filled_holes);
        pel_json_integer(json, "left_holes", summary->left_holes);
        pel_json_integer(json, "triangles", summary->triangles);
        pel_json_number(json, "quality_min", summary->quality_min);
        pel_json_close(json, '}');
        return;
    }
    if (summary->filled_holes > 0)
        printf("%s: holes closed: %d, with %d triangles of quality %.2g at worst\n", out, (int)summary->filled_holes,
               (int)summary->triangles, summary->quality_min);
    if (summary->left_holes > 0)
        printf("%s: holes left open: %d\n", out, (int)summary->left_holes);
}

/* replaces a repaired mesh by one without holes, turned outward */
static pel_status fill_holes(const cli_call *call, pel_mesh **mesh, pel_json *json, pel_error *error)
{
    pel_mesh *filled = NULL, *turned = NULL;
    pel_fill_summary summary;
    pel_status status = pel_mesh_fill_holes(*mesh, cli_count(call, "fill-holes"), &filled, &summary, error);
    /* split vertices are not welded again */
    pel_repair_options options = pel_repair_options_default();
    options.weld = options.cut = false;
    if (status == PEL_OK)
        status = pel_mesh_repair(filled, &options, &turned, NULL, error);
    pel_mesh_destroy(filled);
    if (status != PEL_OK)
        return status;
    tell_fill(json, cli_value(call, "fix"), &summary);
    pel_mesh_destroy(*mesh);
    *mesh = turned;
    return PEL_OK;
}

/* writes the repaired mesh unless it still has errors */
static int write_repaired(const cli_call *call, pel_mesh_format format, const pel_mesh *mesh,
                          const pel_repair_summary *summary, pel_json *json)
{
    const char *out = cli_value(call, "fix");
    pel_error error;
    findings found;
    if (find_all(mesh, !cli_has(call, "no-intersections"), &found, &error) != PEL_OK) {
        pel_mesh_report_destroy(found.report);
        return cli_report(&error);
    }
    bool good = found.report->error_count == 0;
    /* welding has left those only that cutting made */
    if (summary->cut_vertices > 0)
        found.report->issues[PEL_ISSUE_DUPLICATE_VERTEX].count = 0;
    print_findings(out, mesh, &found);
    if (!good)
        cli_complain("'%s' is not written: the repaired mesh still cannot be simulated. edit the elements named above",
                     out);
    pel_mesh_report_destroy(found.report);
    int status = good ? cli_write_mesh(out, format, mesh, &cli_notes, json != NULL) : CLI_BAD_INPUT;
    if (json != NULL)
        pel_json_text(json, "written", status == CLI_DONE ? out : NULL);
    return status;
}

static int fix_mesh(const cli_call *call, pel_mesh_format format, const pel_mesh *mesh, pel_json *json)
{
    const char *out = cli_value(call, "fix");
    pel_repair_options options = pel_repair_options_default();
    if (cli_has(call, "tolerance"))
        options.weld_tolerance = cli_number(call, "tolerance");
    if (cli_has(call, "drop-parts"))
        options.drop_parts = cli_count(call, "drop-parts");
    pel_mesh *repaired = NULL;
    pel_repair_summary summary;
    pel_error error;
    if (pel_mesh_repair(mesh, &options, &repaired, &summary, &error) != PEL_OK)
        return cli_report(&error);
    tell_repair(json, out, &summary);
    int status = CLI_DONE;
    if (cli_has(call, "fill-holes") && fill_holes(call, &repaired, json, &error) != PEL_OK) {
        cli_name_file(&error, call->arguments[0]);
        status = cli_report(&error);
    }
    if (status == CLI_DONE)
        status = write_repaired(call, format, repaired, &summary, json);
    pel_mesh_destroy(repaired);
    return status;
}

static int check_mesh(const cli_call *call, const char *path, pel_mesh_format format, pel_json *json)
{
    int status;
    pel_mesh *mesh = cli_read_mesh(path, &cli_notes, json, &status);
    if (mesh == NULL)
        return status;
    findings found;
    pel_error error;
    bool fix = cli_has(call, "fix");
    if (find_all(mesh, !cli_has(call, "no-intersections"), &found, &error) != PEL_OK) {
        status = cli_report(&error);
    } else {
        /* with --fix it is the rest after the repair that matters */
        if (!fix)
            print_findings(path, mesh, &found);
        if (json != NULL)
            write_issues(json, &found);
        else
            print_verdict(path, &found);
        int64_t count = found.report->error_count + count_warnings(&found);
        status = count == 0 ? CLI_DONE : CLI_BAD_INPUT;
        if (fix)
            status = fix_mesh(call, format, mesh, json);
    }
    pel_mesh_report_destroy(found.report);
    pel_mesh_destroy(mesh);
    return status;
}

/* prints the defects of the meshes of the scene's bodies; false if one cannot be simulated */
static bool check_bodies(const cli_call *call, const pel_scene *scene, pel_json *json)
{
    bool good = true;
    for (int32_t i = 0; i < scene->model.body_count; ++i) {
        const pel_body_def *body = &scene->model.bodies[i];
        char place[PEL_NAME_SIZE + 300];
        snprintf(place, sizeof place, "%.256s: body %s", call->arguments[0], body->name);
        findings found;
        pel_error error;
        if (find_all(body->mesh, !cli_has(call, "no-intersections"), &found, &error) != PEL_OK) {
            pel_mesh_report_destroy(found.report);
            cli_report_to(&error, json);
            return false;
        }
        print_findings(place, body->mesh, &found);
        good = good && found.report->error_count == 0;
        pel_mesh_report_destroy(found.report);
    }
    if (!good && json != NULL)
        pel_json_bool(json, "ok", false);
    return good;
}

/* makes model and simulation, so that everything is found that a run would refuse, and tells magnitudes */
static pel_status try_scene(const pel_scene *scene, const char *path, pel_json *json, pel_error *error)
{
    pel_model *model = NULL;
    pel_sim *sim = NULL;
    pel_status status = pel_model_create(&scene->model, &model, error);
    if (status == PEL_OK) {
        pel_sim_def def = scene->sim;
        def.model = model;
        status = pel_sim_create(&def, &sim, error);
    }
    if (status == PEL_OK) {
        int bodies = (int)scene->model.body_count;
        if (json != NULL)
            pel_json_bool(json, "ok", true);
        else
            printf("%s: fine, %d %s, %g s\n", path, bodies, bodies == 1 ? "body" : "bodies", scene->duration);
        cli_tell_magnitudes(scene, sim, json);
    }
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    return status;
}

static int check_scene(const cli_call *call, pel_json *json)
{
    const char *path = call->arguments[0];
    pel_scene *scene = NULL;
    pel_error error;
    if (pel_scene_load(path, NULL, 0, &cli_notes, &scene, &error) != PEL_OK)
        return cli_report_to(&error, json);
    int status = CLI_BAD_INPUT;
    if (check_bodies(call, scene, json)) {
        status = CLI_DONE;
        if (try_scene(scene, path, json, &error) != PEL_OK) {
            pel_scene_locate(scene, &error);
            status = cli_report_to(&error, json);
        }
    }
    pel_scene_destroy(scene);
    return status;
}

/* format: of --fix */
static int check_file(const cli_call *call, bool is_scene, pel_mesh_format format, pel_json *json)
{
    const char *path = call->arguments[0];
    return is_scene ? check_scene(call, json) : check_mesh(call, path, format, json);
}

int cli_check(const cli_call *call)
{
    const char *path = call->arguments[0], *out = cli_value(call, "fix");
    bool is_scene = cli_is_scene(path);
    pel_mesh_format format = PEL_FORMAT_AUTO;
    if (is_scene && out != NULL)
        return cli_complain("--fix repairs meshes, '%s' is a scene. edit it as 'pellicle check' says", path);
    const char *const about_output[] = {"tolerance", "drop-parts", "fill-holes", "format"};
    for (size_t i = 0; out == NULL && i < sizeof about_output / sizeof *about_output; ++i)
        if (cli_has(call, about_output[i]))
            return cli_complain("option '--%s' is about the mesh that is written. add '--fix OUT.ply'",
                                about_output[i]);
    if (cli_has(call, "fill-holes") && cli_count(call, "fill-holes") < 3)
        return cli_complain("option '--fill-holes' is %d, but a hole has 3 edges at least. write how many the largest "
                            "hole may have, such as --fill-holes 100",
                            (int)cli_count(call, "fill-holes"));
    if (out != NULL && !cli_output_format(call, out, &format))
        return CLI_BAD_INPUT;
    if (!cli_has(call, "json"))
        return check_file(call, is_scene, format, NULL);
    pel_json json = {.file = stdout, .style = PEL_JSON_INDENTED};
    pel_json_open(&json, NULL, '{');
    pel_json_text(&json, "file", path);
    pel_json_text(&json, "kind", is_scene ? "scene" : "mesh");
    int status = check_file(call, is_scene, format, &json);
    pel_json_close(&json, '}');
    return status;
}
