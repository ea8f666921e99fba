#include "touch/doubt.h"

#include "contact/set.h"
#include "tool/tool.h"
#include "tool/tools.h"

#include <string.h>

/* whether a tool presses or holds a body in this part */
static bool acts_on(const pel_sim *sim, const pel_tool *tool, int32_t body)
{
    const pel_contact_forces *forces = &sim->contact_forces;
    int32_t group = sim->model->body_count + (int32_t)(tool - sim->tools->items);
    bool acts = forces->pair_next[body * forces->group_count + group].load_size > 0;
    for (int32_t i = 0; i < tool->held_count && !acts; i++)
        acts = sim->model->body_of_slice[tool->held[i] / PEL_WIDTH] == body;
    return acts;
}

/* whether it does so on this body, or on one that presses this body */
static bool acts_beside(const pel_sim *sim, const pel_tool *tool, int32_t body)
{
    const pel_contact_forces *forces = &sim->contact_forces;
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        int32_t low = b < body ? b : body, high = b < body ? body : b;
        bool is_near = b == body || forces->pair_next[low * forces->group_count + high].load_size > 0;
        if (is_near && acts_on(sim, tool, b))
            return true;
    }
    return false;
}

void pel_contacts_doubt_forces(pel_sim *sim, bool has_stepped_back)
{
    const pel_contact_set *contacts = sim->contacts;
    int32_t last = -1;
    for (int32_t v = 0; has_stepped_back && v < contacts->vertex_count; v++) {
        int32_t body = sim->model->body_of_slice[v / PEL_WIDTH];
        if (body == last || memcmp(contacts->end[v], contacts->solved[v], sizeof contacts->end[v]) == 0)
            continue;
        last = body;
        for (int32_t t = 0; t < sim->tools->count; t++)
            sim->tools->items[t].is_doubtful |= acts_beside(sim, &sim->tools->items[t], body);
    }
}
