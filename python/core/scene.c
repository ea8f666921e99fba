/* Scenes, whole runs, reports. */
#include "core.h"

#include <pellicle/report.h>
#include <pellicle/run.h>

PyTypeObject *core_scene_type;

static void collect_note(void *user, const char *text)
{
    PyObject *line = PyUnicode_DecodeUTF8(text, (Py_ssize_t)strlen(text), "replace");
    /* if there is no memory for the note, omit it */
    if (line == NULL || PyList_Append(user, line) < 0)
        PyErr_Clear();
    Py_XDECREF(line);
}

/* the strings of a tuple, which must outlive the result; free with PyMem_Free */
static const char **texts_of(PyObject *tuple, int32_t *count)
{
    Py_ssize_t size = PyTuple_Size(tuple);
    const char **texts = size > INT32_MAX / 2 ? NULL : PyMem_Calloc((size_t)size + 1, sizeof *texts);
    if (texts == NULL) {
        PyErr_NoMemory();
        return NULL;
    }
    for (Py_ssize_t i = 0; i < size; i++)
        if ((texts[i] = PyUnicode_AsUTF8AndSize(PyTuple_GetItem(tuple, i), NULL)) == NULL) {
            PyMem_Free(texts);
            return NULL;
        }
    *count = (int32_t)size;
    return texts;
}

/* Scene(path, text, overrides, notes): if text is None, the file is read */
static PyObject *scene_new(PyTypeObject *type, PyObject *arguments, PyObject *keywords)
{
    const char *path, *text;
    Py_ssize_t size;
    PyObject *overrides, *notes;
    if (keywords != NULL && PyDict_Size(keywords) > 0)
        return PyErr_SetString(PyExc_TypeError, "Scene takes no keywords"), NULL;
    if (!PyArg_ParseTuple(arguments, "sz#O!O!:Scene", &path, &text, &size, &PyTuple_Type, &overrides, &PyList_Type,
                          &notes))
        return NULL;
    int32_t count;
    const char **texts = texts_of(overrides, &count);
    core_scene *self = texts != NULL ? (core_scene *)PyType_GenericNew(type, arguments, NULL) : NULL;
    pel_status status = PEL_OK;
    pel_error error;
    const pel_log log = {.write = collect_note, .user = notes};
    if (self != NULL && text == NULL)
        status = pel_scene_load(path, texts, count, &log, &self->scene, &error);
    else if (self != NULL)
        status = pel_scene_parse(path, text, (size_t)size, texts, count, &log, &self->scene, &error);
    PyMem_Free(texts);
    if (status == PEL_OK)
        return (PyObject *)self;
    Py_XDECREF((PyObject *)self);
    return core_raise(&error);
}

static void scene_free(core_scene *self)
{
    PyTypeObject *type = Py_TYPE((PyObject *)self);
    pel_model_destroy(self->model);
    pel_scene_destroy(self->scene);
    freefunc release = (freefunc)PyType_GetSlot(type, Py_tp_free);
    release(self);
    Py_DECREF((PyObject *)type);
}

/* builds the model without the GIL, once */
static int need_model(core_scene *self)
{
    if (self->model != NULL)
        return 0;
    if (self->is_busy) {
        PyErr_SetString(
            PyExc_RuntimeError,
            "another thread is building the model of this scene. call Scene.prepare() before starting threads");
        return -1;
    }
    pel_error error;
    pel_status status;
    pel_model *model = NULL;
    self->is_busy = 1;
    Py_BEGIN_ALLOW_THREADS status = pel_model_create(&self->scene->model, &model, &error);
    Py_END_ALLOW_THREADS self->is_busy = 0;
    if (status != PEL_OK) {
        pel_scene_locate(self->scene, &error);
        core_raise(&error);
        return -1;
    }
    self->model = model;
    return 0;
}

static PyObject *scene_text(core_scene *self, PyObject *unused)
{
    (void)unused;
    return PyUnicode_FromString(pel_scene_text(self->scene));
}

