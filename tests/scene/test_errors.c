/* Bad scenes: each gives one message with its exact place and a remedy. */
#include "check.h"

#include <stdlib.h>
#include <time.h>

#include "pellicle/scene.h"

#include <stdlib.h>

/* four lines before the error */
#define BALL "version: 1\nduration: 2\nbodies:\n  - mesh: {shape: geodesic-sphere}\n"

typedef struct bad_scene {
    const char *text, *override; /* override null = none */
    const char *message;         /* beginning of the error's text */
} bad_scene;

static const bad_scene bad_scenes[] = {
    /* filling gives the surface other vertices, and no fields */
    {BALL "    volume: {young: 1000}\n    pinned: {vertices: [0]}\n", NULL,
     "a.yaml:6:25: error: vertex 0 of a body with `volume`, whose surface has other vertices. select by place"},
    {BALL "    volume: {young: 1000}\n    mass: {thickness: 0.001}\n", NULL,
     "a.yaml:6:12: error: the body has a `volume`: its mass is the density times its volume. omit mass.thickness"},
    {BALL "    volume: {young: 1000}\n    pressure: {inside: 5}\n", NULL,
     "a.yaml:6:16: error: the body has a `volume`: what is inside of its surface is solid. use pressure.outside"},
    {BALL "    volume: {young: {field: stiff}}\n", NULL,
     "a.yaml:5:29: error: field 'stiff' of a body with `volume`: filling does not carry fields over. select by place"},
    {BALL "    volume: {young: 1000}\n    pinned: {group: top}\n", NULL,
     "a.yaml:6:21: error: group 'top' of a body with `volume`: filling does not carry fields over. select by place"},
    {BALL "    volume: {young: 1000}\ncuts: [{path: [0, 1]}]\n", NULL,
     "a.yaml:6:8: error: a cut of a body with `volume`"},

    /* unknown keys and words */
    {BALL "    springs: {stifness: 3}\n", NULL,
     "a.yaml:5:15: error: unknown key 'stifness'. did you mean 'stiffness'?"},
    {BALL "gravitation: 3\n", NULL, "a.yaml:5:1: error: unknown key 'gravitation'. known are: version, title, "},
    {BALL "    \"mas\": 3\n", NULL, "a.yaml:5:5: error: unknown key 'mas'. did you mean 'mass'?"},
    {BALL "solver: {method: quasistatic}\n", NULL,
     "a.yaml:5:18: error: unknown method 'quasistatic'. did you mean 'quasi-static'?"},
    {BALL "solver: {method: 'xpdb'}\n", NULL, "a.yaml:5:18: error: unknown method 'xpdb'. did you mean 'xpbd'?"},
    {BALL, "bodies.0.mesh.shape=tors",
     "--set bodies.0.mesh.shape=tors: error: unknown shape 'tors'. did you mean 'torus"},
    {"version: 1\nduration: 2\nbodies:\n- mesh:\n    shape: torus\n    frequency: 3\n", NULL,
     "a.yaml:6:5: error: unknown key of shape torus: 'frequency'. known are: shape, major_radius, "},
    {BALL "tools: [{shape: box, radius: 1}]\n", NULL,
     "a.yaml:5:22: error: unknown key of shape box: 'radius'. known are: name, shape, mesh, size, "},

    /* everyday words */
    {BALL "tools: [{shape: plane}]\n", NULL,
     "a.yaml:5:17: error: unknown shape 'plane'. a floor is a box: { shape: box, size: [1, 1, 1], motion: "},
    {BALL, "bodies.0.mesh.shape=plane",
     "--set bodies.0.mesh.shape=plane: error: unknown shape 'plane'. did you mean 'grid'?"},
    {BALL, "bodies.0.mesh.shape=tube",
     "--set bodies.0.mesh.shape=tube: error: unknown shape 'tube'. did you mean 'cylinder'?"},
    {BALL "    membrane: {young: 1e5, nu: 0.3, thickness: 0.001}\n", NULL,
     "a.yaml:5:28: error: unknown key 'nu'. did you mean 'poisson'?"},
    {BALL "    membrane: {young: 1e5, thickness: 0.001, fracture_energy: 300}\n", NULL,
     "a.yaml:5:46: error: unknown key 'fracture_energy'. did you mean 'toughness'?"},
    {BALL "    membrane: {young: 1e5, thickness: 0.001, Gc: 300}\n", NULL,
     "a.yaml:5:46: error: unknown key 'Gc'. did you mean 'toughness'?"},
    {BALL "    springs: {young: 1e5, energy_release_rate: 300}\n", NULL,
     "a.yaml:5:27: error: unknown key 'energy_release_rate'. did you mean 'toughness'?"},
    {BALL "    membrane: {young: 1e5, thickness: 0.001, tear_strength: 3}\n", NULL,
     "a.yaml:5:46: error: unknown key 'tear_strength'. did you mean 'strength'?"},
    {BALL "tear: {fracture_energy: 300}\n", NULL,
     "a.yaml:5:8: error: unknown key 'fracture_energy'. did you mean 'toughness'? it is a key of bodies[].springs, "},
    {BALL "collision: true\n", NULL, "a.yaml:5:1: error: unknown key 'collision'. did you mean 'contact'?"},
    {BALL "tools: [{shape: forceps}]\n", NULL,
     "a.yaml:5:17: error: unknown shape 'forceps'. forceps are a tool of any shape with the key `grasp`"},
    {BALL "tools: [{shape: sphere, position: [0, 0, 1]}]\n", NULL,
     "a.yaml:5:25: error: unknown key 'position'. it is a key of tools[].motion[]"},
    {BALL "floor: 0\n", NULL,
     "a.yaml:5:1: error: unknown key 'floor'. a floor is a tool: { shape: box, size: [1, 1, 1], motion: "},
    {BALL "    color: red\n", NULL,
     "a.yaml:5:5: error: unknown key 'color'. a scene has no looks: `pellicle render` has --body-colors, "},
    {BALL "    joint: {}\n", NULL,
     "a.yaml:5:5: error: unknown key 'joint'. did you mean 'joints'? it is a key of the scene"},
    {BALL "    membrane: {preset: cotton}\n", NULL,
     "a.yaml:5:24: error: unknown preset 'cotton'. did you mean 'tablecloth'? it is of cotton"},
    {"version: 1\nduration: 2\nbodies:\n- mesh: {shape: grid, resolution: 3}\n", NULL,
     "a.yaml:4:23: error: unknown key 'resolution'. did you mean 'nx'?"},
    {"version: 1\nduration: 2\nbodies:\n- mesh: {shape: geodesic-sphere, resolution: 3}\n", NULL,
     "a.yaml:4:34: error: unknown key 'resolution'. did you mean 'frequency'?"},
    {"version: 1\nduration: 2\nbodies:\n- mesh: {shape: cylinder, length: 3}\n", NULL,
     "a.yaml:4:27: error: unknown key 'length'. did you mean 'height'?"},
    {BALL "timestep: 0.01\n", NULL,
     "a.yaml:5:1: error: unknown key 'timestep'. did you mean 'dt'? it is a key of solver"},
    {BALL "    membrane: {young: 100,000, thickness: 0.001}\n", NULL,
     "a.yaml:5:27: error: unknown key '000'. numbers have a point and no commas: 0.5, 100000"},

    /* a key that belongs elsewhere is told with its place, the near ones first */
    {BALL "    gas: {}\n", NULL, "a.yaml:5:5: error: unknown key 'gas'. it is a key of bodies[].pressure"},
    {BALL "    young: 5\n", NULL,
     "a.yaml:5:5: error: unknown key 'young'. it is a key of bodies[].springs, bodies[].volumetric, bodies[].volume, "
     "bodies[].membrane"},
    {BALL "    membrane: { young: 1e5, thickness: 0.001, rest_scale: { keys: [[0, 1]] } }\n", NULL,
     "a.yaml:5:61: error: unknown key 'keys'. its course over time is the key 'rest_keys' beside 'rest_scale'"},
    {BALL "    pinned: { boundary: true }\n", NULL,
     "a.yaml:5:25: error: bodies.0.pinned.boundary is 'true', it must be: whole number. it means: the vertices on one "
     "loop of open edges: its number from 0, the longest first; all loops: the word `boundary`"},
    {BALL "dt: 5\n", NULL, "a.yaml:5:1: error: unknown key 'dt'. it is a key of solver"},
    {BALL "solver: {friction: 1}\n", NULL,
     "a.yaml:5:10: error: unknown key 'friction'. it is a key of bodies[].contact, tools[], contact"},
    {BALL "solver: {gravity: 1}\n", NULL, "a.yaml:5:10: error: unknown key 'gravity'. it is a key of the scene"},
    {BALL "    radius: 5\n", NULL,
     "a.yaml:5:5: error: unknown key 'radius'. it is a key of tools[], tools[].grasp.lead, mesh, region.sphere"},
    {BALL, "solver.density=3",
     "--set solver.density=3: error: unknown key 'density'. it is a key of bodies[].mass, bod"},
    {BALL, "bodies.0.mesh.shape=sphere",
     "--set bodies.0.mesh.shape=sphere: error: unknown shape 'sphere'. did you mean 'geodesic-sphere'?"},
    {BALL "    rigid: {}\n    membrane: {young: 1e6, thickness: 1e-3}\n", NULL,
     "a.yaml:6:5: error: a rigid body has no 'membrane'. remove 'membrane'"},
    {BALL "    rigid: {}\n    mass: {total: 1}\n", NULL,
     "a.yaml:6:5: error: a rigid body has no 'mass'. give rigid.density, or rigid.mass, and remove 'mass'"},
    {BALL "    rigid: {density: 0}\n", NULL,
     "a.yaml:5:22: error: bodies.0.rigid.density is out of range: 0 kg/m3. it must be > 0 kg/m3"},
    {BALL "    membrane: {preset: steel}\n", NULL,
     "a.yaml:5:24: error: unknown preset 'steel'. did you mean 'steel-sheet'?"},

    /* wrong types */
    {BALL "    springs: {stiffness: soft}\n", NULL,
     "a.yaml:5:26: error: bodies.0.springs.stiffness is 'soft', it must be: number or map. it means: stiffness k"},
    {BALL "    springs: {stiffness: '3'}\n", NULL, "a.yaml:5:26: error: bodies.0.springs.stiffness is '3', it must be"},
    {BALL "    springs: 3\n", NULL,
     "a.yaml:5:14: error: bodies.0.springs is '3', it must be: map. write { key: value } with keys of: young, thick"},
    {"version: 1\nduration: 2\nbodies:\n  - {name: a, mesh: ball.obj}\n", NULL,
     "a.yaml:4:21: error: bodies.0.mesh is 'ball.obj', it must be: map. write { file: ball.obj }"},
    {BALL "    membrane: { young: 1e6, thickness: 1mm }\n", NULL,
     "a.yaml:5:40: error: bodies.0.membrane.thickness is '1mm', it must be: number or map. write the number without a "
     "unit; it is in m"},
    {BALL "    pinned: [0, 1, 2]\n", NULL,
     "a.yaml:5:13: error: bodies.0.pinned is a list, it must be: map or all or boundary. write { vertices: [...] }"},
    {BALL "    pinned: [{group: a}, {group: b}]\n", NULL,
     "a.yaml:5:13: error: bodies.0.pinned is a list, it must be: map or all or boundary. write { union: [...] }"},
    {BALL "wind: [1, 0, 0]\n", NULL, "a.yaml:5:7: error: wind is a list, it must be: map. write { velocity: [...] }"},
    {BALL "gravity: -9.81\n", NULL,
     "a.yaml:5:10: error: gravity is '-9.81', it must be: vector [x, y, z]. write [0, 0, -9.81] for one along z"},
    {BALL "    springs: { stiffness: 3 N/m }\n", NULL,
     "a.yaml:5:27: error: bodies.0.springs.stiffness is '3 N/m', it must be: number or map. write the number "
     "without a unit; it is in N/m"},
    {BALL "    springs:\n      - 3\n", NULL, "a.yaml:6:7: error: bodies.0.springs is a list, it must be: map"},
    {BALL "tools: [ { name: t, shape: mesh, motion: [ { position: [0, 0, 9] } ] } ]\n", NULL,
     "a.yaml:5:28: error: unknown shape 'mesh'. a tool of a mesh has no shape: give `mesh: { file: ... }` in its "
     "place"},
    {BALL "    scale_with_area: yes\n", NULL,
     "a.yaml:5:22: error: bodies.0.scale_with_area is 'yes', it must be: true"},
    {BALL "    reference_count: 1.5\n", NULL,
     "a.yaml:5:22: error: bodies.0.reference_count is '1.5', it must be: whole"},
    {BALL "gravity: [0, 0]\n", NULL, "a.yaml:5:10: error: gravity has 2 elements. give three numbers [x, y, z]"},
    {BALL "gravity: [0, 0, down]\n", NULL, "a.yaml:5:17: error: gravity.2 is 'down', it must be: number"},
    {BALL "gravity: [0, 0, {}]\n", NULL, "a.yaml:5:17: error: gravity.2 is a map, it must be: number"},
    {BALL "gravity: [0, 0, ~]\n", NULL, "a.yaml:5:17: error: gravity.2 is nothing, it must be: number"},
    {BALL "gravity: [0, 0, -.INF]\n", NULL,
     "a.yaml:5:17: error: gravity.2 is '-.INF', it must be: number. infinite numbers and NaN are refused"},
    {BALL "gravity: [.nan, 0, 0]\n", NULL, "a.yaml:5:11: error: gravity.0 is '.nan', it must be: number. infinite"},
    {BALL "gravity: [0, 0, -1e999]\n", NULL,
     "a.yaml:5:17: error: gravity.2 is out of range: -1e999 m/s2. it must be fi"},
    {BALL "loads: {force: [0, 0, 1]}\n", NULL,
     "a.yaml:5:8: error: loads is a map, it must be: list. begin each element with '- force'"},
    {BALL "loads: {push: {force: [0, 0, 1]}}\n", NULL,
     "a.yaml:5:8: error: loads is a map, it must be: list. write the keys of 'push' as an element, after '- '"},
    {BALL "loads: [{force: [0, 0, 1], keys: [[0, 1, 2]]}]\n", NULL,
     "a.yaml:5:35: error: loads.0.keys.0 has 3 elements. give a time and a value [t, value]"},
    {"- 1\n", NULL, "a.yaml:1:1: error: the scene is a list, it must be: map"},
    /* a file that is no scene is not shown: it may hold secrets */
    {"password is x1\n", NULL, "a.yaml:1:1: error: the scene is a text, it must be: map"},

    /* supports */
    {BALL "    supports: [{fix: [x]}]\n", NULL, "a.yaml:5:16: error: bodies.0.supports.0 lacks 'at'. add"},
    {BALL "    supports: [{at: all, fix: [w]}]\n", NULL, "a.yaml:5:32: error: unknown word 'w'. known are: x, y, z"},
    {BALL "    supports: [{at: all, fix: [x], symmetry: y}]\n", NULL,
     "a.yaml:5:36: error: 'fix' and 'symmetry' exclude each other"},
    {BALL "    supports: [{at: all, fix: []}]\n", NULL, "a.yaml:5:16: error: the support holds nothing. list comp"},
    {BALL "    supports: [{at: all, fix: [x], displacement: [0, 1, 0]}]\n", NULL,
     "a.yaml:5:16: error: the support displaces a component that it does not hold. add the component"},
    {BALL "    supports: [{at: all, symmetry: [0, 0, 0]}]\n", NULL,
     "a.yaml:5:36: error: the direction has no length. give a vector"},
    {BALL "    supports: [{at: all, frame: {x: [1, 0, 0], y: [2, 0, 0]}}]\n", NULL,
     "a.yaml:5:51: error: y is parallel to x"},
    {BALL "    supports: [{at: all, stiffness: 0}]\n", NULL,
     "a.yaml:5:37: error: bodies.0.supports.0.stiffness is out of range: 0 N/m"},
    {BALL "    supports: [{at: all, fix: [x], stiffness: 1, foundation: 2}]\n", NULL,
     "a.yaml:5:16: error: the support has a stiffness of its vertices and one of a foundation"},
    {BALL "    supports: [{at: all, frame: {x: [1, 2, 3], y: [0, 0, 0]}}]\n", NULL,
     "a.yaml:5:51: error: the direction has no length"},
    {BALL "    supports: [{name: a, at: all}, {name: a, at: all}]\n", NULL,
     "a.yaml:5:43: error: the name 'a' is in use"},

    /* out of range */
    {BALL "    springs: {stiffness: -3}\n", NULL,
     "a.yaml:5:26: error: bodies.0.springs.stiffness is out of range: -3 N/m. it must be >= 0 N/m"},
    {BALL "    springs: {stiffness: {keys: [[0, 1], [1, -1]]}}\n", NULL,
     "a.yaml:5:46: error: bodies.0.springs.stiffness.keys.1.1 is out of range: -1 N/m. it must be >= 0 N/m"},
    {BALL "    springs: {stiffness: {keys: [[-2, 1]]}}\n", NULL,
     "a.yaml:5:35: error: bodies.0.springs.stiffness.keys.0.0 is out of range: -2 s. it must be >= 0 s"},
    {BALL "solver: {dt: 0}\n", NULL, "a.yaml:5:14: error: solver.dt is out of range: 0 s. it must be >= 1e-100 s"},
    {BALL, "bodies.0.mesh.frequency=0",
     "--set bodies.0.mesh.frequency=0: error: bodies.0.mesh.frequency is out of range: 0. it must be 1 to 5000"},
    {"version: 2\nwhat: 1\n", NULL, "a.yaml:1:10: error: version is out of range: 2. it must be 1"},
    {"version: 1\nduration: 1\nbodies: []\n", NULL,
     "a.yaml:3:9: error: bodies has 0 elements. it must have >= 1 elements"},
    {BALL "    name: ''\n", NULL, "a.yaml:5:11: error: bodies.0.name is empty. give a text, or leave the key out"},
    {BALL "loads: [{force: [0, 0, 1], from: 2, until: 1}]\n", NULL,
     "a.yaml:5:44: error: `until` 1 is not after `from` 2. use a later time"},
    {BALL "loads: [{force: [0, 0, 1], keys: [[1, 0], [1, 1]]}]\n", NULL,
     "a.yaml:5:43: error: the times of the keys do not increase: 1 after 1"},
    {BALL "tools: [{shape: sphere, radius: 1, motion: [{position: [0, 0, 0]}, {position: [0, 0, 0]}]}]\n", NULL,
     "a.yaml:5:68: error: the times of the poses do not increase"},
    {BALL
     "tools: [{shape: sphere, radius: 1, motion: [{position: [0, 0, 0], rotation: {axis: [0, 0, 0], angle: 1}}]}]\n",
     NULL, "a.yaml:5:84: error: the axis of rotation has no length"},
    {BALL, "bodies.0.mesh={shape: torus, minor_radius: 2}",
     "--set bodies.0.mesh={shape: torus, minor_radius: 2}: error:"},
    {BALL, "bodies.0.mesh={shape: lens-capsule, age: 12}",
     "--set bodies.0.mesh={shape: lens-capsule, age: 12}: error: lens-capsule: there is no outline for age 12"},
    {BALL, "bodies.0.mesh.translate=[1e308, 0, 0]", NULL},
    {BALL, "bodies.0.mesh.scale=1e308", NULL},

    /* missing keys */
    {"", NULL, "a.yaml:1:1: error: the scene lacks 'version'. add 'version: 1': "},
    {"version: 1\n", NULL, "a.yaml:1:1: error: the scene lacks 'bodies'. add 'bodies:': deformable surfaces"},
    {"version: 1\nduration: 1\nbodies:\n  - name: ball\n", NULL,
     "a.yaml:4:5: error: bodies.0 lacks 'mesh'. add 'mesh:"},
    {"version: 1\nduration: 1\nbodies:\n  - mesh: {scale: 1}\n", NULL,
     "a.yaml:4:11: error: bodies.0.mesh lacks one of its main keys. add one of: shape, file"},
    {BALL "    mass: {total: 3, thickness: 2}\n", NULL,
     "a.yaml:5:22: error: key 'thickness' is allowed only with: density. add"},
    {BALL "tools:\n  - radius: 1\n", NULL, "a.yaml:6:5: error: key 'radius' is allowed only with: shape. add that key"},
    {BALL "tools:\n  - press: true\n", NULL,
     "a.yaml:6:5: error: tools.0 lacks one of its main keys. add one of: shape, mesh"},
    {BALL "loads: [{at: all}]\n", NULL, "a.yaml:5:9: error: loads.0 lacks 'force'. add 'force:': the force"},
    {BALL "duration:\n", NULL, "a.yaml:5:1: error: key 'duration' is given twice"},
    {"version: 1\nbodies: [{mesh: {shape: grid}}]\nduration:\n", NULL, "a.yaml:1:1: error: the scene lacks 'duration'"},

    /* keys that do not go together */
    {BALL "    mass: {total: 1, per_vertex: 2}\n", NULL,
     "a.yaml:5:22: error: 'total' and 'per_vertex' exclude each other. remove one of them"},
    {BALL "    springs: {damping: 2}\n", NULL,
     "a.yaml:5:15: error: key 'damping' is allowed only with: stiffness. add"},
    {BALL "version: 1\n", NULL,
     "a.yaml:5:1: error: key 'version' is given twice. keep one of them; the other is in line 1"},
    {BALL "    mass: {total: 1, total: 1}\n", NULL, "a.yaml:5:22: error: key 'total' is given twice"},
    {BALL "loads: [{force: [0, 0, 1], at: {sphere: {center: [0, 0, 0], radius: 1}, nearest: [0, 0, 0]}}]\n", NULL,
     "a.yaml:5:73: error: 'sphere' and 'nearest' exclude each other"},
    {BALL "  - {name: body1, mesh: {shape: grid}}\n", NULL,
     "a.yaml:5:12: error: the name 'body1' is in use. give each"},

    /* refinement */
    {BALL "    refine: {levels: 2}\n", NULL, "a.yaml:5:13: error: refine has no criterion. add 'above'"},
    {BALL "    refine: {above: 1, below: 1}\n", NULL,
     "a.yaml:5:31: error: below (1) is not less than above (1). use a smaller value"},
    {BALL "    refine: {curvature: {above: 1, below: 2}}\n", NULL,
     "a.yaml:5:43: error: below (2) is not less than above (1)"},
    {BALL "    refine: {curvature: {below: 2}}\n", NULL, "a.yaml:5:25: error: bodies.0.refine.curvature lacks 'above'"},
    {BALL "    refine: {everywhere: true, near_tools: 1}\n", NULL,
     "a.yaml:5:32: error: 'everywhere' and 'near_tools' exclude each other. remove one"},
    {BALL "    refine: {above: 1, region_levels: 1}\n", NULL,
     "a.yaml:5:24: error: key 'region_levels' is allowed only with: region. add that"},
    {BALL "    refine: {region: all, region_levels: 2}\n", NULL,
     "a.yaml:5:42: error: region_levels is 2, the body has 1 levels. raise levels"},
    {BALL "    refine: {region: {vertices: [1, 252]}}\n", NULL, "a.yaml:5:37: error: the mesh has no vertex 252"},
    {BALL "    refine: {region: all, dwell: 3}\n", NULL,
     "a.yaml:5:27: error: key 'dwell' is allowed only with: above, curv"},
    {BALL "    refine: {above: 1, curvature: {above: 1}, near_tools: 1, region: all, budget: 9000, dwell: 3}\n", NULL,
     NULL},

    /* names of bodies and fields, regions */
    {BALL "    name: ball\nloads: [{force: [0, 0, 1], body: bal}]\n", NULL,
     "a.yaml:6:34: error: unknown body 'bal'. did you mean 'ball'?"},
    {BALL "  - mesh: {shape: grid}\nloads:\n  - force: [0, 0, 1]\n", NULL,
     "a.yaml:7:5: error: the load does not say on which body it acts. add `body: body1` or another name"},
    {BALL "output: {fields: [displacment]}\n", NULL,
     "a.yaml:5:19: error: unknown field 'displacment'. did you mean 'displacement'?"},
    {BALL "output: {fields: [area, gausian_curvature]}\n", NULL,
     "a.yaml:5:25: error: unknown field 'gausian_curvature'. did you mean 'gaussian_curvature'?"},
    {BALL "    springs: {drag: {field: thickness}}\n", NULL,
     "a.yaml:5:29: error: unknown scalar field of the mesh 'thickness'. there is none"},
    {BALL "    pinned: {sphere: {center: [9, 9, 9], radius: 1}}\n", NULL,
     "a.yaml:5:13: error: the region is empty: the nearest vertex is "},
    {BALL "    pinned: {vertices: [1, 252]}\n", NULL,
     "a.yaml:5:28: error: the mesh has no vertex 252. give numbers from 0 to 251"},
    {BALL, "bodies.0.mass={density: 1, thickness: {field: t}}",
     "--set bodies.0.mass={density: 1, thickness: {field: t}}: "
     "error: unknown scalar field of the mesh 't'"},
    {"version: 1\nduration: 1\nbodies:\n- mesh: {shape: lens-capsule}\n  springs: {stiffness: {field: thickness, "
     "map: [0, -1]}}\n",
     NULL, "a.yaml:5:52: error: bodies.0.springs.stiffness.map.1 is out of range: -1 N/m. it must be >= 0 N/m"},

    /* meshes */
    {"version: 1\nduration: 1\nbodies: [{mesh: {file: ''}}]\n", NULL,
     "a.yaml:3:24: error: bodies.0.mesh.file is empty. give a text, or leave the key out"},
    {"version: 1\nduration: 1\nbodies: [{mesh: {file: no/such.ply}}]\n", NULL,
     "a.yaml:3:24: error: cannot open the mesh 'no/such.ply': No such file or directory. check the path"},
    {"version: 1\nduration: 1\nbodies: [{mesh: {file: .}}]\n", NULL, "a.yaml:3:24: error: "},

    /* alternatives */
    {BALL "    pressure: {gas: {pressure: 1}, outside: 3}\n", NULL,
     "a.yaml:5:36: error: 'gas' and 'outside' exclude each other. remove one of them, or move 'outside' into 'gas'"},
    {BALL "    pressure: {outside: 3, volume: {target: 1, bulk: 1}}\n", NULL,
     "a.yaml:5:28: error: 'outside' and 'volume' exclude each other. remove one of them, or move 'outside' into "
     "'volume'"},
    {BALL "    pressure: {inside: 3, outside: 1}\n", NULL,
     "a.yaml:5:27: error: 'inside' and 'outside' exclude each other. remove one of them"},
    {BALL "    mass: {density: 1, thickness: {}}\n", NULL,
     "a.yaml:5:35: error: bodies.0.mass.thickness lacks one of its main keys. add one of: field, base"},
    {BALL "    supports: [{at: all, symmetry: w}]\n", NULL,
     "a.yaml:5:36: error: bodies.0.supports.0.symmetry is 'w', it must be: "},

    /* contact */
    {BALL "contact: {thickness: relative}\n", NULL, "a.yaml:5:22: error: `thickness` 'relative' is not a thickness"},
    {BALL "contact: {thickness: relative 0}\n", NULL,
     "a.yaml:5:22: error: `thickness` 'relative 0' is not a thickness"},
    {BALL "contact: {thickness: relative 1e999}\n", NULL, "a.yaml:5:22: error: `thickness` 'relative 1e999' is not"},
    {BALL "contact: {thickness: relative 1 m}\n", NULL, "a.yaml:5:22: error: `thickness` 'relative 1 m' is not a"},
    {BALL "contact: {thickness: absolute 1}\n", NULL,
     "a.yaml:5:22: error: `thickness` 'absolute 1' is not a thickness"},

    /* sessions */
    {BALL "session: [release]\n", NULL,
     "a.yaml:5:11: error: a command of the session has no step from 0 on: \"release\". write the step, a space"},
    {BALL "session: [3release]\n", NULL, "a.yaml:5:11: error: a command of the session has no step from 0 on"},
    {BALL "session: [' 3 release']\n", NULL, "a.yaml:5:11: error: a command of the session has no step from 0 on"},
    {BALL "session: ['+3 release']\n", NULL, "a.yaml:5:11: error: a command of the session has no step from 0 on"},
    {BALL "session: ['-3 release']\n", NULL, "a.yaml:5:11: error: a command of the session has no step from 0 on"},
    {BALL "session: ['2147483648 release']\n", NULL, "a.yaml:5:11: error: a command of the session has no step from 0"},
    {BALL "session: ['7 release', '7 release', '6 release']\n", NULL,
     "a.yaml:5:37: error: a command of the session has no step from 7 on: \"6 release\""},

    /* YAML itself */
    {"%YAML 3.1\n---\nversion: 1\n", NULL,
     "a.yaml:1:1: error: this is not YAML 1.2. remove lines that begin with %, such as %YAML 1.1"},
    {"%YAML 1.1 x\n---\nversion: 1\n", NULL, "a.yaml:1:11: error: this is not YAML: garbage after version"},
    {"version: 1\nbodies: [1, 2\n", NULL, "a.yaml:3:1: error: this is not YAML: flow sequence without"},
    {"version: \"1\n", NULL, "a.yaml:1:11: error: this is not YAML: double-quoted scalar without closing quote"},
    {"version: 1\n\tduration: 1\n", NULL, "a.yaml:"},
    {"version: 1\nti\xffle: x\n", NULL, "a.yaml:2:3: error: this byte is not UTF-8 text. save the file as UTF-8"},
    {"version: 1\ntitle: \xe2\x82\xac\xf0\x9f\x98\x80 \xed\xa0\x80\n", NULL,
     "a.yaml:2:11: error: this byte is not UTF-8 text"},
    {"version: 1\ntitle: \xf0\x9f\x98", NULL, "a.yaml:2:8: error: this byte is not UTF-8 text"},
    {"version: 1\n---\nversion: 1\n", NULL, "a.yaml:3:1: error: a second document begins"},
    {"version: !!int 1\n", NULL, "a.yaml:1:16: error: tags are not used in scenes"},
    {"version: *one\n", NULL, "a.yaml:1:10: error: the alias has no anchor before it"},
    {"version: &one [*one]\n", NULL, "a.yaml:1:16: error: the alias has no anchor before it"},
    {"? [a, b]\n: 1\n", NULL, "a.yaml:1:3: error: a key must be text"},
    {"title: |\n  text\n", NULL, "a.yaml:2:1: error: block text (| or >) is not used in scenes"},
    {"title: \"a\\0b\"\n", NULL, "a.yaml:1:8: error: the text has a zero byte"},

    /* overrides */
    {BALL, "solver.dt", "--set solver.dt: error: this is not of the form KEY=VALUE. write it as solver.dt=0.005"},
    {BALL, "=3", "--set =3: error: this is not of the form KEY=VALUE"},
    {BALL, "solver..dt=3", "--set solver..dt=3: error: the path has an empty or very long part"},
    {BALL, "solver.dt.=3", "--set solver.dt.=3: error: the path has an empty or very long part"},
    {BALL, "solver.td=3", "--set solver.td=3: error: unknown key 'td'. did you mean 'dt'?"},
    {BALL, "solver.[]=3", "--set solver.[]=3: error: unknown key '[]'"},
    {BALL, "solver.dt=fast", "--set solver.dt=fast: error: solver.dt is 'fast', it must be: number"},
    {BALL, "solver.dt=-1", "--set solver.dt=-1: error: solver.dt is out of range: -1 s. it must be >= 1e-100 s"},
    {BALL, "solver.dt=[1", "--set solver.dt=[1: error: this is not YAML: "},
    {BALL, "solver.dt.x=1", "--set solver.dt.x=1: error: solver.dt has no keys below it"},
    {BALL, "gravity.1=1", "--set gravity.1=1: error: gravity has no keys below it. give the whole value"},
    {BALL, "bodies.2.name=x", "--set bodies.2.name=x: error: bodies has no element '2'. it has 1, numbered from 0"},
    {BALL "    name: ball\n", "bodies.bell.name=x",
     "--set bodies.bell.name=x: error: unknown element 'bell'. did you me"},
    {BALL, "bodies.0.mesh={shape: grid, radus: 1}",
     "--set bodies.0.mesh={shape: grid, radus: 1}: error: unknown key 'radus'. known are: shape, nx, "},
    {BALL, "bodies.0.mesh.nn=1",
     "--set bodies.0.mesh.nn=1: error: unknown key 'nn'. known are: shape, frequency, radius"},
    {BALL, "bodies.0.mesh=", "a.yaml:4:5: error: bodies.0 lacks 'mesh'"},
    {BALL, "duration=", "a.yaml:1:1: error: the scene lacks 'duration'"},
};

