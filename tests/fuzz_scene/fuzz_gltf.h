/* Shared by the fuzz target of glTF and the replay of its corpus. */
#ifndef PEL_TESTS_FUZZ_GLTF_H
#define PEL_TESTS_FUZZ_GLTF_H

#include "../fuzz/fuzz_mesh.h"
#include "foreign/gltf.h"

/* the same bytes as an animation: of at least one frame, or refused */
static inline void fuzz_parse_gltf_sequence(const uint8_t *data, size_t size, int32_t vertex_count)
{
    pel_sequence *sequence;
    pel_error error;
    pel_status status = pel_gltf_parse_sequence("fuzz.gltf", data, size, "0", 0.1, &sequence, &error);
    if (status != PEL_OK) {
        fuzz_require(sequence == NULL && error.status == status && error.what[0] != '\0' && error.remedy[0] != '\0');
        return;
    }
    fuzz_require(pel_sequence_frame_count(sequence) >= 1 && pel_sequence_vertex_count(sequence) == vertex_count);
    pel_sequence_destroy(sequence);
}

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
    const int32_t vertex_count = mesh->vertex_count;
    pel_mesh_destroy(mesh);
    fuzz_parse_gltf_sequence(data, size, vertex_count);
}

#endif
