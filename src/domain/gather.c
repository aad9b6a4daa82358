/* gather.c - the particles of all ranks as one set on rank 0.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/particles/particles_internal.h"
#include "core/state/state.h"
#include "domain_private.h"
#include "row_heads.h"

#include <stdlib.h>
#include <string.h>

/* ---- the message of a rank: head, runs of rows, then the head and columns of each field -------
 */

/* Fields to send: id, position and those of the list; with `names` NULL all. */
typedef struct choice {
  int64_t count;
  const char *const *names;
} choice;

static bool is_chosen(const choice *c, int32_t field, const char *name) {
  bool chosen = !c->names || field < 2; /* id, position */
  for (int64_t k = 0; k < c->count && !chosen; k++) chosen = strcmp(c->names[k], name) == 0;
  return chosen;
}

static mps_status check_choice(const mps_domain *domain, const char *function,
                               mps_particles *particles, const choice *c) {
  mps_view view;
  if (c->count < 0 || (c->count > 0 && !c->names))
    return mpsi_fail(domain->context, function, MPS_ERROR_ARGUMENT,
                     "count is %lld with names %s, must be >= 0, and 0 where names is NULL",
                     (long long)c->count, c->names ? "given" : "NULL");
  for (int64_t k = 0; k < c->count; k++)
    MPSI_TRY(mpsi_as(domain->context, function, mps_particles_view(particles, c->names[k], &view)));
  return MPS_OK;
}

static mps_status pack(mps_domain *domain, const char *function, mps_particles *particles,
                       const choice *chosen, char **out, int64_t *bytes) {
  const int32_t all = mps_particles_field_count(particles);
  mpsi_rows_head h = mpsi_rows_head_of(particles, domain->def.rank);
  h.fields = 0; /* of those chosen */
  mps_particles_field_info info;
  mps_view view;
  mps_status status = check_choice(domain, function, particles, chosen);
  *bytes = (int64_t)sizeof h + h.runs * (int64_t)sizeof(mpsi_row_run);
  for (int32_t f = 0; status == MPS_OK && f < all; f++) {
    status = mpsi_as(domain->context, function, mps_particles_get_field_info(particles, f, &info));
    if (status != MPS_OK || !is_chosen(chosen, f, info.name)) continue;
    h.fields++;
    *bytes += (int64_t)sizeof(mpsi_field_head) + info.components * h.particles * 8;
  }
  if (status != MPS_OK) return status;
  char *at = *out = mpsi_alloc(domain->context, *bytes, 1);
  if (!at) return mpsi_fail_memory(domain->context, function, (size_t)*bytes);
  memcpy(at, &h, sizeof h);
  at += sizeof h;
  mpsi_particles_runs(particles, domain->def.rank, (mpsi_row_run *)at);
  at += h.runs * (int64_t)sizeof(mpsi_row_run);
  for (int32_t f = 0; status == MPS_OK && f < all; f++) {
    status = mpsi_as(domain->context, function, mps_particles_get_field_info(particles, f, &info));
    if (status == MPS_OK && !is_chosen(chosen, f, info.name)) continue;
    if (status == MPS_OK)
      status = mpsi_as(domain->context, function, mps_particles_view(particles, info.name, &view));
    if (status != MPS_OK) return status;
    const mpsi_field_head field = mpsi_field_head_of(&info);
    memcpy(at, &field, sizeof field);
    at += sizeof field;
    for (int32_t c = 0; c < info.components; c++, at += 8 * h.particles)
      memcpy(at, (const char *)view.data + 8 * c * view.stride[1], (size_t)h.particles * 8);
  }
  return status;
}

/* ---- rank 0 ---------------------------------------------------------------------------------- */

/* The parts of one rank's message. */
typedef struct share {
  mpsi_rows_head h;
  const mpsi_row_run *run;
  const int64_t *id;
  const char *field; /* the next field's head */
} share;

/* A run of rows of one rank; the whole set consists of these, sorted. */
typedef struct piece {
  mpsi_row_run run;
  int32_t rank, number; /* of the piece, counted rank by rank */
  int64_t first;        /* its first row among those of the rank */
} piece;

/* Rank 0: the messages of all ranks, and the set made from them. */
typedef struct assembly {
  mps_domain *domain;
  const char *function;
  const mpsi_mailbox *box;
  share *share;
  piece *piece;
  int64_t pieces;
  int32_t *owner; /* by id: the rank whose copy counts, -1: none has it */
  int64_t ids, count;
  mps_snapshot whole;
} assembly;

static bool open_shares(assembly *a) {
  a->share = mpsi_alloc(a->domain->context, a->box->count, sizeof *a->share);
  if (!a->share) return false;
  for (int32_t r = 0; r < a->box->count; r++) {
    share *s = &a->share[r];
    memcpy(&s->h, a->box->mail[r].data, sizeof s->h);
    s->run = (const mpsi_row_run *)((const char *)a->box->mail[r].data + sizeof s->h);
    s->field = (const char *)(s->run + s->h.runs);
    s->id =
        (const int64_t *)(s->field + sizeof(mpsi_field_head)); /* the first field of every set */
    a->pieces += s->h.runs;
    if (s->h.made > a->ids) a->ids = s->h.made;
  }
  return true;
}

