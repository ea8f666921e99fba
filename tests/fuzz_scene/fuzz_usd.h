/* Shared by the fuzz target of USD and the replay of its corpus. */
#ifndef PEL_TESTS_FUZZ_USD_H
#define PEL_TESTS_FUZZ_USD_H

#include "../fuzz/fuzz_mesh.h"
#include "foreign/usd.h"

/* the same bytes as a sequence: of at least one frame, or refused */
static inline void fuzz_parse_usd_sequence(const uint8_t *data, size_t size, int32_t vertex_count)
{
    pel_sequence *sequence;
    pel_error error;
    pel_status status = pel_usd_parse_sequence("fuzz.usda", data, size, &sequence, &error);
    if (status != PEL_OK) {
        fuzz_require(sequence == NULL && error.status == status && error.what[0] != '\0' && error.remedy[0] != '\0');
        return;
    }
    fuzz_require(pel_sequence_frame_count(sequence) >= 1 && pel_sequence_vertex_count(sequence) == vertex_count);
    pel_sequence_destroy(sequence);
}

/* parses bytes; the result must be a valid mesh or an error with a text, a remedy and a place */
static inline void fuzz_parse_usd(const uint8_t *data, size_t size)
{
    pel_mesh *mesh;
    pel_error error;
    pel_status status = pel_usd_parse("fuzz.usda", data, size, NULL, &mesh, &error);
    if (status != PEL_OK) {
        fuzz_require(status == PEL_BAD_FORMAT && mesh == NULL && error.status == status);
        fuzz_require(error.what[0] != '\0' && error.remedy[0] != '\0' && strcmp(error.file, "fuzz.usda") == 0);
        return;
    }
    fuzz_check_mesh(mesh, size);
    const int32_t vertex_count = mesh->vertex_count;
    pel_mesh_destroy(mesh);
    fuzz_parse_usd_sequence(data, size, vertex_count);
}

#endif
