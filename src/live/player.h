/* The thread that steps: takes lines from the mailbox, steps at the pace of the clock, posts what pages draw. */
#ifndef PEL_LIVE_PLAYER_H
#define PEL_LIVE_PLAYER_H

#include "live/mailbox.h"
#include "pellicle/server.h"

typedef struct pel_player pel_player;

/* Creates model and simulation and posts the first messages. `box` outlives the player. */
pel_status pel_player_create(const pel_server_def *def, pel_mailbox *box, pel_player **player, pel_error *error);
void pel_player_destroy(pel_player *player);
/* Seconds until the player has something to do, if no line comes: at most 0.1, 0 or less for at once. */
double pel_player_rest(const pel_player *player);
/* One turn: waits at most `rest` seconds for lines, does them and the steps that are due, for at most as long as a
   picture lasts, and posts what pages need. False when the mailbox has ended. */
bool pel_player_turn(pel_player *player, double rest);
/* Takes turns until the mailbox ends; `player` is a pel_player. For pthread_create. */
void *pel_player_run(void *player);

#endif