static void test_bad_scenes(void **unused)
{
    (void)unused;
    int failures = 0;
    for (size_t i = 0; i < sizeof bad_scenes / sizeof bad_scenes[0]; i++) {
        const bad_scene *bad = &bad_scenes[i];
        pel_scene *scene = (pel_scene *)&failures;
        pel_error error;
        char message[1000] = "no error";
        pel_status status = pel_scene_parse("a.yaml", bad->text, strlen(bad->text), &bad->override,
                                            bad->override != NULL, NULL, &scene, &error);
        if (status == PEL_OK && bad->message == NULL) {
            pel_scene_destroy(scene);
            continue;
        }
        if (status != PEL_OK)
            pel_error_text(&error, message, sizeof message);
        assert_true(status != PEL_OK || scene != NULL);
        bool right = bad->message == NULL || strncmp(message, bad->message, strlen(bad->message)) == 0;
        if (right && status != PEL_OK && scene == NULL && error.remedy[0] != '\0' && status == error.status)
            continue;
        print_error("%s  --set %s\nexpected %s\nactual   %s\n\n", bad->text, bad->override, bad->message, message);
        failures++;
    }
    assert_int_equal(failures, 0);
}

/* the same without an error to fill */
static void test_null_error(void **unused)
{
    (void)unused;
    for (size_t i = 0; i < sizeof bad_scenes / sizeof bad_scenes[0]; i++) {
        pel_scene *scene;
        const bad_scene *bad = &bad_scenes[i];
        if (bad->message != NULL)
            assert_true(pel_scene_parse("a.yaml", bad->text, strlen(bad->text), &bad->override, bad->override != NULL,
                                        NULL, &scene, NULL) != PEL_OK);
    }
}

