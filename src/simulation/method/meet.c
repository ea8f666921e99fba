#include "method/meet.h"

#include "attach/joint.h"
#include "attach/tie.h"
#include "math/extremes.h"
#include "stage/rigids.h"
#include "sweep/backing.h"
#include "sweep/sweep.h"
#include "tool/reading.h"
#include "tool/solid.h"
#include "tool/tools.h"
#include "touch/contact.h"
#include "touch/sleep.h"

#include <string.h>

/* sweeps over contacts after one over elements, and the corrections at which they may end: of the thickness, and of
   what loads have moved where friction holds much */
enum { SWEEP_LIMIT = 8, RIGID_SWEEP_LIMIT = 60 };
#define SWEEP_TOLERANCE 0.1
#define DEPTH_TOLERANCE 0.01
/* of the thickness, and of what loads have moved; rigid bodies have nothing that takes a tremor out: a stack of ten
   boxes stands still at 2e-4 and trembles with 10 % of its weight at 1e-2 */
#define RIGID_TOLERANCE 2e-4
#define RIGID_SHARE 1e-3
/* of that: contacts whose bodies have moved by less are passed over */
#define CALM_SHARE 0.5
/* of the size of the bodies */
#define JOINT_TOLERANCE 1e-8
/* of the thickness: larger corrections update the contacts between two sweeps */
#define REFRESH_SHARE 0.25

/* contacts of one kind or the other that act in the substeps; null = none */
static pel_contact_list *loop_contacts(const pel_sim *sim)
{
    return pel_sim_has_loop_contacts(sim) ? &sim->contacts->list : NULL;
}

/* m, of the layers in the loop */
static double least_thickness(const pel_sim *sim)
{
    double least = HUGE_VAL;
    if (sim->contacts != NULL)
        least = sim->rigids != NULL ? sim->contacts->least : sim->contacts->def.thickness;
    return sim->tools->solids != NULL ? pel_min(least, pel_solids_thickness(sim)) : least;
}

void pel_meet_lists(const pel_sim *sim, pel_contact_list *lists[2])
{
    lists[0] = loop_contacts(sim);
    lists[1] = sim->tools->solids != NULL ? &sim->tools->solids->list : NULL;
}

/* ---- a substep ---- */

/* update the contacts at the predicted positions and apply the kept loads */
static void begin_contacts(pel_sim *sim, const pel_meeting *meeting)
{
    pel_record *positions = sim->state->position_next;
    pel_contact_list *pairs = loop_contacts(sim);
    double most = DEPTH_TOLERANCE * least_thickness(sim);
    if (pairs != NULL) {
        pel_contacts_begin_substep(sim, meeting->tau);
        pel_contacts_refresh(sim, meeting->start, true);
        pel_contacts_begin(&sim->contacts->heights.list, meeting->tau);
        pel_contacts_load(pairs, positions, most);
    }
    if (sim->tools->solids != NULL) {
        pel_solids_begin_substep(sim, meeting->tau);
        pel_solids_refresh(sim, meeting->start, true);
        pel_contacts_load(&sim->tools->solids->list, positions, most);
    }
}

void pel_meet_begin(pel_sim *sim, const pel_meeting *meeting)
{
    begin_contacts(sim, meeting);
    pel_ties_begin_substep(sim, meeting->end - 0.5 * meeting->length, meeting->start);
    pel_joints_begin_substep(sim);
}

/* whether a sweep has hardly changed the gaps, or the loads on which much friction counts */
static bool has_settled(const pel_sim *sim, const pel_contact_list *list, double moved)
{
    double depth = DEPTH_TOLERANCE * least_thickness(sim);
    return !(moved > (list->is_rubbed ? pel_min(SWEEP_TOLERANCE * list->carried, depth) : depth));
}

/* update the contacts between two sweeps */
static void follow_contacts(pel_sim *sim, const pel_record *start)
{
    pel_rigids_place(sim->rigids, sim->state->position_next);
    if (loop_contacts(sim) != NULL)
        pel_contacts_refresh(sim, start, false);
    if (sim->tools->solids != NULL)
        pel_solids_refresh(sim, start, false);
    pel_contact_list *lists[2];
    pel_meet_lists(sim, lists);
    for (int k = 0; k < 2; k++)
        if (lists[k] != NULL)
            pel_contacts_rouse(lists[k], lists[k]->calm);
}

/* m, a correction of rigid bodies at which sweeps may end */
static double rigid_tolerance(const pel_contact_list *list, double least)
{
    return pel_max(RIGID_TOLERANCE * least, RIGID_SHARE * list->carried);
}

/* what tools hold, in both lists, against what presses it */
static void find_supports(pel_sim *sim, pel_contact_list *const lists[2])
{
    bool is_loose = sim->rigids == NULL || !sim->rigids->are_all;
    bool is_asked = is_loose && lists[0] != NULL && (sim->tools->count > 0 || lists[0]->is_uneven);
    pel_contact **supports = is_asked ? sim->touch->supports : NULL;
    if (supports != NULL)
        memset(supports, 0, 2 * (size_t)sim->model->vertex_count * sizeof *supports);
    for (int k = 0; k < 2 && supports != NULL; k++)
        if (lists[k] != NULL) {
            pel_contacts_find_supports(lists[k], sim->state->position_next, supports);
            lists[k]->supports = supports;
        }
}

