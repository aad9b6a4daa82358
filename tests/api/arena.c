/* arena.c - the existing objects, by kind: a call takes any of them, or NULL.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "api.h"

#include <mps/mps.h>
#include <mps/experimental/coupling.h>
#include <mps/experimental/domain.h>
#include <mps/experimental/neighbours.h>
#include <mps/experimental/waves.h>

#include <stdio.h>
#include <string.h>

const char *const api_kind_names[API_KINDS] = {
    "context", "set",        "signal",   "material", "kernel",   "body",
    "contact", "neighbours", "coupling", "domain",   "recorder", "snapshot",
    "mpm",     "dynamics",   "elastic",  "fluid",    "waves",    "absorber",
    "history"};

int api_alive(const api *a, api_kind kind) {
  int count = 0;
  for (int k = 0; k < API_SLOTS; k++) count += a->objects[kind][k].handle != NULL;
  return count;
}

static api_object *latest(api *a, api_kind kind) {
  api_object *found = NULL;
  for (int k = 0; k < API_SLOTS; k++) {
    api_object *o = &a->objects[kind][k];
    if (o->handle && (!found || o->serial > found->serial)) found = o;
  }
  return found;
}

static api_object *any(api *a, api_kind kind) {
  const int alive = api_alive(a, kind);
  if (alive == 0) return NULL;
  if (a->latest || api_chance(a, 40)) return latest(a, kind);
  int skip = (int)api_below(a, (uint32_t)alive);
  for (int k = 0; k < API_SLOTS; k++)
    if (a->objects[kind][k].handle && skip-- == 0) return &a->objects[kind][k];
  return NULL;
}

api_object *api_any(api *a, api_kind kind) {
  static api_object none;
  api_object *o = any(a, kind);
  const bool first = !a->picked;
  a->picked = true;
  if (!o || (a->mood == API_ABSURD && api_chance(a, 6))) {
    memset(&none, 0, sizeof none);
    none.context = -1;
    api_say(a, "NULL, ");
    api_wrong(a, api_kind_names[kind]);
    return &none;
  }
  if (first) a->context = kind == API_CONTEXT ? (int)(o - a->objects[kind]) : o->context;
  api_say(a, "%s%d, ", api_kind_names[kind], (int)(o - a->objects[kind]));
  return o;
}

void *api_maybe(api *a, api_kind kind, const char *name) {
  api_object *o = any(a, kind);
  if (!o || api_chance(a, 60)) return NULL;
  api_say(a, "%s = %s%d, ", name, api_kind_names[kind], (int)(o - a->objects[kind]));
  return o->handle;
}

mps_context *api_context(api *a) { return api_any(a, API_CONTEXT)->handle; }

void api_destroy(api_kind kind, void **handle) {
  switch (kind) {
#define DESTROY(name, type, function)                                                              \
  case name: {                                                                                     \
    type *object = *handle;                                                                        \
    function(&object);                                                                             \
    *handle = object;                                                                              \
    return;                                                                                        \
  }
    DESTROY(API_CONTEXT, mps_context, mps_context_destroy)
    DESTROY(API_SET, mps_particles, mps_particles_destroy)
    DESTROY(API_SIGNAL, mps_signal, mps_signal_destroy)
    DESTROY(API_MATERIAL, mps_material, mps_material_destroy)
    DESTROY(API_KERNEL, mps_kernel, mps_kernel_destroy)
    DESTROY(API_BODY, mps_body, mps_body_destroy)
    DESTROY(API_CONTACT, mps_contact, mps_contact_destroy)
    DESTROY(API_NEIGHBOURS, mps_neighbours, mps_neighbours_destroy)
    DESTROY(API_COUPLING, mps_coupling, mps_coupling_destroy)
    DESTROY(API_DOMAIN, mps_domain, mps_domain_destroy)
    DESTROY(API_RECORDER, mps_recorder, mps_recorder_destroy)
    DESTROY(API_SNAPSHOT, mps_snapshot, mps_snapshot_destroy)
    DESTROY(API_MPM, mps_mpm, mps_mpm_destroy)
    DESTROY(API_DYNAMICS, mps_dynamics, mps_dynamics_destroy)
    DESTROY(API_ELASTIC, mps_elastic, mps_elastic_destroy)
    DESTROY(API_FLUID, mps_fluid, mps_fluid_destroy)
    DESTROY(API_WAVES, mps_waves, mps_waves_destroy)
    DESTROY(API_ABSORBER, mps_absorber, mps_absorber_destroy)
    DESTROY(API_HISTORY, mps_history, mps_history_destroy)
#undef DESTROY
  case API_KINDS:
    return;
  }
}

/* Objects of a context that has been destroyed stay usable, but their records cannot be queried. */
void api_forget(api *a, api_object *object) {
  const ptrdiff_t slot = object - a->objects[API_CONTEXT];
  for (int k = 0; slot >= 0 && slot < API_SLOTS && k < API_KINDS * API_SLOTS; k++) {
    api_object *o = &a->objects[k / API_SLOTS][k % API_SLOTS];
    if (o->context == slot) o->context = -1;
  }
  memset(object, 0, sizeof *object);
}

void api_loosen(api *a) {
  for (int k = 0; k < API_SLOTS; k++) a->objects[API_MPM][k].loose = true;
}

void api_rewrite(api *a, const char *field) {
  static const char *const motion[] = {"displacement",     "velocity",     "rotation",     "spin",
                                       "displacement_old", "rotation_old", "restoring_old"};
  const bool moduli = strcmp(field, "young") == 0 || strcmp(field, "poisson") == 0;
  for (int k = 0; k < API_SLOTS && moduli; k++) a->objects[API_ELASTIC][k].loose = true;
  for (int f = 0; f < API_COUNT(motion); f++)
    for (int k = 0; k < API_SLOTS && strcmp(field, motion[f]) == 0; k++)
      a->objects[API_DYNAMICS][k].rewritten = true;
}

/* A full kind drops its oldest object. */
static api_object *room(api *a, api_kind kind) {
  api_object *oldest = &a->objects[kind][0];
  for (int k = 0; k < API_SLOTS; k++) {
    api_object *o = &a->objects[kind][k];
    if (!o->handle) return o;
    if (o->serial < oldest->serial) oldest = o;
  }
  api_destroy(kind, &oldest->handle);
  if (oldest->handle) api_broken(a, "mps_%s_destroy has not nulled", api_kind_names[kind]);
  api_forget(a, oldest);
  return oldest;
}

api_object *api_adopt(api *a, api_kind kind, void *handle, int context, const api_object *owner) {
  if (!handle) return NULL;
  api_object *o = room(a, kind);
  o->handle = handle;
  o->context = context;
  o->serial = ++a->serials;
  o->owner = owner ? owner->serial : 0;
  return o;
}

/* In any order of kinds: what uses an object keeps it alive. */
void api_clear(api *a) {
  int left[API_KINDS * API_SLOTS];
  int count = 0;
  for (int k = 0; k < API_KINDS * API_SLOTS; k++)
    if (a->objects[k / API_SLOTS][k % API_SLOTS].handle) left[count++] = k;
  while (count > 0) {
    const int k = (int)api_below(a, (uint32_t)count);
    api_object *o = &a->objects[left[k] / API_SLOTS][left[k] % API_SLOTS];
    api_destroy((api_kind)(left[k] / API_SLOTS), &o->handle);
    api_forget(a, o);
    left[k] = left[--count];
  }
}
