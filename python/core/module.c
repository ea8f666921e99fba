#include "core.h"

static PyObject *version(PyObject *module, PyObject *unused)
{
    (void)module;
    (void)unused;
    return PyUnicode_FromString(pel_version());
}

static PyObject *kernels(PyObject *module, PyObject *unused)
{
    (void)module;
    (void)unused;
    return PyUnicode_FromString(pel_kernels());
}

static PyMethodDef methods[] = {
    {"version", version, METH_NOARGS, NULL},
    {"kernels", kernels, METH_NOARGS, NULL},
    {NULL, NULL, 0, NULL},
};

static struct PyModuleDef definition = {
    .m_base = PyModuleDef_HEAD_INIT,
    .m_name = "pellicle._core",
    .m_doc = "Implementation of the package pellicle; not for direct use.",
    .m_size = -1,
    .m_methods = methods,
};

/* adds an object and takes over its reference */
static int add(PyObject *module, const char *name, PyObject *object)
{
    int result = object == NULL ? -1 : PyModule_AddObjectRef(module, name, object);
    Py_XDECREF(object);
    return result;
}

PyMODINIT_FUNC PyInit__core(void);
PyMODINIT_FUNC PyInit__core(void)
{
    PyObject *module = PyModule_Create(&definition);
    if (module == NULL)
        return NULL;
    core_error = core_make_error_class();
    core_scene_type = (PyTypeObject *)PyType_FromSpec(&core_scene_spec);
    core_sim_type = (PyTypeObject *)PyType_FromSpec(&core_sim_spec);
    core_drag_type = (PyTypeObject *)PyType_FromSpec(&core_drag_spec);
    core_study_type = (PyTypeObject *)PyType_FromSpec(&core_study_spec);
    core_store_type = (PyTypeObject *)PyType_FromSpec(&core_store_spec);
    if (core_import_numpy() < 0 || core_error == NULL || core_scene_type == NULL || core_sim_type == NULL ||
        core_drag_type == NULL || core_study_type == NULL || core_store_type == NULL ||
        PyModule_AddObjectRef(module, "Error", core_error) < 0 ||
        PyModule_AddObjectRef(module, "Scene", (PyObject *)core_scene_type) < 0 ||
        PyModule_AddObjectRef(module, "Sim", (PyObject *)core_sim_type) < 0 ||
        PyModule_AddObjectRef(module, "Study", (PyObject *)core_study_type) < 0 ||
        add(module, "ARRAYS", core_array_table()) < 0 || add(module, "FIELDS", core_field_table()) < 0 ||
        PyModule_AddFunctions(module, core_mesh_methods) < 0 || PyModule_AddFunctions(module, core_run_methods) < 0 ||
        PyModule_AddFunctions(module, core_study_methods) < 0)
        Py_CLEAR(module);
    return module;
}
