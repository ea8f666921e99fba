#include "view/image.h"

#include "view/support.h"

#include <errno.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

pel_status view_image_create(view_image *image, int32_t width, int32_t height, pel_error *error)
{
    *image = (view_image){.width = width, .height = height};
    image->pixels = view_allocate((size_t)width * (size_t)height, 4);
    if (image->pixels != NULL)
        return PEL_OK;
    *image = (view_image){0};
    return pel_fail_memory(error);
}

void view_image_destroy(view_image *image)
{
    free(image->pixels);
    *image = (view_image){0};
}

static uint8_t *pixel_at(const view_image *image, int32_t x, int32_t y)
{
    return image->pixels + 4 * ((size_t)y * (size_t)image->width + (size_t)x);
}

void view_image_fill(view_image *image, int32_t x, int32_t y, int32_t width, int32_t height, view_color color)
{
    int32_t right = x + width < image->width ? x + width : image->width;
    int32_t bottom = y + height < image->height ? y + height : image->height;
    for (int32_t row = y < 0 ? 0 : y; row < bottom; ++row) {
        for (int32_t column = x < 0 ? 0 : x; column < right; ++column)
            memcpy(pixel_at(image, column, row), color.rgba, 4);
    }
}

void view_image_blend(view_image *image, int32_t x, int32_t y, view_color color, uint8_t cover)
{
    if (x < 0 || y < 0 || x >= image->width || y >= image->height || cover == 0)
        return;
    uint8_t *pixel = pixel_at(image, x, y);
    /* in units of 1 / (255 x 255) */
    uint32_t over = (uint32_t)cover * color.rgba[3], below = pixel[3] * (255u * 255u - over) / 255u;
    uint32_t alpha = over + below;
    for (int i = 0; alpha > 0 && i < 3; ++i)
        pixel[i] = (uint8_t)((color.rgba[i] * over + pixel[i] * below + alpha / 2) / alpha);
    pixel[3] = (uint8_t)((alpha + 127) / 255);
}

static pel_status fail_writing(const char *path, const char *why, pel_error *error)
{
    pel_fail(error, PEL_BAD_FILE, "cannot write the picture: %s", why);
    pel_fail_place(error, path, 0, 0);
    pel_fail_remedy(error, "check that the folder exists and that there is space");
    return PEL_BAD_FILE;
}

/* the colors alone when no pixel is transparent, which is less to pack; null when one is */
static pel_status copy_opaque(const view_image *image, uint8_t **colors, pel_error *error)
{
    size_t count = (size_t)image->width * (size_t)image->height, i = 0;
    *colors = view_allocate(count, 3);
    if (*colors == NULL)
        return pel_fail_memory(error);
    for (; i < count && image->pixels[4 * i + 3] == 255; ++i)
        memcpy(*colors + 3 * i, image->pixels + 4 * i, 3);
    if (i == count)
        return PEL_OK;
    free(*colors);
    *colors = NULL;
    return PEL_OK;
}

/* colors: of all pixels, or null */
static pel_status write_png(const view_image *image, const uint8_t *colors, const char *path, FILE *file, bool fast,
                            pel_error *error)
{
    png_image png = {.version = PNG_IMAGE_VERSION,
                     .width = (png_uint_32)image->width,
                     .height = (png_uint_32)image->height,
                     .format = colors != NULL ? PNG_FORMAT_RGB : PNG_FORMAT_RGBA,
                     .flags = fast ? PNG_IMAGE_FLAG_FAST : 0};
    bool good = png_image_write_to_stdio(&png, file, 0, colors != NULL ? colors : image->pixels, 0, NULL) != 0;
    int number = errno;
    if (fclose(file) == 0 && good)
        return PEL_OK;
    return fail_writing(path, good ? strerror(errno) : number != 0 ? strerror(number) : png.message, error);
}

pel_status view_image_write(const view_image *image, const char *path, bool fast, pel_error *error)
{
    char temporary[4096];
    if ((size_t)snprintf(temporary, sizeof temporary, "%s.%ld.part", path, (long)getpid()) >= sizeof temporary)
        return fail_writing(path, "the name is too long", error);
    FILE *file = fopen(temporary, "wb");
    if (file == NULL)
        return fail_writing(path, strerror(errno), error);
    uint8_t *colors;
    pel_status status = copy_opaque(image, &colors, error);
    errno = 0;
    if (status == PEL_OK)
        status = write_png(image, colors, path, file, fast, error);
    else
        fclose(file);
    free(colors);
    if (status == PEL_OK && rename(temporary, path) != 0)
        status = fail_writing(path, strerror(errno), error);
    if (status != PEL_OK)
        unlink(temporary);
    return status;
}
