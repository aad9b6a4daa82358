/* geostatic.c - geostatic stress: weight of the layers above, K0 horizontally; or by a caller's
 * function. A field by depth below the surface.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/particles/particles_internal.h"
#include "core/base/ranges.h"
#include "core/definition/digits.h"

#include <mps/soil.h>
#include <mps/experimental/soil.h>

#define ON_SURFACE 1e-9 /* spacings: a centre this little above the surface lies on it */

/* Bytes of a layer: in 0.3; far beyond what any version will have. */
enum { FIRST_LAYER = 24, MOST_LAYER = 65536 };

static const char set_geostatic[] = "mps_particles_set_geostatic";

/* Data of one call. */
typedef struct geostatic {
  mps_particles *set;
  mps_context *context;
  mps_geostatic_def def;
  const char *function; /* that is called */
  int64_t count;
  int32_t dim, up; /* the vertical axis */
  const double *x[3];
  const double *density_field; /* or NULL */
  const int64_t *id;
  double *depth; /* of each particle, m */
  double *top, *burden,
      *weight; /* of each layer: depth m, stress Pa at its top; unit weight N/m3 */
} geostatic;

/* Layer k of the caller's, whose layers may be longer than those of this library. */
static const mps_geostatic_layer *layer_of(const geostatic *g, int32_t k) {
  const int64_t size = g->def.layer_size ? g->def.layer_size : FIRST_LAYER;
  return (const void *)((const char *)g->def.layers + k * size);
}

/* ---- checks ---------------------------------------------------------------------------------- */

static mps_status check_layers(const geostatic *g) {
  const mps_geostatic_def *d = &g->def;
  if (!d->layers)
    return mpsi_fail(g->context, g->function, MPS_ERROR_ARGUMENT,
                     "layers is NULL: give an array of mps_geostatic_layer, and layer_count");
  if (d->layer_count < 1)
    return mpsi_fail(g->context, g->function, MPS_ERROR_ARGUMENT,
                     "layer_count is %lld, must be >= 1", (long long)d->layer_count);
  if (d->layer_size != 0 && (d->layer_size < FIRST_LAYER || d->layer_size > MOST_LAYER ||
                             d->layer_size % (int32_t)sizeof(double) != 0))
    return mpsi_fail(g->context, g->function, MPS_ERROR_ARGUMENT,
                     "layer_size is %d, must be sizeof(mps_geostatic_layer) (%d to %d, a multiple "
                     "of 8), or 0",
                     (int)d->layer_size, FIRST_LAYER, MOST_LAYER);
  for (int64_t k = 0; k < d->layer_count; k++) {
    const mps_geostatic_layer *layer = layer_of(g, k);
    const bool lowest = k == d->layer_count - 1;
    if (!mpsi_in_range(MPSI_RANGE_LENGTH, layer->thickness) &&
        !(lowest && layer->thickness == INFINITY))
      return mpsi_fail(g->context, g->function, MPS_ERROR_ARGUMENT,
                       "layers: layer %d has thickness %s m, must be > 0 (1e-9 to 1e9)%s", (int)k,
                       mpsi_outside(layer->thickness, 1e-9, 1e9).text,
                       lowest ? "" : "; only the lowest may be infinite");
    if (layer->k0 != 0.0 && !mpsi_in_range(MPSI_RANGE_STRESS_RATIO, layer->k0))
      return mpsi_fail(g->context, g->function, MPS_ERROR_ARGUMENT,
                       "layers: layer %d has k0 %s, must be 0 or 1e-9 to 1e6", (int)k,
                       mpsi_outside(layer->k0, 1e-9, 1e6).text);
    if (!isnan(layer->density) && !mpsi_in_range(MPSI_RANGE_DENSITY, layer->density))
      return mpsi_fail(g->context, g->function, MPS_ERROR_ARGUMENT,
                       "layers: layer %d has density %g kg/m3, must be 1e-9 to 1e9, or NaN for "
                       "that of the particles",
                       (int)k, layer->density);
    if (isnan(layer->density) && !g->density_field)
      return mpsi_fail(
          g->context, g->function, MPS_ERROR_FIELD,
          "layers: layer %d has density NaN, but the set has no field 'density' to take it "
          "from",
          (int)k);
  }
  return MPS_OK;
}

