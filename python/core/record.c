#include "core.h"

static PyObject *number(const char *at, core_kind kind, int i)
{
    switch (kind) {
    case CORE_DOUBLE:
        return PyFloat_FromDouble(((const double *)(const void *)at)[i]);
    case CORE_INT32:
        return PyLong_FromLong(((const int32_t *)(const void *)at)[i]);
    case CORE_INT64:
        return PyLong_FromLongLong(((const int64_t *)(const void *)at)[i]);
    default:
        return PyBool_FromLong(((const bool *)(const void *)at)[i]);
    }
}

static PyObject *value_of(const char *at, const core_member *member)
{
    if (member->count == 1)
        return number(at, member->kind, 0);
    PyObject *tuple = PyTuple_New(member->count);
    for (int i = 0; tuple != NULL && i < member->count; i++) {
        PyObject *item = number(at, member->kind, i);
        /* takes over the reference of the item, also on failure */
        if (item == NULL || PyTuple_SetItem(tuple, i, item) < 0)
            Py_CLEAR(tuple);
    }
    return tuple;
}

PyObject *core_record(const void *record, const core_member *members, size_t count)
{
    PyObject *dict = PyDict_New();
    for (size_t m = 0; dict != NULL && m < count; m++) {
        PyObject *value = value_of((const char *)record + members[m].offset, &members[m]);
        if (value == NULL || PyDict_SetItemString(dict, members[m].name, value) < 0)
            Py_CLEAR(dict);
        Py_XDECREF(value);
    }
    return dict;
}
