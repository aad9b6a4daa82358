/* halo.c - copies of particles that other ranks own: made once, filled again and again.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "domain_private.h"
#include "core/base/order.h"
#include "halo.h"

#include <stdlib.h>
#include <string.h>

struct mpsi_halo {
  mps_domain *domain;
  void *star;
  int64_t items, guests; /* own items with copies on other ranks; copies here */
  int64_t *item;         /* index of each of these items */
  int64_t first;         /* index of the first guest */
  double *out, *in;      /* [item][column] */
  int32_t columns;       /* of the copy under way */
};

/* One message to each rank that owns guests: `value` of each of them, in their order. */
static mps_status request_items(mpsi_halo *halo, const char *function, const int32_t *rank,
                                const int64_t *value, mpsi_mailbox *box) {
  mps_context *context = halo->domain->context;
  mps_domain_message *message = mpsi_alloc(context, mps_domain_size(halo->domain), sizeof *message);
  int32_t count = 0;
  for (int64_t k = 0, end; message && k < halo->guests; k = end) {
    for (end = k + 1; end < halo->guests && rank[end] == rank[k];) end++;
    message[count++] =
        (mps_domain_message){.rank = rank[k], .bytes = 8 * (end - k), .data = value + k};
  }
  mps_status status = message ? MPS_OK : mpsi_fail_memory(context, function, 24);
  status = mpsi_domain_agree(halo->domain, function, status);
  if (status == MPS_OK) status = mpsi_domain_exchange(halo->domain, function, count, message, box);
  mpsi_free(context, message);
  return status;
}

/* The items requested by other ranks, each once. */
static mps_status list_items(mpsi_halo *halo, const char *function, const mpsi_mailbox *requested) {
  mps_context *context = halo->domain->context;
  int64_t wanted = 0;
  for (int32_t k = 0; k < requested->count; k++) wanted += requested->mail[k].bytes / 8;
  halo->item = mpsi_alloc(context, wanted, sizeof *halo->item);
  if (!halo->item) return mpsi_fail_memory(context, function, (size_t)wanted * 8);
  for (int32_t k = 0; k < requested->count; k++) {
    memcpy(halo->item + halo->items, requested->mail[k].data, (size_t)requested->mail[k].bytes);
    halo->items += requested->mail[k].bytes / 8;
  }
  qsort(halo->item, (size_t)halo->items, sizeof *halo->item, mpsi_ascending);
  int64_t kept = 0;
  for (int64_t k = 0; k < halo->items; k++)
    if (k == 0 || halo->item[k] != halo->item[k - 1]) halo->item[kept++] = halo->item[k];
  halo->items = kept;
  return MPS_OK;
}

/* Index in the list of each requested item: sent back to the requesting rank. */
static mps_status answer(mpsi_halo *halo, const char *function, mpsi_mailbox *requested,
                         mpsi_mailbox *answers) {
  mps_context *context = halo->domain->context;
  mps_domain_message *message = mpsi_alloc(context, requested->count, sizeof *message);
  mps_status status = message ? MPS_OK : mpsi_fail_memory(context, function, 24);
  for (int32_t k = 0; message && k < requested->count; k++) {
    int64_t *index = requested->mail[k].data;
    for (int64_t i = 0; i < requested->mail[k].bytes / 8; i++)
      index[i] = (int64_t *)bsearch(&index[i], halo->item, (size_t)halo->items, sizeof *halo->item,
                                    mpsi_ascending) -
                 halo->item;
    message[k] = (mps_domain_message){
        .rank = requested->mail[k].rank, .bytes = requested->mail[k].bytes, .data = index};
  }
  status = mpsi_domain_agree(halo->domain, function, status);
  if (status == MPS_OK)
    status = mpsi_domain_exchange(halo->domain, function, requested->count, message, answers);
  mpsi_free(context, message);
  return status;
}

