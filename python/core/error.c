#include "core.h"

PyObject *core_error;

PyObject *core_make_error_class(void)
{
    return PyErr_NewExceptionWithDoc(
        "pellicle.Error",
        "A refused input or a failed operation.\n\n"
        "The text is ``file:line:column: error: what. remedy``.\n\n"
        "Attributes\n----------\n"
        "status : str\n    Kind of failure, such as ``\"bad scene\"`` or ``\"diverged\"``.\n"
        "what : str\n    The problem.\n"
        "remedy : str or None\n    What to do about it.\n"
        "file : str or None\n    The file that contains the problem.\n"
        "line, column : int or None\n    Place in this file, from 1.\n"
        "element_kind : str or None\n    Kind of the element with the problem, such as ``\"vertex\"``.\n"
        "element_name : str or None\n    Name of this element in the scene.\n"
        "element : int or None\n    Number of this element, from 0.\n",
        PyExc_RuntimeError, NULL);
}

/* sets an attribute and releases the value; if the value is null, an exception is already set: returns -1 */
static int set(PyObject *exception, const char *name, PyObject *value)
{
    int result = value == NULL ? -1 : PyObject_SetAttrString(exception, name, value);
    Py_XDECREF(value);
    return result;
}

static PyObject *text_or_none(const char *text)
{
    if (text[0] == '\0')
        return Py_NewRef(Py_None);
    return PyUnicode_DecodeUTF8(text, (Py_ssize_t)strlen(text), "replace");
}

static PyObject *number_or_none(int64_t number, int64_t none)
{
    return number == none ? Py_NewRef(Py_None) : PyLong_FromLongLong(number);
}

static int fill(PyObject *exception, const pel_error *e)
{
    return set(exception, "status", text_or_none(pel_status_text(e->status))) < 0 ||
                   set(exception, "what", text_or_none(e->what)) < 0 ||
                   set(exception, "remedy", text_or_none(e->remedy)) < 0 ||
                   set(exception, "file", text_or_none(e->file)) < 0 ||
                   set(exception, "line", number_or_none(e->line, 0)) < 0 ||
                   set(exception, "column", number_or_none(e->column, 0)) < 0 ||
                   set(exception, "element_kind", text_or_none(e->element_kind)) < 0 ||
                   set(exception, "element_name", text_or_none(e->element_name)) < 0 ||
                   set(exception, "element", number_or_none(e->element, -1)) < 0
               ? -1
               : 0;
}

PyObject *core_raise(const pel_error *error)
{
    char text[1400];
    if (error->status == PEL_OUT_OF_MEMORY)
        return PyErr_NoMemory();
    pel_error_text(error, text, sizeof text);
    PyObject *message = text_or_none(text);
    PyObject *exception = message != NULL ? PyObject_CallFunctionObjArgs(core_error, message, NULL) : NULL;
    Py_XDECREF(message);
    if (exception != NULL && fill(exception, error) == 0)
        PyErr_SetObject(core_error, exception);
    Py_XDECREF(exception);
    return NULL;
}
