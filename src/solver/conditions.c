/* conditions.c - boundaries and loads by number, of all solvers (conditions.h, mps/solver.h).
 *
 * Ranks agree twice on a definition: that it is the same on all of them, before it selects, and
 * after, since each may have a part of what is selected.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "solver_base.h"

#include "core/context/retain.h"
#include "domain/domain_internal.h"

#include <string.h>

/* ---- members of a definition ----------------------------------------------------------------- */

static const mpsi_def_member *find_member(const mpsi_condition_kind *kind, const char *name) {
  return mpsi_member_find(kind->definition, name);
}

static void *place(const mpsi_condition_kind *kind, const void *def, const char *name) {
  return (char *)def + find_member(kind, name)->offset;
}

#define LISTS(k, kind)                                                                             \
  int32_t k = 0;                                                                                   \
  k < MPSI_CONDITION_MOST_LISTS && (kind)->list[k].member;                                         \
  k++

/* The pointer to list k. */
static void **list_of(const mpsi_condition_kind *kind, const void *def, int32_t k) {
  return place(kind, def, kind->list[k].member);
}

/* Bytes of list k; 0 without one. */
static size_t bytes_of(const mpsi_condition_kind *kind, const void *def, int32_t k) {
  const mpsi_condition_list *list = &kind->list[k];
  const int64_t count = *(int64_t *)place(kind, def, list->count);
  const int32_t each = kind->each ? kind->each(def, k) : list->each;
  return *list_of(kind, def, k) && count > 0 ? (size_t)(each * count) * sizeof(double) : 0;
}

static mps_signal **signals_of(const mpsi_condition_kind *kind, const void *def, int32_t *count) {
  *count = find_member(kind, "signal")->count;
  return place(kind, def, "signal");
}

static void drop_def(mps_context *context, const mpsi_condition_kind *kind, void *def) {
  int32_t count;
  mps_signal **signal = signals_of(kind, def, &count);
  for (int32_t c = 0; c < count; c++) mps_signal_destroy(&signal[c]);
  for (LISTS(k, kind)) mpsi_free(context, *list_of(kind, def, k));
  mpsi_free(context, def);
}

/* A copy of a definition with lists of its own and shares in the signals; NULL: no memory. */
static void *copy_def(mps_context *context, const mpsi_condition_kind *kind, const void *def) {
  void *copy = mpsi_alloc(context, 1, kind->definition->size);
  bool good = true;
  int32_t count;
  if (!copy) return NULL;
  memcpy(copy, def, kind->definition->size);
  mps_signal **signal = signals_of(kind, copy, &count);
  for (int32_t c = 0; c < count; c++)
    if (signal[c]) (void)mpsi_signal_retain(signal[c]);
  for (LISTS(k, kind)) {
    const size_t bytes = bytes_of(kind, def, k);
    void *list = *list_of(kind, copy, k) = bytes > 0 && good ? mpsi_alloc(context, 1, bytes) : NULL;
    if (list) memcpy(list, *list_of(kind, def, k), bytes);
    good = good && (list || bytes == 0);
  }
  if (good) return copy;
  drop_def(context, kind, copy);
  return NULL;
}

/* All of a definition that ranks have to have alike. */
static void give(const mpsi_condition_kind *kind, const void *def, mpsi_given *list) {
  int32_t count;
  mps_signal *const *signal = signals_of(kind, def, &count);
  const mpsi_definition *d = kind->definition;
  for (const mpsi_def_member *m = d->member; m < d->member + d->count; m++)
    for (int32_t c = 0; m->type <= MPSI_MEMBER_REAL && c < m->count; c++)
      mpsi_give_member(list, m, def, c);
  for (LISTS(k, kind))
    mpsi_give_bytes(list, kind->list[k].member, *list_of(kind, def, k), bytes_of(kind, def, k));
  for (int32_t c = 0; c < count; c++) mpsi_signal_give(list, "a hash of signal", signal[c]);
}

/* ---- reading a definition -------------------------------------------------------------------- */

static mps_status read(mps_solver *s, const char *function, const mpsi_condition_kind *kind,
                       int32_t number, const void *user, void *known) {
  mps_status status = mpsi_def_read(s->context, function, kind->definition, user, true,
                                    mpsi_scene_of(mps_particles_dim(s->particles)), known);
  int32_t count;
  mps_signal *const *signal = signals_of(kind, known, &count);
  if (status == MPS_OK) status = mpsi_signal_check(s->context, function, kind->role, count, signal);
  if (status == MPS_OK && kind->check) status = kind->check(s, function, number, known);
  return status;
}

