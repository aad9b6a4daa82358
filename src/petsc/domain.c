/* domain.c - a transport for domains: MPI's reductions, PETSc's rendezvous and star forests.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "guest.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#define TAG 7351
#define PIECE (1 << 30) /* bytes of one message of MPI, whose counts are int */

typedef struct transport {
  MPI_Comm comm;
  MPI_Request vote;       /* of max_begin */
  struct transport *next; /* of transports that have left */
  MPI_Request last;       /* of max_leave */
  double *values;         /* its own; NULL: the transport has not left */
} transport;

/* Transports whose last reduction the other ranks have not joined yet. One process has one MPI. */
static transport *leaving;

/* ---- callbacks ------------------------------------------------------------------------------- */

static mps_status reduce_max(void *user, int32_t count, double *values) {
  const transport *t = user;
  if (mpsi_petsc_stranded()) return MPS_ERROR_IO;
  return MPSI_PETSC_STATUS(
      MPI_Allreduce(MPI_IN_PLACE, values, count, MPI_DOUBLE, MPI_MAX, t->comm));
}

static mps_status max_begin(void *user, int32_t count, double *values) {
  transport *t = user;
  if (mpsi_petsc_stranded()) return MPS_ERROR_IO;
  return MPSI_PETSC_STATUS(
      MPI_Iallreduce(MPI_IN_PLACE, values, count, MPI_DOUBLE, MPI_MAX, t->comm, &t->vote));
}

static mps_status max_end(void *user) {
  transport *t = user;
  return MPSI_PETSC_STATUS(MPI_Wait(&t->vote, MPI_STATUS_IGNORE));
}

static mps_status max_leave(void *user, int32_t count, const double *values) {
  transport *t = user;
  if (mpsi_petsc_stranded()) return MPS_ERROR_IO;
  t->values = malloc((size_t)count * sizeof *t->values);
  if (!t->values) return MPS_ERROR_MEMORY;
  memcpy(t->values, values, (size_t)count * sizeof *t->values);
  const mps_status status = MPSI_PETSC_STATUS(
      MPI_Iallreduce(MPI_IN_PLACE, t->values, count, MPI_DOUBLE, MPI_MAX, t->comm, &t->last));
  if (status == MPS_OK) return MPS_OK;
  free(t->values);
  t->values = NULL;
  return status;
}

static mps_status reduce_sum(void *user, int32_t count, int64_t *values) {
  const transport *t = user;
  if (mpsi_petsc_stranded()) return MPS_ERROR_IO;
  return MPSI_PETSC_STATUS(
      MPI_Allreduce(MPI_IN_PLACE, values, count, MPI_INT64_T, MPI_SUM, t->comm));
}

static int pieces(int64_t bytes) { return (int)((bytes + PIECE - 1) / PIECE); }

static int piece_size(int64_t bytes, int k) {
  const int64_t left = bytes - (int64_t)k * PIECE;
  return (int)(left < PIECE ? left : PIECE);
}

/* Messages as they are under way. */
typedef struct post {
  int32_t incoming;
  PetscMPIInt *from;
  int64_t *bytes;
  char **room;
  MPI_Request *request;
  int requests, error;
  bool refused;
} post;

static void receive(const transport *t, post *p, mps_domain_room_fn room, void *room_user) {
  for (int32_t k = 0; k < p->incoming; k++) {
    p->room[k] = room(room_user, p->from[k], p->bytes[k]);
    if (!p->room[k]) { /* it must be received all the same */
      p->refused = true;
      p->room[k] = malloc((size_t)p->bytes[k] + 1);
    }
    for (int i = 0; i < pieces(p->bytes[k]) && p->error == 0; i++)
      p->error = MPI_Irecv(p->room[k] + (int64_t)i * PIECE, piece_size(p->bytes[k], i), MPI_BYTE,
                           p->from[k], TAG, t->comm, &p->request[p->requests++]);
  }
}

static void send_all(const transport *t, post *p, int32_t count, const mps_domain_message *m) {
  for (int32_t k = 0; k < count; k++)
    for (int i = 0; i < pieces(m[k].bytes) && p->error == 0; i++)
      p->error = MPI_Isend((const char *)m[k].data + (int64_t)i * PIECE, piece_size(m[k].bytes, i),
                           MPI_BYTE, m[k].rank, TAG, t->comm, &p->request[p->requests++]);
}