/* properties of the scene, as a dict */
static PyObject *scene_info(core_scene *self, PyObject *unused)
{
    (void)unused;
    const pel_scene *scene = self->scene;
    PyObject *bodies = PyTuple_New(scene->model.body_count);
    for (int32_t b = 0; bodies != NULL && b < scene->model.body_count; b++) {
        PyObject *name = PyUnicode_FromString(scene->model.bodies[b].name);
        if (name == NULL || PyTuple_SetItem(bodies, b, name) < 0)
            Py_CLEAR(bodies);
    }
    PyObject *loads = PyTuple_New(scene->sim.load_count);
    for (int32_t l = 0; loads != NULL && l < scene->sim.load_count; l++) {
        const char *name = scene->sim.loads[l].name;
        PyObject *text = PyUnicode_FromString(name != NULL ? name : "");
        if (text == NULL || PyTuple_SetItem(loads, l, text) < 0)
            Py_CLEAR(loads);
    }
    return Py_BuildValue("{s:s,s:N,s:N,s:d,s:d,s:O}", "title", scene->title, "bodies", bodies, "loads", loads,
                         "duration", scene->duration, "dt", scene->sim.solver.dt, "is_static",
                         scene->sim.solver.method == PEL_METHOD_STATIC ? Py_True : Py_False);
}

/* builds the model now, before threads share it */
static PyObject *scene_prepare(core_scene *self, PyObject *unused)
{
    (void)unused;
    return need_model(self) < 0 ? NULL : Py_NewRef(Py_None);
}

/* dict of the bodies of a model: name -> number */
static PyObject *body_names(const pel_model *model)
{
    PyObject *names = PyDict_New();
    for (int32_t b = 0; names != NULL && b < pel_model_body_count(model); b++) {
        PyObject *number = PyLong_FromLong(b);
        if (number == NULL || PyDict_SetItemString(names, pel_model_body_name(model, b), number) < 0)
            Py_CLEAR(names);
        Py_XDECREF(number);
    }
    return names;
}

/* simulation(scene of the def, threads, whether contacts are recorded): of this scene's model, with the solver, loads
 * and tools of the other */
static PyObject *scene_simulation(core_scene *self, PyObject *arguments)
{
    core_scene *other;
    int threads, records;
    if (!PyArg_ParseTuple(arguments, "O!ip:simulation", core_scene_type, &other, &threads, &records) ||
        need_model(self) < 0)
        return NULL;
    core_sim *made = (core_sim *)PyType_GenericNew(core_sim_type, arguments, NULL);
    if (made == NULL)
        return NULL;
    made->owner = (core_scene *)Py_NewRef((PyObject *)self);
    made->names = body_names(self->model);
    if (made->names == NULL) {
        Py_DECREF((PyObject *)made);
        return NULL;
    }
    pel_sim_def def = other->scene->sim;
    made->load_count = def.load_count;
    def.model = self->model;
    made->records = records;
    def.record_contacts = records != 0;
    if (threads > 0)
        def.thread_count = threads;
    def.wanted = core_is_wanted;
    def.user = &made->next_look;
    pel_error error;
    pel_status status;
    Py_INCREF((PyObject *)other);
    Py_BEGIN_ALLOW_THREADS status = pel_sim_create(&def, &made->sim, &error);
    Py_END_ALLOW_THREADS if (status != PEL_OK) pel_scene_locate(other->scene, &error);
    Py_DECREF((PyObject *)other);
    if (status == PEL_OK)
        return (PyObject *)made;
    Py_DECREF((PyObject *)made);
    return core_raise(&error);
}

static PyMethodDef scene_methods[] = {
    {"text", (PyCFunction)scene_text, METH_NOARGS, NULL},
    {"info", (PyCFunction)scene_info, METH_NOARGS, NULL},
    {"prepare", (PyCFunction)scene_prepare, METH_NOARGS, NULL},
    {"simulation", (PyCFunction)scene_simulation, METH_VARARGS, NULL},
    {NULL, NULL, 0, NULL},
};
static PyType_Slot scene_slots[] = {
    {Py_tp_new, (void *)scene_new},
    {Py_tp_dealloc, (void *)scene_free},
    {Py_tp_methods, scene_methods},
    {0, NULL},
};
PyType_Spec core_scene_spec = {"pellicle._core.Scene", sizeof(core_scene), 0, Py_TPFLAGS_DEFAULT, scene_slots};