/* ---- selection ------------------------------------------------------------------------------- */

static const char *items_of(const mpsi_condition_kind *kind, const void *def) {
  return kind->items ? kind->items(def) : "particle";
}

static mpsi_selection selection_of(const mps_solver *s, const mpsi_condition_kind *kind,
                                   const void *def) {
  return (mpsi_selection){.ids = *(int64_t **)place(kind, def, "ids"),
                          .id_count = *(int64_t *)place(kind, def, "id_count"),
                          .lower = place(kind, def, "lower"),
                          .upper = place(kind, def, "upper"),
                          .all = *(int32_t *)place(kind, def, "all"),
                          .dim = mps_particles_dim(s->particles)};
}

static bool take_item(const mps_solver *s, const mpsi_condition_kind *kind, const void *def,
                      int64_t k, double x[3], int64_t *id) {
  if (kind->item) return kind->item(s, def, k, x, id);
  if (k >= mps_particles_count(s->particles)) return false;
  for (int c = 0; c < mps_particles_dim(s->particles); c++)
    x[c] = mpsi_particles_column(s->particles, "position", c)[k];
  *id = mpsi_particles_integers(s->particles, "id")[k];
  return true;
}

static mps_status check_ids(mps_solver *s, const char *function, const mpsi_condition_kind *kind,
                            const void *def, const mpsi_selection *selection) {
  if (kind->check_ids)
    return kind->check_ids(s, function, def, selection->id_count, selection->ids);
  if (kind->some || mpsi_domain_many(s->domain)) return MPS_OK; /* or they are of another rank */
  return mpsi_particles_check_ids(s->particles, function, selection->id_count, selection->ids);
}

/* Lists with a value for each id need ids. */
static mps_status check_by_box(mps_solver *s, const char *function, const mpsi_condition_kind *kind,
                               const void *def) {
  for (LISTS(k, kind))
    if (*list_of(kind, def, k))
      return mpsi_fail(s->context, function, MPS_ERROR_ARGUMENT,
                       "%s given without ids: it has values for each of them",
                       kind->list[k].member);
  return MPS_OK;
}

/* Reads what the definition selects, before it is copied. */
static mps_status check_selection(mps_solver *s, const char *function,
                                  const mpsi_condition_kind *kind, const void *def,
                                  mpsi_selected *by, mpsi_selection_box *box) {
  const mpsi_selection selection = selection_of(s, kind, def);
  MPSI_TRY(mpsi_selection_read(s->context, function, &selection, by, box));
  if (*by != MPSI_SELECTED_IDS) return check_by_box(s, function, kind, def);
  return check_ids(s, function, kind, def, &selection);
}

/* Replaces a box, or all, by the ids of the items in it. */
static mps_status list_items(mps_solver *s, const char *function, const mpsi_condition_kind *kind,
                             const mpsi_selection_box *box, void *def) {
  const int dim = mps_particles_dim(s->particles);
  double x[3] = {0.0, 0.0, 0.0};
  int64_t count = 0, id;
  for (int64_t k = 0; take_item(s, kind, def, k, x, &id); k++)
    count += mpsi_selection_contains(box, dim, x);
  int64_t *ids = mpsi_alloc(s->context, count, sizeof *ids);
  if (!ids) return mpsi_fail_memory(s->context, function, (size_t)count * sizeof *ids);
  count = 0;
  for (int64_t k = 0; take_item(s, kind, def, k, x, &id); k++)
    if (mpsi_selection_contains(box, dim, x)) ids[count++] = id;
  *(int64_t **)place(kind, def, "ids") = ids;
  *(int64_t *)place(kind, def, "id_count") = count;
  *(int32_t *)place(kind, def, "all") = 0;
  for (int c = 0; c < 3; c++)
    ((double *)place(kind, def, "lower"))[c] = ((double *)place(kind, def, "upper"))[c] = NAN;
  return MPS_OK;
}

/* What a definition under way selects. */
typedef struct choice {
  mpsi_selected by;
  mpsi_selection_box box;
  bool kept;           /* as it is */
  int64_t given;       /* ids in the list */
  int64_t here, found; /* selected, of these counted by this rank */
} choice;

