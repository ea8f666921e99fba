/* In addition to the commands of a session a page may send: play, pause, step, undo, reset, replay (from the start;
   steps repeat the interactions), field NAME (or none), save, open TEXT (a scene), contact (from the start with
   contact, which meshes press by), echo NUMBER (comes back with the next frame).

   The state is kept in a file while it changes, and a file that is there at the start is repeated, as fast as the
   machine can. Until then lines that change the simulation are refused, but undo, reset and open end the repetition.

   Each line and each step is a stage. Pause, undo, reset, open and contact stop the present stage once it has taken
   STAGE_SECONDS, and so does the end of the server: whatever was to change is then as it was before. */
#include "live/player.h"

#include "base/memory.h"
#include "base/patience.h"
#include "base/status.h"
#include "live/keep.h"
#include "live/message.h"
#include "math/extremes.h"
#include "pellicle/observe.h"
#include "pellicle/sim_surface.h"
#include "stage/stepper.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* s between pictures, between one and the next that answers a command, and between measures */
#define PICTURE_SECONDS (1.0 / 60)
#define ANSWER_SECONDS (1.0 / 120)
#define MEASURE_SECONDS 0.1
/* s, largest lag behind the clock that the simulation tries to catch up */
#define LAG_SECONDS 0.1
/* s over which pace and step time are averaged */
#define PACE_SECONDS 0.5
/* steps a second of methods that look for rest */
#define REST_STEP_SECONDS (1.0 / 60)
/* s that a step may take after an interaction; for slow scenes the ratio to the longest of the last steps. A
   thoughtless number can take minutes per step; steps grow gradually as a tool comes deeper (5,120 triangles, implicit:
   15 times as long over 20 steps, 4 times at once). */
#define STEP_SECONDS 1.0
#define STEP_RATIO 20
/* s that a stage has before a line that interrupts stops it */
#define STAGE_SECONDS 0.3
/* the longest step counts this much after another one */
#define STEP_DECAY 0.95
/* s in a row that are slow before it is told: browsers compile the first steps in a hurry */
#define SLOW_SECONDS 1.5

struct pel_player {
    const pel_server_def *def;
    pel_mailbox *box;
    const pel_scene *scene;
    pel_scene *own_scene; /* one that was opened; else null */
    bool is_opened;       /* it is not that of the file, with contact or without */
    pel_model *model;
    pel_sim *sim;
    pel_session *session;
    int32_t field;
    bool playing, changed; /* since the last picture */
    bool touched;          /* a command came after the last step */
    bool answers;          /* the last step saw a command, and no picture shows it */
    bool has_new_parameters, has_new_surface;
    int64_t shown_revision;     /* sum over the surfaces */
    const pel_mesh *shown_tool; /* the mesh under the hand */
    uint32_t echo;
    double step_seconds; /* of the clock for a step */
    double due;          /* clock of the next step */
    double longest_step; /* s of the clock, of the last steps */
    double step_end;     /* clock at which the present step has taken too long; 0 = never */
    double stage_at;     /* clock at the start of the present stage */
    int32_t behind;      /* lines of this turn behind the present one */
    int32_t waiting;     /* of these, those that interrupt */
    double pictured_at, measured_at;
    /* of the present interval, and the result of the last one */
    double interval_at, interval_time, interval_stepping, interval_serving;
    int64_t interval_steps;
    double pace, step_ms, serving;
    double slow_seconds; /* in a row */
    bool has_told_slow;
    /* the kept state: what is still to be repeated, and what is newer than the file */
    pel_kept kept;     /* its scene is own_scene */
    int32_t kept_next; /* command */
    bool repeats;
    pel_keep keep;
    bool is_ahead; /* of the file */
    bool has_told_lost;
    double kept_at;
    struct pel_player *self; /* where it stays: a scene is opened in a copy */
};

/* ---- posts ---- */

static void tell(pel_player *player, const char *kind, const char *text)
{
    size_t size = 0;
    unsigned char *bytes = pel_message_notice(kind, text, &size);
    pel_mailbox_post(player->box, PEL_POST_NOTICE, bytes, size);
}

