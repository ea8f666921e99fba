#include "scene/build.h"

#include "base/memory.h"
#include "keys/table.h"
#include "scene/mesh.h"
#include "scene/region.h"

#include <string.h>

/* `below` of a map may be left to half of `above`, and has to be less */
static pel_status check_thresholds(const pel_scene_part *source, const pel_scene_value *map, double above,
                                   double *below)
{
    const pel_scene_value *low = map != NULL ? pel_scene_value_entry(map, "below") : NULL;
    if (low == NULL)
        return PEL_OK;
    if (low->form == PEL_FORM_WORD)
        *below = above / 2;
    if (*below < above)
        return PEL_OK;
    pel_scene_fail(source->reader, &low->place, "below (%g) is not less than above (%g)", *below, above);
    pel_fail_remedy(source->reader->error, "use a smaller value, or omit it (default: half of above)");
    return PEL_BAD_SCENE;
}

/* something says where, and not twice */
static pel_status check_refine(const pel_scene_part *source, const pel_scene_value *value, bool everywhere)
{
    static const char *const keys[] = {"above", "curvature", "near_tools", "region"};
    const pel_scene_value *found = NULL;
    for (size_t i = 0; found == NULL && i < sizeof keys / sizeof keys[0]; i++)
        found = pel_scene_value_entry(value, keys[i]);
    if ((found != NULL) != everywhere)
        return PEL_OK;
    if (everywhere) {
        pel_scene_fail(source->reader, &found->key_place, "'everywhere' and '%s' exclude each other", found->key);
        pel_fail_remedy(source->reader->error, "remove one of them");
    } else {
        pel_scene_fail(source->reader, &value->place, "refine has no criterion");
        pel_fail_remedy(source->reader->error,
                        "add 'above', 'curvature', 'near_tools' or 'region', or 'everywhere: true'");
    }
    return PEL_BAD_SCENE;
}

/* regions and what depends on other members */
static pel_status finish_refine(const pel_scene_part *source, pel_refine_def *refine)
{
    const pel_scene_value *value = pel_scene_value_entry(source->value, "refine");
    /* a word: the mesh itself becomes finer (fine_spots.c) */
    if (value == NULL || value->form == PEL_FORM_WORD)
        return PEL_OK;
    const pel_scene_value *region = pel_scene_value_entry(value, "region");
    pel_status status = check_refine(source, value, refine->everywhere);
    if (status == PEL_OK)
        status = check_thresholds(source, value, refine->above, &refine->below);
    if (status == PEL_OK)
        status = check_thresholds(source, pel_scene_value_entry(value, "curvature"), refine->curvature_above,
                                  &refine->curvature_below);
    if (status != PEL_OK || region == NULL)
        return status;
    if (refine->region_levels <= refine->levels)
        return pel_scene_read_vertices(source, region, &refine->region, &refine->region_count);
    pel_scene_fail(source->reader, &pel_scene_value_entry(value, "region_levels")->place,
                   "region_levels is %d, the body has %d levels", (int)refine->region_levels, (int)refine->levels);
    pel_fail_remedy(source->reader->error, "raise levels, or give at most %d", (int)refine->levels);
    return PEL_BAD_SCENE;
}

static pel_status read_body(const pel_scene_part *source, pel_body_def *body)
{
    *body = pel_body_def_default();
    body->mesh = source->mesh;
    /* springs that are not given have no stiffness */
    body->spring_stiffness = body->spring_damping = (pel_quantity){0};
    body->volumetric_stiffness = body->volumetric_damping = (pel_quantity){0};
    pel_status status = pel_scene_read_members(source, PEL_DEF_BODY, body);
    if (status == PEL_OK)
        status = finish_refine(source, &body->refine);
    if (status == PEL_OK)
        status = pel_scene_build_tissue(source, body);
    if (status == PEL_OK)
        status = pel_scene_build_shell(source, &body->shell);
    if (status != PEL_OK)
        return status;
    /* a support that moves is a tool (build_sim.c) */
    if (pel_scene_value_entry(source->value, "support") != NULL)
        return PEL_OK;
    return pel_scene_read_vertices(source, pel_scene_value_entry(source->value, "pinned"), &body->pinned,
                                   &body->pinned_count);
}

/* where a body has a shape at rest, nothing may change its mesh */
static pel_status check_rest(pel_scene_reader *reader, const pel_scene_value *root, const pel_scene_value *value,
                             int32_t body, const pel_sim_def *opened)
{
    const pel_scene_value *rest = pel_scene_value_entry(value, "rest");
    static const char *const others[] = {"refine", "volume", "rigid", "follow"};
    const char *found = pel_scene_value_entry(root, "imperfection") != NULL ? "imperfection" : NULL;
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (pel_scene_value_entry(value, others[i]) != NULL)
            found = others[i];
    for (int32_t c = 0; c < opened->cut_count; c++)
        if (opened->cuts[c].body == body)
            found = "cuts";
    for (int32_t s = 0; s < opened->seam_count; s++)
        if (opened->seams[s].body == body)
            found = "seams";
    if (found == NULL)
        return PEL_OK;
    pel_scene_fail(reader, &rest->key_place, "'rest' and '%s' exclude each other", found);
    pel_fail_remedy(reader->error, "remove one of them");
    return PEL_BAD_SCENE;
}

