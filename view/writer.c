#include "view/writer.h"

#include "view/support.h"

#include <stdio.h>

pel_status view_writer_open(view_writer *writer, int32_t width, int32_t height, pel_error *error)
{
    *writer = (view_writer){.status = PEL_OK};
    return view_image_create(&writer->image, width, height, error);
}

static void *write_picture(void *argument)
{
    view_writer *writer = argument;
    double start = pel_seconds();
    writer->status = view_image_write(&writer->image, writer->path, writer->fast, &writer->error);
    writer->seconds += pel_seconds() - start;
    return NULL;
}

/* the failure of the picture that was written, once */
static pel_status wait_for_picture(view_writer *writer, pel_error *error)
{
    if (writer->busy)
        pthread_join(writer->thread, NULL);
    writer->busy = false;
    pel_status status = writer->status;
    if (status != PEL_OK && error != NULL)
        *error = writer->error;
    writer->status = PEL_OK;
    return status;
}

pel_status view_writer_add(view_writer *writer, view_image *image, const char *path, bool fast, pel_error *error)
{
    pel_status status = wait_for_picture(writer, error);
    if (status != PEL_OK)
        return status;
    view_image drawn = *image;
    *image = writer->image;
    writer->image = drawn;
    writer->fast = fast;
    snprintf(writer->path, sizeof writer->path, "%s", path);
    writer->busy = pthread_create(&writer->thread, NULL, write_picture, writer) == 0;
    if (writer->busy)
        return PEL_OK;
    /* without a thread it takes longer */
    write_picture(writer);
    return wait_for_picture(writer, error);
}

pel_status view_writer_close(view_writer *writer, pel_error *error)
{
    pel_status status = wait_for_picture(writer, error);
    view_image_destroy(&writer->image);
    return status;
}