/* Guests are in order of rank, and so are the replies. */
static mps_status make_star(mpsi_halo *halo, const char *function, const int32_t *rank,
                            const mpsi_mailbox *answers, int32_t columns) {
  mps_context *context = halo->domain->context;
  int64_t *index = mpsi_alloc(context, halo->guests, sizeof *index), count = 0;
  halo->out = mpsi_alloc(context, halo->items * columns, sizeof *halo->out);
  halo->in = mpsi_alloc(context, halo->guests * columns, sizeof *halo->in);
  mps_status status = MPS_OK;
  if (!index || !halo->out || !halo->in)
    status = mpsi_fail_memory(context, function, (size_t)(halo->guests * columns) * 8);
  status = mpsi_domain_agree(halo->domain, function, status);
  for (int32_t k = 0; status == MPS_OK && k < answers->count; k++) {
    memcpy(index + count, answers->mail[k].data, (size_t)answers->mail[k].bytes);
    count += answers->mail[k].bytes / 8;
  }
  if (status == MPS_OK) {
    const mps_domain_def *def = &halo->domain->def;
    status = mpsi_domain_note(
        halo->domain, function, "star_create",
        def->star_create(def->user, halo->items, halo->guests, rank, index, &halo->star));
  }
  mpsi_free(context, index);
  return status;
}

mps_status mpsi_halo_create(mps_domain *domain, const char *function, const mpsi_halo_def *def,
                            mpsi_halo **out) {
  mps_context *context = domain->context;
  mpsi_mailbox requested = {.context = context}, answers = {.context = context};
  mpsi_halo *halo = *out = mpsi_alloc(context, 1, sizeof *halo);
  mps_status status = halo ? MPS_OK : mpsi_fail_memory(context, function, sizeof *halo);
  status = mpsi_domain_agree(domain, function, status);
  if (status == MPS_OK) {
    *halo = (mpsi_halo){.domain = domain, .guests = def->guests, .first = def->first};
    status = request_items(halo, function, def->rank, def->index, &requested);
  }
  if (status == MPS_OK)
    status = mpsi_domain_agree(domain, function, list_items(halo, function, &requested));
  if (status == MPS_OK) status = answer(halo, function, &requested, &answers);
  if (status == MPS_OK) status = make_star(halo, function, def->rank, &answers, def->columns);
  mpsi_domain_free_mail(&requested);
  mpsi_domain_free_mail(&answers);
  if (status != MPS_OK) mpsi_halo_destroy(context, out);
  return status;
}

void mpsi_halo_destroy(mps_context *context, mpsi_halo **pointer) {
  mpsi_halo *halo = *pointer;
  *pointer = NULL;
  if (!halo) return;
  if (halo->star) halo->domain->def.star_destroy(halo->domain->def.user, halo->star);
  MPSI_FREE(context, halo->item, halo->out, halo->in, halo);
}

int64_t mpsi_halo_items(const mpsi_halo *halo, const int64_t **index) {
  *index = halo->item;
  return halo->items;
}

mps_status mpsi_halo_begin_bytes(mpsi_halo *halo, const char *function, int32_t item_bytes,
                                 const void *own, void *guests) {
  const mps_domain_def *def = &halo->domain->def;
  MPSI_TRY(mpsi_domain_alive(halo->domain, function));
  halo->domain->calls++;
  return mpsi_domain_note(halo->domain, function, "star_begin",
                          def->star_begin(def->user, halo->star, item_bytes, own, guests));
}

mps_status mpsi_halo_end_bytes(mpsi_halo *halo, const char *function) {
  const mps_domain_def *def = &halo->domain->def;
  return mpsi_domain_note(halo->domain, function, "star_end", def->star_end(def->user, halo->star));
}

mps_status mpsi_halo_begin(mpsi_halo *halo, const char *function, int32_t columns,
                           double *const *column) {
  halo->columns = columns;
  for (int32_t c = 0; c < columns; c++)
    for (int64_t k = 0; k < halo->items; k++) halo->out[k * columns + c] = column[c][halo->item[k]];
  return mpsi_halo_begin_bytes(halo, function, columns * (int32_t)sizeof(double), halo->out,
                               halo->in);
}

mps_status mpsi_halo_end(mpsi_halo *halo, const char *function, double *const *column) {
  MPSI_TRY(mpsi_halo_end_bytes(halo, function));
  for (int32_t c = 0; c < halo->columns; c++)
    for (int64_t k = 0; k < halo->guests; k++)
      column[c][halo->first + k] = halo->in[k * halo->columns + c];
  return MPS_OK;
}
