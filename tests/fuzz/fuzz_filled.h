/* Shared by the fuzz targets of files with tetrahedra and the replay of their corpora. */
#ifndef PEL_TESTS_FUZZ_FILLED_H
#define PEL_TESTS_FUZZ_FILLED_H

#include "fuzz_mesh.h"

#include "pellicle/volume.h"

/* parses bytes; the result must be a filled mesh, or an error with a text, a remedy and a place */
static inline void fuzz_parse_filled(const char *name, const uint8_t *data, size_t size)
{
    pel_mesh *mesh;
    pel_error error;
    pel_status status = pel_mesh_parse_filled(name, data, size, NULL, &mesh, &error);
    if (status != PEL_OK) {
        fuzz_require(status == PEL_BAD_FORMAT && mesh == NULL && error.status == status);
        fuzz_require(error.what[0] != '\0' && error.remedy[0] != '\0' && strcmp(error.file, name) == 0);
        return;
    }
    fuzz_require(mesh->tetrahedron_count > 0 && mesh->triangle_count > 0 && mesh->vertex_count > 3);
    for (int32_t t = 0; t < mesh->tetrahedron_count; t++) {
        double x[4][3];
        for (int k = 0; k < 4; k++) {
            fuzz_require(mesh->tetrahedra[t][k] >= 0 && mesh->tetrahedra[t][k] < mesh->vertex_count);
            memcpy(x[k], mesh->positions[mesh->tetrahedra[t][k]], sizeof x[k]);
        }
        fuzz_require(pel_tetrahedron_volume((const double(*)[3])x) > 0);
    }
    pel_mesh_destroy(mesh);
}

#endif
