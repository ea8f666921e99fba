#include "scene/table.h"

#include "geom/solid.h"
#include "law/membrane.h"
#include "model/bending_model.h"
#include "pellicle/preset.h"
#include "scene/shape_rows.h"
#include "stage/stepper.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define NUMBER .forms = PEL_FORM_NUMBER
#define INTEGER .forms = PEL_FORM_INTEGER
#define BOOLEAN .forms = PEL_FORM_BOOLEAN
#define BOOLEAN_OR(...) .forms = PEL_FORM_BOOLEAN | PEL_FORM_WORD, WORDS(__VA_ARGS__)
#define TEXT .forms = PEL_FORM_TEXT
#define VECTOR .forms = PEL_FORM_VECTOR
#define LIST .forms = PEL_FORM_LIST
#define MAP .forms = PEL_FORM_MAP
#define WORDS(...)                                                                                                     \
    .words = (const char *const[])                                                                                     \
    {                                                                                                                  \
        __VA_ARGS__, NULL                                                                                              \
    }
#define WORD(...) .forms = PEL_FORM_WORD, WORDS(__VA_ARGS__)
#define INTEGER_OR(...) .forms = PEL_FORM_INTEGER | PEL_FORM_WORD, WORDS(__VA_ARGS__)
#define NUMBER_OR(...) .forms = PEL_FORM_NUMBER | PEL_FORM_WORD, WORDS(__VA_ARGS__)
/* a number, over the body or over time */
#define QUANTITY .forms = PEL_FORM_NUMBER | PEL_FORM_MAP, .like = "<quantity>"
/* a number, over the body */
#define FIELD .forms = PEL_FORM_NUMBER | PEL_FORM_MAP, .like = "<field>"
#define REGION .forms = PEL_FORM_WORD | PEL_FORM_MAP, WORDS("all", "boundary"), .like = "<region>"

#define POSITIVE .range = {true, true, 0, (double)HUGE_VAL}
#define AT_LEAST(least) .range = {true, false, least, (double)HUGE_VAL}
#define BETWEEN(least, most) .range = {true, false, least, most}
#define COUNT_FROM(least) BETWEEN(least, INT32_MAX)

#define NAME TEXT, .unit = "letters", BETWEEN(1, PEL_NAME_SIZE - 1)

#define REQUIRED .required = true
#define ALTERNATIVE .alternative = true

