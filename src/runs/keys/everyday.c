#include "keys/everyday.h"

#include "base/text.h"

#include <string.h>
#include <strings.h>

#define FLOOR "{ shape: box, size: [1, 1, 1], motion: [ { position: { below: lowest } } ] }"

const char *pel_everyday_word(const char *text, const char *const *known, size_t count)
{
    static const char floor_tool[] = "a floor is a box: " FLOOR;
    static const char forceps[] = "forceps are a tool of any shape with the key `grasp`";
    static const struct {
        const char *text, *beside, *remedy;
    } words[] = {
        {"plane", "blade", floor_tool},
        {"floor", "blade", floor_tool},
        {"ground", "blade", floor_tool},
        {"half-space", "blade", floor_tool},
        {"wall", "blade", floor_tool},
        {"table", "blade", floor_tool},
        {"mesh", "blade", "a tool of a mesh has no shape: give `mesh: { file: ... }` in its place"},
        {"grasp", "blade", forceps},
        {"forceps", "blade", forceps},
        {"gripper", "blade", forceps},
        {"cylinder", "blade", "did you mean 'capsule'? its ends are round"},
        {"needle", "blade", "did you mean 'capsule'?"},
        {"scalpel", "blade", "did you mean 'blade'?"},
        {"knife", "blade", "did you mean 'blade'?"},
        {"cube", "box", "did you mean 'box'?"},
        {"plane", "grid", "did you mean 'grid'?"},
        {"square", "grid", "did you mean 'grid'?"},
        {"sheet", "grid", "did you mean 'grid'?"},
        {"plate", "grid", "did you mean 'grid'?"},
        {"cloth", "grid", "did you mean 'grid'?"},
        {"rectangle", "grid", "did you mean 'grid'?"},
        {"tube", "cylinder", "did you mean 'cylinder'?"},
        {"pipe", "cylinder", "did you mean 'cylinder'?"},
        {"ball", "geodesic-sphere", "did you mean 'geodesic-sphere'?"},
        {"icosphere", "geodesic-sphere", "did you mean 'geodesic-sphere'?"},
        {"circle", "disk", "did you mean 'disk'?"},
        {"ring", "torus", "did you mean 'torus'?"},
        {"organ", "blend", "did you mean 'blend'? it joins balls to one body; an organ of a scan is `file: ...`"},
        {"cotton", "tablecloth", "did you mean 'tablecloth'? it is of cotton"},
        {"fabric", "tablecloth", "did you mean 'tablecloth'? other woven and knitted ones are denim and rib-knit"},
        {"cloth", "tablecloth", "did you mean 'tablecloth'? other woven and knitted ones are denim and rib-knit"},
        {"jeans", "denim", "did you mean 'denim'?"},
        {"jersey", "rib-knit", "did you mean 'rib-knit'?"},
        {"wool", "rib-knit", "did you mean 'rib-knit'?"},
        {"metal", "steel-sheet", "did you mean 'steel-sheet' or 'aluminium-foil'?"},
        {"plastic", "polyester-film", "did you mean 'polyester-film'?"},
    };
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (strcmp(text, words[i].text) == 0 && pel_is_among(words[i].beside, known, count))
            return words[i].remedy;
    return NULL;
}

/* where a name stands for several keys, the first that is known is meant */
static const char *const everyday_keys[][2] = {
    {"e", "young"},
    {"youngs", "young"},
    {"youngs_modulus", "young"},
    {"modulus", "young"},
    {"nu", "poisson"},
    {"poissons_ratio", "poisson"},
    {"rho", "density"},
    {"collision", "contact"},
    {"collisions", "contact"},
    {"self_collision", "self"},
    {"forces", "loads"},
    {"fixed", "pinned"},
    {"pins", "pinned"},
    {"constraints", "pinned"},
    {"anchors", "pinned"},
    {"time_step", "dt"},
    {"timestep", "dt"},
    {"steps", "duration"},
    {"end_time", "duration"},
    {"objects", "bodies"},
    {"obstacles", "tools"},
    {"colliders", "tools"},
    {"inflate", "pressure"},
    {"mu", "friction"},
    {"fracture_energy", "toughness"},
    {"fracture_toughness", "toughness"},
    {"energy_release_rate", "toughness"},
    {"gc", "toughness"},
    {"g_c", "toughness"},
    {"tear_strength", "strength"},
    {"tensile_strength", "strength"},
    {"type", "kind"},
    {"pivot", "point"},
    {"anchor", "point"},
    {"joint", "joints"},
    {"cells", "nx"},
    {"resolution", "nx"},
    {"resolution", "frequency"},
    {"resolution", "slices"},
    {"subdivisions", "frequency"},
    {"subdivisions", "nx"},
    {"width", "size_x"},
    {"size", "size_x"},
    {"length", "size_x"},
    {"length", "height"},
    {"diameter", "radius"},
    {"position", "translate"},
    {"center", "translate"},
    {"centre", "translate"},
    {"path", "file"},
};

const char *pel_everyday_key(const char *name, const char *const *known, size_t count)
{
    const char *first = NULL;
    for (size_t i = 0; i < sizeof everyday_keys / sizeof *everyday_keys; i++) {
        if (strcasecmp(name, everyday_keys[i][0]) != 0)
            continue;
        if (pel_is_among(everyday_keys[i][1], known, count))
            return everyday_keys[i][1];
        if (first == NULL)
            first = everyday_keys[i][1];
    }
    return first;
}

const char *pel_everyday_thing(const char *name)
{
    static const char picture[] = "a scene has no looks: `pellicle render` has --body-colors, --colors and --view";
    static const char floor_tool[] = "a floor is a tool: " FLOOR;
    static const char *const things[][2] = {
        {"floor", floor_tool},
        {"ground", floor_tool},
        {"plane", floor_tool},
        {"units", "all numbers are in metres, kilograms and seconds; `scale` of a mesh converts its file"},
        {"color", picture},
        {"colour", picture},
        {"camera", picture},
        {"static", "a body that holds still has `pinned: all`, or is a tool: { mesh: { file: ... } }"},
        {"kinematic", "a body that is led has `follow` or `support`, or is a tool with `motion`"},
    };
    for (size_t i = 0; i < sizeof things / sizeof *things; i++)
        if (strcasecmp(name, things[i][0]) == 0)
            return things[i][1];
    return NULL;
}
