/* Membranes and mid-edge bending of triangles, one in each lane. */
#include "force/tangent_lanes.h"
#include "measure/tangent_triangle.h"

#include <string.h>

enum { LANES = PEL_TANGENT_LANES, STRAINS = PEL_MEMBRANE_STRAINS + PEL_MIDEDGE_STRAINS };

/* triangles at hand: what their elements need */
typedef struct triangle_lanes {
    pel_tangent_kind kind;
    bool has_stress, is_viscous;
    pel_lane3 x[3];
    pel_lane step[PEL_TANGENT_UNKNOWNS], stress[STRAINS];
    pel_sheet sheet;
    pel_lane stiffness[6], alpha[3], sign[3];
    pel_lane viscous[STRAINS * PEL_VISCOUS_NUMBERS];
    double rate;
} triangle_lanes;

/* and what they give */
typedef struct triangle_sums {
    pel_lane membrane, edges; /* energies */
    pel_lane gradient[PEL_TANGENT_UNKNOWNS], extrapolated[STRAINS], strain[STRAINS * PEL_VISCOUS_NUMBERS];
    pel_lane hessian[PEL_TANGENT_UNKNOWNS * PEL_TANGENT_UNKNOWNS];
} triangle_sums;

static void load_corners(const double *unknowns, const int32_t *const nodes[LANES], pel_lane3 x[3])
{
    for (int k = 0; k < 3; k++)
        x[k] = pel_tangent_corner(unknowns, nodes, k);
}

static void load_step(const pel_tangent_loop *loop, const int32_t *const nodes[LANES], bool has_edges,
                      triangle_lanes *in)
{
    const double *edges = loop->step + 2 * (size_t)loop->tangent->pattern.vertex_count, *from[LANES];
    pel_lane3 corners[3];
    load_corners(loop->step, nodes, corners);
    for (int k = 0; k < 3; k++) {
        pel_strain_row_set(&in->step[3 * k], corners[k]);
        for (int l = 0; has_edges && l < LANES; l++)
            from[l] = edges + nodes[l][3 + k];
        if (has_edges)
            in->step[9 + k] = pel_tangent_gather(from, 0);
    }
}

/* shape without stress and slip in the step in progress */
static void load_flow(const pel_tangent_loop *loop, const pel_tangent_shell *own, const int32_t t[LANES],
                      pel_sheet *sheet)
{
    const pel_flow *flows = loop->input->state != NULL ? loop->input->state->plastic_next.flows : NULL;
    const double *shape[LANES], *slip[LANES], *growth[LANES];
    if (flows == NULL)
        return;
    for (int l = 0; l < LANES; l++) {
        const pel_flow *flow = &flows[own->shell->first_flow + t[l]];
        shape[l] = flow->inverse;
        slip[l] = &flow->slip;
        growth[l] = &flow->growth;
    }
    for (int k = 0; k < 3; k++)
        sheet->inverse[k] = pel_tangent_gather(shape, k);
    sheet->area = sheet->area * pel_tangent_gather(growth, 0);
    if (own->shell->yields)
        sheet->numbers[0] = pel_tangent_gather(slip, 0);
}

static void load_sheet(const pel_tangent_loop *loop, const pel_tangent_shell *own, const int32_t t[LANES],
                       pel_sheet *sheet)
{
    double modulus[LANES];
    const double *rest[LANES], *area[LANES], *moduli[LANES];
    for (int l = 0; l < LANES; l++) {
        modulus[l] = pel_shell_law(own->shell, t[l]).modulus;
        moduli[l] = &modulus[l];
        rest[l] = own->rests[t[l]].inverse;
        area[l] = &own->rests[t[l]].area;
    }
    for (int k = 0; k < 3; k++)
        sheet->inverse[k] = pel_tangent_gather(rest, k);
    sheet->area = pel_tangent_gather(area, 0);
    sheet->modulus = pel_tangent_gather(moduli, 0);
    sheet->kind = own->shell->law.kind;
    for (int k = 0; k < PEL_LAW_NUMBERS; k++)
        sheet->numbers[k] = pel_lane_splat(own->shell->law.numbers[k]);
    if (pel_shell_flows(own->shell))
        load_flow(loop, own, t, sheet);
    if (!pel_law_is_oriented(pel_membrane_law_traits(sheet->kind)))
        return;
    for (int k = 0; k < PEL_LAW_AXIS; k++) {
        for (int l = 0; l < LANES; l++)
            rest[l] = own->shell->axes[t[l]];
        sheet->numbers[k] = pel_tangent_gather(rest, k);
    }
}

