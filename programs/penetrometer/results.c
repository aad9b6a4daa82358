/* results.c - force.csv, section.csv, summary.json, and their report on the terminal.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "penetrometer.h"

#include "common/compare.h"
#include "common/frame.h"

#include <mps/experimental/pore_water.h>

#include <math.h>
#include <stdio.h>

#define LAST 0.2 /* of the path: means for the summary */
/* A deep cone: its tip so far below the surface, and on its way, in diameters. */
#define DEEP 5.0
#define UNDER_WAY 1.0
#define WIDE 0.8 /* of the plastic zone's radius, R Ir^1/2: half the width of the ground */
/* Hertz: the contact radius over that of the sphere, the width of the ground over it, and the part
 * of the force that is a dashpot's. */
#define SHALLOW 0.3
#define HALF_SPACE 8.0
#define SLOWLY 0.05

double pen_hertz(const penetrometer *p, double depth) {
  const double stiffness = p->s.young / (1.0 - p->s.poisson * p->s.poisson);
  return depth > 0.0 ? 4.0 / 3.0 * stiffness * sqrt(pen_radius(p)) * pow(depth, 1.5) : 0.0;
}

static double base_area(const penetrometer *p) { return PUSH_PI * pen_radius(p) * pen_radius(p); }

/* Means over the last part of the path (N); of Hertz' force too. */
typedef struct mean {
  double force[PUSH_FORCES], hertz, depth; /* N, N, m */
} mean;

static mean mean_of(const penetrometer *p, const pen_run *r) {
  mean m = {{0.0}, 0.0, 0.0};
  int64_t count = 0;
  for (int64_t i = 0; i < r->push.rows; i++) {
    if (r->push.row[i].depth < p->s.start + (1.0 - LAST) * (pen_reached(r) - p->s.start)) continue;
    for (int k = 0; k < PUSH_FORCES; k++) m.force[k] += r->push.row[i].force[k];
    m.hertz += pen_hertz(p, r->push.row[i].depth);
    m.depth += r->push.row[i].depth;
    count++;
  }
  for (int k = 0; k < PUSH_FORCES; k++) m.force[k] = count ? m.force[k] / (double)count : NAN;
  m.hertz = count ? m.hertz / (double)count : NAN;
  m.depth = count ? m.depth / (double)count : NAN;
  return m;
}

/* ---- files ----------------------------------------------------------------------------------- */

static bool write_force(app *a, const penetrometer *p, const pen_run *r, const char *name) {
  output f;
  if (!csv_open(&f, a, p->s.out, name,
                "depth_m,total_N,tip_N,shaft_N,total_smooth_N,tip_smooth_N,shaft_smooth_N,"
                "q_kPa,q_over_c?,n_kt?"))
    return false;
  for (int64_t i = 0; i < r->push.rows; i++) {
    const push_row *row = &r->push.row[i];
    const double q = row->smooth[PEN_TIP] / base_area(p);
    const double ratio = p->s.cohesion > 0.0 ? q / p->s.cohesion : NAN;
    CSV_LINE(&f, row->depth, row->force[PEN_TOTAL], row->force[PEN_TIP], row->force[PEN_SHAFT],
             row->smooth[PEN_TOTAL], row->smooth[PEN_TIP], row->smooth[PEN_SHAFT], 1e-3 * q, ratio,
             pen_factor_of(p, q, row->depth).n_kt);
  }
  return output_close(&f);
}

static bool write_section(app *a, const penetrometer *p) {
  output f;
  if (!csv_open(&f, a, p->s.out, "section.csv", "x_m,z_m,displacement_m,plastic_strain"))
    return false;
  for (int k = 0; k < p->runs; k++)
    for (int64_t i = 0; i < p->run[k].points; i++) {
      const pen_point *point = &p->run[k].point[i];
      CSV_LINE(&f, point->x, point->z, point->moved, point->strain);
    }
  return output_close(&f);
}