static int by_place(const void *left, const void *right) {
  const piece *a = left, *b = right;
  const int order = mpsi_row_run_order(&a->run, &b->run);
  return order ? order : a->number < b->number ? -1 : a->number > b->number;
}

static bool list_pieces(assembly *a) {
  a->piece = mpsi_alloc(a->domain->context, a->pieces, sizeof *a->piece);
  if (!a->piece) return false;
  int32_t number = 0;
  for (int32_t r = 0; r < a->box->count; r++) {
    int64_t first = 0;
    for (int64_t k = 0; k < a->share[r].h.runs; k++) {
      const mpsi_row_run run = a->share[r].run[k];
      a->piece[number] = (piece){.run = run, .rank = r, .number = number, .first = first};
      number++;
      first += run.rows;
    }
  }
  qsort(a->piece, (size_t)a->pieces, sizeof *a->piece, by_place);
  return true;
}

static bool find_owners(assembly *a) {
  a->owner = mpsi_alloc(a->domain->context, a->ids, sizeof *a->owner);
  if (!a->owner) return false;
  for (int64_t id = 0; id < a->ids; id++) a->owner[id] = -1;
  for (int32_t r = 0; r < a->box->count; r++)
    for (int64_t k = 0; k < a->share[r].h.particles; k++) {
      int32_t *owner = &a->owner[a->share[r].id[k]];
      a->count += *owner < 0;
      *owner = r;
    }
  return true;
}

/* Copies the rows of a piece that this rank owns to `to`, from `row` on; returns their number. */
static int64_t put_piece(const assembly *a, const piece *p, mpsi_value *to, int64_t row) {
  const share *s = &a->share[p->rank];
  const char *data = s->field + sizeof(mpsi_field_head);
  int64_t kept = 0;
  for (int64_t k = p->first; k < p->first + p->run.rows; k++) {
    if (a->owner[s->id[k]] != p->rank) continue;
    for (int32_t c = 0; c < to->columns; c++)
      memcpy((char *)to->data + 8 * (c * a->count + row + kept),
             data + 8 * (c * s->h.particles + k), 8);
    kept++;
  }
  return kept;
}

/* Assembles the columns of field `f` of all ranks. */
static mps_status assemble_field(assembly *a, int32_t f) {
  mps_context *context = a->domain->context;
  mpsi_value *to = &a->whole.fields.item[f];
  mpsi_field_head first;
  memcpy(&first, a->share[0].field, sizeof first);
  memcpy(to->name, first.name, sizeof to->name);
  to->type = first.integer ? MPSI_STATE_I64 : MPSI_STATE_F64;
  to->columns = (int32_t)first.columns;
  to->rows = a->count;
  if (!mpsi_value_reserve(context, to, to->type, a->count, to->columns))
    return mpsi_fail_memory(context, a->function, (size_t)(a->count * to->columns) * 8);
  for (int32_t r = 0; r < a->box->count; r++) {
    const share *s = &a->share[r];
    mpsi_field_head own;
    memcpy(&own, s->field, sizeof own);
    if (memcmp(&own, &first, sizeof own) != 0)
      return mpsi_fail(context, a->function, MPS_ERROR_FIELD,
                       "field %d is '%.90s' on rank 0 and '%.90s' on rank %d: all ranks must have "
                       "the same fields",
                       f, first.name, own.name, (int)r);
  }
  int64_t row = 0;
  for (int64_t p = 0; p < a->pieces; p++) row += put_piece(a, &a->piece[p], to, row);
  for (int32_t r = 0; r < a->box->count; r++) {
    share *s = &a->share[r];
    s->field += (int64_t)sizeof first + 8 * s->h.particles * to->columns;
  }
  return MPS_OK;
}

static mps_status assemble(assembly *a) {
  mps_context *context = a->domain->context;
  for (int32_t r = 1; r < a->box->count; r++)
    if (a->share[r].h.fields != a->share[0].h.fields || a->share[r].h.dim != a->share[0].h.dim ||
        a->share[r].h.spacing != a->share[0].h.spacing)
      return mpsi_fail(context, a->function, MPS_ERROR_FIELD,
                       "the set has %lld fields, dim %lld and spacing %g m on rank 0 and %lld, "
                       "%lld and %g m on rank %d: all ranks must have the same",
                       (long long)a->share[0].h.fields, (long long)a->share[0].h.dim,
                       a->share[0].h.spacing, (long long)a->share[r].h.fields,
                       (long long)a->share[r].h.dim, a->share[r].h.spacing, (int)r);
  const int32_t fields = (int32_t)a->share[0].h.fields;
  a->whole.particles = a->count;
  if (!mpsi_values_reserve(context, &a->whole.fields, fields) ||
      !mpsi_values_reserve(context, &a->whole.state, 1) ||
      !mpsi_value_reserve(context, &a->whole.state.item[0], MPSI_STATE_I64, 1, 1))
    return mpsi_fail_memory(context, a->function, (size_t)fields * sizeof(mpsi_value));
  mpsi_particles_name_next_id(&a->whole.state.item[0], a->ids);
  a->whole.state.count = 1;
  mps_status status = MPS_OK;
  for (int32_t f = 0; f < fields && status == MPS_OK; f++) {
    status = assemble_field(a, f);
    a->whole.fields.count = f + 1;
  }
  return status;
}

