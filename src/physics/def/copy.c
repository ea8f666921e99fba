#include "def/copy.h"

#include "base/memory.h"
#include "base/status.h"

#include <string.h>

typedef struct pel_copy_block {
    struct pel_copy_block *next;
    max_align_t bytes[];
} pel_copy_block;

void *pel_copies_room(pel_copies *copies, size_t size)
{
    pel_copy_block *block = pel_allocate(1, sizeof *block + size);
    if (block == NULL)
        return NULL;
    block->next = copies->first;
    copies->first = block;
    return block->bytes;
}

void *pel_copies_take(pel_copies *copies, const void *bytes, size_t size)
{
    void *room = pel_copies_room(copies, size);
    if (room != NULL && size > 0)
        memcpy(room, bytes, size);
    return room;
}

void pel_copies_free(pel_copies *copies)
{
    while (copies->first != NULL) {
        pel_copy_block *block = copies->first;
        copies->first = block->next;
        pel_free(block);
    }
}

/* bytes of the array at a pointer of a def; meshes are not copied */
static size_t size_behind(const pel_def_row *row, const char *def, const char *pointer, const pel_mesh *mesh)
{
    int32_t count = 0;
    if (row->store == PEL_STORE_TEXT)
        return strlen(pointer) + 1;
    if (row->store == PEL_STORE_FIELD)
        return (size_t)mesh->vertex_count * sizeof(double);
    memcpy(&count, def + row->count_offset, sizeof count);
    return (size_t)count * row->size;
}

/* replaces a nullable pointer */
static bool copy_array(pel_copies *copies, void *at, size_t size)
{
    const void *pointer;
    memcpy(&pointer, at, sizeof pointer);
    if (pointer == NULL)
        return true;
    pointer = pel_copies_take(copies, pointer, size);
    memcpy(at, &pointer, sizeof pointer);
    return pointer != NULL;
}

static bool copy_members(pel_copies *copies, pel_def_kind kind, char *def, const pel_mesh *mesh);

static bool copy_behind(pel_copies *copies, const pel_def_row *row, char *def, const pel_mesh *mesh)
{
    char *pointer;
    memcpy(&pointer, def + row->offset, sizeof pointer);
    if (pointer == NULL)
        return true;
    size_t size = size_behind(row, def, pointer, mesh);
    bool is_copied = copy_array(copies, def + row->offset, size);
    memcpy(&pointer, def + row->offset, sizeof pointer);
    for (size_t at = 0; is_copied && row->store == PEL_STORE_DEFS && at < size; at += row->size)
        is_copied = copy_members(copies, row->element, pointer + at, mesh);
    return is_copied;
}

static bool copy_quantity(pel_copies *copies, pel_quantity *quantity, const pel_mesh *mesh)
{
    size_t size = quantity->field != NULL ? (size_t)mesh->vertex_count * sizeof(double) : 0;
    return copy_array(copies, &quantity->field, size) &&
           copy_array(copies, &quantity->keys, (size_t)quantity->key_count * sizeof(pel_key));
}

static bool copy_members(pel_copies *copies, pel_def_kind kind, char *def, const pel_mesh *mesh)
{
    bool is_copied = true;
    if (kind == PEL_DEF_BODY)
        mesh = ((const pel_body_def *)(const void *)def)->mesh;
    const pel_def_row *members[PEL_MOST_MEMBERS];
    int32_t count = pel_def_members(kind, members);
    for (int32_t i = 0; is_copied && i < count; i++) {
        const pel_def_row *row = members[i];
        if (row->store == PEL_STORE_DEF)
            is_copied = copy_members(copies, row->element, def + row->offset, mesh);
        else if (row->store == PEL_STORE_QUANTITY)
            is_copied = copy_quantity(copies, (pel_quantity *)(void *)(def + row->offset), mesh);
        else if (row->store > PEL_STORE_QUANTITY && row->store != PEL_STORE_MESH && row->store != PEL_STORE_SEQUENCE)
            is_copied = copy_behind(copies, row, def, mesh);
    }
    return is_copied;
}

pel_status pel_def_copy(pel_copies *copies, pel_def_kind kind, void *def, pel_error *error)
{
    return copy_members(copies, kind, def, NULL) ? PEL_OK : pel_fail_memory(error);
}
