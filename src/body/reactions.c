/* reactions.c - forces of particles on a rigid body, by parts of its surface.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "body_internal.h"

#include "rotation.h"

#include <string.h>

#define MOST_PARTS 1000000

/* ---- reactions ------------------------------------------------------------------------------- */

/* Puts the force on one part in a step of dt into its account: `count` particles are in contact
 * with it. */
static void add_to_account(const mpsi_pose *pose, double dt, const mpsi_load *load, int64_t count,
                           mps_reaction *r) {
  r->work -= dt * (mpsi_dot3(load->force, pose->v) + mpsi_dot3(load->moment, pose->spin));
  for (int c = 0; c < 3; c++) {
    r->force[c] = load->force[c];
    r->moment[c] = load->moment[c];
    r->impulse[c] += dt * load->force[c];
    r->moment_impulse[c] += dt * load->moment[c];
  }
  r->count = count;
}

void mpsi_body_join(mps_body *body, mpsi_body_source *source) {
  mpsi_body_source **last = &body->sources;
  while (*last) last = &(*last)->next;
  source->next = NULL;
  *last = source;
}

void mpsi_body_leave(mps_body *body, const mpsi_body_source *source) {
  mpsi_body_source **at = &body->sources;
  while (*at && *at != source) at = &(*at)->next;
  if (*at) *at = source->next;
}

/* The body's present forces on a part, by all its sources. */
static void sum_forces(mps_body *body, int32_t part) {
  mps_reaction *sum = &body->reaction[part];
  for (int k = 0; k < 3; k++) sum->force[k] = sum->moment[k] = 0.0;
  sum->count = 0;
  for (const mpsi_body_source *s = body->sources; s; s = s->next) {
    for (int k = 0; k < 3; k++) {
      sum->force[k] += s->reaction[part].force[k];
      sum->moment[k] += s->reaction[part].moment[k];
    }
    sum->count += s->reaction[part].count;
  }
}

void mpsi_body_react(mps_body *body, mpsi_body_source *source, double dt) {
  for (int32_t part = 0; part < body->parts; part++) {
    const mpsi_part_load *by = &source->part[part];
    add_to_account(&body->pose, dt, &by->force, by->count, &source->reaction[part]);
    add_to_account(&body->pose, dt, &by->force, by->count, &body->reaction[part]);
    if (body->sources->next) sum_forces(body, part);
    for (int c = 0; c < 3; c++) {
      body->pending.force[c] += dt * by->force.force[c];
      body->pending.moment[c] += dt * by->force.moment[c];
    }
  }
}

void mpsi_body_strike(mps_body *body, mpsi_body_source *source) {
  for (int32_t part = 0; part < body->parts; part++) {
    mpsi_load *J = &source->part[part].impulse;
    mps_reaction *const account[2] = {&source->reaction[part], &body->reaction[part]};
    for (int k = 0; k < 2; k++) {
      account[k]->work -= mpsi_dot3(J->force, body->pose.v) + mpsi_dot3(J->moment, body->pose.spin);
      for (int c = 0; c < 3; c++) {
        account[k]->impulse[c] += J->force[c];
        account[k]->moment_impulse[c] += J->moment[c];
      }
    }
    for (int c = 0; c < 3; c++) {
      body->pending.force[c] += J->force[c];
      body->pending.moment[c] += J->moment[c];
    }
    *J = (mpsi_load){{0.0}, {0.0}};
  }
}

mps_status mpsi_body_check_part(const mps_body *body, const char *function, int32_t part) {
  if (part >= -1 && part < body->parts) return MPS_OK;
  if (body->parts == 1)
    return mpsi_fail(body->context, function, MPS_ERROR_ARGUMENT,
                     "part is %d, and the body has no named parts: allowed are 0 and -1, the whole",
                     part);
  return mpsi_fail(body->context, function, MPS_ERROR_ARGUMENT,
                   "part is %d, allowed are 0 to %d, and -1 for all", part, body->parts - 1);
}

void mpsi_body_add_reaction(mps_reaction *sum, const mps_reaction *r) {
  for (int c = 0; c < 3; c++) {
    sum->force[c] += r->force[c];
    sum->moment[c] += r->moment[c];
    sum->impulse[c] += r->impulse[c];
    sum->moment_impulse[c] += r->moment_impulse[c];
  }
  sum->count += r->count;
  sum->work += r->work;
  sum->removed += r->removed;
  sum->removed_mass += r->removed_mass;
}

