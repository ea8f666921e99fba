/* A simulation: steps and readings. */
#include "core.h"

#include <pellicle/observe.h>

PyTypeObject *core_sim_type;

static void sim_free(core_sim *self)
{
    PyTypeObject *type = Py_TYPE((PyObject *)self);
    pel_potential_destroy(self->potential);
    pel_sim_destroy(self->sim);
    Py_XDECREF((PyObject *)self->owner);
    Py_XDECREF(self->names);
    freefunc release = (freefunc)PyType_GetSlot(type, Py_tp_free);
    release(self);
    Py_DECREF((PyObject *)type);
}

int core_sim_check(core_sim *self)
{
    if (!self->is_busy)
        return 0;
    PyErr_SetString(PyExc_RuntimeError, "another thread is using this simulation. create one simulation per thread");
    return -1;
}

static void refuse_name(core_sim *self, PyObject *body)
{
    PyObject *names = PyDict_Keys(self->names);
    if (names != NULL)
        PyErr_Format(PyExc_KeyError, "body: there is no body %R. use one of %R", body, names);
    Py_XDECREF(names);
}

int32_t core_sim_body(core_sim *self, PyObject *body)
{
    int32_t number;
    if (core_sim_check(self) < 0)
        return -1;
    int64_t last = (int64_t)pel_model_body_count(pel_sim_model(self->sim)) - 1;
    if (!PyUnicode_Check(body)) {
        if (core_get_index(body, "body", 0, last, &number) == 0)
            return number;
        if (PyErr_ExceptionMatches(PyExc_TypeError))
            PyErr_Format(PyExc_TypeError, "body: must be the name or number of a body, not %S",
                         (PyObject *)Py_TYPE(body));
        return -1;
    }
    PyObject *found = PyDict_GetItemWithError(self->names, body);
    if (found != NULL)
        return (int32_t)PyLong_AsLong(found);
    if (!PyErr_Occurred())
        refuse_name(self, body);
    return -1;
}

/* ---- steps ---- */

/* s between two checks for Ctrl-C */
#define LOOK_SECONDS 0.05

bool core_is_wanted(void *user)
{
    double *next = user, now = pel_seconds();
    if (now < *next)
        return true;
    *next = now + LOOK_SECONDS;
    PyGILState_STATE state = PyGILState_Ensure();
    /* the signal is handled once; its exception stays set */
    bool goes_on = !PyErr_Occurred() && PyErr_CheckSignals() == 0;
    PyGILState_Release(state);
    if (!goes_on)
        *next = 0;
    return goes_on;
}

static PyObject *sim_step(core_sim *self, PyObject *argument)
{
    int32_t count;
    if (core_get_index(argument, "n", 0, INT32_MAX, &count) < 0 || core_sim_check(self) < 0)
        return NULL;
    pel_error error;
    pel_status status = PEL_OK;
    int stopped = 0;
    self->is_busy = 1;
    while (count > 0 && status == PEL_OK && !stopped) {
        Py_BEGIN_ALLOW_THREADS double until = pel_seconds() + LOOK_SECONDS;
        do
            status = pel_sim_step(self->sim, &error);
        while (--count > 0 && status == PEL_OK && pel_seconds() < until);
        Py_END_ALLOW_THREADS stopped = status == PEL_STOPPED || PyErr_Occurred() || PyErr_CheckSignals() < 0;
    }
    self->is_busy = 0;
    if (stopped)
        return NULL;
    if (status != PEL_OK) {
        pel_scene_locate(self->owner->scene, &error);
        return core_raise(&error);
    }
    return Py_NewRef(Py_None);
}

/* ---- arrays ---- */

typedef void pel_getter(core_sim *self, int32_t body, void *out);

#define GETTER(name, type)                                                                                             \
    static void get_##name(core_sim *self, int32_t body, void *out)                                                    \
    {                                                                                                                  \
        pel_sim_get_##name(self->sim, body, (type *)out);                                                              \
    }
