/* scenes.h - a small scene of each solver, on the stable headers alone: for the programs of a release that later
 * libraries run (docs/interface.md). SPDX-License-Identifier: BSD-3-Clause */
#ifndef RELEASED_SCENES_H
#define RELEASED_SCENES_H

#include <mps/mps.h>

/* What a scene is made of; NULL where it has none. */
typedef struct scene {
  mps_context *context;
  mps_particles *set;
  mps_material *law;
  mps_signal *signal;
  mps_body *body;
  mps_contact *contact;
  mps_mpm *mpm;
  mps_dynamics *dynamics;
  mps_elastic *elastic;
  mps_fluid *fluid;
  mps_solver *solver; /* the one of the four, lent */
} scene;

enum { SCENE_MPM, SCENE_DYNAMICS, SCENE_ELASTIC, SCENE_FLUID, SCENES };
extern const char *const scene_names[SCENES];

/* Makes scene `kind` of a zeroed `s` in a serial context. MPS_ERROR_UNSUPPORTED: the library lacks what it needs. */
mps_status scene_make(scene *s, int kind);
void scene_drop(scene *s);

#endif