static mps_status exchange(const transport *t, post *p, int32_t count, const mps_domain_message *m,
                           mps_domain_room_fn room, void *room_user) {
  int all = 0;
  for (int32_t k = 0; k < p->incoming; k++) all += pieces(p->bytes[k]);
  for (int32_t k = 0; k < count; k++) all += pieces(m[k].bytes);
  p->room = calloc((size_t)p->incoming + 1, sizeof *p->room);
  p->request = calloc((size_t)all + 1, sizeof *p->request);
  if (!p->room || !p->request) return MPS_ERROR_IO; /* the messages cannot be received any more */
  receive(t, p, room, room_user);
  send_all(t, p, count, m);
  if (p->error == 0) p->error = MPI_Waitall(p->requests, p->request, MPI_STATUSES_IGNORE);
  return p->error ? MPS_ERROR_IO : p->refused ? MPS_ERROR_MEMORY : MPS_OK;
}

static mps_status rendezvous(void *user, int32_t count, const mps_domain_message *messages,
                             mps_domain_room_fn room, void *room_user) {
  const transport *t = user;
  if (mpsi_petsc_stranded()) return MPS_ERROR_IO;
  post p = {.incoming = 0};
  PetscMPIInt incoming = 0;
  void *bytes = NULL;
  PetscMPIInt *to = malloc(((size_t)count + 1) * sizeof *to);
  int64_t *size = malloc(((size_t)count + 1) * sizeof *size);
  mps_status status = to && size ? MPS_OK : MPS_ERROR_IO;
  for (int32_t k = 0; status == MPS_OK && k < count; k++)
    to[k] = messages[k].rank, size[k] = messages[k].bytes;
  if (status == MPS_OK)
    status = MPSI_PETSC_STATUS(PetscCommBuildTwoSided(t->comm, 1, MPI_INT64_T, count, to, size,
                                                      &incoming, &p.from, &bytes));
  p.incoming = incoming, p.bytes = bytes;
  if (status == MPS_OK) status = exchange(t, &p, count, messages, room, room_user);
  free(p.room);
  free(p.request);
  free(to);
  free(size);
  (void)PetscFree(p.from);
  (void)PetscFree(bytes);
  return status;
}

/* ---- stars ----------------------------------------------------------------------------------- */

typedef struct star {
  PetscSF forest;
  MPI_Datatype item;
  int32_t item_bytes;
  const void *own;
  void *guests;
} star;

static void star_destroy(void *user, void *handle) {
  star *s = handle;
  if (mpsi_petsc_stranded()) return;
  if (s->item_bytes > 0) (void)MPI_Type_free(&s->item);
  (void)PetscSFDestroy(&s->forest);
  free(s);
}

static mps_status star_create(void *user, int64_t own, int64_t guests, const int32_t *rank,
                              const int64_t *index, void **out) {
  const transport *t = user;
  if (mpsi_petsc_stranded()) return MPS_ERROR_IO;
  star *s = calloc(1, sizeof *s);
  PetscSFNode *node = malloc(((size_t)guests + 1) * sizeof *node);
  bool good = s && node && own <= PETSC_MAX_INT && guests <= PETSC_MAX_INT;
  for (int64_t k = 0; good && k < guests; k++) {
    node[k].rank = rank[k];
    node[k].index = (PetscInt)index[k];
  }
  good = good && PetscSFCreate(t->comm, &s->forest) == 0 &&
         PetscSFSetGraph(s->forest, (PetscInt)own, (PetscInt)guests, NULL, PETSC_OWN_POINTER, node,
                         PETSC_COPY_VALUES) == 0 &&
         PetscSFSetUp(s->forest) == 0;
  free(node);
  if (!good && s) star_destroy(user, s);
  *out = good ? s : NULL;
  return good ? MPS_OK : MPS_ERROR_IO;
}

static mps_status star_begin(void *user, void *handle, int32_t item_bytes, const void *own,
                             void *guests) {
  star *s = handle;
  if (mpsi_petsc_stranded()) return MPS_ERROR_IO;
  if (item_bytes != s->item_bytes) {
    const int size = (int)sizeof(double);
    const bool doubles = item_bytes % size == 0;
    if (s->item_bytes > 0) (void)MPI_Type_free(&s->item);
    s->item_bytes = 0;
    if (MPI_Type_contiguous(doubles ? item_bytes / size : item_bytes,
                            doubles ? MPI_DOUBLE : MPI_BYTE, &s->item) != 0 ||
        MPI_Type_commit(&s->item) != 0)
      return MPS_ERROR_IO;
    s->item_bytes = item_bytes;
  }
  s->own = own, s->guests = guests;
  return MPSI_PETSC_STATUS(PetscSFBcastBegin(s->forest, s->item, own, guests, MPI_REPLACE));
}

