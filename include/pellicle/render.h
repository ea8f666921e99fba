/* Pellicle: pictures and films of runs and meshes, drawn without a display. In the library pellicle_view (CMake target
   pellicle::view), which needs OpenGL through EGL, FreeType, libpng and, for films, the program ffmpeg.

       const char *run = "results/sphere-press";
       pel_render_def def = pel_render_def_default();
       def.inputs = &run;
       def.input_count = 1;
       def.output = "press.png";
       pel_status status = pel_render(&def, NULL, &error);

   The same input gives the same picture on the same machine. `up` of the scene points up, z by default; def.up
   selects another axis. */
#ifndef PELLICLE_RENDER_H
#define PELLICLE_RENDER_H

#include "base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Colour maps. */
typedef enum pel_color_map {
    PEL_COLORS_VIRIDIS,   /* S. van der Walt, N. Smith 2015: perceptually uniform, dark to bright */
    PEL_COLORS_CIVIDIS,   /* Nunez, Anderton, Renslow 2018: also perceptually uniform for colour-blind people */
    PEL_COLORS_COOL_WARM, /* Moreland 2009: blue below the middle, red above it */
    PEL_COLORS_WARM,      /* the upper half of cool-warm: grey at 0, red above */
    PEL_COLORS_COUNT,
    /* by the values: cool-warm for both signs, with grey at 0; warm for ranges that start at 0; otherwise viridis */
    PEL_COLORS_AUTO = PEL_COLORS_COUNT
} pel_color_map;

/* "viridis", "cividis", "cool-warm", "warm"; null for a larger index. Lives forever. */
PEL_API const char *pel_color_map_name(int index);
/* Finds a map by name; false if there is none. */
PEL_API bool pel_color_map_find(const char *name, pel_color_map *map);
/* The sRGB colour at 0 .. 1 (clamped; NaN is grey). */
PEL_API void pel_color_map_sample(pel_color_map map, double at, uint8_t rgb[3]);

/* Position of the camera. The camera looks at the middle of the bodies, from a distance at which everything is visible.
 */
typedef struct pel_camera_angle {
    double azimuth;   /* degrees around the bodies from the front, counter-clockwise seen from above */
    double elevation; /* degrees above the horizontal plane, -90 .. 90 */
    double zoom;      /* 1 = everything fits into the picture, 2 = twice as large */
} pel_camera_angle;

/* "iso", "front", "back", "left", "right", "top", "bottom"; null for a larger index. Lives forever. */
PEL_API const char *pel_camera_preset_name(int index);
/* Finds a preset by name; false if there is none. */
PEL_API bool pel_camera_preset_find(const char *name, pel_camera_angle *angle);

typedef enum pel_background { PEL_BACKGROUND_WHITE, PEL_BACKGROUND_DARK, PEL_BACKGROUND_TRANSPARENT } pel_background;

/* Frames first, first + step, ... up to last; negative numbers count from the end, -1 is the last frame. */
typedef struct pel_frame_range {
    int32_t first, last, step; /* step >= 1 */
} pel_frame_range;

enum { PEL_RENDER_FIELD_LIMIT = 8, PEL_RENDER_COLOR_LIMIT = 16 };

typedef struct pel_render_def {
    const char *const *inputs; /* (input_count) run folders, .vtp or mesh files */
    int32_t input_count;
    const char *const *labels; /* (input_count) label of each input; null = names of the folders */
    /* a folder (one picture per frame), FILE.png (one picture; a contact sheet if there are several frames or inputs),
       or FILE.mp4 or FILE.gif (a film) */
    const char *output;
    const pel_frame_range *frames; /* (frame_range_count); null = all frames; for a .png file without columns and rows,
                                      the frame with the largest displacement of each run (the last frame if series.csv
                                      has no displacements); with columns and rows, as many evenly spaced frames as the
                                      contact sheet has places */
    int32_t frame_range_count;

    const char *field; /* vertex field that colours the surface, "none" = plain; up to PEL_RENDER_FIELD_LIMIT names,
                          separated by commas, are shown side by side; null = displacement if there is one */
    int32_t component; /* of a vector field, from 0; -1 = magnitude */
    pel_color_map color_map; /* PEL_COLORS_AUTO */
    bool fixed_range;   /* false: colours span the values of all drawn frames; true: they span `range`, for a single
                           coloured field */
    double range[2];    /* low < high, in the unit of the field */
    const char *unit;   /* of a single coloured field; null = SI unit of known quantities, "" = none */
    const char *arrows; /* vector field drawn as arrows with lengths proportional to its values; null = none */

    /* (body_color_count, up to PEL_RENDER_COLOR_LIMIT) red, green, blue of each body where no field colours it, from
       the first one again after the last; null = colours that differ, a single body the colour of tissue */
    const uint8_t (*body_colors)[3];
    int32_t body_color_count;

    pel_camera_angle angle;
    int32_t up; /* axis that points up: 0 x, 1 y, 2 z, -1 (default) that of the first input's scene, else z */
    int32_t width, height;     /* pixels of the whole picture; 0 = 1280 x 720, or a size that fits the contact sheet */
    int32_t columns, rows;     /* of a contact sheet; 0 = one row per input */
    bool flat;                 /* one normal per triangle */
    bool edges;                /* draw the edges of the triangles */
    bool outline;              /* draw a dark line along the silhouette of the surface */
    bool hide_tools, hide_bar; /* do not draw the tools, the colour bar */
    bool hide_labels;          /* do not draw times and names */
    bool hide_ground;          /* do not draw the shadow on the ground */
    bool frame_numbers;        /* labels show the number of the frame instead of the time */
    pel_background background;
    const char *title; /* above the picture; null or empty = none */
    double frame_rate; /* pictures per second of a film; 0 = real time, clamped to 10 .. 60 */
    double turn; /* degrees by which the camera turns around the bodies during a film, counter-clockwise; 0 = no motion.
                    A single frame becomes a film of 72 pictures: 360 makes a turntable that can be repeated */
    const char *program;          /* path of ffmpeg; null = search PATH */
    bool (*progress)(void *user); /* called before each frame is read and while it is drawn; returning false stops with
                                     PEL_STOPPED; nullable */
    void *user;
    uint32_t cookie; /* set by pel_render_def_default */
} pel_render_def;

