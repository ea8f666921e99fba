/* The tetrahedra of a filled body. */
#include "base/assert.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "model/quantity.h"
#include "model/shell.h"

#include <math.h>
#include <string.h>

static void load_tetra(const pel_mesh *mesh, int32_t t, double x[4][3])
{
    PEL_ASSERT_INDEX(t, mesh->tetrahedron_count);
    for (int k = 0; k < 4; k++)
        memcpy(x[k], mesh->positions[mesh->tetrahedra[t][k]], sizeof x[k]);
}

static pel_status check_material(const pel_body_def *def, int32_t body, pel_error *error)
{
    const pel_volume_def *volume = &def->volume;
    if (PEL_IS_NO_CHOICE((int)volume->element, PEL_VOLUME_ELEMENT_COUNT))
        return pel_body_refuse(error, body, "volume.element", (double)volume->element,
                               "give one of pel_volume_element");
    if (PEL_IS_NO_CHOICE((int)volume->kind, PEL_VOLUME_COUNT))
        return pel_body_refuse(error, body, "volume.kind", (double)volume->kind, "give one of pel_volume_kind");
    if (!(volume->poisson >= 0 && volume->poisson < 0.5))
        return pel_body_refuse(error, body, "volume.poisson", volume->poisson, "give a number from 0 to less than 0.5");
    if (!(volume->mooney_ratio >= 0 && isfinite(volume->mooney_ratio)))
        return pel_body_refuse(error, body, "volume.mooney_ratio", volume->mooney_ratio, "give a number of at least 0");
    pel_status status = pel_quantity_check(&volume->young, def->mesh->vertex_count, body,
                                           "Young's modulus of the volume", false, error);
    for (int32_t v = 0; status == PEL_OK && v < def->mesh->vertex_count; v++)
        if (!(pel_quantity_at(&volume->young, v) > 0))
            status = pel_body_refuse(error, body, "volume.young", pel_quantity_at(&volume->young, v),
                                     "give a number of pascals above 0");
    return status;
}

/* what is whole for surfaces only */
static pel_status check_company(const pel_body_def *def, int32_t body, pel_error *error)
{
    const struct {
        bool is_there;
        const char *what, *remedy;
    } others[] = {
        {def->refine.levels > 0, "refinement", "use `refine: auto`, or fill it with a smaller edge"},
        {def->origins != NULL, "cuts", "leave the cuts out, or the volume"},
        {def->volumetric_stiffness.field != NULL || def->volumetric_stiffness.value > 0, "volumetric springs",
         "leave `volumetric` out: the volume resists by itself"},
        {def->fluid_density > 0, "a liquid", "leave `fluid` out, or the volume"},
    };
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (others[i].is_there)
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", body, others[i].remedy,
                                      "a body with a volume cannot have %s", others[i].what);
    return PEL_OK;
}

pel_status pel_filled_check(const pel_body_def *def, int32_t body, pel_error *error)
{
    if (!def->volume.on)
        return PEL_OK;
    if (def->mesh->tetrahedron_count < 1)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", body, "fill it with pel_mesh_fill",
                                  "a body with a volume needs a mesh with tetrahedra");
    pel_status status = check_material(def, body, error);
    return status == PEL_OK ? check_company(def, body, error) : status;
}

pel_status pel_filled_lump(const pel_mesh *mesh, double *volumes, pel_error *error)
{
    memset(volumes, 0, (size_t)mesh->vertex_count * sizeof *volumes);
    for (int32_t t = 0; t < mesh->tetrahedron_count; t++) {
        double x[4][3];
        pel_rest_tetra rest;
        load_tetra(mesh, t, x);
        if (!pel_rest_tetra_setup((const double(*)[3])x, &rest))
            return pel_refuse_element(error, PEL_BAD_MESH, "tetrahedron", t,
                                      rest.volume < 0 ? "swap two of its vertices" : "move one of its vertices",
                                      rest.volume < 0 ? "tetrahedron is turned inside out"
                                                      : "tetrahedron has no volume");
        for (int k = 0; k < 4; k++)
            volumes[mesh->tetrahedra[t][k]] += rest.volume / 4;
    }
    return PEL_OK;
}

/* elements of smooth tetrahedra, with places for vertices */
static pel_status create_stars(const pel_body *body, pel_shell *shell, pel_error *error)
{
    const pel_mesh *mesh = body->mesh;
    double *young = pel_allocate((size_t)mesh->tetrahedron_count, sizeof *young);
    if (young == NULL)
        return pel_fail_memory(error);
    for (int32_t t = 0; t < mesh->tetrahedron_count; t++)
        young[t] = shell->tetra_youngs != NULL ? shell->tetra_youngs[t] : shell->tetra_young;
    pel_status status =
        pel_stars_create((const double(*)[3])mesh->positions, mesh->vertex_count, (const int32_t(*)[4])mesh->tetrahedra,
                         mesh->tetrahedron_count, young, &shell->stars, error);
    for (int32_t i = 0; status == PEL_OK && i < shell->stars->begin[shell->stars->count]; i++)
        shell->stars->nodes[i] = body->model_index[shell->stars->nodes[i]];
    pel_free(young);
    return status;
}

pel_status pel_filled_create(const pel_body_def *def, const pel_body *body, pel_shell *shell, pel_error *error)
{
    const pel_mesh *mesh = body->mesh;
    if (!def->volume.on)
        return PEL_OK;
    const size_t count = (size_t)mesh->tetrahedron_count;
    const bool varies = def->volume.young.field != NULL;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(shell->tetrahedra, count), PEL_ROOM_IF(varies, shell->tetra_youngs, count)))
        return pel_fail_memory(error);
    shell->tetrahedron_count = mesh->tetrahedron_count;
    shell->solid = pel_solid_law_of(def->volume.kind, def->volume.poisson, def->volume.mooney_ratio);
    shell->solid_poisson = def->volume.poisson;
    shell->tetra_young = def->volume.young.value;
    for (int32_t t = 0; t < mesh->tetrahedron_count; t++) {
        double sum = 0;
        for (int k = 0; k < 4; k++) {
            shell->tetrahedra[t][k] = body->model_index[mesh->tetrahedra[t][k]];
            sum += pel_quantity_at(&def->volume.young, mesh->tetrahedra[t][k]);
        }
        if (varies)
            shell->tetra_youngs[t] = sum / 4;
    }
    return def->volume.element == PEL_VOLUME_SMOOTH ? create_stars(body, shell, error) : PEL_OK;
}

void pel_filled_destroy(pel_shell *shell)
{
    PEL_FREE_ALL(shell->tetrahedra, shell->tetra_youngs);
    pel_stars_destroy(shell->stars);
}

double pel_filled_rest(const pel_shell *shell, const pel_record *positions, int32_t t, pel_rest_tetra *rest)
{
    PEL_ASSERT_INDEX(t, shell->tetrahedron_count);
    double x[4][3];
    pel_load_points(positions, shell->tetrahedra[t], 4, x);
    pel_rest_tetra_setup((const double(*)[3])x, rest);
    return (shell->tetra_youngs != NULL ? shell->tetra_youngs[t] : shell->tetra_young) * rest->volume;
}