static mps_status check_line(const geostatic *g) {
  const mps_geostatic_def *d = &g->def;
  const int64_t n = d->surface_points;
  if (!d->surface_line) return MPS_OK;
  if (g->dim != 2 || g->up != 1)
    return mpsi_fail(g->context, g->function, MPS_ERROR_UNSUPPORTED,
                     "a surface_line is for 2D with y upwards: use surface_level");
  for (int32_t k = 0; k < n; k++) {
    const double x = d->surface_line[2 * k], y = d->surface_line[2 * k + 1];
    if (!isfinite(x) || !isfinite(y) || (k > 0 && x <= d->surface_line[2 * k - 2]))
      return mpsi_fail(g->context, g->function, MPS_ERROR_ARGUMENT,
                       "point %d of surface_line is (%g, %g) m: must be finite, and x larger than "
                       "that of the point before",
                       (int)k, x, y);
  }
  return MPS_OK;
}

/* ---- depths ---------------------------------------------------------------------------------- */

static double level_of_line(const mps_geostatic_def *d, double x) {
  const double *p = d->surface_line;
  const int64_t n = d->surface_points;
  if (x <= p[0]) return p[1];
  for (int32_t k = 1; k < n; k++) {
    if (x > p[2 * k]) continue;
    const double share = (x - p[2 * k - 2]) / (p[2 * k] - p[2 * k - 2]);
    return p[2 * k - 1] + share * (p[2 * k + 1] - p[2 * k - 1]);
  }
  return p[2 * n - 1];
}

/* The caller's function has failed for particle k; a value that is no status is MPS_ERROR_ARGUMENT.
 */
static mps_status refused(const geostatic *g, const char *function, const char *what,
                          mps_status status, int64_t k) {
  const bool known = status > MPS_OK && status <= MPS_ERROR_INTERNAL;
  return mpsi_fail(g->context, function, known ? status : MPS_ERROR_ARGUMENT,
                   "%s particle %lld: it returned status %d (%s)", what, (long long)g->id[k],
                   (int)status, mps_status_text(status));
}

/* Depth of every particle below the surface. */
static mps_status find_depths(geostatic *g) {
  const mps_geostatic_def *d = &g->def;
  const double spacing = mps_particles_spacing(g->set);
  double flat = d->surface;
  if (isnan(flat)) {
    /* of a set in parts the highest particle may lie on another rank */
    MPSI_TRY(d->surface_line || d->surface_level
                 ? MPS_OK
                 : mpsi_particles_check_deal(g->set, g->function, NULL));
    flat = -INFINITY;
    for (int64_t k = 0; k < g->count; k++) flat = fmax(flat, g->x[g->up][k]);
    flat += 0.5 * spacing;
  }
  for (int64_t k = 0; k < g->count; k++) {
    double x[3] = {0.0};
    for (int32_t c = 0; c < g->dim; c++) x[c] = g->x[c][k];
    double level = d->surface_line ? level_of_line(d, x[0]) : flat;
    const mps_status status = d->surface_level ? d->surface_level(d->user, x, &level) : MPS_OK;
    if (status != MPS_OK)
      return refused(g, g->function, "surface_level refused the position of", status, k);
    const double depth = level - x[g->up];
    if (!isfinite(depth) || depth < -ON_SURFACE * spacing)
      return mpsi_fail(g->context, g->function, MPS_ERROR_ARGUMENT,
                       "particle %lld lies at the level %g m, above the surface at %g m there",
                       (long long)g->id[k], x[g->up], level);
    g->depth[k] = fmax(depth, 0.0);
  }
  return MPS_OK;
}

/* The layer with the depth in [top, bottom); the lowest one with its bottom, and count below. */
static int32_t layer_at(const geostatic *g, double depth) {
  const int64_t n = g->def.layer_count;
  int32_t k = 0;
  while (k < n && depth >= g->top[k] + layer_of(g, k)->thickness) k++;
  if (k == n && depth <= g->top[n - 1] + layer_of(g, n - 1)->thickness) k--;
  return k;
}

