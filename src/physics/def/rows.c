#include "def/row_words.h"
#include "geom/solid.h"
#include "law/bending_model.h"
#include "law/membrane.h"
#include "law/solid.h"

/* parts of the fingerprint: of bodies by group, of other defs one for all members */
#define BODY(member, PART) OF(BODY, pel_body_def, member, PART)
#define BODY_LIST(member, count, PART) LIST_OF(BODY, pel_body_def, member, count, PART)
#define MEMBRANE(member) BODY(shell.membrane.member, MEMBRANE)
#define VOLUME(member) BODY(volume.member, VOLUME)
#define RIGID(member) BODY(rigid.member, RIGID)
#define BENDING(member) BODY(shell.bending.member, BENDING)
#define PRESSURE(member) BODY(shell.pressure.member, PRESSURE)
#define REFINE(member) BODY(refine.member, REFINEMENT)
#define FIBRES(member) OF(FIBRES, pel_anisotropy_def, member, ANISOTROPY)
#define SUPPORT(member) OF(SUPPORT, pel_support_def, member, SUPPORTS)
#define SUPPORT_LIST(member, count) LIST_OF(SUPPORT, pel_support_def, member, count, SUPPORTS)
#define MODEL(member, PART) OF(MODEL, pel_model_def, member, PART)
#define LOAD(member) OF(LOAD, pel_load_def, member, LOADS)
#define LOAD_LIST(member, count) LIST_OF(LOAD, pel_load_def, member, count, LOADS)
#define TOOL(member) OF(TOOL, pel_tool_def, member, TOOLS)
#define TOOL_LIST(member, count) LIST_OF(TOOL, pel_tool_def, member, count, TOOLS)
#define CUT(member) OF(CUT, pel_cut_def, member, CUTS)
#define CUT_LIST(member, count) LIST_OF(CUT, pel_cut_def, member, count, CUTS)
#define TIE(member) OF(TIE, pel_tie_def, member, TIES)
#define TIE_LIST(member, count) LIST_OF(TIE, pel_tie_def, member, count, TIES)
#define JOINT(member) OF(JOINT, pel_joint_def, member, TIES)
#define SEAM(member) OF(SEAM, pel_seam_def, member, CUTS)
#define SEAM_LIST(member, count) LIST_OF(SEAM, pel_seam_def, member, count, CUTS)
#define CONTACT(member) OF(CONTACT, pel_contact_def, member, CONTACT)
#define WIND(member) OF(SIM, pel_sim_def, wind.member, LOADS)
#define SOLVER(member) OF(SOLVER, pel_solver_def, member, SOLVER)

/* regions of fibres are a group of scenes */
#define FIBRES_PATH(name) "<anisotropy>." name, .parameter_path = "bodies[].anisotropy[]." name
#define STRUCTURE(why) REFUSED(why, "make a simulation with the new value, and set positions and velocities in it")
#define WHEN(condition) .applies = condition

/* ---- conditions: which defs read a member ---- */

#define CONDITION(name, type, expression)                                                                              \
    static bool name(const void *pointer)                                                                              \
    {                                                                                                                  \
        const type *def = pointer;                                                                                     \
        return expression;                                                                                             \
    }

static bool law_reads(const pel_body_def *def, pel_law_trait number)
{
    return def->shell.membrane.on && (pel_membrane_law_traits(def->shell.membrane.kind) & (int)number) != 0;
}

CONDITION(is_per_vertex, pel_body_def, def->mass_kind == PEL_MASS_PER_VERTEX)
CONDITION(is_total, pel_body_def, def->mass_kind == PEL_MASS_TOTAL)
CONDITION(is_density, pel_body_def, def->mass_kind == PEL_MASS_DENSITY)
CONDITION(is_sheet, pel_body_def, def->mass_kind == PEL_MASS_DENSITY && !def->volume.on)
CONDITION(has_spring_young, pel_body_def, def->spring_thickness > 0)
CONDITION(has_spring_stiffness, pel_body_def, !(def->spring_thickness > 0))
CONDITION(has_filling_young, pel_body_def, def->volumetric_depth > 0)
CONDITION(has_filling_stiffness, pel_body_def, !(def->volumetric_depth > 0))
CONDITION(has_membrane, pel_body_def, def->shell.membrane.on)
CONDITION(reads_poisson, pel_body_def, law_reads(def, PEL_LAW_READS_POISSON))
CONDITION(reads_mooney_ratio, pel_body_def, law_reads(def, PEL_LAW_READS_MOONEY_RATIO))
CONDITION(reads_extension_limit, pel_body_def, law_reads(def, PEL_LAW_READS_EXTENSION_LIMIT))
CONDITION(reads_stiffening, pel_body_def, law_reads(def, PEL_LAW_READS_STIFFENING))
CONDITION(reads_weft, pel_body_def, law_reads(def, PEL_LAW_READS_WEFT))
CONDITION(reads_shear, pel_body_def, law_reads(def, PEL_LAW_READS_SHEAR))
CONDITION(membrane_yields, pel_body_def, law_reads(def, PEL_LAW_YIELDS))
CONDITION(has_warp, pel_body_def,
          law_reads(def, PEL_LAW_ORIENTED) ||
              (def->shell.bending.model != PEL_BENDING_NONE && !(def->shell.bending.weft < 0)))
CONDITION(has_volume, pel_body_def, def->volume.on)
CONDITION(reads_volume_ratio, pel_body_def, def->volume.on && def->volume.kind == PEL_VOLUME_MOONEY_RIVLIN)
CONDITION(is_rigid, pel_body_def, def->rigid.on)
CONDITION(has_rigid_density, pel_body_def, def->rigid.on && !(def->rigid.mass > 0))
CONDITION(has_rigid_mass, pel_body_def, def->rigid.on && def->rigid.mass > 0)
CONDITION(has_bending, pel_body_def, def->shell.bending.model != PEL_BENDING_NONE)
CONDITION(does_yield, pel_body_def, def->shell.bending.model != PEL_BENDING_NONE && def->shell.bending.yield > 0)
CONDITION(is_pressed, pel_body_def, def->shell.pressure.kind == PEL_PRESSURE_GIVEN)
CONDITION(is_gas, pel_body_def, def->shell.pressure.kind == PEL_PRESSURE_GAS)
CONDITION(has_target, pel_body_def, def->shell.pressure.kind == PEL_PRESSURE_VOLUME)
CONDITION(has_pressure, pel_body_def, def->shell.pressure.kind != PEL_PRESSURE_NONE)
CONDITION(refines, pel_body_def, def->refine.levels > 0)
CONDITION(looks_at_force, pel_body_def, refines(def) && def->refine.above > 0)
CONDITION(looks_at_curvature, pel_body_def, refines(def) && def->refine.curvature_above > 0)
CONDITION(caves, pel_anisotropy_def, def->mode == PEL_FIBRE_CAVE)
CONDITION(has_max_step, pel_anisotropy_def, def->mode == PEL_FIBRE_CAVE || def->mode == PEL_FIBRE_NORMAL)
CONDITION(is_normal, pel_anisotropy_def, def->mode == PEL_FIBRE_NORMAL)
CONDITION(is_active, pel_anisotropy_def, def->mode == PEL_FIBRE_ACTIVE)
CONDITION(is_muscle, pel_anisotropy_def, def->mode == PEL_FIBRE_MUSCLE)
CONDITION(curls, pel_anisotropy_def, def->mode == PEL_FIBRE_CURL)
CONDITION(has_fibres, pel_anisotropy_def, def->mode != PEL_FIBRE_CURL && def->mode != PEL_FIBRE_MUSCLE)
CONDITION(has_foundation, pel_support_def, def->foundation > 0)
CONDITION(has_radius, pel_tool_def, pel_solid_rows[def->shape].has_radius)
CONDITION(has_length, pel_tool_def, pel_solid_rows[def->shape].has_length)
CONDITION(has_size, pel_tool_def, pel_solid_rows[def->shape].has_size)
CONDITION(is_instrument, pel_tool_def, def->shape != PEL_TOOL_SUPPORT)
CONDITION(is_blade, pel_tool_def, def->shape == PEL_TOOL_BLADE)
CONDITION(is_scissors, pel_tool_def, def->shape == PEL_TOOL_SCISSORS)
CONDITION(grasps, pel_tool_def, def->grasp)
CONDITION(leads, pel_tool_def, def->grasp && def->leads)
CONDITION(is_enabled, pel_contact_def, def->enabled)
CONDITION(is_quasi_static, pel_solver_def, def->method == PEL_METHOD_QUASI_STATIC)
CONDITION(is_explicit, pel_solver_def, def->method == PEL_METHOD_EXPLICIT)
CONDITION(is_xpbd, pel_solver_def, def->method == PEL_METHOD_XPBD)
CONDITION(has_path, pel_solver_def, def->path == PEL_PATH_ARC_LENGTH)
CONDITION(is_descent, pel_solver_def, def->method == PEL_METHOD_DESCENT)
CONDITION(has_substeps, pel_solver_def,
          def->method == PEL_METHOD_PBD || def->method == PEL_METHOD_PBD_DISTANCE || is_xpbd(def))
CONDITION(has_drag, pel_solver_def, has_substeps(def) || is_explicit(def))
CONDITION(iterates, pel_solver_def, has_substeps(def) || is_descent(def))

#define METHOD_WORD(METHOD, name, word) word,
const char *const pel_method_words[] = {PEL_METHODS(METHOD_WORD) NULL};
#undef METHOD_WORD

/* ---- the table ---- */