/* kind: "error", or "refused" for the value of a parameter */
static void say_error(pel_player *player, const char *kind, const char *before, const pel_error *error)
{
    char text[1200], whole[1300];
    pel_error_text(error, text, sizeof text);
    const char *what = strncmp(text, "error: ", 7) == 0 ? text + 7 : text;
    snprintf(whole, sizeof whole, "%s%s", before, what);
    tell(player, kind, whole);
    pel_log_line(player->def->log, "%s", whole);
}

static void forget_place(pel_error *error)
{
    error->file[0] = '\0';
    error->line = error->column = 0;
}

/* an error of the present simulation: bodies, loads and tools by name; its cause stands on the page, not in the scene
 */
static void tell_error(pel_player *player, const char *kind, const char *before, const pel_error *error)
{
    pel_error named = *error;
    pel_scene_locate(player->scene, &named);
    if (error->file[0] == '\0')
        forget_place(&named);
    say_error(player, kind, before, &named);
}

/* an error of a scene that came as text; scene: nullable, as far as it was read */
static void tell_not_opened(pel_player *player, const pel_scene *scene, pel_error *error)
{
    char before[80] = "the scene was not opened. ";
    pel_scene_locate(scene, error);
    if (strcmp(error->file, player->def->scene->path) == 0) {
        if (error->line > 0)
            snprintf(before, sizeof before, "the scene was not opened. line %d, column %d: ", (int)error->line,
                     (int)error->column);
        forget_place(error);
    }
    say_error(player, "error", before, error);
}

static void post_hello(pel_player *player)
{
    size_t size = 0;
    unsigned char *bytes =
        pel_message_hello(player->scene, player->is_opened ? "" : player->scene->path, player->sim, &size);
    pel_mailbox_post(player->box, PEL_POST_HELLO, bytes, size);
}

static int64_t surface_revision(const pel_player *player)
{
    int64_t sum = 0;
    for (int32_t b = 0; b < player->scene->model.body_count; b++)
        sum += pel_sim_surface_revision(player->sim, b);
    return sum;
}

static void post_surface(pel_player *player)
{
    size_t size = 0;
    unsigned char *bytes = pel_message_surface(player->sim, player->session, &size);
    pel_mailbox_post(player->box, PEL_POST_SURFACE, bytes, size);
    player->has_new_surface = false;
    player->shown_revision = surface_revision(player);
    player->shown_tool = pel_session_tool_mesh(player->session);
}

static void post_parameters(pel_player *player)
{
    size_t size = 0;
    unsigned char *bytes = pel_message_parameters(player->sim, player->session, player->scene, &size);
    pel_mailbox_post(player->box, PEL_POST_PARAMETERS, bytes, size);
    player->has_new_parameters = false;
}

static void post_frame(pel_player *player, double now)
{
    size_t size = 0;
    bool measures = now - player->measured_at >= MEASURE_SECONDS || !player->playing;
    const pel_pace pace = {player->playing, player->pace, player->step_ms, player->serving, player->echo, measures};
    unsigned char *bytes = pel_message_frame(player->sim, player->session, player->field, &pace, &size);
    pel_mailbox_post(player->box, PEL_POST_FRAME, bytes, size);
    player->pictured_at = now;
    player->measured_at = measures ? now : player->measured_at;
    player->changed = player->answers = false;
}

/* clock of the next frame: soon after a command */
static double picture_due(const pel_player *player)
{
    return player->pictured_at + (player->answers ? ANSWER_SECONDS : PICTURE_SECONDS);
}

/* posts pending messages to pages; a picture only if a page waits for it */
static void post_all(pel_player *player)
{
    double start = pel_seconds();
    if (player->has_new_parameters)
        post_parameters(player);
    if (player->changed && start >= picture_due(player) && atomic_exchange(&player->box->wanted, false)) {
        if (player->has_new_surface || surface_revision(player) != player->shown_revision ||
            pel_session_tool_mesh(player->session) != player->shown_tool)
            post_surface(player);
        post_frame(player, start);
    }
    player->interval_serving += pel_seconds() - start;
}

