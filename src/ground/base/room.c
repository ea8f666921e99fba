#include "base/room.h"

#include "base/memory.h"

#include <string.h>

/* pointers of all types have one form; copying it leaves their types alone */
static void set_pointer(const pel_room *room, void *array)
{
    memcpy(room->pointer, &array, sizeof array);
}

static void *allocate_room(const pel_room *room)
{
    return room->is_aligned ? pel_allocate_aligned(room->count, room->size) : pel_allocate(room->count, room->size);
}

static void free_room(const pel_room *room)
{
    void *array;
    memcpy(&array, room->pointer, sizeof array);
    pel_free(array);
    set_pointer(room, NULL);
}

bool pel_rooms_allocate(const pel_room *rooms, size_t room_count)
{
    for (size_t i = 0; i < room_count; i++)
        set_pointer(&rooms[i], NULL);
    for (size_t i = 0; i < room_count; i++) {
        if (rooms[i].is_left_out)
            continue;
        void *array = allocate_room(&rooms[i]);
        set_pointer(&rooms[i], array);
        if (array != NULL)
            continue;
        for (size_t made = 0; made < i; made++)
            free_room(&rooms[made]);
        return false;
    }
    return true;
}

void pel_free_arrays(void *const *arrays, size_t count)
{
    for (size_t i = 0; i < count; i++)
        pel_free(arrays[i]);
}
