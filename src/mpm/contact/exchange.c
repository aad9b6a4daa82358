/* exchange.c - see exchange.h. A message has one entry for each block of cells with constraints or
 * areas: its head; the nodes that the constraints use, each once; the constraints, each followed by
 * the numbers of its nodes in that list and by its weights, one or (in blocks at mirrors or with
 * listed particles) three a node; and the areas that its particles represent (area.c).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "exchange.h"
#include "mpm/boundary/mirror.h"
#include "mpm/contact/pairs.h"
#include "mpm/ranks/partition.h"

#include "mpm/base/kernels.h"

#include <stdlib.h>
#include <string.h>

#define UNDER (2 * MPSI_SIDE)          /* nodes an axis of the whole blocks under a tile */
#define PLACES (UNDER * UNDER * UNDER) /* index from which on values across thin bodies follow */

typedef struct head {
  int32_t at[3];              /* coordinates of the block of cells */
  int32_t colour;             /* colour of the block: the order of the sweeps */
  int64_t cells;              /* index of the block on its own rank */
  int64_t bytes;              /* length of the entry */
  int64_t nodes, constraints; /* contacts and groups */
  int64_t groups;             /* of these */
  int64_t components;         /* components of a weight: 1, 3 */
  int64_t areas;
} head;

typedef struct named_area {
  int32_t place, body;
  double area;
  mpsi_borne borne;
} named_area;

typedef struct named_node {
  int64_t place; /* index under the tile; see PLACES */
  double value[4];
} named_node;

/* ---- writing messages ------------------------------------------------------------------------ */

static int under_index(int i, int j, int k) { return (k * UNDER + j) * UNDER + i; }

/* Index under the tile of `cells` of a node of the grid. */
static int place_under(const mpsi_grid *grid, const mpsi_cell_block *cells, const double *node) {
  const int64_t number = (node - (const double *)grid->node) / 4;
  const int64_t block = number / grid->block_nodes;
  const bool across = block >= grid->node_count;
  int q = 0, at[3];
  while ((across ? grid->nodes[cells->to[q]].across : cells->to[q]) != block) q++;
  mpsi_unravel((int)(number % grid->block_nodes), MPSI_SIDE, at);
  return (across ? PLACES : 0) + under_index(at[0] + MPSI_SIDE * (q & 1),
                                             at[1] + MPSI_SIDE * (q >> 1 & 1),
                                             at[2] + MPSI_SIDE * (q >> 2));
}

static int64_t index_bytes(int64_t nodes) { return (nodes + 1) / 2 * 8; }

/* Upper limit of the length of an entry. `block`: NULL where there are areas and no constraints. */
static int64_t entry_bytes(const mpsi_grid *grid, const mpsi_contacts *contacts,
                           const mpsi_cell_block *cells, const mpsi_constraint_block *block) {
  const mpsi_impulses *all = &contacts->impulses;
  int64_t bytes = (int64_t)sizeof(head), nodes = 0;
  for (int32_t q = 0; q < cells->pairs && all->areas; q++)
    if (mpsi_has_areas(contacts->handle[contacts->cell_pair[cells->first_pair + q].body],
                       contacts->wet))
      bytes += grid->tile_nodes * (int64_t)sizeof(named_area);
  if (!block) return bytes;
  for (int64_t n = block->first; n < block->first + block->count + block->groups; n++) {
    nodes += all->constraint[n].nodes;
    bytes += (int64_t)sizeof(mpsi_constraint) + index_bytes(all->constraint[n].nodes);
  }
  return bytes + nodes * (int64_t)(3 * sizeof(double) + sizeof(named_node));
}

/* Lists the nodes of the block's constraints, each once; `number`: position in that list by index
 * under the tile. */
static int64_t name_nodes(const mpsi_grid *grid, const mpsi_contacts *contacts,
                          const mpsi_constraint_block *block, int32_t *number, named_node *out) {
  const mpsi_impulses *all = &contacts->impulses;
  const mpsi_cell_block *cells = &grid->cells[block->cells];
  int64_t count = 0;
  memset(number, -1, 2 * PLACES * sizeof *number);
  for (int64_t n = block->first; n < block->first + block->count + block->groups; n++)
    for (int32_t i = 0; i < all->constraint[n].nodes; i++) {
      const double *node = all->node[n * all->stride + i];
      const int place = place_under(grid, cells, node);
      if (number[place] >= 0) continue;
      out[count].place = place;
      memcpy(out[count].value, node, sizeof out->value);
      number[place] = (int32_t)count++;
    }
  return count;
}

