#include "sim/parameter_table.h"

#include "geom/solid.h"
#include "law/membrane.h"
#include "model/bending_model.h"
#include "stage/stepper.h"

#include <math.h>

#define NUMBER .kind = PEL_PARAMETER_NUMBER, .store = PEL_STORE_DOUBLE
#define QUANTITY .kind = PEL_PARAMETER_NUMBER, .store = PEL_STORE_QUANTITY
#define INTEGER .kind = PEL_PARAMETER_INTEGER, .store = PEL_STORE_INT
#define SWITCH .kind = PEL_PARAMETER_SWITCH, .store = PEL_STORE_BOOL
#define VECTOR .kind = PEL_PARAMETER_VECTOR, .store = PEL_STORE_DOUBLE, ANY
#define FACTOR .kind = PEL_PARAMETER_NUMBER, .store = PEL_STORE_KEYS, .may_be_keyed = true, ANY
#define WORDS(...)                                                                                                     \
    .words = (const char *const[])                                                                                     \
    {                                                                                                                  \
        __VA_ARGS__, NULL                                                                                              \
    }
#define WORD(...) .kind = PEL_PARAMETER_WORD, WORDS(__VA_ARGS__)
#define KEYED .may_be_keyed = true
#define AUTO(value) .may_be_auto = true, .automatic = value

#define POSITIVE .is_open = true, .least = 0, .most = (double)HUGE_VAL
#define AT_LEAST(low) .least = low, .most = (double)HUGE_VAL
#define BETWEEN(low, high) .least = low, .most = high
#define COUNT_FROM(low) BETWEEN(low, INT32_MAX)
#define ANY BETWEEN(-(double)HUGE_VAL, (double)HUGE_VAL)

#define OF(owner_name, def, member) .owner = PEL_OWNER_##owner_name, .offset = offsetof(def, member)
#define BODY(member) OF(BODY, pel_body_def, member)
#define REGION(member) OF(REGION, pel_anisotropy_def, member)
#define SUPPORT(member) OF(SUPPORT, pel_support_def, member)
#define LOAD(member) OF(LOAD, pel_load_def, member)
#define TOOL(member) OF(TOOL, pel_tool_def, member)
#define CONTACT(member) OF(CONTACT, pel_contact_def, member)
#define SOLVER(member) OF(SOLVER, pel_solver_def, member)

#define REFUSED(why, instead) .refusal = why, .remedy = instead
#define STRUCTURE(why) REFUSED(why, "make a simulation with the new value, and set positions and velocities in it")

/* ---- members of defs ---- */

static bool is_per_vertex(const void *def)
{
    return ((const pel_body_def *)def)->mass_kind == PEL_MASS_PER_VERTEX;
}

static bool is_total(const void *def)
{
    return ((const pel_body_def *)def)->mass_kind == PEL_MASS_TOTAL;
}

static bool is_density(const void *def)
{
    return ((const pel_body_def *)def)->mass_kind == PEL_MASS_DENSITY;
}

static bool has_spring_young(const void *def)
{
    return ((const pel_body_def *)def)->spring_thickness > 0;
}

static bool has_spring_stiffness(const void *def)
{
    return !has_spring_young(def);
}

static bool has_filling_young(const void *def)
{
    return ((const pel_body_def *)def)->volumetric_depth > 0;
}

static bool has_filling_stiffness(const void *def)
{
    return !has_filling_young(def);
}

static bool has_membrane(const void *def)
{
    return ((const pel_body_def *)def)->shell.membrane.on;
}

static bool reads(const void *def, pel_law_trait number)
{
    return has_membrane(def) &&
           (pel_membrane_law_traits(((const pel_body_def *)def)->shell.membrane.kind) & (int)number) != 0;
}

static bool reads_poisson(const void *def)
{
    return reads(def, PEL_LAW_READS_POISSON);
}

static bool reads_mooney_ratio(const void *def)
{
    return reads(def, PEL_LAW_READS_MOONEY_RATIO);
}

static bool reads_extension_limit(const void *def)
{
    return reads(def, PEL_LAW_READS_EXTENSION_LIMIT);
}

static bool reads_stiffening(const void *def)
{
    return reads(def, PEL_LAW_READS_STIFFENING);
}

static bool has_bending(const void *def)
{
    return ((const pel_body_def *)def)->shell.bending.model != PEL_BENDING_NONE;
}

static bool is_pressed(const void *def)
{
    return ((const pel_body_def *)def)->shell.pressure.kind == PEL_PRESSURE_GIVEN;
}

