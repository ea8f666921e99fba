/* glTF 2.0 (Khronos) as .gltf or .glb: the surfaces of its scene, placed by nodes and bones, and its animations.

   gltf.c            the scene's meshes: primitives, morph targets, triangles
   gltf_nodes.c      the tree of nodes and where they stand
   gltf_animation.c  nodes and weights of targets over time
   gltf_skin.c       vertices that bones move
   gltf_buffer.c     the file: chunks, buffers inside it and beside it, extensions
   gltf_numbers.c    accessors: numbers of all types, strides, normalised, sparse */
#ifndef PEL_FOREIGN_GLTF_H
#define PEL_FOREIGN_GLTF_H

#include "foreign/json_tree.h"
#include "foreign/place.h"
#include "pellicle/mesh.h"
#include "pellicle/sequence.h"

/* the lists of a file whose elements others name by their number */
typedef enum pel_gltf_list {
    PEL_GLTF_SCENES,
    PEL_GLTF_NODES,
    PEL_GLTF_MESHES,
    PEL_GLTF_ACCESSORS,
    PEL_GLTF_VIEWS,
    PEL_GLTF_BUFFERS,
    PEL_GLTF_ANIMATIONS,
    PEL_GLTF_SKINS,
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
/* Numbers (count x width; free them) of an accessor with that width: 1 to 4, or 16 for matrices. Finite. */
pel_status pel_gltf_numbers(pel_gltf *g, const pel_json_node *accessor, int32_t width, double **numbers, size_t *count,
                            pel_error *error);
/* Whole numbers from 0 (count; free them). */
pel_status pel_gltf_indices(pel_gltf *g, const pel_json_node *accessor, double **indices, size_t *count,
                            pel_error *error);

/* ---- nodes ---- */

typedef struct pel_gltf_node {
    const pel_json_node *node;
    int32_t parent; /* -1 = a root */
    bool is_in_scene;
    bool has_matrix;              /* `matrix` instead of the three parts */
    double translation[3];        /* of the file, then of an animation */
    double rotation[4], scale[3]; /* quaternion x, y, z, w of any length */
    pel_place matrix;             /* in the parent */
    pel_place world;              /* of pel_gltf_nodes_place */
    const double *weights;        /* (weight_count) of targets, of an animation; null = those of the file */
    int32_t weight_count;
} pel_gltf_node;

typedef struct pel_gltf_nodes {
    pel_gltf_node *nodes; /* (counts of nodes) */
    int32_t *order;       /* (order_count) nodes of the scene, parents before children */
    int32_t order_count;
    bool has_scene; /* without scenes all meshes are taken, where they are */
} pel_gltf_nodes;

/* The nodes of the scene. PEL_BAD_FORMAT, PEL_OUT_OF_MEMORY; free in any case. */
pel_status pel_gltf_nodes_read(pel_gltf *g, pel_gltf_nodes *nodes, pel_error *error);
void pel_gltf_nodes_free(pel_gltf_nodes *nodes);
/* Where all nodes of the scene stand in the world; PEL_BAD_FORMAT for a rotation without length. */
pel_status pel_gltf_nodes_place(const pel_gltf *g, pel_gltf_nodes *nodes, pel_error *error);

/* ---- animations ---- */

typedef struct pel_gltf_channel pel_gltf_channel;

typedef struct pel_gltf_animation {
    pel_gltf_channel *channels; /* (channel_count) */
    size_t channel_count, channel_capacity;
    double duration; /* s, of the last key */
} pel_gltf_animation;

/* The animation of a name, or with a null name all together. PEL_BAD_FORMAT: there is none, none of this name, several
   that move the same nodes, or it is damaged. PEL_OUT_OF_MEMORY. Free in any case; the nodes keep pointers to its
   weights. */
pel_status pel_gltf_animation_read(pel_gltf *g, const pel_gltf_nodes *nodes, const char *name,
                                   pel_gltf_animation *animation, pel_error *error);
void pel_gltf_animation_free(pel_gltf_animation *animation);
/* Moves the nodes to a time [s]; place them afterwards. */
void pel_gltf_animation_pose(pel_gltf_animation *animation, double time, pel_gltf_nodes *nodes);

/* ---- skins ---- */

typedef struct pel_gltf_skin {
    int32_t *joints;     /* (joint_count) nodes */
    pel_place *inverses; /* (joint_count) of the bones at rest */
    pel_place *bones;    /* (joint_count) from rest to the world, of pel_gltf_skin_pose */
    int32_t joint_count;
} pel_gltf_skin;

/* Free in any case. PEL_BAD_FORMAT, PEL_OUT_OF_MEMORY. */
pel_status pel_gltf_skin_read(pel_gltf *g, const pel_gltf_nodes *nodes, const pel_json_node *skin, pel_gltf_skin *made,
                              pel_error *error);
void pel_gltf_skin_free(pel_gltf_skin *skin);
void pel_gltf_skin_pose(pel_gltf_skin *skin, const pel_gltf_nodes *nodes);

/* The bones of each vertex and their weights: `sets` of four for each of `count` vertices. */
typedef struct pel_gltf_influences {
    double *joints, *weights; /* (sets x count x 4) one set after the other; weights of a vertex have the sum 1 */
    int32_t sets;
} pel_gltf_influences;

/* JOINTS_n and WEIGHTS_n of a primitive's attributes; sets = 0 without. Free in any case. */
pel_status pel_gltf_influences_read(pel_gltf *g, const pel_json_node *attributes, size_t count, int32_t joint_count,
                                    pel_gltf_influences *influences, pel_error *error);
void pel_gltf_influences_free(pel_gltf_influences *influences);
/* the place of a point of vertex v as its bones move it (linear blend skinning, glTF 2.0 section 3.7.3) */
void pel_gltf_skin_point(const pel_gltf_skin *skin, const pel_gltf_influences *influences, size_t count, size_t v,
                         const double point[3], double placed[3]);

/* ---- files ---- */

/* A mesh from a file of these bytes, or from the file at path with bytes null. */
pel_status pel_gltf_read(const char *path, const pel_log *log, pel_mesh **mesh, pel_error *error);
pel_status pel_gltf_parse(const char *name, const void *bytes, size_t size, const pel_log *log, pel_mesh **mesh,
                          pel_error *error);
/* The vertices of that mesh over an animation (null = all), `fps` frames a second and one at its end. */
pel_status pel_gltf_read_sequence(const char *path, const char *animation, double fps, pel_sequence **sequence,
                                  pel_error *error);
pel_status pel_gltf_parse_sequence(const char *name, const void *bytes, size_t size, const char *animation, double fps,
                                   pel_sequence **sequence, pel_error *error);
/* whether a path ends in .gltf or .glb */
bool pel_gltf_is(const char *path);

#endif
