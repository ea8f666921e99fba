#include "contact/layer.h"

#include "math/functions.h"

/* 1/2 m v^2 = 1/2 k (h / 2)^2 */
#define ABSORB 4.0
/* of mass / dt^2 */
#define STIFF 1000.0

double pel_contact_layer_compliance(const pel_contact_layer *layer, double mass, double speed, double dt)
{
    double rate = speed / layer->thickness, needed = ABSORB * rate * rate;
    double hardness = layer->hardness > 0 ? layer->hardness : STIFF / (dt * dt);
    return 1 / (mass * (hardness > needed ? hardness : needed));
}

/* A load in units of thickness / compliance [N], as far as the law goes, and what is beyond on its tangent. With u this
   load x = depth / thickness is u / (1 + u). */
typedef struct scaled {
    double unit, u, beyond;
} scaled;

static scaled scale(double compliance, double thickness, double load)
{
    double unit = thickness / compliance, u = load / unit, most = PEL_LAYER_STRAIN / (1 - PEL_LAYER_STRAIN);
    return (scaled){unit, u < most ? u : most, u < most ? 0 : u - most};
}

pel_layer_state pel_contact_layer_state(double compliance, double thickness, double load)
{
    if (!(compliance > 0) || !(load > 0))
        return (pel_layer_state){0, compliance};
    const scaled at = scale(compliance, thickness, load);
    double left = 1 / (1 + at.u), square = left * left;
    return (pel_layer_state){thickness * (at.u * left + square * at.beyond), compliance * square};
}

double pel_contact_layer_load(double compliance, double thickness, double depth)
{
    double x = depth / thickness, inside = x < PEL_LAYER_STRAIN ? x : PEL_LAYER_STRAIN, left = 1 - inside;
    return depth > 0 && compliance > 0 ? thickness / compliance * (inside / left + (x - inside) / (left * left)) : 0;
}

/* of the law unit thickness (-x - ln(1 - x)), with 1 - x = 1 / (1 + u) */
double pel_contact_layer_energy(double compliance, double thickness, double load)
{
    if (!(compliance > 0) || !(load > 0))
        return 0;
    const scaled at = scale(compliance, thickness, load);
    double left = 1 / (1 + at.u), inside = pel_ln(1 + at.u) - at.u * left;
    return at.unit * thickness * (inside + left * left * at.beyond * (at.u + 0.5 * at.beyond));
}
