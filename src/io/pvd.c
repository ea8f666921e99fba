#include "pellicle/results.h"

#include "base/memory.h"
#include "io/byte_order.h"
#include "io/file.h"
#include "io/number.h"
#include "io/xml.h"

#include <math.h>
#include <string.h>

pel_status pel_pvd_write(const char *path, const char *const *file_names, const double *times, int32_t frame_count,
                         pel_error *error)
{
    pel_file_writer writer;
    pel_status status = pel_file_writer_open(&writer, path, error);
    if (status != PEL_OK)
        return status;
    pel_file_writer_printf(&writer,
                           "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"%s\">\n"
                           "<Collection>\n",
                           PEL_BYTE_ORDER_NAME);
    for (int32_t i = 0; i < frame_count; i++) {
        char time[PEL_NUMBER_SIZE];
        pel_number_print(time, times[i]);
        pel_file_writer_printf(&writer, "<DataSet timestep=\"%s\" group=\"\" part=\"0\" file=\"", time);
        pel_xml_write_escaped(&writer, file_names[i]);
        pel_file_writer_printf(&writer, "\"/>\n");
    }
    pel_file_writer_printf(&writer, "</Collection>\n</VTKFile>\n");
    return pel_file_writer_commit(&writer, error);
}

/* ---- reading ---- */

enum { LONGEST_NAME = 4096 };

typedef struct pvd_reader {
    const char *path;
    const char *start, *end; /* the whole file */
    size_t capacity[2];      /* of times and paths */
    pel_pvd *pvd;
    pel_error *error;
} pvd_reader;

static pel_status fail_at(const pvd_reader *reader, const char *at, const char *what)
{
    pel_fail(reader->error, PEL_BAD_FORMAT, "%s", what);
    pel_fail_remedy(reader->error, "name a .pvd file that 'pellicle run' or ParaView wrote");
    pel_fail_offset(reader->error, reader->path, at - reader->start);
    return PEL_BAD_FORMAT;
}

/* the name with the folder of the .pvd before it, unless it begins at the root; null when out of memory */
static char *path_beside(const char *path, const char *name)
{
    const char *slash = name[0] != '/' ? strrchr(path, '/') : NULL;
    size_t length = slash != NULL ? (size_t)(slash - path) + 1 : 0, size = length + strlen(name) + 1;
    char *joined = pel_allocate(size, 1);
    if (joined != NULL)
        snprintf(joined, size, "%.*s%s", (int)length, path, name);
    return joined;
}

static pel_status read_data_set(pvd_reader *reader, const pel_xml_tag *tag)
{
    char name[LONGEST_NAME], number[PEL_NUMBER_SIZE];
    double time;
    if (!pel_xml_attribute(tag, "file", name, sizeof name) || name[0] == '\0')
        return fail_at(reader, tag->start, "a frame names no file");
    if (!pel_xml_attribute(tag, "timestep", number, sizeof number) ||
        pel_number_parse(number, number + strlen(number), &time) == NULL || !isfinite(time))
        return fail_at(reader, tag->start, "a frame has no time");
    pel_pvd *pvd = reader->pvd;
    size_t count = (size_t)pvd->frame_count;
    if (!pel_reserve((void **)&pvd->times, &reader->capacity[0], count + 1, sizeof *pvd->times) ||
        !pel_reserve((void **)&pvd->paths, &reader->capacity[1], count + 1, sizeof *pvd->paths) ||
        (pvd->paths[count] = path_beside(reader->path, name)) == NULL)
        return pel_fail_memory(reader->error);
    pvd->times[count] = time;
    pvd->frame_count++;
    return PEL_OK;
}

static pel_status read_tags(pvd_reader *reader)
{
    const char *at = reader->start;
    pel_xml_tag tag;
    bool is_collection = false, is_whole = false;
    while (pel_xml_next(&at, reader->end, &tag)) {
        pel_status status = PEL_OK;
        if (pel_xml_is(&tag, "Collection"))
            is_collection = true;
        else if (pel_xml_is(&tag, "/Collection"))
            is_whole = true;
        else if (pel_xml_is(&tag, "DataSet"))
            status = read_data_set(reader, &tag);
        if (status != PEL_OK)
            return status;
    }
    if (!is_collection)
        return fail_at(reader, reader->start, "this is no VTK collection file");
    if (!is_whole)
        return fail_at(reader, reader->end, "the end of the file is missing");
    return reader->pvd->frame_count > 0 ? PEL_OK
                                        : fail_at(reader, reader->start, "there is no frame in the collection");
}

pel_status pel_pvd_read(const char *path, pel_pvd **pvd, pel_error *error)
{
    char *bytes;
    size_t size;
    *pvd = NULL;
    pel_status status = pel_file_read(path, &bytes, &size, error);
    if (status != PEL_OK)
        return status;
    pvd_reader reader = {.path = path, .start = bytes, .end = bytes + size, .error = error};
    reader.pvd = pel_allocate(1, sizeof *reader.pvd);
    status = reader.pvd != NULL ? read_tags(&reader) : pel_fail_memory(error);
    pel_free(bytes);
    if (status == PEL_OK)
        *pvd = reader.pvd;
    else
        pel_pvd_destroy(reader.pvd);
    return status;
}

void pel_pvd_destroy(pel_pvd *pvd)
{
    if (pvd == NULL)
        return;
    for (int32_t i = 0; i < pvd->frame_count; i++)
        pel_free(pvd->paths[i]);
    pel_free(pvd->paths);
    pel_free(pvd->times);
    pel_free(pvd);
}
