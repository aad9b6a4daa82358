/* rows.c - the particles of all ranks for a file that rank 0 writes, column by column, in the order
 * of the whole set (core/state/row_source.h). No rank has more of them at once than its own and
 * PIECE_BYTES of a column: a rank sends its rows in their order, and rank 0 knows where in the
 * whole each run of them lies. A particle that several ranks have counts on the last of them.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/particles/particles_internal.h"
#include "core/state/row_source.h"
#include "core/state/state.h"
#include "domain_private.h"
#include "row_heads.h"

#include <stdlib.h>
#include <string.h>

#define PIECE_BYTES (INT64_C(1) << 18) /* of a column on its way, of all ranks together */
#define LEAST_ROWS 64                  /* of one rank in a piece */

/* ---- a rank's description of its rows: head, runs, heads of fields ------------------------- */

/* Rows of a rank that come one after the other in the whole. */
typedef struct piece {
  mpsi_row_run run;
  int32_t rank;
  int64_t number; /* of a piece in the order of ranks */
  int64_t kept;   /* of its rows */
  int64_t first;  /* in the whole */
} piece;

typedef struct stream {
  mpsi_row_source source; /* first: what the file knows of it */
  mps_domain *domain;
  const char *function;
  int64_t kept, most; /* rows of this rank that go into the file; of the rank with most */
  uint8_t *keep;      /* of each row of this rank */
  int64_t *buffer;    /* a piece of a column */
  int64_t rows;       /* of one rank in a piece */
  int32_t columns, done;
  mps_status begun;
  /* rank 0 */
  mpsi_mailbox heads;
  piece *piece;
  int64_t pieces, ids;
  int64_t *first_piece; /* of each rank, and behind the last */
  int64_t *at, *within; /* the piece of each rank that a column has come to, and the row in it */
} stream;

static mps_status describe(stream *s, char **out, int64_t *bytes) {
  mps_particles *set = s->source.set;
  const mpsi_rows_head h = mpsi_rows_head_of(set, s->domain->def.rank);
  mps_status status = MPS_OK;
  *bytes = (int64_t)sizeof h + h.runs * (int64_t)sizeof(mpsi_row_run) +
           h.fields * (int64_t)sizeof(mpsi_field_head);
  char *to = *out = mpsi_alloc(s->domain->context, *bytes, 1);
  if (!to) return mpsi_fail_memory(s->domain->context, s->function, (size_t)*bytes);
  memcpy(to, &h, sizeof h);
  to += sizeof h;
  mpsi_particles_runs(set, s->domain->def.rank, (mpsi_row_run *)to);
  to += h.runs * (int64_t)sizeof(mpsi_row_run);
  for (int32_t f = 0; f < h.fields && status == MPS_OK; f++, to += sizeof(mpsi_field_head)) {
    mps_particles_field_info info;
    status = mpsi_as(s->domain->context, s->function, mps_particles_get_field_info(set, f, &info));
    if (status != MPS_OK) break;
    const mpsi_field_head field = mpsi_field_head_of(&info);
    memcpy(to, &field, sizeof field);
    s->columns += info.components;
  }
  return status;
}

static mpsi_rows_head head_of(const stream *s, int32_t rank) {
  mpsi_rows_head h;
  memcpy(&h, s->heads.mail[rank].data, sizeof h);
  return h;
}

static const mpsi_row_run *runs_of(const stream *s, int32_t rank) {
  return (const mpsi_row_run *)((const char *)s->heads.mail[rank].data + sizeof(mpsi_rows_head));
}