/* in the order of the reference page and of resolved scenes */
static const pel_scene_row rows[] = {
    {"version", INTEGER, BETWEEN(1, 1), REQUIRED, .doc = "version of the scene format"},
    {"title", TEXT, .doc = "title of the run, shown in reports"},

    {"bodies", LIST, COUNT_FROM(1), REQUIRED, .doc = "deformable surfaces"},
    {"bodies[]", MAP, .doc = "one body"},
    {"bodies[].name", NAME, .preset = "body#", .doc = "name in outputs, loads and tools"},
    {"bodies[].mesh", MAP, REQUIRED, .like = "<mesh>", .doc = "the surface at rest"},
    {"bodies[].preset", WORD("tissue", "paper-a"), .preset = "tissue",
     .doc = "defaults of `mass`, `springs` and `volumetric`. tissue: density and Young's modulus, for meshes of any "
            "size and fineness; paper-a: the numbers of paper A, a mass of 1 kg per vertex, stiffnesses k = 3 and k' = "
            "1.5 N/m, dampings d = d' = 0.5 N s/m. A body with a membrane has no springs unless `springs` is given"},
    {"bodies[].mass", MAP, .preset = "{}", .doc = "mass of the vertices, by one of three keys"},
    {"bodies[].mass.per_vertex", NUMBER, .unit = "kg", POSITIVE, ALTERNATIVE,
     .doc = "mass of each vertex (paper A: 1)"},
    {"bodies[].mass.total", NUMBER, .unit = "kg", POSITIVE, ALTERNATIVE,
     .doc = "mass of the body, distributed evenly over its vertices"},
    {"bodies[].mass.density", NUMBER, .unit = "kg/m3", POSITIVE, ALTERNATIVE, .preset = "1000",
     .doc = "density of the material"},
    {"bodies[].mass.thickness", .forms = PEL_FORM_NUMBER | PEL_FORM_WORD | PEL_FORM_MAP, WORDS("auto"),
     .like = "<field>", .unit = "m", POSITIVE, .needs = "density", .preset = "auto",
     .doc = "thickness of the shell. auto: that of the membrane; without a membrane the enclosed volume over the area, "
            "so that the body is filled; for an open surface a tenth of the radius of a ball with the same area"},
    {"bodies[].springs", MAP, .preset = "{}", .doc = "structural springs on the edges (paper A, eq. A-3)"},
    {"bodies[].springs.young", QUANTITY, .unit = "Pa", AT_LEAST(0), ALTERNATIVE, .preset = "5000",
     .doc = "Young's modulus E of the skin. An edge of length L between triangles of area A has the stiffness E "
            "`thickness` A / L^2, so that the response does not depend on the fineness of the mesh"},
    {"bodies[].springs.thickness", NUMBER_OR("auto"), .unit = "m", POSITIVE, .needs = "young", .preset = "auto",
     .doc = "thickness of the skin. auto: a tenth of the body's radius, which is 3 times its volume over its area, or "
            "for an open surface the radius of a ball with the same area"},
    {"bodies[].springs.drag", QUANTITY, .unit = "1/s", AT_LEAST(0), .needs = "young", .preset = "0.5",
     .doc = "damping of each vertex per unit of its mass"},
    {"bodies[].springs.stiffness", QUANTITY, .unit = "N/m", AT_LEAST(0), ALTERNATIVE,
     .doc = "stiffness k of each edge, independent of its length (paper A: 3), so that a finer mesh is stiffer"},
    {"bodies[].springs.damping", QUANTITY, .unit = "N s/m", AT_LEAST(0), .needs = "stiffness", .preset = "0.5",
     .doc = "damping d of each vertex (eq. A-2)"},
    {"bodies[].contact", MAP, .doc = "contact parameters of this body; default: those of `contact`"},
    {"bodies[].contact.friction", NUMBER, AT_LEAST(0), .doc = "Coulomb's coefficient of the body"},
    {"bodies[].contact.thickness", NUMBER, .unit = "m", POSITIVE,
     .doc = "contact thickness of the body; two surfaces keep a distance of half the thickness of each"},
    {"bodies[].contact.restitution", NUMBER, BETWEEN(0, 1), .doc = "coefficient of restitution of the body"},
    {"bodies[].volumetric", MAP,
     .doc = "volumetric springs that model the filling: each vertex is pulled back to its rest position (paper A, eq. "
            "A-4); optional"},
    {"bodies[].volumetric.young", QUANTITY, .unit = "Pa", AT_LEAST(0), ALTERNATIVE, .preset = "5000",
     .doc = "Young's modulus E of the filling. A vertex with area A has the stiffness E A / `depth`; default: that of "
            "`springs`"},
    {"bodies[].volumetric.depth", NUMBER_OR("auto"), .unit = "m", POSITIVE, .needs = "young", .preset = "auto",
     .doc = "depth of the filling under the surface. auto: the body's radius, see springs.thickness"},
    {"bodies[].volumetric.drag", QUANTITY, .unit = "1/s", AT_LEAST(0), .needs = "young", .preset = "20",
     .doc = "damping of each vertex along its displacement, per unit of its mass"},
    {"bodies[].volumetric.stiffness", QUANTITY, .unit = "N/m", AT_LEAST(0), ALTERNATIVE,
     .doc = "stiffness k' of each vertex (paper A: 1.5)"},
    {"bodies[].volumetric.damping", QUANTITY, .unit = "N s/m", AT_LEAST(0), .needs = "stiffness", .preset = "0.5",
     .doc = "damping d' of each vertex"},
    {"bodies[].scale_with_area", BOOLEAN, .preset = "false",
     .doc = "true: the volumetric stiffness k' and the dampings d and d' are proportional to the area of a vertex"},
    {"bodies[].reference_count", INTEGER, COUNT_FROM(1), .preset = "252",
     .doc = "with scale_with_area: the stiffness and dampings are those of a vertex with the area of the body over "
            "this count (paper A: 252)"},
    {"bodies[].pinned", REGION, .doc = "vertices that never move, or move with `support`; optional"},
    {"bodies[].velocity", VECTOR, .unit = "m/s", .preset = "[0, 0, 0]",
     .doc = "velocity of the body at the start; for methods with velocities"},
    {"bodies[].angular_velocity", VECTOR, .unit = "rad/s", .preset = "[0, 0, 0]",
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

    {"bodies[].supports", LIST, .preset = "[]",
     .doc = "supports of single displacement components, for the methods static and implicit; each reports its "
            "reaction force"},
    {"bodies[].supports[]", MAP, .doc = "one support"},
    {"bodies[].supports[].name", NAME, .preset = "support#", .doc = "name in outputs, after the name of the body"},
    {"bodies[].supports[].at", REGION, REQUIRED, .doc = "supported vertices"},
    {"bodies[].supports[].fix", LIST, COUNT_FROM(0), ALTERNATIVE, .preset = "[\"x\", \"y\", \"z\"]",
     .doc = "fixed displacement components, along the axes of `frame`; [] fixes rotation only"},
    {"bodies[].supports[].fix[]", WORD("x", "y", "z"), .doc = "one component"},
    {"bodies[].supports[].symmetry", .forms = PEL_FORM_WORD | PEL_FORM_VECTOR, WORDS("x", "y", "z"), ALTERNATIVE,
     .doc = "plane of symmetry with this normal: fixes the displacement along the normal and the rotation of edges in "
            "the plane"},
    {"bodies[].supports[].frame", MAP, .needs = "fix", .doc = "axes of the components; default: x, y, z"},
    {"bodies[].supports[].frame.x", VECTOR, REQUIRED, .doc = "direction of x, of any length but 0"},
    {"bodies[].supports[].frame.y", VECTOR,
     .doc = "direction of y, made orthogonal to x; default: any direction orthogonal to x"},
    {"bodies[].supports[].displacement", VECTOR, .unit = "m", .needs = "fix", .preset = "[0, 0, 0]",
     .doc = "prescribed displacement of the fixed components, along the axes of `frame`"},
    {"bodies[].supports[].keys", LIST, COUNT_FROM(1), .needs = "displacement",
     .doc = "factor on the displacement over time, linear between the keys"},
    {"bodies[].supports[].keys[]", .forms = PEL_FORM_KEY, .doc = "time [s] and factor"},
    {"bodies[].supports[].rotation", WORD("free", "fixed"), .needs = "fix", .preset = "free",
     .doc = "fixed: clamps edges with both ends in the region, whose normals then keep their direction (bending model "
            "midedge)"},
    {"bodies[].supports[].stiffness", NUMBER, .unit = "N/m", POSITIVE, .needs = "fix",
     .doc = "spring stiffness of the support at each vertex; default: rigid"},
    {"bodies[].supports[].foundation", NUMBER, .unit = "N/m3", POSITIVE, .needs = "fix",
     .doc = "elastic (Winkler) foundation under the triangles of the region: stiffness per area at rest; optional"},

    {"bodies[].membrane", MAP,
     .doc = "thin shell: triangles that stretch like a sheet of a material (paper B, eq. 2); optional"},
    {"bodies[].membrane.preset", .forms = PEL_FORM_WORD,
     .doc = "a material of `pellicle presets`; other keys of `membrane` override its numbers"},
    {"bodies[].membrane.material", .forms = PEL_FORM_WORD, .words = pel_membrane_words, .preset = "stvk",
     .doc = "constitutive law"},
    {"bodies[].membrane.young", FIELD, .unit = "Pa", POSITIVE, REQUIRED, .supplied = "preset",
     .doc = "Young's modulus"},
    {"bodies[].membrane.poisson", NUMBER, .range = {true, true, -1, 1}, .preset = "0.3",
     .doc = "Poisson's ratio, less than 1; 0 to 0.5 for neo-hookean; mooney-rivlin and gent are incompressible and "
            "ignore it"},
    {"bodies[].membrane.thickness", FIELD, .unit = "m", POSITIVE, REQUIRED, .supplied = "",
     .doc = "thickness of the sheet; default: that of `mass`"},
    {"bodies[].membrane.mooney_ratio", NUMBER, AT_LEAST(0), .preset = "0.2", .doc = "mooney-rivlin: c2 over c1"},
    {"bodies[].membrane.extension_limit", NUMBER, POSITIVE, .preset = "50",
     .doc = "gent: limit of I1 - 3, where the polymer chains are fully extended; 30 to 100 for rubber"},
    {"bodies[].membrane.stiffening", NUMBER, POSITIVE, .preset = "10",
     .doc = "fung: b in the tangent stiffness, which grows as exp(b e^2 / 2) with the uniaxial strain e"},
    {"bodies[].membrane.strain_limit", NUMBER, .range = {true, true, 0, 0.99},
     .doc = "pbd and xpbd, for cloth: keeps principal stretches between 1 - strain_limit and 1 + strain_limit; "
            "default: no limit"},
    {"bodies[].bending", MAP,
     .doc = "resistance to bending (paper B, eq. 3); default: a body with a membrane has the flexural rigidity of its "
            "material, but none under pbd and pbd-distance"},
    {"bodies[].bending.model", .forms = PEL_FORM_WORD, .words = pel_bending_words, .preset = "hinge", .varies = true,
     .doc = "none: no resistance; isometric: paper B's model, which flattens a curved rest shape; isometric-rest: the "
            "same with the minimum of its energy at the rest shape; hinge: change of the dihedral angles; midedge: "
            "plate bending that does not depend on the mesh, only for the methods static and implicit. Default: hinge; "
            "midedge under static and implicit"},
    {"bodies[].bending.weight", NUMBER_OR("auto"), BETWEEN(0, 1), .preset = "0.01",
     .doc = "pbd: factor on the position corrections (paper B, k_B). auto: starts at 0.01, decreases by 1 % per step "
            "while the volume changes monotonically, is halved when the change of the volume reverses, and is at least "
            "0.001"},
    {"bodies[].bending.stiffness", .forms = PEL_FORM_NUMBER | PEL_FORM_WORD | PEL_FORM_MAP, WORDS("auto"),
     .like = "<field>", .unit = "N m", AT_LEAST(0), .preset = "auto",
     .doc = "flexural rigidity D, for all methods but pbd and pbd-distance; auto: E h^3 / (12 (1 - nu^2)) of the "
            "membrane"},
    {"bodies[].anisotropy", .forms = PEL_FORM_MAP | PEL_FORM_LIST, COUNT_FROM(1), .like = "<anisotropy>",
     .doc = "regions with fibres (paper B, section 3): one map or a list of them; optional"},
    {"bodies[].anisotropy[]", MAP, .like = "<anisotropy>", .doc = "one region with fibres"},
    {"bodies[].pressure", MAP, .doc = "pressure on the surface; optional"},
    {"bodies[].pressure.outside", QUANTITY, .unit = "Pa", ALTERNATIVE,
     .doc = "excess of the outside pressure: presses inward (paper B)"},
    {"bodies[].pressure.inside", QUANTITY, .unit = "Pa", ALTERNATIVE, .doc = "excess of the inside pressure: inflates"},
    {"bodies[].pressure.gas", MAP, ALTERNATIVE,
     .doc = "an enclosed gas with constant p V^gamma, in equilibrium at rest"},
    {"bodies[].pressure.gas.pressure", NUMBER, .unit = "Pa", POSITIVE, .preset = "101325",
     .doc = "pressure of the gas at rest and of the surrounding air"},
    {"bodies[].pressure.gas.gamma", NUMBER, BETWEEN(1, 10), .preset = "1.4",
     .doc = "adiabatic index: 1 for isothermal, 1.4 for adiabatic changes of air"},
    {"bodies[].pressure.gas.outside", QUANTITY, .unit = "Pa", .preset = "0",
     .doc = "additional outside pressure; negative inflates"},
    {"bodies[].pressure.volume", MAP, ALTERNATIVE, .doc = "drives the enclosed volume to a target"},
    {"bodies[].pressure.volume.target", QUANTITY, AT_LEAST(0), REQUIRED,
     .doc = "ratio of the target volume to the rest volume"},
    {"bodies[].pressure.volume.bulk", NUMBER, .unit = "Pa", POSITIVE, REQUIRED,
     .doc = "bulk modulus: pressure per relative difference of volume"},
    {"bodies[].pressure.volume.outside", QUANTITY, .unit = "Pa", .preset = "0",
     .doc = "outside pressure; negative inflates"},
    {"bodies[].pressure.form", WORD("consistent", "vertex-normal"), .preset = "consistent",
     .doc = "consistent: minus pressure times the gradient of the volume; vertex-normal: along the vertex normal, as "
            "paper B writes it"},
    {"bodies[].pressure.region", REGION, .preset = "all", .doc = "region on which the pressure acts"},

    {"bodies[].refine", MAP, .doc = "dynamic local refinement (paper A, section 3); optional"},
    {"bodies[].refine.levels", INTEGER, .range = {true, false, 1, 6}, .preset = "1",
     .doc = "finest level of detail; each one halves the edges"},
    {"bodies[].refine.everywhere", BOOLEAN, .preset = "false",
     .doc = "true: refines the whole body to the finest level; excludes the criteria below"},
    {"bodies[].refine.above", NUMBER, .unit = "N/m2", POSITIVE,
     .doc = "refines around vertices whose elastic force per area is larger"},
    {"bodies[].refine.below", NUMBER_OR("auto"), .unit = "N/m2", AT_LEAST(0), .needs = "above", .preset = "auto",
     .doc = "coarsens again below this value; auto: half of `above`"},
    {"bodies[].refine.curvature", MAP, .doc = "refines where the surface bends or folds; optional"},
    {"bodies[].refine.curvature.above", NUMBER, .unit = "1/m", POSITIVE, REQUIRED,
     .doc = "refines around vertices whose mean curvature has changed by more since rest"},
    {"bodies[].refine.curvature.below", NUMBER_OR("auto"), .unit = "1/m", AT_LEAST(0), .preset = "auto",
     .doc = "coarsens again below this value; auto: half of `above`"},
    {"bodies[].refine.near_tools", NUMBER, .unit = "m", POSITIVE,
     .doc = "refines triangles within this distance of a tool, before it touches; coarsens beyond 1.25 times the "
            "distance"},
    {"bodies[].refine.region", REGION, .doc = "always refines the triangles at these vertices"},
    {"bodies[].refine.region_levels", INTEGER, .range = {true, false, 0, 6}, .needs = "region", .preset = "0",
     .doc = "minimum level in the region; 0: the finest level"},
    {"bodies[].refine.rings", INTEGER, .range = {true, false, 1, 3}, .preset = "2",
     .doc = "rings of triangles that a vertex refines around it, on each level"},
    {"bodies[].refine.dwell", INTEGER, COUNT_FROM(0), .needs = "above, curvature, near_tools", .preset = "50",
     .doc = "steps that a vertex must stay below `below` before it coarsens"},
    {"bodies[].refine.interval", INTEGER, COUNT_FROM(1), .needs = "above, curvature, near_tools", .preset = "10",
     .doc = "number of steps in which every vertex is tested once; use 1 if steps are few and large, as under static"},
    {"bodies[].refine.budget", INTEGER, COUNT_FROM(0), .preset = "0",
     .doc = "maximum number of triangles of the body; the strongest candidates are refined first. 0: no limit"},
    {"bodies[].refine.springs", WORD("van-gelder", "unchanged"), .preset = "van-gelder",
     .doc = "stiffness on finer levels: van-gelder scales it by area over squared length; unchanged keeps it"},

    {"gravity", VECTOR, .unit = "m/s2", .preset = "[0, 0, 0]", .doc = "acceleration of all bodies"},

    {"loads", LIST, .preset = "[]", .doc = "forces on vertices over time"},
    {"loads[]", MAP, .doc = "one load"},
    {"loads[].name", NAME, .preset = "load#", .doc = "name in messages and in parameters"},
    {"loads[].body", TEXT, .doc = "name of the body; optional if there is one"},
    {"loads[].force", VECTOR, .unit = "N", REQUIRED, .doc = "the force; `per` defines how it is distributed"},
    {"loads[].at", REGION, .preset = "all", .doc = "loaded vertices"},
    {"loads[].per", WORD("total", "vertex", "length", "moment"), .preset = "total",
     .doc = "total: each vertex has an equal part of the force, whatever its area (a force per area is a pressure or "
            "gravity); vertex: it acts on each vertex; length: force per metre of the boundary edges with both ends "
            "in the region [N/m]; moment: moment per metre of these edges [N m/m], whose component along an edge "
            "turns the surface about it (bending model midedge)"},
    {"loads[].follower", BOOLEAN, .needs = "per", .needs_word = "length", .preset = "false",
     .doc = "true: the force rotates with the edge and its triangle"},
    {"loads[].from", NUMBER, .unit = "s", AT_LEAST(0), .preset = "0", .doc = "acts from this time on"},
    {"loads[].until", NUMBER_OR("end"), .unit = "s", POSITIVE, .preset = "end", .doc = "acts up to this time"},
    {"loads[].keys", LIST, COUNT_FROM(1), .doc = "factor on the force over time, linear between the keys"},
    {"loads[].keys[]", .forms = PEL_FORM_KEY, .doc = "time [s] and factor"},

    {"tools", LIST, .preset = "[]", .doc = "rigid instruments that press and grasp; the force on each is reported"},
    {"tools[]", MAP, .doc = "one tool"},
    {"tools[].name", NAME, .preset = "tool#", .doc = "name in outputs"},
    {"tools[].shape", .forms = PEL_FORM_WORD, ALTERNATIVE,
     .doc = "shape of the tool; its dimensions are further keys of the tool"},
    {"tools[].mesh", MAP, ALTERNATIVE, .like = "<mesh>",
     .doc = "the tool's surface about its center, open or closed; needs `contact`"},
    {"tools[].radius", NUMBER, .unit = "m", POSITIVE, .needs = "shape", .needs_word = "sphere", REQUIRED,
     .doc = "radius of the sphere"},
    {"tools[].radius", NUMBER, .unit = "m", POSITIVE, .needs = "shape", .needs_word = "capsule", REQUIRED,
     .doc = "radius of the capsule"},
    {"tools[].length", NUMBER, .unit = "m", POSITIVE, .needs = "shape", .needs_word = "capsule", REQUIRED,
     .doc = "distance of the centers of the caps, along the tool's z axis"},
    {"tools[].size", VECTOR, .unit = "m", POSITIVE, .needs = "shape", .needs_word = "box", REQUIRED,
     .doc = "full lengths of the box along the tool's axes"},
    {"tools[].body", TEXT, .doc = "the only body that the tool acts on; default: all"},
    {"tools[].friction", NUMBER, AT_LEAST(0), .doc = "Coulomb's coefficient of the tool; default: that of `contact`"},
    {"tools[].thickness", NUMBER, .unit = "m", POSITIVE,
     .doc = "contact thickness of the tool; a body and the tool keep a distance of half the thickness of each; "
            "default: that of `contact`"},
    {"tools[].restitution", NUMBER, BETWEEN(0, 1),
     .doc = "coefficient of restitution of the tool; default: that of `contact`"},
    {"tools[].press", BOOLEAN, .preset = "true", .doc = "true: pushes bodies out of the tool"},
    {"tools[].grasp", MAP, .doc = "holds the vertices inside the tool and near its surface; optional"},
    {"tools[].grasp.from", NUMBER, .unit = "s", AT_LEAST(0), .preset = "0", .doc = "closes at this time"},
    {"tools[].grasp.until", NUMBER_OR("end"), .unit = "s", POSITIVE, .preset = "end", .doc = "opens at this time"},
    {"tools[].grasp.reach", NUMBER, .unit = "m", POSITIVE, REQUIRED,
     .doc = "grasps vertices inside the tool (a mesh must be closed) and within this distance of its surface"},
    {"tools[].grasp.max_force", NUMBER, .unit = "N", POSITIVE,
     .doc = "maximum of the sum of the magnitudes of the forces on grasped vertices; above it the vertices with the "
            "largest forces are released; default: no limit"},
    {"tools[].motion", LIST, COUNT_FROM(1), REQUIRED,
     .doc = "poses over time, linear between the keys in position and angle; one key for a fixed tool"},
    {"tools[].motion[]", MAP, .doc = "one pose"},
    {"tools[].motion[].time", NUMBER, .unit = "s", AT_LEAST(0), .preset = "0", .doc = "time of the pose"},
    {"tools[].motion[].position", VECTOR, .unit = "m", REQUIRED, .doc = "center of the tool"},
    {"tools[].motion[].rotation", MAP,
     .doc = "rotation of the tool about its center; optional. Between keys with the same axis the angle is linear as "
            "written, so from 0 to 360 is a full turn. Between keys with different axes the number of whole turns is "
            "linear, and the rest is interpolated spherically"},
    {"tools[].motion[].rotation.axis", VECTOR, REQUIRED, .doc = "axis of rotation, of any length but 0"},
    {"tools[].motion[].rotation.angle", NUMBER, .unit = "degrees", REQUIRED,
     .doc = "angle, counter-clockwise; from 0 to 720 is two turns"},

    {"contact", MAP, .doc = "contact without interpenetration (paper B, section 4); optional"},
    {"contact.self", BOOLEAN, .preset = "true", .doc = "contact between parts of one body"},
    {"contact.between", BOOLEAN, .preset = "true", .doc = "contact between different bodies"},
    {"contact.thickness", .forms = PEL_FORM_NUMBER | PEL_FORM_TEXT, .unit = "m", POSITIVE, .preset = "relative 1e-4",
     .doc = "contact thickness of bodies and tools without their own; two surfaces keep a distance of half the "
            "thickness of each. A number of metres, or `relative` and a factor on the diagonal of the bounding box of "
            "all bodies (at most half the shortest edge)"},
    {"contact.friction", NUMBER, AT_LEAST(0), .preset = "0",
     .doc = "Coulomb's coefficient of bodies and tools without their own; a pair has the geometric mean of both"},
    {"contact.restitution", NUMBER, BETWEEN(0, 1),
     .doc = "coefficient of restitution of bodies and tools without their own; a pair has the larger one. Only for "
            "methods with velocities; default: the elasticity of the bodies determines the rebound"},
    {"contact.method", WORD("conservative", "bridson"), .preset = "conservative",
     .doc = "conservative: a test that misses no contact; bridson: the cubic equation of paper B. The check at the end "
            "of a step is always conservative"},
    {"contact.response", WORD("in-loop", "after"), .preset = "in-loop",
     .doc =
         "in-loop: resolves contacts in every sweep of pbd and xpbd or as constraints of descent, static and implicit, "
         "and after the step until no pair is too close; after: one correction after the step, as in paper B"},
    {"contact.start", WORD("refuse", "tangled"), .preset = "refuse",
     .doc = "refuse: bodies that intersect at the start are an error; tangled: ignores these pairs until they have "
            "separated"},
    {"contact.sweeps", INTEGER, COUNT_FROM(1), .preset = "10",
     .doc = "maximum number of sweeps over the contacts after a step"},
    {"contact.limit", INTEGER, COUNT_FROM(0), .preset = "0",
     .doc = "maximum number of contacts; 0: 64 per vertex. Vertices of contacts beyond the limit are stepped back"},
    {"contact.memory_limit", NUMBER_OR("auto"), .unit = "bytes", POSITIVE, .preset = "auto",
     .doc = "memory for the candidate pairs of a step. Near the limit the search keeps fewer pairs for later steps. If "
            "the pairs of one step exceed it, the step is divided or the run ends: use a smaller dt or a larger limit. "
            "auto: 1 GiB, or 4 KiB per triangle if that is more"},

    {"solver", MAP, .preset = "{}", .doc = "method and time integration"},
    {"solver.method", .forms = PEL_FORM_WORD, .words = pel_method_words, .preset = "quasi-static", .varies = true,
     .doc = "quasi-static: x += alpha F dt^2 / m (paper A, eq. A-5); explicit: Euler's method on m a = F; pbd: paper "
            "B; pbd-distance: position-based dynamics of edge lengths; xpbd: position-based dynamics that follows the "
            "stiffness of the material; descent: minimises the energy under tools and contacts; static: equilibria by "
            "Newton's method; implicit: the midpoint rule, BDF2 or implicit Euler by Newton's method. Default: xpbd if "
            "a body has a membrane or springs by `young`, as tissue has; implicit if xpbd would be too soft or slower; "
            "quasi-static if springs are given by a stiffness in N/m"},
    {"solver.dt", NUMBER, .unit = "s", POSITIVE, .preset = "0.01", .doc = "length of a step"},
    {"solver.alpha", NUMBER_OR("auto"), POSITIVE, .preset = "auto",
     .doc = "quasi-static: dimensionless step size; auto: a value that is stable on the mesh"},
    {"solver.velocity", WORD("ignore", "keep"), .preset = "ignore",
     .doc = "quasi-static: ignore computes forces without velocities, F(x, 0), so that damping has no effect; keep "
            "computes F(x, v) with the velocities v of the last step"},
    {"solver.integrator", WORD("symplectic", "forward"), .preset = "symplectic",
     .doc = "explicit: symplectic Euler, or forward Euler as in paper A"},
    {"solver.iterations", INTEGER_OR("auto"), COUNT_FROM(1), .preset = "auto",
     .doc = "pbd, xpbd: sweeps per substep; descent: iterations per step or, with tools or contact, in each of up to "
            "12 rounds; static, implicit: linear systems in each round. auto: 5 for pbd, 1 for xpbd, 500 for descent "
            "(50 in a round), 200 for static, 20 for implicit (40 with constraints)"},
    {"solver.substeps", INTEGER_OR("auto"), COUNT_FROM(1), .preset = "auto",
     .doc = "pbd, xpbd: number of parts of a step. auto: 1 for pbd; for xpbd as many as keep the stretch within 5 % of "
            "the material's, updated during the run"},
    {"solver.max_substeps", INTEGER, COUNT_FROM(1), .preset = "200",
     .doc = "xpbd: maximum number of automatic substeps. A scene without `method` uses implicit if it needs more, or "
            "if implicit is cheaper and `max_substeps` is not given"},
    {"solver.second_order", BOOLEAN_OR("auto"), .preset = "auto",
     .doc = "xpbd: second order in time (BDF2). auto: on without tools, contact, gas and target volumes"},
    {"solver.drag", NUMBER, .unit = "1/s", AT_LEAST(0), .preset = "0",
     .doc = "explicit, pbd, xpbd, implicit: drag of all bodies; velocities decrease as exp(-drag t)"},
    {"solver.descent", WORD("lbfgs", "gradient"), .preset = "lbfgs",
     .doc = "descent: L-BFGS, or plain gradient descent (paper B's comparison)"},
    {"solver.steps", INTEGER, COUNT_FROM(1),
     .doc = "static without `duration`: number of equal steps to the last key; default: steps at the largest interval "
            "that divides all key times. With path arc-length: maximum number of steps; default: 100"},
    {"solver.path", WORD("time", "arc-length"), .preset = "time",
     .doc = "static: arc-length multiplies all loads, gravity and prescribed pressures by one load factor that starts "
            "at 0, and follows the equilibria through limit points (snap-through, a balloon beyond its largest "
            "pressure) to the factor 1. Each arc length is a step and a frame; its size is automatic; series.csv has "
            "the column load_factor"},
    {"solver.analysis", WORD("none", "modal", "buckling"), .preset = "none",
     .doc = "static: modal computes the lowest frequencies and modes of the body under its loads; buckling computes "
            "the lowest factors on all loads, gravity and pressure together at which the body buckles by linear "
            "theory. Each mode is a frame; summary.json has the numbers"},
    {"solver.modes", INTEGER, BETWEEN(1, 1000), .preset = "6", .doc = "number of modes of an analysis"},
    {"solver.budget", NUMBER, .unit = "ms", AT_LEAST(0), .preset = "0",
     .doc =
         "static, implicit: wall time for a step; 0: no limit. A step ends after the linear system in progress, with "
         "the best state so far; `solver_residual` in series.csv is its residual. Results depend on the machine"},
    {"solver.threads", INTEGER, COUNT_FROM(0), .preset = "0",
     .doc = "threads of a step; 0: as many as the machine has. Unless it is 1, a further thread writes the frames. The "
            "results do not depend on it"},

    {"duration", NUMBER, .unit = "s", POSITIVE, REQUIRED, .supplied = "",
     .doc = "simulated time; optional if stop.time or stop.frames is set, and under static: its steps and frames then "
            "go to the last key, or it takes one step if nothing has keys"},
    {"stop", MAP, .doc = "conditions that end a run before its duration; optional"},
    {"stop.at_rest", NUMBER, .unit = "m/s", POSITIVE,
     .doc = "ends the run when loads and tools have stopped changing and all vertices are slower than this"},
    {"stop.volume_ratio_below", NUMBER, POSITIVE,
     .doc = "ends the run when the ratio of the volume to the rest volume is below this; needs a closed body"},
    {"stop.frames", INTEGER, COUNT_FROM(1), .doc = "ends the run after this number of steps of dt (paper B's frames)"},
    {"stop.time", NUMBER, .unit = "s", POSITIVE, .doc = "ends the run at this simulated time"},
    {"stop.self_contact", BOOLEAN, .preset = "false", .doc = "ends the run when a body touches itself or another"},

    {"session", LIST, .doc = "commands that `pellicle live` recorded, replayed bit for bit; optional"},
    {"session[]", TEXT,
     .doc = "number of the step before which the command acts, and a command of pellicle/session.h, such as 120 set "
            "solver.drag 2; in the order of steps"},

    {"output", MAP, .preset = "{}", .doc = "results in the run's folder"},
    {"output.every", NUMBER, .unit = "s", POSITIVE, ALTERNATIVE, .preset = "0.1",
     .doc = "simulated time between frames"},
    {"output.every_frame", INTEGER, COUNT_FROM(1), ALTERNATIVE, .doc = "steps between frames"},
    {"output.fields", LIST, .preset = "[\"displacement\", \"force\"]",
     .doc = "vertex fields of the frames: fields of the list below and fields of the meshes"},
    {"output.fields[]", NAME, .doc = "name of a field"},
    {"output.compress", BOOLEAN, .preset = "false",
     .doc = "compresses the .vtp files (zlib): less than half the size; writing takes several times as long"},
    {"output.precision", WORD("single", "double"), .preset = "single", .doc = "precision of the .vtp files"},
    {"output.checkpoint", NUMBER, .unit = "s", AT_LEAST(0), .preset = "0",
     .doc = "simulated time between checkpoints; 0: keeps only the last good state of a run that fails, is stopped or "
            "is killed"},

    {"<mesh>", MAP, .doc = "a surface, in metres after `scale`: a generated shape or a file"},
    {"<mesh>.shape", .forms = PEL_FORM_WORD, ALTERNATIVE,
     .doc = "a generated surface; its parameters are further keys of the mesh"},
    {"<mesh>.file", TEXT, ALTERNATIVE, .doc = "a mesh file; its path is relative to the scene"},
    {"<mesh>.format", WORD("auto", "obj", "ply", "stl", "off", "vtp"), .needs = "file", .preset = "auto",
     .doc = "format of the file; auto: by its extension and content, also glTF, FBX, 3MF and others"},
    {"<mesh>.scale", .forms = PEL_FORM_NUMBER | PEL_FORM_VECTOR, POSITIVE, .preset = "1",
     .doc = "factor on all coordinates or on x, y and z (0.001 for millimetres); applied first"},
    {"<mesh>.rotate", MAP, .doc = "rotation of the mesh about the origin; applied second"},
    {"<mesh>.rotate.axis", VECTOR, REQUIRED, .doc = "axis of rotation, of any length but 0"},
    {"<mesh>.rotate.angle", NUMBER, .unit = "degrees", REQUIRED, .doc = "angle, counter-clockwise"},
    {"<mesh>.translate", VECTOR, .unit = "m", .preset = "[0, 0, 0]", .doc = "translation; applied last"},

    {"<quantity>", MAP, .doc = "a number that varies over the body or over time"},
    {"<quantity>.field", TEXT, ALTERNATIVE, .doc = "vertex field of the mesh that gives the number at each vertex"},
    {"<quantity>.map", .forms = PEL_FORM_PAIR, .scoped = true, .needs = "field",
     .doc = "numbers at the field values 0 and 1; other values are interpolated or extrapolated linearly; default: the "
            "values of the field"},
    {"<quantity>.keys", LIST, COUNT_FROM(1), ALTERNATIVE, .scoped = true,
     .doc = "numbers over time, linear between the keys"},
    {"<quantity>.keys[]", .forms = PEL_FORM_KEY, .scoped = true, .doc = "time [s] and number"},

    {"<field>", MAP, .doc = "a number that varies over the body"},
    {"<field>.field", TEXT, ALTERNATIVE, .doc = "vertex field of the mesh that gives the number at each vertex"},
    {"<field>.map", .forms = PEL_FORM_PAIR, .scoped = true, .needs = "field",
     .doc = "numbers at the field values 0 and 1; other values are interpolated or extrapolated linearly; default: the "
            "values of the field"},

    {"<anisotropy>", MAP, .doc = "a region with fibres"},
    {"<anisotropy>.mode", WORD("cave", "strain", "active", "curl"), ALTERNATIVE, .preset = "cave",
     .doc = "cave: paper B's rule, moves triangles inward where fibres are shorter than at rest (pbd, xpbd); strain: "
            "fibres resist strain; active: fibres contract like a muscle; curl: changes the rest angles of hinges"},
    {"<anisotropy>.energy", WORD("arap", "stvk", "sqrt"), .preset = "arap",
     .doc =
         "cave, strain: energy of the fibres. With their stretch s and stiffness k, per area: arap and sqrt k/2 (s - "
         "1)^2, stvk k/2 (s^2 - 1)^2, which is 4 times as stiff at small strain"},
    {"<anisotropy>.stiffness", NUMBER_OR("auto"), .unit = "N/m", POSITIVE, .preset = "auto",
     .doc = "stiffness of the fibres; auto: Young's modulus times the thickness of the membrane"},
    {"<anisotropy>.strength", NUMBER, .unit = "m", POSITIVE, .needs = "mode", .needs_word = "cave", REQUIRED,
     .doc = "inward motion of a triangle per step if its fibre is 5 % shorter than at rest; proportional to the square "
            "of the shortening"},
    {"<anisotropy>.max_step", NUMBER, BETWEEN(0, 1), .needs = "mode", .needs_word = "cave", .preset = "0.05",
     .doc = "maximum inward motion of a triangle per step, relative to its edge, for any iterations and substeps"},
    {"<anisotropy>.rest_length", QUANTITY, AT_LEAST(0), .needs = "mode", .needs_word = "active", REQUIRED,
     .doc = "rest length of the fibres, relative to the rest shape"},
    {"<anisotropy>.curvature", NUMBER, .needs = "mode", .needs_word = "curl", .preset = "-1",
     .doc = "factor on the rest angles of hinges; below 0 the region bends inward"},
    {"<anisotropy>.direction", .forms = PEL_FORM_WORD | PEL_FORM_VECTOR, WORDS("center", "principal"),
     .preset = "center",
     .doc = "direction of the fibres: towards the center of the region, along the largest stretch, or along a vector"},
    {"<anisotropy>.region", REGION, .preset = "all", .doc = "vertices with fibres"},

    {"<region>", MAP,
     .doc = "a set of vertices of a body, selected at rest; `all`: all vertices; `boundary`: those on open edges"},
    {"<region>.sphere", MAP, ALTERNATIVE, .doc = "the vertices inside a sphere"},
    {"<region>.sphere.center", VECTOR, .unit = "m", REQUIRED, .doc = "center of the sphere"},
    {"<region>.sphere.radius", NUMBER, .unit = "m", POSITIVE, REQUIRED, .doc = "radius of the sphere"},
    {"<region>.falloff", NUMBER, .unit = "m", AT_LEAST(0), .needs = "sphere, box, nearest", .preset = "0",
     .doc = "width around the region over which its weight decreases smoothly from 1 to 0"},
    {"<region>.box", MAP, ALTERNATIVE, .doc = "the vertices inside a box parallel to the axes"},
    {"<region>.box.min", VECTOR, .unit = "m", REQUIRED, .doc = "lowest corner"},
    {"<region>.box.max", VECTOR, .unit = "m", REQUIRED, .doc = "highest corner"},
    {"<region>.vertices", LIST, COUNT_FROM(1), ALTERNATIVE, .doc = "the vertices with these numbers"},
    {"<region>.vertices[]", INTEGER, COUNT_FROM(0), .doc = "number of a vertex, from 0"},
    {"<region>.field", TEXT, ALTERNATIVE, .doc = "the vertices at which this field of the mesh exceeds `above`"},
    {"<region>.above", NUMBER, .needs = "field", .preset = "0.5", .doc = "threshold of the field"},
    {"<region>.nearest", VECTOR, .unit = "m", ALTERNATIVE, .doc = "the one vertex nearest to this point"},
};

enum { ROW_COUNT = sizeof rows / sizeof rows[0] };

/* names of the materials; null when out of memory */
/* the solids among the shapes of tools */
static const char *const *solid_words(pel_arena *arena)
{
    const char **words = pel_arena_take(arena, PEL_TOOL_SHAPE_COUNT + 1, sizeof *words);
    for (int i = 0, count = 0; words != NULL && i < PEL_TOOL_SHAPE_COUNT; i++)
        if (pel_solid_rows[i].distance != NULL)
            words[count++] = pel_solid_rows[i].word;
    return (const char *const *)words;
}

static const char *const *preset_words(pel_arena *arena)
{
    int32_t count;
    const pel_material_preset *presets = pel_material_presets(&count);
    const char **words = pel_arena_take(arena, (size_t)count + 1, sizeof *words);
    for (int32_t i = 0; words != NULL && i < count; i++)
        words[i] = presets[i].name;
    return (const char *const *)words;
}

/* length of the only prefix that a row may stand directly below */
static size_t parent_length(const char *path)
{
    const char *dot = strrchr(path, '.'), *bracket = strrchr(path, '[');
    const char *last = bracket != NULL && (dot == NULL || bracket > dot) ? bracket : dot;
    return last != NULL ? (size_t)(last - path) : 0;
}

/* the part of a path that follows its parent; null for rows such as <mesh> */
static const char *name_below(const char *path, size_t length)
{
    const char *name = path + length;
    if (length > 0 && strcmp(name, "[]") == 0)
        return name;
    name += length > 0 && *name == '.';
    return *name != '<' ? name : NULL;
}

/* Rows with the same parent as a chain, so that the rows below a prefix are found without a search over all rows. Later
   rows are in buckets, the nearest first. */
static void link_siblings(const pel_scene_row *all, size_t count, const size_t *parents, const char **names,
                          size_t *siblings, size_t *later)
{
    enum { BUCKETS = 128 };
    size_t first[BUCKETS];
    for (size_t b = 0; b < BUCKETS; b++)
        first[b] = count;
    for (size_t i = count; i-- > 0;) {
        const char *path = all[i].path;
        size_t length = parents[i], bucket = 0, j;
        if (length > 0)
            bucket = (7 * length + (unsigned char)path[length / 2] + (unsigned char)path[length - 1]) % BUCKETS;
        names[i] = name_below(path, length);
        for (j = first[bucket]; j < count && (parents[j] != length || memcmp(all[j].path, path, length) != 0);)
            j = later[j];
        siblings[i] = j;
        later[i] = first[bucket];
        if (names[i] != NULL)
            first[bucket] = i;
    }
}

const pel_scene_table *pel_scene_table_create(pel_arena *arena)
{
    size_t shape_row_count = pel_scene_shape_row_count();
    pel_scene_table *table = pel_arena_take(arena, 1, sizeof *table);
    pel_scene_row *all = pel_arena_take(arena, ROW_COUNT + shape_row_count, sizeof *all);
    size_t *parents = pel_arena_take(arena, ROW_COUNT + shape_row_count, sizeof *parents);
    size_t *siblings = pel_arena_take(arena, ROW_COUNT + shape_row_count, sizeof *siblings);
    size_t *later = pel_arena_take(arena, ROW_COUNT + shape_row_count, sizeof *later);
    const char **names = pel_arena_take(arena, ROW_COUNT + shape_row_count, sizeof *names);
    if (table == NULL || all == NULL || parents == NULL || siblings == NULL || later == NULL || names == NULL)
        return NULL;
    size_t count = 0;
    for (size_t i = 0; i < ROW_COUNT; i++) {
        all[count++] = rows[i];
        const bool is_preset = strcmp(rows[i].path, "bodies[].membrane.preset") == 0;
        if (is_preset || strcmp(rows[i].path, "tools[].shape") == 0) {
            all[count - 1].words = is_preset ? preset_words(arena) : solid_words(arena);
            if (all[count - 1].words == NULL)
                return NULL;
        }
        if (strcmp(rows[i].path, "<mesh>.shape") != 0)
            continue;
        all[count - 1].words = pel_scene_shape_words(arena);
        if (all[count - 1].words == NULL || !pel_scene_shape_rows(arena, "<mesh>", all + count))
            return NULL;
        count += shape_row_count;
    }
    for (size_t i = 0; i < count; i++)
        parents[i] = parent_length(all[i].path);
    link_siblings(all, count, parents, names, siblings, later);
    *table = (pel_scene_table){all, count, parents, names, siblings};
    return table;
}

const char *pel_scene_row_prefix(const pel_scene_row *row)
{
    if (row == NULL)
        return "";
    return row->like != NULL ? row->like : row->path;
}

const char *pel_scene_row_name(const pel_scene_row *row, const char *prefix)
{
    return name_below(row->path, strlen(prefix));
}

const pel_scene_row *pel_scene_row_next(const pel_scene_table *table, const char *prefix, const pel_scene_row *row)
{
    size_t length, i = 0;
    if (row != NULL) {
        i = table->siblings[row - table->rows];
        return i < table->row_count ? &table->rows[i] : NULL;
    }
    for (length = strlen(prefix); i < table->row_count; i++)
        if (table->parent_lengths[i] == length && table->names[i] != NULL &&
            memcmp(table->rows[i].path, prefix, length) == 0)
            return &table->rows[i];
    return NULL;
}

const pel_scene_row *pel_scene_row_find(const pel_scene_table *table, const char *prefix, const char *name)
{
    const pel_scene_row *row = pel_scene_row_next(table, prefix, NULL);
    while (row != NULL && strcmp(table->names[row - table->rows], name) != 0)
        row = pel_scene_row_next(table, prefix, row);
    return row;
}

bool pel_scene_row_needs(const pel_scene_row *row, const char *key)
{
    size_t length = strlen(key);
    for (const char *name = row->needs; *name != '\0';) {
        size_t name_length = strcspn(name, ",");
        if (name_length == length && strncmp(name, key, length) == 0)
            return true;
        name += name_length;
        name += strspn(name, ", ");
    }
    return false;
}

/* appends to text with " or " before all but the first */
static void add_form(char *text, size_t size, const char *form)
{
    size_t length = strlen(text);
    snprintf(text + length, size - length, "%s%s", length > 0 ? " or " : "", form);
}

const char *pel_scene_form_text(const pel_scene_row *row, char *text, size_t size)
{
    static const struct {
        unsigned form;
        const char *text;
    } forms[] = {
        {PEL_FORM_NUMBER, "number"},
        {PEL_FORM_INTEGER, "whole number"},
        {PEL_FORM_BOOLEAN, "true or false"},
        {PEL_FORM_TEXT, "text"},
        {PEL_FORM_PAIR, "[number, number]"},
        {PEL_FORM_KEY, "[time, value]"},
        {PEL_FORM_VECTOR, "vector [x, y, z]"},
        {PEL_FORM_LIST, "list"},
        {PEL_FORM_MAP, "map"},
    };
    text[0] = '\0';
    for (size_t i = 0; i < sizeof forms / sizeof forms[0]; i++)
        if ((row->forms & forms[i].form) != 0)
            add_form(text, size, forms[i].text);
    for (size_t i = 0; (row->forms & PEL_FORM_WORD) != 0 && row->words[i] != NULL; i++)
        add_form(text, size, row->words[i]);
    return text;
}

const char *pel_scene_range_text(pel_scene_range range, char *text, size_t size)
{
    if (!range.given)
        text[0] = '\0';
    else if (range.least == range.most)
        snprintf(text, size, "%g", range.least);
    else if (range.most < INT32_MAX)
        snprintf(text, size, "%s%g to %g", range.open ? "above " : "", range.least, range.most);
    else
        snprintf(text, size, "%s %g", range.open ? ">" : ">=", range.least);
    return text;
}

bool pel_scene_range_has(pel_scene_range range, double number)
{
    if (!range.given)
        return true;
    return (range.open ? number > range.least : number >= range.least) && number <= range.most;
}