/* errors of the model and the simulation have their place in the scene */
static void check_location(const char *end, const char *expected)
{
    char text[1000], message[1000];
    snprintf(text, sizeof text, "%s%s", BALL, end);
    pel_scene *scene;
    pel_model *model = NULL;
    pel_sim *sim = NULL;
    pel_error error;
    assert_int_equal(pel_scene_parse("a.yaml", text, strlen(text), NULL, 0, NULL, &scene, NULL), PEL_OK);
    pel_status status = pel_model_create(&scene->model, &model, &error);
    pel_sim_def def = scene->sim;
    def.model = model;
    if (status == PEL_OK)
        status = pel_sim_create(&def, &sim, &error);
    assert_true(status != PEL_OK);
    pel_scene_locate(scene, &error);
    pel_error_text(&error, message, sizeof message);
    if (strncmp(message, expected, strlen(expected)) != 0)
        fail_msg("%s", message);
    pel_model_destroy(model);
    pel_scene_destroy(scene);
}

static void test_locations(void **unused)
{
    (void)unused;
    check_location("solver: {method: quasi-static, alpha: 5000}\n", "a.yaml:5:39: error: alpha 5000 is unstable");
    check_location("solver: {method: explicit, integrator: forward, dt: 5}\n", "a.yaml:5:53: error: dt 5 is unstable");
    check_location("    rigid: {}\njoints:\n  - {kind: ball, point: [0, 0, 0]}\n  - {name: knee, kind: hinge, point: "
                   "[0, 0, 0], least: 3}\n",
                   "a.yaml:8:5: error: joint 'knee' starts beyond its limits");
    check_location("    refine: {above: 1, budget: 30}\n",
                   "a.yaml:4:5: error: body 'body1': refine: the budget is 30 triangles, 500 are needed");
    check_location("    refine: {above: 1, levels: 6}\n  - {mesh: {shape: grid, nx: 600, ny: 600}, refine: {above: 1, "
                   "levels: 6}}\n",
                   "a.yaml:6:5: error: body 'body2': 6 levels of 720000 triangles are more than 32 bits can number");
    check_location(
        "    membrane: {preset: rubber}\n  - {name: thin, mesh: {shape: grid, size_x: 1e-200, size_y: 1e-200}, "
        "membrane: {preset: rubber}}\n",
        "a.yaml: error: triangle 0: body 'thin': triangle has no area: its mesh is 1e-200 m across");
    check_location("tools:\n- {shape: sphere, radius: .5, motion: [{position: [0, 0, 9]}]}\n"
                   "- {shape: sphere, radius: .5, motion: [{position: [0, 0, 1]}]}\n",
                   "a.yaml:7:3: error: ");
    /* supports are numbered through all bodies */
    check_location("    supports: [{at: {nearest: [0, 0, 1]}}, {at: {nearest: [0, 0, -1]}}]\n"
                   "  - {mesh: {shape: geodesic-sphere}, pinned: all,\n"
                   "     supports: [{name: low, at: all, symmetry: z},\n"
                   "                {name: top, at: all, displacement: [0, 0, 1]}]}\n"
                   "solver: {method: static}\n",
                   "a.yaml:8:17: error: support 'body2_top' displaces vertex 0, which is pinned");
}

