/* Pellicle: pictures and films of runs and meshes, drawn without a display. In the library pellicle_view (CMake target
   pellicle::view), because it needs OpenGL through EGL, FreeType, libpng and, for films, the program ffmpeg.

       const char *run = "results/sphere-press";
       pel_render_def def = pel_render_def_default();
       def.inputs = &run;
       def.input_count = 1;
       def.output = "press.png";
       pel_status status = pel_render(&def, NULL, &error);

   The same input gives the same picture on the same machine. z points up unless def.up says otherwise. */
#ifndef PELLICLE_RENDER_H
#define PELLICLE_RENDER_H

#include "base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Colours of numbers. */
typedef enum pel_color_map {
    PEL_COLORS_VIRIDIS,   /* S. van der Walt, N. Smith 2015: even steps for the eye, dark to bright */
    PEL_COLORS_CIVIDIS,   /* Nunez, Anderton, Renslow 2018: the same also for the colour-blind */
    PEL_COLORS_COOL_WARM, /* Moreland 2009: blue below, red above the middle */
    PEL_COLORS_WARM,      /* the upper half of cool-warm: grey at 0, red above */
    PEL_COLORS_COUNT,
    /* grey is zero: cool-warm for values of both signs, warm for values from 0; viridis for all others */
    PEL_COLORS_AUTO = PEL_COLORS_COUNT
} pel_color_map;

/* "viridis", "cividis", "cool-warm", "warm"; null past the last. Lives forever. */
PEL_API const char *pel_color_map_name(int index);
/* Looks a name up; false when there is none. */
PEL_API bool pel_color_map_find(const char *name, pel_color_map *map);
/* The colour at 0 .. 1 (clamped; NaN gives grey) as sRGB. */
PEL_API void pel_color_map_sample(pel_color_map map, double at, uint8_t rgb[3]);

/* Where the camera stands: degrees around the body, from the front counter-clockwise seen from above, and above its
   horizon (-90 .. 90). It looks at the middle and is as far away as needed to see everything. */
typedef struct pel_camera_angle {
    double azimuth, elevation;
    double zoom; /* 1 = fitted, 2 = twice as large */
} pel_camera_angle;

/* "iso", "front", "back", "left", "right", "top", "bottom"; null past the last. Lives forever. */
PEL_API const char *pel_camera_preset_name(int index);
/* Looks a preset up; false when there is none. */
PEL_API bool pel_camera_preset_find(const char *name, pel_camera_angle *angle);

typedef enum pel_background { PEL_BACKGROUND_WHITE, PEL_BACKGROUND_DARK, PEL_BACKGROUND_TRANSPARENT } pel_background;

/* Frames first, first + step, ... up to last; negative numbers count from the end, -1 is the last frame. */
typedef struct pel_frame_range {
    int32_t first, last, step; /* step >= 1 */
} pel_frame_range;

enum { PEL_RENDER_FIELD_LIMIT = 8 };

typedef struct pel_render_def {
    const char *const *inputs; /* (input_count) run folders, .vtp or mesh files */
    int32_t input_count;
    const char *const *labels; /* (input_count) label of each input; null = names of the folders */
    /* a folder (one picture for each frame), FILE.png (one picture; a contact sheet when there are several frames or
       inputs) or FILE.mp4 or FILE.gif (a film) */
    const char *output;
    const pel_frame_range *frames; /* (frame_range_count); null = all; for a .png the frame with the largest
                                      displacement of each run (the last frame if series.csv has no displacements), or
                                      as many as columns x rows hold, evenly spaced */
    int32_t frame_range_count;

    const char *field; /* vertex field that colours the surface, "none" = plain; up to PEL_RENDER_FIELD_LIMIT names
                          with commas between them stand side by side; null = displacement where there is one */
    int32_t component; /* of a vector field, from 0; -1 = magnitude */
    pel_color_map color_map; /* PEL_COLORS_AUTO */
    bool fixed_range;        /* false: least to largest value of all frames drawn; true: of the only coloured field */
    double range[2];         /* low < high, in the unit of the field */
    const char *unit;        /* of the only coloured field; null = SI unit of the known quantities, "" = none */
    const char *arrows;      /* vector field drawn as arrows, the longest value the longest arrow; null = none */

    pel_camera_angle angle;
    int32_t up;                /* axis that points up: 0 x, 1 y, 2 z */
    int32_t width, height;     /* pixels of the whole picture; 0 = 1280 x 720, or a size that suits the sheet */
    int32_t columns, rows;     /* of a contact sheet; 0 = one row for each input */
    bool flat;                 /* one normal per triangle */
    bool edges;                /* draw the edges of the triangles */
    bool outline;              /* draw a dark line along the silhouette of the surface */
    bool hide_tools, hide_bar; /* omit tools, the colour bar */
    bool hide_labels;          /* omit times and names */
    bool hide_ground;          /* omit the shadow on the ground */
    bool frame_numbers;        /* labels tell the number of the frame instead of the time */
    pel_background background;
    const char *title; /* above the picture; null or empty = none */
    double frame_rate; /* pictures per second of a film; 0 = real time, between 10 and 60 */
    double turn; /* degrees by which the camera goes around the body in a film, counter-clockwise; a single frame is
                    shown in 72 pictures: 360 makes a turntable that can be repeated. 0 = it stands still */
    const char *program;          /* the ffmpeg to use; null = the one of the search path */
    bool (*progress)(void *user); /* asked before each frame is read and while it is drawn; false stops with
                                     PEL_STOPPED; nullable */
    void *user;
    uint32_t cookie; /* set by pel_render_def_default */
} pel_render_def;

PEL_API pel_render_def pel_render_def_default(void);

/* Summary of a picture. */
typedef struct pel_render_summary {
    int32_t picture_count;     /* files, or pictures of the film */
    int32_t width, height;     /* pixels */
    char field[PEL_NAME_SIZE]; /* the first that colours the surface; "" = none */
    double range[2];           /* of its colours */
    double read_s;             /* wall time of reading frames, */
    double draw_s;             /* of drawing them, */
    double least_s;            /* of drawing the quickest picture, and */
    double write_s;            /* of packing and writing pictures */
    char renderer[128];
} pel_render_summary;

/* Draws a picture or film. log (nullable) receives notes, such as tools that cannot be drawn. summary is nullable.
   Tools are drawn at their poses in series.csv or the resolved scene of a run. Arrows whose vector points into the
   surface have their head, all others their tail at the vertex. Errors: PEL_BAD_ARGUMENT (a number out of range, an
   unknown field with the nearest name, a frame that does not exist, no OpenGL, no font, no ffmpeg), PEL_BAD_FILE and
   PEL_BAD_FORMAT (missing or damaged frames, NaN in a field with frame and vertex, output that cannot be written),
   PEL_OUT_OF_MEMORY, PEL_STOPPED. A picture or film is written whole or not at all. */
PEL_API pel_status pel_render(const pel_render_def *def, const pel_log *log, pel_render_summary *summary,
                              pel_error *error);

#ifdef __cplusplus
}
#endif
#endif
