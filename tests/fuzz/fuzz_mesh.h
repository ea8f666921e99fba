/* Shared by the fuzz targets and the replay of their corpora: parse, and check the result. */
#ifndef PEL_TESTS_FUZZ_MESH_H
#define PEL_TESTS_FUZZ_MESH_H

#include "pellicle/mesh_io.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static inline void fuzz_require(bool holds)
{
    if (!holds)
        abort();
}

static inline void fuzz_check_mesh(const pel_mesh *mesh, size_t size)
{
    fuzz_require(mesh->vertex_count > 0 && mesh->triangle_count > 0);
    /* no format spends less than a byte on a vertex or triangle */
    fuzz_require((size_t)mesh->vertex_count <= size && (size_t)mesh->triangle_count <= size);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        for (int i = 0; i < 3; i++)
            fuzz_require(isfinite(mesh->positions[v][i]));
    for (int32_t t = 0; t < mesh->triangle_count; t++)
        for (int i = 0; i < 3; i++)
            fuzz_require(mesh->triangles[t][i] >= 0 && mesh->triangles[t][i] < mesh->vertex_count);
    for (int32_t f = 0; f < mesh->field_count; f++) {
        const pel_field *field = &mesh->fields[f];
        fuzz_require(field->name[0] != '\0' && field->component_count > 0 &&
                     pel_mesh_field(mesh, field->name) == field);
        for (int64_t i = 0; i < (int64_t)mesh->vertex_count * field->component_count; i++)
            fuzz_require(isfinite(field->values[i]));
    }
}

/* parses bytes as that format; a failure must have a text, a remedy and a place */
static inline void fuzz_parse(const char *name, const uint8_t *data, size_t size, pel_mesh_format format)
{
    pel_mesh *mesh;
    pel_error error;
    char text[700];
    pel_status status = pel_mesh_parse(name, data, size, format, NULL, &mesh, &error);
    if (status == PEL_OK) {
        fuzz_check_mesh(mesh, size);
        pel_mesh_destroy(mesh);
        return;
    }
    fuzz_require(status == PEL_BAD_FORMAT && mesh == NULL);
    fuzz_require(error.what[0] != '\0' && error.remedy[0] != '\0' && strcmp(error.file, name) == 0);
    fuzz_require(strlen(pel_error_text(&error, text, sizeof text)) > 0);
}

#endif
