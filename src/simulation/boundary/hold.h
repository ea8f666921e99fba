/* Supports of single components: vertices held along axes, springs along axes, edges that keep their normals. For the
   methods whose stepper turns edges; the others refuse them. */
#ifndef PEL_BOUNDARY_HOLD_H
#define PEL_BOUNDARY_HOLD_H

#include "newton/newton.h"
#include "stage/stage.h"
#include "stage/transfer.h"

typedef struct pel_hold {
    char name[PEL_NAME_SIZE];
    int32_t body;
    bool fixes_rotation;
    double axes[3][3], value[3];
    pel_key *keys;
    int32_t key_count;
    pel_support_reading part, reading; /* of the last part of a step, and the mean of the last step */
    /* after the last step that the ledger has booked: N, m along the axes */
    double booked_force[3], booked_way[3];
} pel_hold;

/* A vertex that is held along its first `count` axes. The direction of row i, an axis of support owner[i], is the sum
   of factor[i][j] axes[j] over j <= i. */
typedef struct pel_held_vertex {
    int32_t vertex, count;
    int32_t owner[3], component[3]; /* the support and its axis */
    double factor[3][3];
} pel_held_vertex;

/* an elastic support at one vertex along one axis */
typedef struct pel_hold_spring {
    int32_t vertex, owner, component;
    double stiffness; /* N/m */
} pel_hold_spring;

struct pel_holds {
    pel_hold *holds;
    int32_t hold_count;
    pel_held_vertex *held; /* (held_count) by rising vertex */
    int32_t held_count;
    int32_t *vertices;    /* (held_count) of them */
    double (*axes)[3][3]; /* (held_count) */
    pel_hold_spring *springs;
    int32_t spring_count;
    double booked_energy; /* J, of the springs, likewise */
    uint8_t *edge_fixed;  /* (edges of mid-edge bending) */
    int32_t *edge_owner;  /* (the same) support that fixes it */
};

/* Copies and checks the supports; sim->holds stays null without any. PEL_BAD_ARGUMENT, PEL_OUT_OF_MEMORY. */
pel_status pel_holds_create(pel_sim *sim, const pel_sim_def *def, pel_error *error);
void pel_holds_destroy(pel_sim *sim);

/* Refuses a body with supports that may still move as a whole, where nothing touches it (statics). */
pel_status pel_holds_check_mechanism(const pel_sim *sim, int32_t body, pel_error *error);

bool pel_holds_has_body(const pel_sim *sim, int32_t body);
/* a support has a displacement */
bool pel_holds_move(const pel_sim *sim);

/* Flags and targets of held unknowns at a time; their frames. The arrays live as long as the sim. */
pel_newton_frames pel_holds_fix(const pel_sim *sim, double time, uint8_t *fixed, double *target);
/* Energy [J] of elastic supports; adds the gradient, or the blocks of the matrix. */
double pel_holds_evaluate(const pel_sim *sim, double time, const double *unknowns, double *gradient);
void pel_holds_add_matrix(const pel_sim *sim, pel_matrix *matrix);

/* Readings from the gradient after a step, with positions at its end. */
void pel_holds_read(pel_sim *sim, double time);
/* Work [J] of all supports on the bodies in a step that ends at a time, with readings and positions at its end. The
   energy stored in elastic supports is work of the bodies. */
double pel_holds_work(pel_sim *sim, double time);
/* a pel_transfer_part: their readings */
void pel_holds_transfer(pel_cursor *at, const pel_sim *sim, int32_t unused);
/* adds the readings of a body's supports */
void pel_holds_add_readings(const pel_sim *sim, int32_t body, pel_support_reading *sum);

#endif
