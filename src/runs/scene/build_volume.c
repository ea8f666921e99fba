#include "scene/build.h"

#include "keys/table.h"

/* the mass of a solid is its density times its volume */
static pel_status check_mass(pel_scene_reader *reader, const pel_scene_value *body)
{
    const pel_scene_value *thickness = pel_scene_value_at(body, "mass.thickness");
    if (thickness == NULL || thickness->is_implied || thickness->form == PEL_FORM_WORD)
        return PEL_OK;
    pel_scene_fail(reader, &thickness->key_place, "the body has a `volume`: its mass is the density times its volume");
    pel_fail_remedy(reader->error, "omit mass.thickness, or give mass.total");
    return PEL_BAD_SCENE;
}

/* a cavity would be drawn together by it, against what is meant */
static pel_status check_pressure(pel_scene_reader *reader, const pel_scene_value *body)
{
    const pel_scene_value *inside = pel_scene_value_at(body, "pressure.inside");
    if (inside == NULL || inside->is_implied)
        return PEL_OK;
    pel_scene_fail(reader, &inside->key_place, "the body has a `volume`: what is inside of its surface is solid");
    pel_fail_remedy(reader->error,
                    "use pressure.outside, which presses on the surface; for a pressure in a cavity with "
                    "a `region` at the wall of the cavity");
    return PEL_BAD_SCENE;
}

pel_status pel_scene_fill_mesh(pel_scene_reader *reader, const pel_scene_value *body, pel_mesh **mesh)
{
    const pel_scene_value *volume = pel_scene_value_entry(body, "volume");
    if (volume == NULL && (*mesh)->tetrahedron_count > 0) {
        pel_scene_fail(reader, &pel_scene_value_at(body, "mesh.file")->place,
                       "the file has tetrahedra, but the body has no volume");
        pel_fail_remedy(reader->error, "give the body `volume: { young: ... }`, or a file of its surface");
        return PEL_BAD_SCENE;
    }
    pel_status status = volume != NULL ? check_pressure(reader, body) : PEL_OK;
    if (status != PEL_OK)
        return status;
    if (volume == NULL || volume->kind != PEL_SCENE_MAP || (*mesh)->tetrahedron_count > 0)
        return PEL_OK;
    status = check_mass(reader, body);
    if (status != PEL_OK)
        return status;
    const pel_scene_value *edge = pel_scene_value_entry(volume, "edge");
    const double length = edge == NULL || edge->form == PEL_FORM_WORD ? 0 : pel_scene_value_number(volume, "edge");
    pel_mesh *filled = NULL;
    if (pel_mesh_fill(*mesh, length, &filled, reader->error) != PEL_OK)
        return pel_scene_fail_at(reader, edge != NULL ? &edge->place : &volume->key_place);
    pel_log_line(reader->log, "body '%s' is filled with %d tetrahedra; its surface has %d triangles in place of %d",
                 pel_scene_value_entry(body, "name")->text, (int)filled->tetrahedron_count, (int)filled->triangle_count,
                 (int)(*mesh)->triangle_count);
    pel_mesh_destroy(*mesh);
    *mesh = filled;
    return PEL_OK;
}