/* ---- weights --------------------------------------------------------------------------------- */

/* Density of the layers that take it from their particles: one value, or an error. */
static mps_status take_densities(geostatic *g, double *density) {
  const int64_t n = g->def.layer_count;
  for (int32_t k = 0; k < n; k++) density[k] = layer_of(g, k)->density;
  for (int64_t k = 0; k < g->count; k++) {
    const int32_t layer = layer_at(g, g->depth[k]);
    if (layer == n)
      return mpsi_fail(g->context, g->function, MPS_ERROR_ARGUMENT,
                       "particle %lld is %g m deep, the layers reach down to %g m (the lowest may "
                       "be infinite)",
                       (long long)g->id[k], g->depth[k],
                       g->top[n - 1] + layer_of(g, n - 1)->thickness);
    if (!isnan(layer_of(g, layer)->density)) continue;
    const double rho = g->density_field[k];
    if (!mpsi_in_range(MPSI_RANGE_DENSITY, rho))
      return mpsi_fail(g->context, g->function, MPS_ERROR_ARGUMENT,
                       "particles: particle %lld has density %g kg/m3, must be 1e-9 to 1e9",
                       (long long)g->id[k], rho);
    if (isnan(density[layer])) density[layer] = rho;
    if (rho != density[layer])
      return mpsi_fail(g->context, g->function, MPS_ERROR_ARGUMENT,
                       "layer %d has particles of %g and of %g kg/m3 (particle %lld), must be one "
                       "value, or give the layer's density",
                       (int)layer, density[layer], rho, (long long)g->id[k]);
  }
  for (int32_t k = 0; k < n; k++)
    if (isnan(density[k]) && k < n - 1)
      return mpsi_fail(g->context, g->function, MPS_ERROR_ARGUMENT,
                       "layers: layer %d has density NaN and no particle to take it from", (int)k);
  return MPS_OK;
}

static mps_status weigh(geostatic *g) {
  const int64_t n = g->def.layer_count;
  for (int32_t k = 1; k < n; k++) g->top[k] = g->top[k - 1] + layer_of(g, k - 1)->thickness;
  MPSI_TRY(find_depths(g));
  MPSI_TRY(take_densities(g, g->weight));
  g->burden[0] = g->def.surcharge;
  for (int32_t k = 0; k < n; k++) {
    g->weight[k] = isnan(g->weight[k]) ? 0.0 : g->weight[k] * g->def.gravity; /* nothing there */
    if (k + 1 < n) g->burden[k + 1] = g->burden[k] + g->weight[k] * layer_of(g, k)->thickness;
  }
  return MPS_OK;
}

/* ---- the public functions -------------------------------------------------------------------- */

/* Adds the field where the set lacks it, and notifies the set's holders; on an error of one the set
 * has its former fields. */
static mps_status open_stress(const geostatic *g, const char *function) {
  const int32_t fields = mps_particles_field_count(g->set);
  mps_status status = mpsi_as(g->context, function, mps_particles_add_field(g->set, "stress", 0));
  if (status == MPS_OK) status = mpsi_particles_notify(g->set, function, "stress", NULL);
  if (status != MPS_OK) mpsi_particles_drop_fields(g->set, fields);
  return status;
}

static void write_stress(const geostatic *g) {
  double *s[6];
  for (int32_t c = 0; c < 2 * g->dim; c++) s[c] = mpsi_particles_column(g->set, "stress", c);
  for (int64_t k = 0; k < g->count; k++) {
    const int32_t layer = layer_at(g, g->depth[k]);
    const double vertical = -(g->burden[layer] + g->weight[layer] * (g->depth[k] - g->top[layer]));
    for (int32_t c = 0; c < 2 * g->dim; c++)
      s[c][k] = c == g->up ? vertical : c < 3 ? layer_of(g, layer)->k0 * vertical : 0.0;
  }
}