static void test_missing_file(void **unused)
{
    (void)unused;
    pel_scene *scene;
    pel_error error;
    assert_int_equal(pel_scene_load("no/such.yaml", NULL, 0, NULL, &scene, &error), PEL_BAD_FILE);
    assert_null(scene);
    assert_string_equal(error.file, "no/such.yaml");
}

/* errors of a mesh file have their place there */
static void test_bad_mesh_file(void **unused)
{
    (void)unused;
    const char *text = "version: 1\nduration: 1\nbodies: [{mesh: {file: scene_bad_mesh.obj}}]\n";
    FILE *file = fopen("scene_bad_mesh.obj", "w");
    fputs("v 0 0 0\nv 1 x 0\n", file);
    fclose(file);
    pel_scene *scene;
    pel_error error;
    assert_int_equal(pel_scene_parse("a.yaml", text, strlen(text), NULL, 0, NULL, &scene, &error), PEL_BAD_FORMAT);
    assert_non_null(strstr(error.file, "scene_bad_mesh.obj"));
    assert_int_equal(error.line, 2);
    remove("scene_bad_mesh.obj");
}

/* numbers of a field are checked like those of the scene, after its map; the field is found among the scalar ones */
static void test_field_out_of_range(void **unused)
{
    (void)unused;
    static const char *const cases[][2] = {
        {"{field: stiff}",
         "a.yaml:3:94: error: bodies.0.membrane.young is -0.5 at vertex 2, out of range. it must be > 0"},
        {"{field: stiff, map: [1, 2]}", NULL},
        {"{field: stiff, map: [1, 4]}", "a.yaml:3:94: error: bodies.0.membrane.young is -0.5 at vertex 2"},
        {"{field: side}", "a.yaml:3:94: error: unknown scalar field of the mesh 'side'. known are: stiff"},
    };
    FILE *file = fopen("scene_field.ply", "w");
    fputs("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
          "property float side_0\nproperty float side_1\nproperty float side_2\nproperty float stiff\n"
          "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
          "0 0 0 0 0 1 1\n1 0 0 0 0 1 2\n0 1 0 0 0 1 -0.5\n3 0 1 2\n",
          file);
    fclose(file);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[300], message[1000];
        snprintf(
            text, sizeof text,
            "version: 1\nduration: 1\nbodies: [{mesh: {file: scene_field.ply}, membrane: {thickness: 1, poisson: 0, "
            "young: %s}}]\n",
            cases[i][0]);
        pel_scene *scene;
        pel_error error;
        pel_status status = pel_scene_parse("a.yaml", text, strlen(text), NULL, 0, NULL, &scene, &error);
        if (cases[i][1] == NULL) {
            assert_int_equal(status, PEL_OK);
            const double expected[3] = {2, 3, 0.5};
            for (int v = 0; v < 3; v++)
                assert_near(scene->model.bodies[0].shell.membrane.young.field[v], expected[v], 1e-15);
            pel_scene_destroy(scene);
            continue;
        }
        assert_int_equal(status, PEL_BAD_SCENE);
        pel_error_text(&error, message, sizeof message);
        if (strncmp(message, cases[i][1], strlen(cases[i][1])) != 0)
            fail_msg("%s", message);
    }
    remove("scene_field.ply");
}

