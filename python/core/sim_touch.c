/* Picking, dragging, pins, and derivatives by the adjoint method. */
#include "core.h"

#include <pellicle/live.h>
#include <pellicle/tear.h>

/* a change of a body by numbers of its vertices */
typedef pel_status vertex_change(pel_sim *sim, int32_t body, const int32_t *vertices, int32_t count, pel_error *error);

static PyObject *change_vertices(core_sim *self, const char *name, vertex_change *change, PyObject *const *arguments,
                                 Py_ssize_t count)
{
    Py_buffer view;
    pel_error error;
    if (core_check_count(name, count, 2) < 0)
        return NULL;
    int32_t body = core_sim_body(self, arguments[0]);
    if (body < 0 || core_get_array(arguments[1], "vertices", 'i', -1, 0, &view) < 0)
        return NULL;
    /* the potential belongs to the model, which the change may replace */
    pel_potential_destroy(self->potential);
    self->potential = NULL;
    pel_status status = change(self->sim, body, view.buf, (int32_t)(view.len / (Py_ssize_t)sizeof(int32_t)), &error);
    PyBuffer_Release(&view);
    return status == PEL_OK ? Py_NewRef(Py_None) : core_raise(&error);
}

/* set_pins(body, vertices) */
PyObject *core_sim_set_pins(core_sim *self, PyObject *const *arguments, Py_ssize_t count)
{
    return change_vertices(self, "set_pins", pel_sim_set_pins, arguments, count);
}

/* cut(body, vertices) */
PyObject *core_sim_cut(core_sim *self, PyObject *const *arguments, Py_ssize_t count)
{
    return change_vertices(self, "cut", pel_cut, arguments, count);
}

_Static_assert(sizeof(pel_tip) == 96, "as simulation.py reads it");

/* tips(body): rows of pel_tip as bytes */
PyObject *core_sim_tips(core_sim *self, PyObject *argument)
{
    pel_error error;
    int32_t body = core_sim_body(self, argument), count = 0, all = 0;
    void *rows;
    if (body < 0)
        return NULL;
    if (pel_sim_tips(self->sim, body, NULL, 0, &count, &error) != PEL_OK)
        return core_raise(&error);
    PyObject *bytes = core_new_bytes((size_t)count * sizeof(pel_tip), &rows);
    if (bytes == NULL)
        return NULL;
    if (pel_sim_tips(self->sim, body, rows, count, &all, &error) == PEL_OK)
        return bytes;
    Py_DECREF(bytes);
    return core_raise(&error);
}

#define SCORE(name, member, kind, count)                                                                               \
    {                                                                                                                  \
        name, kind, offsetof(pel_score, member), count                                                                 \
    }
static const core_member score_members[] = {
    SCORE("whole", hole.is_whole, CORE_BOOL, 1),
    SCORE("aim", hole.aim, CORE_DOUBLE, 1),
    SCORE("along", hole.along, CORE_DOUBLE, 3),
    SCORE("across", hole.across, CORE_DOUBLE, 3),
    SCORE("radius", hole.radius, CORE_DOUBLE, PEL_HOLE_SECTORS),
    SCORE("swept", hole.swept, CORE_DOUBLE, 1),
    SCORE("diameter", hole.diameter, CORE_DOUBLE, 1),
    SCORE("offset", hole.offset, CORE_DOUBLE, 1),
    SCORE("roundness", hole.roundness, CORE_DOUBLE, 1),
    SCORE("run_outs", hole.run_out_count, CORE_INT32, 1),
    SCORE("largest_radius", hole.largest, CORE_DOUBLE, 1),
    SCORE("force_peak", force_peak, CORE_DOUBLE, 1),
    SCORE("force_rms", force_rms, CORE_DOUBLE, 1),
    SCORE("time", time, CORE_DOUBLE, 1),
    SCORE("touches", touch_count, CORE_INT64, 1),
};

/* score(): a dict, or None */
PyObject *core_sim_score(core_sim *self, PyObject *unused)
{
    pel_score score;
    (void)unused;
    if (core_sim_check(self) < 0)
        return NULL;
    if (!pel_sim_get_score(self->sim, &score))
        return Py_NewRef(Py_None);
    return core_record(&score, score_members, sizeof score_members / sizeof *score_members);
}

