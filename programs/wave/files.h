/* files.h - the series of frames and the checkpoints of a run.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef EXAMPLES_WAVE_FILES_H
#define EXAMPLES_WAVE_FILES_H

#include "restart.h"

#include "common/resume.h"

#include <mps/io.h>
#include <mps/dynamics.h>

typedef struct files {
  mps_particles *particles; /* borrowed; of several ranks this one's share */
  mps_domain *domain;       /* borrowed; NULL: one process */
  mps_particles *whole;     /* rank 0 of several: all ranks' particles, to write */
  mps_recorder *recorder;   /* NULL: no frames */
  char *series;             /* its file */
  double frame_every;       /* s, between frames; 0: no frames */
  int64_t next_frame;       /* due at next_frame * frame_every; the first at once */
  resume_schedule saves;    /* checkpoints */
  mps_dynamics *dynamics;   /* borrowed */
  app *a;                   /* borrowed */
  bool failed;              /* files_record, which ended the run */
  results_so_far *so_far;   /* borrowed: results in a checkpoint */
} files;

/* Reads the time step of the checkpoint that the options name, before the solver is made. */
bool files_peek(app *a, settings *s);
/* Restores the checkpoint, if any, and opens the files of the options. */
bool files_open(app *a, const settings *s, double duration, results_so_far *so_far,
                mps_dynamics *dynamics, files *out);
/* Writes the files that are due; call it with fields up to date. `status` is that of this rank so
 * far. As the others with a solver: on all ranks, of which rank 0 writes. */
mps_status files_record(files *f, mps_status status);
/* The particles of all ranks, brought up to date on rank 0; NULL on the others, or on an error. */
mps_status files_gather(files *f, mps_particles **whole);
/* The last checkpoint, wherever the run ended; false after an error line. */
bool files_close(app *a, files *f, bool diverged, bool interrupted);
void files_destroy(files *f);

#endif
