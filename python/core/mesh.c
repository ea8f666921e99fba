/* Meshes. One comes in as three arguments: positions, triangles, and a tuple of fields (name, components, values); it
   goes out as a tuple of the same with bytearrays. */
#include "core.h"

#include <pellicle/import.h>

/* a mesh whose arrays are views of Python's arrays */
typedef struct borrowed_mesh {
    pel_mesh mesh;
    Py_buffer positions, triangles, *values; /* values (mesh.field_count) */
} borrowed_mesh;

static void give_back(borrowed_mesh *m)
{
    PyBuffer_Release(&m->positions);
    PyBuffer_Release(&m->triangles);
    for (int32_t f = 0; f < m->mesh.field_count; f++)
        PyBuffer_Release(&m->values[f]);
    PyMem_Free(m->values);
    PyMem_Free(m->mesh.fields);
}

static int borrow_field(borrowed_mesh *m, PyObject *item)
{
    const char *name;
    PyObject *values;
    int components;
    pel_field *field = &m->mesh.fields[m->mesh.field_count];
    if (!PyTuple_Check(item)) {
        PyErr_SetString(PyExc_TypeError, "fields: must be tuples of name, component count and values");
        return -1;
    }
    if (!PyArg_ParseTuple(item, "siO", &name, &components, &values))
        return -1;
    if (strlen(name) >= sizeof field->name || name[0] == '\0' || components < 1) {
        PyErr_Format(PyExc_ValueError, "fields: the name '%s' must have 1 to %d bytes", name, PEL_NAME_SIZE - 1);
        return -1;
    }
    Py_buffer *view = &m->values[m->mesh.field_count];
    if (core_get_array(values, name, 'd', (Py_ssize_t)m->mesh.vertex_count * components, 0, view) < 0)
        return -1;
    memcpy(field->name, name, strlen(name) + 1);
    field->component_count = components;
    field->values = view->buf;
    m->mesh.field_count++;
    return 0;
}

static int borrow_fields(borrowed_mesh *m, PyObject *fields)
{
    if (!PyTuple_Check(fields)) {
        PyErr_SetString(PyExc_TypeError, "fields: must be a tuple");
        return -1;
    }
    Py_ssize_t count = PyTuple_Size(fields);
    m->values = PyMem_Calloc((size_t)count + 1, sizeof *m->values);
    m->mesh.fields = PyMem_Calloc((size_t)count + 1, sizeof *m->mesh.fields);
    if (m->values == NULL || m->mesh.fields == NULL) {
        PyErr_NoMemory();
        return -1;
    }
    for (Py_ssize_t i = 0; i < count; i++)
        if (borrow_field(m, PyTuple_GetItem(fields, i)) < 0)
            return -1;
    return 0;
}

static int borrow_mesh(PyObject *const *arguments, borrowed_mesh *m)
{
    memset(m, 0, sizeof *m);
    if (core_get_array(arguments[0], "positions", 'd', -1, 0, &m->positions) < 0)
        return -1;
    if (core_get_array(arguments[1], "triangles", 'i', -1, 0, &m->triangles) < 0) {
        give_back(m);
        return -1;
    }
    Py_ssize_t coordinates = m->positions.len / (Py_ssize_t)sizeof(double);
    Py_ssize_t corners = m->triangles.len / (Py_ssize_t)sizeof(int32_t);
    int result = 0;
    if (coordinates % 3 != 0 || coordinates / 3 > INT32_MAX || corners % 3 != 0 || corners / 3 > INT32_MAX) {
        PyErr_SetString(PyExc_ValueError, "positions, triangles: must have rows of three numbers");
        result = -1;
    }
    m->mesh.vertex_count = (int32_t)(coordinates / 3);
    m->mesh.triangle_count = (int32_t)(corners / 3);
    m->mesh.positions = m->positions.buf;
    m->mesh.triangles = m->triangles.buf;
    if (result == 0)
        result = borrow_fields(m, arguments[2]);
    if (result < 0)
        give_back(m);
    return result;
}

/* a validated copy, for functions that do not check the mesh */
static int copy_mesh(PyObject *const *arguments, pel_mesh **mesh)
{
    borrowed_mesh m;
    pel_error error;
    if (borrow_mesh(arguments, &m) < 0)
        return -1;
    pel_status status =
        pel_mesh_create(m.positions.buf, m.mesh.vertex_count, m.triangles.buf, m.mesh.triangle_count, mesh, &error);
    for (int32_t f = 0; status == PEL_OK && f < m.mesh.field_count; f++) {
        const pel_field *field = &m.mesh.fields[f];
        status = pel_mesh_add_field(*mesh, field->name, field->component_count, field->values, &error);
    }
    give_back(&m);
    if (status == PEL_OK)
        return 0;
    pel_mesh_destroy(*mesh);
    core_raise(&error);
    return -1;
}