static const core_member hit_members[] = {
    CORE_MEMBER(pel_pick_hit, body, CORE_INT32),        CORE_MEMBER(pel_pick_hit, triangle, CORE_INT32),
    CORE_ARRAY(pel_pick_hit, vertices, CORE_INT32, 3),  CORE_ARRAY(pel_pick_hit, weights, CORE_DOUBLE, 3),
    CORE_MEMBER(pel_pick_hit, mesh_vertex, CORE_INT32), CORE_MEMBER(pel_pick_hit, distance, CORE_DOUBLE),
    CORE_ARRAY(pel_pick_hit, point, CORE_DOUBLE, 3),    CORE_ARRAY(pel_pick_hit, normal, CORE_DOUBLE, 3),
};

/* origin and direction in one array of 6 */
static int cast(core_sim *self, PyObject *ray, pel_pick_hit *hit)
{
    Py_buffer view;
    pel_error error;
    if (core_sim_check(self) < 0 || core_get_array(ray, "ray", 'd', 6, 0, &view) < 0)
        return -1;
    const double *numbers = view.buf;
    pel_status status = pel_pick(self->sim, numbers, numbers + 3, hit, &error);
    PyBuffer_Release(&view);
    return status == PEL_OK ? 0 : (core_raise(&error), -1);
}

/* pick(ray): a dict, or None */
PyObject *core_sim_pick(core_sim *self, PyObject *ray)
{
    pel_pick_hit hit;
    if (cast(self, ray, &hit) < 0)
        return NULL;
    return hit.is_hit ? core_record(&hit, hit_members, sizeof hit_members / sizeof *hit_members) : Py_NewRef(Py_None);
}

/* ---- Drag ---- */

typedef struct core_drag {
    PyObject_HEAD pel_drag *drag; /* null after it has ended */
    core_sim *sim;                /* kept alive */
} core_drag;

PyTypeObject *core_drag_type;

/* drag(ray, stiffness, reach): a Drag, or None if the ray meets no body */
PyObject *core_sim_drag(core_sim *self, PyObject *const *arguments, Py_ssize_t count)
{
    pel_pick_hit hit;
    pel_error error;
    if (core_check_count("drag", count, 3) < 0)
        return NULL;
    double stiffness = PyFloat_AsDouble(arguments[1]), reach = PyFloat_AsDouble(arguments[2]);
    if (PyErr_Occurred() || cast(self, arguments[0], &hit) < 0)
        return NULL;
    if (!hit.is_hit)
        return Py_NewRef(Py_None);
    PyObject *none = PyTuple_New(0);
    core_drag *made = none != NULL ? (core_drag *)PyType_GenericNew(core_drag_type, none, NULL) : NULL;
    Py_XDECREF(none);
    if (made == NULL)
        return NULL;
    made->sim = (core_sim *)Py_NewRef((PyObject *)self);
    if (pel_drag_begin(self->sim, &hit, stiffness, reach, &made->drag, &error) == PEL_OK)
        return (PyObject *)made;
    Py_DECREF((PyObject *)made);
    return core_raise(&error);
}

static int drag_check(core_drag *self)
{
    if (self->drag == NULL) {
        PyErr_SetString(PyExc_ValueError, "this drag has ended. call Simulation.drag for a new one");
        return -1;
    }
    return core_sim_check(self->sim);
}

static PyObject *drag_move(core_drag *self, PyObject *target)
{
    Py_buffer view;
    pel_error error;
    if (drag_check(self) < 0 || core_get_array(target, "target", 'd', 3, 0, &view) < 0)
        return NULL;
    pel_status status = pel_drag_move(self->drag, view.buf, &error);
    PyBuffer_Release(&view);
    return status == PEL_OK ? Py_NewRef(Py_None) : core_raise(&error);
}

static const core_member drag_members[] = {
    CORE_ARRAY(pel_drag_reading, point, CORE_DOUBLE, 3),   CORE_ARRAY(pel_drag_reading, target, CORE_DOUBLE, 3),
    CORE_ARRAY(pel_drag_reading, force, CORE_DOUBLE, 3),   CORE_ARRAY(pel_drag_reading, reaction, CORE_DOUBLE, 3),
    CORE_MEMBER(pel_drag_reading, held_count, CORE_INT32),
};

static PyObject *drag_read(core_drag *self, PyObject *unused)
{
    (void)unused;
    pel_drag_reading reading;
    if (drag_check(self) < 0)
        return NULL;
    pel_drag_get(self->drag, &reading);
    return core_record(&reading, drag_members, sizeof drag_members / sizeof *drag_members);
}