void pel_meet_sweep(pel_sim *sim, const pel_meeting *meeting)
{
    pel_record *positions = sim->state->position_next;
    pel_contact_list *lists[2];
    pel_meet_lists(sim, lists);
    pel_ties_project(sim, meeting->end, meeting->tau, positions);
    if (lists[0] != NULL)
        pel_contact_heights_refresh(sim->contacts, positions);
    double least = least_thickness(sim), most = REFRESH_SHARE * least, moved = 0;
    bool is_over = false, is_stacked = false;
    for (int i = 0; i < (is_stacked ? RIGID_SWEEP_LIMIT : SWEEP_LIMIT) && !is_over; i++) {
        if (moved > most)
            follow_contacts(sim, meeting->start);
        find_supports(sim, lists);
        moved = 0;
        is_stacked = pel_joints_project(sim, meeting->length) > JOINT_TOLERANCE;
        is_over = !is_stacked;
        for (int k = 0; k < 2; k++) {
            if (lists[k] == NULL)
                continue;
            double way = pel_contacts_project(lists[k], positions, meeting->start);
            bool is_loose = !(lists[k]->rigid_moved > rigid_tolerance(lists[k], least));
            /* joints move bodies too */
            lists[k]->calm = sim->joints == NULL ? CALM_SHARE * rigid_tolerance(lists[k], least) : -1;
            is_over &= (has_settled(sim, lists[k], way) || (i >= SWEEP_LIMIT && sim->rigids != NULL)) && is_loose;
            is_stacked |= !is_loose;
            moved = pel_max(moved, way);
        }
        if (lists[0] != NULL)
            pel_contacts_project(&sim->contacts->heights.list, positions, meeting->start);
    }
    pel_rigids_place(sim->rigids, positions);
    for (int k = 0; k < 2; k++)
        if (lists[k] != NULL)
            lists[k]->supports = NULL;
}

/* whether any body of a contact is marked, and all */
static void read_marks(const pel_sim *sim, const pel_contact *contact, const uint8_t *bodies, bool *any, bool *all)
{
    *any = false;
    *all = true;
    for (int i = 0; i < 4; i++) {
        if (contact->weights[i] == 0)
            continue;
        bool is_marked = bodies[sim->model->body_of_slice[contact->vertices[i] / PEL_WIDTH]];
        *any |= is_marked;
        *all &= is_marked;
    }
}

static void mark(const pel_sim *sim, const pel_contact *contact, uint8_t *bodies)
{
    for (int i = 0; i < 4; i++)
        if (contact->weights[i] != 0)
            bodies[sim->model->body_of_slice[contact->vertices[i] / PEL_WIDTH]] = 1;
}

void pel_meet_mark_pressed(const pel_sim *sim, uint8_t *bodies)
{
    const pel_contact_list *pairs = loop_contacts(sim);
    for (int32_t i = 0; pairs != NULL && i < pel_contact_list_length(pairs); i++)
        if (pel_contact_list_at(pairs, i)->multiplier > 0)
            mark(sim, pel_contact_list_at(pairs, i), bodies);
    if (sim->tools->solids != NULL)
        pel_solids_mark_carried(sim, bodies);
}

void pel_meet_spread(const pel_sim *sim, uint8_t *bodies)
{
    const pel_contact_list *pairs = loop_contacts(sim);
    const size_t body_count = (size_t)sim->model->body_count;
    bool spreads = memchr(bodies, 1, body_count) != NULL && memchr(bodies, 0, body_count) != NULL;
    if (spreads && sim->ties != NULL)
        memset(bodies, 1, body_count);
    while (spreads && pairs != NULL) {
        spreads = false;
        for (int32_t c = 0; c < pairs->count; c++) {
            bool any, all;
            read_marks(sim, &pairs->contacts[c], bodies, &any, &all);
            if (!any || all)
                continue;
            mark(sim, &pairs->contacts[c], bodies);
            spreads = true;
        }
    }
}

void pel_meet_tally(pel_sim *sim, const pel_meeting *meeting, pel_record *reaction)
{
    double rate = 1 / (meeting->length * meeting->length * sim->solver.substeps);
    pel_ties_tally(sim, meeting->tau, reaction);
    pel_joints_tally(sim, meeting->length);
    if (pel_sim_has_loop_contacts(sim))
        pel_contacts_tally(sim, rate);
    if (sim->tools->solids != NULL)
        pel_solids_tally(sim, rate);
}

/* ---- a step ---- */

pel_status pel_meet_find(pel_sim *sim, bool has_pairs, pel_error *error)
{
    pel_status status;
    do {
        status = has_pairs ? pel_contacts_find(sim, 0, error) : PEL_OK;
        if (status == PEL_OK && has_pairs)
            status = pel_contact_heights_find(sim->contacts, sim->state->position, error);
        if (status == PEL_OK && sim->tools->solids != NULL)
            status = pel_solids_find(sim, error);
    } while (status == PEL_OK && pel_sleep_meet_tools(sim));
    return status;
}

void pel_meet_recall(pel_sim *sim, double length)
{
    if (pel_sim_has_loop_contacts(sim))
        pel_contact_set_recall_loads(sim->contacts, length);
    if (sim->tools->solids != NULL)
        pel_solids_recall_loads(sim, length);
}

void pel_meet_end(pel_sim *sim)
{
    if (sim->tools->solids != NULL)
        pel_solids_keep_loads(sim);
    if (!pel_sim_has_loop_contacts(sim))
        return;
    pel_contacts_end_search(sim, sim->state->position_next);
    pel_contacts_tell(sim);
    pel_contact_set_keep_loads(sim->contacts);
    pel_contacts_tally_asleep(sim);
}