mps_status mps_body_get_reaction_sized(const mps_body *body, int32_t part, mps_reaction *out,
                                       size_t size) {
  static const char function[] = "mps_body_get_reaction";
  if (!body) return mpsi_null(__func__, "body");
  MPSI_TRY(mpsi_body_check_part(body, function, part));
  mps_reaction sum = {0};
  for (int32_t p = 0; p < body->parts; p++)
    if (part < 0 || p == part) mpsi_body_add_reaction(&sum, &body->reaction[p]);
  return mpsi_out_write(body->context, function, out, size, &sum, sizeof sum);
}

/* ---- parts ----------------------------------------------------------------------------------- */

static bool widen_source(mps_body *body, mpsi_body_source *source, int32_t capacity) {
  return mpsi_grow(body->context, (void **)&source->reaction, body->parts, capacity,
                   sizeof *source->reaction) &&
         mpsi_grow(body->context, (void **)&source->part, body->parts, capacity,
                   sizeof *source->part);
}

bool mpsi_body_make_source(mps_body *body, mpsi_body_source *source) {
  source->reaction = mpsi_alloc(body->context, body->part_capacity, sizeof *source->reaction);
  if (source->reaction)
    source->part = mpsi_alloc(body->context, body->part_capacity, sizeof *source->part);
  return source->part != NULL;
}

void mpsi_body_free_source(mps_body *body, mpsi_body_source *source) {
  MPSI_FREE(body->context, source->reaction, source->part);
}

/* Memory for one more part, here and in all sources. */
static mps_status ensure_part(mps_body *body, const char *function) {
  if (body->parts < body->part_capacity) return MPS_OK;
  const int32_t capacity = 2 * body->part_capacity;
  bool good =
      mpsi_grow(body->context, (void **)&body->names, body->parts, capacity, sizeof *body->names) &&
      mpsi_grow(body->context, (void **)&body->reaction, body->parts, capacity,
                sizeof *body->reaction);
  for (mpsi_body_source *s = body->sources; s && good; s = s->next)
    good = widen_source(body, s, capacity);
  if (!good)
    return mpsi_fail_memory(body->context, function, (size_t)capacity * sizeof *body->reaction);
  body->part_capacity = capacity;
  return MPS_OK;
}

mps_status mps_body_name_part(mps_body *body, const char *name, int64_t first, int64_t count,
                              int32_t *part) {
  if (!body) return mpsi_null(__func__, "body");
  const size_t length = name ? mpsi_identifier(name, MPSI_PART_NAME) : 0;
  if (!name) return mpsi_fail(body->context, __func__, MPS_ERROR_ARGUMENT, "name is NULL");
  if (length == 0 || name[length] != '\0')
    return mpsi_fail(body->context, __func__, MPS_ERROR_ARGUMENT,
                     "name is '%.60s', must be letters, digits and _, not begin with a digit, and "
                     "have 1 to %d characters",
                     name, MPSI_PART_NAME - 1);
  if (body->faces == 1 && (first != 0 || count != 1))
    return mpsi_fail(body->context, __func__, MPS_ERROR_ARGUMENT,
                     "first is %lld and count %lld, but the surface is a single piece: 0 and 1",
                     (long long)first, (long long)count);
  if (first < 0 || first >= body->faces)
    return mpsi_fail(body->context, __func__, MPS_ERROR_ARGUMENT,
                     "first is %lld, and the pieces of the surface are numbered 0 to %lld",
                     (long long)first, (long long)body->faces - 1);
  if (count < 1 || count > body->faces)
    return mpsi_fail(body->context, __func__, MPS_ERROR_ARGUMENT,
                     "count is %lld, and the surface has 1 to %lld pieces to name",
                     (long long)count, (long long)body->faces);
  int32_t number = mps_body_find_part(body, name);
  if (number < 0) {
    if (body->parts == MOST_PARTS)
      return mpsi_fail(body->context, __func__, MPS_ERROR_ARGUMENT,
                       "the body has %d named parts, the most there can be", MOST_PARTS - 1);
    MPSI_TRY(ensure_part(body, __func__));
    number = body->parts++;
    strcpy(body->names[number], name);
  }
  for (int64_t k = 0; k < count; k++) body->part_of[(first + k) % body->faces] = number;
  if (part) *part = number;
  return MPS_OK;
}

int32_t mps_body_find_part(const mps_body *body, const char *name) {
  for (int32_t k = 0; body && name && k < body->parts; k++)
    if (strcmp(body->names[k], name) == 0) return k;
  return -1;
}
