#include "core.h"

#include <pellicle/live.h>

/* set(0: positions or 1: velocities, body, values) */
PyObject *core_sim_set(core_sim *self, PyObject *const *arguments, Py_ssize_t count)
{
    int32_t is_velocity;
    Py_buffer view;
    if (core_check_count("set", count, 3) < 0 || core_get_index(arguments[0], "kind", 0, 1, &is_velocity) < 0)
        return NULL;
    int32_t body = core_sim_body(self, arguments[1]);
    if (body < 0)
        return NULL;
    const char *name = is_velocity ? "velocities" : "positions";
    if (core_get_array(arguments[2], name, 'd', 3 * (Py_ssize_t)pel_sim_vertex_count(self->sim, body), 0, &view) < 0)
        return NULL;
    pel_error error;
    pel_status status = is_velocity ? pel_sim_set_velocities(self->sim, body, view.buf, &error)
                                    : pel_sim_set_positions(self->sim, body, view.buf, &error);
    PyBuffer_Release(&view);
    return status == PEL_OK ? Py_NewRef(Py_None) : core_raise(&error);
}

/* set_load(number, force); the number must be that of a load of the scene */
PyObject *core_sim_set_load(core_sim *self, PyObject *const *arguments, Py_ssize_t count)
{
    int32_t load;
    Py_buffer view;
    pel_error error;
    if (core_check_count("set_load", count, 2) < 0 || core_sim_check(self) < 0 ||
        core_get_index(arguments[0], "load", 0, (int64_t)self->load_count - 1, &load) < 0 ||
        core_get_array(arguments[1], "force", 'd', 3, 0, &view) < 0)
        return NULL;
    pel_status status = pel_sim_set_load_force(self->sim, load, view.buf, &error);
    PyBuffer_Release(&view);
    return status == PEL_OK ? Py_NewRef(Py_None) : core_raise(&error);
}

/* set_tool(number, position and quaternion x, y, z, w in one array of 7) */
PyObject *core_sim_set_tool(core_sim *self, PyObject *const *arguments, Py_ssize_t count)
{
    int32_t tool;
    Py_buffer view;
    pel_error error;
    if (core_check_count("set_tool", count, 2) < 0 || core_sim_check(self) < 0 ||
        core_get_index(arguments[0], "tool", 0, (int64_t)pel_sim_tool_count(self->sim) - 1, &tool) < 0 ||
        core_get_array(arguments[1], "pose", 'd', 7, 0, &view) < 0)
        return NULL;
    const double *pose = view.buf;
    pel_status status = pel_sim_set_tool_pose(self->sim, tool, pose, pose + 3, &error);
    PyBuffer_Release(&view);
    return status == PEL_OK ? Py_NewRef(Py_None) : core_raise(&error);
}

/* set_parameter(path, value as text) */
PyObject *core_sim_set_parameter(core_sim *self, PyObject *const *arguments, Py_ssize_t count)
{
    pel_error error;
    if (core_check_count("set_parameter", count, 2) < 0 || core_sim_check(self) < 0)
        return NULL;
    const char *texts[2];
    for (int i = 0; i < 2; i++) {
        if (!PyUnicode_Check(arguments[i]))
            return PyErr_SetString(PyExc_TypeError, "path, value: must be str"), NULL;
        if ((texts[i] = PyUnicode_AsUTF8AndSize(arguments[i], NULL)) == NULL)
            return NULL;
    }
    /* the potential belongs to the model, which the change may replace */
    pel_potential_destroy(self->potential);
    self->potential = NULL;
    if (pel_set_parameter_text(self->sim, texts[0], texts[1], &error) != PEL_OK)
        return core_raise(&error);
    return Py_NewRef(Py_None);
}

PyObject *core_sim_save(core_sim *self, PyObject *unused)
{
    (void)unused;
    if (core_sim_check(self) < 0)
        return NULL;
    PyObject *bytes = PyBytes_FromStringAndSize(NULL, (Py_ssize_t)pel_sim_save_size(self->sim));
    if (bytes != NULL)
        pel_sim_save(self->sim, PyBytes_AsString(bytes));
    return bytes;
}

PyObject *core_sim_load(core_sim *self, PyObject *snapshot)
{
    char *bytes;
    Py_ssize_t size;
    pel_error error;
    if (core_sim_check(self) < 0 || PyBytes_AsStringAndSize(snapshot, &bytes, &size) < 0)
        return NULL;
    if (pel_sim_load(self->sim, bytes, (size_t)size, &error) != PEL_OK)
        return core_raise(&error);
    return Py_NewRef(Py_None);
}

/* ---- potential ---- */

/* opens the array with the positions of all bodies, and creates the potential if there is none */
static int open_potential(core_sim *self, PyObject *positions, Py_buffer *view)
{
    pel_error error;
    if (core_sim_check(self) < 0)
        return -1;
    if (self->potential == NULL && pel_potential_create(self->sim, &self->potential, &error) != PEL_OK) {
        core_raise(&error);
        return -1;
    }
    return core_get_array(positions, "x", 'd', 3 * (Py_ssize_t)pel_potential_vertex_count(self->potential), 0, view);
}

/* evaluate(x, array for the gradient or None): the energy */
PyObject *core_sim_evaluate(core_sim *self, PyObject *const *arguments, Py_ssize_t count)
{
    Py_buffer x, gradient = {0};
    double energy;
    if (core_check_count("evaluate", count, 2) < 0 || open_potential(self, arguments[0], &x) < 0)
        return NULL;
    if (arguments[1] != Py_None &&
        core_get_array(arguments[1], "out", 'd', x.len / (Py_ssize_t)sizeof(double), 1, &gradient) < 0) {
        PyBuffer_Release(&x);
        return NULL;
    }
    pel_error error;
    pel_status status;
    self->is_busy = 1;
    Py_BEGIN_ALLOW_THREADS status = pel_potential_evaluate(self->potential, x.buf, &energy, gradient.buf, &error);
    Py_END_ALLOW_THREADS self->is_busy = 0;
    PyBuffer_Release(&x);
    PyBuffer_Release(&gradient);
    return status == PEL_OK ? PyFloat_FromDouble(energy) : core_raise(&error);
}

static PyObject *bytes_of(const void *data, size_t count, size_t size)
{
    return PyByteArray_FromStringAndSize(data, (Py_ssize_t)(count * size));
}

/* hessian(x): row starts, columns, values, coefficients, volume gradients as bytearrays */
PyObject *core_sim_hessian(core_sim *self, PyObject *positions)
{
    Py_buffer x;
    pel_hessian *h;
    pel_error error;
    pel_status status;
    if (open_potential(self, positions, &x) < 0)
        return NULL;
    self->is_busy = 1;
    Py_BEGIN_ALLOW_THREADS status = pel_potential_hessian(self->potential, x.buf, &h, &error);
    Py_END_ALLOW_THREADS self->is_busy = 0;
    PyBuffer_Release(&x);
    if (status != PEL_OK)
        return core_raise(&error);
    size_t rows = (size_t)h->row_count, entries = (size_t)h->entry_count, products = (size_t)h->rank_one_count;
    PyObject *result = Py_BuildValue("NNNNN", bytes_of(h->row_start, rows + 1, sizeof *h->row_start),
                                     bytes_of(h->columns, entries, sizeof *h->columns),
                                     bytes_of(h->values, entries, sizeof *h->values),
                                     bytes_of(h->coefficients, products, sizeof *h->coefficients),
                                     bytes_of(h->volume_gradients, products * rows, sizeof *h->volume_gradients));
    pel_hessian_destroy(h);
    return result;
}