/* ---- scenes ---- */

static void close_scene(pel_player *player)
{
    pel_session_destroy(player->session);
    pel_sim_destroy(player->sim);
    pel_model_destroy(player->model);
    pel_scene_destroy(player->own_scene);
    player->session = NULL;
    player->sim = NULL;
    player->model = NULL;
    player->own_scene = NULL;
}

static bool is_too_long(const pel_player *player)
{
    return player->step_end > 0 && pel_seconds() > player->step_end;
}

static bool is_interrupted(const pel_player *player)
{
    return (player->waiting > 0 || atomic_load(&player->box->interrupting) > 0) &&
           pel_seconds() - player->stage_at > STAGE_SECONDS;
}

/* asked within long stages */
static bool is_wanted(void *user)
{
    const pel_player *player = user;
    return !atomic_load(&player->box->ended) && !is_too_long(player) && !is_interrupted(player);
}

/* name: begins a sentence, lives forever */
static void begin_stage(pel_player *player, const char *name)
{
    player->stage_at = pel_seconds();
    pel_mailbox_begin(player->box, name, player->behind);
    pel_patience_begin(is_wanted, player);
}

/* whether it was stopped; from here on allocations are made again */
static bool end_stage(pel_player *player)
{
    bool was_stopped = pel_patience_end();
    pel_mailbox_begin(player->box, NULL, 0);
    return was_stopped;
}

/* nobody hears it at the end */
static void tell_stopped(pel_player *player, const char *what)
{
    char text[200];
    snprintf(text, sizeof text, "%s was stopped", what);
    if (!atomic_load(&player->box->ended))
        tell(player, "note", text);
}

/* model, simulation and session of the player's scene */
static pel_status start_scene(pel_player *player, pel_error *error)
{
    pel_status status = pel_model_create(&player->scene->model, &player->model, error);
    if (status != PEL_OK)
        return status;
    pel_sim_def def = player->scene->sim;
    def.model = player->model;
    if (player->def->thread_count > 0)
        def.thread_count = player->def->thread_count;
    def.wanted = is_wanted;
    def.user = player->self;
    def.stops_short_steps = true;
    status = pel_sim_create(&def, &player->sim, error);
    if (status == PEL_OK)
        status = pel_session_create(player->scene, player->sim, &player->session, error);
    if (status != PEL_OK)
        return status;
    bool rests = !pel_stepper_of(def.solver.method)->has_velocity;
    player->step_seconds = rests ? pel_min(def.solver.dt, REST_STEP_SECONDS) : def.solver.dt;
    player->field = -1;
    player->changed = player->has_new_parameters = true;
    player->slow_seconds = player->longest_step = 0;
    player->has_told_slow = false;
    return PEL_OK;
}

static void post_scene(pel_player *player)
{
    post_hello(player);
    post_surface(player);
    post_frame(player, pel_seconds());
}

/* replaces the scene; a text that cannot be simulated leaves the present one; setting is nullable */
static void open_scene(pel_player *player, const char *text, const char *setting)
{
    pel_player next = *player;
    pel_error error;
    next.own_scene = NULL;
    next.model = NULL;
    next.sim = NULL;
    next.session = NULL;
    begin_stage(player, "opening the scene");
    pel_status status = pel_scene_parse(player->def->scene->path, text, strlen(text), &setting, setting != NULL, NULL,
                                        &next.own_scene, &error);
    next.scene = next.own_scene;
    if (status == PEL_OK)
        status = start_scene(&next, &error);
    bool was_stopped = end_stage(player);
    if (was_stopped || status != PEL_OK) {
        if (was_stopped)
            tell_stopped(player, "opening the scene");
        else
            tell_not_opened(player, next.scene, &error);
        close_scene(&next);
        return;
    }
    next.is_opened |= setting == NULL;
    close_scene(player);
    *player = next;
    post_scene(player);
}

