/* soil.c - the soil of mps-penetrometer: particles, in-situ stress, law, pore water, and the
 * undrained strength and rigidity that cone factors refer to. SPDX-License-Identifier: BSD-3-Clause
 */
#include "penetrometer.h"

#include <mps/soil.h>
#include <mps/experimental/pore_water.h>
#include <mps/experimental/domain.h>
#include <mps/experimental/soil.h>

#include <math.h>
#include <stdlib.h>

#define ROOT3 1.7320508075688772

/* ---- settings -------------------------------------------------------------------------------- */

/* su (Pa) in triaxial compression, half the largest q; of Cam-Clay the state decides. */
static double strength_of(const pen_settings *s) {
  return s->law == PEN_CLAY ? 0.5 * ROOT3 * s->cohesion : s->cohesion;
}

/* Options of one kind of soil alone. */
static const char *check_uses(const pen_settings *s, const option *table) {
  static const char *const clay[] = {"M", "lambda", "kappa", "ocr", "permeability"};
  static const char *const unused[] = {"cohesion", "young", "adhesion", "k0", "gravity"};
  const bool mcc = s->law == PEN_CAM_CLAY;
  for (size_t k = 0; k < sizeof clay / sizeof *clay && !mcc; k++)
    if (options_given(table, clay[k]))
      return "--M, --lambda, --kappa, --ocr and --permeability are for --law mcc";
  for (size_t k = 0; k < sizeof unused / sizeof *unused && mcc; k++)
    if (options_given(table, unused[k]))
      return "--cohesion, --young, --adhesion, --k0 and --gravity are not for --law mcc, whose "
             "strength "
             "and stiffness follow --surcharge and --ocr in ground without weight";
  if (s->law != PEN_SAND && (options_given(table, "phi") || options_given(table, "psi")))
    return "--phi and --psi are for --law sand";
  if (s->law != PEN_SAND && options_given(table, "emax")) return "--emax is for --law sand";
  if (s->law != PEN_SAND && !mcc && options_given(table, "e0"))
    return "--e0 is for --law mcc and sand";
  if (!isnan(s->ir) && (s->law == PEN_SAND || s->law == PEN_ELASTIC))
    return "--ir is for --law clay, tresca and mcc, which have an undrained strength";
  if (!isnan(s->ir) && options_given(table, "young")) return "--ir and --young exclude each other";
  return NULL;
}

/* The hole that the tip and its shaft fill at the start, and the load on the ground around. */
static const char *check_start(const penetrometer *p) {
  const pen_settings *s = &p->s;
  if (s->start > 0.0 && s->tip != PEN_CONE)
    return "--start is for --tip cone, whose shaft fills the hole above it";
  if (s->start > 0.0 && !(s->start >= pen_shoulder(p)))
    return "--start must be at least the height of the cone, (D/2)/tan(angle/2)";
  if (s->start > 0.0 && !(s->depth - s->start >= 2.0 * s->h))
    return "--depth must be at least 2 cells of --cell below --start";
  if (s->surcharge > 0.0 && !(s->start > 0.0))
    return "--surcharge asks for --start, with which the shaft holds the ground beside it open";
  if (s->sides == PEN_FREE && !(s->start > 0.0))
    return "--sides free asks for --start, in ground far from the surface";
  if (s->sides == PEN_FREE && s->surcharge > 0.0)
    return "--sides free is for ground without stress: --surcharge must be 0";
  if (s->law == PEN_CAM_CLAY && !(s->surcharge > 0.0))
    return "--law mcc asks for a --surcharge > 0, the vertical effective stress of its ground";
  return NULL;
}

