#include "model/fingerprint.h"

#include "base/hash.h"

#include <stdio.h>

/* ---- tables: every member of a def has a row (house/fingerprint) ---- */

#define SIZE_OF(def, name) sizeof((def *)NULL)->name
#define PLAIN(def, name, PART)                                                                                         \
    {                                                                                                                  \
        PEL_PART_##PART, PEL_MEMBER_PLAIN, offsetof(def, name), SIZE_OF(def, name), NULL, 0                            \
    }
#define DEF(def, name, PART, members)                                                                                  \
    {                                                                                                                  \
        PEL_PART_##PART, PEL_MEMBER_DEF, offsetof(def, name), 0, members, 0                                            \
    }
#define LIST(def, name, PART, count)                                                                                   \
    {                                                                                                                  \
        PEL_PART_##PART, PEL_MEMBER_LIST, offsetof(def, name), SIZE_OF(def, name[0]), NULL, offsetof(def, count)       \
    }
#define DEFS(def, name, PART, count, members)                                                                          \
    {                                                                                                                  \
        PEL_PART_##PART, PEL_MEMBER_LIST, offsetof(def, name), SIZE_OF(def, name[0]), members, offsetof(def, count)    \
    }
#define FIELD(def, name, PART)                                                                                         \
    {                                                                                                                  \
        PEL_PART_##PART, PEL_MEMBER_FIELD, offsetof(def, name), 0, NULL, 0                                             \
    }
#define MESH(def, name, PART)                                                                                          \
    {                                                                                                                  \
        PEL_PART_##PART, PEL_MEMBER_MESH, offsetof(def, name), 0, NULL, 0                                              \
    }
#define TEXT(def, name)                                                                                                \
    {                                                                                                                  \
        PEL_PART_SAME, PEL_MEMBER_TEXT, offsetof(def, name), 0, NULL, 0                                                \
    }
#define OTHER(def, name)                                                                                               \
    {                                                                                                                  \
        PEL_PART_SAME, PEL_MEMBER_OTHER, offsetof(def, name), 0, NULL, 0                                               \
    }
#define END                                                                                                            \
    {                                                                                                                  \
        PEL_PART_SAME, PEL_MEMBER_END, 0, 0, NULL, 0                                                                   \
    }

_Static_assert(sizeof(pel_key) == 2 * sizeof(double) && sizeof(pel_pose_key) == 11 * sizeof(double), "keys are plain");

static const pel_member quantity[] = {
    PLAIN(pel_quantity, value, SAME),
    FIELD(pel_quantity, field, SAME),
    LIST(pel_quantity, keys, SAME, key_count),
    OTHER(pel_quantity, key_count),
    END,
};

static const pel_member membrane[] = {
    PLAIN(pel_membrane_def, on, SAME),
    PLAIN(pel_membrane_def, kind, SAME),
    DEF(pel_membrane_def, young, SAME, quantity),
    PLAIN(pel_membrane_def, poisson, SAME),
    DEF(pel_membrane_def, thickness, SAME, quantity),
    PLAIN(pel_membrane_def, mooney_ratio, SAME),
    PLAIN(pel_membrane_def, extension_limit, SAME),
    PLAIN(pel_membrane_def, stiffening, SAME),
    PLAIN(pel_membrane_def, strain_limit, SAME),
    END,
};

static const pel_member bending[] = {
    PLAIN(pel_bending_def, model, SAME),
    PLAIN(pel_bending_def, weight, SAME),
    DEF(pel_bending_def, stiffness, SAME, quantity),
    END,
};

static const pel_member anisotropy[] = {
    PLAIN(pel_anisotropy_def, mode, SAME),      PLAIN(pel_anisotropy_def, kind, SAME),
    PLAIN(pel_anisotropy_def, stiffness, SAME), PLAIN(pel_anisotropy_def, strength, SAME),
    PLAIN(pel_anisotropy_def, max_step, SAME),  DEF(pel_anisotropy_def, rest_length, SAME, quantity),
    PLAIN(pel_anisotropy_def, curvature, SAME), PLAIN(pel_anisotropy_def, direction, SAME),
    PLAIN(pel_anisotropy_def, axis, SAME),      PLAIN(pel_anisotropy_def, center, SAME),
    FIELD(pel_anisotropy_def, weights, SAME),   END,
};