static mps_status star_end(void *user, void *handle) {
  star *s = handle;
  if (mpsi_petsc_stranded()) return MPS_ERROR_IO;
  return MPSI_PETSC_STATUS(PetscSFBcastEnd(s->forest, s->item, s->own, s->guests, MPI_REPLACE));
}

/* ---- life ------------------------------------------------------------------------------------ */

static void drop(transport *t) {
  (void)MPI_Comm_free(&t->comm);
  free(t->values);
  free(t);
}

/* Frees transports that have left and that no rank uses; `wait`: all of them. */
static void drop_left(bool wait) {
  for (transport **at = &leaving; *at;) {
    transport *t = *at;
    int done = 0;
    if (wait)
      done = MPI_Wait(&t->last, MPI_STATUS_IGNORE) == 0;
    else
      (void)MPI_Test(&t->last, &done, MPI_STATUS_IGNORE);
    if (!done && !wait) {
      at = &t->next;
      continue;
    }
    *at = t->next;
    drop(t);
  }
}

static void wait_for_left(void) { drop_left(true); }

static void destroy(void *user) {
  transport *t = user;
  if (mpsi_petsc_stranded()) {
    free(t); /* its communicator is in use by the others */
  } else if (t->values) {
    mpsi_petsc_before_end(wait_for_left);
    t->next = leaving;
    leaving = t;
    drop_left(false);
  } else {
    drop(t);
  }
  mpsi_petsc_leave();
}

static mps_status refuse(mps_status status) {
  mpsi_petsc_leave();
  return status;
}

/* Reductions in two parts cost more than they save where ranks keep in step. */
static bool in_parts(void) {
  PetscBool asked = PETSC_FALSE;
  return PetscOptionsHasName(NULL, "mps_", "-reduce_in_parts", &asked) == 0 && asked;
}

static mps_status create(mps_context *context, const char *function, MPI_Comm communicator,
                         mps_domain **out) {
  transport *t = calloc(1, sizeof *t);
  int rank = 0, size = 0;
  drop_left(false);
  if (!t) return refuse(mpsi_petsc_fail(context, function, MPS_ERROR_MEMORY, "no memory is left"));
  const mps_status made = mpsi_petsc_duplicate(context, function, communicator, &t->comm);
  if (made != MPS_OK) {
    free(t);
    return refuse(made);
  }
  (void)MPI_Comm_rank(t->comm, &rank);
  (void)MPI_Comm_size(t->comm, &size);
  mps_domain_def def = mps_domain_defaults();
  def.rank = rank;
  def.size = size;
  def.user = t;
  def.rendezvous = rendezvous;
  def.star_create = star_create;
  def.star_begin = star_begin;
  def.star_end = star_end;
  def.star_destroy = star_destroy;
  def.reduce_max = reduce_max;
  def.reduce_sum = reduce_sum;
  if (in_parts()) def.max_begin = max_begin, def.max_end = max_end;
  def.max_leave = max_leave;
  def.release = destroy;
  const mps_status status = mps_domain_create(context, &def, out);
  if (status != MPS_OK) destroy(t);
  return status;
}

mps_status mps_petsc_domain_create_c2f(mps_context *context, int32_t communicator,
                                       mps_domain **out) {
  int running = 0, ended = 0;
  if (!context || !out)
    return mps_context_set_error(context, MPS_ERROR_ARGUMENT, __func__,
                                 context ? "out is NULL" : "context is NULL");
  *out = NULL;
  if (MPI_Initialized(&running) != 0 || MPI_Finalized(&ended) != 0 || !running || ended)
    return mps_context_set_error(context, MPS_ERROR_STATE, __func__,
                                 "MPI is not running or has been ended");
  const mps_status status = mpsi_petsc_enter();
  return status == MPS_OK ? create(context, __func__, MPI_Comm_f2c((MPI_Fint)communicator), out)
                          : mpsi_petsc_fail(context, __func__, status, "PETSc cannot be started");
}

mps_status mps_petsc_domain_create_world(mps_context *context, mps_domain **out) {
  if (!context || !out)
    return mps_context_set_error(context, MPS_ERROR_ARGUMENT, __func__,
                                 context ? "out is NULL" : "context is NULL");
  *out = NULL;
  const mps_status status = mpsi_petsc_enter();
  return status == MPS_OK
             ? create(context, __func__, MPI_COMM_WORLD, out)
             : mpsi_petsc_fail(context, __func__, status, "MPI or PETSc cannot be started");
}