static bool is_gas(const void *def)
{
    return ((const pel_body_def *)def)->shell.pressure.kind == PEL_PRESSURE_GAS;
}

static bool has_target(const void *def)
{
    return ((const pel_body_def *)def)->shell.pressure.kind == PEL_PRESSURE_VOLUME;
}

static bool has_foundation(const void *def)
{
    return ((const pel_support_def *)def)->foundation > 0;
}

static bool has_pressure(const void *def)
{
    return ((const pel_body_def *)def)->shell.pressure.kind != PEL_PRESSURE_NONE;
}

static bool refines(const void *def)
{
    return ((const pel_body_def *)def)->refine.levels > 0;
}

static bool looks_at_force(const void *def)
{
    return refines(def) && ((const pel_body_def *)def)->refine.above > 0;
}

static bool looks_at_curvature(const void *def)
{
    return refines(def) && ((const pel_body_def *)def)->refine.curvature_above > 0;
}

static bool caves(const void *def)
{
    return ((const pel_anisotropy_def *)def)->mode == PEL_FIBRE_CAVE;
}

static bool is_active(const void *def)
{
    return ((const pel_anisotropy_def *)def)->mode == PEL_FIBRE_ACTIVE;
}

static bool curls(const void *def)
{
    return ((const pel_anisotropy_def *)def)->mode == PEL_FIBRE_CURL;
}

static bool has_fibres(const void *def)
{
    return !curls(def);
}

static bool has_radius(const void *def)
{
    return pel_solid_rows[((const pel_tool_def *)def)->shape].has_radius;
}

static bool has_length(const void *def)
{
    return pel_solid_rows[((const pel_tool_def *)def)->shape].has_length;
}

static bool has_size(const void *def)
{
    return pel_solid_rows[((const pel_tool_def *)def)->shape].has_size;
}

static bool is_instrument(const void *def)
{
    return ((const pel_tool_def *)def)->shape != PEL_TOOL_SUPPORT;
}

static bool grasps(const void *def)
{
    return ((const pel_tool_def *)def)->grasp;
}

static bool is_enabled(const void *def)
{
    return ((const pel_contact_def *)def)->enabled;
}

static const pel_stepper *stepper_of(const void *def)
{
    return pel_stepper_of(((const pel_solver_def *)def)->method);
}

static bool relaxes(const void *def)
{
    return stepper_of(def)->relaxes;
}

static bool is_explicit(const void *def)
{
    return stepper_of(def)->is_explicit;
}

static bool is_compliant(const void *def)
{
    return stepper_of(def)->is_compliant;
}

static bool has_substeps(const void *def)
{
    return stepper_of(def)->has_substeps;
}

static bool has_drag(const void *def)
{
    return has_substeps(def) || is_explicit(def);
}

static bool descends(const void *def)
{
    return stepper_of(def)->descends;
}

static bool iterates(const void *def)
{
    return has_substeps(def) || descends(def);
}

/* ---- the table ---- */

