#include "keys/everyday.h"

#include "base/text.h"

#include <string.h>
#include <strings.h>

const char *pel_everyday_word(const char *text, const char *const *known, size_t count)
{
    static const char floor_tool[] = "a floor is a box: { shape: box, size: [1, 1, 1], motion: [ { position: { below: "
                                     "lowest } } ] }";
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
    };
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (strcmp(text, words[i].text) == 0 && pel_is_among(words[i].beside, known, count))
            return words[i].remedy;
    return NULL;
}

const char *pel_everyday_key(const char *name)
{
    static const char *const keys[][2] = {
        {"e", "young"},           {"youngs_modulus", "young"}, {"nu", "poisson"},         {"poissons_ratio", "poisson"},
        {"rho", "density"},       {"collision", "contact"},    {"collisions", "contact"}, {"self_collision", "self"},
        {"forces", "loads"},      {"fixed", "pinned"},         {"pins", "pinned"},        {"constraints", "pinned"},
        {"anchors", "pinned"},    {"time_step", "dt"},         {"timestep", "dt"},        {"steps", "duration"},
        {"end_time", "duration"}, {"objects", "bodies"},       {"obstacles", "tools"},    {"colliders", "tools"},
        {"inflate", "pressure"},  {"mu", "friction"},          {"type", "kind"},          {"pivot", "point"},
        {"anchor", "point"},
    };
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++)
        if (strcasecmp(name, keys[i][0]) == 0)
            return keys[i][1];
    return NULL;
}
