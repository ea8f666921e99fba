/* The extension module pellicle._core: simulations for Python, against the limited API, so that one binary serves
   Python 3.11 and later. Arrays are passed through the buffer protocol; building needs no numpy. Users call the package
   around it (python/pellicle), which checks, names and documents arguments. The checks here ensure that no call,
   however wrong, reads or writes beyond an array. */
#ifndef PELLICLE_PYTHON_CORE_H
#define PELLICLE_PYTHON_CORE_H

#define PY_SSIZE_T_CLEAN
#include <Python.h>

#include <string.h>

#include <pellicle/pellicle.h>
#include <pellicle/scene.h>

/* ---- error.c: pel_error as a Python exception ---- */

extern PyObject *core_error; /* pellicle.Error */
PyObject *core_make_error_class(void);
/* raises pellicle.Error (MemoryError for PEL_OUT_OF_MEMORY); returns null */
PyObject *core_raise(const pel_error *error);

/* ---- array.c ---- */

/* A view of the array `object`, which must be C-contiguous, have this type ('d' double, 'i' int32) and `count` numbers
   (-1: any count). Errors name the argument: TypeError for another type, otherwise ValueError. Release with
   PyBuffer_Release. */
int core_get_array(PyObject *object, const char *name, char type, Py_ssize_t count, int is_written, Py_buffer *view);
/* -1 and ValueError unless a view has this shape: (rows), or (rows, columns) with more than one column */
int core_check_shape(const Py_buffer *view, const char *name, Py_ssize_t rows, Py_ssize_t columns);
/* a new numpy array of that type and shape */
PyObject *core_new_array(char type, Py_ssize_t rows, Py_ssize_t columns);
/* imports numpy for core_new_array; -1 with an exception */
int core_import_numpy(void);
/* -1 and an exception unless the number of arguments is right */
int core_check_count(const char *name, Py_ssize_t given, Py_ssize_t wanted);
/* An int within least .. most, or -1 with an exception that names the argument. */
int core_get_index(PyObject *object, const char *name, int64_t least, int64_t most, int32_t *index);
/* a bytearray of that size, zeros; null with MemoryError */
PyObject *core_new_bytes(size_t size, void **bytes);

/* ---- record.c: C structs as dicts ---- */

typedef enum core_kind { CORE_DOUBLE, CORE_INT32, CORE_INT64, CORE_BOOL } core_kind;
typedef struct core_member {
    const char *name;
    core_kind kind;
    size_t offset;
    int count; /* of an array; 1 = a single number */
} core_member;
#define CORE_MEMBER(type, member, kind)                                                                                \
    {                                                                                                                  \
#member, kind, offsetof(type, member), 1                                                                       \
    }
#define CORE_ARRAY(type, member, kind, count)                                                                          \
    {                                                                                                                  \
#member, kind, offsetof(type, member), count                                                                   \
    }
PyObject *core_record(const void *record, const core_member *members, size_t count);

/* ---- mesh.c ---- */

extern PyMethodDef core_mesh_methods[];

/* ---- scene.c ---- */

typedef struct core_scene {
    PyObject_HEAD pel_scene *scene;
    pel_model *model; /* built on first use */
    int is_busy;      /* a thread is building the model without the GIL */
} core_scene;
extern PyTypeObject *core_scene_type;
extern PyType_Spec core_scene_spec;
extern PyMethodDef core_run_methods[];

/* ---- sim.c ---- */

/* `wanted` of the library: checks for Ctrl-C every 0.05 s. user: double, time of the next check, 0 at first. Without
   the GIL; when it returns false the exception is set. */
bool core_is_wanted(void *user);

typedef struct core_sim {
    PyObject_HEAD pel_sim *sim;
    core_scene *owner; /* owns the model; kept alive */
    PyObject *names;   /* dict of the bodies: name -> number */
    int32_t load_count;
    int records;              /* whether contacts are recorded */
    pel_potential *potential; /* created on first use */
    double next_look;         /* s, of core_is_wanted */
    int is_busy;              /* a thread uses it without the GIL; other threads are refused */
} core_sim;
extern PyTypeObject *core_sim_type;
extern PyType_Spec core_sim_spec;
/* -1 and RuntimeError while another thread uses the simulation */
int core_sim_check(core_sim *self);
/* The number of a body given by name or number; -1 with an exception, also if core_sim_check fails. */
int32_t core_sim_body(core_sim *self, PyObject *body);
/* a tuple of (name, components, unit, doc, is on triangles too): the table of fields, in its order */
PyObject *core_field_table(void);
/* a tuple of (name, type, components, is on triangles): what `get` can fill, in its order */
PyObject *core_array_table(void);

/* ---- sim_change.c: methods that change a simulation, and its potential at other positions ---- */

PyObject *core_sim_set(core_sim *self, PyObject *const *arguments, Py_ssize_t count);
PyObject *core_sim_set_load(core_sim *self, PyObject *const *arguments, Py_ssize_t count);
PyObject *core_sim_set_tool(core_sim *self, PyObject *const *arguments, Py_ssize_t count);
PyObject *core_sim_set_parameter(core_sim *self, PyObject *const *arguments, Py_ssize_t count);
PyObject *core_sim_save(core_sim *self, PyObject *unused);
PyObject *core_sim_load(core_sim *self, PyObject *snapshot);
PyObject *core_sim_evaluate(core_sim *self, PyObject *const *arguments, Py_ssize_t count);
PyObject *core_sim_hessian(core_sim *self, PyObject *positions);

/* ---- sim_touch.c: picking, dragging, pins, derivatives ---- */

extern PyTypeObject *core_drag_type;
extern PyType_Spec core_drag_spec;
PyObject *core_sim_set_pins(core_sim *self, PyObject *const *arguments, Py_ssize_t count);
PyObject *core_sim_cut(core_sim *self, PyObject *const *arguments, Py_ssize_t count);
PyObject *core_sim_tips(core_sim *self, PyObject *argument);
PyObject *core_sim_score(core_sim *self, PyObject *unused);
PyObject *core_sim_pick(core_sim *self, PyObject *ray);
PyObject *core_sim_drag(core_sim *self, PyObject *const *arguments, Py_ssize_t count);
PyObject *core_sim_adjoint(core_sim *self, PyObject *const *arguments, Py_ssize_t count);
PyObject *core_sim_adjoint_steps(core_sim *self, PyObject *const *arguments, Py_ssize_t count);

/* ---- study.c ---- */

extern PyTypeObject *core_study_type, *core_store_type;
extern PyType_Spec core_study_spec, core_store_spec;
extern PyMethodDef core_study_methods[];

#endif