/* Fills in what follows from the law. */
static const char *complete(pen_settings *s, const option *table) {
  const bool mcc = s->law == PEN_CAM_CLAY, undrained = s->law == PEN_CLAY || s->law == PEN_TRESCA;
  if (mcc) s->cohesion = 0.0;
  if (s->law == PEN_SAND && !options_given(table, "cohesion")) s->cohesion = 0.0;
  if (mcc && !options_given(table, "poisson")) s->poisson = 0.25;
  if (undrained && !isnan(s->ir) && !options_given(table, "poisson")) s->poisson = 0.49;
  if (undrained && s->cohesion == 0.0) return "--cohesion must be > 0 with --law clay and tresca";
  if (undrained && !isnan(s->ir)) s->young = 2.0 * (1.0 + s->poisson) * s->ir * strength_of(s);
  if (isnan(s->gravity)) s->gravity = s->law == PEN_SAND ? 9.81 : 0.0;
  if (isnan(s->k0)) s->k0 = s->poisson / (1.0 - s->poisson);
  if (s->sides == PEN_FREE && s->gravity > 0.0)
    return "--sides free is for ground without stress: --gravity must be 0";
  const double vertical = s->surcharge + s->density * s->gravity * s->height;
  if (undrained && fabs(1.0 - s->k0) * vertical > 2.0 * strength_of(s))
    return "--k0 and the stress at the bottom, --surcharge + density g depth, are beyond the "
           "strength "
           "of the clay";
  if (mcc) {
    if (!(s->kappa < s->lambda)) return "--kappa must be below --lambda";
    if (!(s->density > PEN_WATER)) return "--density must be above 1000 kg/m3 with --law mcc";
  } else if (vertical > 0.5 * s->young) {
    return "--young must be at least twice the stress at the bottom of the soil, surcharge + "
           "density "
           "g depth";
  }
  return NULL;
}

const char *pen_check_soil(penetrometer *p, const option *table) {
  const char *reason = check_uses(&p->s, table);
  if (!reason) reason = check_start(p);
  return reason ? reason : complete(&p->s, table);
}

/* ---- stress ---------------------------------------------------------------------------------- */

/* The weight above and the surcharge, sideways K0 times as much. */
static mps_status set_stress(const penetrometer *p, pen_run *r) {
  const pen_settings *s = &p->s;
  mps_particles *set = r->m.particles;
  if (s->gravity == 0.0) {
    if (s->surcharge == 0.0) return MPS_OK;
    mps_status status = mps_particles_add_field(set, "stress", 0);
    for (int c = 0; c < 3 && status == MPS_OK; c++)
      status = mps_particles_set(set, "stress", c, -s->surcharge * (c == pen_up(r) ? 1.0 : s->k0));
    return status;
  }
  r->push.m = &r->m;
  return push_set_stress(&r->push, s->gravity, s->k0, r->size[pen_up(r)], s->surcharge);
}

/* ---- laws ------------------------------------------------------------------------------------ */

static mps_status make_cam_clay(mps_context *context, const pen_settings *s, double shear,
                                mps_material **out) {
  mps_material_cam_clay_def clay = mps_material_cam_clay_defaults();
  clay.critical_slope = s->M;
  clay.compression = s->lambda;
  clay.swelling = s->kappa;
  clay.poisson = s->poisson;
  clay.shear_modulus = shear;
  clay.void_ratio = s->e0;
  clay.preconsolidation = s->surcharge; /* that of the particles follows */
  return mps_material_create_cam_clay(context, &clay, out);
}

/* State of the ground of Cam-Clay, which is the same everywhere, and 0 on a rank without particles
 * until all have the greatest: `stress` vertical and horizontal,
 * and su in triaxial compression from p and pc, (M/2) p^(1 - Lambda) (pc/2)^Lambda. */
static mps_status read_state(penetrometer *p, pen_run *r, mps_status status) {
  const pen_settings *s = &p->s;
  mps_view stress, pc, any;
  if (status == MPS_OK) status = mps_particles_view(r->m.particles, "stress", &stress);
  if (status == MPS_OK) status = mps_particles_view(r->m.particles, "preconsolidation", &pc);
  if (status == MPS_OK) status = mps_particles_view(r->m.particles, "id", &any);
  const int up = pen_up(r);
  double mean = 0.0, found[2] = {0.0, 0.0};
  for (int c = 0; status == MPS_OK && any.shape[0] > 0 && c < 3; c++)
    mean -= *mps_view_f64(&stress, 0, c) / 3.0;
  const double part = 1.0 - s->kappa / s->lambda; /* Lambda */
  if (status == MPS_OK && any.shape[0] > 0) {
    found[0] = -*mps_view_f64(&stress, 0, up == 0 ? 1 : 0);
    found[1] = 0.5 * s->M * pow(mean, 1.0 - part) * pow(0.5 * *mps_view_f64(&pc, 0, 0), part);
  }
  status = app_settle(r->m.a, status);
  if (status == MPS_OK && r->m.a->domain) status = mps_domain_max(r->m.a->domain, 2, found);
  p->state.sideways = found[0], p->state.strength = found[1];
  return status;
}