static PyObject *bytes_of(const void *data, size_t count, size_t size)
{
    return PyByteArray_FromStringAndSize(data, (Py_ssize_t)(count * size));
}

static PyObject *fields_of(const pel_mesh *mesh)
{
    PyObject *tuple = PyTuple_New(mesh->field_count);
    for (int32_t f = 0; tuple != NULL && f < mesh->field_count; f++) {
        const pel_field *field = &mesh->fields[f];
        size_t numbers = (size_t)mesh->vertex_count * (size_t)field->component_count;
        PyObject *item = Py_BuildValue("siN", field->name, (int)field->component_count,
                                       bytes_of(field->values, numbers, sizeof(double)));
        if (item == NULL || PyTuple_SetItem(tuple, f, item) < 0)
            Py_CLEAR(tuple);
    }
    return tuple;
}

/* converts a mesh to a tuple and destroys it */
static PyObject *hand_over(pel_mesh *mesh)
{
    PyObject *result = Py_BuildValue(
        "NNN", bytes_of(mesh->positions, (size_t)mesh->vertex_count, sizeof *mesh->positions),
        bytes_of(mesh->triangles, (size_t)mesh->triangle_count, sizeof *mesh->triangles), fields_of(mesh));
    pel_mesh_destroy(mesh);
    return result;
}

/* ---- files ---- */

static void collect_note(void *user, const char *text)
{
    PyObject *line = PyUnicode_DecodeUTF8(text, (Py_ssize_t)strlen(text), "replace");
    /* if there is no memory for the note, omit it */
    if (line == NULL || PyList_Append(user, line) < 0)
        PyErr_Clear();
    Py_XDECREF(line);
}

/* (path, notes) */
static PyObject *read_mesh(PyObject *module, PyObject *arguments)
{
    (void)module;
    const char *path;
    PyObject *notes;
    pel_mesh *mesh;
    pel_error error;
    if (!PyArg_ParseTuple(arguments, "sO:read_mesh", &path, &notes))
        return NULL;
    const pel_log log = {.write = collect_note, .user = notes};
    if (pel_mesh_import(path, PyList_Check(notes) ? &log : NULL, &mesh, &error) != PEL_OK)
        return core_raise(&error);
    return hand_over(mesh);
}

/* (path, positions, triangles, fields) */
static PyObject *write_mesh(PyObject *module, PyObject *const *arguments, Py_ssize_t count)
{
    (void)module;
    pel_mesh *mesh;
    pel_error error;
    PyObject *path;
    if (core_check_count("write_mesh", count, 4) < 0 || copy_mesh(arguments + 1, &mesh) < 0)
        return NULL;
    if (!PyUnicode_FSConverter(arguments[0], &path)) {
        pel_mesh_destroy(mesh);
        return NULL;
    }
    pel_status status = pel_mesh_write(PyBytes_AsString(path), PEL_FORMAT_AUTO, mesh, NULL, &error);
    pel_mesh_destroy(mesh);
    Py_DECREF(path);
    return status == PEL_OK ? Py_NewRef(Py_None) : core_raise(&error);
}

/* (path) of a .vtp file; returns the mesh and its time */
static PyObject *read_vtp(PyObject *module, PyObject *arguments)
{
    (void)module;
    const char *path;
    pel_mesh *mesh;
    double time;
    pel_error error;
    if (!PyArg_ParseTuple(arguments, "s:read_vtp", &path))
        return NULL;
    if (pel_vtp_read(path, &mesh, &time, &error) != PEL_OK)
        return core_raise(&error);
    return Py_BuildValue("Nd", hand_over(mesh), time);
}

/* (folder) of a run; returns the paths and times of its frames */
static PyObject *list_frames(PyObject *module, PyObject *arguments)
{
    (void)module;
    const char *folder;
    pel_frames *frames;
    pel_error error;
    if (!PyArg_ParseTuple(arguments, "s:list_frames", &folder))
        return NULL;
    if (pel_frames_open(folder, &frames, &error) != PEL_OK)
        return core_raise(&error);
    PyObject *list = PyList_New(frames->frame_count);
    for (int32_t f = 0; list != NULL && f < frames->frame_count; f++) {
        PyObject *item = Py_BuildValue("sd", frames->paths[f], frames->times[f]);
        if (item == NULL || PyList_SetItem(list, f, item) < 0)
            Py_CLEAR(list);
    }
    pel_frames_close(frames);
    return list;
}