static char *write_constraint(const mpsi_grid *grid, const mpsi_contacts *contacts,
                              const mpsi_cell_block *cells, int64_t n, const int32_t *number,
                              int64_t components, char *to) {
  const mpsi_impulses *all = &contacts->impulses;
  const mpsi_constraint *constraint = &all->constraint[n];
  memcpy(to, constraint, sizeof *constraint);
  to += sizeof *constraint;
  int32_t *index = (int32_t *)to;
  for (int32_t i = 0; i < constraint->nodes; i++)
    index[i] = number[place_under(grid, cells, all->node[n * all->stride + i])];
  to += index_bytes(constraint->nodes);
  for (int32_t i = 0; i < constraint->nodes; i++, to += components * (int64_t)sizeof(double))
    memcpy(to, all->weight[n * all->stride + i] + MPSI_VECTOR, (size_t)components * sizeof(double));
  return to;
}

static char *write_constraints(const mpsi_grid *grid, const mpsi_contacts *contacts,
                               const mpsi_constraint_block *block, head *h, char *to) {
  const mpsi_cell_block *cells = &grid->cells[block->cells];
  int32_t *number = grid->workers[0].scratch; /* no other thread is at work */
  _Static_assert(2 * PLACES * sizeof *number <= MPSI_WORKER_SCRATCH, "scratch of a worker");
  h->nodes = name_nodes(grid, contacts, block, number, (named_node *)to);
  h->constraints = block->count + block->groups;
  h->groups = block->groups;
  to += h->nodes * (int64_t)sizeof(named_node);
  for (int64_t n = block->first; n < block->first + h->constraints; n++)
    to = write_constraint(grid, contacts, cells, n, number, h->components, to);
  return to;
}

static char *write_areas(const mpsi_grid *grid, const mpsi_columns *p,
                         const mpsi_contacts *contacts, const mpsi_cell_block *cells, head *h,
                         char *to) {
  mpsi_area *tile = grid->workers[0].scratch;
  named_area *out = (named_area *)to;
  for (int32_t q = 0; q < cells->pairs && contacts->impulses.areas; q++) {
    const mpsi_cell_pair *pair = &contacts->cell_pair[cells->first_pair + q];
    if (!mpsi_mpm_sum_areas(grid, p, contacts, pair, tile)) continue;
    for (int k = 0; k < grid->tile_nodes; k++) {
      int at[3];
      if (!(tile[k].area > 0.0)) continue;
      mpsi_unravel(k, MPSI_TILE_SIDE, at);
      out[h->areas++] =
          (named_area){under_index(at[0], at[1], at[2]), pair->body, tile[k].area, tile[k].borne};
    }
  }
  return to + h->areas * (int64_t)sizeof *out;
}

/* Writes the entry of a block of cells and returns its end; returns `to` where there is nothing to
 * send. `block`: NULL where there are areas and no constraints. */
static char *write_block(const mpsi_grid *grid, const mpsi_columns *p,
                         const mpsi_contacts *contacts, const mpsi_cell_block *cells,
                         const mpsi_constraint_block *block, char *to) {
  const int32_t *at = cells->at;
  head h = {.colour = (at[0] & 1) | (at[1] & 1) << 1 | (at[2] & 1) << 2,
            .cells = cells - grid->cells,
            .components = cells->mirrors || (block && block->groups > 0) ? 3 : 1};
  memcpy(h.at, at, sizeof h.at);
  char *end = to + sizeof h;
  if (block) end = write_constraints(grid, contacts, block, &h, end);
  end = write_areas(grid, p, contacts, cells, &h, end);
  if (h.constraints == 0 && h.areas == 0) return to;
  h.bytes = end - to;
  memcpy(to, &h, sizeof h);
  return end;
}

/* ---- reading messages ------------------------------------------------------------------------ */

/* An entry of a message; `own`: of this rank. */
typedef struct entry {
  head h;
  const char *data; /* behind the head */
  bool own;
} entry;

typedef struct exchange {
  const mpsi_contact_stage *stage;
  const char *function;
  mpsi_mailbox box;
  const char *own;
  int64_t own_bytes;
  entry *entry;
  int64_t entries, constraints, nodes; /* nodes: nodes and areas of all entries */
} exchange;

