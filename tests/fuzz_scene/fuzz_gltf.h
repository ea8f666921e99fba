/* Shared by the fuzz target of glTF and the replay of its corpus. */
#ifndef PEL_TESTS_FUZZ_GLTF_H
#define PEL_TESTS_FUZZ_GLTF_H

#include "../fuzz/fuzz_mesh.h"
#include "foreign/gltf.h"

/* parses bytes; the result must be a valid mesh or an error with a text, a remedy and a place */
static inline void fuzz_parse_gltf(const uint8_t *data, size_t size)
{
    pel_mesh *mesh;
    pel_error error;
    pel_status status = pel_gltf_parse("fuzz.gltf", data, size, NULL, &mesh, &error);
    if (status != PEL_OK) {
        fuzz_require(status == PEL_BAD_FORMAT && mesh == NULL && error.status == status);
        fuzz_require(error.what[0] != '\0' && error.remedy[0] != '\0' && strcmp(error.file, "fuzz.gltf") == 0);
        return;
    }
    /* instances make many of few, but not without end */
    fuzz_check_mesh(mesh, 1000000 + 64 * size);
    pel_mesh_destroy(mesh);
}

#endif
