/* reactions.c - forces of particles on a rigid body, by parts of its surface.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "body_internal.h"

#include "rotation.h"

#include <string.h>

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

void mpsi_body_react(mps_body *body, mpsi_body_source *source, double dt, const mpsi_load *load,
                     const int64_t *count) {
  for (int32_t part = 0; part < body->parts; part++) {
    add_to_account(&body->pose, dt, &load[part], count[part], &source->reaction[part]);
    add_to_account(&body->pose, dt, &load[part], count[part], &body->reaction[part]);
    if (body->sources->next) sum_forces(body, part);
    for (int c = 0; c < 3; c++) {
      body->pending.force[c] += dt * load[part].force[c];
      body->pending.moment[c] += dt * load[part].moment[c];
    }
  }
}

void mpsi_body_strike(mps_body *body, mpsi_body_source *source, const mpsi_load *impulse) {
  for (int32_t part = 0; part < body->parts; part++) {
    const mpsi_load *J = &impulse[part];
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
  }
}

mps_status mpsi_body_sum_reaction(mps_context *context, const char *function,
                                  const mps_reaction *reaction, int32_t parts, int32_t part,
                                  mps_reaction *out) {
  if (part < -1 || part >= parts)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "part is %d, allowed are 0 to %d, and -1 for all", part, parts - 1);
  mps_reaction sum = {0};
  for (int32_t p = part < 0 ? 0 : part; p < (part < 0 ? parts : part + 1); p++) {
    const mps_reaction *r = &reaction[p];
    for (int c = 0; c < 3; c++) {
      sum.force[c] += r->force[c];
      sum.moment[c] += r->moment[c];
      sum.impulse[c] += r->impulse[c];
      sum.moment_impulse[c] += r->moment_impulse[c];
    }
    sum.count += r->count;
    sum.work += r->work;
    sum.removed += r->removed;
    sum.removed_mass += r->removed_mass;
  }
  *out = sum;
  return MPS_OK;
}

mps_status mps_body_get_reaction_sized(const mps_body *body, int32_t part, mps_reaction *out,
                                       size_t size) {
  static const char function[] = "mps_body_get_reaction";
  if (!body) return MPS_ERROR_ARGUMENT;
  mps_reaction sum;
  const mps_status status =
      mpsi_body_sum_reaction(body->context, function, body->reaction, body->parts, part, &sum);
  if (status != MPS_OK) return status;
  return mpsi_out_write(body->context, function, out, size, &sum, sizeof sum);
}

/* ---- parts ----------------------------------------------------------------------------------- */

mps_status mps_body_name_part(mps_body *body, const char *name, int64_t first, int64_t count,
                              int32_t *part) {
  if (!body) return MPS_ERROR_ARGUMENT;
  const size_t length = name ? mpsi_identifier(name, MPSI_PART_NAME) : 0;
  if (length == 0 || name[length] != '\0')
    return mpsi_fail(body->context, __func__, MPS_ERROR_ARGUMENT,
                     "name is \"%.60s\", must be [A-Za-z_][A-Za-z0-9_]* of at most 47 characters",
                     name ? name : "(NULL)");
  if (first < 0 || first >= body->faces || count < 1 || count > body->faces)
    return mpsi_fail(body->context, __func__, MPS_ERROR_ARGUMENT,
                     "first is %lld and count %lld, allowed are 0 to %lld and 1 to %lld",
                     (long long)first, (long long)count, (long long)body->faces - 1,
                     (long long)body->faces);
  int32_t number = mps_body_find_part(body, name);
  if (number < 0) {
    if (body->parts == MPS_BODY_MAX_PARTS)
      return mpsi_fail(body->context, __func__, MPS_ERROR_ARGUMENT,
                       "the body has %d named parts, the most there can be",
                       MPS_BODY_MAX_PARTS - 1);
    number = body->parts++;
    strcpy(body->names[number], name);
  }
  for (int64_t k = 0; k < count; k++) body->part_of[(first + k) % body->faces] = number;
  if (part) *part = number;
  return MPS_OK;
}

int32_t mps_body_part_count(const mps_body *body) { return body ? body->parts : 0; }

int32_t mps_body_find_part(const mps_body *body, const char *name) {
  for (int32_t k = 0; body && name && k < body->parts; k++)
    if (strcmp(body->names[k], name) == 0) return k;
  return -1;
}
