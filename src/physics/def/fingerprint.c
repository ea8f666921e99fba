#include "def/fingerprint.h"

#include "base/hash.h"
#include "sequence/sequence.h"

#include <stdio.h>
#include <string.h>

_Static_assert(sizeof(pel_key) == 2 * sizeof(double) && sizeof(pel_pose_key) == 11 * sizeof(double), "keys are plain");

/* what members of a body need */
typedef struct place {
    const pel_mesh *mesh; /* of the body; null = none */
    bool skips_meshes;
} place;

void pel_fingerprint_add_bytes(pel_fingerprint *fingerprint, pel_part part, const void *bytes, size_t size)
{
    uint64_t *sum = &fingerprint->parts[part];
    *sum = pel_hash_block(*sum, bytes, size);
}

static void add_mesh(pel_fingerprint *fingerprint, pel_part part, const pel_mesh *mesh)
{
    pel_fingerprint_add_bytes(fingerprint, part, mesh->positions, (size_t)mesh->vertex_count * sizeof *mesh->positions);
    pel_fingerprint_add_bytes(fingerprint, part, mesh->triangles,
                              (size_t)mesh->triangle_count * sizeof *mesh->triangles);
    if (mesh->tetrahedron_count > 0)
        pel_fingerprint_add_bytes(fingerprint, part, mesh->tetrahedra,
                                  (size_t)mesh->tetrahedron_count * sizeof *mesh->tetrahedra);
}

/* whether a pointer of a def is null */
static bool add_pointer(pel_fingerprint *fingerprint, pel_part part, const void *pointer)
{
    unsigned char is_there = pointer != NULL;
    pel_fingerprint_add_bytes(fingerprint, part, &is_there, sizeof is_there);
    return pointer != NULL;
}

static void add_list(pel_fingerprint *fingerprint, pel_part part, const void *list, int32_t count, size_t size)
{
    if (!add_pointer(fingerprint, part, list))
        return;
    pel_fingerprint_add_bytes(fingerprint, part, &count, sizeof count);
    pel_fingerprint_add_bytes(fingerprint, part, list, (size_t)count * size);
}

static void add_field(pel_fingerprint *fingerprint, pel_part part, const double *field, const pel_mesh *mesh)
{
    if (add_pointer(fingerprint, part, field))
        pel_fingerprint_add_bytes(fingerprint, part, field, (size_t)mesh->vertex_count * sizeof *field);
}

static void add_quantity(pel_fingerprint *fingerprint, pel_part part, const pel_quantity *quantity,
                         const pel_mesh *mesh)
{
    pel_fingerprint_add_bytes(fingerprint, part, &quantity->value, sizeof quantity->value);
    add_field(fingerprint, part, quantity->field, mesh);
    add_list(fingerprint, part, quantity->keys, quantity->key_count, sizeof *quantity->keys);
}

static void add_sequence(pel_fingerprint *fingerprint, pel_part part, const pel_sequence *sequence)
{
    if (add_pointer(fingerprint, part, sequence))
        pel_fingerprint_add_bytes(fingerprint, part, &sequence->fingerprint, sizeof sequence->fingerprint);
}

static void add_members(pel_fingerprint *fingerprint, pel_def_kind kind, const char *def, place outer);

static void add_defs(pel_fingerprint *fingerprint, const pel_def_row *row, const char *defs, int32_t count, place outer)
{
    if (!add_pointer(fingerprint, row->part, defs))
        return;
    pel_fingerprint_add_bytes(fingerprint, row->part, &count, sizeof count);
    for (int32_t i = 0; i < count; i++)
        add_members(fingerprint, row->element, defs + (size_t)i * row->size, outer);
}

/* the target of a pointer of a def */
static void add_behind(pel_fingerprint *fingerprint, const pel_def_row *row, const char *def, place at)
{
    const void *pointer;
    int32_t count = 0;
    memcpy(&pointer, def + row->offset, sizeof pointer);
    if (row->count_offset > 0)
        memcpy(&count, def + row->count_offset, sizeof count);
    if (row->store == PEL_STORE_DEFS)
        add_defs(fingerprint, row, pointer, count, at);
    else if (row->store == PEL_STORE_FIELD)
        add_field(fingerprint, row->part, pointer, at.mesh);
    else if (row->store == PEL_STORE_SEQUENCE)
        add_sequence(fingerprint, row->part, pointer);
    else if (row->store != PEL_STORE_MESH)
        add_list(fingerprint, row->part, pointer, count, row->size);
    else if (add_pointer(fingerprint, row->part, pointer) && !at.skips_meshes)
        add_mesh(fingerprint, row->part, pointer);
}

static void add_members(pel_fingerprint *fingerprint, pel_def_kind kind, const char *def, place outer)
{
    if (kind == PEL_DEF_BODY)
        outer.mesh = ((const pel_body_def *)(const void *)def)->mesh;
    const pel_def_row *members[PEL_MOST_MEMBERS];
    int32_t count = pel_def_members(kind, members);
    for (int32_t i = 0; i < count; i++) {
        const pel_def_row *row = members[i];
        const char *at = def + row->offset;
        if (row->part == PEL_PART_NONE)
            continue;
        if (row->store == PEL_STORE_DEF)
            add_members(fingerprint, row->element, at, outer);
        else if (row->store == PEL_STORE_QUANTITY)
            add_quantity(fingerprint, row->part, (const pel_quantity *)(const void *)at, outer.mesh);
        else if (row->store < PEL_STORE_QUANTITY)
            pel_fingerprint_add_bytes(fingerprint, row->part, at, row->size);
        else
            add_behind(fingerprint, row, def, outer);
    }
}

void pel_fingerprint_add(pel_fingerprint *fingerprint, pel_def_kind kind, const void *def)
{
    add_members(fingerprint, kind, def, (place){NULL, false});
}

void pel_fingerprint_renew(pel_fingerprint *fingerprint, const void *def)
{
    uint64_t meshes = fingerprint->parts[PEL_PART_MESH];
    *fingerprint = (pel_fingerprint){0};
    add_members(fingerprint, PEL_DEF_MODEL, def, (place){NULL, true});
    fingerprint->parts[PEL_PART_MESH] = meshes;
}

const char *pel_fingerprint_compare(const pel_fingerprint *a, const pel_fingerprint *b, char *text, size_t size)
{
#define NAME(PART, name) name,
    static const char *const names[] = {PEL_PARTS(NAME)};
#undef NAME
    size_t length = 0;
    text[0] = '\0';
    for (int p = 0; p < PEL_PART_COUNT && length < size; p++)
        if (a->parts[p] != b->parts[p])
            length += (size_t)snprintf(text + length, size - length, "%s%s", length > 0 ? ", " : "", names[p]);
    return text;
}