/* the shape of a body at rest has the triangles of its mesh */
static pel_status compare_rest(pel_scene_reader *reader, const pel_scene_value *value, const pel_mesh *mesh,
                               const pel_mesh *rest)
{
    int32_t t = 0;
    const bool same_size = mesh->vertex_count == rest->vertex_count && mesh->triangle_count == rest->triangle_count;
    while (same_size && t < mesh->triangle_count &&
           memcmp(mesh->triangles[t], rest->triangles[t], sizeof *mesh->triangles) == 0)
        t++;
    if (same_size && t == mesh->triangle_count)
        return PEL_OK;
    if (same_size)
        pel_scene_fail(reader, &value->place, "triangle %d of the shape at rest has other vertices than in the mesh",
                       (int)t);
    else
        pel_scene_fail(
            reader, &value->place, "the shape at rest has %d vertices and %d triangles, the mesh has %d and %d",
            (int)rest->vertex_count, (int)rest->triangle_count, (int)mesh->vertex_count, (int)mesh->triangle_count);
    pel_fail_remedy(reader->error,
                    "move the vertices of one mesh only, and write both with their vertices in one order "
                    "(`weld: false` keeps those of files)");
    return PEL_BAD_SCENE;
}

/* the shapes at rest, after all meshes of bodies */
static pel_status read_rests(pel_scene_reader *reader, const pel_scene_value *root, const char *folder,
                             pel_body_def *bodies, pel_mesh **meshes, int32_t *mesh_count, const pel_sim_def *opened)
{
    pel_status status = PEL_OK;
    int32_t body = 0;
    for (const pel_scene_value *value = pel_scene_value_entry(root, "bodies")->first; status == PEL_OK && value != NULL;
         value = value->next, body++) {
        pel_scene_value *rest = pel_scene_value_entry(value, "rest");
        if (rest == NULL)
            continue;
        status = check_rest(reader, root, value, body, opened);
        if (status == PEL_OK)
            status = pel_scene_mesh(reader, rest, folder, &meshes[*mesh_count]);
        if (status != PEL_OK)
            break;
        bodies[body].rest = meshes[(*mesh_count)++];
        status = compare_rest(reader, rest, bodies[body].mesh, bodies[body].rest);
    }
    return status;
}

/* bytes of a triangle in the smallest scene: springs alone, explicit, without contact (measured: 290) */
#define LEAST_BYTES 250.0

/* before minutes pass until the memory is used up, and the system ends the program without a word */
static pel_status check_memory(pel_scene_reader *reader, const pel_scene_value *body, double triangle_count)
{
    const double needed = LEAST_BYTES * triangle_count, most = pel_memory_limit();
    if (needed <= most)
        return PEL_OK;
    pel_fail(
        reader->error, PEL_OUT_OF_MEMORY,
        "out of memory: with this body the scene has %.3g million triangles, which need at least %.3g GB of %.3g GB",
        1e-6 * triangle_count, 1e-9 * needed, 1e-9 * most);
    pel_fail_remedy(reader->error, "use a coarser mesh: %.3g million triangles are the most, fewer with contact",
                    1e-6 * most / LEAST_BYTES);
    return pel_scene_fail_at(reader, &body->place);
}

pel_status pel_scene_build_bodies(pel_scene_reader *reader, const pel_scene_value *root, const char *folder,
                                  pel_scene *scene, pel_mesh **meshes, int32_t *mesh_count, pel_sim_def *opened)
{
    const pel_scene_value *list = pel_scene_value_entry(root, "bodies");
    pel_body_def *bodies = pel_arena_take(reader->arena, (size_t)pel_scene_value_count(list), sizeof *bodies);
    if (bodies == NULL)
        return pel_fail_memory(reader->error);
    pel_status status = pel_scene_check_names(reader, list);
    int32_t count = 0;
    double triangle_count = 0;
    for (const pel_scene_value *value = list->first; status == PEL_OK && value != NULL; value = value->next) {
        status = pel_scene_mesh(reader, pel_scene_value_entry(value, "mesh"), folder, &meshes[count]);
        if (status != PEL_OK)
            break;
        *mesh_count = count + 1;
        triangle_count += meshes[count]->triangle_count;
        status = check_memory(reader, value, triangle_count);
        if (status != PEL_OK)
            break;
        status = pel_scene_fill_mesh(reader, value, &meshes[count]);
        if (status == PEL_OK)
            status = pel_scene_refine_torn(reader, root, value, &meshes[count]);
        if (status == PEL_OK)
            status = pel_scene_build_follow(reader, value, folder, count, meshes[count]);
        if (status != PEL_OK)
            break;
        pel_scene_part source = {reader, value, meshes[count]};
        const pel_scene_owner of = {pel_scene_value_entry(value, "name")->text, count, pel_scene_value_count(list),
                                    meshes[count]};
        status = pel_scene_build_cuts(reader, root, &of, opened);
        if (status == PEL_OK)
            status = read_body(&source, &bodies[count++]);
    }
    if (status == PEL_OK)
        status = read_rests(reader, root, folder, bodies, meshes, mesh_count, opened);
    scene->model = pel_model_def_default();
    scene->model.bodies = bodies;
    scene->model.body_count = count;
    const pel_scene_part whole = {reader, root, NULL};
    return status == PEL_OK ? pel_scene_read_members(&whole, PEL_DEF_MODEL, &scene->model) : status;
}