static mps_status choose(mps_solver *s, const char *function, const mpsi_condition_kind *kind,
                         choice *c, void *def) {
  mps_status status = MPS_OK;
  c->kept = c->by != MPSI_SELECTED_IDS && kind->keeps && kind->keeps(def, c->by);
  if (c->kept) return MPS_OK;
  if (c->by != MPSI_SELECTED_IDS) status = list_items(s, function, kind, &c->box, def);
  const mpsi_selection now = selection_of(s, kind, def);
  c->given = c->here = now.id_count;
  for (int64_t k = 0; kind->counts && status == MPS_OK && k < now.id_count; k++)
    c->found += kind->counts(s, now.ids[k]);
  return status;
}

/* Whether there is what the definition selects, on any rank. */
static mps_status check_choice(mps_solver *s, const char *function, const mpsi_condition_kind *kind,
                               const choice *c, const mpsi_selection *as_given, const char *items) {
  int64_t found[2] = {c->found, mps_particles_count(s->particles)};
  if (c->kept || c->by == MPSI_SELECTED_NONE) return MPS_OK;
  if (!kind->counts)
    return mpsi_selection_check_count(s->context, function, as_given, items, c->here);
  MPSI_TRY(mpsi_domain_sum(s->domain, function, 2, found));
  if (mpsi_domain_many(s->domain) && c->by == MPSI_SELECTED_IDS && c->given > found[1])
    return mpsi_fail(s->context, function, MPS_ERROR_ARGUMENT,
                     "id_count is %lld, allowed are 1 to %lld particles", (long long)c->given,
                     (long long)found[1]);
  if (c->by == MPSI_SELECTED_IDS && !kind->some && found[0] != c->given)
    return mpsi_fail(s->context, function, MPS_ERROR_ARGUMENT,
                     "of %lld ids %lld are of particles of the set on any rank",
                     (long long)c->given, (long long)found[0]);
  return mpsi_selection_check_count(s->context, function, as_given, items, found[0]);
}

/* ---- numbers --------------------------------------------------------------------------------- */

static mpsi_conditions *find_list(const mps_solver *s, int32_t kind) {
  mpsi_conditions *list = (mpsi_conditions *)s->conditions;
  if (kind == MPS_DEF_BOUNDARY) return &list[MPSI_BOUNDARIES];
  if (kind == MPS_DEF_LOAD) return &list[MPSI_LOADS];
  for (int k = 0; k < MPSI_CONDITION_LISTS; k++)
    if (list[k].kind->kind == kind) return &list[k];
  return NULL;
}

static mps_status fail_kind(const mps_solver *s, const char *function, int32_t kind) {
  return mpsi_fail(s->context, function, MPS_ERROR_ARGUMENT,
                   "kind is %s, this solver has %s and %s", mpsi_name_of("mps_def_kind", kind).text,
                   mpsi_name_of("mps_def_kind", s->conditions[0].kind->kind).text,
                   mpsi_name_of("mps_def_kind", s->conditions[1].kind->kind).text);
}

static bool is_there(const mps_solver *s, const mpsi_conditions *list, int32_t number) {
  if (number >= 0 && number < list->kind->first)
    return list->kind->has && list->kind->has(s, number);
  return number >= 0 && number < list->capacity && list->def[number];
}

static mps_status check_number(const mps_solver *s, const char *function,
                               const mpsi_conditions *list, int32_t number) {
  if (is_there(s, list, number)) return MPS_OK;
  return mpsi_fail(s->context, function, MPS_ERROR_ARGUMENT,
                   "number is %d: there is no %s of this number", number, list->kind->what);
}

/* Room for `number` in the list. */
static mps_status reserve(mps_solver *s, const char *function, mpsi_conditions *list,
                          int32_t number) {
  const int32_t capacity = number + 8;
  if (number < list->capacity) return MPS_OK;
  void **def = mpsi_alloc(s->context, capacity, sizeof *def);
  void **own = def ? mpsi_alloc(s->context, capacity, sizeof *own) : NULL;
  if (!own) {
    mpsi_free(s->context, def);
    return mpsi_fail_memory(s->context, function, (size_t)capacity * sizeof *def);
  }
  for (int32_t k = 0; k < list->capacity; k++) def[k] = list->def[k], own[k] = list->own[k];
  MPSI_FREE(s->context, list->def, list->own);
  list->def = def, list->own = own, list->capacity = capacity;
  return MPS_OK;
}