/* ---- whole runs ---- */

/* run(scene, folder, frames, threads, resume, overwrite) */
static PyObject *run(PyObject *module, PyObject *arguments)
{
    (void)module;
    core_scene *scene;
    const char *folder, *resume;
    long long frames;
    int threads, overwrite;
    if (!PyArg_ParseTuple(arguments, "O!sLizp:run", core_scene_type, &scene, &folder, &frames, &threads, &resume,
                          &overwrite))
        return NULL;
    pel_run_def def = pel_run_def_default();
    double next_look = 0;
    def.folder = folder;
    def.max_frames = frames;
    def.thread_count = threads;
    def.resume = resume;
    def.overwrite = overwrite != 0;
    def.wanted = core_is_wanted;
    def.user = &next_look;
    /* large: not on the stack of a thread */
    pel_run_summary *summary = PyMem_Calloc(1, sizeof *summary);
    if (summary == NULL)
        return PyErr_NoMemory();
    pel_error error;
    pel_status status;
    Py_INCREF((PyObject *)scene);
    Py_BEGIN_ALLOW_THREADS status = pel_run(scene->scene, &def, summary, &error);
    Py_END_ALLOW_THREADS Py_DECREF((PyObject *)scene);
    PyMem_Free(summary);
    if (PyErr_Occurred())
        return NULL;
    return status == PEL_OK ? Py_NewRef(Py_None) : core_raise(&error);
}

/* take_folder(folder, overwrite) */
static PyObject *take_folder(PyObject *module, PyObject *arguments)
{
    (void)module;
    const char *folder;
    int overwrite;
    pel_error error;
    if (!PyArg_ParseTuple(arguments, "sp:take_folder", &folder, &overwrite))
        return NULL;
    return pel_run_take_folder(folder, overwrite != 0, NULL, &error) == PEL_OK ? Py_NewRef(Py_None)
                                                                               : core_raise(&error);
}

/* results of runs that are stepped together */
typedef struct series_work {
    PyObject *runs; /* list of (lines, positions): the run, then those beside it */
    int failed;     /* an exception is set */
} series_work;

static PyObject *part_of_run(series_work *work, int32_t scene, int part)
{
    return PyTuple_GetItem(PyList_GetItem(work->runs, scene + 1), part);
}

static void collect_row_of(void *user, int32_t scene, const char *line)
{
    series_work *work = user;
    PyGILState_STATE state = PyGILState_Ensure();
    PyObject *text = work->failed ? NULL : PyUnicode_FromString(line);
    if (text == NULL || PyList_Append(part_of_run(work, scene, 0), text) < 0)
        work->failed = 1;
    Py_XDECREF(text);
    PyGILState_Release(state);
}

static void collect_row(void *user, const char *line)
{
    collect_row_of(user, -1, line);
}

static int append_positions(PyObject *list, pel_sim *sim, int32_t body)
{
    Py_buffer view;
    PyObject *array = core_new_array('d', pel_sim_vertex_count(sim, body), 3);
    if (array == NULL || core_get_array(array, "positions", 'd', -1, 1, &view) < 0) {
        Py_XDECREF(array);
        return -1;
    }
    pel_sim_get_positions(sim, body, view.buf);
    PyBuffer_Release(&view);
    int result = PyList_Append(list, array);
    Py_DECREF(array);
    return result;
}

static void collect_positions(void *user, int32_t scene, pel_sim *sim)
{
    series_work *work = user;
    PyGILState_STATE state = PyGILState_Ensure();
    int32_t count = pel_model_body_count(pel_sim_model(sim));
    for (int32_t b = 0; !work->failed && b < count; b++)
        work->failed = append_positions(part_of_run(work, scene, 1), sim, b) < 0;
    PyGILState_Release(state);
}

