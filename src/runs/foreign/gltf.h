/* glTF 2.0 (Khronos) as .gltf or .glb: the surfaces of its scene, placed by its nodes.

   gltf.c          the scene: nodes, instances, meshes, morph targets
   gltf_buffer.c   the file: chunks, buffers inside it and beside it, extensions
   gltf_numbers.c  accessors: numbers of all types, strides, normalised, sparse */
#ifndef PEL_FOREIGN_GLTF_H
#define PEL_FOREIGN_GLTF_H

#include "foreign/json_tree.h"
#include "pellicle/mesh.h"

/* the lists of a file whose elements others name by their number */
typedef enum pel_gltf_list {
    PEL_GLTF_SCENES,
    PEL_GLTF_NODES,
    PEL_GLTF_MESHES,
    PEL_GLTF_ACCESSORS,
    PEL_GLTF_VIEWS,
    PEL_GLTF_BUFFERS,
    PEL_GLTF_LIST_COUNT
} pel_gltf_list;

typedef struct pel_gltf_buffer {
    const char *bytes;
    size_t size;
    char *owned; /* to be freed; null = part of the file */
} pel_gltf_buffer;

typedef struct pel_gltf {
    const char *path;
    const char *bytes; /* (size) the whole file */
    size_t size;
    bool is_alone; /* from memory: it has no folder with other files */
    pel_json_tree tree;
    const pel_json_node **lists[PEL_GLTF_LIST_COUNT]; /* (counts) the elements of each list */
    int32_t counts[PEL_GLTF_LIST_COUNT];
    const char *chunk; /* (chunk_size) the binary chunk of a .glb; null = none */
    size_t chunk_size;
    pel_gltf_buffer *buffers; /* (counts of buffers) */
    size_t work, most_work;   /* numbers taken, and how many may be: instances make many of few */
} pel_gltf;

/* The file's JSON, its lists and its buffers; refuses extensions that it requires and that we do not know. Free in any
   case. PEL_BAD_FORMAT, PEL_BAD_FILE (another file that it names), PEL_OUT_OF_MEMORY. */
pel_status pel_gltf_open(pel_gltf *g, pel_error *error);
void pel_gltf_free(pel_gltf *g);

/* PEL_BAD_FORMAT at a node of the tree, null = the file */
pel_status pel_gltf_fail(const pel_gltf *g, const pel_json_node *at, pel_error *error, const char *remedy,
                         const char *format, ...) PEL_PRINTF(5, 6);

/* The whole number of a member, or `otherwise` where it has none; PEL_BAD_FORMAT unless low <= number <= high. */
pel_status pel_gltf_integer(const pel_gltf *g, const pel_json_node *object, const char *key, int64_t otherwise,
                            int64_t low, int64_t high, int64_t *number, pel_error *error);
/* The element of a list that a member names by its number; null where it has no such member. PEL_BAD_FORMAT if there is
   no such element. */
pel_status pel_gltf_named(const pel_gltf *g, const pel_json_node *object, const char *key, pel_gltf_list list,
                          const pel_json_node **element, pel_error *error);
/* The numbers of an array, at most `most`; count = how many. PEL_BAD_FORMAT for something else than numbers. */
pel_status pel_gltf_list_numbers(const pel_gltf *g, const pel_json_node *array, double *numbers, int32_t most,
                                 int32_t *count, pel_error *error);

/* Counts work; PEL_BAD_FORMAT when it is too much for a file of this size. */
pel_status pel_gltf_work(pel_gltf *g, const pel_json_node *at, size_t amount, pel_error *error);

/* How many elements an accessor has. */
pel_status pel_gltf_count(pel_gltf *g, const pel_json_node *accessor, size_t *count, pel_error *error);
/* Numbers (count x width; free them) of an accessor with that width: 3 for positions. Finite. */
pel_status pel_gltf_numbers(pel_gltf *g, const pel_json_node *accessor, int32_t width, double **numbers, size_t *count,
                            pel_error *error);

/* A mesh from a file of these bytes, or from the file at path with bytes null. */
pel_status pel_gltf_read(const char *path, const pel_log *log, pel_mesh **mesh, pel_error *error);
pel_status pel_gltf_parse(const char *name, const void *bytes, size_t size, const pel_log *log, pel_mesh **mesh,
                          pel_error *error);
/* whether a path ends in .gltf or .glb */
bool pel_gltf_is(const char *path);

#endif