/* aliases that double over and over end in an error, not without memory */
static void test_aliases_without_end(void **unused)
{
    (void)unused;
    char text[4000] = "a0: &a0 [1, 2, 3, 4, 5, 6, 7, 8, 9]\n";
    for (int i = 1; i < 12; i++) {
        size_t length = strlen(text);
        snprintf(text + length, sizeof text - length, "a%d: &a%d [*a%d, *a%d, *a%d, *a%d, *a%d, *a%d, *a%d, *a%d]\n", i,
                 i, i - 1, i - 1, i - 1, i - 1, i - 1, i - 1, i - 1, i - 1);
    }
    pel_scene *scene;
    pel_error error;
    assert_int_equal(pel_scene_parse("a.yaml", text, strlen(text), NULL, 0, NULL, &scene, &error), PEL_BAD_SCENE);
    assert_string_equal(error.what, "there are too many values");
}

/* a list of many names in which each alias looks for its own takes time with their square */
static void test_many_anchors(void **unused)
{
    (void)unused;
    for (int count = 1000; count <= 1001; count++) {
        char text[40000];
        int length = 0;
        for (int i = 0; i < count; i++)
            length += snprintf(text + length, sizeof text - (size_t)length, "k%d: &name%d 1\n", i, i);
        pel_scene *scene;
        pel_error error;
        assert_int_equal(pel_scene_parse("a.yaml", text, strlen(text), NULL, 0, NULL, &scene, &error), PEL_BAD_SCENE);
        assert_true((strcmp(error.what, "there are more than 1000 anchors") == 0) == (count > 1000));
        assert_int_equal(error.line, count > 1000 ? 1001 : 1);
    }
}

