/* Studies, their folders, and fit files. */
#include "core.h"

#include <pellicle/study.h>

typedef struct core_study {
    PyObject_HEAD pel_study *study;
} core_study;

typedef struct core_store {
    PyObject_HEAD pel_study_store *store;
    core_study *owner; /* owns the study; kept alive */
} core_store;

PyTypeObject *core_study_type, *core_store_type;

static void release(PyObject *self)
{
    PyTypeObject *type = Py_TYPE(self);
    freefunc give_back = (freefunc)PyType_GetSlot(type, Py_tp_free);
    give_back(self);
    Py_DECREF((PyObject *)type);
}

/* ---- Study(path, text): if text is None, the file is read ---- */

static PyObject *study_new(PyTypeObject *type, PyObject *arguments, PyObject *keywords)
{
    const char *path, *text;
    Py_ssize_t size;
    if (keywords != NULL && PyDict_Size(keywords) > 0)
        return PyErr_SetString(PyExc_TypeError, "Study takes no keywords"), NULL;
    if (!PyArg_ParseTuple(arguments, "sz#:Study", &path, &text, &size))
        return NULL;
    core_study *self = (core_study *)PyType_GenericNew(type, arguments, NULL);
    if (self == NULL)
        return NULL;
    pel_error error;
    pel_status status = text == NULL ? pel_study_load(path, &self->study, &error)
                                     : pel_study_parse(path, text, (size_t)size, &self->study, &error);
    if (status == PEL_OK)
        return (PyObject *)self;
    Py_DECREF((PyObject *)self);
    return core_raise(&error);
}

static void study_free(core_study *self)
{
    pel_study_destroy(self->study);
    release((PyObject *)self);
}

/* number of runs, and the first line of the table */
static PyObject *study_info(core_study *self, PyObject *unused)
{
    (void)unused;
    return Py_BuildValue("Ls", (long long)pel_study_run_count(self->study), pel_study_header(self->study));
}

/* run(number, folder or None): its row */
static PyObject *study_run(core_study *self, PyObject *arguments)
{
    long long run;
    const char *folder;
    if (!PyArg_ParseTuple(arguments, "Lz:run", &run, &folder))
        return NULL;
    char *row = PyMem_Calloc(pel_study_row_size(self->study) + 1, 1);
    if (row == NULL)
        return PyErr_NoMemory();
    pel_error error;
    pel_status status;
    Py_INCREF((PyObject *)self);
    Py_BEGIN_ALLOW_THREADS status = pel_study_run(self->study, run, folder, NULL, NULL, row, &error);
    Py_END_ALLOW_THREADS Py_DECREF((PyObject *)self);
    PyObject *text = status == PEL_OK ? PyUnicode_DecodeUTF8(row, (Py_ssize_t)strlen(row), "replace") : NULL;
    PyMem_Free(row);
    return status == PEL_OK ? text : core_raise(&error);
}

/* lost(number, status, what): the row of a run whose process wrote none */
static PyObject *study_lost(core_study *self, PyObject *arguments)
{
    long long run;
    const char *word, *what;
    if (!PyArg_ParseTuple(arguments, "Lss:lost", &run, &word, &what))
        return NULL;
    char *row = PyMem_Calloc(pel_study_row_size(self->study) + 1, 1);
    if (row == NULL)
        return PyErr_NoMemory();
    pel_error error;
    pel_status status = pel_study_lost_run(self->study, run, word, what, NULL, row, &error);
    PyObject *text = status == PEL_OK ? PyUnicode_DecodeUTF8(row, (Py_ssize_t)strlen(row), "replace") : NULL;
    PyMem_Free(row);
    return status == PEL_OK ? text : core_raise(&error);
}

/* called without the GIL, in the thread of `execute` */
static bool look_for_signals(void *user)
{
    (void)user;
    PyGILState_STATE state = PyGILState_Ensure();
    bool goes_on = PyErr_CheckSignals() == 0;
    PyGILState_Release(state);
    return goes_on;
}

/* execute(folder, jobs, time limit of a run [s], whether failed runs are repeated): runs, present, done, missing,
 * failed */
static PyObject *study_execute(core_study *self, PyObject *arguments)
{
    pel_study_def def = pel_study_def_default();
    pel_study_summary s;
    pel_error error;
    pel_status status;
    int retry;
    if (!PyArg_ParseTuple(arguments, "sidp:execute", &def.folder, &def.thread_count, &def.run_seconds, &retry))
        return NULL;
    def.retry = retry != 0;
    def.wanted = look_for_signals;
    Py_INCREF((PyObject *)self);
    Py_BEGIN_ALLOW_THREADS status = pel_study_execute(self->study, &def, &s, &error);
    Py_END_ALLOW_THREADS Py_DECREF((PyObject *)self);
    if (PyErr_Occurred())
        return NULL;
    if (status != PEL_OK)
        return core_raise(&error);
    return Py_BuildValue("LLLLL", (long long)s.runs, (long long)s.present, (long long)s.done, (long long)s.missing,
                         (long long)s.failed);
}