static void write_settings(output *f, const penetrometer *p) {
  static const char *const tips[] = {"cone", "sphere", "stl"};
  static const char *const laws[] = {"clay", "sand", "elastic", "tresca", "mcc"};
  const pen_settings *s = &p->s;
  json_text(f, "tip", tips[s->tip]);
  json_text(f, "law", laws[s->law]);
  json_text(f, "geometry", p->run[0].geometry == MPS_MPM_GEOMETRY_SPACE ? "space" : "axisymmetric");
  JSON_NUMBERS(f, {"cell", s->h}, {"flip_time", s->flip_time});
  sand_write(f, &(sand_voids){s->e0, s->e_max}, s->law == PEN_SAND ? s->psi : 0.0);
  JSON_NUMBERS(f, {"diameter", s->diameter}, {"rate", s->rate}, {"friction", s->friction});
  if (s->alpha > 0.0) json_number(f, "alpha", s->alpha);
  if (s->contact == MPS_CONTACT_METHOD_IMPULSE) json_number(f, "corner", s->corner);
  if (s->inset > 0.0) json_number(f, "inset", s->inset);
  JSON_NUMBERS(
      f, {"half_width", p->run[0].size[0]},
      {"soil_height", p->run[0].size[p->run[0].geometry == MPS_MPM_GEOMETRY_SPACE ? 2 : 1]});
  if (p->s.contact == MPS_CONTACT_METHOD_PENALTY) json_number(f, "penalty", p->run[0].penalty);
  json_number(f, "dt", p->run[0].dt);
}

/* V = v D/c_v, c_v of virgin compression at the stress before; NAN where no water flows. */
static double speed_of(const pen_settings *s) {
  if (s->law != PEN_CAM_CLAY || isnan(s->permeability)) return NAN;
  const double c_v =
      s->permeability * (1.0 + s->e0) * s->surcharge / (s->lambda * MPS_PORE_GRAVITY * PEN_WATER);
  return s->rate * s->diameter / c_v;
}

/* Solutions of a deep, smooth cone of 60 degrees in undrained, perfectly plastic ground. */
static comparison compare_cone(const penetrometer *p, const mean *m, const char *source,
                               double value, double reference) {
  const pen_settings *s = &p->s;
  const double zone = WIDE * sqrt(p->state.shear / p->state.strength) * pen_radius(p);
  const double shear = sqrt(p->state.shear / s->density);
  comparison c = compare_with(source, value, reference);
  compare_require(&c, s->tip == PEN_CONE, "it is of a cone");
  compare_require(&c, fabs(s->angle - 60.0) <= 1e-9, "it is of a cone of 60 degrees");
  compare_require(&c, s->friction == 0.0, "it is of a smooth cone");
  compare_require(&c, isnan(speed_of(s)), "it is of undrained ground, and water flows");
  compare_require(&c, m->depth >= DEEP * s->diameter,
                  "it is of a deep cone, from %g diameters on, and this one is at %.3g", DEEP,
                  m->depth / s->diameter);
  compare_require(&c, m->depth - s->start >= UNDER_WAY * s->diameter,
                  "the cone is %.2g diameters on its way, and its resistance is steady from %g on",
                  (m->depth - s->start) / s->diameter, UNDER_WAY);
  compare_require(&c, p->run[0].size[0] >= zone,
                  "the ground is %.3g m wide to each side, its plastic zone would be %.3g m",
                  p->run[0].size[0], zone);
  compare_require(&c, s->rate <= SLOWLY * shear,
                  "the cone moves at %.2g times the velocity of shear waves: inertia counts",
                  s->rate / shear);
  return c;
}

typedef struct cone_theory {
  pen_factor n;
  comparison teh_houlsby, lu;
} cone_theory;

static cone_theory find_cone(const penetrometer *p, const mean *m) {
  cone_theory t = {.n = pen_factor_of(p, m->force[PEN_TIP] / base_area(p), m->depth)};
  const double Ir = t.n.rigidity;
  t.teh_houlsby = compare_cone(p, m, "Teh and Houlsby", t.n.n_kt, t.n.teh_houlsby);
  compare_require(&t.teh_houlsby, Ir >= 50.0 * (1.0 - 1e-9) && Ir <= 500.0 * (1.0 + 1e-9),
                  "it is of Ir = 50 to 500, here it is %.4g", Ir);
  t.lu = compare_cone(p, m, "Lu et al.", t.n.n_kt, t.n.lu);
  return t;
}