static PyObject *drag_end(core_drag *self, PyObject *unused)
{
    (void)unused;
    pel_error error;
    if (self->drag == NULL)
        return Py_NewRef(Py_None);
    if (core_sim_check(self->sim) < 0)
        return NULL;
    pel_status status = pel_drag_end(self->drag, &error);
    self->drag = NULL;
    return status == PEL_OK ? Py_NewRef(Py_None) : core_raise(&error);
}

static void drag_free(core_drag *self)
{
    PyTypeObject *type = Py_TYPE((PyObject *)self);
    /* a drag that is freed during a step in another thread ends with the simulation */
    if (self->drag != NULL && !self->sim->is_busy)
        pel_drag_end(self->drag, NULL);
    Py_XDECREF((PyObject *)self->sim);
    freefunc give_back = (freefunc)PyType_GetSlot(type, Py_tp_free);
    give_back(self);
    Py_DECREF((PyObject *)type);
}

static PyMethodDef drag_methods[] = {
    {"move", (PyCFunction)drag_move, METH_O, NULL},
    {"read", (PyCFunction)drag_read, METH_NOARGS, NULL},
    {"end", (PyCFunction)drag_end, METH_NOARGS, NULL},
    {NULL, NULL, 0, NULL},
};
static PyType_Slot drag_slots[] = {
    {Py_tp_dealloc, (void *)drag_free},
    {Py_tp_methods, drag_methods},
    {0, NULL},
};
PyType_Spec core_drag_spec = {"pellicle._core.Drag", sizeof(core_drag), 0,
                              Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION, drag_slots};

/* ---- adjoint ---- */

static int32_t all_vertices(const core_sim *self)
{
    int32_t count = 0;
    for (int32_t b = 0; b < pel_model_body_count(pel_sim_model(self->sim)); b++)
        count += pel_sim_vertex_count(self->sim, b);
    return count;
}

enum {
    ADJOINT_GRADIENT,
    ADJOINT_FORCES,
    ADJOINT_REST,
    ADJOINT_LOADS,
    ADJOINT_GRAVITY,
    ADJOINT_MATERIALS,
    ADJOINT_COUNT
};
_Static_assert(sizeof(pel_adjoint_material) == 6 * sizeof(double), "rows of six numbers");

/* adjoint(gradient, forces, rest positions or None, loads, gravity, materials): fills all arrays except the first */
PyObject *core_sim_adjoint(core_sim *self, PyObject *const *arguments, Py_ssize_t count)
{
    static const char *const names[ADJOINT_COUNT] = {"loss_gradient", "forces",  "rest_positions",
                                                     "loads",         "gravity", "materials"};
    Py_buffer views[ADJOINT_COUNT] = {{0}};
    if (core_check_count("adjoint", count, ADJOINT_COUNT) < 0 || core_sim_check(self) < 0)
        return NULL;
    const Py_ssize_t vertices = all_vertices(self), bodies = pel_model_body_count(pel_sim_model(self->sim));
    const Py_ssize_t sizes[ADJOINT_COUNT] = {3 * vertices, 3 * vertices, 3 * vertices, pel_sim_load_count(self->sim), 3,
                                             6 * bodies};
    int opened = 0;
    while (opened < ADJOINT_COUNT &&
           ((opened == ADJOINT_REST && arguments[opened] == Py_None) ||
            core_get_array(arguments[opened], names[opened], 'd', sizes[opened], opened > 0, &views[opened]) == 0))
        opened++;
    pel_error error = {0};
    pel_status status = PEL_OK;
    if (opened == ADJOINT_COUNT) {
        const pel_adjoint def = {.positions = views[ADJOINT_GRADIENT].buf,
                                 .forces = views[ADJOINT_FORCES].buf,
                                 .rest_positions = views[ADJOINT_REST].buf,
                                 .loads = views[ADJOINT_LOADS].buf,
                                 .gravity = views[ADJOINT_GRAVITY].buf,
                                 .materials = views[ADJOINT_MATERIALS].buf};
        self->is_busy = 1;
        Py_BEGIN_ALLOW_THREADS status = pel_sim_adjoint(self->sim, &def, &error);
        Py_END_ALLOW_THREADS self->is_busy = 0;
    }
    for (int i = 0; i < opened; i++)
        PyBuffer_Release(&views[i]);
    if (opened < ADJOINT_COUNT)
        return NULL;
    return status == PEL_OK ? Py_NewRef(Py_None) : core_raise(&error);
}