/* the scene from the start, whose steps repeat all interactions */
static void replay(pel_player *player)
{
    char *text = NULL;
    pel_error error;
    if (pel_session_scene(player->session, &text, &error) != PEL_OK) {
        tell_error(player, "error", "", &error);
        return;
    }
    bool was_opened = player->is_opened;
    open_scene(player, text, NULL);
    player->is_opened = was_opened;
    pel_session_free_text(text);
}

static void save_scene(pel_player *player)
{
    char *text = NULL;
    size_t size = 0;
    pel_error error;
    if (pel_session_scene(player->session, &text, &error) != PEL_OK) {
        tell_error(player, "error", "", &error);
        return;
    }
    unsigned char *bytes = pel_message_scene(text, &size);
    pel_mailbox_post(player->box, PEL_POST_SCENE, bytes, size);
    pel_session_free_text(text);
}

/* ---- the kept state ---- */

/* writes what is newer than the file; an error is told once */
static void keep(pel_player *player)
{
    pel_error error;
    if (player->def->kept == NULL || !player->is_ahead || player->repeats)
        return;
    pel_status status = pel_keep_write(&player->keep, player->session, pel_sim_step_count(player->sim), &error);
    player->kept_at = pel_seconds();
    player->is_ahead = false;
    if (status != PEL_OK && !player->has_told_lost)
        say_error(player, "error", "a crash would lose this session: ", &error);
    player->has_told_lost = status != PEL_OK;
}

/* the commands of the kept state for the present step */
static pel_status repeat_kept(pel_player *player, pel_error *error)
{
    const pel_kept *kept = &player->kept;
    int64_t now = pel_sim_step_count(player->sim);
    while (player->kept_next < kept->command_count && kept->commands[player->kept_next].step <= now) {
        pel_status status = pel_session_apply(player->session, kept->commands[player->kept_next].line, error);
        if (status != PEL_OK)
            return status;
        player->kept_next++;
    }
    return PEL_OK;
}

/* a file that cannot be repeated stays, under another name */
static void set_aside(pel_player *player, pel_error *error)
{
    char path[4096], before[4200];
    bool fits = snprintf(path, sizeof path, "%s.1", player->def->kept) < (int)sizeof path;
    snprintf(before, sizeof before, "the last session cannot be repeated (it is in %s): ",
             fits && rename(player->def->kept, path) == 0 ? path : player->def->kept);
    tell_error(player, "error", before, error);
}

/* one step of the kept state; its last one ends the repetition. A line that stops it waits for more. */
static void repeat_step(pel_player *player)
{
    pel_error error;
    bool is_last = pel_sim_step_count(player->sim) >= player->kept.steps;
    begin_stage(player, "repeating the last session");
    pel_status status = repeat_kept(player, &error);
    if (status == PEL_OK && !is_last)
        status = pel_session_step(player->session, &error);
    bool was_stopped = end_stage(player) || status == PEL_STOPPED;
    if ((status == PEL_OK && !is_last) || (status != PEL_OK && was_stopped))
        return;
    player->repeats = false;
    player->has_new_parameters = player->has_new_surface = true;
    if (status == PEL_OK)
        tell(player, "note", "the last session is back. Reset starts anew");
    else
        set_aside(player, &error);
}

/* as fast as the machine can, for as long as a picture lasts */
static void repeat_steps(pel_player *player)
{
    double start = pel_seconds();
    while (player->repeats && !atomic_load(&player->box->ended) && pel_seconds() - start < PICTURE_SECONDS)
        repeat_step(player);
    player->changed = true;
    player->due = pel_seconds();
}

/* the scene of the file instead of that of the def */
static void take_kept(pel_player *player)
{
    pel_error error;
    if (player->def->kept == NULL)
        return;
    if (pel_keep_read(player->def->kept, player->def->scene->path, &player->kept, &error) != PEL_OK) {
        set_aside(player, &error);
    } else if (player->kept.scene != NULL) {
        player->own_scene = player->kept.scene;
        player->scene = player->own_scene;
        player->repeats = true;
        pel_log_line(player->def->log, "repeats the last session: %d commands, %lld steps",
                     (int)player->kept.command_count, (long long)player->kept.steps);
    }
}