static void load_edges(const pel_tangent_loop *loop, const pel_tangent_shell *own, const int32_t t[LANES],
                       triangle_lanes *in)
{
    const pel_tangent *tangent = loop->tangent;
    const double *xi = loop->input->unknowns + 3 * (size_t)tangent->pattern.vertex_count;
    double alpha[LANES][3], sign[LANES][3];
    const double *alphas[LANES], *signs[LANES], *stiffness[LANES];
    for (int l = 0; l < LANES; l++) {
        for (int k = 0; k < 3; k++) {
            const int32_t e = pel_tangent_edge_of(own->edges[t[l]][k], &sign[l][k]);
            alpha[l][k] = tangent->half_angles[e] + sign[l][k] * xi[e];
        }
        alphas[l] = alpha[l];
        signs[l] = sign[l];
        stiffness[l] = own->midedges[t[l]].stiffness;
    }
    for (int k = 0; k < 3; k++) {
        in->alpha[k] = pel_tangent_gather(alphas, k);
        in->sign[k] = pel_tangent_gather(signs, k);
    }
    for (int k = 0; k < 6; k++)
        in->stiffness[k] = pel_tangent_gather(stiffness, k);
}

/* the first `count` of the numbers that each strain has */
static void load_numbers(const double *numbers, int each, const int32_t at[LANES], int count, pel_lane *lanes)
{
    const double *from[LANES];
    for (int l = 0; l < LANES; l++)
        from[l] = numbers + (size_t)each * (size_t)at[l];
    for (int k = 0; k < count; k++)
        lanes[k] = pel_tangent_gather(from, k);
}

/* constant flags: what is not asked for is not computed */
PEL_INLINE void evaluate(const triangle_lanes *in, bool is_sheet, bool is_plate, bool has_gradient, bool has_hessian,
                         bool extrapolates, bool refers, triangle_sums *out)
{
    const pel_strain_sum sum = {has_gradient ? out->gradient : NULL, has_hessian ? out->hessian : NULL,
                                PEL_TANGENT_UNKNOWNS};
    for (int i = 0; has_gradient && i < PEL_TANGENT_UNKNOWNS; i++)
        out->gradient[i] = pel_lane_splat(0);
    for (int i = 0; has_hessian && i < PEL_TANGENT_UNKNOWNS * PEL_TANGENT_UNKNOWNS; i++)
        out->hessian[i] = pel_lane_splat(0);
    for (int i = 0; extrapolates && i < STRAINS; i++)
        out->extrapolated[i] = pel_lane_splat(0);
    for (int i = 0; refers && i < STRAINS * PEL_VISCOUS_NUMBERS; i++)
        out->strain[i] = pel_lane_splat(0);
    pel_strain_request request = {.kind = in->kind,
                                  .stress = in->has_stress ? in->stress : NULL,
                                  .step = extrapolates ? in->step : NULL,
                                  .extrapolated = extrapolates ? out->extrapolated : NULL,
                                  .viscous = in->is_viscous ? in->viscous : NULL,
                                  .rate = in->rate,
                                  .strain = refers ? out->strain : NULL};
    if (is_sheet)
        out->membrane = pel_sheet_tangent(&in->sheet, in->x, &request, &sum);
    request.stress = in->has_stress ? in->stress + PEL_MEMBRANE_STRAINS : NULL;
    request.extrapolated = extrapolates ? out->extrapolated + PEL_MEMBRANE_STRAINS : NULL;
    request.viscous = in->is_viscous ? in->viscous + PEL_MEMBRANE_STRAINS * PEL_VISCOUS_NUMBERS : NULL;
    request.strain = refers ? out->strain + PEL_MEMBRANE_STRAINS * PEL_VISCOUS_NUMBERS : NULL;
    if (is_plate)
        out->edges = pel_plate_tangent(in->stiffness, in->alpha, in->sign, in->x, &request, &sum);
}

