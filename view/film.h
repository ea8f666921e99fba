/* Films: pictures are piped to ffmpeg, which writes MP4 or GIF. */
#ifndef PELLICLE_VIEW_FILM_H
#define PELLICLE_VIEW_FILM_H

#include "view/image.h"

typedef struct view_film view_film;

/* Starts ffmpeg (program null: the one of the search path). Errors: PEL_BAD_ARGUMENT (no ffmpeg), PEL_BAD_FILE,
   PEL_OUT_OF_MEMORY; *film is null then. */
pel_status view_film_create(const char *path, int32_t width, int32_t height, double frame_rate, const char *program,
                            view_film **film, pel_error *error);
pel_status view_film_add(view_film *film, const view_image *image, pel_error *error);
/* Ends the film and puts it under its name, unless `keep` is false or something failed. */
pel_status view_film_close(view_film *film, bool keep, pel_error *error);

#endif