/* A smooth sphere on an elastic half space, slowly, and shallow beside its radius. */
static comparison compare_hertz(const penetrometer *p, const mean *m) {
  const pen_settings *s = &p->s;
  const double R = pen_radius(p), a = sqrt(R * fmax(0.0, m->depth));
  const double G = 0.5 * s->young / (1.0 + s->poisson);
  const double dashpot = 3.4 * a * a * sqrt(G * s->density) / (1.0 - s->poisson) * s->rate;
  const int up = p->run[0].geometry == MPS_MPM_GEOMETRY_SPACE ? 2 : 1;
  const double least = fmin(p->run[0].size[0], p->run[0].size[up]);
  comparison c = compare_with("Hertz", m->force[PEN_TOTAL], m->hertz);
  compare_require(&c, m->depth > 0.0, "the sphere has not reached the ground");
  compare_require(&c, s->friction == 0.0, "it is of a smooth sphere");
  compare_require(&c, s->start == 0.0, "it is of a sphere on the surface");
  compare_require(&c, a <= SHALLOW * R,
                  "the contact's radius is %.2g of the sphere's, and it is of a small one", a / R);
  compare_require(&c, least >= HALF_SPACE * a,
                  "the ground is %.3g contact radii wide to each side or deep, less than %g: it is "
                  "of a half space",
                  least / a, HALF_SPACE);
  compare_require(&c, dashpot <= SLOWLY * m->hertz,
                  "at this speed the waves that leave take %.0f %% of the force",
                  100.0 * dashpot / m->hertz);
  return c;
}

/* Undrained ground: the net cone factor and what it refers to. */
static void write_factor(output *f, const penetrometer *p, const mean *m) {
  const pen_settings *s = &p->s;
  const cone_theory t = find_cone(p, m);
  const pen_factor n = t.n;
  if (s->start > 0.0) json_number(f, "start", s->start);
  if (s->surcharge > 0.0) json_number(f, "surcharge", s->surcharge);
  if (p->hold > 0.0) json_number(f, "q_at_rest", p->run[0].rest / base_area(p));
  if (isnan(n.strength)) return;
  JSON_NUMBERS(f, {"su", n.strength}, {"rigidity_index", n.rigidity},
               {"vertical_stress", n.vertical}, {"stress_deviation", n.deviation},
               {"n_kt", n.n_kt});
  json_comparison(f, "n_kt_teh_houlsby", &t.teh_houlsby);
  json_comparison(f, "n_kt_lu", &t.lu);
  if (!isnan(speed_of(s))) json_number(f, "v_d_over_cv", speed_of(s));
}

/* Of the first run; of both for conditions that must never occur. */
static bool write_summary(app *a, const penetrometer *p, const mean *m) {
  const pen_run *r = &p->run[0], *other = &p->run[p->runs - 1];
  output f;
  if (!mpm_model_summary(a, &r->m, p->s.out, &f)) return false;
  write_settings(&f, p);
  JSON_NUMBERS(&f, {"depth", pen_reached(r)}, {"force_total", m[0].force[PEN_TOTAL]},
               {"force_tip", m[0].force[PEN_TIP]}, {"force_shaft", m[0].force[PEN_SHAFT]},
               {"q", m[0].force[PEN_TIP] / base_area(p)});
  if (p->s.law == PEN_CLAY || p->s.law == PEN_TRESCA)
    json_number(&f, "n_factor", m[0].force[PEN_TIP] / base_area(p) / p->s.cohesion);
  write_factor(&f, p, &m[0]);
  if (p->s.law == PEN_ELASTIC && p->s.tip == PEN_SPHERE) {
    const comparison hertz = compare_hertz(p, &m[0]);
    json_comparison(&f, "force_hertz", &hertz);
    json_number(&f, "hertz_error", compare_error(&hertz));
  }
  if (p->runs == 2) {
    json_integer(&f, "axisymmetric_particles", other->particles);
    JSON_NUMBERS(&f, {"axisymmetric_radius", other->size[0]},
                 {"axisymmetric_force_total", m[1].force[PEN_TOTAL]},
                 {"space_over_axisymmetric", m[0].force[PEN_TOTAL] / m[1].force[PEN_TOTAL]});
  }
  json_integer(&f, "particles_inside",
               r->push.seen.inside > other->push.seen.inside ? r->push.seen.inside
                                                             : other->push.seen.inside);
  JSON_NUMBERS(&f, {"deepest_inside", fmax(r->push.seen.deepest, other->push.seen.deepest)},
               {"volume_ratio_max", fmax(r->push.seen.ratio_max, other->push.seen.ratio_max)},
               {"volume_ratio_min", fmin(r->push.seen.ratio_min, other->push.seen.ratio_min)});
  json_end(&f);
  return output_close(&f);
}

