/* Colour maps as formulas, so that no table has to be kept:
   - viridis: polynomials of degree 6 fitted to the map of van der Walt and Smith (M. Zucker, "Matplotlib colormaps",
     Shadertoy WlfXRN, 2019, in the public domain), within 2/255 of it
   - cividis: the polynomials of degree 5 published with d3-scale-chromatic (M. Bostock, J. Davies, 2018) for the map of
     Nunez, Anderton and Renslow, PLOS ONE 13(7), 2018
   - cool-warm: computed as in K. Moreland, "Diverging color maps for scientific visualization", ISVC 2009: a straight
     line in Msh, the polar form of CIELAB, from blue to white and on to red */
#include "pellicle/render.h"

#include <math.h>
#include <string.h>

static const char *const names[PEL_COLORS_COUNT] = {"viridis", "cividis", "cool-warm", "warm"};

const char *pel_color_map_name(int index)
{
    return index >= 0 && index < PEL_COLORS_COUNT ? names[index] : NULL;
}

bool pel_color_map_find(const char *name, pel_color_map *map)
{
    if (name == NULL || map == NULL)
        return false;
    for (int i = 0; i < PEL_COLORS_COUNT; ++i) {
        if (strcmp(names[i], name) == 0) {
            *map = (pel_color_map)i;
            return true;
        }
    }
    return false;
}

/* ---- polynomials ---- */

enum { DEGREE = 6 };

/* red, green, blue: coefficients from the constant one up */
static const double viridis[3][DEGREE + 1] = {
    {0.2777273272, 0.1050930431, -0.3308618287, -4.634230499, 6.228269936, 4.776384998, -5.435455856},
    {0.0054073445, 1.4046135299, 0.2148475595, -5.799100973, 14.179933367, -13.745145378, 4.645852612},
    {0.3340998053, 1.3845901626, 0.0950951630, -19.332440956, 56.690552601, -65.353032633, 26.312435250},
};
static const double cividis[3][DEGREE + 1] = {
    {-4.54 / 255, -35.34 / 255, 2381.73 / 255, -6402.7 / 255, 7024.72 / 255, -2710.57 / 255, 0},
    {32.49 / 255, 170.73 / 255, 52.82 / 255, -131.46 / 255, 176.58 / 255, -67.37 / 255, 0},
    {81.24 / 255, 442.36 / 255, -2482.43 / 255, 6167.24 / 255, -6614.94 / 255, 2475.67 / 255, 0},
};

static void sample_polynomial(const double polynomial[3][DEGREE + 1], double at, double rgb[3])
{
    for (int i = 0; i < 3; ++i) {
        rgb[i] = 0;
        for (int j = DEGREE; j >= 0; --j)
            rgb[i] = rgb[i] * at + polynomial[i][j];
    }
}

/* ---- cool-warm ---- */

/* D65, and where the cube root of CIELAB turns into a line */
static const double white_point[3] = {0.9505, 1.0, 1.089};
static const double cube_limit = 0.008856;

static void lab_to_rgb(const double lab[3], double rgb[3])
{
    static const double to_rgb[3][3] = {
        {3.2406, -1.5372, -0.4986}, {-0.9689, 1.8758, 0.0415}, {0.0557, -0.2040, 1.0570}};
    double y = (lab[0] + 16) / 116, f[3] = {y + lab[1] / 500, y, y - lab[2] / 200}, xyz[3];
    for (int i = 0; i < 3; ++i) {
        double cube = f[i] * f[i] * f[i];
        xyz[i] = white_point[i] * (cube > cube_limit ? cube : (f[i] - 16.0 / 116) / 7.787);
    }
    for (int i = 0; i < 3; ++i) {
        double linear = to_rgb[i][0] * xyz[0] + to_rgb[i][1] * xyz[1] + to_rgb[i][2] * xyz[2];
        rgb[i] = linear > 0.0031308 ? 1.055 * pow(linear, 1 / 2.4) - 0.055 : 12.92 * linear;
    }
}

/* hue of the white end, so that the perceived hue stays constant towards it (section 5 of Moreland) */
static double spun_hue(const double msh[3], double magnitude)
{
    if (msh[0] >= magnitude)
        return msh[2];
    double spin = msh[1] * sqrt(magnitude * magnitude - msh[0] * msh[0]) / (msh[0] * sin(msh[1]));
    return msh[2] > -1.0471975511965976 ? msh[2] + spin : msh[2] - spin;
}

static void sample_cool_warm(double at, double rgb[3])
{
    /* magnitude, saturation, hue of rgb (59, 76, 192), of rgb (180, 4, 38) and of the white between */
    static const double ends[2][3] = {{80.0, 1.08, -1.1}, {80.0, 1.08, 0.5}};
    const double middle = 88.0;
    const double *end = ends[at < 0.5 ? 0 : 1];
    double part = at < 0.5 ? 1 - 2 * at : 2 * at - 1; /* 0 at the middle, 1 at the end */
    double magnitude = middle + part * (end[0] - middle);
    double saturation = part * end[1], hue = spun_hue(end, middle);
    hue += part * (end[2] - hue);
    double chroma = magnitude * sin(saturation);
    lab_to_rgb((double[]){magnitude * cos(saturation), chroma * cos(hue), chroma * sin(hue)}, rgb);
}

void pel_color_map_sample(pel_color_map map, double at, uint8_t rgb[3])
{
    double color[3] = {0.5, 0.5, 0.5};
    at = at < 0 ? 0 : at > 1 ? 1 : at;
    if (isnan(at))
        ;
    else if (map == PEL_COLORS_COOL_WARM || map == PEL_COLORS_WARM)
        sample_cool_warm(map == PEL_COLORS_WARM ? 0.5 + 0.5 * at : at, color);
    else
        sample_polynomial(map == PEL_COLORS_CIVIDIS ? cividis : viridis, at, color);
    for (int i = 0; i < 3; ++i) {
        double clamped = color[i] < 0 ? 0 : color[i] > 1 ? 1 : color[i];
        rgb[i] = (uint8_t)(255 * clamped + 0.5);
    }
}
