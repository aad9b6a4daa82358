/* mps/io.h - results and restart: a series of frames that ParaView opens (VTKHDF), and checkpoints
 * from which a run continues bit for bit. Both are HDF5 files; docs/output.md shows their layout.
 *
 * A libmps built without HDF5 has these functions too: functions with a status then return
 * MPS_ERROR_UNSUPPORTED.
 *
 * Thread rule: one thread at a time per context. Distinct contexts may write and read at once:
 * libmps serialises their calls of HDF5, which is not thread safe in most builds. A program that
 * calls HDF5 itself must not do so in another thread while a function of this header runs, unless
 * its HDF5 is a thread-safe build. Its own settings of HDF5's error printing stay.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_IO_H
#define LIBMPS_IO_H

#include "particles.h"

MPS_EXTERN_C_BEGIN

/* ---- series of frames ------------------------------------------------------------------------ */

typedef struct mps_recorder mps_recorder;

typedef struct mps_recorder_def {
  uint32_t struct_size;
  int32_t compression;       /* zlib level 1..9, or 0 (default): none */
  const char *path;          /* file to write, customarily *.vtkhdf; an existing one is replaced */
  const char *const *fields; /* names of the fields to write; NULL (default): all of the set.
                                Position and id are always written. */
  int64_t field_count;       /* number of names */
  int32_t xdmf; /* 1: writes PATH.xdmf too (x.xdmf for x.vtkhdf), a text that names the frames, for
                   programs that read no series of VTKHDF, such as ParaView before 5.12; both files
                   stay together. 0 (default): no */
  int32_t reserved;
} mps_recorder_def;

static inline mps_recorder_def mps_recorder_defaults(void) {
  mps_recorder_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_RECORDER, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Begins a series of the set `particles`, which the recorder keeps alive. The fields are those the
 *  set has now, so create the solver first. MPS_ERROR_FIELD: the set lacks a name of the list;
 *  MPS_ERROR_IO: the file cannot be written; MPS_ERROR_UNSUPPORTED: no HDF5, or one without zlib
 *  where `compression` is not 0. The file is opened only after all other checks. */
MPS_API MPS_NODISCARD mps_status mps_recorder_create(mps_context *context, mps_particles *particles,
                                                     const mps_recorder_def *def,
                                                     mps_recorder **out);

/** Appends a frame at `time` (s, finite): the present positions, ids and fields. Order and number
 *  of particles may differ from frame to frame. Time must not go back; the time of the last frame
 *  again replaces that frame (so that runs may follow each other, each calling back at its start
 *  and end). All data are passed to the operating system before it returns. MPS_ERROR_IO (a full
 *  disk): this frame is lost, those before stay readable, and further frames return
 *  MPS_ERROR_STATE. MPS_ERROR_ARGUMENT: `time` not finite, or before the last frame.
 *  MPS_ERROR_UNSUPPORTED: no HDF5. */
MPS_API MPS_NODISCARD mps_status mps_recorder_write(mps_recorder *recorder, double time);

/** Closes the file, has the disk confirm it, destroys and nulls, even on error; accepts NULL.
 *  MPS_ERROR_IO: something of the series did not reach the disk. */
MPS_API MPS_NODISCARD mps_status mps_recorder_close(mps_recorder **recorder);
/** Closes and destroys, ignoring errors; accepts NULL. */
MPS_API void mps_recorder_destroy(mps_recorder **recorder);

/* ---- checkpoints -----------------------------------------------------------------------------
 * mps_solver_save writes one, mps_solver_restore continues from it (mps/solver.h); here are its
 * description, and its particles without the solver. */

/** Data of a checkpoint besides the fields. */
typedef struct mps_checkpoint {
  uint32_t struct_size;
  int32_t reserved;
  double time;        /* s, finite */
  int64_t step;       /* >= 0 */
  double dt;          /* s, >= 0 */
  char user_key[64];  /* terminated text: compared at restart, such as the options of the run; ""
                         (default): nothing */
  void *user_data;    /* of the caller, such as results so far. Writing: user_bytes to keep, not
                         changed. Reading: NULL (default), or room for user_bytes, at least what the
                         file has */
  int64_t user_bytes; /* >= 0; reading writes how many the file has */
} mps_checkpoint;

static inline mps_checkpoint mps_checkpoint_defaults(void) {
  mps_checkpoint info;
  memset(&info, 0, sizeof info);
  if (mps_def_init(MPS_DEF_CHECKPOINT, &info, sizeof info) != MPS_OK) info.struct_size = 0;
  return info;
}

/** Reads `info` only (start from mps_checkpoint_defaults()), such as the dt of the solver to
 *  create. A user_key given there that is not "" must equal that of the file (MPS_ERROR_ARGUMENT).
 *  MPS_ERROR_IO, MPS_ERROR_FORMAT and MPS_ERROR_UNSUPPORTED as mps_checkpoint_read. */
MPS_API MPS_NODISCARD mps_status mps_checkpoint_info(mps_context *context, const char *path,
                                                     mps_checkpoint *info);

/** Restores the fields of a checkpoint, bit for bit, in a set that has the same particles
 *  (dimension, spacing, number, ids; their order may differ), adding fields that the set lacks;
 *  fields that the file lacks keep their values. A caller's field that libmps 0.3 wrote as NAME
 *  becomes "user.NAME", here and in mps_solver_restore. `info` is as for mps_checkpoint_info. Order
 * and epoch of the set stay. Needs memory for a second copy of all fields. On an error nothing has
 *  changed.
 *
 *  MPS_ERROR_IO: cannot be read. MPS_ERROR_FORMAT: not a checkpoint, cut short or damaged.
 *  MPS_ERROR_UNSUPPORTED: written by a newer libmps. MPS_ERROR_ARGUMENT: of another set of
 *  particles, or another user_key. MPS_ERROR_FIELD: a field of the set has another shape.
 *  MPS_ERROR_STATE: a solver holds the set (its own function, such as mps_mpm_restore, puts both
 *  back), or a field is being edited. */
MPS_API MPS_NODISCARD mps_status mps_checkpoint_read(mps_particles *particles, const char *path,
                                                     mps_checkpoint *info);

MPS_EXTERN_C_END
#endif