static void look_at_set(geostatic *g) {
  g->count = mps_particles_count(g->set);
  g->dim = mps_particles_dim(g->set);
  for (int32_t c = 0; c < g->dim; c++) g->x[c] = mpsi_particles_column(g->set, "position", c);
  g->density_field = mpsi_particles_column(g->set, "density", 0);
  g->id = mpsi_particles_integers(g->set, "id");
}

mps_status mps_particles_set_geostatic(mps_particles *particles, const mps_geostatic_def *def) {
  if (!particles) return mpsi_null(__func__, "particles");
  geostatic g = {.set = particles,
                 .context = mpsi_particles_context(particles),
                 .def = mps_geostatic_defaults(),
                 .function = set_geostatic};
  MPSI_TRY(MPSI_DEF_READ_IN(g.context, set_geostatic, mps_geostatic_def, def,
                            mpsi_scene_of(mps_particles_dim(particles)), &g.def));
  MPSI_TRY(mpsi_particles_writable(particles, set_geostatic));
  look_at_set(&g);
  g.up = g.def.vertical == -1 ? g.dim - 1 : g.def.vertical;
  MPSI_TRY(check_line(&g));
  MPSI_TRY(check_layers(&g));
  const int64_t n = g.def.layer_count, doubles = g.count + 3 * n;
  g.depth = mpsi_alloc(g.context, doubles, sizeof *g.depth);
  if (!g.depth)
    return mpsi_fail_memory(g.context, set_geostatic, (size_t)doubles * sizeof *g.depth);
  g.top = g.depth + g.count, g.burden = g.top + n, g.weight = g.burden + n;
  mps_status status = weigh(&g);
  if (status == MPS_OK) status = open_stress(&g, set_geostatic);
  if (status == MPS_OK) write_stress(&g);
  mpsi_free(g.context, g.depth);
  return status;
}

/* Calls the caller's function for each particle in turn: s[6 k + c]. */
static mps_status evaluate_stress(const geostatic *g, mps_geostatic_stress_fn fn, void *user,
                                  double *s) {
  static const char function[] = "mps_particles_set_stress";
  for (int64_t k = 0; k < g->count; k++) {
    double x[3] = {0.0};
    for (int32_t c = 0; c < g->dim; c++) x[c] = g->x[c][k];
    const mps_status status = fn(user, x, &s[6 * k]);
    if (status != MPS_OK) return refused(g, function, "the stress function refused", status, k);
    for (int32_t c = 0; c < 2 * g->dim; c++)
      if (!isfinite(s[6 * k + c]))
        return mpsi_fail(g->context, function, MPS_ERROR_ARGUMENT,
                         "stress[%d] at particle %lld is %g Pa, must be finite", (int)c,
                         (long long)g->id[k], s[6 * k + c]);
  }
  return MPS_OK;
}

mps_status mps_particles_set_stress(mps_particles *particles, mps_geostatic_stress_fn fn,
                                    void *user) {
  if (!particles) return mpsi_null(__func__, "particles");
  geostatic g = {.set = particles, .context = mpsi_particles_context(particles)};
  if (!fn) return mpsi_fail(g.context, __func__, MPS_ERROR_ARGUMENT, "stress is NULL");
  MPSI_TRY(mpsi_particles_writable(particles, __func__));
  look_at_set(&g);
  double *s = mpsi_alloc(g.context, 6 * g.count, sizeof *s);
  if (!s) return mpsi_fail_memory(g.context, __func__, (size_t)g.count * 6 * sizeof *s);
  mps_status status = evaluate_stress(&g, fn, user, s);
  if (status == MPS_OK) status = open_stress(&g, __func__);
  for (int32_t c = 0; c < 2 * g.dim && status == MPS_OK; c++) {
    double *column = mpsi_particles_column(particles, "stress", c);
    for (int64_t k = 0; k < g.count; k++) column[k] = s[6 * k + c];
  }
  mpsi_free(g.context, s);
  return status;
}

/* ---- a field by depth ------------------------------------------------------------------------ */