/* Creates the set where *whole is NULL; else replaces its contents. */
static mps_status put(assembly *a, mps_particles **whole) {
  mps_particles_def def = mps_particles_defaults();
  mps_particles *set = *whole;
  void *scratch = NULL;
  def.dim = (int32_t)a->share[0].h.dim;
  def.spacing = a->share[0].h.spacing;
  mps_status status = set ? MPS_OK
                          : mpsi_as(a->domain->context, a->function,
                                    mps_particles_create(a->domain->context, &def, &set));
  if (status == MPS_OK)
    status = mpsi_particles_prepare_state(set, a->function, &a->whole, &scratch);
  if (status == MPS_OK) {
    mpsi_particles_put_state(set, &a->whole, scratch);
    mpsi_particles_take_next_id(set, &a->whole);
  }
  if (status != MPS_OK && !*whole) mps_particles_destroy(&set);
  if (status == MPS_OK) *whole = set;
  return status;
}

static mps_status make_whole(mps_domain *domain, const char *function, const mpsi_mailbox *box,
                             mps_particles **whole) {
  mps_context *context = domain->context;
  assembly a = {.domain = domain, .function = function, .box = box, .whole.context = context};
  mps_status status = MPS_OK;
  if (!open_shares(&a) || !list_pieces(&a) || !find_owners(&a))
    status = mpsi_fail_memory(context, function, (size_t)a.ids * sizeof *a.owner);
  if (status == MPS_OK) status = assemble(&a);
  if (status == MPS_OK) status = put(&a, whole);
  mpsi_values_free(context, &a.whole.fields);
  mpsi_values_free(context, &a.whole.state);
  MPSI_FREE(context, a.owner, a.piece, a.share);
  return status;
}

/* Every rank, the first too, sends its particles to rank 0. */
static mps_status send_to_first(mps_domain *domain, const char *function, char *data, int64_t bytes,
                                mpsi_mailbox *box) {
  const mps_domain_message message = {.rank = 0, .bytes = bytes, .data = data};
  return mpsi_domain_exchange(domain, function, 1, &message, box);
}

static mps_status gather(mps_domain *domain, const char *function, mps_particles *particles,
                         const choice *chosen, mps_particles **whole) {
  mps_context *context = domain->context;
  mpsi_mailbox box = {.context = context};
  char *data = NULL;
  int64_t bytes = 0;
  mps_status status = MPS_OK;
  if (!particles || !whole)
    status = mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "%s is NULL",
                       particles ? "whole" : "particles");
  else if (*whole == particles)
    status = mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "whole is the set that is to be gathered: give another, or NULL");
  else if (mpsi_particles_context(particles) != context)
    status = mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "the particle set was made from another context than the domain");
  else
    status = mpsi_particles_committed(particles, function);
  if (status == MPS_OK) status = pack(domain, function, particles, chosen, &data, &bytes);
  status = mpsi_domain_agree(domain, function, status);
  if (status == MPS_OK) status = send_to_first(domain, function, data, bytes, &box);
  mpsi_free(context, data);
  if (status == MPS_OK && domain->def.rank == 0) status = make_whole(domain, function, &box, whole);
  mpsi_domain_free_mail(&box);
  return mpsi_domain_agree(domain, function, status);
}

mps_status mps_domain_gather_fields(mps_domain *domain, mps_particles *particles, int64_t count,
                                    const char *const *names, mps_particles **whole) {
  const choice chosen = {.count = count, .names = names};
  return domain ? gather(domain, __func__, particles, &chosen, whole)
                : mpsi_null(__func__, "domain");
}

/* ---- rows of a solver's state ---------------------------------------------------------------- */

mps_status mpsi_domain_gather_rows(mps_domain *domain, const char *function, int64_t rows,
                                   mpsi_value *value) {
  const int64_t row = value->columns * mpsi_state_size(value->type);
  const mps_domain_message message = {.rank = 0, .bytes = rows * row, .data = value->data};
  mpsi_mailbox box;
  mps_status status = mpsi_domain_exchange(domain, function, 1, &message, &box);
  if (status == MPS_OK && mps_domain_rank(domain) == 0) {
    int64_t all = 0;
    for (int32_t k = 0; k < box.count; k++) all += box.mail[k].bytes / row;
    if (!mpsi_value_reserve(domain->context, value, value->type, all, value->columns))
      status = mpsi_fail_memory(domain->context, function, (size_t)(all * row));
    char *to = value->data;
    for (int32_t k = 0; status == MPS_OK && k < box.count; to += box.mail[k++].bytes)
      memcpy(to, box.mail[k].data, (size_t)box.mail[k].bytes);
    if (status == MPS_OK) value->rows = all;
  }
  mpsi_domain_free_mail(&box);
  return mpsi_domain_agree(domain, function, status);
}
