/* Energies and forces of linear tetrahedra, one in each lane. */
#include "force/tangent_lanes.h"
#include "measure/tetra_lanes.h"

enum { LANES = PEL_TANGENT_LANES, UNKNOWNS = 12 };

/* tetrahedra at hand */
typedef struct tetra_lanes {
    pel_lane3 x[4];
    pel_tetra_gradients at_rest;
    pel_lane scale; /* J */
} tetra_lanes;

static void load(const pel_tangent_loop *loop, const pel_tangent_part *part, const int32_t t[LANES], tetra_lanes *in)
{
    const pel_tangent *tangent = loop->tangent;
    const pel_tangent_shell *own = &tangent->shells[part->shell];
    const int32_t *nodes[LANES];
    const double *gradients[LANES], *scales[LANES];
    pel_lane number[9];
    for (int l = 0; l < LANES; l++) {
        PEL_ASSERT_INDEX(t[l], part->count);
        nodes[l] = tangent->nodes + tangent->node_begin[part->first + t[l]];
        gradients[l] = own->tetras[t[l]].gradients[0];
        scales[l] = &own->tetra_scales[t[l]];
    }
    for (int k = 0; k < 4; k++)
        in->x[k] = pel_tangent_corner(loop->input->unknowns, nodes, k);
    for (int j = 0; j < 9; j++)
        number[j] = pel_tangent_gather(gradients, j);
    in->at_rest = pel_tetra_gradients_of(number);
    in->scale = pel_tangent_gather(scales, 0);
}

/* returns the energies */
PEL_INLINE pel_lane strain(const pel_solid_law *law, pel_volume_kind kind, const tetra_lanes *in,
                           pel_lane gradient[UNKNOWNS])
{
    pel_lane3 f[3], stress[3];
    pel_tetra_columns(&in->at_rest, in->x, f);
    const pel_lane energy = in->scale * pel_tetra_stress(law, kind, f, stress);
    for (int k = 0; k < 4; k++) {
        const pel_lane3 row = pel_lane3_scale(pel_tetra_row(stress, in->at_rest.corner[k]), in->scale);
        gradient[3 * k] = row.x;
        gradient[3 * k + 1] = row.y;
        gradient[3 * k + 2] = row.z;
    }
    return energy;
}

#define PEL_STRAIN(KIND, name, word)                                                                                   \
    case PEL_VOLUME_##KIND:                                                                                            \
        return strain(law, PEL_VOLUME_##KIND, in, gradient);

static pel_lane strain_of(const pel_solid_law *law, const tetra_lanes *in, pel_lane gradient[UNKNOWNS])
{
    switch (law->kind) {
        PEL_VOLUME_LAWS(PEL_STRAIN)
    }
    return pel_lane_splat(0);
}

void pel_tangent_tetrahedra(const pel_tangent_loop *loop, const pel_tangent_part *part, const int32_t *tetrahedra,
                            int32_t count, double *gradients, pel_tangent_energy *energy)
{
    const pel_solid_law law = loop->tangent->shells[part->shell].shell->solid;
    for (int32_t first = 0; first < count; first += LANES) {
        const int lanes = count - first < LANES ? count - first : LANES;
        int32_t t[LANES];
        tetra_lanes in;
        pel_lane gradient[UNKNOWNS];
        for (int l = 0; l < LANES; l++)
            t[l] = tetrahedra[first + (l < lanes ? l : 0)];
        load(loop, part, t, &in);
        const pel_lane sum = strain_of(&law, &in, gradient);
        if (gradients != NULL)
            pel_tangent_scatter(gradient, UNKNOWNS, lanes, gradients + (size_t)first * UNKNOWNS, UNKNOWNS);
        for (int l = 0; l < lanes; l++)
            energy->volume += pel_tangent_lane(&sum, l);
    }
}