/* The lowest free number, with room for it. */
static mps_status find_number(mps_solver *s, const char *function, mpsi_conditions *list,
                              int32_t *number) {
  int32_t at = list->kind->first;
  while (at < list->capacity && list->def[at]) at++;
  *number = at;
  if (at >= list->kind->most)
    return mpsi_fail(s->context, function, MPS_ERROR_ARGUMENT,
                     "there are %d numbers for a %s, and all are taken: remove one first",
                     list->kind->most - list->kind->first, list->kind->what);
  return reserve(s, function, list, at);
}

/* ---- a condition under way ------------------------------------------------------------------- */

static void drop_own(mps_solver *s, const mpsi_condition_kind *kind, void *own) {
  if (own && kind->drop) kind->drop(s, own);
  mpsi_free(s->context, own);
}

/* Makes the condition of a definition, on all ranks or on none. */
static mps_status make(mps_solver *s, const char *function, const mpsi_condition_kind *kind,
                       mps_status status, int32_t number, const void *user, void **out_def,
                       void **out_own) {
  union {
    double align;
    char bytes[MPSI_STRUCT_MOST];
  } known;
  choice c = {.by = MPSI_SELECTED_NONE};
  void *def = NULL, *own = NULL;
  mpsi_selection as_given = {.dim = 0};
  if (status == MPS_OK) status = read(s, function, kind, number, user, &known);
  const bool selects = status == MPS_OK && kind->selects && number >= kind->first;
  if (selects) status = check_selection(s, function, kind, &known, &c.by, &c.box);
  if (selects) as_given = selection_of(s, kind, &known);
  mpsi_given given = MPSI_GIVEN;
  mpsi_give(&given, "number", number);
  if (status == MPS_OK && mpsi_domain_many(s->domain)) give(kind, &known, &given);
  status = mpsi_domain_agree_given(s->domain, function, status, &given);
  if (status != MPS_OK) return status;
  const size_t bytes = kind->definition->size + kind->size;
  if (!(def = copy_def(s->context, kind, &known)) || !(own = mpsi_alloc(s->context, 1, kind->size)))
    status = mpsi_fail_memory(s->context, function, bytes);
  if (status == MPS_OK && selects) status = choose(s, function, kind, &c, def);
  if (status == MPS_OK) status = kind->make(s, function, number, def, own);
  status = mpsi_domain_agree(s->domain, function, status);
  if (status == MPS_OK)
    status = check_choice(s, function, kind, &c, &as_given, items_of(kind, def));
  if (status != MPS_OK) {
    drop_own(s, kind, own);
    if (def) drop_def(s->context, kind, def);
    return status;
  }
  *out_def = def, *out_own = own;
  return MPS_OK;
}

/* Makes a condition and puts it in the place of that which has its number, if any. */
static mps_status put(mps_solver *s, const char *function, mpsi_conditions *list, mps_status status,
                      int32_t number, const void *user) {
  const mpsi_condition_kind *kind = list->kind;
  void *def, *own;
  status = make(s, function, kind, status, number, user, &def, &own);
  if (status != MPS_OK) return status;
  void *const former = list->own[number], *const former_def = list->def[number];
  if (kind->apply) status = kind->apply(s, function, number, def, own, former);
  if (status == MPS_OK) {
    list->def[number] = def, list->own[number] = own;
    def = former_def, own = former;
  }
  drop_own(s, kind, own);
  if (def) drop_def(s->context, kind, def);
  return status;
}

/* ---- the caller's functions ------------------------------------------------------------------ */

mps_status mps_solver_add(mps_solver *s, int32_t kind, const void *def, int32_t *number) {
  if (!s) return mpsi_null(__func__, "solver");
  mpsi_conditions *list = find_list(s, kind);
  if (!list) return fail_kind(s, __func__, kind);
  const char *function = list->kind->add;
  MPSI_TRY(mpsi_solver_enter_to_change(s, function));
  int32_t at = 0;
  mpsi_guard_enter(&s->guard, s->context, function);
  mps_status status = find_number(s, function, list, &at);
  status = put(s, function, list, status, at, def);
  mpsi_guard_end(&s->guard);
  if (status == MPS_OK && number) *number = at;
  return status;
}

