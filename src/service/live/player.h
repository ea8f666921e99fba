/* The simulation thread: reads lines from the mailbox, steps in real time, posts frames for the pages. */
#ifndef PEL_LIVE_PLAYER_H
#define PEL_LIVE_PLAYER_H

#include "live/mailbox.h"
#include "pellicle/server.h"

typedef struct pel_player pel_player;

/* Creates model and simulation and posts the first messages. `box` outlives the player. */
pel_status pel_player_create(const pel_server_def *def, pel_mailbox *box, pel_player **player, pel_error *error);
void pel_player_destroy(pel_player *player);
/* Seconds until the player has something to do, if no line comes: at most 0.1; 0 or less = immediately. */
double pel_player_rest(const pel_player *player);
/* One turn: waits at most `rest` seconds for lines, executes them and the steps that are due, for at most the time of
   one picture, and posts messages. False when the mailbox has ended. */
bool pel_player_turn(pel_player *player, double rest);
/* Whether a line stops what the player does when it comes: those that undo it, or wait for its end. */
bool pel_player_interrupts(const char *line);
/* Takes turns until the mailbox ends; `player` is a pel_player. For pthread_create. */
void *pel_player_run(void *player);

#endif