/* ---- steps ---- */

static void begin_interval(pel_player *player, double now)
{
    player->interval_at = now;
    player->interval_time = pel_sim_time(player->sim);
    player->interval_stepping = player->interval_serving = 0;
    player->interval_steps = 0;
}

static void play(pel_player *player, bool playing)
{
    player->playing = playing;
    player->due = pel_seconds();
    player->changed = true;
    begin_interval(player, player->due);
}

static bool has_parameter(const pel_player *player, const char *path)
{
    pel_parameter_info info;
    return pel_parameter_find(player->sim, path, &info, NULL) == PEL_OK;
}

/* what shortens the steps of the scene, or lets one last longer */
static const char *suit_remedy(const pel_player *player)
{
    if (player->step_seconds < player->scene->sim.solver.dt)
        return "a coarser mesh helps";
    if (pel_stepper_of(player->scene->sim.solver.method)->is_explicit)
        return "a coarser mesh helps, or the method xpbd with a longer solver.dt";
    if (has_parameter(player, "solver.substeps"))
        return "a lower solver.substeps, a coarser mesh or a longer solver.dt helps";
    if (has_parameter(player, "solver.iterations"))
        return "a lower solver.iterations, a coarser mesh or a longer solver.dt helps";
    return "a coarser mesh or a longer solver.dt helps";
}

/* length: s of the clock of the interval */
static void tell_slow(pel_player *player, double length)
{
    char text[300];
    bool is_slow = player->pace <= 0.8 && player->pace > 0;
    player->slow_seconds = is_slow ? player->slow_seconds + length : 0;
    if (player->slow_seconds < SLOW_SECONDS || player->has_told_slow)
        return;
    player->has_told_slow = true;
    snprintf(text, sizeof text,
             "slower than real time: %.2g s of simulation in a second, %.3g ms a step of %.3g ms. %s", player->pace,
             player->step_ms, 1e3 * player->step_seconds, suit_remedy(player));
    tell(player, "note", text);
}

static void end_interval(pel_player *player, double now)
{
    double length = now - player->interval_at;
    if (length < PACE_SECONDS || player->interval_steps == 0)
        return;
    double dt = player->scene->sim.solver.dt;
    player->pace = (double)player->interval_steps * player->step_seconds / length;
    if (player->step_seconds >= dt)
        player->pace = (pel_sim_time(player->sim) - player->interval_time) / length;
    player->step_ms = 1e3 * player->interval_stepping / (double)player->interval_steps;
    player->serving = player->interval_serving / length;
    tell_slow(player, length);
    begin_interval(player, now);
}

/* undoes the last interaction, after a step that failed; the session itself does so after one that diverged */
static pel_status return_to_mark(pel_player *player, pel_status failed, pel_error *error)
{
    bool done = true;
    if (failed == PEL_DIVERGED)
        return PEL_OK;
    pel_status status = pel_session_undo(player->session, &done, error);
    return status == PEL_OK && !done ? pel_session_reset(player->session, error) : status;
}

/* a step that failed or took too long */
static void end_at_mark(pel_player *player, pel_status failed, double seconds, pel_error *error)
{
    pel_error later;
    if (failed == PEL_STOPPED) {
        pel_fail(error, failed, "after the last command a step would take more than %.2g s (before: %.3g ms at most)",
                 seconds, 1e3 * player->longest_step);
        pel_fail_remedy(error, "change less at once");
    }
    if (return_to_mark(player, failed, &later) == PEL_OK)
        tell_error(player, "error", "the last good state is back: ", error);
    else
        tell_error(player, "error", "", &later);
}

/* a step that was not made: stopped by a line or the end, too long, or failed */
static void miss_step(pel_player *player, pel_status status, bool was_interrupted, double limit, pel_error *error)
{
    player->has_new_parameters = player->has_new_surface = true;
    if (was_interrupted)
        tell_stopped(player, "the step");
    else if (!atomic_load(&player->box->ended))
        end_at_mark(player, status, limit, error);
    play(player, false);
}

