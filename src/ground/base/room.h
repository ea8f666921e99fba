/* Room for several arrays at once: all of them, or none.

       if (!PEL_ALLOCATE_ALL(PEL_ROOM(own->sizes, count), PEL_ROOM_ALIGNED(own->points, 3 * count)))
           return pel_fail_memory(error);
       ...
       PEL_FREE_ALL(own->sizes, own->points); */
#ifndef PEL_BASE_ROOM_H
#define PEL_BASE_ROOM_H

#include <stdbool.h>
#include <stddef.h>

typedef struct pel_room {
    void *pointer; /* the address of the pointer to an array */
    size_t count, size;
    bool is_aligned; /* to a cache line */
    bool is_left_out;
} pel_room;

#define PEL_ROOM(array, n) ((pel_room){&(array), (size_t)(n), sizeof *(array), false, false})
#define PEL_ROOM_ALIGNED(array, n) ((pel_room){&(array), (size_t)(n), sizeof *(array), true, false})
/* aligned elements of another size than the pointer says */
#define PEL_ROOM_OF(array, n, bytes) ((pel_room){&(array), (size_t)(n), (bytes), true, false})
/* an array that is only there if the condition holds, else null */
#define PEL_ROOM_IF(condition, array, n) ((pel_room){&(array), (size_t)(n), sizeof *(array), false, !(condition)})
#define PEL_ROOM_ALIGNED_IF(condition, array, n)                                                                       \
    ((pel_room){&(array), (size_t)(n), sizeof *(array), true, !(condition)})

/* Zeroed arrays; those left out are null. When out of memory all are null, and it returns false. */
bool pel_rooms_allocate(const pel_room *rooms, size_t room_count);
#define PEL_ALLOCATE_ALL(...)                                                                                          \
    pel_rooms_allocate((const pel_room[]){__VA_ARGS__}, sizeof((const pel_room[]){__VA_ARGS__}) / sizeof(pel_room))

/* null is fine */
void pel_free_arrays(void *const *arrays, size_t count);
#define PEL_FREE_ALL(...)                                                                                              \
    pel_free_arrays((void *const[]){__VA_ARGS__}, sizeof((void *const[]){__VA_ARGS__}) / sizeof(void *))

#endif
