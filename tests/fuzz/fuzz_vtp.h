/* Shared by the fuzz target of .vtp files and the replay of its corpus. */
#ifndef PEL_TESTS_FUZZ_VTP_H
#define PEL_TESTS_FUZZ_VTP_H

#include "fuzz_mesh.h"

#include "pellicle/results.h"

/* parses bytes; the result must be a valid mesh or an error with a text, a remedy and a place */
static inline void fuzz_parse_vtp(const uint8_t *data, size_t size)
{
    pel_mesh *mesh;
    pel_error error;
    double time;
    pel_status status = pel_vtp_parse("fuzz.vtp", data, size, &mesh, &time, &error);
    if (status != PEL_OK) {
        fuzz_require(status == PEL_BAD_FORMAT && mesh == NULL && error.status == status);
        fuzz_require(error.what[0] != '\0' && error.remedy[0] != '\0' && strcmp(error.file, "fuzz.vtp") == 0);
        return;
    }
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        for (int i = 0; i < 3; i++)
            fuzz_require(isfinite(mesh->positions[v][i]));
    for (int32_t t = 0; t < mesh->triangle_count; t++)
        for (int i = 0; i < 3; i++)
            fuzz_require(mesh->triangles[t][i] >= 0 && mesh->triangles[t][i] < mesh->vertex_count);
    for (int32_t f = 0; f < mesh->field_count; f++)
        fuzz_require(pel_mesh_field(mesh, mesh->fields[f].name) == &mesh->fields[f]);
    pel_mesh_destroy(mesh);
}

#endif
