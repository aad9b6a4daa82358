/* state_list.c - see state.h: the list of a solver's state, and the values of a list.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "state_private.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* A new item, or NULL when out of memory. */
static mpsi_state_item *add(mpsi_state *s, const char *name, mpsi_state_type type, int64_t rows) {
  if (s->count == s->capacity) {
    const int32_t capacity = s->capacity ? 2 * s->capacity : 64;
    void *list = s->item;
    if (s->refused || !mpsi_grow(s->context, &list, s->capacity, capacity, sizeof *s->item)) {
      s->refused = true;
      return NULL;
    }
    s->item = list;
    s->capacity = capacity;
  }
  mpsi_state_item *made = &s->item[s->count++];
  *made = (mpsi_state_item){.type = type, .columns = 1, .rows = rows};
  snprintf(made->name, sizeof made->name, "%.47s%.47s", s->prefix, name);
  return made;
}

static void add_at(mpsi_state *s, const char *name, mpsi_state_type type, mpsi_state_width how,
                   void *data, int64_t count) {
  mpsi_state_item *made = add(s, name, type, count);
  if (!made) return;
  made->width = how;
  made->data = data;
}

void mpsi_state_f64(mpsi_state *state, const char *name, double *values, int64_t count) {
  add_at(state, name, MPSI_STATE_F64, MPSI_STATE_WIDE, values, count);
}

void mpsi_state_i64(mpsi_state *state, const char *name, int64_t *values, int64_t count) {
  add_at(state, name, MPSI_STATE_I64, MPSI_STATE_WIDE, values, count);
}

void mpsi_state_bits(mpsi_state *state, const char *name, int64_t *values, int64_t count) {
  add_at(state, name, MPSI_STATE_I64, MPSI_STATE_BITS, values, count);
}

void mpsi_state_exact(mpsi_state *state, const char *name, mpsi_exact *sums, int64_t count) {
  add_at(state, name, MPSI_STATE_I64, MPSI_STATE_EXACT, sums, count * MPSI_EXACT_LIMBS);
}

void mpsi_state_bool(mpsi_state *state, const char *name, bool *value) {
  add_at(state, name, MPSI_STATE_I64, MPSI_STATE_BOOL, value, 1);
}

void mpsi_state_reaction(mpsi_state *state, mps_reaction *reaction) {
  mpsi_state_f64(state, "force", reaction->force, 3);
  mpsi_state_f64(state, "moment", reaction->moment, 3);
  mpsi_state_f64(state, "impulse", reaction->impulse, 3);
  mpsi_state_f64(state, "moment_impulse", reaction->moment_impulse, 3);
  mpsi_state_i64(state, "count", &reaction->count, 1);
  mpsi_state_f64(state, "work", &reaction->work, 1);
  mpsi_state_i64(state, "removed", &reaction->removed, 1);
  mpsi_state_f64(state, "removed_mass", &reaction->removed_mass, 1);
}

void mpsi_state_agree_integer(mpsi_state *state, const char *name, int64_t value) {
  mpsi_state_item *made = add(state, name, MPSI_STATE_I64, 1);
  if (!made) return;
  made->agrees = true;
  made->own.integer = value;
}

void mpsi_state_agree_choice(mpsi_state *state, const char *name, const char *enumeration,
                             int32_t value) {
  mpsi_state_item *made = add(state, name, MPSI_STATE_I64, 1);
  if (!made) return;
  made->agrees = true;
  made->enumeration = enumeration;
  made->own.integer = value;
}

void mpsi_state_agree_number(mpsi_state *state, const char *name, double value) {
  mpsi_state_item *made = add(state, name, MPSI_STATE_F64, 1);
  if (!made) return;
  made->agrees = true;
  made->own.number = value;
}

void mpsi_state_agree_text(mpsi_state *state, const char *name, const char *value) {
  mpsi_state_item *made = add(state, name, MPSI_STATE_BYTES, MPSI_STATE_NAME);
  if (!made) return;
  made->agrees = made->text = true;
  snprintf(made->own.text, sizeof made->own.text, "%s", value);
}

void mpsi_state_enter(mpsi_state *state, const char *format, ...) {
  const size_t used = strlen(state->prefix);
  if (state->depth < MPSI_STATE_DEPTH) state->cut[state->depth] = used;
  state->depth++;
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(state->prefix + used, sizeof state->prefix - used, format, arguments);
  va_end(arguments);
  const size_t now = strlen(state->prefix);
  snprintf(state->prefix + now, sizeof state->prefix - now, "/");
}

