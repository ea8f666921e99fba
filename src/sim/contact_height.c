/* Triangles that collapse. A law such as StVK resists less and less where a triangle is pressed flat in its own plane,
   and no pair of features tells it: the features have vertices in common. The edges about a collapsed triangle then lie
   along each other, and everything in their neighbourhood jams. So with contact the height of each triangle of a body
   over its longest edge stays above a share of its least height at rest: a contact between a vertex and an edge. */
#include "sim/contact.h"

#include "base/memory.h"
#include "base/status.h"

/* least height, of that at rest */
#define LEAST_SHARE 0.05
/* triangles below so many least heights at the start of a step are watched in it */
#define WATCH 4.0

/* from the longest edge, a to b, to the third vertex */
typedef struct height {
    int vertex, a, b;
    double share;  /* of the edge, where the height stands on it */
    double way[3]; /* from there to the vertex */
    double length; /* m */
} height;

static height measure(double x[3][3])
{
    double longest = -1, along[3], way[3];
    height h = {0};
    for (int i = 0; i < 3; i++) {
        int a = (i + 1) % 3, b = (i + 2) % 3;
        pel_vec3_subtract(x[b], x[a], along);
        double square = pel_vec3_squared_length(along);
        if (!(square > longest))
            continue;
        longest = square;
        pel_vec3_subtract(x[i], x[a], way);
        h = (height){.vertex = i, .a = a, .b = b, .share = square > 0 ? pel_vec3_dot(way, along) / square : 0};
        pel_vec3_along(way, -h.share, along, h.way);
    }
    h.length = pel_vec3_length(h.way);
    return h;
}

static height measure_triangle(const int32_t *v, const pel_record *positions)
{
    double x[3][3];
    for (int i = 0; i < 3; i++)
        pel_vertex_position(positions, v[i], x[i]);
    return measure(x);
}

pel_status pel_contact_heights_find(pel_sim *sim, pel_error *error)
{
    pel_sim_contacts *contacts = sim->contacts;
    pel_contact_heights *heights = &contacts->heights;
    heights->list.count = 0;
    for (int32_t t = 0; t < contacts->triangle_count; t++) {
        const int32_t *v = contacts->triangles[t];
        if (v[0] >= contacts->place_count)
            continue;
        double least = LEAST_SHARE * measure_triangle(v, sim->model->rest).length;
        if (!(measure_triangle(v, sim->state->position).length < WATCH * least))
            continue;
        size_t count = (size_t)heights->list.count;
        if (!pel_reserve((void **)&heights->list.contacts, &heights->capacity, count + 1,
                         sizeof *heights->list.contacts) ||
            !pel_reserve((void **)&heights->triangles, &heights->triangle_capacity, count + 1,
                         sizeof *heights->triangles))
            return pel_fail_memory(error);
        heights->list.contacts[count] = (pel_contact){.separation = (pel_real)least};
        heights->triangles[count] = t;
        heights->list.count++;
    }
    return PEL_OK;
}

void pel_contact_heights_refresh(pel_sim *sim)
{
    const pel_sim_contacts *contacts = sim->contacts;
    const pel_contact_heights *heights = &contacts->heights;
    for (int32_t c = 0; c < heights->list.count; c++) {
        pel_contact *contact = &heights->list.contacts[c];
        const int32_t *v = contacts->triangles[heights->triangles[c]];
        height h = measure_triangle(v, sim->state->position_next);
        const int32_t vertices[4] = {v[h.vertex], v[h.a], v[h.b], v[h.b]};
        const double weights[4] = {1, h.share - 1, -h.share, 0};
        for (int i = 0; i < 4; i++) {
            contact->vertices[i] = vertices[i];
            contact->weights[i] = (pel_real)weights[i];
        }
        for (int k = 0; k < 3 && h.length > 0; k++)
            contact->normal[k] = (pel_real)(h.way[k] / h.length);
    }
}