static void load(const pel_tangent_loop *loop, const pel_tangent_part *part, const int32_t t[LANES], triangle_lanes *in)
{
    const pel_tangent *tangent = loop->tangent;
    const pel_tangent_shell *own = &tangent->shells[part->shell];
    int32_t places[LANES];
    const int32_t *nodes[LANES];
    for (int l = 0; l < LANES; l++) {
        nodes[l] = tangent->nodes + tangent->node_begin[part->first + t[l]];
        places[l] = pel_tangent_stress(own, part, t[l]);
    }
    load_corners(loop->input->unknowns, nodes, in->x);
    if (own->shell->has_membrane)
        load_sheet(loop, own, t, &in->sheet);
    if (own->midedges != NULL)
        load_edges(loop, own, t, in);
    if (in->has_stress)
        load_numbers(loop->input->stresses, 1, places, part->strains, in->stress);
    if (in->is_viscous)
        load_numbers(loop->input->viscous, PEL_VISCOUS_NUMBERS, places, part->strains * PEL_VISCOUS_NUMBERS,
                     in->viscous);
    if (loop->step != NULL)
        load_step(loop, nodes, own->midedges != NULL, in);
}

/* the strains of a triangle, which is in a lane */
static void refer_strains(const pel_tangent_loop *loop, const pel_tangent_part *part, int32_t t,
                          const triangle_sums *sums, int lane)
{
    const pel_tangent_shell *own = &loop->tangent->shells[part->shell];
    for (int k = 0; k < part->strains; k++) {
        double numbers[PEL_VISCOUS_NUMBERS];
        for (int j = 0; j < PEL_VISCOUS_NUMBERS; j++)
            numbers[j] = pel_tangent_lane(&sums->strain[PEL_VISCOUS_NUMBERS * k + j], lane);
        pel_tangent_refer(loop, pel_tangent_stress(own, part, t) + k,
                          k < PEL_MEMBRANE_STRAINS ? own->shell->membrane_retardation : own->shell->bending_retardation,
                          numbers);
    }
}

void pel_tangent_triangles(const pel_tangent_loop *loop, const pel_tangent_part *part, const int32_t *triangles,
                           int32_t count, double *gradients, double *matrices, pel_tangent_energy *energy)
{
    const pel_tangent_shell *own = &loop->tangent->shells[part->shell];
    const bool is_sheet = own->shell->has_membrane, is_plate = own->midedges != NULL;
    const int n = part->unknowns;
    triangle_lanes in = {.kind = loop->input->kind,
                         .has_stress = loop->input->stresses != NULL,
                         .is_viscous = loop->input->viscous != NULL,
                         .rate = loop->input->rate};
    triangle_sums out;
    for (int32_t first = 0; first < count; first += LANES) {
        const int lanes = count - first < LANES ? count - first : LANES;
        int32_t t[LANES];
        for (int l = 0; l < LANES; l++)
            t[l] = triangles[first + (l < lanes ? l : 0)];
        load(loop, part, t, &in);
        if (matrices != NULL)
            evaluate(&in, is_sheet, is_plate, false, true, false, false, &out);
        else if (gradients != NULL)
            evaluate(&in, is_sheet, is_plate, true, false, false, false, &out);
        else if (loop->stresses != NULL)
            evaluate(&in, is_sheet, is_plate, false, false, true, false, &out);
        else if (loop->viscous != NULL)
            evaluate(&in, is_sheet, is_plate, false, false, false, true, &out);
        else
            evaluate(&in, is_sheet, is_plate, false, false, false, false, &out);
        for (int row = 0; matrices != NULL && row < n; row++)
            pel_tangent_scatter(&out.hessian[row * PEL_TANGENT_UNKNOWNS], n, lanes, matrices + (first * n + row) * n,
                                (size_t)(n * n));
        if (gradients != NULL)
            pel_tangent_scatter(out.gradient, n, lanes, gradients + first * n, (size_t)n);
        for (int l = 0; l < lanes; l++) {
            energy->membrane += is_sheet ? pel_tangent_lane(&out.membrane, l) : 0;
            energy->edges += is_plate ? pel_tangent_lane(&out.edges, l) : 0;
            for (int k = 0; loop->stresses != NULL && k < part->strains; k++)
                loop->stresses[pel_tangent_stress(own, part, t[l]) + k] = pel_tangent_lane(&out.extrapolated[k], l);
            if (loop->viscous != NULL)
                refer_strains(loop, part, t[l], &out, l);
        }
    }
}