GETTER(positions, double)
GETTER(velocities, double)
GETTER(forces, double)
GETTER(rest_positions, double)
GETTER(masses, double)
GETTER(triangles, int32_t)
GETTER(levels, int32_t)
GETTER(origins, int32_t)

typedef struct sim_array {
    const char *name;
    pel_getter *get;
    char type;
    int components, on_triangles;
} sim_array;

#define ARRAY(name, type, components, on_triangles)                                                                    \
    {                                                                                                                  \
#name, get_##name, type, components, on_triangles                                                              \
    }
static const sim_array arrays[] = {
    ARRAY(positions, 'd', 3, 0),      ARRAY(velocities, 'd', 3, 0), ARRAY(forces, 'd', 3, 0),
    ARRAY(rest_positions, 'd', 3, 0), ARRAY(masses, 'd', 1, 0),     ARRAY(triangles, 'i', 3, 1),
    ARRAY(levels, 'i', 1, 0),         ARRAY(origins, 'i', 1, 0),
};
enum { ARRAY_COUNT = sizeof arrays / sizeof *arrays };

PyObject *core_array_table(void)
{
    PyObject *table = PyTuple_New(ARRAY_COUNT);
    for (int i = 0; table != NULL && i < ARRAY_COUNT; i++) {
        PyObject *row = Py_BuildValue("sCiO", arrays[i].name, arrays[i].type, arrays[i].components,
                                      arrays[i].on_triangles ? Py_True : Py_False);
        if (row == NULL || PyTuple_SetItem(table, i, row) < 0)
            Py_CLEAR(table);
    }
    return table;
}

/* get(number of the array, body, array to fill or None) */
static PyObject *sim_get(core_sim *self, PyObject *const *arguments, Py_ssize_t count)
{
    int32_t which;
    Py_buffer view;
    if (core_check_count("get", count, 3) < 0 || core_get_index(arguments[0], "array", 0, ARRAY_COUNT - 1, &which) < 0)
        return NULL;
    int32_t body = core_sim_body(self, arguments[1]);
    if (body < 0)
        return NULL;
    const sim_array *array = &arrays[which];
    Py_ssize_t rows =
        array->on_triangles ? pel_sim_triangle_count(self->sim, body) : pel_sim_vertex_count(self->sim, body);
    PyObject *out =
        arguments[2] == Py_None ? core_new_array(array->type, rows, array->components) : Py_NewRef(arguments[2]);
    if (out == NULL || core_get_array(out, "out", array->type, -1, 1, &view) < 0) {
        Py_XDECREF(out);
        return NULL;
    }
    if (core_check_shape(&view, "out", rows, array->components) < 0)
        Py_CLEAR(out);
    else
        array->get(self, body, view.buf);
    PyBuffer_Release(&view);
    return out;
}

PyObject *core_field_table(void)
{
    PyObject *table = PyTuple_New(pel_field_count());
    for (int32_t f = 0; table != NULL && f < pel_field_count(); f++) {
        const pel_field_info *info = pel_field_at(f);
        PyObject *row = Py_BuildValue("sissO", info->name, (int)info->component_count, info->unit, info->doc,
                                      info->place == PEL_FIELD_ON_BOTH ? Py_True : Py_False);
        if (row == NULL || PyTuple_SetItem(table, f, row) < 0)
            Py_CLEAR(table);
    }
    return table;
}

