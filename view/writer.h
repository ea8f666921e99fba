/* Compresses and writes one picture in a separate thread while the next one is drawn. */
#ifndef PELLICLE_VIEW_WRITER_H
#define PELLICLE_VIEW_WRITER_H

#include "view/image.h"

#include <pthread.h>

enum { VIEW_WRITER_PATH = 4096 };

typedef struct view_writer {
    view_image image; /* the picture being written */
    char path[VIEW_WRITER_PATH];
    bool fast, busy;
    pthread_t thread;
    pel_status status; /* of that picture */
    pel_error error;
    double seconds; /* spent on all pictures */
} view_writer;

/* For pictures of that size. PEL_OUT_OF_MEMORY. Close also on failure. */
pel_status view_writer_open(view_writer *writer, int32_t width, int32_t height, pel_error *error);

/* Takes the pixels of an image, which gets another buffer in exchange, and writes them like view_image_write. Waits for
   the previous picture and returns its failure; nothing is written then. */
pel_status view_writer_add(view_writer *writer, view_image *image, const char *path, bool fast, pel_error *error);

/* Waits for the last picture and returns its failure. */
pel_status view_writer_close(view_writer *writer, pel_error *error);

#endif