static const pel_member pressure[] = {
    PLAIN(pel_pressure_def, kind, SAME),
    PLAIN(pel_pressure_def, form, SAME),
    DEF(pel_pressure_def, outside, SAME, quantity),
    PLAIN(pel_pressure_def, value, SAME),
    PLAIN(pel_pressure_def, gamma, SAME),
    DEF(pel_pressure_def, target, SAME, quantity),
    PLAIN(pel_pressure_def, bulk, SAME),
    FIELD(pel_pressure_def, weights, SAME),
    END,
};

static const pel_member shell[] = {
    DEF(pel_shell_def, membrane, MEMBRANE, membrane),
    DEF(pel_shell_def, bending, BENDING, bending),
    DEFS(pel_shell_def, anisotropies, ANISOTROPY, anisotropy_count, anisotropy),
    OTHER(pel_shell_def, anisotropy_count),
    DEF(pel_shell_def, pressure, PRESSURE, pressure),
    END,
};

static const pel_member refinement[] = {
    PLAIN(pel_refine_def, levels, SAME),
    PLAIN(pel_refine_def, everywhere, SAME),
    PLAIN(pel_refine_def, above, SAME),
    PLAIN(pel_refine_def, below, SAME),
    PLAIN(pel_refine_def, curvature_above, SAME),
    PLAIN(pel_refine_def, curvature_below, SAME),
    PLAIN(pel_refine_def, near_tools, SAME),
    LIST(pel_refine_def, region, SAME, region_count),
    OTHER(pel_refine_def, region_count),
    PLAIN(pel_refine_def, region_levels, SAME),
    PLAIN(pel_refine_def, rings, SAME),
    PLAIN(pel_refine_def, dwell, SAME),
    PLAIN(pel_refine_def, interval, SAME),
    PLAIN(pel_refine_def, budget, SAME),
    PLAIN(pel_refine_def, springs, SAME),
    OTHER(pel_refine_def, memory_limit),
    END,
};

const pel_member pel_body_members[] = {
    TEXT(pel_body_def, name),
    MESH(pel_body_def, mesh, MESH),
    PLAIN(pel_body_def, mass_kind, MASS),
    PLAIN(pel_body_def, mass, MASS),
    DEF(pel_body_def, thickness, MASS, quantity),
    DEF(pel_body_def, spring_stiffness, SPRINGS, quantity),
    DEF(pel_body_def, spring_damping, SPRINGS, quantity),
    DEF(pel_body_def, volumetric_stiffness, VOLUMETRIC, quantity),
    DEF(pel_body_def, volumetric_damping, VOLUMETRIC, quantity),
    PLAIN(pel_body_def, volumetric_by_area, VOLUMETRIC),
    PLAIN(pel_body_def, reference_count, VOLUMETRIC),
    PLAIN(pel_body_def, spring_thickness, SPRINGS),
    PLAIN(pel_body_def, volumetric_depth, VOLUMETRIC),
    LIST(pel_body_def, pinned, PINS, pinned_count),
    OTHER(pel_body_def, pinned_count),
    PLAIN(pel_body_def, velocity, START),
    PLAIN(pel_body_def, angular_velocity, START),
    PLAIN(pel_body_def, friction, SURFACE),
    PLAIN(pel_body_def, restitution, SURFACE),
    PLAIN(pel_body_def, contact_thickness, SURFACE),
    DEF(pel_body_def, refine, REFINEMENT, refinement),
    DEF(pel_body_def, shell, SAME, shell),
    OTHER(pel_body_def, cookie),
    END,
};

const pel_member pel_model_members[] = {
    DEFS(pel_model_def, bodies, MESH, body_count, pel_body_members),
    OTHER(pel_model_def, body_count),
    PLAIN(pel_model_def, gravity, GRAVITY),
    OTHER(pel_model_def, cookie),
    END,
};

static const pel_member solver[] = {
    PLAIN(pel_solver_def, method, SAME),
    PLAIN(pel_solver_def, dt, SAME),
    PLAIN(pel_solver_def, alpha, SAME),
    PLAIN(pel_solver_def, keep_velocity, SAME),
    PLAIN(pel_solver_def, symplectic, SAME),
    PLAIN(pel_solver_def, iterations, SAME),
    PLAIN(pel_solver_def, substeps, SAME),
    PLAIN(pel_solver_def, max_substeps, SAME),
    PLAIN(pel_solver_def, second_order, SAME),
    PLAIN(pel_solver_def, drag, SAME),
    PLAIN(pel_solver_def, gradient_only, SAME),
    PLAIN(pel_solver_def, analysis, SAME),
    PLAIN(pel_solver_def, path, SAME),
    PLAIN(pel_solver_def, mode_count, SAME),
    OTHER(pel_solver_def, budget),
    END,
};