mps_status mps_solver_set(mps_solver *s, int32_t kind, int32_t number, const void *def) {
  if (!s) return mpsi_null(__func__, "solver");
  mpsi_conditions *list = find_list(s, kind);
  if (!list) return fail_kind(s, __func__, kind);
  const char *function = list->kind->set;
  MPSI_TRY(mpsi_solver_enter_to_change(s, function));
  mpsi_guard_enter(&s->guard, s->context, function);
  mps_status status = check_number(s, function, list, number);
  if (status == MPS_OK) status = reserve(s, function, list, number);
  status = put(s, function, list, status, number, def);
  mpsi_guard_end(&s->guard);
  return status;
}

mps_status mps_solver_remove(mps_solver *s, int32_t kind, int32_t number) {
  if (!s) return mpsi_null(__func__, "solver");
  mpsi_conditions *list = find_list(s, kind);
  if (!list) return fail_kind(s, __func__, kind);
  const char *function = list->kind->remove;
  MPSI_TRY(mpsi_solver_enter_to_change(s, function));
  mpsi_guard_enter(&s->guard, s->context, function);
  mps_status status = mpsi_domain_agree_same(
      s->domain, function, check_number(s, function, list, number), "number", number);
  void *const former = number >= 0 && number < list->capacity ? list->own[number] : NULL;
  if (status == MPS_OK && list->kind->apply)
    status = list->kind->apply(s, function, number, NULL, NULL, former);
  if (status == MPS_OK && number < list->capacity) {
    drop_own(s, list->kind, former);
    if (list->def[number]) drop_def(s->context, list->kind, list->def[number]);
    list->own[number] = list->def[number] = NULL;
  }
  mpsi_guard_end(&s->guard);
  return status;
}

mps_status mps_solver_get(const mps_solver *s, int32_t kind, int32_t number, void *out,
                          size_t size) {
  if (!s) return mpsi_null(__func__, "solver");
  const mpsi_conditions *list = find_list(s, kind);
  if (!list) return fail_kind(s, __func__, kind);
  const char *function = list->kind->get;
  MPSI_TRY(check_number(s, function, list, number));
  union {
    double align;
    char bytes[MPSI_STRUCT_MOST];
  } known;
  const void *def = number < list->capacity ? list->def[number] : NULL;
  const mpsi_definition *d = list->kind->definition;
  if (!def) {
    mpsi_definition_fill(d, &known, d->size);
    list->kind->describe(s, number, &known);
    def = &known;
  }
  return mpsi_def_write(s->context, function, out, size, def, d->size);
}

mps_status mps_solver_get_numbers(const mps_solver *s, int32_t kind, int64_t capacity,
                                  int64_t *count, int32_t *numbers) {
  if (!s) return mpsi_null(__func__, "solver");
  const mpsi_conditions *list = find_list(s, kind);
  if (!list) return fail_kind(s, __func__, kind);
  if (!count || capacity < 0)
    return mpsi_fail(s->context, __func__, MPS_ERROR_ARGUMENT,
                     "count is %s and capacity %lld: must be given, and >= 0",
                     count ? "given" : "NULL", (long long)capacity);
  int64_t found = 0;
  for (int32_t k = 0; k < list->capacity || k < list->kind->first; k++) {
    if (!is_there(s, list, k)) continue;
    if (numbers && found < capacity) numbers[found] = k;
    found++;
  }
  *count = found;
  return MPS_OK;
}

mps_status mps_solver_get_reaction_sized(const mps_solver *s, int32_t number, mps_reaction *out,
                                         size_t size) {
  if (!s) return mpsi_null(__func__, "solver");
  const char *function = s->kind->name.get_reaction;
  mps_reaction reaction = {.count = 0};
  mps_status status = check_number(s, function, &s->conditions[MPSI_BOUNDARIES], number);
  MPSI_TRY(s->kind->get_reaction((void *)s, function, status, number, &reaction));
  return mpsi_out_write(s->context, function, out, size, &reaction, sizeof reaction);
}

void mpsi_conditions_drop(mps_solver *s) {
  for (int w = 0; w < MPSI_CONDITION_LISTS; w++) {
    mpsi_conditions *list = &s->conditions[w];
    for (int32_t k = 0; k < list->capacity; k++) {
      drop_own(s, list->kind, list->own[k]);
      if (list->def[k]) drop_def(s->context, list->kind, list->def[k]);
    }
    MPSI_FREE(s->context, list->def, list->own);
    *list = (mpsi_conditions){.kind = list->kind};
  }
}
