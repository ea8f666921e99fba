/* Pellicle: status codes, errors and basic types that every other header uses.
   SI units unless stated otherwise. Nothing here keeps state; any thread may call all functions. */
#ifndef PELLICLE_BASE_H
#define PELLICLE_BASE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define PEL_VERSION_MAJOR 0
#define PEL_VERSION_MINOR 2
#define PEL_VERSION_PATCH 0
#define PEL_VERSION "0.2.0"

/* On every public function. The shared library exports these and nothing else. */
#ifndef PEL_API
#if defined(__GNUC__)
#define PEL_API __attribute__((visibility("default")))
#else
#define PEL_API
#endif
#endif

/* Scalar of the simulated state: double, or float when the library was built with PEL_SINGLE (preset `single`). */
#ifdef PEL_SINGLE
typedef float pel_real;
#else
typedef double pel_real;
#endif

/* Longest name of a field, body, load or tool, terminating zero included. */
#define PEL_NAME_SIZE 64

/* Result of a function that can fail. PEL_OK is 0; every other value is a failure. */
typedef enum pel_status {
    PEL_OK = 0,
    PEL_OUT_OF_MEMORY, /* an allocation failed */
    PEL_BAD_ARGUMENT,  /* an argument or a member of a def is missing, NaN, infinite or out of range */
    PEL_BAD_FILE,      /* a file cannot be opened, read or written (the message has the reason of the system) */
    PEL_BAD_FORMAT,    /* the content of a file violates its format */
    PEL_BAD_MESH,      /* a mesh has a topology or geometry that cannot be simulated */
    PEL_BAD_SCENE,     /* a scene file has an unknown key, a wrong type or a value out of range */
    PEL_UNSTABLE,      /* a parameter exceeds the stability limit of this mesh */
    PEL_DIVERGED,      /* the state became NaN, infinite or extremely large during a step */
    PEL_STOPPED,       /* a callback requested the stop, for example after Ctrl-C */
    PEL_STATUS_COUNT
} pel_status;

/* PEL_VERSION of the library in use, which may be newer than the header. Never null; lives forever. */
PEL_API const char *pel_version(void);

/* Instruction set that the library uses on this machine: "avx2" or "baseline". The results do not depend on it. A
   library built without PELLICLE_NATIVE contains both; the environment variable PELLICLE_KERNELS=baseline, set before
   the program starts, selects the second. Lives forever. */
PEL_API const char *pel_kernels(void);

/* Short English name of a status, such as "out of memory". Never null; lives forever. */
PEL_API const char *pel_status_text(pel_status status);

/* Details of a failure. Every function that takes a `pel_error *` accepts null; on success it does not change the
   error. Members that do not apply are zero or empty; `element` and `byte_offset` are -1 then. */
typedef struct pel_error {
    pel_status status;
    char file[256];                   /* the file that contains the problem */
    int32_t line, column;             /* place in that file, from 1 */
    int64_t byte_offset;              /* place in a binary file, from 0; -1 = does not apply */
    char element_kind[24];            /* "vertex", "triangle", "edge", "tool", ... */
    int64_t element;                  /* its number, from 0; -1 = does not apply */
    char element_name[PEL_NAME_SIZE]; /* its name in the scene, which replaces the number in the text */
    char what[320];                   /* the problem, one sentence without a full stop */
    char remedy[320];                 /* what to do about it, one sentence without a full stop */
} pel_error;

/* Writes "file:line:column: error: what. remedy" to text (size bytes, always terminated when size > 0).
   Returns text. */
PEL_API const char *pel_error_text(const pel_error *error, char *text, size_t size);

/* The name (of count) with the smallest edit distance to `name`, or the first of several such names; case is ignored,
   and '-' equals '_'. If all differ by more than two letters and a third of the letters: the first with `name` between
   hyphens (geodesic-sphere for sphere), else null. For remedies such as "did you mean ...?". */
PEL_API const char *pel_nearest_name(const char *name, const char *const *names, size_t count);

/* Seconds of a monotonic clock, from any origin: only differences mean something. Setting the time of the system does
   not change it. */
PEL_API double pel_seconds(void);

/* Processor time of the calling thread in seconds, likewise: other load on the machine counts less. */
PEL_API double pel_thread_seconds(void);

/* Receiver of notes and warnings (a quad was triangulated, vertices were welded). Null log or null write: none. */
typedef struct pel_log {
    void (*write)(void *user, const char *text); /* one line without newline */
    void *user;
} pel_log;

#ifdef __cplusplus
}
#endif
#endif
