#include "def/vertices.h"

#include "base/memory.h"
#include "base/status.h"

#include <string.h>

bool pel_values_follow(pel_copies *copies, const double **values, const pel_vertex_sources *vertices)
{
    if (*values == NULL)
        return true;
    double *made = pel_copies_room(copies, (size_t)vertices->count * sizeof *made);
    for (int32_t v = 0; made != NULL && v < vertices->count; v++)
        made[v] = (*values)[vertices->sources[v]];
    *values = made;
    return made != NULL;
}

/* the first place of each vertex in a list plus 1, 0 = it is not in it */
static int32_t *find_members(const int32_t *list, int32_t list_count, const pel_vertex_sources *vertices)
{
    int32_t *places = pel_allocate((size_t)vertices->kept_count, sizeof *places);
    for (int32_t i = list_count - 1; places != NULL && i >= 0; i--)
        if (list[i] < vertices->kept_count)
            places[list[i]] = i + 1;
    return places;
}

bool pel_list_follows(pel_copies *copies, const int32_t **list, int32_t *list_count, const double **weights,
                      const pel_vertex_sources *vertices)
{
    if (*list == NULL)
        return pel_values_follow(copies, weights, vertices);
    size_t room = (size_t)*list_count + (size_t)(vertices->count - vertices->kept_count);
    int32_t *made = pel_copies_room(copies, room * sizeof *made), count = 0;
    double *made_weights = *weights != NULL ? pel_copies_room(copies, room * sizeof *made_weights) : NULL;
    int32_t *places = find_members(*list, *list_count, vertices);
    bool is_made = made != NULL && places != NULL && (*weights == NULL || made_weights != NULL);
    for (int32_t i = 0; is_made && i < *list_count; i++) {
        if ((*list)[i] >= vertices->kept_count)
            continue;
        if (made_weights != NULL)
            made_weights[count] = (*weights)[i];
        made[count++] = (*list)[i];
    }
    for (int32_t v = vertices->kept_count; is_made && v < vertices->count; v++) {
        int32_t place = places[vertices->sources[v]];
        if (place == 0)
            continue;
        if (made_weights != NULL)
            made_weights[count] = (*weights)[place - 1];
        made[count++] = v;
    }
    pel_free(places);
    *list = made;
    *list_count = count;
    *weights = made_weights;
    return is_made;
}

static bool follow(pel_copies *copies, pel_def_kind kind, char *def, const pel_vertex_sources *vertices);

/* a list of defs is a copy already, and may be written to */
static bool follow_defs(pel_copies *copies, const pel_def_row *row, char *def, const pel_vertex_sources *vertices)
{
    char *defs;
    int32_t count;
    bool is_made = true;
    memcpy(&defs, def + row->offset, sizeof defs);
    memcpy(&count, def + row->count_offset, sizeof count);
    for (int32_t i = 0; is_made && defs != NULL && i < count; i++)
        is_made = follow(copies, row->element, defs + (size_t)i * row->size, vertices);
    return is_made;
}

static bool follow_list(pel_copies *copies, const pel_def_row *row, char *def, const pel_vertex_sources *vertices)
{
    const int32_t *list;
    const double *none = NULL;
    int32_t count;
    memcpy(&list, def + row->offset, sizeof list);
    memcpy(&count, def + row->count_offset, sizeof count);
    if (list == NULL)
        return true;
    bool is_made = pel_list_follows(copies, &list, &count, &none, vertices);
    memcpy(def + row->offset, &list, sizeof list);
    memcpy(def + row->count_offset, &count, sizeof count);
    return is_made;
}

static bool follow(pel_copies *copies, pel_def_kind kind, char *def, const pel_vertex_sources *vertices)
{
    const pel_def_row *members[PEL_MOST_MEMBERS];
    int32_t count = pel_def_members(kind, members);
    bool is_made = true;
    for (int32_t i = 0; is_made && i < count; i++) {
        const pel_def_row *row = members[i];
        void *at = def + row->offset;
        bool is_origins = kind == PEL_DEF_BODY && row->offset == offsetof(pel_body_def, origins);
        if (row->store == PEL_STORE_DEF)
            is_made = follow(copies, row->element, at, vertices);
        else if (row->store == PEL_STORE_DEFS)
            is_made = follow_defs(copies, row, def, vertices);
        else if (row->store == PEL_STORE_QUANTITY)
            is_made = pel_values_follow(copies, &((pel_quantity *)at)->field, vertices);
        else if (row->store == PEL_STORE_FIELD)
            is_made = pel_values_follow(copies, at, vertices);
        else if (row->store == PEL_STORE_LIST && row->size == sizeof(int32_t) && !is_origins)
            is_made = follow_list(copies, row, def, vertices);
    }
    return is_made;
}

pel_status pel_def_follow_vertices(pel_copies *copies, pel_def_kind kind, void *def, const pel_vertex_sources *vertices,
                                   pel_error *error)
{
    return follow(copies, kind, def, vertices) ? PEL_OK : pel_fail_memory(error);
}