/* write_frame(folder, positions, triangles, fields, time): frames/f00000.vtp and frames.pvd, as of a run with one frame
 */
static PyObject *write_frame(PyObject *module, PyObject *const *arguments, Py_ssize_t count)
{
    (void)module;
    static const char *const names[] = {"frames/f00000.vtp"};
    PyObject *folder;
    pel_mesh *mesh;
    pel_error error;
    pel_vtp_field fields[8];
    if (core_check_count("write_frame", count, 5) < 0)
        return NULL;
    double time = PyFloat_AsDouble(arguments[4]);
    if (PyErr_Occurred() || copy_mesh(arguments + 1, &mesh) < 0)
        return NULL;
    if (!PyUnicode_FSConverter(arguments[0], &folder)) {
        pel_mesh_destroy(mesh);
        return NULL;
    }
    pel_vtp vtp = {.vertex_count = mesh->vertex_count,
                   .triangle_count = mesh->triangle_count,
                   .positions = (const double *)mesh->positions,
                   .triangles = (const int32_t *)mesh->triangles,
                   .fields = fields,
                   .time = time};
    for (; vtp.field_count < mesh->field_count && vtp.field_count < 8; vtp.field_count++) {
        const pel_field *field = &mesh->fields[vtp.field_count];
        fields[vtp.field_count] = (pel_vtp_field){field->name, field->component_count, field->values};
    }
    PyObject *frame = PyBytes_FromFormat("%s/%s", PyBytes_AsString(folder), names[0]);
    PyObject *list = PyBytes_FromFormat("%s/frames.pvd", PyBytes_AsString(folder));
    PyObject *result = NULL;
    if (frame != NULL && list != NULL) {
        pel_status status = pel_vtp_write(PyBytes_AsString(frame), &vtp, &error);
        if (status == PEL_OK)
            status = pel_pvd_write(PyBytes_AsString(list), names, &time, 1, &error);
        result = status == PEL_OK ? Py_NewRef(Py_None) : core_raise(&error);
    }
    Py_XDECREF(frame);
    Py_XDECREF(list);
    Py_DECREF(folder);
    pel_mesh_destroy(mesh);
    return result;
}

/* ---- generated and changed meshes ---- */

/* (name, parameters): the parameters are a tuple of pairs of texts */
static PyObject *make_shape(PyObject *module, PyObject *arguments)
{
    (void)module;
    const char *name, *key, *value;
    PyObject *parameters;
    pel_shape_def def;
    pel_mesh *mesh;
    pel_error error;
    if (!PyArg_ParseTuple(arguments, "sO!:make_shape", &name, &PyTuple_Type, &parameters))
        return NULL;
    pel_status status = pel_shape_def_of_name(name, &def, &error);
    for (Py_ssize_t i = 0; status == PEL_OK && i < PyTuple_Size(parameters); i++) {
        PyObject *pair = PyTuple_GetItem(parameters, i);
        if (!PyTuple_Check(pair) || !PyArg_ParseTuple(pair, "ss", &key, &value))
            return NULL;
        status = pel_shape_set(&def, key, value, &error);
    }
    if (status == PEL_OK)
        status = pel_shape_create(&def, &mesh, &error);
    return status == PEL_OK ? hand_over(mesh) : core_raise(&error);
}

/* (positions, triangles, fields, levels) */
static PyObject *subdivide(PyObject *module, PyObject *const *arguments, Py_ssize_t count)
{
    (void)module;
    pel_mesh *mesh, *fine;
    pel_error error;
    int32_t levels;
    if (core_check_count("subdivide", count, 4) < 0 || core_get_index(arguments[3], "levels", 0, 32, &levels) < 0 ||
        copy_mesh(arguments, &mesh) < 0)
        return NULL;
    pel_status status;
    Py_BEGIN_ALLOW_THREADS status = pel_mesh_subdivide(mesh, levels, &fine, &error);
    Py_END_ALLOW_THREADS pel_mesh_destroy(mesh);
    return status == PEL_OK ? hand_over(fine) : core_raise(&error);
}

/* ---- checks ---- */