static const pel_member load[] = {
    TEXT(pel_load_def, name),
    PLAIN(pel_load_def, body, SAME),
    PLAIN(pel_load_def, kind, SAME),
    PLAIN(pel_load_def, force, SAME),
    PLAIN(pel_load_def, follower, SAME),
    LIST(pel_load_def, vertices, SAME, vertex_count),
    OTHER(pel_load_def, vertex_count),
    OTHER(pel_load_def, weights), /* one per vertex, and optional: loads.c adds them */
    PLAIN(pel_load_def, from, SAME),
    PLAIN(pel_load_def, until, SAME),
    LIST(pel_load_def, keys, SAME, key_count),
    OTHER(pel_load_def, key_count),
    END,
};

static const pel_member tool[] = {
    TEXT(pel_tool_def, name),
    PLAIN(pel_tool_def, shape, SAME),
    PLAIN(pel_tool_def, radius, SAME),
    PLAIN(pel_tool_def, half_length, SAME),
    PLAIN(pel_tool_def, half_extents, SAME),
    MESH(pel_tool_def, mesh, SAME),
    LIST(pel_tool_def, keys, SAME, key_count),
    OTHER(pel_tool_def, key_count),
    PLAIN(pel_tool_def, body, SAME),
    PLAIN(pel_tool_def, press, SAME),
    PLAIN(pel_tool_def, grasp, SAME),
    PLAIN(pel_tool_def, grasp_from, SAME),
    PLAIN(pel_tool_def, grasp_until, SAME),
    PLAIN(pel_tool_def, reach, SAME),
    PLAIN(pel_tool_def, friction, SAME),
    PLAIN(pel_tool_def, restitution, SAME),
    PLAIN(pel_tool_def, thickness, SAME),
    PLAIN(pel_tool_def, grasp_max_force, SAME),
    LIST(pel_tool_def, vertices, SAME, vertex_count),
    OTHER(pel_tool_def, vertex_count),
    PLAIN(pel_tool_def, center, SAME),
    END,
};

static const pel_member support[] = {
    TEXT(pel_support_def, name),
    PLAIN(pel_support_def, body, SAME),
    LIST(pel_support_def, vertices, SAME, vertex_count),
    OTHER(pel_support_def, vertex_count),
    PLAIN(pel_support_def, axes, SAME),
    PLAIN(pel_support_def, fix, SAME),
    PLAIN(pel_support_def, displacement, SAME),
    PLAIN(pel_support_def, foundation, SAME),
    LIST(pel_support_def, keys, SAME, key_count),
    OTHER(pel_support_def, key_count),
    PLAIN(pel_support_def, stiffness, SAME),
    PLAIN(pel_support_def, fix_rotation, SAME),
    END,
};

/* the limit of memory decides how much room the search for pairs gives */
static const pel_member contact[] = {
    PLAIN(pel_contact_def, enabled, SAME),
    PLAIN(pel_contact_def, self, SAME),
    PLAIN(pel_contact_def, between, SAME),
    PLAIN(pel_contact_def, thickness, SAME),
    PLAIN(pel_contact_def, relative_thickness, SAME),
    PLAIN(pel_contact_def, friction, SAME),
    PLAIN(pel_contact_def, restitution, SAME),
    PLAIN(pel_contact_def, method, SAME),
    PLAIN(pel_contact_def, response, SAME),
    PLAIN(pel_contact_def, allow_tangled, SAME),
    PLAIN(pel_contact_def, sweeps, SAME),
    PLAIN(pel_contact_def, limit, SAME),
    PLAIN(pel_contact_def, memory_limit, SAME),
    END,
};

const pel_member pel_sim_members[] = {
    OTHER(pel_sim_def, model),
    DEF(pel_sim_def, solver, SOLVER, solver),
    DEFS(pel_sim_def, loads, LOADS, load_count, load),
    OTHER(pel_sim_def, load_count),
    DEFS(pel_sim_def, tools, TOOLS, tool_count, tool),
    OTHER(pel_sim_def, tool_count),
    DEFS(pel_sim_def, supports, SUPPORTS, support_count, support),
    OTHER(pel_sim_def, support_count),
    DEF(pel_sim_def, contact, CONTACT, contact),
    OTHER(pel_sim_def, record_contacts),
    OTHER(pel_sim_def, thread_count),
    OTHER(pel_sim_def, wanted),
    OTHER(pel_sim_def, user),
    OTHER(pel_sim_def, stops_short_steps),
    OTHER(pel_sim_def, cookie),
    END,
};

