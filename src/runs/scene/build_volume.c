#include "scene/build.h"

#include "keys/table.h"

/* measured: a beam of 4 cells in its thickness is 5 % too stiff at 0.3, 7 % at 0.45 and 9 % at 0.49 (docs/volumes.md)
 */
#define LOCKING_POISSON 0.45

pel_status pel_scene_fill_mesh(pel_scene_reader *reader, const pel_scene_value *body, pel_mesh **mesh)
{
    const pel_scene_value *volume = pel_scene_value_entry(body, "volume");
    if (volume == NULL || volume->kind != PEL_SCENE_MAP || (*mesh)->tetrahedron_count > 0)
        return PEL_OK;
    const pel_scene_value *edge = pel_scene_value_entry(volume, "edge");
    const double length = edge == NULL || edge->form == PEL_FORM_WORD ? 0 : pel_scene_value_number(volume, "edge");
    pel_mesh *filled = NULL;
    if (pel_mesh_fill(*mesh, length, &filled, reader->error) != PEL_OK)
        return pel_scene_fail_at(reader, edge != NULL ? &edge->place : &volume->key_place);
    pel_log_line(reader->log, "body '%s' is filled with %d tetrahedra; its surface has %d triangles in place of %d",
                 pel_scene_value_entry(body, "name")->text, (int)filled->tetrahedron_count, (int)filled->triangle_count,
                 (int)(*mesh)->triangle_count);
    if (pel_scene_value_number(volume, "poisson") > LOCKING_POISSON)
        pel_log_line(reader->log,
                     "body '%s' has a Poisson's ratio above %g: linear tetrahedra lock there, and bend and shear too "
                     "stiffly. use a smaller one, or a smaller volume.edge",
                     pel_scene_value_entry(body, "name")->text, LOCKING_POISSON);
    pel_mesh_destroy(*mesh);
    *mesh = filled;
    return PEL_OK;
}