/* observe(field, body, on triangles instead of vertices, array to fill or None) */
static PyObject *sim_observe(core_sim *self, PyObject *const *arguments, Py_ssize_t count)
{
    int32_t field, on_triangles;
    Py_buffer view;
    pel_error error;
    if (core_check_count("observe", count, 4) < 0 ||
        core_get_index(arguments[0], "field", 0, (int64_t)pel_field_count() - 1, &field) < 0 ||
        core_get_index(arguments[2], "on_triangles", 0, 1, &on_triangles) < 0)
        return NULL;
    int32_t body = core_sim_body(self, arguments[1]);
    if (body < 0)
        return NULL;
    Py_ssize_t columns = pel_field_at(field)->component_count;
    Py_ssize_t rows = on_triangles ? pel_sim_triangle_count(self->sim, body) : pel_sim_vertex_count(self->sim, body);
    PyObject *out = arguments[3] == Py_None ? core_new_array('d', rows, columns) : Py_NewRef(arguments[3]);
    if (out == NULL || core_get_array(out, "out", 'd', -1, 1, &view) < 0) {
        Py_XDECREF(out);
        return NULL;
    }
    int fits = core_check_shape(&view, "out", rows, columns) == 0;
    pel_status status = PEL_OK;
    if (fits && on_triangles)
        status = pel_observe_triangles(self->sim, field, body, view.buf, &error);
    else if (fits)
        status = pel_observe(self->sim, field, body, view.buf, &error);
    PyBuffer_Release(&view);
    if (fits && status == PEL_OK)
        return out;
    Py_DECREF(out);
    return fits ? core_raise(&error) : NULL;
}

/* counts(body): numbers of vertices and triangles, and the revision of the surface */
static PyObject *sim_counts(core_sim *self, PyObject *argument)
{
    int32_t body = core_sim_body(self, argument);
    if (body < 0)
        return NULL;
    return Py_BuildValue("iiL", (int)pel_sim_vertex_count(self->sim, body),
                         (int)pel_sim_triangle_count(self->sim, body),
                         (long long)pel_sim_surface_revision(self->sim, body));
}

/* ---- records ---- */

#define MEASURE(member, kind) CORE_MEMBER(pel_sim_measures, member, kind)
static const core_member measure_members[] = {
    MEASURE(volume, CORE_DOUBLE),
    MEASURE(volume_ratio, CORE_DOUBLE),
    MEASURE(least_volume_ratio, CORE_DOUBLE),
    MEASURE(area_ratio, CORE_DOUBLE),
    MEASURE(kinetic_energy, CORE_DOUBLE),
    MEASURE(elastic_energy, CORE_DOUBLE),
    MEASURE(spring_energy, CORE_DOUBLE),
    MEASURE(volumetric_energy, CORE_DOUBLE),
    MEASURE(membrane_energy, CORE_DOUBLE),
    MEASURE(bending_energy, CORE_DOUBLE),
    MEASURE(fibre_energy, CORE_DOUBLE),
    MEASURE(max_displacement, CORE_DOUBLE),
    MEASURE(max_force, CORE_DOUBLE),
    MEASURE(vertex_count, CORE_INT64),
    MEASURE(triangle_count, CORE_INT64),
    MEASURE(contact_count, CORE_INT64),
};

#define LEDGER(member) CORE_MEMBER(pel_sim_ledger, member, CORE_DOUBLE)
static const core_member ledger_members[] = {
    LEDGER(work_tools),         LEDGER(work_loads),        LEDGER(work_pressure),
    LEDGER(work_gravity),       LEDGER(work_estimated),    LEDGER(work_material),
    LEDGER(work_setters),       LEDGER(elastic),           LEDGER(kinetic),
    LEDGER(elastic_start),      LEDGER(kinetic_start),     LEDGER(dissipated_drag),
    LEDGER(dissipated_plastic), LEDGER(dissipated_solver), LEDGER(energy_error),
    LEDGER(supplied),           LEDGER(tolerance),
};

#define SOLVER(member, kind) CORE_MEMBER(pel_solver_reading, member, kind)
static const core_member solver_members[] = {
    SOLVER(solves, CORE_BOOL),           SOLVER(iterations, CORE_INT32),     SOLVER(evaluations, CORE_INT32),
    SOLVER(energy, CORE_DOUBLE),         SOLVER(residual, CORE_DOUBLE),      SOLVER(converged, CORE_BOOL),
    SOLVER(substeps, CORE_INT32),        SOLVER(least_substeps, CORE_INT32), SOLVER(most_substeps, CORE_INT32),
    SOLVER(needed_substeps, CORE_INT32), SOLVER(second_order, CORE_BOOL),    SOLVER(softness, CORE_DOUBLE),
    SOLVER(most_softness, CORE_DOUBLE),
};