/* false if the simulation cannot continue */
static bool do_step(pel_player *player)
{
    pel_error error;
    double start = pel_seconds(), limit = pel_max(STEP_SECONDS, STEP_RATIO * player->longest_step);
    begin_stage(player, "the step");
    pel_status repeated = pel_session_repeat(player->session, &error), status = repeated;
    /* the step asks by itself, and restores its state */
    bool was_stopped = pel_patience_end();
    player->step_end = pel_session_undo_count(player->session) > 0 ? start + limit : 0;
    if (status == PEL_OK)
        status = pel_session_step(player->session, &error);
    bool was_interrupted = was_stopped || (status == PEL_STOPPED && !is_too_long(player));
    double seconds = pel_seconds() - start;
    player->step_end = 0;
    (void)end_stage(player);
    player->interval_stepping += seconds;
    player->interval_steps++;
    player->changed = player->is_ahead = true;
    player->answers |= player->touched;
    player->touched = false;
    if (status == PEL_OK) {
        player->longest_step = pel_max(seconds, STEP_DECAY * player->longest_step);
        return true;
    }
    if (repeated != PEL_OK && !was_interrupted) {
        player->has_new_parameters = player->has_new_surface = true;
        tell_error(player, "error", "", &error);
        play(player, false);
    } else {
        miss_step(player, status, was_interrupted, limit, &error);
    }
    return false;
}

/* A step answers a command before it is due, but the simulation is never more than one step ahead of the clock. */
static bool is_due(const pel_player *player, double now)
{
    return player->due <= now || (player->touched && player->due - player->step_seconds <= now);
}

/* steps that are due, at most for as long as a picture lasts */
static void do_steps(pel_player *player)
{
    double start = pel_seconds(), now = start;
    while (player->playing && is_due(player, now) && now - start < PICTURE_SECONDS) {
        if (!do_step(player))
            return;
        player->due += player->step_seconds;
        now = pel_seconds();
    }
    if (now - player->due > LAG_SECONDS)
        player->due = now;
    if (player->playing)
        end_interval(player, now);
}

/* ---- lines ---- */

static void choose_field(pel_player *player, const char *name)
{
    char text[200];
    player->field = strcmp(name, "none") == 0 ? -1 : pel_field_find(name);
    if (player->field < 0 && strcmp(name, "none") != 0) {
        snprintf(text, sizeof text, "there is no field '%.100s'", name);
        tell(player, "error", text);
    }
}

static void go_back(pel_player *player, bool whole)
{
    pel_error error;
    bool done = true;
    begin_stage(player, whole ? "the reset" : "undoing");
    pel_status status =
        whole ? pel_session_reset(player->session, &error) : pel_session_undo(player->session, &done, &error);
    if (end_stage(player) && status != PEL_OK)
        tell_stopped(player, whole ? "the reset" : "undoing");
    else if (status != PEL_OK)
        tell_error(player, "error", "", &error);
    else if (!done)
        tell(player, "note", "there is nothing to undo");
    player->has_new_surface = player->has_new_parameters = true;
    if (whole)
        play(player, false);
}

/* commands that change parameters or pins, which pages show next to the picture */
static void apply(pel_player *player, const char *line)
{
    pel_error error;
    begin_stage(player, "the command");
    pel_status status = pel_session_apply(player->session, line, &error);
    bool was_stopped = end_stage(player), sets = strncmp(line, "set ", 4) == 0 || strncmp(line, "inflate ", 8) == 0;
    if (was_stopped && status != PEL_OK)
        tell_stopped(player, "the command");
    else if (status != PEL_OK)
        tell_error(player, sets ? "refused" : "error", "", &error);
    if (sets || status != PEL_OK)
        player->has_new_parameters = true;
    if (strncmp(line, "pin ", 4) == 0 || strncmp(line, "unpin ", 6) == 0 || strncmp(line, "press ", 6) == 0)
        player->has_new_surface = true;
}

