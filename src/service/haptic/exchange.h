/* One writer hands its newest record to one reader without locks and without waiting: of three slots the writer owns
   one, the reader one, and the third changes owners through an atomic exchange. */
#ifndef PEL_HAPTIC_EXCHANGE_H
#define PEL_HAPTIC_EXCHANGE_H

#include <stdatomic.h>
#include <stdbool.h>

typedef struct pel_exchange {
    atomic_uint middle;      /* slot between the two, with PEL_EXCHANGE_FRESH where the reader has not seen it */
    unsigned writer, reader; /* slots */
} pel_exchange;

enum { PEL_EXCHANGE_SLOTS = 3, PEL_EXCHANGE_FRESH = 4 };

static inline void pel_exchange_create(pel_exchange *exchange)
{
    atomic_init(&exchange->middle, 1);
    exchange->writer = 0;
    exchange->reader = 2;
}

/* Publishes the complete record in slot `writer`. The next one is written to the new slot `writer`. */
static inline void pel_exchange_give(pel_exchange *exchange)
{
    unsigned old =
        atomic_exchange_explicit(&exchange->middle, exchange->writer | PEL_EXCHANGE_FRESH, memory_order_acq_rel);
    exchange->writer = old & 3;
}

/* True when there is a newer record, which is in slot `reader` then. */
static inline bool pel_exchange_take(pel_exchange *exchange)
{
    if ((atomic_load_explicit(&exchange->middle, memory_order_relaxed) & PEL_EXCHANGE_FRESH) == 0)
        return false;
    unsigned old = atomic_exchange_explicit(&exchange->middle, exchange->reader, memory_order_acq_rel);
    exchange->reader = old & 3;
    return true;
}

#endif
