/* Warnings about contact: jams, tools that were held back, grasps and ties that lost vertices, coarse contact. */
#ifndef PEL_RUN_WARNINGS_CONTACT_H
#define PEL_RUN_WARNINGS_CONTACT_H

#include "run/warnings_bodies.h"

/* a tool that touches fewer vertices has a force that depends on the mesh: a disc with a radius of three edges has 33.
   Balls on livers have forces within 5 % of those on fine meshes from 30 on, and 10 % more with 13 to 15
   (docs/scenes.md) */
enum { PEL_LEAST_CONTACTS = 30 };

/* Vertices that a tool touched when its force was largest; 0 = it pressed nothing. Grasps hold vertices one by one. */
int32_t pel_pressed_count(const pel_run_state *run, int32_t tool);

/* The first body on the way of a tool by now of which all vertices in the tool are pinned, so that it presses nothing
   that moves; null = none, or the tool is a mesh. */
const char *pel_pinned_body_on_way(const pel_run_state *run, int32_t tool);

/* Whether a tool moved to press something and never had a force, nor is at a surface now. One that stands still may be
   a floor, and forces of the last steps may have fallen to nothing; what gives way by itself, such as a net without
   bending, has none. */
bool pel_tool_is_idle(const pel_run_state *run, int32_t tool);

/* Blades with a sharpness that pass more than a share of an edge in a step: one edge opens in a step at most. */
void pel_warnings_check_blades(pel_run_state *run);
void pel_tell_fast_blade(const pel_warning_text *at);

void pel_tell_jam(const pel_warning_text *at);
void pel_tell_held_tool(const pel_warning_text *at);
void pel_tell_estimated(const pel_warning_text *at);
void pel_tell_lost_grasp(const pel_warning_text *at);
void pel_tell_lost_tie(const pel_warning_text *at);
void pel_tell_coarse_contact(const pel_warning_text *at);

#endif
