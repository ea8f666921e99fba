#include "rigid/row.h"

#include "base/memory.h"

void pel_rigid_rows_begin(pel_rigids *rigids)
{
    rigids->row_round = rigids->row_round < INT32_MAX ? rigids->row_round + 1 : 1;
    rigids->row_count = 0;
}

pel_rigid_row *pel_rigid_rows_add(pel_rigids *rigids)
{
    size_t needed = (size_t)rigids->row_count + 1;
    if (!pel_reserve((void **)&rigids->rows, &rigids->row_capacity, needed, sizeof *rigids->rows))
        return NULL;
    return &rigids->rows[rigids->row_count++];
}

/* a side from its grip in the sum: what moves of it */
static void set_side(pel_rigid_row *row, const pel_rigids *rigids, const pel_rigid_grip *grip, pel_rigid_side *side)
{
    static const double axes[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    pel_rigid_grip points = {.rigid = grip->rigid};
    double moved[3], moment[3], turn[3], back[3];
    *side = (pel_rigid_side){.rigid = grip->rigid, .far_turns = grip->rigid->far_turns, .weight = grip->weight};
    for (int i = 0; i < PEL_SUM_MOST; i++)
        if (row->weights[i] != 0 && pel_rigid_of(rigids, row->vertices[i]) == grip->rigid)
            pel_rigid_grip_add(&points, rigids, row->vertices[i], row->weights[i]);
    pel_rigid_grip_turn(&points);
    pel_vec3_add(points.arm, grip->touch, side->arm);
    pel_vec3_copy(grip->arm, side->lever);
    pel_vec3_cross(grip->rigid->turned, side->arm, moved);
    pel_vec3_along(moved, grip->weight, grip->rigid->way, moved);
    pel_vec3_subtract(row->place, moved, row->place);
    for (int k = 0; k < 3; k++) {
        pel_vec3_cross(side->lever, axes[k], moment);
        pel_rigid_turn_by(grip->rigid, moment, turn);
        pel_vec3_cross(turn, side->lever, back);
        pel_vec3_add(row->answer[k], back, row->answer[k]);
        row->answer[k][k] += grip->weight * grip->weight * grip->rigid->shape->inverse_mass;
    }
}

bool pel_rigid_row_set(pel_rigid_row *row, const pel_rigids *rigids, const pel_rigid_sum *sum, const pel_record *start)
{
    double x[3];
    int count = 0;
    if (sum->looseness > 0 || sum->grip_count > 2)
        return false;
    *row = (pel_rigid_row){.place = {sum->value[0], sum->value[1], sum->value[2]}, .has_ball = sum->has_ball};
    pel_vec3_copy(sum->normal, row->normal);
    for (int i = 0; i < PEL_SUM_MOST; i++) {
        row->vertices[i] = sum->vertices[i];
        row->weights[i] = sum->weights[i];
        if (sum->weights[i] == 0)
            continue;
        pel_vertex_position(start, sum->vertices[i], x);
        pel_vec3_along(row->start, sum->weights[i], x, row->start);
    }
    pel_rigid_sum_turn_start(sum, rigids, row->start);
    for (int g = 0; g < sum->grip_count; g++)
        if (!sum->grips[g].rigid->is_fixed)
            set_side(row, rigids, &sum->grips[g], &row->sides[count++]);
    return true;
}

void pel_rigid_row_place(const pel_rigid_row *row, double place[3])
{
    double moved[3];
    pel_vec3_copy(row->place, place);
    for (int i = 0; i < 2 && row->sides[i].rigid != NULL; i++) {
        const pel_rigid_side *side = &row->sides[i];
        pel_vec3_cross(side->rigid->turned, side->arm, moved);
        pel_vec3_along(moved, side->weight, side->rigid->way, moved);
        pel_vec3_add(place, moved, place);
    }
}

double pel_rigid_row_mobility(const pel_rigid_row *row, const double direction[3])
{
    double sum = 0;
    for (int k = 0; k < 3; k++)
        sum += direction[k] * pel_vec3_dot(row->answer[k], direction);
    return sum;
}

void pel_rigid_row_follow(const pel_rigid_row *row, const double push[3], double place[3])
{
    for (int k = 0; k < 3; k++)
        pel_vec3_along(place, push[k], row->answer[k], place);
}

void pel_rigid_row_push(const pel_rigid_row *row, const double push[3], double rate)
{
    double moment[3], own[3];
    for (int i = 0; i < 2 && row->sides[i].rigid != NULL; i++) {
        const pel_rigid_side *side = &row->sides[i];
        pel_vec3_cross(side->lever, push, moment);
        pel_vec3_scale(push, side->weight, own);
        pel_rigid_shift_later(side->rigid, own, moment, rate);
    }
}