void mpsi_state_leave(mpsi_state *state) {
  if (state->depth > 0 && --state->depth < MPSI_STATE_DEPTH)
    state->prefix[state->cut[state->depth]] = '\0';
}

void mpsi_state_add_table_of(mpsi_state *state, const char *name, const mpsi_state_table *table,
                             void *owner) {
  mpsi_state_item *made = add(state, name, table->type, table->rows(owner));
  if (!made) return;
  made->columns = table->columns;
  made->table = table;
  made->owner = owner;
}

void mpsi_state_add_optional(mpsi_state *state, const char *name, const mpsi_state_table *table,
                             mpsi_state_fits_fn fits, void *owner) {
  const int32_t before = state->count;
  mpsi_state_add_table_of(state, name, table, owner);
  if (state->count == before) return;
  state->item[before].optional = true;
  state->item[before].fits = fits;
}

void mpsi_state_add_table(mpsi_state *state, const char *name, const mpsi_state_table *table) {
  mpsi_state_add_table_of(state, name, table, state->solver);
}

/* ---- values -------------------------------------------------------------------------------- */

bool mpsi_values_reserve(mps_context *context, mpsi_values *values, int32_t count) {
  if (count <= values->capacity) return true;
  void *list = values->item;
  if (!mpsi_grow(context, &list, values->capacity, count, sizeof *values->item)) return false;
  values->item = list;
  values->capacity = count;
  return true;
}

bool mpsi_value_reserve(mps_context *context, mpsi_value *value, mpsi_state_type type, int64_t rows,
                        int32_t columns) {
  const int64_t size = mpsi_state_size(type);
  if (rows < 0 || columns < 1 || rows > INT64_MAX / size / columns) return false;
  const int64_t bytes = rows * columns * size;
  if (value->data && bytes <= value->capacity) return true;
  void *data = value->data;
  if (!mpsi_grow(context, &data, value->data ? value->capacity : 0, bytes, 1)) return false;
  value->data = data;
  value->capacity = bytes;
  return true;
}

const mpsi_value *mpsi_values_find(const mpsi_values *values, const char *name) {
  for (int32_t k = 0; k < values->count; k++)
    if (strcmp(values->item[k].name, name) == 0) return &values->item[k];
  return NULL;
}

void mpsi_values_free(mps_context *context, mpsi_values *values) {
  for (int32_t k = 0; k < values->capacity; k++) mpsi_free(context, values->item[k].data);
  mpsi_free(context, values->item);
  *values = (mpsi_values){0};
}

void mpsi_state_read_item(const mpsi_state_item *from, void *to) {
  const int64_t count = from->rows * from->columns;
  int64_t *integer = to;
  if (from->table) {
    if (count > 0) from->table->get(from->owner, to);
  } else if (from->agrees) {
    memcpy(to, &from->own, (size_t)(count * mpsi_state_size(from->type)));
  } else if (from->width == MPSI_STATE_BOOL) {
    for (int64_t k = 0; k < count; k++) integer[k] = ((const bool *)from->data)[k];
  } else if (count > 0) {
    memcpy(to, from->data, (size_t)(count * mpsi_state_size(from->type)));
  }
}

bool mpsi_state_bounded(const mpsi_state_item *of, const mpsi_value *from) {
  const int64_t count = from->rows * from->columns, *integer = from->data;
  if (of->type != MPSI_STATE_I64 || of->table || of->width == MPSI_STATE_BITS) return true;
  for (int64_t k = 0; k < count && of->width == MPSI_STATE_EXACT; k += MPSI_EXACT_LIMBS)
    if (!mpsi_exact_is_sum(integer + k)) return false;
  for (int64_t k = 0; k < count && of->width != MPSI_STATE_EXACT; k++)
    if (integer[k] > MPSI_STATE_MOST || integer[k] < -MPSI_STATE_MOST) return false;
  return true;
}

void mpsi_state_write_item(const mpsi_state_item *to, const mpsi_value *from) {
  const int64_t count = from ? from->rows * from->columns : 0;
  const int64_t *integer = from ? from->data : NULL;
  if (to->agrees) return;
  if (!from) {
    to->table->set(to->owner, 0, NULL);
  } else if (to->table) {
    to->table->set(to->owner, from->rows, from->data);
  } else if (to->width == MPSI_STATE_BOOL) {
    for (int64_t k = 0; k < count; k++) ((bool *)to->data)[k] = integer[k] != 0;
  } else if (count > 0) {
    memcpy(to->data, from->data, (size_t)(count * mpsi_state_size(from->type)));
  }
}