static const char *message_of(const exchange *m, int32_t k, int64_t *bytes) {
  *bytes = k < m->box.count ? m->box.mail[k].bytes : m->own_bytes;
  return k < m->box.count ? m->box.mail[k].data : m->own;
}

/* Counts the entries of all messages; lists them if there is a list. */
static void read_entries(exchange *m) {
  m->entries = m->constraints = m->nodes = 0;
  for (int32_t k = 0; k <= m->box.count; k++) {
    int64_t bytes;
    const char *at = message_of(m, k, &bytes), *end = at + bytes;
    while (at < end) {
      entry e = {.data = at + sizeof e.h, .own = k == m->box.count};
      memcpy(&e.h, at, sizeof e.h);
      if (m->entry) m->entry[m->entries] = e;
      m->entries++;
      m->constraints += e.h.constraints;
      m->nodes += e.h.nodes + e.h.areas;
      at += e.h.bytes;
    }
  }
}

/* The order of sweeps on one rank: colour by colour, as sort_colours in layout.c. */
static int by_colour(const void *left, const void *right) {
  const head *a = &((const entry *)left)->h, *b = &((const entry *)right)->h;
  if (a->colour != b->colour) return a->colour < b->colour ? -1 : 1;
  for (int c = 2; c >= 0; c--)
    if (a->at[c] != b->at[c]) return a->at[c] < b->at[c] ? -1 : 1;
  return 0;
}

static bool reserve(exchange *m, int64_t slots) {
  mps_context *context = m->stage->context;
  mpsi_impulses *all = &m->stage->contact->impulses;
  mpsi_contact_exchange *r = &m->stage->contact->exchange;
  return mpsi_room_ensure(context, &r->constraint, m->constraints, sizeof *all->constraint) &&
         mpsi_room_ensure(context, &r->block, m->entries, sizeof *all->block) &&
         mpsi_room_ensure(context, &r->weight, m->constraints * all->stride, sizeof *all->weight) &&
         mpsi_room_ensure(context, &r->node, m->constraints * all->stride, sizeof *all->node) &&
         mpsi_room_ensure(context, &r->shared, m->nodes, sizeof(mpsi_shared_node)) &&
         mpsi_room_ensure(context, &r->lookup, slots, sizeof(int32_t)) &&
         mpsi_room_ensure(context, &all->next_room, 2 * m->constraints, sizeof *all->warm) &&
         mpsi_mpm_area_room(m->stage->context, m->stage->transfer.grid, m->stage->contact,
                            m->stage->partition, m->constraints);
}

static void place_of(const int32_t *block, int place, int32_t *at) {
  at[0] = block[0] * MPSI_SIDE + place % UNDER;
  at[1] = block[1] * MPSI_SIDE + place / UNDER % UNDER;
  at[2] = block[2] * MPSI_SIDE + place / UNDER / UNDER;
}

/* Adds the areas of an entry to the shared nodes. */
static void add_areas(exchange *m, const head *h, const char *from) {
  static const double none[4] = {0.0};
  for (int64_t k = 0; k < h->areas; k++, from += sizeof(named_area)) {
    named_area named;
    int32_t at[3];
    memcpy(&named, from, sizeof named);
    place_of(h->at, named.place, at);
    mpsi_area *to = &mpsi_mpm_shared_node(&m->stage->contact->exchange, m->stage->transfer.grid, at,
                                          MPSI_SHARED_AREA + named.body, none)
                         ->area;
    mpsi_mpm_add_area(to, named.area, named.borne);
  }
}

/* Appends the constraints of an entry. */
static void append_entry(exchange *m, const entry *e, int64_t first) {
  mpsi_impulses *all = &m->stage->contact->impulses;
  const named_node *named = (const named_node *)e->data;
  const char *from = e->data + e->h.nodes * (int64_t)sizeof *named;
  const size_t components = (size_t)e->h.components;
  for (int64_t n = first; n < first + e->h.constraints; n++) {
    mpsi_constraint *constraint = &all->constraint[n];
    memcpy(constraint, from, sizeof *constraint);
    from += sizeof *constraint;
    if (!e->own) constraint->pair = constraint->particle = -1;
    const int32_t *index = (const int32_t *)from;
    from += index_bytes(constraint->nodes);
    for (int32_t i = 0; i < constraint->nodes; i++, from += components * sizeof(double)) {
      const int place = (int)named[index[i]].place % PLACES;
      const int32_t across = (int32_t)(named[index[i]].place / PLACES);
      int32_t at[3];
      place_of(e->h.at, place, at);
      double *weight = all->weight[n * all->stride + i] + MPSI_VECTOR;
      all->node[n * all->stride + i] =
          mpsi_mpm_shared_node(&m->stage->contact->exchange, m->stage->transfer.grid, at,
                               across ? MPSI_SHARED_ACROSS : MPSI_SHARED_NODE,
                               named[index[i]].value)
              ->value;
      weight[-MPSI_VECTOR] = 1.0 / named[index[i]].value[MPSI_MASS];
      memcpy(weight, from, components * sizeof(double));
      for (size_t c = components; c < 3; c++) weight[c] = weight[0];
    }
  }
  add_areas(m, &e->h, from);
}

