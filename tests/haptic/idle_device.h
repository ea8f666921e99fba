/* A device that is never there. */
#ifndef PEL_TESTS_HAPTIC_IDLE_DEVICE_H
#define PEL_TESTS_HAPTIC_IDLE_DEVICE_H

#include <stdbool.h>

static inline bool read_nothing(void *user, double position[3], double rotation[4])
{
    (void)user;
    (void)position;
    (void)rotation;
    return false;
}

static inline void write_nothing(void *user, const double force[3])
{
    (void)user;
    (void)force;
}

#endif