/* ---- hashes ---- */

/* where a member is */
typedef struct place {
    pel_part part;
    const pel_mesh *mesh; /* of the body; null = none */
    bool skips_meshes;
} place;

void pel_fingerprint_add_bytes(pel_fingerprint *fingerprint, pel_part part, const void *bytes, size_t size)
{
    uint64_t *sum = &fingerprint->parts[part];
    *sum = pel_hash_block(*sum, bytes, size);
}

static void add_mesh(pel_fingerprint *fingerprint, pel_part part, const pel_mesh *mesh)
{
    pel_fingerprint_add_bytes(fingerprint, part, mesh->positions, (size_t)mesh->vertex_count * sizeof *mesh->positions);
    pel_fingerprint_add_bytes(fingerprint, part, mesh->triangles,
                              (size_t)mesh->triangle_count * sizeof *mesh->triangles);
}

static void add_members(pel_fingerprint *fingerprint, const pel_member *members, const char *def, place outer);

/* the target of a pointer of a def */
static void add_behind(pel_fingerprint *fingerprint, const pel_member *member, const char *def, place at)
{
    const char *pointer;
    int32_t count = 0;
    memcpy(&pointer, def + member->offset, sizeof pointer);
    unsigned char is_there = pointer != NULL;
    pel_fingerprint_add_bytes(fingerprint, at.part, &is_there, sizeof is_there);
    if (pointer == NULL)
        return;
    if (member->form == PEL_MEMBER_LIST) {
        memcpy(&count, def + member->count_offset, sizeof count);
        pel_fingerprint_add_bytes(fingerprint, at.part, &count, sizeof count);
    }
    if (member->form == PEL_MEMBER_MESH && at.skips_meshes)
        return;
    if (member->form == PEL_MEMBER_MESH)
        add_mesh(fingerprint, at.part, (const pel_mesh *)(const void *)pointer);
    else if (member->form == PEL_MEMBER_FIELD)
        pel_fingerprint_add_bytes(fingerprint, at.part, pointer, (size_t)at.mesh->vertex_count * sizeof(double));
    else if (member->members == NULL)
        pel_fingerprint_add_bytes(fingerprint, at.part, pointer, (size_t)count * member->size);
    for (int32_t i = 0; member->members != NULL && i < count; i++)
        add_members(fingerprint, member->members, pointer + (size_t)i * member->size, at);
}

static void add_members(pel_fingerprint *fingerprint, const pel_member *members, const char *def, place outer)
{
    if (members == pel_body_members)
        outer.mesh = ((const pel_body_def *)(const void *)def)->mesh;
    for (const pel_member *member = members; member->form != PEL_MEMBER_END; member++) {
        place at = {member->part == PEL_PART_SAME ? outer.part : member->part, outer.mesh, outer.skips_meshes};
        if (member->form == PEL_MEMBER_PLAIN)
            pel_fingerprint_add_bytes(fingerprint, at.part, def + member->offset, member->size);
        else if (member->form == PEL_MEMBER_DEF)
            add_members(fingerprint, member->members, def + member->offset, at);
        else if (member->form != PEL_MEMBER_OTHER && member->form != PEL_MEMBER_TEXT)
            add_behind(fingerprint, member, def, at);
    }
}

void pel_fingerprint_add(pel_fingerprint *fingerprint, const pel_member *members, const void *def)
{
    add_members(fingerprint, members, def, (place){PEL_PART_COUNT, NULL, false});
}

void pel_fingerprint_renew(pel_fingerprint *fingerprint, const void *def)
{
    uint64_t meshes = fingerprint->parts[PEL_PART_MESH];
    *fingerprint = (pel_fingerprint){0};
    add_members(fingerprint, pel_model_members, def, (place){PEL_PART_COUNT, NULL, true});
    fingerprint->parts[PEL_PART_MESH] = meshes;
}

const char *pel_fingerprint_compare(const pel_fingerprint *a, const pel_fingerprint *b, char *text, size_t size)
{
#define NAME(PART, name) name,
    static const char *const names[] = {PEL_PARTS(NAME)};
#undef NAME
    size_t length = 0;
    text[0] = '\0';
    for (int p = 0; p < PEL_PART_COUNT && length < size; p++)
        if (a->parts[p] != b->parts[p])
            length += (size_t)snprintf(text + length, size - length, "%s%s", length > 0 ? ", " : "", names[p]);
    return text;
}
