#include "pellicle/import.h"

#include "base/status.h"
#include "foreign/child.h"
#include "foreign/gltf.h"
#include "foreign/usd.h"
#include "pellicle/mesh_io.h"
#include "pellicle/volume.h"

pel_status pel_mesh_import(const char *path, const pel_log *log, pel_mesh **mesh, pel_error *error)
{
    PEL_REFUSE_NULL(path, error);
    PEL_REFUSE_NULL(mesh, error);
    *mesh = NULL;
    if (pel_mesh_is_filled_file(path))
        return pel_mesh_read_filled(path, log, mesh, error);
    if (pel_gltf_is(path))
        return pel_gltf_read(path, log, mesh, error);
    if (pel_usd_is_path(path))
        return pel_usd_read(path, log, mesh, error);
#ifdef PELLICLE_ASSIMP
    if (pel_foreign_is(path))
        return pel_foreign_read(path, PEL_CHILD_WAIT_SECONDS, log, mesh, error);
#endif
    return pel_mesh_read(path, PEL_FORMAT_AUTO, log, mesh, error);
}