/* Cam-Clay at rest under the surcharge. G = Ir su needs the state that su follows from. */
static mps_status settle_cam_clay(penetrometer *p, pen_run *r) {
  const pen_settings *s = &p->s;
  const mps_consolidation_def state = {.struct_size = sizeof state,
                                       .ocr = s->ocr,
                                       .k0 = NAN,
                                       .critical_volume = NAN,
                                       .reference = 1000.0,
                                       .vertical = -1};
  mps_status status = MPS_OK;
  double shear = NAN;
  for (int pass = 0; pass < (isnan(s->ir) ? 1 : 2) && status == MPS_OK; pass++) {
    mps_material_destroy(&r->m.material);
    status = make_cam_clay(p->context, s, shear, &r->m.material);
    if (status == MPS_OK)
      status = mps_particles_set_consolidation(r->m.particles, r->m.material, &state);
    status = read_state(p, r, status);
    shear = s->ir * p->state.strength;
  }
  p->state.shear = shear;
  if (status == MPS_OK && isnan(s->ir)) { /* by nu, from K at the present state */
    const double mean = (s->surcharge + 2.0 * p->state.sideways) / 3.0;
    p->state.shear =
        1.5 * (1.0 - 2.0 * s->poisson) / (1.0 + s->poisson) * (1.0 + s->e0) * mean / s->kappa;
  }
  return status;
}

static mps_status make_clay(mps_context *context, const pen_settings *s, mps_material **out) {
  mps_material_von_mises_def clay = mps_material_von_mises_defaults();
  clay.young = s->young, clay.poisson = s->poisson;
  clay.yield_stress = ROOT3 * s->cohesion; /* Nakamura (54) */
  return mps_material_create_von_mises(context, &clay, out);
}

static mps_status make_tresca(mps_context *context, const pen_settings *s, mps_material **out) {
  mps_material_mohr_coulomb_def clay = mps_material_mohr_coulomb_defaults();
  clay.young = s->young, clay.poisson = s->poisson, clay.cohesion = s->cohesion;
  clay.friction = clay.dilation = 0.0;
  return mps_material_create_mohr_coulomb(context, &clay, out);
}

static mps_status make_sand(mps_context *context, const pen_settings *s, mps_material **out) {
  const push_sand sand = {.young = s->young,
                          .poisson = s->poisson,
                          .phi = s->phi,
                          .psi = s->psi,
                          .cohesion = s->cohesion,
                          .voids = {s->e0, s->e_max},
                          .cone = MPS_MATERIAL_CONE_INSCRIBED};
  return push_make_sand(context, &sand, out);
}

static mps_status make_law(penetrometer *p, pen_run *r) {
  const pen_settings *s = &p->s;
  mps_material **out = &r->m.material;
  p->state.sideways = s->k0 * s->surcharge;
  p->state.strength = strength_of(s);
  p->state.shear = s->young / (2.0 * (1.0 + s->poisson));
  switch (s->law) {
  case PEN_CLAY:
    return make_clay(p->context, s, out);
  case PEN_TRESCA:
    return make_tresca(p->context, s, out);
  case PEN_SAND:
    return make_sand(p->context, s, out);
  case PEN_CAM_CLAY:
    return settle_cam_clay(p, r);
  default:
    return mps_material_create_linear_elastic(p->context, s->young, s->poisson, out);
  }
}

/* ---- particles ------------------------------------------------------------------------------- */

typedef struct place_of {
  const penetrometer *p;
  const pen_run *r;
} place_of;

/* Outside the tip and its shaft as they stand at the start. */
static mps_status outside_hole(void *user, const double *x, int32_t *inside) {
  const place_of *of = user;
  const penetrometer *p = of->p;
  const int up = pen_up(of->r);
  const double over = x[up] - (of->r->size[up] - p->s.start), R = pen_radius(p);
  const double away = up == 2 ? hypot(x[0], x[1]) : fabs(x[0]);
  *inside = !(over > 0.0 && away < fmin(R, R * over / pen_shoulder(p)) + 1e-6 * p->s.h);
  return MPS_OK;
}

static mps_status fill(penetrometer *p, pen_run *r, const double *lower) {
  place_of of = {p, r};
  return p->s.start > 0.0
             ? mps_particles_fill_where(r->m.particles, lower, r->size, outside_hole, &of, NULL)
             : mps_particles_fill_box(r->m.particles, lower, r->size, NULL);
}