/* more names than a message holds */
static void test_many_names(void **unused)
{
    (void)unused;
    char text[20000] = "version: 1\nduration: 1\nbodies:\n";
    for (int i = 0; i < 100; i++) {
        size_t length = strlen(text);
        snprintf(text + length, sizeof text - length,
                 "- {name: a-rather-long-name-%d, mesh: {shape: grid, nx: 1, ny: 1}}\n", i);
    }
    pel_scene *scene;
    pel_error error;
    const char *const overrides[] = {"tools=[{shape: sphere, radius: 1, body: zz, motion: [{position: [0, 0, 9]}]}]"};
    assert_int_equal(pel_scene_parse("a.yaml", text, strlen(text), overrides, 1, NULL, &scene, &error), PEL_BAD_SCENE);
    assert_string_equal(error.what, "unknown body 'zz'");
    assert_string_equal(error.remedy + strlen(error.remedy) - 5, ", ...");
    /* one name longer than the message */
    char override[600] = "bodies.zz.name=x", scene_text[600];
    snprintf(scene_text, sizeof scene_text, "version: 1\nbodies: [{name: %0500d}]\n", 1);
    assert_int_equal(pel_scene_parse("a.yaml", scene_text, strlen(scene_text), (const char *const[]){override}, 1, NULL,
                                     &scene, &error),
                     PEL_BAD_SCENE);
    assert_string_equal(error.remedy, "known are: ...");
}