#define REPORT(member, kind) CORE_MEMBER(pel_mesh_report, member, kind)
static const core_member report_members[] = {
    REPORT(error_count, CORE_INT64),
    REPORT(warning_count, CORE_INT64),
    REPORT(vertex_count, CORE_INT32),
    REPORT(triangle_count, CORE_INT32),
    REPORT(edge_count, CORE_INT32),
    REPORT(boundary_loop_count, CORE_INT32),
    REPORT(component_count, CORE_INT32),
    REPORT(euler_characteristic, CORE_INT32),
    REPORT(genus, CORE_INT32),
    REPORT(closed, CORE_BOOL),
    REPORT(manifold, CORE_BOOL),
    REPORT(oriented, CORE_BOOL),
    REPORT(area, CORE_DOUBLE),
    REPORT(volume, CORE_DOUBLE),
    REPORT(edge_length_min, CORE_DOUBLE),
    REPORT(edge_length_median, CORE_DOUBLE),
    REPORT(edge_length_mean, CORE_DOUBLE),
    REPORT(edge_length_max, CORE_DOUBLE),
    REPORT(quality_min, CORE_DOUBLE),
    REPORT(quality_mean, CORE_DOUBLE),
    REPORT(worst_triangle, CORE_INT32),
    REPORT(valence_min, CORE_INT32),
    REPORT(valence_max, CORE_INT32),
    REPORT(valence_mean, CORE_DOUBLE),
    CORE_ARRAY(pel_mesh_report, bounds_low, CORE_DOUBLE, 3),
    CORE_ARRAY(pel_mesh_report, bounds_high, CORE_DOUBLE, 3),
};

static PyObject *issues_of(const pel_mesh_report *report)
{
    static const char *const severities[] = {"note", "warning", "error"};
    PyObject *list = PyList_New(0);
    for (int k = 0; list != NULL && k < PEL_ISSUE_COUNT; k++) {
        const pel_issue *issue = &report->issues[k];
        const pel_issue_info *info = pel_issue_info_of((pel_issue_kind)k);
        if (issue->count == 0)
            continue;
        PyObject *item =
            Py_BuildValue("{s:s,s:s,s:s,s:i,s:N,s:s,s:s,s:O}", "name", info->name, "element_kind", info->element_kind,
                          "severity", severities[info->severity], "count", (int)issue->count, "elements",
                          bytes_of(issue->elements, (size_t)issue->listed_count, sizeof *issue->elements), "doc",
                          info->doc, "remedy", info->remedy, "repairable", info->repairable ? Py_True : Py_False);
        if (item == NULL || PyList_Append(list, item) < 0)
            Py_CLEAR(list);
        Py_XDECREF(item);
    }
    return list;
}

/* (positions, triangles, fields) */
static PyObject *check(PyObject *module, PyObject *const *arguments, Py_ssize_t count)
{
    (void)module;
    borrowed_mesh m;
    pel_mesh_report *report;
    pel_error error;
    if (core_check_count("check", count, 3) < 0 || borrow_mesh(arguments, &m) < 0)
        return NULL;
    pel_status status = pel_mesh_check(&m.mesh, &report, &error);
    give_back(&m);
    if (status != PEL_OK)
        return core_raise(&error);
    PyObject *dict = core_record(report, report_members, sizeof report_members / sizeof *report_members);
    PyObject *issues = issues_of(report);
    if (dict == NULL || issues == NULL || PyDict_SetItemString(dict, "issues", issues) < 0)
        Py_CLEAR(dict);
    Py_XDECREF(issues);
    pel_mesh_report_destroy(report);
    return dict;
}

#define REPAIR(member, kind) CORE_MEMBER(pel_repair_summary, member, kind)
static const core_member repair_members[] = {
    REPAIR(bad_triangles, CORE_INT32),       REPAIR(degenerate_triangles, CORE_INT32),
    REPAIR(duplicate_triangles, CORE_INT32), REPAIR(welded_vertices, CORE_INT32),
    REPAIR(dropped_parts, CORE_INT32),       REPAIR(isolated_vertices, CORE_INT32),
    REPAIR(closed_slits, CORE_INT32),        REPAIR(cut_vertices, CORE_INT32),
    REPAIR(turned_triangles, CORE_INT32),    REPAIR(outward_components, CORE_INT32),
    REPAIR(non_orientable, CORE_INT32),      REPAIR(changed, CORE_BOOL),
};