static mps_status check_profile(const geostatic *g, const char *field, int64_t count,
                                const double *depth, const double *value) {
  if (!field || !depth || !value)
    return mpsi_fail(g->context, g->function, MPS_ERROR_ARGUMENT, "%s is NULL",
                     !field   ? "field"
                     : !depth ? "depth"
                              : "value");
  if (count < 1)
    return mpsi_fail(g->context, g->function, MPS_ERROR_ARGUMENT, "count is %d, must be >= 1",
                     (int)count);
  for (int32_t k = 0; k < count; k++) {
    if (!isfinite(value[k]))
      return mpsi_fail(g->context, g->function, MPS_ERROR_ARGUMENT,
                       "value[%d] is %g, must be finite", (int)k, value[k]);
    if (!isfinite(depth[k]) || (k > 0 && depth[k] <= depth[k - 1]))
      return mpsi_fail(g->context, g->function, MPS_ERROR_ARGUMENT,
                       "depth[%d] is %g m, must be finite and greater than the one before", (int)k,
                       depth[k]);
  }
  return MPS_OK;
}

/* Linear between the points, constant beyond. */
static double profile_at(int32_t count, const double *depth, const double *value, double at) {
  if (at <= depth[0]) return value[0];
  for (int32_t k = 1; k < count; k++) {
    if (at > depth[k]) continue;
    const double share = (at - depth[k - 1]) / (depth[k] - depth[k - 1]);
    return value[k - 1] + share * (value[k] - value[k - 1]);
  }
  return value[count - 1];
}

static mps_status write_profile(const geostatic *g, const char *field, int64_t count,
                                const double *depth, const double *value) {
  mps_edit edit;
  MPSI_TRY(mpsi_as(g->context, g->function, mps_particles_edit(g->set, field, &edit)));
  for (int64_t k = 0; k < g->count; k++)
    *mps_edit_f64(&edit, k, 0) = profile_at(count, depth, value, g->depth[k]);
  mps_status status = mpsi_as(g->context, g->function, mps_particles_commit(g->set, &edit));
  if (status != MPS_OK && mps_particles_abandon(g->set, &edit) != MPS_OK) return MPS_ERROR_INTERNAL;
  return status;
}

mps_status mps_particles_set_profile(mps_particles *particles, const char *field, int64_t count,
                                     const double *depth, const double *value,
                                     const mps_geostatic_def *ground) {
  if (!particles) return mpsi_null(__func__, "particles");
  geostatic g = {.set = particles,
                 .context = mpsi_particles_context(particles),
                 .def = mps_geostatic_defaults(),
                 .function = __func__};
  mps_view view;
  MPSI_TRY(check_profile(&g, field, count, depth, value));
  if (ground)
    MPSI_TRY(MPSI_DEF_READ_IN(g.context, __func__, mps_geostatic_def, ground,
                              mpsi_scene_of(mps_particles_dim(particles)), &g.def));
  MPSI_TRY(mpsi_particles_writable(particles, __func__));
  look_at_set(&g);
  g.up = g.def.vertical == -1 ? g.dim - 1 : g.def.vertical;
  MPSI_TRY(check_line(&g));
  g.depth = mpsi_alloc(g.context, g.count, sizeof *g.depth);
  if (!g.depth) return mpsi_fail_memory(g.context, __func__, (size_t)g.count * sizeof *g.depth);
  const int32_t fields = mps_particles_field_count(particles);
  mps_status status = find_depths(&g);
  if (status == MPS_OK)
    status = mpsi_as(g.context, __func__, mps_particles_add_field(particles, field, 1));
  if (status == MPS_OK)
    status = mpsi_as(g.context, __func__, mps_particles_view(particles, field, &view));
  if (status == MPS_OK && view.dtype.code != 2)
    status = mpsi_fail(g.context, __func__, MPS_ERROR_FIELD,
                       "field '%s' is of int64, must be float64", field);
  if (status == MPS_OK) status = write_profile(&g, field, count, depth, value);
  if (status != MPS_OK) mpsi_particles_drop_fields(particles, fields);
  mpsi_free(g.context, g.depth);
  return status;
}
