#include "model/def_copy.h"

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
static size_t size_behind(const pel_member *member, const char *def, const char *pointer, const pel_mesh *mesh)
{
    int32_t count = 0;
    if (member->form == PEL_MEMBER_TEXT)
        return strlen(pointer) + 1;
    if (member->form == PEL_MEMBER_FIELD)
        return (size_t)mesh->vertex_count * sizeof(double);
    memcpy(&count, def + member->count_offset, sizeof count);
    return (size_t)count * member->size;
}

static bool copy_members(pel_copies *copies, const pel_member *members, char *def, const pel_mesh *mesh);

static bool copy_behind(pel_copies *copies, const pel_member *member, char *def, const pel_mesh *mesh)
{
    char *pointer;
    memcpy(&pointer, def + member->offset, sizeof pointer);
    if (pointer == NULL)
        return true;
    size_t size = size_behind(member, def, pointer, mesh);
    pointer = pel_copies_take(copies, pointer, size);
    memcpy(def + member->offset, &pointer, sizeof pointer);
    bool is_copied = pointer != NULL;
    for (size_t at = 0; is_copied && member->members != NULL && at < size; at += member->size)
        is_copied = copy_members(copies, member->members, pointer + at, mesh);
    return is_copied;
}

static bool copy_members(pel_copies *copies, const pel_member *members, char *def, const pel_mesh *mesh)
{
    bool is_copied = true;
    if (members == pel_body_members)
        mesh = ((const pel_body_def *)(const void *)def)->mesh;
    for (const pel_member *member = members; is_copied && member->form != PEL_MEMBER_END; member++) {
        if (member->form == PEL_MEMBER_DEF)
            is_copied = copy_members(copies, member->members, def + member->offset, mesh);
        else if (member->form == PEL_MEMBER_LIST || member->form == PEL_MEMBER_FIELD || member->form == PEL_MEMBER_TEXT)
            is_copied = copy_behind(copies, member, def, mesh);
    }
    return is_copied;
}

pel_status pel_def_copy(pel_copies *copies, const pel_member *members, void *def, pel_error *error)
{
    return copy_members(copies, members, def, NULL) ? PEL_OK : pel_fail_memory(error);
}
