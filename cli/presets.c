/* The materials that scenes may name. */
#include "commands.h"
#include "diagnostics.h"
#include "help.h"

#include <pellicle/preset.h>

static void print_json(const pel_material_preset *presets, int32_t count)
{
    pel_json json = {.file = stdout, .style = PEL_JSON_INDENTED};
    pel_json_open(&json, NULL, '{');
    pel_json_open(&json, "presets", '[');
    for (int32_t i = 0; i < count; ++i) {
        const pel_material_preset *preset = &presets[i];
        pel_json_open(&json, NULL, '{');
        pel_json_text(&json, "name", preset->name);
        pel_json_text(&json, "material", pel_membrane_kind_name(preset->material.kind));
        pel_json_number(&json, "young", preset->material.young);
        pel_json_number(&json, "poisson", preset->material.poisson);
        pel_json_number(&json, "thickness", preset->material.thickness);
        pel_json_number(&json, "mooney_ratio", preset->material.mooney_ratio);
        pel_json_number(&json, "density", preset->density);
        pel_json_text(&json, "doc", preset->doc);
        pel_json_text(&json, "source", preset->source);
        pel_json_close(&json, '}');
    }
    pel_json_close(&json, ']');
    pel_json_close(&json, '}');
}

int cli_presets(const cli_call *call)
{
    int32_t count;
    const pel_material_preset *presets = pel_material_presets(&count);
    if (cli_has(call, "json")) {
        print_json(presets, count);
        return CLI_DONE;
    }
    printf("%-16s %-14s %9s %8s %10s %8s\n", "name", "material", "young", "poisson", "thickness", "density");
    printf("%-16s %-14s %9s %8s %10s %8s\n", "", "", "Pa", "", "m", "kg/m3");
    for (int32_t i = 0; i < count; ++i) {
        const pel_membrane_material *material = &presets[i].material;
        printf("%-16s %-14s %9.3g %8g %10.3g %8g\n", presets[i].name, pel_membrane_kind_name(material->kind),
               material->young, material->poisson, material->thickness, presets[i].density);
    }
    for (int32_t i = 0; i < count; ++i) {
        printf("\n%s: %s\n    ", presets[i].name, presets[i].doc);
        cli_print_wrapped(stdout, presets[i].source, 4, 4);
    }
    return CLI_DONE;
}