static void test_nesting_without_end(void **unused)
{
    (void)unused;
    enum { DEPTH = 20000 };
    static char text[2 * DEPTH + 2];
    for (int i = 0; i < DEPTH; i++)
        memcpy(text + (size_t)2 * (size_t)i, "- ", 2);
    pel_scene *scene;
    pel_error error;
    assert_int_equal(pel_scene_parse("a.yaml", text, strlen(text), NULL, 0, NULL, &scene, &error), PEL_BAD_SCENE);
    assert_string_equal(error.what, "lists and maps are nested too deeply");
    memset(text, '[', DEPTH);
    assert_int_equal(pel_scene_parse("a.yaml", text, DEPTH, NULL, 0, NULL, &scene, &error), PEL_BAD_SCENE);
    assert_string_equal(error.what, "lists and maps are nested too deeply");
}

/* 100 lists in each other are read, 101 are not; 8 MB of brackets end before they are read */
static void test_depth(void **unused)
{
    (void)unused;
    enum { SIZE = 8 << 20 };
    char text[240];
    pel_scene *scene;
    pel_error error;
    for (int depth = 100; depth <= 101; depth++) {
        snprintf(
            text, sizeof text, "version: 1\nbodies: %.*s%.*s\n", depth - 1,
            "[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[["
            "[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[",
            depth - 1,
            "]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]");
        assert_int_equal(pel_scene_parse("a.yaml", text, strlen(text), NULL, 0, NULL, &scene, &error), PEL_BAD_SCENE);
        bool is_deep = strcmp(error.what, "lists and maps are nested too deeply") == 0;
        assert_int_equal(is_deep, depth == 101);
    }
    char *brackets = malloc(SIZE);
    assert_non_null(brackets);
    memset(brackets, '[', SIZE);
    clock_t start = clock();
    assert_int_equal(pel_scene_parse("a.yaml", brackets, SIZE, NULL, 0, NULL, &scene, &error), PEL_BAD_SCENE);
    /* in libfyaml they take 1.6 s until they are too deep, and 27 s in all; counted before, 0.01 s */
    assert_true((double)(clock() - start) / CLOCKS_PER_SEC < 0.5);
    free(brackets);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bad_scenes),
        cmocka_unit_test(test_null_error),
        cmocka_unit_test(test_missing_file),
        cmocka_unit_test(test_bad_mesh_file),
        cmocka_unit_test(test_field_out_of_range),
        cmocka_unit_test(test_aliases_without_end),
        cmocka_unit_test(test_many_anchors),
        cmocka_unit_test(test_nesting_without_end),
        cmocka_unit_test(test_depth),
        cmocka_unit_test(test_locations),
        cmocka_unit_test(test_many_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