#define CONTACT(member, kind) CORE_MEMBER(pel_contact_statistics, member, kind)
static const core_member contact_members[] = {
    CONTACT(candidates, CORE_INT64),     CONTACT(passed_filter, CORE_INT64), CONTACT(passed_hull, CORE_INT64),
    CONTACT(cubics, CORE_INT64),         CONTACT(contacts, CORE_INT64),      CONTACT(dropped, CORE_INT64),
    CONTACT(rounds, CORE_INT64),         CONTACT(fall_backs, CORE_INT64),    CONTACT(tools_held, CORE_INT64),
    CONTACT(stepped_back, CORE_DOUBLE),  CONTACT(steps_divided, CORE_INT64), CONTACT(sleeping, CORE_DOUBLE),
    CONTACT(tangled, CORE_INT64),        CONTACT(find_seconds, CORE_DOUBLE), CONTACT(solve_seconds, CORE_DOUBLE),
    CONTACT(guard_seconds, CORE_DOUBLE),
};

#define TOOL(member, kind) CORE_MEMBER(pel_tool_reading, member, kind)
static const core_member tool_members[] = {
    CORE_ARRAY(pel_tool_reading, position, CORE_DOUBLE, 3),
    CORE_ARRAY(pel_tool_reading, rotation, CORE_DOUBLE, 4),
    CORE_ARRAY(pel_tool_reading, force, CORE_DOUBLE, 3),
    CORE_ARRAY(pel_tool_reading, torque, CORE_DOUBLE, 3),
    TOOL(contact_count, CORE_INT32),
    TOOL(held_count, CORE_INT32),
    TOOL(is_held_back, CORE_BOOL),
    TOOL(force_known, CORE_BOOL),
    TOOL(lost_count, CORE_INT64),
    TOOL(lost_time, CORE_DOUBLE),
    TOOL(lost_limit, CORE_DOUBLE),
    TOOL(held_back_count, CORE_INT64),
    TOOL(held_back_time, CORE_DOUBLE),
};

static const core_member support_members[] = {
    CORE_ARRAY(pel_support_reading, force, CORE_DOUBLE, 3),
    CORE_ARRAY(pel_support_reading, torque, CORE_DOUBLE, 3),
    CORE_MEMBER(pel_support_reading, vertex_count, CORE_INT32),
};

#define RECORD(record, members) core_record(record, members, sizeof members / sizeof *members)

static PyObject *sim_measure(core_sim *self, PyObject *unused)
{
    (void)unused;
    pel_sim_measures measures;
    if (core_sim_check(self) < 0)
        return NULL;
    pel_sim_measure(self->sim, &measures);
    return RECORD(&measures, measure_members);
}

static PyObject *sim_ledger(core_sim *self, PyObject *unused)
{
    (void)unused;
    pel_sim_ledger ledger;
    if (core_sim_check(self) < 0)
        return NULL;
    pel_sim_get_ledger(self->sim, &ledger);
    return RECORD(&ledger, ledger_members);
}

static PyObject *sim_solver(core_sim *self, PyObject *unused)
{
    (void)unused;
    pel_solver_reading reading;
    if (core_sim_check(self) < 0)
        return NULL;
    pel_sim_get_solver(self->sim, &reading);
    return RECORD(&reading, solver_members);
}

static PyObject *sim_contact(core_sim *self, PyObject *unused)
{
    (void)unused;
    pel_contact_statistics statistics;
    if (core_sim_check(self) < 0)
        return NULL;
    pel_sim_get_contact_statistics(self->sim, &statistics);
    return RECORD(&statistics, contact_members);
}

_Static_assert(sizeof(pel_contact_record) == 144, "as simulation.py reads it");