/* Have all ranks the same fields? On rank 0. */
static mps_status compare(const stream *s) {
  const mpsi_rows_head first = head_of(s, 0);
  const char *fields = (const char *)(runs_of(s, 0) + first.runs);
  for (int32_t r = 1; r < s->heads.count; r++) {
    const mpsi_rows_head h = head_of(s, r);
    const char *own = (const char *)(runs_of(s, r) + h.runs);
    if (h.fields != first.fields || h.dim != first.dim || h.spacing != first.spacing)
      return mpsi_fail(s->domain->context, s->function, MPS_ERROR_FIELD,
                       "the set has %lld fields, dim %lld and spacing %g m on rank 0 and %lld, "
                       "%lld and %g m on rank %d: all ranks must have the same",
                       (long long)first.fields, (long long)first.dim, first.spacing,
                       (long long)h.fields, (long long)h.dim, h.spacing, (int)r);
    for (int64_t f = 0; f < h.fields; f++) {
      const char *a = fields + f * (int64_t)sizeof(mpsi_field_head),
                 *b = own + f * (int64_t)sizeof(mpsi_field_head);
      if (memcmp(a, b, sizeof(mpsi_field_head)) == 0) continue;
      return mpsi_fail(s->domain->context, s->function, MPS_ERROR_FIELD,
                       "field %lld is '%.90s' on rank 0 and '%.90s' on rank %d: all ranks must "
                       "have the same fields",
                       (long long)f, a, b, (int)r);
    }
  }
  return MPS_OK;
}

static mps_status list_pieces(stream *s) {
  const int32_t ranks = s->heads.count;
  mps_context *context = s->domain->context;
  for (int32_t r = 0; r < ranks; r++) {
    const mpsi_rows_head h = head_of(s, r);
    s->pieces += h.runs;
    if (h.made > s->ids) s->ids = h.made;
  }
  s->piece = mpsi_alloc(context, s->pieces, sizeof *s->piece);
  s->first_piece = mpsi_alloc(context, 3 * (int64_t)ranks + 1, sizeof *s->first_piece);
  if (!s->piece || !s->first_piece)
    return mpsi_fail_memory(context, s->function, (size_t)s->pieces * sizeof *s->piece);
  s->at = s->first_piece + ranks + 1;
  s->within = s->at + ranks;
  int64_t number = 0;
  for (int32_t r = 0; r < ranks; r++) {
    s->first_piece[r] = number;
    for (int64_t k = 0; k < head_of(s, r).runs; k++, number++)
      s->piece[number] = (piece){.run = runs_of(s, r)[k], .rank = r, .number = number};
  }
  s->first_piece[ranks] = number;
  return MPS_OK;
}

/* ---- which rank's copy of a particle counts ---------------------------------------------------
 */

/* The ids of a rank: which of its rows no later rank has, to `keep`. On rank 0. */
static void keep_rows(stream *s, int32_t rank, const int64_t *id, uint8_t *seen, uint8_t *keep) {
  for (int64_t p = s->first_piece[rank]; p < s->first_piece[rank + 1]; p++)
    for (int64_t k = 0; k < s->piece[p].run.rows; k++, id++, keep++) {
      uint8_t *byte = &seen[*id / 8];
      const uint8_t bit = (uint8_t)(1u << *id % 8);
      *keep = !(*byte & bit);
      *byte |= bit;
      s->piece[p].kept += *keep;
    }
}