/* The places at the start, for the displacements at the end. */
static mps_status keep_places(pen_run *r) {
  mps_view x;
  const int dim = pen_up(r) + 1;
  mps_status status = mps_particles_add_field(r->m.particles, "user.start", dim);
  if (status == MPS_OK) status = mps_particles_view(r->m.particles, "position", &x);
  for (int c = 0; status == MPS_OK && c < dim; c++)
    status = mps_particles_set_array(r->m.particles, "user.start", c, mps_view_f64(&x, 0, c),
                                     x.shape[0]);
  return status;
}

mps_status pen_make_soil(penetrometer *p, pen_run *r, const double *lower) {
  const pen_settings *s = &p->s;
  mps_particles_def set = mps_particles_defaults();
  set.dim = pen_up(r) + 1;
  set.spacing = s->h / nearbyint(cbrt((double)s->ppc));
  mps_status status = mpm_model_particles(&r->m, p->context, &set);
  if (status == MPS_OK) status = fill(p, r, lower);
  r->particles = mps_particles_count(r->m.particles);
  if (status == MPS_OK) status = mpm_model_sum(&r->m, &r->particles);
  if (status == MPS_OK) status = mps_particles_set(r->m.particles, "density", 0, s->density);
  if (status == MPS_OK) status = set_stress(p, r);
  if (status == MPS_OK) status = keep_places(r);
  status = app_settle(r->m.a, status);
  return status == MPS_OK ? make_law(p, r) : status;
}

/* ---- water and load -------------------------------------------------------------------------- */

static bool at_surface(const void *user, const double *x) {
  const pen_run *r = user;
  return x[pen_up(r)] > r->size[pen_up(r)] - mps_particles_spacing(r->m.particles);
}

/* The surcharge, on the uppermost particles. */
static mps_status press(const penetrometer *p, pen_run *r) {
  mps_mpm_load_def load = mps_mpm_load_defaults();
  int64_t *ids;
  mps_status status = mpm_model_list(&r->m, at_surface, r, &load.id_count, &ids);
  load.ids = ids;
  load.traction[pen_up(r)] = -p->s.surcharge;
  if (status == MPS_OK) status = mps_mpm_add_load(r->m.mpm, &load, NULL);
  free(ids);
  return status;
}

mps_status pen_load_soil(const penetrometer *p, pen_run *r) {
  const pen_settings *s = &p->s;
  mps_status status = MPS_OK;
  if (s->law == PEN_CAM_CLAY) { /* undrained, or drained by the surface */
    mps_pore_water_def water = mps_pore_water_defaults();
    water.porosity = s->e0 / (1.0 + s->e0);
    water.permeability = s->permeability;
    if (!isnan(s->permeability)) water.scheme = MPS_PORE_SCHEME_IMPLICIT; /* else dt ~ h^2/k */
    water.density = PEN_WATER;
    status = mps_mpm_add_pore_water(r->m.mpm, &water);
  }
  return status == MPS_OK && s->surcharge > 0.0 ? press(p, r) : status;
}

/* ---- cone factors ---------------------------------------------------------------------------- */

double pen_vertical(const penetrometer *p, double depth) {
  return p->s.surcharge + p->s.density * p->s.gravity * depth;
}

/* Of a smooth cone of 60 degrees. C. I. Teh, G. T. Houlsby, Geotechnique 41 (1991) 17-34, for Ir
 * from 50 to 500 (von Mises); Q. Lu, M. F. Randolph, Y. Hu, I. C. Bugarski, Geotechnique 54 (2004)
 * 257-267 (Tresca). */
pen_factor pen_factor_of(const penetrometer *p, double q, double depth) {
  const pen_settings *s = &p->s;
  pen_factor f = {NAN, NAN, NAN, NAN, NAN, NAN, NAN};
  if (s->law == PEN_SAND || s->law == PEN_ELASTIC) return f;
  const double su = p->state.strength, weight = s->density * s->gravity * depth;
  f.strength = su;
  f.rigidity = p->state.shear / su;
  f.vertical = pen_vertical(p, depth);
  f.n_kt = (q - f.vertical) / su;
  const double sideways = p->state.sideways + s->k0 * weight;
  f.deviation = (f.vertical - sideways) / (2.0 * su);
  const double ln = log(f.rigidity);
  f.teh_houlsby = 4.0 / 3.0 * (1.0 + ln) * (1.25 + f.rigidity / 2000.0) - 1.8 * f.deviation;
  f.lu = 3.4 + 1.6 * ln - 1.9 * f.deviation;
  return f;
}
