/* The thread that steps: takes lines from the mailbox, steps at the pace of the clock, posts what pages draw. */
#ifndef PEL_LIVE_PLAYER_H
#define PEL_LIVE_PLAYER_H

#include "live/mailbox.h"
#include "pellicle/server.h"

typedef struct pel_player pel_player;

/* Creates model and simulation and posts the first messages. `box` outlives the player. */
pel_status pel_player_create(const pel_server_def *def, pel_mailbox *box, pel_player **player, pel_error *error);
void pel_player_destroy(pel_player *player);
/* Until the mailbox ends; `player` is a pel_player. For pthread_create. */
void *pel_player_run(void *player);

#endif