/* contact_records(): rows of pel_contact_record as bytes; None if contacts are not recorded */
static PyObject *sim_contact_records(core_sim *self, PyObject *unused)
{
    (void)unused;
    if (core_sim_check(self) < 0)
        return NULL;
    if (!self->records)
        return Py_NewRef(Py_None);
    void *records;
    PyObject *bytes =
        core_new_bytes((size_t)pel_sim_contact_record_count(self->sim) * sizeof(pel_contact_record), &records);
    pel_error error;
    if (bytes == NULL)
        return NULL;
    if (pel_sim_get_contact_records(self->sim, records, &error) == PEL_OK)
        return bytes;
    Py_DECREF(bytes);
    return core_raise(&error);
}

static PyObject *sim_tool(core_sim *self, PyObject *argument)
{
    int32_t tool;
    pel_tool_reading reading;
    if (core_sim_check(self) < 0 ||
        core_get_index(argument, "tool", 0, (int64_t)pel_sim_tool_count(self->sim) - 1, &tool) < 0)
        return NULL;
    pel_sim_get_tool(self->sim, tool, &reading);
    return RECORD(&reading, tool_members);
}

/* force and torque of a body on all its supports */
static PyObject *sim_support(core_sim *self, PyObject *argument)
{
    pel_support_reading reading;
    int32_t body = core_sim_body(self, argument);
    if (body < 0)
        return NULL;
    pel_sim_get_support(self->sim, body, &reading);
    return RECORD(&reading, support_members);
}

#define RIGID(member, count) CORE_ARRAY(pel_rigid_reading, member, CORE_DOUBLE, count)
static const core_member rigid_members[] = {
    CORE_MEMBER(pel_rigid_reading, mass, CORE_DOUBLE),
    RIGID(center, 3),
    RIGID(rotation, 4),
    RIGID(velocity, 3),
    RIGID(spin, 3),
    RIGID(momentum, 3),
    RIGID(angular_momentum, 3),
    CORE_MEMBER(pel_rigid_reading, kinetic_energy, CORE_DOUBLE),
};

/* place and motion of a rigid body; None of others */
static PyObject *sim_rigid(core_sim *self, PyObject *argument)
{
    pel_rigid_reading reading;
    int32_t body = core_sim_body(self, argument);
    if (body < 0)
        return NULL;
    if (pel_sim_get_rigid(self->sim, body, &reading))
        return RECORD(&reading, rigid_members);
    Py_RETURN_NONE;
}

static const core_member joint_members[] = {
    CORE_MEMBER(pel_joint_reading, position, CORE_DOUBLE), CORE_MEMBER(pel_joint_reading, speed, CORE_DOUBLE),
    CORE_ARRAY(pel_joint_reading, force, CORE_DOUBLE, 3),  CORE_ARRAY(pel_joint_reading, torque, CORE_DOUBLE, 3),
    CORE_MEMBER(pel_joint_reading, load, CORE_DOUBLE),     CORE_MEMBER(pel_joint_reading, work, CORE_DOUBLE),
};

static PyObject *sim_joint(core_sim *self, PyObject *argument)
{
    int32_t joint;
    pel_joint_reading reading;
    if (core_sim_check(self) < 0 ||
        core_get_index(argument, "joint", 0, (int64_t)pel_sim_joint_count(self->sim) - 1, &joint) < 0)
        return NULL;
    pel_sim_get_joint(self->sim, joint, &reading);
    return RECORD(&reading, joint_members);
}

static PyObject *names_of(core_sim *self, int32_t count, const char *(*name_of)(const pel_sim *, int32_t))
{
    PyObject *names = PyTuple_New(count);
    for (int32_t i = 0; names != NULL && i < count; i++) {
        PyObject *name = PyUnicode_FromString(name_of(self->sim, i));
        if (name == NULL || PyTuple_SetItem(names, i, name) < 0)
            Py_CLEAR(names);
    }
    return names;
}

static PyObject *sim_tools(core_sim *self, PyObject *unused)
{
    (void)unused;
    return core_sim_check(self) < 0 ? NULL : names_of(self, pel_sim_tool_count(self->sim), pel_sim_tool_name);
}

