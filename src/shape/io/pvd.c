#include "io/pvd.h"

#include "base/memory.h"
#include "base/number.h"
#include "base/status.h"
#include "io/byte_order.h"
#include "io/file.h"
#include "io/xml.h"

pel_status pel_pvd_write_entries(const char *path, const pel_pvd_entry *entries, size_t count, pel_error *error)
{
    pel_file_writer writer;
    pel_status status = pel_file_writer_open(&writer, path, error);
    if (status != PEL_OK)
        return status;
    pel_file_writer_printf(&writer,
                           "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"%s\">\n"
                           "<Collection>\n",
                           PEL_BYTE_ORDER_NAME);
    for (size_t i = 0; i < count; i++) {
        char time[PEL_NUMBER_SIZE];
        pel_number_print(time, entries[i].time);
        pel_file_writer_printf(&writer, "<DataSet timestep=\"%s\" group=\"\" part=\"%d\"", time, (int)entries[i].part);
        if (entries[i].name != NULL) {
            pel_file_writer_printf(&writer, " name=\"");
            pel_xml_write_escaped(&writer, entries[i].name);
            pel_file_writer_printf(&writer, "\"");
        }
        pel_file_writer_printf(&writer, " file=\"");
        pel_xml_write_escaped(&writer, entries[i].file);
        pel_file_writer_printf(&writer, "\"/>\n");
    }
    pel_file_writer_printf(&writer, "</Collection>\n</VTKFile>\n");
    return pel_file_writer_commit(&writer, error);
}

pel_status pel_pvd_write(const char *path, const char *const *file_names, const double *times, int32_t frame_count,
                         pel_error *error)
{
    PEL_REFUSE_NULL(path, error);
    if (frame_count < 0)
        return pel_fail(error, PEL_BAD_ARGUMENT, "frame_count is %d", (int)frame_count);
    if (frame_count > 0) {
        PEL_REFUSE_NULL(file_names, error);
        PEL_REFUSE_NULL(times, error);
    }
    for (int32_t i = 0; i < frame_count; i++)
        if (file_names[i] == NULL)
            return pel_fail(error, PEL_BAD_ARGUMENT, "file_names[%d] is null", (int)i);
    pel_pvd_entry *entries = pel_allocate((size_t)frame_count, sizeof *entries);
    if (entries == NULL)
        return pel_fail_memory(error);
    for (int32_t i = 0; i < frame_count; i++)
        entries[i] = (pel_pvd_entry){.file = file_names[i], .time = times[i]};
    pel_status status = pel_pvd_write_entries(path, entries, (size_t)frame_count, error);
    pel_free(entries);
    return status;
}