/* what else is said while the last session is repeated has to wait: it would come before its turn */
static bool waits_for_repetition(pel_player *player, const char *line)
{
    static const char *const harmless[] = {"play", "pause", "save", "field ", "echo "};
    bool waits = player->repeats;
    for (size_t i = 0; i < sizeof harmless / sizeof *harmless; i++)
        waits &= strncmp(line, harmless[i], strlen(harmless[i])) != 0;
    if (waits && pel_player_interrupts(line))
        player->repeats = waits = false;
    if (waits)
        tell(player, "note", "the last session is repeated first. Reset starts anew");
    return waits;
}

static void do_line(pel_player *player, const char *line)
{
    if (waits_for_repetition(player, line))
        return;
    if (strcmp(line, "play") == 0)
        play(player, true);
    else if (strcmp(line, "pause") == 0)
        play(player, false);
    else if (strcmp(line, "step") == 0)
        (void)do_step(player);
    else if (strcmp(line, "undo") == 0)
        go_back(player, false);
    else if (strcmp(line, "reset") == 0)
        go_back(player, true);
    else if (strcmp(line, "save") == 0)
        save_scene(player);
    else if (strcmp(line, "replay") == 0)
        replay(player);
    else if (strncmp(line, "field ", 6) == 0)
        choose_field(player, line + 6);
    else if (strncmp(line, "open ", 5) == 0)
        open_scene(player, line + 5, NULL);
    else if (strcmp(line, "contact") == 0)
        open_scene(player, pel_scene_text(player->scene), "contact.self=false");
    else if (strncmp(line, "echo ", 5) == 0)
        player->echo = (uint32_t)strtoul(line + 5, NULL, 10);
    else
        apply(player, line);
    player->changed = player->touched = player->is_ahead = true;
    player->answers |= !player->playing;
}

bool pel_player_interrupts(const char *line)
{
    static const char *const words[] = {"pause", "undo", "reset", "contact"};
    bool found = strncmp(line, "open ", 5) == 0;
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        found |= strcmp(line, words[i]) == 0;
    return found;
}

double pel_player_rest(const pel_player *player)
{
    double now = pel_seconds(), rest = player->playing ? player->due - now : 0.1;
    if (player->repeats)
        return 0;
    if (player->changed && atomic_load(&player->box->wanted))
        return pel_min(rest, picture_due(player) - now);
    return player->changed ? pel_min(rest, 0.004) : pel_min(rest, 0.1);
}

bool pel_player_turn(pel_player *player, double rest)
{
    char *lines[PEL_LINE_LIMIT];
    int32_t count = 0;
    bool goes_on = pel_mailbox_wait(player->box, rest, lines, &count);
    for (int32_t i = 0; i < count; i++)
        player->waiting += pel_player_interrupts(lines[i]);
    for (int32_t i = 0; i < count; i++) {
        player->waiting -= pel_player_interrupts(lines[i]);
        player->behind = count - 1 - i;
        if (goes_on && !atomic_load(&player->box->ended))
            do_line(player, lines[i]);
        pel_free(lines[i]);
    }
    if (!goes_on || pel_seconds() - player->kept_at >= PEL_KEEP_SECONDS)
        keep(player);
    if (goes_on && player->repeats)
        repeat_steps(player);
    else if (goes_on && player->playing)
        do_steps(player);
    if (goes_on)
        post_all(player);
    return goes_on;
}

void *pel_player_run(void *player)
{
    while (pel_player_turn(player, pel_player_rest(player)))
        ;
    return NULL;
}

pel_status pel_player_create(const pel_server_def *def, pel_mailbox *box, pel_player **player, pel_error *error)
{
    *player = NULL;
    pel_player *made = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    made->def = def;
    made->box = box;
    made->scene = def->scene;
    made->self = made;
    made->keep.path = def->kept;
    take_kept(made);
    pel_status status = start_scene(made, error);
    if (status != PEL_OK) {
        pel_player_destroy(made);
        return status;
    }
    post_scene(made);
    post_parameters(made);
    play(made, false);
    *player = made;
    return PEL_OK;
}

void pel_player_destroy(pel_player *player)
{
    if (player == NULL)
        return;
    close_scene(player);
    pel_keep_close(&player->keep);
    pel_free(player);
}