/* ---- terminal -------------------------------------------------------------------------------- */

static void tell_factor(const cone_theory *t) {
  const pen_factor n = t->n;
  const comparison *const theory[] = {&t->teh_houlsby, &t->lu};
  if (!isfinite(n.n_kt)) return;
  printf("net cone factor N_kt = (q - %.4g kPa)/su = %.4g, su = %.4g kPa in triaxial compression, "
         "Ir = G/su = %.4g",
         1e-3 * n.vertical, n.n_kt, 1e-3 * n.strength, n.rigidity);
  for (int k = 0; k < 2; k++)
    if (compare_holds(theory[k]))
      printf("; %s %.4g, %+.1f %%", theory[k]->source, theory[k]->reference,
             100.0 * compare_error(theory[k]));
  printf("\n");
  compare_tell(&t->teh_houlsby);
  compare_tell(&t->lu);
}

static void tell_run(const penetrometer *p, const pen_run *r, const mean *m) {
  const double q = m->force[PEN_TIP] / base_area(p);
  if (isfinite(m->force[PEN_TOTAL]))
    printf("%s: mean of the last fifth of %.4g m: %.5g N = tip %.5g + shaft %.5g N, q = %.4g kPa",
           r->geometry == MPS_MPM_GEOMETRY_SPACE ? "space" : "axisymmetric", pen_reached(r),
           m->force[PEN_TOTAL], m->force[PEN_TIP], m->force[PEN_SHAFT], 1e-3 * q);
  if (p->s.cohesion > 0.0 && p->s.law != PEN_SAND && p->s.law != PEN_ELASTIC && isfinite(q))
    printf(" = %.4g c", q / p->s.cohesion);
  const bool elastic = p->s.law == PEN_ELASTIC && p->s.tip == PEN_SPHERE;
  const comparison hertz = compare_hertz(p, m);
  if (elastic && compare_holds(&hertz))
    printf("; Hertz %.5g N, %+.2f %%", m->hertz, 100.0 * compare_error(&hertz));
  printf("\n");
  if (elastic) compare_tell(&hertz);
  const cone_theory t = find_cone(p, m);
  tell_factor(&t);
  if (isfinite(r->push.seen.ratio_min))
    printf("V/V0 %.4g to %.4g, particles inside the tip: %lld\n", r->push.seen.ratio_min,
           r->push.seen.ratio_max, (long long)r->push.seen.inside);
  if (p->s.law == PEN_SAND) sand_print(&(sand_voids){p->s.e0, p->s.e_max}, p->s.psi);
}

bool pen_finish(app *a, void *user) {
  penetrometer *p = user;
  mpm_model *model = &p->run[0].m;
  mps_particles *soil = model->whole ? model->whole : model->particles;
  const mean m[2] = {mean_of(p, &p->run[0]), mean_of(p, &p->run[1])};
  if (p->runs == 2 && p->run[1].push.rows < MPM_MODEL_SAMPLES) p->runs = 1; /* interrupted before */
  if (!write_force(a, p, &p->run[0], "force.csv") || !write_section(a, p) ||
      (p->runs == 2 && !write_force(a, p, &p->run[1], "force-axisymmetric.csv")) ||
      !write_summary(a, p, m) || !frame_write(a, soil, p->s.out, "soil.vtkhdf") || !pen_draw(a, p))
    return false;
  app_tell_results(a, p->s.out);
  for (int k = 0; k < p->runs; k++) tell_run(p, &p->run[k], &m[k]);
  return true;
}