/* open(folder): the Store */
static PyObject *study_open(core_study *self, PyObject *argument)
{
    const char *folder = PyUnicode_AsUTF8AndSize(argument, NULL);
    if (folder == NULL)
        return NULL;
    PyObject *none = PyTuple_New(0);
    core_store *made = none != NULL ? (core_store *)PyType_GenericNew(core_store_type, none, NULL) : NULL;
    Py_XDECREF(none);
    if (made == NULL)
        return NULL;
    pel_error error;
    made->owner = (core_study *)Py_NewRef((PyObject *)self);
    if (pel_study_store_open(self->study, folder, 1, 1, &made->store, &error) == PEL_OK)
        return (PyObject *)made;
    Py_DECREF((PyObject *)made);
    return core_raise(&error);
}

/* ---- Store ---- */

static void store_free(core_store *self)
{
    pel_study_store_close(self->store);
    Py_XDECREF((PyObject *)self->owner);
    release((PyObject *)self);
}

/* -1 with an exception after close */
static int check_open(core_store *self)
{
    if (self->store != NULL)
        return 0;
    PyErr_SetString(PyExc_ValueError, "the folder of the study is closed");
    return -1;
}

static PyObject *store_needs(core_store *self, PyObject *argument)
{
    long long run = PyLong_AsLongLong(argument);
    if ((run == -1 && PyErr_Occurred()) || check_open(self) < 0)
        return NULL;
    return PyBool_FromLong(pel_study_store_needs(self->store, run));
}

static PyObject *store_failed(core_store *self, PyObject *argument)
{
    long long run = PyLong_AsLongLong(argument);
    if ((run == -1 && PyErr_Occurred()) || check_open(self) < 0)
        return NULL;
    return PyBool_FromLong(pel_study_store_failed(self->store, run));
}

static PyObject *store_add(core_store *self, PyObject *argument)
{
    pel_error error;
    const char *row = PyUnicode_AsUTF8AndSize(argument, NULL);
    if (row == NULL || check_open(self) < 0)
        return NULL;
    return pel_study_store_add(self->store, row, &error) == PEL_OK ? Py_NewRef(Py_None) : core_raise(&error);
}

/* numbers of missing and failed runs */
static PyObject *store_collect(core_store *self, PyObject *unused)
{
    (void)unused;
    int64_t missing, failed;
    pel_error error;
    if (check_open(self) < 0)
        return NULL;
    if (pel_study_store_collect(self->store, &missing, &failed, &error) != PEL_OK)
        return core_raise(&error);
    return Py_BuildValue("LL", (long long)missing, (long long)failed);
}

static PyObject *store_close(core_store *self, PyObject *unused)
{
    (void)unused;
    pel_study_store_close(self->store);
    self->store = NULL;
    return Py_NewRef(Py_None);
}

/* ---- types ---- */

static PyMethodDef study_methods[] = {
    {"info", (PyCFunction)study_info, METH_NOARGS, NULL},  {"run", (PyCFunction)study_run, METH_VARARGS, NULL},
    {"lost", (PyCFunction)study_lost, METH_VARARGS, NULL}, {"execute", (PyCFunction)study_execute, METH_VARARGS, NULL},
    {"open", (PyCFunction)study_open, METH_O, NULL},       {NULL, NULL, 0, NULL},
};
static PyType_Slot study_slots[] = {
    {Py_tp_new, (void *)study_new},
    {Py_tp_dealloc, (void *)study_free},
    {Py_tp_methods, study_methods},
    {0, NULL},
};
PyType_Spec core_study_spec = {"pellicle._core.Study", sizeof(core_study), 0, Py_TPFLAGS_DEFAULT, study_slots};

static PyMethodDef store_methods[] = {
    {"needs", (PyCFunction)store_needs, METH_O, NULL},      {"failed", (PyCFunction)store_failed, METH_O, NULL},
    {"add", (PyCFunction)store_add, METH_O, NULL},          {"collect", (PyCFunction)store_collect, METH_NOARGS, NULL},
    {"close", (PyCFunction)store_close, METH_NOARGS, NULL}, {NULL, NULL, 0, NULL},
};
static PyType_Slot store_slots[] = {
    {Py_tp_dealloc, (void *)store_free},
    {Py_tp_methods, store_methods},
    {0, NULL},
};
PyType_Spec core_store_spec = {"pellicle._core.Store", sizeof(core_store), 0,
                               Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION, store_slots};

/* load_fit(path): the fit file as JSON */
static PyObject *load_fit(PyObject *module, PyObject *argument)
{
    (void)module;
    char *json;
    pel_error error;
    const char *path = PyUnicode_AsUTF8AndSize(argument, NULL);
    if (path == NULL)
        return NULL;
    if (pel_fit_load(path, &json, &error) != PEL_OK)
        return core_raise(&error);
    PyObject *text = PyUnicode_DecodeUTF8(json, (Py_ssize_t)strlen(json), "replace");
    pel_fit_destroy(json);
    return text;
}

PyMethodDef core_study_methods[] = {
    {"load_fit", load_fit, METH_O, NULL},
    {NULL, NULL, 0, NULL},
};