/* arrays of adjoint_steps, in order */
enum {
    STEPS_POSITIONS,
    STEPS_VELOCITIES,
    STEPS_BY_POSITIONS,
    STEPS_BY_VELOCITIES,
    STEPS_START_POSITIONS,
    STEPS_START_VELOCITIES,
    STEPS_FORCES,
    STEPS_REST,
    STEPS_LOADS,
    STEPS_GRAVITY,
    STEPS_MATERIALS,
    STEPS_COUNT
};

typedef struct asked {
    PyObject *function;
    Py_buffer views[STEPS_COUNT];
} asked;

/* two arrays contain the state for the function, two others its derivatives */
static bool ask_function(void *user, const pel_adjoint_point *point)
{
    asked *a = user;
    size_t size = (size_t)a->views[STEPS_POSITIONS].len;
    PyGILState_STATE held = PyGILState_Ensure();
    memcpy(a->views[STEPS_POSITIONS].buf, point->positions, size);
    memcpy(a->views[STEPS_VELOCITIES].buf, point->velocities, size);
    PyObject *answer = PyObject_CallFunction(a->function, "L", (long long)point->step);
    if (answer != NULL) {
        memcpy(point->by_positions, a->views[STEPS_BY_POSITIONS].buf, size);
        memcpy(point->by_velocities, a->views[STEPS_BY_VELOCITIES].buf, size);
        Py_DECREF(answer);
    }
    PyGILState_Release(held);
    return answer != NULL;
}

static pel_status take_steps(core_sim *self, asked *a, long long steps, bool is_running, pel_error *error)
{
    const pel_adjoint_steps def = {.step_count = steps,
                                   .gradient = ask_function,
                                   .user = a,
                                   .is_running = is_running,
                                   .results = {.forces = a->views[STEPS_FORCES].buf,
                                               .rest_positions = a->views[STEPS_REST].buf,
                                               .loads = a->views[STEPS_LOADS].buf,
                                               .gravity = a->views[STEPS_GRAVITY].buf,
                                               .materials = a->views[STEPS_MATERIALS].buf},
                                   .start_positions = a->views[STEPS_START_POSITIONS].buf,
                                   .start_velocities = a->views[STEPS_START_VELOCITIES].buf};
    pel_status status;
    self->is_busy = 1;
    Py_BEGIN_ALLOW_THREADS status = pel_sim_adjoint_steps(self->sim, &def, error);
    Py_END_ALLOW_THREADS self->is_busy = 0;
    return status;
}

/* adjoint_steps(function, steps, running, positions, velocities, by positions, by velocities, start positions, start
   velocities, forces, rest positions or None, loads, gravity, materials) */
PyObject *core_sim_adjoint_steps(core_sim *self, PyObject *const *arguments, Py_ssize_t count)
{
    enum { FIRST = 3 };
    if (core_check_count("adjoint_steps", count, FIRST + STEPS_COUNT) < 0 || core_sim_check(self) < 0)
        return NULL;
    asked a = {.function = arguments[0]};
    long long steps = PyLong_AsLongLong(arguments[1]);
    int is_running = PyObject_IsTrue(arguments[2]);
    if ((steps == -1 && PyErr_Occurred()) || is_running < 0)
        return NULL;
    const Py_ssize_t vertices = 3 * all_vertices(self), bodies = pel_model_body_count(pel_sim_model(self->sim));
    int opened = 0;
    for (; opened < STEPS_COUNT; opened++) {
        Py_ssize_t size = opened == STEPS_LOADS       ? pel_sim_load_count(self->sim)
                          : opened == STEPS_GRAVITY   ? 3
                          : opened == STEPS_MATERIALS ? 6 * bodies
                                                      : vertices;
        if (opened == STEPS_REST && arguments[FIRST + opened] == Py_None)
            continue;
        if (core_get_array(arguments[FIRST + opened], "arrays", 'd', size, 1, &a.views[opened]) != 0)
            break;
    }
    pel_error error = {0};
    pel_status status = opened == STEPS_COUNT ? take_steps(self, &a, steps, is_running > 0, &error) : PEL_OK;
    for (int i = 0; i < opened; i++)
        PyBuffer_Release(&a.views[i]);
    if (opened < STEPS_COUNT || PyErr_Occurred())
        return NULL;
    return status == PEL_OK ? Py_NewRef(Py_None) : core_raise(&error);
}
