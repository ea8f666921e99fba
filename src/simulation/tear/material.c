#include "tear/material.h"

#include "math/functions.h"
#include "model/quantity.h"

#include <math.h>

/* of a mesh of springs (van Gelder 1998) */
#define SPRING_POISSON (1.0 / 3)

static const pel_body_def *def_of(const pel_sim *sim, int32_t body)
{
    return &sim->given->def.bodies[body];
}

static const pel_quantity *toughness_of(const pel_body_def *def)
{
    return def->shell.membrane.on ? &def->shell.membrane.toughness : &def->spring_toughness;
}

static const pel_quantity *strength_of(const pel_body_def *def)
{
    return def->shell.membrane.on ? &def->shell.membrane.strength : &def->spring_strength;
}

static bool is_given(const pel_quantity *quantity)
{
    return quantity->value > 0 || quantity->field != NULL;
}

bool pel_body_can_tear(const pel_sim *sim, int32_t body)
{
    return is_given(toughness_of(def_of(sim, body)));
}

bool pel_tear_may_start(const pel_sim *sim, int32_t body)
{
    return pel_body_can_tear(sim, body) && sim->def.tear.start != PEL_TEAR_NONE;
}

bool pel_body_has_strength(const pel_sim *sim, int32_t body)
{
    return is_given(strength_of(def_of(sim, body)));
}

double pel_tear_thickness(const pel_sim *sim, int32_t body, int32_t vertex)
{
    const pel_body_def *def = def_of(sim, body);
    if (def->shell.membrane.on)
        return pel_quantity_at(&def->shell.membrane.thickness, vertex);
    return def->spring_thickness > 0 ? def->spring_thickness : (double)NAN;
}

double pel_tear_resistance(const pel_sim *sim, int32_t body, int32_t vertex)
{
    return pel_quantity_at(toughness_of(def_of(sim, body)), vertex) * pel_tear_thickness(sim, body, vertex);
}

double pel_tear_strength(const pel_sim *sim, int32_t body, int32_t vertex)
{
    return pel_quantity_at(strength_of(def_of(sim, body)), vertex);
}

static const pel_quantity *young_of(const pel_body_def *def)
{
    return def->shell.membrane.on ? &def->shell.membrane.young : &def->spring_stiffness;
}

double pel_tear_stiffness(const pel_sim *sim, int32_t body, int32_t vertex)
{
    return pel_quantity_at(young_of(def_of(sim, body)), vertex) * pel_tear_thickness(sim, body, vertex);
}

double pel_tear_length(const pel_sim *sim, int32_t body, int32_t vertex)
{
    const pel_body_def *def = def_of(sim, body);
    double strength = pel_tear_strength(sim, body, vertex);
    return pel_quantity_at(young_of(def), vertex) * pel_quantity_at(toughness_of(def), vertex) /
           (3.141592653589793 * strength * strength);
}

double pel_tear_thinning(const pel_sim *sim, int32_t body, double area_ratio)
{
    const pel_body_def *def = def_of(sim, body);
    double poisson = def->shell.membrane.on ? def->shell.membrane.poisson : SPRING_POISSON;
    return pel_pow(area_ratio, -poisson / (1 - poisson));
}
