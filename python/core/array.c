#include "core.h"

/* whether the elements of a view are native numbers of this type, by their format of the module struct */
static int has_type(const Py_buffer *view, char type)
{
    const char *format = view->format != NULL ? view->format : "B";
    if (*format == '@' || *format == '=' || *format == '<')
        format++;
    if (format[0] == '\0' || format[1] != '\0')
        return 0;
    if (type == 'd')
        return *format == 'd' && view->itemsize == sizeof(double);
    return (*format == 'i' || *format == 'l') && view->itemsize == sizeof(int32_t);
}

int core_get_array(PyObject *object, const char *name, char type, Py_ssize_t count, int is_written, Py_buffer *view)
{
    if (!PyObject_CheckBuffer(object)) {
        PyErr_Format(PyExc_TypeError, "%s: must be an array", name);
        return -1;
    }
    if (PyObject_GetBuffer(object, view, PyBUF_STRIDES | PyBUF_FORMAT) < 0) {
        PyErr_Format(PyExc_ValueError, "%s: the memory of this array cannot be accessed. pass a numpy array", name);
        return -1;
    }
    Py_ssize_t numbers = view->itemsize > 0 ? view->len / view->itemsize : 0;
    if (!has_type(view, type))
        PyErr_Format(PyExc_TypeError, "%s: must be an array of %s", name, type == 'd' ? "float64" : "int32");
    else if (is_written && view->readonly)
        PyErr_Format(PyExc_ValueError, "%s: the array is read-only. pass a writable array", name);
    else if (!PyBuffer_IsContiguous(view, 'C'))
        PyErr_Format(PyExc_ValueError, "%s: the array is not C-contiguous. pass a contiguous copy", name);
    else if (count >= 0 && numbers != count)
        PyErr_Format(PyExc_ValueError, "%s: must have %zd numbers, not %zd", name, count, numbers);
    else
        return 0;
    PyBuffer_Release(view);
    return -1;
}

int core_check_shape(const Py_buffer *view, const char *name, Py_ssize_t rows, Py_ssize_t columns)
{
    int dimensions = columns == 1 ? 1 : 2;
    if (view->ndim == dimensions && view->shape[0] == rows && (columns == 1 || view->shape[1] == columns))
        return 0;
    if (columns == 1)
        PyErr_Format(PyExc_ValueError, "%s: must have the shape (%zd,)", name, rows);
    else
        PyErr_Format(PyExc_ValueError, "%s: must have the shape (%zd, %zd)", name, rows, columns);
    return -1;
}

/* numpy.empty and the types of elements */
static PyObject *empty, *float64, *int32;

int core_import_numpy(void)
{
    PyObject *numpy = PyImport_ImportModule("numpy");
    if (numpy == NULL)
        return -1;
    empty = PyObject_GetAttrString(numpy, "empty");
    float64 = PyObject_CallMethod(numpy, "dtype", "s", "float64");
    int32 = PyObject_CallMethod(numpy, "dtype", "s", "int32");
    Py_DECREF(numpy);
    return empty != NULL && float64 != NULL && int32 != NULL ? 0 : -1;
}

PyObject *core_new_array(char type, Py_ssize_t rows, Py_ssize_t columns)
{
    PyObject *shape = columns == 1 ? PyLong_FromSsize_t(rows) : Py_BuildValue("nn", rows, columns);
    if (shape == NULL)
        return NULL;
    PyObject *array = PyObject_CallFunctionObjArgs(empty, shape, type == 'd' ? float64 : int32, NULL);
    Py_DECREF(shape);
    return array;
}

int core_check_count(const char *name, Py_ssize_t given, Py_ssize_t wanted)
{
    if (given == wanted)
        return 0;
    PyErr_Format(PyExc_TypeError, "%s takes %zd arguments, not %zd", name, wanted, given);
    return -1;
}

int core_get_index(PyObject *object, const char *name, int64_t least, int64_t most, int32_t *index)
{
    PyObject *number = PyNumber_Index(object);
    if (number == NULL) {
        PyErr_Format(PyExc_TypeError, "%s: must be an integer", name);
        return -1;
    }
    int overflow = 0;
    int64_t value = PyLong_AsLongLongAndOverflow(number, &overflow);
    Py_DECREF(number);
    if (overflow != 0 || value < least || value > most) {
        PyErr_Format(PyExc_ValueError, "%s: must be within %lld .. %lld", name, (long long)least, (long long)most);
        return -1;
    }
    *index = (int32_t)value;
    return 0;
}

PyObject *core_new_bytes(size_t size, void **bytes)
{
    PyObject *made = size > PY_SSIZE_T_MAX ? PyErr_NoMemory() : PyByteArray_FromStringAndSize(NULL, (Py_ssize_t)size);
    *bytes = made != NULL ? PyByteArray_AsString(made) : NULL;
    if (made != NULL)
        memset(*bytes, 0, size);
    return made;
}