static void append_constraints(exchange *m, int64_t slots) {
  const mpsi_contact_stage *stage = m->stage;
  mpsi_impulses *all = &stage->contact->impulses;
  mpsi_contact_exchange *r = &stage->contact->exchange;
  memset(r->lookup.item, -1, (size_t)slots * sizeof(int32_t));
  r->slots = slots;
  r->nodes = 0;
  all->constraint = r->constraint.item;
  all->block = r->block.item;
  all->weight = r->weight.item;
  all->node = r->node.item;
  all->constraint_count = all->block_count = 0;
  int32_t colour = 0;
  for (int64_t k = 0; k < m->entries; k++) {
    const entry *e = &m->entry[k];
    while (colour <= e->h.colour) all->colour[colour++] = all->block_count;
    all->block[all->block_count++] =
        (mpsi_constraint_block){.first = all->constraint_count,
                                .count = e->h.constraints - e->h.groups,
                                .groups = e->h.groups,
                                .cells = e->own ? (int32_t)e->h.cells : -1};
    memcpy(all->block[all->block_count - 1].at, e->h.at, sizeof e->h.at);
    append_entry(m, e, all->constraint_count);
    all->constraint_count += e->h.constraints;
  }
  while (colour <= MPSI_CORNERS) all->colour[colour++] = all->block_count;
  mpsi_mpm_find_areas(m->stage);
}

static mps_status join(exchange *m) {
  mps_context *context = m->stage->context;
  mpsi_contact_exchange *r = &m->stage->contact->exchange;
  int64_t slots = 16;
  m->entry = NULL;
  read_entries(m);
  while (slots < 2 * m->nodes) slots *= 2;
  if (!mpsi_room_ensure(context, &r->list, m->entries, sizeof *m->entry) || !reserve(m, slots))
    return mpsi_fail_memory(context, m->function,
                            (size_t)(m->constraints + 1) * sizeof(mpsi_constraint) +
                                (size_t)m->nodes * sizeof(mpsi_shared_node));
  m->entry = r->list.item;
  read_entries(m);
  if (m->entries > 0) qsort(m->entry, (size_t)m->entries, sizeof *m->entry, by_colour);
  append_constraints(m, slots);
  return MPS_OK;
}

/* ---- a step ---------------------------------------------------------------------------------- */

/* Constraints of a block of cells, or NULL. Called for blocks of cells in the order of the colours;
 * `next` counts those with constraints. */
static const mpsi_constraint_block *constraints_of(const mpsi_impulses *all, int32_t cells,
                                                   int64_t *next) {
  if (*next == all->block_count || all->block[*next].cells != cells) return NULL;
  return &all->block[(*next)++];
}

static bool has_entry(const mpsi_cell_block *cells, const mpsi_constraint_block *block) {
  return block || (cells->in_contact && !cells->ghost);
}

static int64_t message_bytes(const mpsi_grid *grid, const mpsi_contacts *contacts) {
  const mpsi_impulses *all = &contacts->impulses;
  int64_t bytes = 0, next = 0;
  for (int64_t i = 0; i < grid->cell_count; i++) {
    const mpsi_constraint_block *block = constraints_of(all, grid->coloured[i], &next);
    const mpsi_cell_block *cells = &grid->cells[grid->coloured[i]];
    if (has_entry(cells, block)) bytes += entry_bytes(grid, contacts, cells, block);
  }
  return bytes;
}