static const pel_def_row rows[] = {
    {"bodies", DEFS_OF(MODEL, pel_model_def, bodies, body_count, BODY, MESH), LIST, COUNT_FROM(1), REQUIRED,
     .doc = "deformable surfaces"},
    {"bodies[]", MAP, .doc = "one body"},
    {"bodies[].name", BODY(name, NONE), NAME, .preset = "body#", .doc = "name in outputs, loads and tools"},
    {"bodies[].mesh", BODY(mesh, MESH), MAP, REQUIRED, .like = "<mesh>",
     .doc = "the surface at the start, which is its shape at rest if there is no `rest`"},
    {"bodies[].rest", BODY(rest, MESH), MAP, .like = "<mesh>",
     .doc =
         "the shape at rest, with the vertices and triangles of `mesh` in their order, such as a shape key: the body "
         "starts as `mesh` and springs to this shape. Displacements and volume ratios refer to it, and supports hold "
         "vertices where it has them; regions select by `mesh`. Optional; not with rigid, refine, volume, cuts or "
         "seams"},
    {"bodies[].preset", WORD("tissue", "paper-a"), .preset = "tissue",
     .doc = "defaults of `mass`, `springs` and `volumetric`. tissue: density and Young's modulus, for meshes of any "
            "size and fineness; paper-a: the numbers of paper A, a mass of 1 kg per vertex, stiffnesses k = 3 and k' = "
            "1.5 N/m, dampings d = d' = 0.5 N s/m. A body with a membrane has no springs unless `springs` is given"},
    {"bodies[].mass", BODY(mass_kind, MASS), MAP, .preset = "{}", .doc = "mass of the vertices, by one of three keys"},
    {"bodies[].mass.per_vertex", BODY(mass, MASS), NUMBER, .unit = "kg", POSITIVE, ALTERNATIVE, .initial = 1,
     WHEN(is_per_vertex), .doc = "mass of each vertex (paper A: 1)"},
    {"bodies[].mass.total", BODY(mass, MASS), NUMBER, .unit = "kg", POSITIVE, ALTERNATIVE, WHEN(is_total),
     .doc = "mass of the body, distributed over its surface by area"},
    {"bodies[].mass.density", BODY(mass, MASS), NUMBER, .unit = "kg/m3", POSITIVE, ALTERNATIVE, .preset = "1000",
     WHEN(is_density), .doc = "density of the material"},
    {"bodies[].mass.thickness", BODY(thickness, MASS), .forms = PEL_FORM_NUMBER | PEL_FORM_WORD | PEL_FORM_MAP,
     WORDS("auto"), .like = "<field>", .unit = "m", POSITIVE, .needs = "density", .preset = "auto", WHEN(is_sheet),
     IMPLYING,
     .doc = "thickness of the shell. auto: that of the membrane; without a membrane the enclosed volume over the area, "
            "so that the body is filled; for an open surface a tenth of the radius of a ball with the same area"},
    {"bodies[].springs", MAP, .preset = "{}", .doc = "structural springs on the edges (paper A, eq. A-3)"},
    {"bodies[].springs.young", BODY(spring_stiffness, SPRINGS), QUANTITY, .unit = "Pa", AT_LEAST(0), ALTERNATIVE,
     .preset = "5000", WHEN(has_spring_young), IMPLYING,
     .doc = "Young's modulus E of the skin. An edge of length L between triangles of area A has the stiffness E "
            "`thickness` A / L^2, so that the response does not depend on the fineness of the mesh"},
    {"bodies[].springs.thickness", BODY(spring_thickness, SPRINGS), NUMBER_OR("auto"), .unit = "m", POSITIVE,
     .needs = "young", .preset = "auto", WHEN(has_spring_young),
     .doc = "thickness of the skin. auto: a tenth of the body's radius, which is 3 times its volume over its area, or "
            "for an open surface the radius of a ball with the same area"},
    {"bodies[].springs.drag", BODY(spring_damping, SPRINGS), QUANTITY, .unit = "1/s", AT_LEAST(0), .needs = "young",
     .preset = "0.5", WHEN(has_spring_young), .doc = "damping of each vertex per unit of its mass"},
    {"bodies[].springs.toughness", BODY(spring_toughness, SPRINGS), FIELD, .unit = "J/m2", POSITIVE, .needs = "young",
     AUTO(0), WHEN(has_spring_young), STRUCTURE("snapshots of bodies that tear hold more"),
     .doc =
         "energy that a tear takes per area, as `membrane.toughness`, of a body without a membrane; default: cuts do "
         "not grow"},
    {"bodies[].springs.strength", BODY(spring_strength, SPRINGS), FIELD, .unit = "Pa", POSITIVE, .needs = "toughness",
     AUTO(0), WHEN(has_spring_young), STRUCTURE("snapshots of bodies that tear hold more"),
     .doc = "true stress at which a tear starts, as `membrane.strength`; default: at no stress"},
    {"bodies[].springs.stiffness", BODY(spring_stiffness, SPRINGS), QUANTITY, .unit = "N/m", AT_LEAST(0), ALTERNATIVE,
     .initial = 3, WHEN(has_spring_stiffness),
     .doc = "stiffness k of each edge, independent of its length (paper A: 3), so that a finer mesh is stiffer"},
    {"bodies[].springs.damping", BODY(spring_damping, SPRINGS), .forms = PEL_FORM_NUMBER | PEL_FORM_MAP,
     .like = "<spring damping>", .unit = "N s/m", AT_LEAST(0), .needs = "stiffness", DEFAULT(0.5),
     WHEN(has_spring_stiffness),
     .doc = "a number: damping d of each vertex (eq. A-2). { stiffness: SECONDS } or { loss_factor: NUMBER }: "
            "`viscosity`"},
    {"bodies[].springs.viscosity", MAP,
     .doc = "damping by the rate of the springs' lengths, as that of `membrane`; optional"},
    {"bodies[].springs.viscosity.stiffness", BODY(spring_retardation, SPRINGS), NUMBER, .unit = "s", AT_LEAST(0),
     ALTERNATIVE, STRUCTURE("a run has room for rates of strain from its start"),
     .doc = "viscous force over stiffness times the rate of the length"},
    {"bodies[].springs.viscosity.loss_factor", NUMBER, BETWEEN(0, 2), ALTERNATIVE,
     .doc = "loss factor at the lowest frequency of the body, which the run tells"},
    {"bodies[].contact", MAP, .doc = "contact parameters of this body; default: those of `contact`"},
    {"bodies[].contact.friction", BODY(friction, SURFACE), NUMBER, AT_LEAST(0), AUTO(-1),
     .doc = "Coulomb's coefficient of the body"},
    {"bodies[].contact.thickness", BODY(contact_thickness, SURFACE), NUMBER, .unit = "m", POSITIVE, AUTO(-1), IMPLYING,
     .doc = "contact thickness of the body; two surfaces keep a distance of half the thickness of each"},
    {"bodies[].contact.restitution", BODY(restitution, SURFACE), NUMBER, BETWEEN(0, 1), AUTO(-1),
     .doc = "coefficient of restitution of the body"},
    {"bodies[].volumetric", MAP,
     .doc = "volumetric springs that model the filling: each vertex is pulled back to its rest position (paper A, eq. "
            "A-4); optional"},
    {"bodies[].volumetric.young", BODY(volumetric_stiffness, VOLUMETRIC), QUANTITY, .unit = "Pa", AT_LEAST(0),
     ALTERNATIVE, .preset = "5000", WHEN(has_filling_young),
     .doc = "Young's modulus E of the filling. A vertex with area A has the stiffness E A / `depth`; default: that of "
            "`springs`"},
    {"bodies[].volumetric.depth", BODY(volumetric_depth, VOLUMETRIC), NUMBER_OR("auto"), .unit = "m", POSITIVE,
     .needs = "young", .preset = "auto", WHEN(has_filling_young),
     .doc = "depth of the filling under the surface. auto: the body's radius, see springs.thickness"},
    {"bodies[].volumetric.drag", BODY(volumetric_damping, VOLUMETRIC), QUANTITY, .unit = "1/s", AT_LEAST(0),
     .needs = "young", .preset = "20", WHEN(has_filling_young),
     .doc = "damping of each vertex along its displacement, per unit of its mass"},
    {"bodies[].volumetric.stiffness", BODY(volumetric_stiffness, VOLUMETRIC), QUANTITY, .unit = "N/m", AT_LEAST(0),
     ALTERNATIVE, .initial = 1.5, WHEN(has_filling_stiffness), .doc = "stiffness k' of each vertex (paper A: 1.5)"},
    {"bodies[].volumetric.damping", BODY(volumetric_damping, VOLUMETRIC), QUANTITY, .unit = "N s/m", AT_LEAST(0),
     .needs = "stiffness", DEFAULT(0.5), WHEN(has_filling_stiffness), .doc = "damping d' of each vertex"},
    {"bodies[].volumetric.adhesion", BODY(adhesion, VOLUMETRIC), FIXED, NUMBER, .unit = "Pa", POSITIVE, AUTO(0),
     .doc = "pull per area, away from the filling or along the surface, beyond which a vertex leaves its spring for "
            "ever; default: it never does"},
    {"bodies[].scale_with_area", BODY(volumetric_by_area, VOLUMETRIC), BOOLEAN, .preset = "false",
     .doc = "true: the volumetric stiffness k' and the dampings d and d' are proportional to the area of a vertex"},
    {"bodies[].reference_count", BODY(reference_count, VOLUMETRIC), INTEGER, COUNT_FROM(1), DEFAULT(252),
     .doc = "with scale_with_area: the stiffness and dampings are those of a vertex with the area of the body over "
            "this count (paper A: 252)"},
    {"bodies[].pinned", BODY_LIST(pinned, pinned_count, PINS), REGION,
     .doc = "vertices that never move, or move with `support`; optional"},
    {"bodies[].velocity", BODY(velocity, START), FIXED, VECTOR, .unit = "m/s", .preset = "[0, 0, 0]",
     .doc = "velocity of the body at the start; for methods with velocities"},
    {"bodies[].angular_velocity", BODY(angular_velocity, START), FIXED, VECTOR, .unit = "rad/s", .preset = "[0, 0, 0]",
     .doc = "angular velocity at the start, about the center of mass; added to `velocity`"},
    {"bodies[].support", MAP, .needs = "pinned",
     .doc = "rigid motion of the pinned vertices; default: they do not move"},
    {"bodies[].support.center", VECTOR, .unit = "m", .preset = "[0, 0, 0]", .doc = "center of rotation at rest"},
    {"bodies[].support.motion", LIST, COUNT_FROM(1), REQUIRED,
     .doc = "poses over time; position and angle are linear between keys and constant before the first and after the "
            "last"},
    {"bodies[].support.motion[]", MAP, .doc = "one pose"},
    {"bodies[].support.motion[].time", NUMBER, .unit = "s", AT_LEAST(0), .preset = "0", .doc = "time of the pose"},
    {"bodies[].support.motion[].position", VECTOR, .unit = "m", .preset = "[0, 0, 0]",
     .doc = "displacement of the center from its rest position"},
    {"bodies[].support.motion[].rotation", MAP, .doc = "rotation of the support about its center; optional"},
    {"bodies[].support.motion[].rotation.axis", VECTOR, REQUIRED, .doc = "axis of rotation, of any length but 0"},
    {"bodies[].support.motion[].rotation.angle", NUMBER, .unit = "degrees", REQUIRED,
     .doc = "angle, counter-clockwise; from 0 to 720 is two turns"},

    {"bodies[].follow", MAP,
     .doc = "vertices that follow an animation, linear in time between its frames; a body that follows as a whole and "
            "has no material is an obstacle that moves. Optional"},
    {"bodies[].follow.file", TEXT, REQUIRED,
     .doc = "animated .glb, .gltf or .usda; point cache (.pc2); folder of meshes, in the order of their names; or a "
            "pattern "
            "with one *, such as walk/step_*.obj. The frames have the vertices of `mesh.file`, and are moved like the "
            "mesh"},
    {"bodies[].follow.animation", TEXT,
     .doc = "name or number, from 0, of an animation of a glTF file; default: all together"},
    {"bodies[].follow.fps", NUMBER, .unit = "1/s", POSITIVE, .preset = "24", .doc = "frames per second"},
    {"bodies[].follow.start", NUMBER, .unit = "s", .preset = "0",
     .doc = "time of the first frame; before it and after the last the positions are constant"},
    {"bodies[].follow.at", REGION, .preset = "all", .doc = "vertices that follow"},
    {"bodies[].follow.from", NUMBER, .unit = "s", AT_LEAST(0), .preset = "0",
     .doc = "time from which they follow; above 0 they keep their distance from the animation at that time"},
    {"bodies[].follow.until", NUMBER_OR("end"), .unit = "s", POSITIVE, .preset = "end", .doc = "time of their release"},
    {"bodies[].follow.stiffness", FIELD, .unit = "N/m", AT_LEAST(0),
     .doc =
         "stiffness of a spring that draws each vertex to its place in the animation; 0 = none. Default: the vertex is "
         "there"},
    {"bodies[].follow.strength", NUMBER, .unit = "N", POSITIVE,
     .doc = "force on a vertex above which it is released for good; default: no limit"},

    {"bodies[].supports", DEFS_OF(SIM, pel_sim_def, supports, support_count, SUPPORT, SUPPORTS), LIST, .preset = "[]",
     .doc = "supports of single displacement components, for the methods static and implicit; each reports its "
            "reaction force"},
    {"bodies[].supports[]", MAP, .doc = "one support"},
    {"bodies[].supports[].name", OF(SUPPORT, pel_support_def, name, NONE), NAME, .preset = "support#",
     .doc = "name in outputs, after the name of the body"},
    {"bodies[].supports[].at", SUPPORT_LIST(vertices, vertex_count), REGION, REQUIRED, .doc = "supported vertices"},
    {"bodies[].supports[].fix", SUPPORT(fix), LIST, COUNT_FROM(0), ALTERNATIVE, .preset = "[\"x\", \"y\", \"z\"]",
     .doc = "fixed displacement components, along the axes of `frame`; [] fixes rotation only"},
    {"bodies[].supports[].fix[]", WORD("x", "y", "z"), .doc = "one component"},
    {"bodies[].supports[].symmetry", .forms = PEL_FORM_WORD | PEL_FORM_VECTOR, WORDS("x", "y", "z"), ALTERNATIVE,
     .doc = "plane of symmetry with this normal: fixes the displacement along the normal and the rotation of edges in "
            "the plane"},
    {"bodies[].supports[].frame", SUPPORT(axes), MAP, .needs = "fix",
     .doc = "axes of the components; default: x, y, z"},
    {"bodies[].supports[].frame.x", VECTOR, REQUIRED, .doc = "direction of x, of any length but 0"},
    {"bodies[].supports[].frame.y", VECTOR,
     .doc = "direction of y, made orthogonal to x; default: any direction orthogonal to x"},
    {"bodies[].supports[].displacement", SUPPORT(displacement), VECTOR, .unit = "m", .needs = "fix",
     .preset = "[0, 0, 0]", .doc = "prescribed displacement of the fixed components, along the axes of `frame`"},
    {"bodies[].supports[].keys", SUPPORT_LIST(keys, key_count), LIST, COUNT_FROM(1), .needs = "displacement",
     .doc = "factor on the displacement over time, linear between the keys"},
    {"bodies[].supports[].keys[]", .forms = PEL_FORM_KEY, .doc = "time [s] and factor"},
    {"bodies[].supports[].rotation", SUPPORT(fix_rotation), FIXED, WORD("free", "fixed"), .needs = "fix",
     .preset = "free",
     .doc = "fixed: clamps edges with both ends in the region, whose normals then keep their direction (bending model "
            "midedge)"},
    {"bodies[].supports[].stiffness", SUPPORT(stiffness), NUMBER, .unit = "N/m", POSITIVE, .needs = "fix", AUTO(0),
     .doc = "spring stiffness of the support at each vertex; default: rigid"},
    {"bodies[].supports[].foundation", SUPPORT(foundation), NUMBER, .unit = "N/m3", POSITIVE, .needs = "fix",
     WHEN(has_foundation),
     .doc = "elastic (Winkler) foundation under the triangles of the region: stiffness per area at rest; optional"},

    {"bodies[].volume", VOLUME(on), MAP,
     .doc =
         "solid body: the closed mesh is filled with tetrahedra of a material. Its surface gets vertices of its own, "
         "which lie on the mesh. Methods implicit, static, xpbd, explicit and descent; optional"},
    {"bodies[].volume.material", VOLUME(kind), .forms = PEL_FORM_WORD, .words = pel_volume_words,
     .preset = "neo-hookean", .initial = PEL_VOLUME_NEO_HOOKEAN, WHEN(has_volume), IMPLYING, .doc = "constitutive law"},
    {"bodies[].volume.young", VOLUME(young), FIELD, .unit = "Pa", POSITIVE, REQUIRED, WHEN(has_volume),
     .doc = "Young's modulus; of a tetrahedron the mean of its corners"},
    {"bodies[].volume.poisson", VOLUME(poisson), NUMBER, .range = {true, false, 0, 0.4999}, DEFAULT(0.3),
     WHEN(has_volume),
     .doc = "Poisson's ratio; above 0.45 linear tetrahedra lock, and are too stiff: `element: smooth` does not"},
    {"bodies[].volume.mooney_ratio", VOLUME(mooney_ratio), NUMBER, AT_LEAST(0), DEFAULT(0.2), .needs = "material",
     .needs_word = "mooney-rivlin", WHEN(reads_volume_ratio), .doc = "mooney-rivlin: c2 over c1"},
    {"bodies[].volume.element", VOLUME(element), .forms = PEL_FORM_WORD, .words = pel_volume_element_words,
     .preset = "linear", WHEN(has_volume), STRUCTURE("the element decides which vertices act on each other"),
     .doc =
         "linear: strains of each tetrahedron, too stiff in bending and above a Poisson's ratio of 0.45; smooth: means "
         "over the tetrahedra at each edge, right on coarse meshes and up to 0.4999, 3 to 5 times as dear; methods "
         "implicit, static, explicit and descent. Default: smooth for bodies that bend or lock, if steps are cheap"},
    {"bodies[].volume.edge", NUMBER_OR("auto"), .unit = "m", POSITIVE, .preset = "auto",
     .doc = "length of the edges of the tetrahedra along the axes; auto: the mean edge of the mesh"},

    {"bodies[].rigid", RIGID(on), MAP,
     .doc = "rigid body: its mesh moves and turns as a whole. One pinned vertex is a ball joint, several on a line are "
            "a hinge. Methods xpbd, pbd, pbd-distance, implicit, explicit and static; optional"},
    {"bodies[].rigid.density", RIGID(density), NUMBER, .unit = "kg/m3", POSITIVE, ALTERNATIVE, DEFAULT(1000),
     WHEN(has_rigid_density), .doc = "density of the filling, or of the sheet"},
    {"bodies[].rigid.mass", RIGID(mass), NUMBER, .unit = "kg", POSITIVE, ALTERNATIVE, WHEN(has_rigid_mass),
     .doc = "mass of the body"},
    {"bodies[].rigid.thickness", RIGID(thickness), NUMBER, .unit = "m", POSITIVE, AUTO(0), WHEN(is_rigid),
     .doc = "thickness of the sheet that the triangles are; a closed mesh then is hollow. Default: it is filled"},
    {"bodies[].rigid.sphere", RIGID(sphere), BOOLEAN, .preset = "false", WHEN(is_rigid),
     .doc = "a ball: its mass, inertia and contact are those of the sphere about the mesh; not implicit, not static"},

    {"bodies[].membrane", MEMBRANE(on), MAP,
     .doc = "thin shell: triangles that stretch like a sheet of a material (paper B, eq. 2); optional"},
    {"bodies[].membrane.preset", .forms = PEL_FORM_WORD,
     .doc = "a material of `pellicle presets`; other keys of `membrane` override its numbers"},
    {"bodies[].membrane.material", MEMBRANE(kind), .forms = PEL_FORM_WORD, .words = pel_membrane_words,
     .preset = "neo-hookean", .initial = PEL_MEMBRANE_NEO_HOOKEAN, WHEN(has_membrane), IMPLYING,
     .doc = "constitutive law; default: neo-hookean, which resists compression to any extent"},
    {"bodies[].membrane.young", MEMBRANE(young), .forms = PEL_FORM_NUMBER | PEL_FORM_MAP | PEL_FORM_PAIR,
     .like = "<field>", .unit = "Pa", POSITIVE, REQUIRED, .supplied = "preset", WHEN(has_membrane), IMPLYING,
     .doc = "Young's modulus; orthotropic: along the warp, or [warp, weft]; weave: left out, the first slope of "
            "`warp_curve`"},
    {"bodies[].membrane.poisson", MEMBRANE(poisson), NUMBER, .range = {true, true, -1, 1}, DEFAULT(0.3),
     WHEN(reads_poisson),
     .doc = "Poisson's ratio, less than 1; 0 to 0.5 for neo-hookean; mooney-rivlin and gent are incompressible and "
            "ignore it"},
    {"bodies[].membrane.thickness", MEMBRANE(thickness), FIELD, .unit = "m", POSITIVE, REQUIRED, .supplied = "",
     WHEN(has_membrane), IMPLYING, .doc = "thickness of the sheet; default: that of `mass`"},
    {"bodies[].membrane.mooney_ratio", MEMBRANE(mooney_ratio), NUMBER, AT_LEAST(0), DEFAULT(0.2),
     WHEN(reads_mooney_ratio), .doc = "mooney-rivlin: c2 over c1"},
    {"bodies[].membrane.extension_limit", MEMBRANE(extension_limit), NUMBER, POSITIVE, DEFAULT(50),
     WHEN(reads_extension_limit),
     .doc = "gent: limit of I1 - 3, where the polymer chains are fully extended; 30 to 100 for rubber"},
    {"bodies[].membrane.stiffening", MEMBRANE(stiffening), NUMBER, POSITIVE, DEFAULT(10), WHEN(reads_stiffening),
     .doc = "fung: b in the tangent stiffness, which grows as exp(b e^2 / 2) with the uniaxial strain e"},
    {"bodies[].membrane.weft", MEMBRANE(weft), NUMBER_OR("auto"), .unit = "Pa", POSITIVE, .needs = "material",
     .needs_word = "orthotropic", .preset = "auto", AUTO(0), WHEN(reads_weft),
     .doc = "orthotropic: Young's modulus across the warp, along which it is `young`; auto: `young`"},
    {"bodies[].membrane.shear", MEMBRANE(shear), NUMBER_OR("auto"), .unit = "Pa", POSITIVE, .needs = "material",
     .needs_word = "orthotropic", .preset = "auto", AUTO(0), WHEN(reads_shear),
     .doc = "orthotropic: shear modulus; auto: young / (2 (1 + poisson))"},
    {"bodies[].membrane.shear", MEMBRANE(shear), NUMBER, .unit = "Pa", POSITIVE, REQUIRED, .needs = "material",
     .needs_word = "weave", WHEN(reads_shear), .doc = "weave: shear modulus, which curves of the threads do not tell"},
    {"bodies[].membrane.warp_curve", MEMBRANE(warp_curve), FIXED, LIST, BETWEEN(1, PEL_WEAVE_POINTS), REQUIRED,
     .needs = "material", .needs_word = "weave",
     .doc = "weave: points [strain, stress] of a strip pulled along the warp, of force over area at rest, in rising "
            "order, the first of them beyond 0; linear between points and beyond the last"},
    {"bodies[].membrane.warp_curve[]", .forms = PEL_FORM_PAIR, .doc = "a strain, and a stress in pascal"},
    {"bodies[].membrane.weft_curve", MEMBRANE(weft_curve), FIXED, LIST, BETWEEN(1, PEL_WEAVE_POINTS),
     .needs = "material", .needs_word = "weave", .varies = true,
     .doc = "the same across the warp; default: `warp_curve`"},
    {"bodies[].membrane.weft_curve[]", .forms = PEL_FORM_PAIR, .doc = "a strain, and a stress in pascal"},
    {"bodies[].membrane.yield", MEMBRANE(yield), NUMBER, .unit = "Pa", POSITIVE, REQUIRED, .needs = "material",
     .needs_word = "elastoplastic", WHEN(membrane_yields),
     .doc = "elastoplastic: yield stress (von Mises), beyond which the sheet stretches for good"},
    {"bodies[].membrane.hardening", MEMBRANE(hardening), NUMBER, .unit = "Pa", AT_LEAST(0), DEFAULT(0),
     .needs = "yield", WHEN(membrane_yields), .doc = "elastoplastic: growth of the yield stress over plastic strain"},
    {"bodies[].membrane.direction", MEMBRANE(direction), .forms = PEL_FORM_VECTOR | PEL_FORM_WORD | PEL_FORM_MAP,
     WORDS("uv"), .preset = "[1, 0, 0]", .initial = 1, WHEN(has_warp),
     .doc = "the warp of an orthotropic membrane, and of bending with `weft`: a vector [x, y, z], projected into each "
            "triangle at rest (where it is normal to some of them, [z, x, y]); uv: along the first texture coordinate, "
            "the field u, s or texture_u of a PLY file; or the direction in "
            "which a number "
            "rises, such as the distance from a point"},
    {"bodies[].membrane.direction.field", TEXT, ALTERNATIVE,
     .doc = "scalar field of the mesh: the warp is its gradient in each triangle"},
    {"bodies[].membrane.direction.center", VECTOR, .unit = "m", ALTERNATIVE,
     .doc = "point at rest: the warp runs away from it"},
    {"bodies[].membrane.strain_limit", MEMBRANE(strain_limit), NUMBER, .range = {true, true, 0, 0.99}, AUTO(0),
     WHEN(has_membrane),
     .doc = "pbd and xpbd, for cloth: keeps principal stretches between 1 - strain_limit and 1 + strain_limit; "
            "default: no limit"},
    {"bodies[].membrane.damping", MAP,
     .doc =
         "damping of the material by its rate of strain (Kelvin and Voigt), which leaves rigid motion alone; methods "
         "implicit and xpbd; optional"},
    {"bodies[].membrane.damping.stiffness", MEMBRANE(retardation), NUMBER, .unit = "s", AT_LEAST(0), ALTERNATIVE,
     WHEN(has_membrane), STRUCTURE("a run has room for rates of strain from its start"),
     .doc =
         "viscous stress over stiffness times rate of strain: a vibration of angular frequency w loses stiffness * w "
         "/ 2 of critical damping"},
    {"bodies[].membrane.damping.loss_factor", NUMBER, BETWEEN(0, 2), ALTERNATIVE,
     .doc =
         "loss factor at the lowest frequency of the body, which the run tells: twice the ratio to critical damping"},
    {"bodies[].membrane.toughness", MEMBRANE(toughness), FIELD, .unit = "J/m2", POSITIVE, AUTO(0), WHEN(has_membrane),
     STRUCTURE("snapshots of bodies that tear hold more"),
     .doc = "energy that a tear takes per area, which is its length times the thickness: cuts and notches grow where "
            "they release more; default: they do not"},
    {"bodies[].membrane.strength", MEMBRANE(strength), FIELD, .unit = "Pa", POSITIVE, .needs = "toughness", AUTO(0),
     WHEN(has_membrane), STRUCTURE("snapshots of bodies that tear hold more"),
     .doc = "true stress at which a tear starts where `tear.start` allows it: the mean of the largest principal stress "
            "over a disc of 1.32 `young` `toughness` / (pi `strength`^2) around a vertex; default: at no stress"},
    {"bodies[].membrane.rest_scale", MEMBRANE(rest_scale), FIXED, FIELD, POSITIVE, AUTO(0), WHEN(has_membrane),
     .doc = "lengths of the shape without stress over those of the mesh; above 1 the body grows; default: 1"},
    {"bodies[].membrane.rest_keys", BODY_LIST(shell.membrane.rest_keys, shell.membrane.rest_key_count, MEMBRANE), FIXED,
     LIST, COUNT_FROM(1), .needs = "rest_scale", WHEN(has_membrane), .doc = "share of it over time, 0 to 1"},
    {"bodies[].membrane.rest_keys[]", .forms = PEL_FORM_KEY, .doc = "time [s] and share"},
    {"bodies[].bending", MAP,
     .doc = "resistance to bending (paper B, eq. 3); default: a body with a membrane has the flexural rigidity of its "
            "material, but none under pbd and pbd-distance"},
    {"bodies[].bending.model", BENDING(model), .forms = PEL_FORM_WORD, .words = pel_bending_words, .preset = "hinge",
     .varies = true, WHEN(has_bending), STRUCTURE("the model of bending decides what elements there are"),
     .doc = "none: no resistance; isometric: paper B's model, which flattens a curved rest shape; isometric-rest: the "
            "same with the minimum of its energy at the rest shape; hinge: change of the dihedral angles; midedge: "
            "plate bending that does not depend on the mesh, only for the methods static and implicit. Default: hinge; "
            "midedge under static and implicit"},
    {"bodies[].bending.weight", BENDING(weight), NUMBER_OR("auto"), BETWEEN(0, 1), DEFAULT(0.01), AUTO(-1),
     WHEN(has_bending),
     .doc = "pbd: factor on the position corrections (paper B, k_B). auto: starts at 0.01, decreases by 1 % per step "
            "while the volume changes monotonically, is halved when the change of the volume reverses, and is at least "
            "0.001"},
    {"bodies[].bending.stiffness", BENDING(stiffness), .forms = PEL_FORM_NUMBER | PEL_FORM_WORD | PEL_FORM_MAP,
     WORDS("auto"), .like = "<field>", .unit = "N m", AT_LEAST(0), .preset = "auto", AUTO(-1), WHEN(has_bending),
     .doc = "flexural rigidity D, for all methods but pbd and pbd-distance; auto: E h^3 / (12 (1 - nu^2)) of the "
            "membrane"},
    {"bodies[].bending.weft", BENDING(weft), NUMBER_OR("auto"), .unit = "N m", POSITIVE, .preset = "auto", AUTO(-1),
     WHEN(has_bending),
     .doc = "flexural rigidity of the weft, where `stiffness` is that of the warp (`membrane.direction`); auto: by the "
            "moduli of an orthotropic membrane, or equal to a `stiffness` that is given"},
    {"bodies[].bending.yield", BENDING(yield), NUMBER, .unit = "1/m", POSITIVE, AUTO(0), WHEN(has_bending),
     STRUCTURE("snapshots of bodies that fold for good hold more"),
     .doc = "change of curvature beyond which the sheet folds for good, as paper and foil do: its rest angles follow "
            "(model hinge, methods with a material); default: never"},
    {"bodies[].bending.hardening", BENDING(hardening), NUMBER, AT_LEAST(0), DEFAULT(0.05), .needs = "yield",
     WHEN(does_yield),
     .doc =
         "growth of the yield moment, over `stiffness` times plastic curvature: the moment rises by hardening / (1 + "
         "hardening) of the elastic slope beyond `yield`"},
    {"bodies[].bending.damping", MAP,
     .doc = "damping by the rate of bending, as that of `membrane`; models hinge and midedge; optional"},
    {"bodies[].bending.damping.stiffness", BENDING(retardation), NUMBER, .unit = "s", AT_LEAST(0), ALTERNATIVE,
     WHEN(has_bending), STRUCTURE("a run has room for rates of strain from its start"),
     .doc = "viscous moment over rigidity times rate of curvature"},
    {"bodies[].bending.damping.loss_factor", NUMBER, BETWEEN(0, 2), ALTERNATIVE,
     .doc = "loss factor at the lowest frequency of the body, which the run tells"},
    {"bodies[].anisotropy", DEFS_OF(BODY, pel_body_def, shell.anisotropies, shell.anisotropy_count, FIBRES, ANISOTROPY),
     .forms = PEL_FORM_MAP | PEL_FORM_LIST, COUNT_FROM(1), .like = "<anisotropy>",
     .doc = "regions with fibres (paper B, section 3): one map or a list of them; optional"},
    {"bodies[].anisotropy[]", MAP, .like = "<anisotropy>", .doc = "one region with fibres"},
    {"bodies[].pressure", PRESSURE(kind), MAP, .doc = "pressure on the surface; optional"},
    {"bodies[].pressure.outside", PRESSURE(outside), QUANTITY, .unit = "Pa", ALTERNATIVE, WHEN(is_pressed),
     .doc = "excess of the outside pressure: presses inward (paper B)"},
    {"bodies[].pressure.inside", PRESSURE(outside), QUANTITY, .unit = "Pa", ALTERNATIVE, FACTOR(-1), WHEN(is_pressed),
     .doc = "excess of the inside pressure: inflates"},
    {"bodies[].pressure.gas", MAP, ALTERNATIVE,
     .doc = "an enclosed gas with constant p V^gamma, in equilibrium at rest"},
    {"bodies[].pressure.gas.pressure", PRESSURE(value), NUMBER, .unit = "Pa", POSITIVE, .preset = "101325",
     WHEN(is_gas), .doc = "pressure of the gas at rest and of the surrounding air"},
    {"bodies[].pressure.gas.gamma", PRESSURE(gamma), NUMBER, BETWEEN(1, 10), DEFAULT(1.4), WHEN(is_gas),
     .doc = "adiabatic index: 1 for isothermal, 1.4 for adiabatic changes of air"},
    {"bodies[].pressure.gas.outside", PRESSURE(outside), QUANTITY, .unit = "Pa", .preset = "0", WHEN(is_gas),
     .doc = "additional outside pressure; negative inflates"},
    {"bodies[].pressure.volume", MAP, ALTERNATIVE, .doc = "drives the enclosed volume to a target"},
    {"bodies[].pressure.volume.target", PRESSURE(target), QUANTITY, AT_LEAST(0), REQUIRED, .initial = 1,
     WHEN(has_target), .doc = "ratio of the target volume to the rest volume"},
    {"bodies[].pressure.volume.bulk", PRESSURE(bulk), NUMBER, .unit = "Pa", POSITIVE, REQUIRED, WHEN(has_target),
     .doc = "bulk modulus: pressure per relative difference of volume"},
    {"bodies[].pressure.volume.outside", PRESSURE(outside), QUANTITY, .unit = "Pa", .preset = "0", WHEN(has_target),
     .doc = "outside pressure; negative inflates"},
    {"bodies[].pressure.form", PRESSURE(form), WORD("consistent", "vertex-normal"), .preset = "consistent",
     WHEN(has_pressure),
     .doc = "consistent: minus pressure times the gradient of the volume; vertex-normal: along the vertex normal, as "
            "paper B writes it"},
    {"bodies[].pressure.region", PRESSURE(weights), REGION, .preset = "all",
     .doc = "region on which the pressure acts"},

    {"bodies[].fluid", MAP,
     .doc = "a liquid in the body: its weight, and its pressure by depth; methods implicit, static, xpbd, pbd and "
            "explicit; optional"},
    {"bodies[].fluid.density", BODY(fluid_density, PRESSURE), NUMBER, .unit = "kg/m3", POSITIVE, .preset = "1000",
     STRUCTURE("masses are made once"),
     .doc = "density. Without `level` the liquid fills a closed body, whose volume is kept (give `pressure.volume` to "
            "choose its bulk modulus)"},
    {"bodies[].fluid.level", BODY(fluid_level, PRESSURE), NUMBER, .unit = "m", AUTO((double)HUGE_VAL),
     STRUCTURE("whether the liquid has a mass is decided at the start"),
     .doc = "height of its surface, against gravity about the origin, for open bodies: it presses below, and its mass "
            "does not move with the body. Default: it fills the body"},

    {"bodies[].refine", .forms = PEL_FORM_WORD | PEL_FORM_MAP, WORDS("auto"),
     .doc = "dynamic local refinement (paper A, section 3); optional. auto, for bodies with a membrane: before the run "
            "the mesh becomes finer around small loads and around the places where tools press, until point loads are "
            "right within about 3 %; vertices keep their numbers, and new ones follow. auto, with a volume: the same "
            "where tools press, until their forces are"},
    {"bodies[].refine.levels", REFINE(levels), INTEGER, BETWEEN(1, 6), .preset = "1", WHEN(refines),
     STRUCTURE("the levels of detail are made once"), .doc = "finest level of detail; each one halves the edges"},
    {"bodies[].refine.everywhere", REFINE(everywhere), BOOLEAN, .preset = "false", WHEN(refines),
     STRUCTURE("it decides which triangles there are from the start"),
     .doc = "true: refines the whole body to the finest level; excludes the criteria below"},
    {"bodies[].refine.above", REFINE(above), NUMBER, .unit = "N/m2", POSITIVE, WHEN(looks_at_force), IMPLYING,
     .doc = "refines around vertices whose elastic force per area is larger"},
    {"bodies[].refine.below", REFINE(below), NUMBER_OR("auto"), .unit = "N/m2", AT_LEAST(0), .needs = "above",
     .preset = "auto", WHEN(looks_at_force), .doc = "coarsens again below this value; auto: half of `above`"},
    {"bodies[].refine.curvature", MAP, .doc = "refines where the surface bends or folds; optional"},
    {"bodies[].refine.curvature.above", REFINE(curvature_above), NUMBER, .unit = "1/m", POSITIVE, REQUIRED,
     WHEN(looks_at_curvature), IMPLYING,
     .doc = "refines around vertices whose mean curvature has changed by more since rest"},
    {"bodies[].refine.curvature.below", REFINE(curvature_below), NUMBER_OR("auto"), .unit = "1/m", AT_LEAST(0),
     .preset = "auto", WHEN(looks_at_curvature), .doc = "coarsens again below this value; auto: half of `above`"},
    {"bodies[].refine.near_tools", REFINE(near_tools), NUMBER, .unit = "m", POSITIVE, AUTO(0), WHEN(refines),
     .doc = "refines triangles within this distance of a tool, before it touches; coarsens beyond 1.25 times the "
            "distance"},
    {"bodies[].refine.region", BODY_LIST(refine.region, refine.region_count, REFINEMENT), REGION,
     .doc = "always refines the triangles at these vertices"},
    {"bodies[].refine.region_levels", REFINE(region_levels), FIXED, INTEGER, BETWEEN(0, 6), .needs = "region",
     .preset = "0", .doc = "minimum level in the region; 0: the finest level"},
    {"bodies[].refine.rings", REFINE(rings), INTEGER, BETWEEN(1, 3), DEFAULT(2), WHEN(refines),
     .doc = "rings of triangles that a vertex refines around it, on each level"},
    {"bodies[].refine.dwell", REFINE(dwell), INTEGER, COUNT_FROM(0), .needs = "above, curvature, near_tools",
     DEFAULT(50), WHEN(refines), .doc = "steps that a vertex must stay below `below` before it coarsens"},
    {"bodies[].refine.interval", REFINE(interval), INTEGER, COUNT_FROM(1), .needs = "above, curvature, near_tools",
     DEFAULT(10), WHEN(refines),
     .doc = "number of steps in which every vertex is tested once; use 1 if steps are few and large, as under static"},
    {"bodies[].refine.budget", REFINE(budget), INTEGER, COUNT_FROM(0), .preset = "0", WHEN(refines),
     .doc = "maximum number of triangles of the body; the strongest candidates are refined first. 0: no limit"},
    {"bodies[].refine.springs", REFINE(springs), WORD("van-gelder", "unchanged"), .preset = "van-gelder", WHEN(refines),
     .doc = "stiffness on finer levels: van-gelder scales it by area over squared length; unchanged keeps it"},

    {"gravity", MODEL(gravity, GRAVITY), VECTOR, .unit = "m/s2", .preset = "[0, 0, 0]",
     .doc = "acceleration of all bodies"},

    {"loads", DEFS_OF(SIM, pel_sim_def, loads, load_count, LOAD, LOADS), LIST, .preset = "[]",
     .doc = "forces on vertices over time"},
    {"loads[]", MAP, .doc = "one load"},
    {"loads[].name", OF(LOAD, pel_load_def, name, NONE), NAME, .preset = "load#",
     .doc = "name in messages and in parameters"},
    {"loads[].body", LOAD(body), TEXT, .doc = "name of the body; optional if there is one"},
    {"loads[].force", LOAD(force), VECTOR, .unit = "N", REQUIRED, DIRECT,
     .doc = "the force; `per` defines how it is distributed"},
    {"loads[].at", LOAD_LIST(vertices, vertex_count), REGION, .preset = "all", .doc = "loaded vertices"},
    {"loads[].per", LOAD(kind), FIXED, WORD("total", "vertex", "length", "moment"), .preset = "total",
     .doc = "total: the force, spread evenly over the tetrahedra, triangles or edges whose vertices are all in the "
            "region, the first of these with all of its vertices (else over the triangles around them; vertices that "
            "no edge joins have equal parts); vertex: it acts on each vertex; length: force per metre of the boundary "
            "edges with both ends in the region [N/m]; moment: moment per metre of these edges [N m/m], whose "
            "component along an edge turns the surface about it (bending model midedge)"},
    {"loads[].follower", LOAD(follower), FIXED, BOOLEAN, .needs = "per", .needs_word = "length", .preset = "false",
     .doc = "true: the force rotates with the edge and its triangle"},
    {"loads[].from", LOAD(from), NUMBER, .unit = "s", AT_LEAST(0), .preset = "0", DIRECT, IMPLYING,
     .doc = "acts from this time on, which may be within a step"},
    {"loads[].until", LOAD(until), NUMBER_OR("end"), .unit = "s", POSITIVE, .preset = "end", AUTO((double)HUGE_VAL),
     DIRECT, IMPLYING, .doc = "acts up to this time, likewise"},
    {"loads[].keys", LOAD_LIST(keys, key_count), LIST, COUNT_FROM(1),
     .doc = "factor on the force over time, linear between the keys"},
    {"loads[].keys[]", .forms = PEL_FORM_KEY, .doc = "time [s] and factor"},

    {"wind", MAP,
     .doc = "air around all bodies, still or moving: drag and lift on every triangle; methods with velocities; "
            "optional"},
    {"wind.velocity", WIND(velocity), FIXED, VECTOR, .unit = "m/s", .preset = "[0, 0, 0]",
     .doc = "velocity of the air; [0, 0, 0] is still air, which brakes bodies"},
    {"wind.keys", LIST_OF(SIM, pel_sim_def, wind.keys, wind.key_count, LOADS), FIXED, LIST, COUNT_FROM(1),
     .doc = "factor on the velocity and the gusts over time, linear between the keys"},
    {"wind.keys[]", .forms = PEL_FORM_KEY, .doc = "time [s] and factor"},
    {"wind.density", WIND(density), FIXED, NUMBER, .unit = "kg/m3", POSITIVE, .preset = "1.2",
     .doc = "density of the air"},
    {"wind.drag", WIND(drag), FIXED, NUMBER, AT_LEAST(0), DEFAULT(1.2),
     .doc = "coefficient of the force along the wind, of a triangle across it; it falls with the square of the sine of "
            "the angle between wind and triangle"},
    {"wind.lift", WIND(lift), FIXED, NUMBER, AT_LEAST(0), DEFAULT(1.2),
     .doc = "coefficient of the force across the wind, times sine and cosine of that angle. With the same number as "
            "`drag` the force is along the normal of the triangle"},
    {"wind.gusts", MAP, .doc = "eddies that the wind carries along; optional"},
    {"wind.gusts.speed", WIND(gusts.speed), FIXED, NUMBER, .unit = "m/s", POSITIVE, REQUIRED,
     .doc = "root mean square of each component of their velocity"},
    {"wind.gusts.length", WIND(gusts.length), FIXED, NUMBER, .unit = "m", POSITIVE, REQUIRED,
     .doc = "length of the eddies"},
    {"wind.gusts.seed", WIND(gusts.seed), FIXED, INTEGER, BETWEEN(0, INT32_MAX), DEFAULT(0),
     .doc = "number that the field follows from: the same number, the same gusts"},

    {"tools", DEFS_OF(SIM, pel_sim_def, tools, tool_count, TOOL, TOOLS), LIST, .preset = "[]",
     .doc = "rigid instruments that press and grasp; the force on each is reported"},
    {"tools[]", MAP, .doc = "one tool"},
    {"tools[].name", OF(TOOL, pel_tool_def, name, NONE), NAME, .preset = "tool#", .doc = "name in outputs"},
    {"tools[].shape", TOOL(shape), FIXED, .forms = PEL_FORM_WORD, ALTERNATIVE,
     .doc = "shape of the tool; its dimensions are further keys of the tool"},
    {"tools[].mesh", TOOL(mesh), MAP, ALTERNATIVE, .like = "<mesh>",
     .doc = "the tool's surface about its center, open or closed; presses by `contact`"},
    {"tools[].radius", TOOL(radius), NUMBER_OR("auto"), .unit = "m", POSITIVE, .needs = "shape", .needs_word = "sphere",
     REQUIRED, WHEN(has_radius), IMPLYING,
     .doc = "radius of the sphere; auto: 6 % of the diagonal of the box about the bodies"},
    {"tools[].radius", NUMBER_OR("auto"), .unit = "m", POSITIVE, .needs = "shape", .needs_word = "capsule", REQUIRED,
     .doc = "radius of the capsule; auto: 3 % of that diagonal"},
    {"tools[].length", TOOL(half_length), NUMBER_OR("auto"), .unit = "m", POSITIVE, .needs = "shape",
     .needs_word = "capsule", REQUIRED, FACTOR(2), WHEN(has_length), IMPLYING,
     .doc = "distance of the centers of the caps, along the tool's z axis; auto: 20 % of that diagonal"},
    {"tools[].size", TOOL(half_extents), .forms = PEL_FORM_VECTOR | PEL_FORM_WORD, WORDS("auto"), .unit = "m", POSITIVE,
     .needs = "shape", .needs_word = "box", REQUIRED, FACTOR(2), WHEN(has_size), IMPLYING,
     .doc = "full lengths of the box along the tool's axes; auto: 12 % of that diagonal each"},
    {"tools[].edge", TOOL(edge), FIXED, LIST, BETWEEN(2, 2), .needs = "shape", .needs_word = "blade", REQUIRED,
     .doc = "the two ends of the blade's edge in the frame of the tool. What the edge passes through opens along its "
            "way, one edge of the mesh after the other"},
    {"tools[].edge", LIST, BETWEEN(2, 2), .needs = "shape", .needs_word = "hook", REQUIRED,
     .doc = "the two ends of the hook's edge, which takes the rim or lip that it passes over, and holds it"},
    {"tools[].edge", LIST, BETWEEN(2, 2), .needs = "shape", .needs_word = "scissors", REQUIRED,
     .doc = "the tips of both blades, open, which turn about the origin of the tool's frame. What lies between them "
            "opens while they close"},
    {"tools[].edge[]", VECTOR, .unit = "m", .doc = "one end"},
    {"tools[].closing", TOOL_LIST(closing, closing_count), FIXED, LIST, COUNT_FROM(1), .needs = "shape",
     .needs_word = "scissors", REQUIRED, WHEN(is_scissors),
     .doc = "how far the scissors have closed over time, from 0 (open) to 1: the share of the blades, from the origin, "
            "that has cut. Nothing is cut while they open"},
    {"tools[].closing[]", .forms = PEL_FORM_KEY, .doc = "time [s] and share"},
    {"tools[].sharpness", TOOL(sharpness), NUMBER, .unit = "J/m2", POSITIVE, .needs = "shape", .needs_word = "blade",
     AUTO(0), WHEN(is_blade), DIRECT,
     .doc = "energy that the blade takes for each new area of the cut, its length times the thickness of the sheet. It "
            "presses until its force is that energy per length, and cuts under it. Default: cuts without a force"},
    {"tools[].kerf", TOOL(kerf), NUMBER, .unit = "m", POSITIVE, .needs = "shape", .needs_word = "blade", AUTO(0),
     WHEN(is_blade), DIRECT,
     .doc = "width of the blade: a longer part of the edge that lies on a surface pierces it under a force that is "
            "larger in proportion. Default: the thickness of the sheet"},
    {"tools[].body", TOOL(body), .initial = -1, TEXT, .doc = "the only body that the tool acts on; default: all"},
    {"tools[].friction", TOOL(friction), NUMBER, AT_LEAST(0), AUTO(-1), WHEN(is_instrument),
     .doc = "Coulomb's coefficient of the tool; default: that of `contact`"},
    {"tools[].thickness", TOOL(thickness), NUMBER, .unit = "m", POSITIVE, AUTO(-1), WHEN(is_instrument), IMPLYING,
     .doc = "contact thickness of the tool; a body and the tool keep a distance of half the thickness of each; "
            "default: that of `contact`"},
    {"tools[].restitution", TOOL(restitution), NUMBER, BETWEEN(0, 1), AUTO(-1), WHEN(is_instrument),
     .doc = "coefficient of restitution of the tool; default: that of `contact`"},
    {"tools[].press", TOOL(press), BOOLEAN, DEFAULT(true), WHEN(is_instrument),
     .doc = "true: pushes bodies out of the tool"},
    {"tools[].max_force", TOOL(grasp_max_force), NUMBER_OR("auto"), .unit = "N", POSITIVE, .needs = "grasp",
     .preset = "auto", AUTO(0), WHEN(grasps), DIRECT,
     .doc = "largest force of the grasp: the sum of the magnitudes of the forces on grasped vertices; above it those "
            "with the largest forces are released. auto: ten times the force that doubles the length of the sheet of "
            "these vertices, beside their inertia, and a grasp that contact has stopped for some steps lets go; pbd: "
            "no limit"},
    {"tools[].max_force", NUMBER, .unit = "N", POSITIVE, .needs = "shape", .needs_word = "hook",
     .doc = "largest force of the hook, which lets go above it; default: no limit"},
    {"tools[].grasp", TOOL(grasp), MAP, .doc = "holds the vertices inside the tool and near its surface; optional"},
    {"tools[].grasp.from", TOOL(grasp_from), NUMBER, .unit = "s", AT_LEAST(0), .preset = "0", WHEN(grasps), DIRECT,
     IMPLYING, .doc = "closes at this time"},
    {"tools[].grasp.until", TOOL(grasp_until), NUMBER_OR("end"), .unit = "s", POSITIVE, .preset = "end",
     AUTO((double)HUGE_VAL), WHEN(grasps), DIRECT, IMPLYING, .doc = "opens at this time"},
    {"tools[].grasp.reach", TOOL(reach), NUMBER, .unit = "m", POSITIVE, REQUIRED, WHEN(grasps), DIRECT,
     .doc = "grasps vertices inside the tool (a mesh must be closed) and within this distance of its surface"},
    {"tools[].grasp.max_force", TOOL(grasp_max_force), NUMBER, .unit = "N", POSITIVE, AUTO(0), WHEN(grasps), DIRECT,
     .doc = "older place of `max_force` of the tool"},
    {"tools[].grasp.one_patch", TOOL(grasp_one_patch), BOOLEAN, DEFAULT(false), WHEN(grasps), DIRECT,
     .doc = "true: of the vertices in reach only those that edges join, over vertices in reach, to the one nearest to "
            "the tool's center, so that a flap is grasped without what lies under it"},
    {"tools[].grasp.lead", TOOL(leads), FIXED, MAP,
     .doc =
         "forceps that lead a tear around an axis: once closed the tool leaves `motion`, moves along the circle "
         "through the nearest tip, grasps the flap anew where it is far from the tip, and lifts it when the tear has "
         "ended. It grasps one patch"},
    {"tools[].grasp.lead.center", TOOL(lead_center), FIXED, VECTOR, .unit = "m", .preset = "[0, 0, 0]", WHEN(leads),
     .doc = "a point of the axis"},
    {"tools[].grasp.lead.axis", TOOL(lead_axis), FIXED, VECTOR, .preset = "[0, 0, 1]", WHEN(leads),
     .doc = "direction of the axis, away from the surface, of any length but 0"},
    {"tools[].grasp.lead.radius", TOOL(lead_radius), NUMBER, .unit = "m", POSITIVE, REQUIRED, WHEN(leads), DIRECT,
     .doc = "radius of the circle at rest, about the axis"},
    {"tools[].grasp.lead.speed", TOOL(lead_speed), NUMBER, .unit = "m/s", POSITIVE, REQUIRED, WHEN(leads), DIRECT,
     .doc = "speed of the tool; a flap that is folded over tears at half of it"},
    {"tools[].grasp.lead.outward", TOOL(lead_outward), NUMBER, .unit = "degrees", BETWEEN(-90, 90), DEFAULT(0),
     FACTOR(57.29577951308232), WHEN(leads), DIRECT,
     .doc = "turns the pull away from the axis; other than 0, the tear is not led back to the circle"},
    {"tools[].grasp.lead.regrasp", TOOL(lead_regrasp), NUMBER, .unit = "m", POSITIVE, REQUIRED, WHEN(leads), DIRECT,
     .doc =
         "distance from the tip beyond which the flap is grasped anew, five edges behind it; at least four times the "
         "radius of the tool and its reach"},
    {"tools[].motion", TOOL_LIST(keys, key_count), LIST, COUNT_FROM(1), REQUIRED,
     .doc = "poses over time, linear between the keys in position and angle; one key for a fixed tool"},
    {"tools[].motion[]", MAP, .doc = "one pose"},
    {"tools[].motion[].time", NUMBER, .unit = "s", AT_LEAST(0), .preset = "0", .doc = "time of the pose"},
    {"tools[].motion[].position", .forms = PEL_FORM_VECTOR | PEL_FORM_MAP, .like = "<place>", .unit = "m", REQUIRED,
     .doc = "center of the tool, or a place above a body at rest"},
    {"tools[].motion[].rotation", MAP,
     .doc = "rotation of the tool about its center; optional. Between keys with the same axis the angle is linear as "
            "written, so from 0 to 360 is a full turn. Between keys with different axes the number of whole turns is "
            "linear, and the rest is interpolated spherically"},
    {"tools[].motion[].rotation.axis", VECTOR, REQUIRED, .doc = "axis of rotation, of any length but 0"},
    {"tools[].motion[].rotation.angle", NUMBER, .unit = "degrees", REQUIRED,
     .doc = "angle, counter-clockwise; from 0 to 720 is two turns"},

    {"attachments", DEFS_OF(SIM, pel_sim_def, ties, tie_count, TIE, TIES), LIST, .preset = "[]",
     .doc = "vertices held to another body, a tool or a place; each reports its force"},
    {"attachments[]", MAP, .doc = "one attachment"},
    {"attachments[].name", OF(TIE, pel_tie_def, name, NONE), FIXED, NAME, .preset = "attachment#",
     .doc = "name in outputs"},
    {"attachments[].body", TIE(body), FIXED, TEXT, .doc = "body whose vertices are held; optional if there is one"},
    {"attachments[].at", TIE_LIST(vertices, vertex_count), FIXED, REGION, REQUIRED, .doc = "vertices that are held"},
    {"attachments[].to", TIE(target), FIXED, MAP, .doc = "what holds them; default: the places where they are"},
    {"attachments[].to.body", TIE(to_body), FIXED, .initial = -1, TEXT, ALTERNATIVE,
     .doc = "another body: each vertex is held to the nearest point of its triangles at rest"},
    {"attachments[].to.tool", TIE(tool), FIXED, .initial = -1, TEXT, ALTERNATIVE,
     .doc = "tool that carries them, where they are in its frame"},
    {"attachments[].stiffness", TIE(stiffness), FIXED, NUMBER, .unit = "N/m", POSITIVE, AUTO(0),
     .doc =
         "spring stiffness at each vertex; default: rigid for xpbd and pbd, else a hundred times that of a vertex of "
         "the material"},
    {"attachments[].from", TIE(from), FIXED, NUMBER, .unit = "s", AT_LEAST(0), DEFAULT(0),
     .doc = "begins at this time"},
    {"attachments[].until", TIE(until), FIXED, NUMBER_OR("end"), .unit = "s", POSITIVE, .preset = "end",
     AUTO((double)HUGE_VAL), .doc = "lets go at this time"},
    {"attachments[].close", TIE(close), FIXED, NUMBER, .unit = "s", AT_LEAST(0), AUTO(-1),
     .doc = "time in which the vertices are drawn to the other body; default: they keep their distance"},
    {"attachments[].strength", TIE(strength), FIXED, NUMBER, .unit = "N", POSITIVE, AUTO(0),
     .doc = "force above which a vertex is let go for good; default: no limit"},

    {"joints", DEFS_OF(SIM, pel_sim_def, joints, joint_count, JOINT, TIES), LIST, .preset = "[]",
     .doc = "joints of rigid bodies, to the world or to each other, with motors and limits"},
    {"joints[]", MAP, .doc = "one joint"},
    {"joints[].name", OF(JOINT, pel_joint_def, name, NONE), FIXED, NAME, .preset = "joint#", .doc = "name in outputs"},
    {"joints[].body", JOINT(body), FIXED, TEXT, .doc = "rigid body that the joint holds; optional if there is one"},
    {"joints[].to", JOINT(to_body), FIXED, .initial = -1, TEXT, .doc = "another rigid body; default: the world"},
    {"joints[].kind", JOINT(kind), FIXED, WORD("ball", "hinge", "slider", "weld"), REQUIRED,
     .doc = "ball keeps a point of both together, hinge leaves the turn about an axis, slider the way along it, weld "
            "nothing"},
    {"joints[].point", JOINT(point), FIXED, VECTOR, .unit = "m", REQUIRED, .doc = "point of the joint at rest"},
    {"joints[].axis", JOINT(axis), FIXED, VECTOR, .preset = "[0, 0, 1]",
     .doc = "axis of a hinge or slider at rest, of any length but 0"},
    {"joints[].least", JOINT(least), FIXED, NUMBER, AUTO(-(double)HUGE_VAL),
     .doc = "least position of a hinge [degrees, counter-clockwise from rest] or slider [m from rest]; default: none"},
    {"joints[].most", JOINT(most), FIXED, NUMBER, AUTO((double)HUGE_VAL), .doc = "largest position; default: none"},
    {"joints[].motor", MAP, .doc = "motor of a hinge or slider"},
    {"joints[].motor.speed", JOINT(speed), FIXED, NUMBER, REQUIRED,
     .doc = "speed that it aims at [degrees/s of a hinge, m/s of a slider]; 0 = a brake"},
    {"joints[].motor.strength", JOINT(strength), FIXED, NUMBER, POSITIVE, REQUIRED,
     .doc = "largest torque of a hinge [N m] or force of a slider [N]"},

    {"stitches", LIST, .preset = "[]",
     .doc = "seams: pairs of vertices of two borders, drawn together and held; each reports its force"},
    {"stitches[]", MAP, .doc = "one seam"},
    {"stitches[].name", NAME, .preset = "stitch#", .doc = "name in outputs"},
    {"stitches[].a", MAP, REQUIRED, .doc = "one border"},
    {"stitches[].a.body", TEXT, .doc = "its body; optional if there is one"},
    {"stitches[].a.at", REGION, REQUIRED, .doc = "its vertices"},
    {"stitches[].b", MAP, REQUIRED, .doc = "the other border"},
    {"stitches[].b.body", TEXT, .doc = "its body; optional if there is one"},
    {"stitches[].b.at", REGION, REQUIRED,
     .doc =
         "its vertices, as many as those of `a`; each is paired with the nearest one left, in the order of distance"},
    {"stitches[].close", NUMBER, .unit = "s", AT_LEAST(0), .preset = "0.5", .doc = "time in which the pairs meet"},
    {"stitches[].stiffness", NUMBER, .unit = "N/m", POSITIVE, .doc = "of each pair; default as that of `attachments`"},
    {"stitches[].from", NUMBER, .unit = "s", AT_LEAST(0), .preset = "0", .doc = "begins at this time"},
    {"stitches[].until", NUMBER_OR("end"), .unit = "s", POSITIVE, .preset = "end", .doc = "opens at this time"},
    {"stitches[].strength", NUMBER, .unit = "N", POSITIVE,
     .doc = "force above which a pair opens for good; default: no limit"},

    {"cuts", DEFS_OF(SIM, pel_sim_def, cuts, cut_count, CUT, CUTS), LIST, .preset = "[]",
     .doc = "cuts that open a surface along a path, for bodies that do not refine"},
    {"cuts[]", MAP, .doc = "one cut"},
    {"cuts[].at", CUT(at), FIXED, NUMBER, .unit = "s", AT_LEAST(0), DEFAULT(0),
     .doc = "time of the cut: the start of the first step that begins then or later"},
    {"cuts[].body", CUT(body), TEXT, .doc = "name of the body; optional if there is one"},
    {"cuts[].path", CUT_LIST(vertices, vertex_count), LIST, COUNT_FROM(2), REQUIRED,
     .doc = "points of the rest shape, or numbers of vertices that edges join. Between points the cut runs straight "
            "over the surface: vertices of the mesh near it are moved onto it in the rest shape. It ends inside the "
            "surface or at its border; a path that ends where it begins cuts a piece out"},
    {"cuts[].path[]", .forms = PEL_FORM_VECTOR | PEL_FORM_INTEGER, .unit = "m", .doc = "one point or vertex"},

    {"seams", DEFS_OF(SIM, pel_sim_def, seams, seam_count, SEAM, CUTS), LIST, .preset = "[]",
     .doc = "edges of a surface that open by themselves, such as a perforation, for bodies that do not refine"},
    {"seams[]", MAP, .doc = "one seam, with `strength`, `opens_at` or both"},
    {"seams[].body", SEAM(body), TEXT, .doc = "name of the body; optional if there is one"},
    {"seams[].path", SEAM_LIST(path, path_count), LIST, COUNT_FROM(2), ALTERNATIVE,
     .doc = "a line as `cuts[].path`: points of the rest shape, or numbers of vertices that edges join"},
    {"seams[].path[]", .forms = PEL_FORM_VECTOR | PEL_FORM_INTEGER, .unit = "m", .doc = "one point or vertex"},
    {"seams[].vertices", SEAM_LIST(vertices, vertex_count), REGION, ALTERNATIVE,
     .doc = "all edges that join two of these vertices; all: every edge of the body"},
    {"seams[].strength", SEAM(strength), FIXED, NUMBER, .unit = "N/m", POSITIVE, AUTO(0),
     .doc = "force per length at rest across an edge, from tension and shear, that opens it; that of a sheet is its "
            "strength in Pa times its thickness. Default: no force opens the seam"},
    {"seams[].opens_at", SEAM(opens_at), FIXED, NUMBER, .unit = "s", AT_LEAST(0), AUTO(-1),
     .doc = "time at which the whole seam opens: the start of the first step that begins then or later. Default: no "
            "time opens it"},

    {"tear", MAP, .preset = "{}", .doc = "growth of tears in bodies with a toughness"},
    {"tear.start", OF(SIM, pel_sim_def, tear.start, CUTS), FIXED, WORD("none", "borders", "anywhere"),
     .preset = "borders", .initial = PEL_TEAR_BORDERS,
     .doc = "where tears start, beside the ends of cuts, which always grow. borders: in sharp notches of the border, "
            "with an inner angle above 270 degrees, and where the stress at the border exceeds the `strength` of the "
            "body. anywhere: inside as well"},
    {"tear.max_tips", OF(SIM, pel_sim_def, tear.max_tips, CUTS), FIXED, INTEGER, COUNT_FROM(1), DEFAULT(64),
     .doc = "number of tips of a body that may grow in one step; of more, those that release most energy do"},
    {"tear.level", INTEGER, BETWEEN(0, 6), .preset = "0",
     .doc = "before anything else the meshes of bodies with a toughness become finer, each level halves the edges"},
    {"tear.region", REGION, .doc = "where: the triangles at these vertices; default: the whole body"},

    {"contact", DEF_OF(SIM, pel_sim_def, contact, CONTACT, CONTACT), .forms = PEL_FORM_MAP | PEL_FORM_WORD,
     WORDS("none"),
     .doc = "contact without interpenetration (paper B, section 4), or none. Default: several bodies, bodies and mesh "
            "tools, rigid spheres (static: rigid bodies) and tools touch each other, not themselves ({ self: false }), "
            "unless two bodies intersect at the start"},
    {"contact.self", CONTACT(self), BOOLEAN, DEFAULT(true), WHEN(is_enabled),
     STRUCTURE("parts that touch or intersect by now would be pushed apart at once"),
     .doc = "contact between parts of one body"},
    {"contact.between", CONTACT(between), BOOLEAN, DEFAULT(true), WHEN(is_enabled),
     STRUCTURE("bodies that touch or intersect by now would be pushed apart at once"),
     .doc = "contact between different bodies"},
    {"contact.thickness", CONTACT(thickness), .forms = PEL_FORM_NUMBER | PEL_FORM_TEXT, .unit = "m", POSITIVE,
     .preset = "auto", AUTO(0), WHEN(is_enabled), IMPLYING,
     .doc =
         "contact thickness of bodies and tools without their own; two surfaces keep half the thickness of each. "
         "`auto`: an open surface that deforms has that of its membrane, as far as its mesh and its start leave room, "
         "others relative 1e-4. Metres; `shell`: bodies have that of their membrane (without one an open surface that "
         "of its mass), others relative 1e-4; `relative` and a factor on the diagonal of all bodies' bounding box"},
    {"contact.friction", CONTACT(friction), NUMBER, AT_LEAST(0), .preset = "0", WHEN(is_enabled),
     .doc = "Coulomb's coefficient of bodies and tools without their own; a pair has the geometric mean of both"},
    {"contact.restitution", CONTACT(restitution), NUMBER, BETWEEN(0, 1), AUTO(-1), WHEN(is_enabled),
     .doc = "coefficient of restitution of bodies and tools without their own; a pair has the larger one. Only for "
            "methods with velocities; default: the elasticity of the bodies determines the rebound"},
    {"contact.method", CONTACT(method), WORD("conservative", "bridson"), .preset = "conservative", WHEN(is_enabled),
     .doc = "conservative: a test that misses no contact; bridson: the cubic equation of paper B. The check at the end "
            "of a step is always conservative"},
    {"contact.response", CONTACT(response), WORD("in-loop", "after"), .preset = "in-loop", WHEN(is_enabled),
     .doc =
         "in-loop: resolves contacts in every sweep of pbd and xpbd or as constraints of descent, static and implicit, "
         "and after the step until no pair is too close; after: one correction after the step, as in paper B"},
    {"contact.start", CONTACT(allow_tangled), FIXED, WORD("refuse", "tangled"), .preset = "refuse",
     .doc = "refuse: bodies that intersect at the start are an error; tangled: ignores these pairs until they have "
            "separated"},
    {"contact.sleep", CONTACT(sleep), BOOLEAN, DEFAULT(true), WHEN(is_enabled),
     .doc = "pbd, xpbd: bodies that rest in contact are left out of steps until something that moves comes near, or a "
            "load, a key or a parameter changes for them. Bodies with pinned or held vertices and models that refine "
            "stay awake"},
    {"contact.sweeps", CONTACT(sweeps), INTEGER, COUNT_FROM(1), .preset = "10", AUTO(0), WHEN(is_enabled),
     .doc = "maximum number of sweeps over the contacts after a step, six times as many with rigid bodies"},
    {"contact.limit", CONTACT(limit), INTEGER, COUNT_FROM(0), .preset = "0", WHEN(is_enabled),
     .doc = "maximum number of contacts; 0: 64 per vertex. Vertices of contacts beyond the limit are stepped back"},
    {"contact.memory_limit", CONTACT(memory_limit), FIXED, NUMBER_OR("auto"), .unit = "bytes", POSITIVE,
     .preset = "auto",
     .doc = "memory for the candidate pairs of a step. Near the limit the search keeps fewer pairs for later steps. If "
            "the pairs of one step exceed it, the step is divided or the run ends: use a smaller dt or a larger limit. "
            "auto: 1 GiB, or 4 KiB per triangle if that is more"},

    {"solver", DEF_OF(SIM, pel_sim_def, solver, SOLVER, SOLVER), MAP, .preset = "{}",
     .doc = "method and time integration"},
    {"solver.method", SOLVER(method), .forms = PEL_FORM_WORD, .words = pel_method_words, .preset = "quasi-static",
     .varies = true, STRUCTURE("the method decides what the state holds"),
     .doc = "quasi-static: x += alpha F dt^2 / m (paper A, eq. A-5); explicit: Euler's method on m a = F; pbd: paper "
            "B; pbd-distance: position-based dynamics of edge lengths; xpbd: position-based dynamics that follows the "
            "stiffness of the material; descent: minimises the energy under tools and contacts; static: equilibria by "
            "Newton's method; implicit: the midpoint rule, two stages, BDF2 or implicit Euler by Newton's method. "
            "Default: xpbd if "
            "a body has a membrane or springs by `young`, as tissue has; implicit if xpbd would be too soft or slower; "
            "quasi-static if springs are given by a stiffness in N/m"},
    {"solver.dt", SOLVER(dt), NUMBER, .unit = "s", AT_LEAST(1e-100), DEFAULT(0.01),
     REFUSED("time is counted in steps of dt", "change substeps, or make a simulation with the new dt"),
     .doc = "length of a step. Default: 0.01, or output.every if that is shorter (explicit, xpbd, implicit); explicit: "
            "half "
            "of the limit of stability at rest, refused beyond ten minutes of one core; implicit: shorter where "
            "nothing damps a vibration or load that this would not resolve, and the run takes no more than "
            "about 10 s of one core"},
    {"solver.alpha", SOLVER(alpha), NUMBER_OR("auto"), POSITIVE, .preset = "auto", AUTO(0), WHEN(is_quasi_static),
     .doc = "quasi-static: dimensionless step size; auto: chosen to be stable"},
    {"solver.velocity", SOLVER(keep_velocity), WORD("ignore", "keep"), .preset = "ignore", WHEN(is_quasi_static),
     .doc = "quasi-static: ignore computes forces without velocities, F(x, 0), so that damping has no effect; keep "
            "computes F(x, v) with the velocities v of the last step"},
    {"solver.momentum", SOLVER(momentum), NUMBER, BETWEEN(0, 0.99), .preset = "0", WHEN(is_quasi_static),
     .doc = "quasi-static: share of the last displacement that each step adds (heavy-ball steps, Polyak 1964). A body "
            "comes to rest in fewer steps, by about (1 + m) / (1 - m); it may swing on the way. Not for bodies that "
            "refine"},
    {"solver.integrator", SOLVER(symplectic), WORD("symplectic", "forward"), .preset = "symplectic",
     .values = WORD_LIST("forward", "symplectic"), .initial = true, WHEN(is_explicit),
     STRUCTURE("velocities of the two belong to different times"),
     .doc = "explicit: symplectic Euler, or forward Euler as in paper A"},
    {"solver.iterations", SOLVER(iterations), INTEGER_OR("auto"), COUNT_FROM(1), .preset = "auto", AUTO(0),
     WHEN(iterates),
     .doc = "pbd, xpbd: sweeps per substep; descent: iterations per step or, with tools or contact, in each of up to "
            "12 rounds; static, implicit: linear systems in each round. auto: 5 for pbd, 1 for xpbd, 500 for descent "
            "(50 in a round), 200 for static, 20 for implicit (40 with constraints)"},
    {"solver.substeps", SOLVER(substeps), INTEGER_OR("auto"), COUNT_FROM(1), .preset = "auto", AUTO(0),
     WHEN(has_substeps),
     .doc = "pbd, xpbd: number of parts of a step. auto: 1 for pbd; for xpbd as many as keep the stretch within 1 % of "
            "the material's, updated during the run"},
    {"solver.max_substeps", SOLVER(max_substeps), INTEGER, COUNT_FROM(1), .preset = "200", AUTO(0), WHEN(is_xpbd),
     .doc = "xpbd: maximum number of automatic substeps. A scene without `method` uses implicit if it needs more. "
            "If neither is given, it uses the cheaper method, and xpbd takes up to as many substeps as cost less than "
            "implicit"},
    {"solver.second_order", SOLVER(second_order), BOOLEAN_OR("auto"), .preset = "auto", AUTO(PEL_AUTO), WHEN(is_xpbd),
     STRUCTURE("the two remember different states"),
     .doc = "xpbd: second order in time (BDF2) for bodies that nothing touches, nor did in the step before. auto: on "
            "but for those with a gas or a target volume"},
    {"solver.drag", SOLVER(drag), NUMBER, .unit = "1/s", AT_LEAST(0), .preset = "0", WHEN(has_drag),
     .doc = "explicit, pbd, xpbd, implicit: drag of all bodies; velocities decrease as exp(-drag t)"},
    {"solver.descent", SOLVER(gradient_only), WORD("lbfgs", "gradient"), .preset = "lbfgs", WHEN(is_descent),
     .doc = "descent: L-BFGS, or plain gradient descent (paper B's comparison)"},
    {"solver.steps", INTEGER, COUNT_FROM(1),
     .doc = "static without `duration`: number of equal steps to the last key; default: steps at the largest interval "
            "that divides all key times. With path arc-length: maximum number of steps; default: 100"},
    {"solver.path", SOLVER(path), FIXED, WORD("time", "arc-length"), .preset = "time",
     .doc = "static: arc-length multiplies all loads, gravity and prescribed pressures by one load factor that starts "
            "at 0, and follows the equilibria through limit points (snap-through, a balloon beyond its largest "
            "pressure) to the factor 1. Each arc length is a step and a frame; its size is automatic; series.csv has "
            "the column load_factor"},
    {"solver.arc_length", SOLVER(arc_length), FIXED, NUMBER, .unit = "m", POSITIVE, AUTO(0), WHEN(has_path),
     .doc = "path arc-length: largest arc length of a step, the root of the mean square of the displacements; shorter "
            "steps follow sharp bends of the path. default: 5 % of the size of the largest body"},
    {"solver.branch", SOLVER(branch), FIXED, WORD("same", "lowest"), .preset = "same", WHEN(has_path),
     .doc =
         "path arc-length: where another path crosses (a bifurcation, as when a column buckles). same: goes on as it "
         "came, unstable beyond it; lowest: leaves along the lowest mode, to the minimum of the energy beside it, "
         "and goes on from there"},
    {"solver.analysis", SOLVER(analysis), FIXED, WORD("none", "modal", "buckling"), .preset = "none",
     .doc = "static: modal computes the lowest frequencies and modes of the body under its loads; buckling computes "
            "the lowest factors on all loads, gravity and pressure together at which the body buckles by linear "
            "theory. Each mode is a frame; summary.json has the numbers"},
    {"solver.modes", SOLVER(mode_count), FIXED, INTEGER, BETWEEN(1, 1000), .preset = "6",
     .doc = "number of modes of an analysis"},
    {"solver.budget", OF(SOLVER, pel_solver_def, budget, NONE), FACTOR(1000), FIXED, NUMBER, .unit = "ms", AT_LEAST(0),
     .preset = "0",
     .doc =
         "static, implicit: wall time for a step; 0: no limit. A step ends after the linear system in progress, with "
         "the best state so far; `solver_residual` in series.csv is its residual. Results depend on the machine"},
    {"solver.threads", OF(SIM, pel_sim_def, thread_count, NONE), FIXED, INTEGER, COUNT_FROM(0), .preset = "0",
     .doc = "threads of a step; 0: as many as the machine has. Unless it is 1, a further thread writes the frames. The "
            "results do not depend on it"},

    {"<anisotropy>", MAP, .doc = "a region with fibres"},
    {"<anisotropy>.mode", FIBRES(mode), FIXED, WORD("cave", "strain", "active", "curl", "normal", "muscle"),
     ALTERNATIVE, .preset = "cave",
     .doc = "normal: paper B's energy of the fibres with its gradient along the normal, moves triangles inward where "
            "fibres are shorter than at rest; cave: the same with a bounded way per step (pbd, xpbd); strain: fibres "
            "resist strain; active: fibres contract to a rest length; curl: changes the rest angles of hinges; muscle: "
            "fibres pull with activation times tension times a force-length curve"},
    {"<anisotropy>.energy", FIBRES(kind), FIXED, WORD("arap", "stvk", "sqrt"), .preset = "arap",
     .doc =
         "normal, strain: energy of the fibres. With their stretch s and stiffness k, per area: arap and sqrt k/2 (s - "
         "1)^2, stvk k/2 (s^2 - 1)^2, which is 4 times as stiff at small strain"},
    {FIBRES_PATH("stiffness"), FIBRES(stiffness), NUMBER_OR("auto"), .unit = "N/m", POSITIVE, .preset = "auto",
     .initial = 1, WHEN(has_fibres),
     .doc = "stiffness of the fibres; auto: Young's modulus times the thickness of the membrane"},
    {FIBRES_PATH("strength"), FIBRES(strength), NUMBER, .unit = "m", POSITIVE, .needs = "mode", .needs_word = "cave",
     REQUIRED, WHEN(caves),
     .doc = "inward motion of a triangle per step if its fibre is 5 % shorter than at rest; proportional to the square "
            "of the shortening"},
    {FIBRES_PATH("max_step"), FIBRES(max_step), NUMBER, BETWEEN(0, 1), .needs = "mode", .needs_word = "cave",
     DEFAULT(0.05), WHEN(has_max_step),
     .doc = "maximum inward motion of a triangle per step, relative to its edge, for any iterations and substeps"},
    {FIBRES_PATH("gradient"), FIBRES(gradient), NUMBER, .unit = "N", POSITIVE, .needs = "mode", .needs_word = "normal",
     REQUIRED, .initial = 1, WHEN(is_normal),
     .doc = "k_A of paper B: in a sweep of pbd a triangle with the energy E_A moves its corners inward by E_A / (3 "
            "k_A), if a step has five sweeps; in other methods its area carries the pressure stiffness / k_A times "
            "E_A per area. Smaller values cave in deeper"},
    {FIBRES_PATH("max_step"), NUMBER, BETWEEN(0, 1), .needs = "mode", .needs_word = "normal", .preset = "0.05",
     .doc = "pbd: maximum motion of a corner by one correction, relative to the edge; a bound that should not act "
            "(`caving_limited` in series.csv)"},
    {FIBRES_PATH("rest_length"), FIBRES(rest_length), QUANTITY, AT_LEAST(0), .needs = "mode", .needs_word = "active",
     REQUIRED, .initial = 1, WHEN(is_active), .doc = "rest length of the fibres, relative to the rest shape"},
    {FIBRES_PATH("tension"), FIBRES(tension), NUMBER, .unit = "N/m", POSITIVE, .needs = "mode", .needs_word = "muscle",
     REQUIRED, .initial = 1, WHEN(is_muscle),
     .doc = "force over width of the muscle at activation 1 and its optimum: its largest stress, 0.1 to 0.3 MPa of "
            "skeletal muscle, times its thickness"},
    {FIBRES_PATH("activation"), FIBRES(activation), QUANTITY, BETWEEN(0, 1), .needs = "mode", .needs_word = "muscle",
     REQUIRED, .initial = 1, WHEN(is_muscle),
     .doc = "of the muscle; over time by keys, over the body by a field or the weights of the region"},
    {FIBRES_PATH("optimum"), FIBRES(optimum), NUMBER, POSITIVE, .needs = "mode", .needs_word = "muscle", DEFAULT(1),
     WHEN(is_muscle), .doc = "stretch at which the muscle is strongest"},
    {FIBRES_PATH("width"), FIBRES(width), NUMBER, POSITIVE, .needs = "mode", .needs_word = "muscle", DEFAULT(0.5),
     WHEN(is_muscle), .doc = "of its force-length curve 1 - ((stretch - optimum) / width)^2, which is 0 beyond that"},
    {FIBRES_PATH("curvature"), FIBRES(curvature), NUMBER, .needs = "mode", .needs_word = "curl", DEFAULT(-1),
     WHEN(curls), .doc = "factor on the rest angles of hinges; below 0 the region bends inward"},
    {"<anisotropy>.direction", FIBRES(direction), FIXED, .forms = PEL_FORM_WORD | PEL_FORM_VECTOR,
     WORDS("center", "principal"), .preset = "center",
     .doc = "direction of the fibres: towards the center of the region, along the largest stretch, or along a vector"},
    {"<anisotropy>.region", FIBRES(weights), REGION, .preset = "all", .doc = "vertices with fibres"},

    /* members without a key of their own */
    {NULL, BODY_LIST(origins, origin_count, MESH)},
    {NULL, MEMBRANE(coordinate)},
    {NULL, BODY_LIST(released, released_count, NONE)},
    {NULL, FIBRES(axis)},
    {NULL, FIBRES(center)},
    {NULL, OF(SUPPORT, pel_support_def, body, SUPPORTS)},
    {NULL, TOOL_LIST(vertices, vertex_count)},
    {NULL, TOOL(center)},
    {NULL, TIE_LIST(to_vertices, vertex_count)},
    {NULL, TIE(sequence)},
    {NULL, TOOL(sequence)},
    {NULL, TOOL(strength)},
    {NULL, CONTACT(enabled)},
    {NULL, CONTACT(shell_thickness)},
    {NULL, CONTACT(relative_thickness)},
};

int32_t pel_def_row_count(void)
{
    return sizeof rows / sizeof *rows;
}

const pel_def_row *pel_def_row_at(int32_t index)
{
    return index >= 0 && index < pel_def_row_count() ? &rows[index] : NULL;
}