static PyObject *empty_runs(Py_ssize_t count)
{
    PyObject *runs = PyList_New(0);
    for (Py_ssize_t i = 0; runs != NULL && i < count; i++) {
        PyObject *parts = Py_BuildValue("([][])");
        if (parts == NULL || PyList_Append(runs, parts) < 0)
            Py_CLEAR(runs);
        Py_XDECREF(parts);
    }
    return runs;
}

/* series(scene, beside): a run that leaves no files, with one thread, and those of a tuple of scenes beside it; a list
   with (the lines of the series, the positions of the bodies at the end) of each */
static PyObject *series(PyObject *module, PyObject *arguments)
{
    (void)module;
    core_scene *scene;
    PyObject *scenes;
    if (!PyArg_ParseTuple(arguments, "O!O!:series", core_scene_type, &scene, &PyTuple_Type, &scenes))
        return NULL;
    const Py_ssize_t count = PyTuple_Size(scenes);
    series_work work = {.runs = empty_runs(count + 1)};
    const pel_scene **beside = PyMem_Calloc((size_t)count + 1, sizeof *beside);
    pel_run_summary *summary = PyMem_Calloc(1, sizeof *summary);
    pel_status status = PEL_OUT_OF_MEMORY;
    pel_error error;
    if (work.runs == NULL || beside == NULL || summary == NULL)
        PyErr_NoMemory();
    for (Py_ssize_t i = 0; !PyErr_Occurred() && i < count; i++) {
        PyObject *other = PyTuple_GetItem(scenes, i);
        if (!PyObject_TypeCheck(other, core_scene_type))
            PyErr_SetString(PyExc_TypeError, "beside: a tuple of Scenes is needed");
        else
            beside[i] = ((core_scene *)other)->scene;
    }
    if (!PyErr_Occurred()) {
        const pel_run_beside others = {.scenes = beside, .count = (int32_t)count, .row = collect_row_of, .user = &work};
        pel_run_def def = pel_run_def_default();
        def.thread_count = 1;
        def.row = collect_row;
        def.ended = collect_positions;
        def.user = &work;
        def.beside = count > 0 ? &others : NULL;
        Py_INCREF(arguments);
        Py_BEGIN_ALLOW_THREADS status = pel_run(scene->scene, &def, summary, &error);
        Py_END_ALLOW_THREADS Py_DECREF(arguments);
        if (status != PEL_OK && !PyErr_Occurred())
            core_raise(&error);
    }
    PyMem_Free(summary);
    PyMem_Free(beside);
    if (status == PEL_OK && !work.failed)
        return work.runs;
    Py_XDECREF(work.runs);
    return NULL;
}

/* write_report(path, page, folders, fields) */
static PyObject *write_report(PyObject *module, PyObject *arguments)
{
    (void)module;
    const char *path, *page;
    PyObject *folders, *fields;
    pel_report_def def = pel_report_def_default();
    if (!PyArg_ParseTuple(arguments, "ssO!O!:write_report", &path, &page, &PyTuple_Type, &folders, &PyTuple_Type,
                          &fields))
        return NULL;
    const char **folder_texts = texts_of(folders, &def.folder_count);
    const char **field_texts = folder_texts != NULL ? texts_of(fields, &def.field_count) : NULL;
    if (field_texts == NULL) {
        PyMem_Free(folder_texts);
        return NULL;
    }
    def.page = page;
    def.folders = folder_texts;
    def.fields = def.field_count > 0 ? field_texts : NULL;
    pel_error error;
    pel_status status;
    Py_BEGIN_ALLOW_THREADS status = pel_report_write(path, &def, NULL, &error);
    Py_END_ALLOW_THREADS PyMem_Free(folder_texts);
    PyMem_Free(field_texts);
    return status == PEL_OK ? Py_NewRef(Py_None) : core_raise(&error);
}

PyMethodDef core_run_methods[] = {
    {"run", run, METH_VARARGS, NULL},
    {"take_folder", take_folder, METH_VARARGS, NULL},
    {"series", series, METH_VARARGS, NULL},
    {"write_report", write_report, METH_VARARGS, NULL},
    {NULL, NULL, 0, NULL},
};