/* Writes the entries of the blocks that are sent to partners (`sent`), or of the others. */
static char *write_blocks(const mpsi_grid *grid, const mpsi_columns *p,
                          const mpsi_contacts *contacts, bool sent, char *to) {
  const mpsi_impulses *all = &contacts->impulses;
  int64_t next = 0;
  for (int64_t i = 0; i < grid->cell_count; i++) {
    const mpsi_constraint_block *block = constraints_of(all, grid->coloured[i], &next);
    const mpsi_cell_block *cells = &grid->cells[grid->coloured[i]];
    if (has_entry(cells, block) && cells->sent == sent)
      to = write_block(grid, p, contacts, cells, block, to);
  }
  return to;
}

/* Memory for this rank's entries, those to be sent first, and for a list of the receivers. */
static mps_status make_room_for_message(exchange *m, mps_domain_message **list) {
  const mpsi_contact_stage *stage = m->stage;
  mps_domain *domain = stage->partition->domain;
  mpsi_room *mail = &stage->contact->exchange.mail;
  const int64_t bytes = message_bytes(stage->transfer.grid, stage->contact);
  if (bytes == 0) return MPS_OK;
  *list = mpsi_alloc(stage->context, mps_domain_size(domain), sizeof **list);
  if (!*list || !mpsi_room_ensure(stage->context, mail, bytes, 1))
    return mpsi_fail_memory(stage->context, m->function, (size_t)bytes);
  return MPS_OK;
}

/* Writes this rank's entries and addresses the same message to each partner; returns their
 * number. */
static int32_t address_partners(exchange *m, mps_domain_message *list) {
  const mpsi_contact_stage *stage = m->stage;
  const mps_domain *domain = stage->partition->domain;
  int32_t count = 0;
  if (!list) return 0;
  char *own = stage->contact->exchange.mail.item;
  const int64_t bytes =
      write_blocks(stage->transfer.grid, stage->transfer.p, stage->contact, true, own) - own;
  m->own = own;
  m->own_bytes =
      write_blocks(stage->transfer.grid, stage->transfer.p, stage->contact, false, own + bytes) -
      own;
  for (int32_t r = 0; r < mps_domain_size(domain) && bytes > 0; r++)
    if (r != mps_domain_rank(domain) && mpsi_mpm_is_partner(&stage->contact->partners, r))
      list[count++] = (mps_domain_message){.rank = r, .bytes = bytes, .data = own};
  return count;
}

mps_status mpsi_mpm_exchange_contacts(const mpsi_contact_stage *stage, const char *function,
                                      mps_status status) {
  mps_domain *domain = stage->partition->domain;
  exchange m = {.stage = stage, .function = function, .box.context = stage->context};
  mps_domain_message *list = NULL;
  int64_t constraints = 0;
  if (status == MPS_OK) status = make_room_for_message(&m, &list);
  status = mpsi_mpm_find_partners(stage->contact, stage->transfer.grid, stage->partition, function,
                                  status, &constraints);
  stage->contact->exchange.nodes = 0;
  stage->contact->exchange.constraints = constraints;
  if (status == MPS_OK && constraints > 0) {
    const int32_t count = address_partners(&m, list);
    if (stage->contact->partners.any)
      status = mpsi_domain_post(domain, function, count, list, &m.box);
    if (status == MPS_OK) status = join(&m);
    status = mpsi_domain_agree(domain, function, status);
  }
  mpsi_domain_free_mail(&m.box);
  mpsi_free(stage->context, list);
  return status;
}

void mpsi_mpm_end_contact_exchange(mpsi_contacts *contacts) {
  mpsi_impulses *all = &contacts->impulses;
  mpsi_contact_exchange *r = &contacts->exchange;
  mpsi_shared_node *shared = r->shared.item;
  for (int64_t k = 0; k < r->nodes; k++)
    if (shared[k].home)
      memcpy(shared[k].home + MPSI_VECTOR, shared[k].value + MPSI_VECTOR, 3 * sizeof(double));
  for (int64_t n = 0; n < all->constraint_count; n++) /* what is read later are this rank's nodes */
    for (int32_t i = 0; i < all->constraint[n].nodes && all->constraint[n].pair >= 0; i++) {
      double **node = &all->node[n * all->stride + i];
      *node = ((mpsi_shared_node *)((char *)*node - offsetof(mpsi_shared_node, value)))->home;
    }
}

void mpsi_mpm_free_contact_exchange(mps_context *context, mpsi_contacts *contacts) {
  mpsi_contact_exchange *r = &contacts->exchange;
  MPSI_FREE(context, r->constraint.item, r->block.item, r->weight.item, r->node.item,
            r->shared.item, r->lookup.item, r->mail.item, r->list.item);
}