/* From the last rank to the first: its ids to rank 0, and back which rows are kept. */
static mps_status choose_rows(stream *s) {
  mps_domain *domain = s->domain;
  mps_context *context = domain->context;
  const int32_t ranks = domain->def.size, rank = domain->def.rank;
  const int64_t n = mps_particles_count(s->source.set);
  uint8_t *seen = rank == 0 ? mpsi_alloc(context, s->ids / 8 + 1, 1) : NULL, *answer = NULL;
  s->keep = mpsi_alloc(context, n, 1);
  mps_status status = MPS_OK;
  if (!s->keep || (rank == 0 && !seen))
    status = mpsi_fail_memory(context, s->function, (size_t)(rank == 0 ? s->ids / 8 : n));
  if (rank == 0 && seen) memset(seen, 0, (size_t)(s->ids / 8 + 1));
  status = mpsi_domain_agree(domain, s->function, status);
  for (int32_t r = ranks - 1; r >= 0 && status == MPS_OK; r--) {
    mpsi_mailbox box = {.context = context};
    const mps_domain_message ids = {
        .rank = 0, .bytes = 8 * n, .data = mpsi_particles_integers(s->source.set, "id")};
    status = mpsi_domain_exchange(domain, s->function, rank == r && n > 0, &ids, &box);
    mps_domain_message kept = {.rank = r};
    if (status == MPS_OK && box.count > 0) {
      kept.bytes = box.mail[0].bytes / 8;
      kept.data = answer = mpsi_alloc(context, kept.bytes, 1);
      if (answer) keep_rows(s, r, box.mail[0].data, seen, answer);
      if (!answer) status = mpsi_fail_memory(context, s->function, (size_t)kept.bytes);
    }
    const bool answers = box.count > 0;
    mpsi_domain_free_mail(&box);
    status = mpsi_domain_agree(domain, s->function, status);
    if (status == MPS_OK) status = mpsi_domain_exchange(domain, s->function, answers, &kept, &box);
    if (status == MPS_OK && box.count > 0) memcpy(s->keep, box.mail[0].data, (size_t)n);
    mpsi_domain_free_mail(&box);
    mpsi_free(context, answer);
    answer = NULL;
  }
  mpsi_free(context, seen);
  for (int64_t k = 0; k < n && status == MPS_OK; k++) s->kept += s->keep[k];
  return status;
}

static int by_place(const void *left, const void *right) {
  const piece *a = left, *b = right;
  const int order = mpsi_row_run_order(&a->run, &b->run);
  return order ? order : a->number < b->number ? -1 : a->number > b->number;
}

static int by_number(const void *left, const void *right) {
  const piece *a = left, *b = right;
  return a->number < b->number ? -1 : a->number > b->number;
}

static void place_pieces(stream *s) {
  if (s->pieces > 0) qsort(s->piece, (size_t)s->pieces, sizeof *s->piece, by_place);
  for (int64_t p = 0; p < s->pieces; p++) {
    s->piece[p].first = s->source.particles;
    s->source.particles += s->piece[p].kept;
  }
  if (s->pieces > 0) qsort(s->piece, (size_t)s->pieces, sizeof *s->piece, by_number);
}

/* ---- columns ----------------------------------------------------------------------------------
 */

/* The rows of rank r that have come, to where they lie. */
static bool put_rows(stream *s, int32_t r, int64_t count, const int64_t *values,
                     mpsi_put_rows_fn put, void *user) {
  bool good = true;
  while (count > 0 && good) {
    const piece *p = &s->piece[s->at[r]];
    int64_t some = p->kept - s->within[r];
    if (some == 0) {
      s->at[r]++, s->within[r] = 0;
      continue;
    }
    if (some > count) some = count;
    good = put(user, p->first + s->within[r], some, values);
    s->within[r] += some;
    values += some, count -= some;
  }
  return good;
}

/* The next kept rows of a column from row *next on, at most those of a piece; returns how many. */
static int64_t pack(const stream *s, const int64_t *values, int64_t *next) {
  const int64_t n = mps_particles_count(s->source.set);
  int64_t count = 0;
  for (; *next < n && count < s->rows; ++*next)
    if (s->keep[*next]) s->buffer[count++] = values[*next];
  return count;
}