static PyObject *sim_joints(core_sim *self, PyObject *unused)
{
    (void)unused;
    return core_sim_check(self) < 0 ? NULL : names_of(self, pel_sim_joint_count(self->sim), pel_sim_joint_name);
}

/* time, steps, alpha, its limit, contact thickness */
static PyObject *sim_state(core_sim *self, PyObject *unused)
{
    (void)unused;
    if (core_sim_check(self) < 0)
        return NULL;
    return Py_BuildValue("dLddd", pel_sim_time(self->sim), (long long)pel_sim_step_count(self->sim),
                         pel_sim_alpha(self->sim), pel_sim_alpha_limit(self->sim),
                         pel_sim_contact_thickness(self->sim));
}

static PyObject *sim_time(core_sim *self, PyObject *unused)
{
    (void)unused;
    return core_sim_check(self) < 0 ? NULL : PyFloat_FromDouble(pel_sim_time(self->sim));
}

static PyObject *sim_hash(core_sim *self, PyObject *unused)
{
    (void)unused;
    return core_sim_check(self) < 0 ? NULL : PyLong_FromUnsignedLongLong(pel_sim_hash(self->sim));
}

static PyObject *sim_intersections(core_sim *self, PyObject *unused)
{
    (void)unused;
    int64_t count;
    pel_error error;
    if (core_sim_check(self) < 0)
        return NULL;
    if (pel_sim_intersections(self->sim, &count, &error) != PEL_OK)
        return core_raise(&error);
    return PyLong_FromLongLong(count);
}

#define CHANGE(name, flags)                                                                                            \
    {                                                                                                                  \
#name, (PyCFunction)(void (*)(void))core_sim_##name, flags, NULL                                               \
    }
#define METHOD(name, flags)                                                                                            \
    {                                                                                                                  \
#name, (PyCFunction)(void (*)(void))sim_##name, flags, NULL                                                    \
    }
static PyMethodDef methods[] = {
    CHANGE(set_parameter, METH_FASTCALL),
    METHOD(step, METH_O),
    METHOD(get, METH_FASTCALL),
    METHOD(observe, METH_FASTCALL),
    METHOD(counts, METH_O),
    METHOD(measure, METH_NOARGS),
    METHOD(ledger, METH_NOARGS),
    METHOD(solver, METH_NOARGS),
    METHOD(contact, METH_NOARGS),
    METHOD(contact_records, METH_NOARGS),
    METHOD(tool, METH_O),
    METHOD(support, METH_O),
    METHOD(rigid, METH_O),
    METHOD(joint, METH_O),
    METHOD(tools, METH_NOARGS),
    METHOD(joints, METH_NOARGS),
    METHOD(state, METH_NOARGS),
    METHOD(time, METH_NOARGS),
    METHOD(hash, METH_NOARGS),
    METHOD(intersections, METH_NOARGS),
    CHANGE(set, METH_FASTCALL),
    CHANGE(set_load, METH_FASTCALL),
    CHANGE(set_tool, METH_FASTCALL),
    CHANGE(save, METH_NOARGS),
    CHANGE(load, METH_O),
    CHANGE(evaluate, METH_FASTCALL),
    CHANGE(hessian, METH_O),
    CHANGE(set_pins, METH_FASTCALL),
    CHANGE(cut, METH_FASTCALL),
    CHANGE(tips, METH_O),
    CHANGE(score, METH_NOARGS),
    CHANGE(pick, METH_O),
    CHANGE(drag, METH_FASTCALL),
    CHANGE(adjoint, METH_FASTCALL),
    CHANGE(adjoint_steps, METH_FASTCALL),
    {NULL, NULL, 0, NULL},
};
static PyType_Slot slots[] = {
    {Py_tp_dealloc, (void *)sim_free},
    {Py_tp_methods, methods},
    {0, NULL},
};
PyType_Spec core_sim_spec = {"pellicle._core.Sim", sizeof(core_sim), 0,
                             Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION, slots};
