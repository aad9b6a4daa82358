/* messages.c - messages between pairs of ranks by the program's transport, with lengths known to
 * the sender only. SPDX-License-Identifier: BSD-3-Clause */
#include "domain_private.h"

void mpsi_domain_free_mail(mpsi_mailbox *box) {
  for (int32_t k = 0; k < box->count; k++) mpsi_free(box->context, box->mail[k].data);
  if (box->mail) mpsi_free(box->context, box->mail);
  box->mail = NULL;
  box->count = box->room = 0;
}

static void *make_room(void *user, int32_t rank, int64_t bytes) {
  mpsi_mailbox *box = user;
  if (box->count == box->room) {
    void *list = box->mail;
    if (!mpsi_grow(box->context, &list, box->count, box->room + 16, sizeof *box->mail)) return NULL;
    box->mail = list;
    box->room += 16;
  }
  void *data = mpsi_alloc(box->context, bytes, 1);
  if (!data) return NULL;
  int32_t at = box->count++;
  for (; at > 0 && box->mail[at - 1].rank > rank; at--) box->mail[at] = box->mail[at - 1];
  box->mail[at] = (mpsi_mail){rank, bytes, data};
  return data;
}

mps_status mpsi_domain_post(mps_domain *domain, const char *function, int32_t count,
                            const mps_domain_message *messages, mpsi_mailbox *box) {
  *box = (mpsi_mailbox){.context = domain->context};
  MPSI_TRY(mpsi_domain_alive(domain, function));
  domain->calls++;
  mps_status status = domain->def.rendezvous(domain->def.user, count, messages, make_room, box);
  if (status == MPS_ERROR_MEMORY) /* no memory for a message: the others are valid */
    return mpsi_fail(domain->context, function, MPS_ERROR_MEMORY,
                     "could not allocate the messages of other ranks");
  return mpsi_domain_note(domain, function, "rendezvous", status);
}

mps_status mpsi_domain_exchange(mps_domain *domain, const char *function, int32_t count,
                                const mps_domain_message *messages, mpsi_mailbox *box) {
  mps_status status = mpsi_domain_post(domain, function, count, messages, box);
  status = mpsi_domain_agree(domain, function, status);
  if (status != MPS_OK) mpsi_domain_free_mail(box);
  return status;
}