PEL_API pel_render_def pel_render_def_default(void);

/* Summary of a rendering. */
typedef struct pel_render_summary {
    int32_t picture_count;     /* files, or pictures of the film */
    int32_t width, height;     /* pixels */
    char field[PEL_NAME_SIZE]; /* the first field that colours the surface; "" = none */
    double range[2];           /* of its colours */
    double read_s;             /* s, wall time of reading frames */
    double draw_s;             /* s, of drawing them */
    double least_s;            /* s, shortest time of drawing a picture */
    double write_s;            /* s, of compressing and writing pictures */
    char renderer[128];        /* name of the OpenGL renderer */
} pel_render_summary;

/* Draws a picture or film. log (nullable) receives notes, such as tools that cannot be drawn. summary is nullable.
   Tools are drawn at their poses in series.csv or the resolved scene of a run. Arrows that point into the surface have
   their head at the vertex, all others their tail. Errors: PEL_BAD_ARGUMENT (a number out of range, an
   unknown field with the nearest name, a frame that does not exist, no OpenGL, no font, no ffmpeg), PEL_BAD_FILE and
   PEL_BAD_FORMAT (missing or damaged frames, NaN in a field with frame and vertex, output that cannot be written),
   PEL_OUT_OF_MEMORY, PEL_STOPPED. A picture or film is written completely or not at all. */
PEL_API pel_status pel_render(const pel_render_def *def, const pel_log *log, pel_render_summary *summary,
                              pel_error *error);

/* A white picture for lines and text, without OpenGL. Lengths are in units of `scale` pixels, y points down; what lies
   outside the picture is cut off. */
typedef struct pel_canvas pel_canvas;
typedef enum pel_canvas_anchor { PEL_CANVAS_START, PEL_CANVAS_MIDDLE, PEL_CANVAS_END } pel_canvas_anchor;

/* Sizes 1 to 16384 pixels, scale 0.25 to 8. *canvas is null on failure. Free with pel_canvas_destroy. Errors:
   PEL_BAD_ARGUMENT (size or scale), PEL_BAD_FILE (no font), PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_canvas_create(double width, double height, double scale, pel_canvas **canvas, pel_error *error);
/* Null is permitted. */
PEL_API void pel_canvas_destroy(pel_canvas *canvas);

/* A line of this width through points (count x 2) with round ends and corners; one point is a dot. Numbers that are not
   finite break the line. Nothing happens if canvas or points is null. */
PEL_API void pel_canvas_line(pel_canvas *canvas, const double *points, int32_t count, double width,
                             const uint8_t rgb[3]);
/* A rectangle, rounded to pixels. */
PEL_API void pel_canvas_fill(pel_canvas *canvas, double x, double y, double width, double height, const uint8_t rgb[3]);
/* Black UTF-8 text, 13 units high, that starts, has its middle or ends at the point on its baseline; upward: turned by
   a quarter, from bottom to top. */
PEL_API void pel_canvas_text(pel_canvas *canvas, double x, double y, pel_canvas_anchor anchor, bool upward,
                             const char *text);
/* Writes a PNG; an older file stays if that fails. Errors: PEL_BAD_ARGUMENT, PEL_BAD_FILE. */
PEL_API pel_status pel_canvas_write(const pel_canvas *canvas, const char *path, pel_error *error);

#ifdef __cplusplus
}
#endif
#endif