/* (positions, triangles, fields, weld_tolerance, drop_parts) */
static PyObject *repair(PyObject *module, PyObject *const *arguments, Py_ssize_t count)
{
    (void)module;
    borrowed_mesh m;
    pel_mesh *repaired;
    pel_repair_summary summary;
    pel_error error;
    pel_repair_options options = pel_repair_options_default();
    if (core_check_count("repair", count, 5) < 0 ||
        core_get_index(arguments[4], "drop_parts", 0, INT32_MAX, &options.drop_parts) < 0)
        return NULL;
    options.weld_tolerance = PyFloat_AsDouble(arguments[3]);
    if (PyErr_Occurred() || borrow_mesh(arguments, &m) < 0)
        return NULL;
    pel_status status = pel_mesh_repair(&m.mesh, &options, &repaired, &summary, &error);
    give_back(&m);
    if (status != PEL_OK)
        return core_raise(&error);
    return Py_BuildValue("NN", hand_over(repaired),
                         core_record(&summary, repair_members, sizeof repair_members / sizeof *repair_members));
}

/* (positions, triangles, fields, limit): the number of all pairs, and at most `limit` of the pairs */
static PyObject *self_intersections(PyObject *module, PyObject *const *arguments, Py_ssize_t count)
{
    (void)module;
    borrowed_mesh m;
    pel_error error;
    int64_t pair_count;
    int32_t limit;
    void *pairs;
    if (core_check_count("self_intersections", count, 4) < 0 ||
        core_get_index(arguments[3], "limit", 0, 1 << 28, &limit) < 0 || borrow_mesh(arguments, &m) < 0)
        return NULL;
    PyObject *bytes = core_new_bytes((size_t)limit * sizeof(pel_pair), &pairs);
    if (bytes == NULL) {
        give_back(&m);
        return NULL;
    }
    pel_status status = pel_mesh_self_intersections(&m.mesh, pairs, limit, &pair_count, &error);
    give_back(&m);
    if (status == PEL_OK)
        return Py_BuildValue("LN", (long long)pair_count, bytes);
    Py_DECREF(bytes);
    return core_raise(&error);
}

/* ---- measures ---- */

/* (positions, triangles, fields, areas, normals, mean, gaussian): fills the four arrays */
static PyObject *measure(PyObject *module, PyObject *const *arguments, Py_ssize_t count)
{
    (void)module;
    static const char *const names[] = {"areas", "normals", "mean", "gaussian"};
    pel_mesh *mesh;
    pel_topology *topology;
    pel_error error;
    Py_buffer views[4] = {{0}};
    int ready = 1;
    if (core_check_count("measure", count, 7) < 0 || copy_mesh(arguments, &mesh) < 0)
        return NULL;
    for (int i = 0; ready && i < 4; i++)
        ready = core_get_array(arguments[3 + i], names[i], 'd', (i == 1 ? 3 : 1) * (Py_ssize_t)mesh->vertex_count, 1,
                               &views[i]) == 0;
    if (ready && pel_topology_create(mesh, &topology, &error) != PEL_OK) {
        core_raise(&error);
        ready = 0;
    }
    if (ready) {
        const double *positions = (const double *)mesh->positions;
        pel_surface_vertex_areas(topology, positions, views[0].buf);
        pel_surface_normals(topology, positions, PEL_NORMAL_ANGLE, views[1].buf);
        pel_surface_mean_curvature(topology, positions, views[2].buf, NULL);
        pel_surface_gaussian_curvature(topology, positions, views[3].buf, NULL);
        pel_topology_destroy(topology);
    }
    for (int i = 0; i < 4; i++)
        PyBuffer_Release(&views[i]);
    pel_mesh_destroy(mesh);
    return ready ? Py_NewRef(Py_None) : NULL;
}

#define FAST(function)                                                                                                 \
    {                                                                                                                  \
#function, (PyCFunction)(void (*)(void))function, METH_FASTCALL, NULL                                          \
    }
PyMethodDef core_mesh_methods[] = {
    {"read_mesh", read_mesh, METH_VARARGS, NULL},
    {"read_vtp", read_vtp, METH_VARARGS, NULL},
    {"list_frames", list_frames, METH_VARARGS, NULL},
    {"make_shape", make_shape, METH_VARARGS, NULL},
    FAST(write_mesh),
    FAST(write_frame),
    FAST(subdivide),
    FAST(check),
    FAST(repair),
    FAST(self_intersections),
    FAST(measure),
    {NULL, NULL, 0, NULL},
};