static bool column(mpsi_row_source *source, int32_t field, int32_t component, mpsi_put_rows_fn put,
                   void *user) {
  stream *s = (stream *)source;
  mps_particles_field_info info;
  mps_view view = {0};
  bool good = true;
  int64_t next = 0;
  mpsi_mailbox box = {.context = s->domain->context};
  s->done++;
  if (source->status != MPS_OK) return false; /* on all ranks */
  if (mps_particles_get_field_info(source->set, field, &info) != MPS_OK ||
      mps_particles_view(source->set, info.name, &view) != MPS_OK)
    view.data = NULL; /* the fields have been looked at: cannot be */
  const int64_t *values =
      view.data ? (const int64_t *)view.data + component * view.stride[1] : NULL;
  for (int32_t r = 0; s->at && r < s->domain->def.size; r++)
    s->at[r] = s->first_piece[r], s->within[r] = 0;
  for (int64_t sent = 0; sent < s->most; sent += s->rows) {
    const int64_t count = values ? pack(s, values, &next) : 0;
    const mps_domain_message message = {.rank = 0, .bytes = 8 * count, .data = s->buffer};
    source->status = mpsi_domain_exchange(s->domain, s->function, count > 0, &message, &box);
    if (source->status != MPS_OK) return false;
    for (int32_t k = 0; k < box.count && good && put; k++)
      good = put_rows(s, box.mail[k].rank, box.mail[k].bytes / 8, box.mail[k].data, put, user);
    mpsi_domain_free_mail(&box);
  }
  return good;
}

static mps_status begin(mpsi_row_source *source, mps_status status) {
  stream *s = (stream *)source;
  return s->begun = mpsi_domain_agree(s->domain, s->function, status);
}

/* ---- all of it --------------------------------------------------------------------------------
 */

static mps_status open_stream(stream *s) {
  mps_domain *domain = s->domain;
  char *data = NULL;
  int64_t bytes = 0;
  mps_status status = mpsi_domain_agree(domain, s->function, describe(s, &data, &bytes));
  const mps_domain_message message = {.rank = 0, .bytes = bytes, .data = data};
  if (status == MPS_OK) status = mpsi_domain_exchange(domain, s->function, 1, &message, &s->heads);
  mpsi_free(domain->context, data);
  if (status == MPS_OK && domain->def.rank == 0) status = compare(s);
  if (status == MPS_OK && domain->def.rank == 0) status = list_pieces(s);
  status = mpsi_domain_agree(domain, s->function, status);
  if (status == MPS_OK) status = choose_rows(s);
  if (status == MPS_OK && domain->def.rank == 0) place_pieces(s);
  const int64_t share = PIECE_BYTES / 8 / domain->def.size;
  s->rows = share > LEAST_ROWS ? share : LEAST_ROWS;
  if (status == MPS_OK && !(s->buffer = mpsi_alloc(domain->context, s->rows, 8)))
    status = mpsi_fail_memory(domain->context, s->function, (size_t)s->rows * 8);
  double most = (double)s->kept;
  status = mpsi_domain_agree_max(domain, s->function, status, 1, &most);
  s->most = (int64_t)most;
  return status;
}

/* The columns that this rank has not requested: all but rank 0 only send. */
static void send_rest(stream *s) {
  int32_t before = 0;
  for (int32_t f = 0; f < mps_particles_field_count(s->source.set); f++) {
    mps_particles_field_info info;
    if (mps_particles_get_field_info(s->source.set, f, &info) != MPS_OK) return;
    for (int32_t c = 0; c < info.components; c++, before++)
      if (before == s->done) (void)column(&s->source, f, c, NULL, NULL);
  }
}

mps_status mpsi_domain_write_rows(mps_domain *domain, const char *function,
                                  mps_particles *particles, mpsi_take_rows_fn *take, void *user) {
  stream s = {.source = {.set = particles, .begin = begin, .column = column},
              .domain = domain,
              .function = function,
              .heads.context = domain->context,
              .begun = MPS_ERROR_STATE};
  mps_status status = open_stream(&s);
  if (status == MPS_OK) {
    status = domain->def.rank == 0 ? take(user, &s.source) : begin(&s.source, MPS_OK);
    if (s.begun == MPS_OK) send_rest(&s);
    if (status == MPS_OK) status = s.source.status;
    status = mpsi_domain_agree(domain, function, status);
  }
  mpsi_domain_free_mail(&s.heads);
  MPSI_FREE(domain->context, s.keep, s.buffer, s.piece, s.first_piece);
  return status;
}