static const pel_parameter_row rows[] = {
    {"bodies[].mass.per_vertex", BODY(mass), NUMBER, .unit = "kg", POSITIVE, .applies = is_per_vertex},
    {"bodies[].mass.total", BODY(mass), NUMBER, .unit = "kg", POSITIVE, .applies = is_total},
    {"bodies[].mass.density", BODY(mass), NUMBER, .unit = "kg/m3", POSITIVE, .applies = is_density},
    {"bodies[].mass.thickness", BODY(thickness), QUANTITY, .unit = "m", POSITIVE, .applies = is_density,
     .is_implying = true},
    {"bodies[].springs.young", BODY(spring_stiffness), QUANTITY, .unit = "Pa", AT_LEAST(0), KEYED,
     .applies = has_spring_young, .is_implying = true},
    {"bodies[].springs.thickness", BODY(spring_thickness), NUMBER, .unit = "m", POSITIVE, .applies = has_spring_young},
    {"bodies[].springs.drag", BODY(spring_damping), QUANTITY, .unit = "1/s", AT_LEAST(0), KEYED,
     .applies = has_spring_young},
    {"bodies[].springs.stiffness", BODY(spring_stiffness), QUANTITY, .unit = "N/m", AT_LEAST(0), KEYED,
     .applies = has_spring_stiffness},
    {"bodies[].springs.damping", BODY(spring_damping), QUANTITY, .unit = "N s/m", AT_LEAST(0), KEYED,
     .applies = has_spring_stiffness},
    {"bodies[].contact.friction", BODY(friction), NUMBER, AT_LEAST(0), AUTO(-1)},
    {"bodies[].contact.thickness", BODY(contact_thickness), NUMBER, .unit = "m", POSITIVE, AUTO(-1)},
    {"bodies[].contact.restitution", BODY(restitution), NUMBER, BETWEEN(0, 1), AUTO(-1)},
    {"bodies[].volumetric.young", BODY(volumetric_stiffness), QUANTITY, .unit = "Pa", AT_LEAST(0), KEYED,
     .applies = has_filling_young},
    {"bodies[].volumetric.depth", BODY(volumetric_depth), NUMBER, .unit = "m", POSITIVE, .applies = has_filling_young},
    {"bodies[].volumetric.drag", BODY(volumetric_damping), QUANTITY, .unit = "1/s", AT_LEAST(0), KEYED,
     .applies = has_filling_young},
    {"bodies[].volumetric.stiffness", BODY(volumetric_stiffness), QUANTITY, .unit = "N/m", AT_LEAST(0), KEYED,
     .applies = has_filling_stiffness},
    {"bodies[].volumetric.damping", BODY(volumetric_damping), QUANTITY, .unit = "N s/m", AT_LEAST(0), KEYED,
     .applies = has_filling_stiffness},
    {"bodies[].scale_with_area", BODY(volumetric_by_area), SWITCH, BETWEEN(0, 1)},
    {"bodies[].reference_count", BODY(reference_count), INTEGER, COUNT_FROM(1)},
    {"bodies[].membrane.material", BODY(shell.membrane.kind), .kind = PEL_PARAMETER_WORD, .store = PEL_STORE_INT,
     .words = pel_membrane_words, .applies = has_membrane, .is_implying = true},
    {"bodies[].membrane.young", BODY(shell.membrane.young), QUANTITY, .unit = "Pa", POSITIVE, .applies = has_membrane,
     .is_implying = true},
    {"bodies[].membrane.poisson", BODY(shell.membrane.poisson), NUMBER, .is_open = true, BETWEEN(-1, 1),
     .applies = reads_poisson},
    {"bodies[].membrane.thickness", BODY(shell.membrane.thickness), QUANTITY, .unit = "m", POSITIVE,
     .applies = has_membrane, .is_implying = true},
    {"bodies[].membrane.mooney_ratio", BODY(shell.membrane.mooney_ratio), NUMBER, AT_LEAST(0),
     .applies = reads_mooney_ratio},
    {"bodies[].membrane.extension_limit", BODY(shell.membrane.extension_limit), NUMBER, POSITIVE,
     .applies = reads_extension_limit},
    {"bodies[].membrane.stiffening", BODY(shell.membrane.stiffening), NUMBER, POSITIVE, .applies = reads_stiffening},
    {"bodies[].membrane.strain_limit", BODY(shell.membrane.strain_limit), NUMBER, .is_open = true, BETWEEN(0, 0.99),
     AUTO(0), .applies = has_membrane},
    {"bodies[].bending.model", BODY(shell.bending.model), .store = PEL_STORE_INT, .kind = PEL_PARAMETER_WORD,
     .words = pel_bending_words, .applies = has_bending,
     STRUCTURE("the model of bending decides what elements there are")},
    {"bodies[].bending.weight", BODY(shell.bending.weight), NUMBER, BETWEEN(0, 1), AUTO(-1), .applies = has_bending},
    {"bodies[].bending.stiffness", BODY(shell.bending.stiffness), QUANTITY, .unit = "N m", AT_LEAST(0), AUTO(-1),
     .applies = has_bending},
    {"bodies[].pressure.outside", BODY(shell.pressure.outside), QUANTITY, .unit = "Pa", ANY, KEYED,
     .applies = is_pressed},
    {"bodies[].pressure.inside", BODY(shell.pressure.outside), QUANTITY, .unit = "Pa", ANY, KEYED, .factor = -1,
     .applies = is_pressed},
    {"bodies[].pressure.gas.pressure", BODY(shell.pressure.value), NUMBER, .unit = "Pa", POSITIVE, .applies = is_gas},
    {"bodies[].pressure.gas.gamma", BODY(shell.pressure.gamma), NUMBER, BETWEEN(1, 10), .applies = is_gas},
    {"bodies[].pressure.gas.outside", BODY(shell.pressure.outside), QUANTITY, .unit = "Pa", ANY, KEYED,
     .applies = is_gas},
    {"bodies[].pressure.volume.target", BODY(shell.pressure.target), QUANTITY, AT_LEAST(0), KEYED,
     .applies = has_target},
    {"bodies[].pressure.volume.bulk", BODY(shell.pressure.bulk), NUMBER, .unit = "Pa", POSITIVE, .applies = has_target},
    {"bodies[].pressure.volume.outside", BODY(shell.pressure.outside), QUANTITY, .unit = "Pa", ANY, KEYED,
     .applies = has_target},
    {"bodies[].pressure.form", BODY(shell.pressure.form), .store = PEL_STORE_INT, WORD("consistent", "vertex-normal"),
     .applies = has_pressure},
    {"bodies[].refine.levels", BODY(refine.levels), INTEGER, BETWEEN(1, 6), .applies = refines,
     STRUCTURE("the levels of detail are made once")},
    {"bodies[].refine.everywhere", BODY(refine.everywhere), SWITCH, BETWEEN(0, 1), .applies = refines,
     STRUCTURE("it decides which triangles there are from the start")},
    {"bodies[].refine.above", BODY(refine.above), NUMBER, .unit = "N/m2", POSITIVE, .applies = looks_at_force,
     .is_implying = true},
    {"bodies[].refine.below", BODY(refine.below), NUMBER, .unit = "N/m2", AT_LEAST(0), .applies = looks_at_force},
    {"bodies[].refine.curvature.above", BODY(refine.curvature_above), NUMBER, .unit = "1/m", POSITIVE,
     .applies = looks_at_curvature, .is_implying = true},
    {"bodies[].refine.curvature.below", BODY(refine.curvature_below), NUMBER, .unit = "1/m", AT_LEAST(0),
     .applies = looks_at_curvature},
    {"bodies[].refine.near_tools", BODY(refine.near_tools), NUMBER, .unit = "m", POSITIVE, AUTO(0), .applies = refines},
    {"bodies[].refine.rings", BODY(refine.rings), INTEGER, BETWEEN(1, 3), .applies = refines},
    {"bodies[].refine.dwell", BODY(refine.dwell), INTEGER, COUNT_FROM(0), .applies = refines},
    {"bodies[].refine.interval", BODY(refine.interval), INTEGER, COUNT_FROM(1), .applies = refines},
    {"bodies[].refine.budget", BODY(refine.budget), INTEGER, COUNT_FROM(0), .applies = refines},
    {"bodies[].refine.springs", BODY(refine.springs), .store = PEL_STORE_INT, WORD("van-gelder", "unchanged"),
     .applies = refines},

    {"bodies[].anisotropy[].stiffness", REGION(stiffness), NUMBER, .unit = "N/m", POSITIVE, .applies = has_fibres},
    {"bodies[].anisotropy[].strength", REGION(strength), NUMBER, .unit = "m", POSITIVE, .applies = caves},
    {"bodies[].anisotropy[].max_step", REGION(max_step), NUMBER, BETWEEN(0, 1), .applies = caves},
    {"bodies[].anisotropy[].rest_length", REGION(rest_length), QUANTITY, AT_LEAST(0), KEYED, .applies = is_active},
    {"bodies[].anisotropy[].curvature", REGION(curvature), NUMBER, ANY, .applies = curls},

    {"bodies[].supports[].displacement", SUPPORT(displacement), VECTOR, .unit = "m"},
    {"bodies[].supports[].keys", SUPPORT(keys), FACTOR, .count_offset = offsetof(pel_support_def, key_count)},
    {"bodies[].supports[].foundation", SUPPORT(foundation), NUMBER, .unit = "N/m3", POSITIVE,
     .applies = has_foundation},
    {"bodies[].supports[].stiffness", SUPPORT(stiffness), NUMBER, .unit = "N/m", POSITIVE, AUTO(0)},

    {"gravity", OF(MODEL, pel_model_def, gravity), VECTOR, .unit = "m/s2"},

    {"loads[].force", LOAD(force), VECTOR, .unit = "N", .is_direct = true},
    {"loads[].from", LOAD(from), NUMBER, .unit = "s", AT_LEAST(0), .is_direct = true, .is_implying = true},
    {"loads[].until", LOAD(until), NUMBER, .unit = "s", POSITIVE, AUTO((double)HUGE_VAL), .is_direct = true,
     .is_implying = true},
    {"loads[].keys", LOAD(keys), FACTOR, .count_offset = offsetof(pel_load_def, key_count)},

    {"tools[].radius", TOOL(radius), NUMBER, .unit = "m", POSITIVE, .applies = has_radius},
    {"tools[].length", TOOL(half_length), NUMBER, .unit = "m", POSITIVE, .factor = 2, .applies = has_length},
    {"tools[].size", TOOL(half_extents), .kind = PEL_PARAMETER_VECTOR, .store = PEL_STORE_DOUBLE, .unit = "m", POSITIVE,
     .factor = 2, .applies = has_size},
    {"tools[].friction", TOOL(friction), NUMBER, AT_LEAST(0), AUTO(-1), .applies = is_instrument},
    {"tools[].thickness", TOOL(thickness), NUMBER, .unit = "m", POSITIVE, AUTO(-1), .applies = is_instrument},
    {"tools[].restitution", TOOL(restitution), NUMBER, BETWEEN(0, 1), AUTO(-1), .applies = is_instrument},
    {"tools[].press", TOOL(press), SWITCH, BETWEEN(0, 1), .applies = is_instrument},
    {"tools[].grasp.from", TOOL(grasp_from), NUMBER, .unit = "s", AT_LEAST(0), .applies = grasps, .is_direct = true,
     .is_implying = true},
    {"tools[].grasp.until", TOOL(grasp_until), NUMBER, .unit = "s", POSITIVE, AUTO((double)HUGE_VAL), .applies = grasps,
     .is_direct = true, .is_implying = true},
    {"tools[].grasp.reach", TOOL(reach), NUMBER, .unit = "m", POSITIVE, .applies = grasps, .is_direct = true},
    {"tools[].grasp.max_force", TOOL(grasp_max_force), NUMBER, .unit = "N", POSITIVE, AUTO(0), .applies = grasps,
     .is_direct = true},

    {"contact.self", CONTACT(self), SWITCH, BETWEEN(0, 1), .applies = is_enabled,
     STRUCTURE("parts that touch or intersect by now would be pushed apart at once")},
    {"contact.between", CONTACT(between), SWITCH, BETWEEN(0, 1), .applies = is_enabled,
     STRUCTURE("bodies that touch or intersect by now would be pushed apart at once")},
    {"contact.thickness", CONTACT(thickness), NUMBER, .unit = "m", POSITIVE, AUTO(0), .applies = is_enabled},
    {"contact.friction", CONTACT(friction), NUMBER, AT_LEAST(0), .applies = is_enabled},
    {"contact.restitution", CONTACT(restitution), NUMBER, BETWEEN(0, 1), AUTO(-1), .applies = is_enabled},
    {"contact.method", CONTACT(method), .store = PEL_STORE_INT, WORD("conservative", "bridson"), .applies = is_enabled},
    {"contact.response", CONTACT(response), .store = PEL_STORE_INT, WORD("in-loop", "after"), .applies = is_enabled},
    {"contact.sweeps", CONTACT(sweeps), INTEGER, COUNT_FROM(1), AUTO(0), .applies = is_enabled},
    {"contact.limit", CONTACT(limit), INTEGER, COUNT_FROM(0), .applies = is_enabled},

    {"solver.method", SOLVER(method), .store = PEL_STORE_INT, .kind = PEL_PARAMETER_WORD, .words = pel_method_words,
     STRUCTURE("the method decides what the state holds")},
    {"solver.dt", SOLVER(dt), NUMBER, .unit = "s", POSITIVE,
     REFUSED("time is counted in steps of dt", "change substeps, or make a simulation with the new dt")},
    {"solver.alpha", SOLVER(alpha), NUMBER, POSITIVE, AUTO(0), .applies = relaxes},
    {"solver.velocity", SOLVER(keep_velocity), .store = PEL_STORE_BOOL, WORD("ignore", "keep"), .applies = relaxes},
    {"solver.integrator", SOLVER(symplectic), .store = PEL_STORE_BOOL, WORD("forward", "symplectic"),
     .applies = is_explicit, STRUCTURE("velocities of the two belong to different times")},
    {"solver.iterations", SOLVER(iterations), INTEGER, COUNT_FROM(1), AUTO(0), .applies = iterates},
    {"solver.substeps", SOLVER(substeps), INTEGER, COUNT_FROM(1), AUTO(0), .applies = has_substeps},
    {"solver.max_substeps", SOLVER(max_substeps), INTEGER, COUNT_FROM(1), AUTO(0), .applies = is_compliant},
    {"solver.second_order", SOLVER(second_order), .store = PEL_STORE_INT, WORD("false", "true"), AUTO(PEL_AUTO),
     .applies = is_compliant, STRUCTURE("the two remember different states")},
    {"solver.drag", SOLVER(drag), NUMBER, .unit = "1/s", AT_LEAST(0), .applies = has_drag},
    {"solver.descent", SOLVER(gradient_only), .store = PEL_STORE_BOOL, WORD("lbfgs", "gradient"), .applies = descends},
};

const pel_parameter_row *pel_parameter_row_at(int32_t index)
{
    return index >= 0 && (size_t)index < sizeof rows / sizeof *rows ? &rows[index] : NULL;
}
