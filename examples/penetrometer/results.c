/* results.c - force.csv, section.csv, summary.json, and their report on the terminal.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "penetrometer.h"

#include "common/frame.h"

#include <mps/pore_water.h>

#include <math.h>
#include <stdio.h>

#define LAST 0.2 /* of the path: means for the summary */
/* v D/c_v, above which a warning: N_kt by implicit pressures was right at 33, 9 % low at 335. */
#define MOST_SPEED 100.0

double pen_hertz(const penetrometer *p, double depth) {
  const double stiffness = p->s.young / (1.0 - p->s.poisson * p->s.poisson);
  return depth > 0.0 ? 4.0 / 3.0 * stiffness * sqrt(pen_radius(p)) * pow(depth, 1.5) : 0.0;
}

static double base_area(const penetrometer *p) { return PEN_PI * pen_radius(p) * pen_radius(p); }

/* Means over the last part of the path (N); of Hertz' force too. */
typedef struct mean {
  double force[PEN_FORCES], hertz, depth; /* N, N, m */
} mean;

static mean mean_of(const penetrometer *p, const pen_run *r) {
  mean m = {{0.0}, 0.0, 0.0};
  int64_t count = 0;
  for (int64_t i = 0; i < r->rows; i++) {
    if (r->row[i].depth < p->s.start + (1.0 - LAST) * (pen_reached(r) - p->s.start)) continue;
    for (int k = 0; k < PEN_FORCES; k++) m.force[k] += r->row[i].force[k];
    m.hertz += pen_hertz(p, r->row[i].depth);
    m.depth += r->row[i].depth;
    count++;
  }
  for (int k = 0; k < PEN_FORCES; k++) m.force[k] = count ? m.force[k] / (double)count : NAN;
  m.hertz = count ? m.hertz / (double)count : NAN;
  m.depth = count ? m.depth / (double)count : NAN;
  return m;
}

/* ---- files ----------------------------------------------------------------------------------- */

static bool write_force(app *a, const penetrometer *p, const pen_run *r, const char *name) {
  output f;
  if (!output_open(&f, a, p->s.out, name)) return false;
  csv_header(&f, "depth_m,total_N,tip_N,shaft_N,total_smooth_N,tip_smooth_N,shaft_smooth_N,"
                 "q_kPa,q_over_c?,n_kt?");
  for (int64_t i = 0; i < r->rows; i++) {
    const pen_row *row = &r->row[i];
    const double q = row->smooth[PEN_TIP] / base_area(p);
    const double ratio = p->s.cohesion > 0.0 ? q / p->s.cohesion : NAN;
    const double line[] = {row->depth,
                           row->force[PEN_TOTAL],
                           row->force[PEN_TIP],
                           row->force[PEN_SHAFT],
                           row->smooth[PEN_TOTAL],
                           row->smooth[PEN_TIP],
                           row->smooth[PEN_SHAFT],
                           1e-3 * q,
                           ratio,
                           pen_factor_of(p, q, row->depth).n_kt};
    csv_row(&f, 10, line);
  }
  return output_close(&f);
}

static bool write_section(app *a, const penetrometer *p) {
  output f;
  if (!output_open(&f, a, p->s.out, "section.csv")) return false;
  csv_header(&f, "x_m,z_m,displacement_m,plastic_strain");
  for (int k = 0; k < p->runs; k++)
    for (int64_t i = 0; i < p->run[k].points; i++) {
      const pen_point *point = &p->run[k].point[i];
      const double row[] = {point->x, point->z, point->moved, point->strain};
      csv_row(&f, 4, row);
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
  json_number(f, "h", s->h);
  json_number(f, "flip_time", s->flip_time);
  json_number(f, "diameter", s->diameter);
  json_number(f, "rate", s->rate);
  json_number(f, "friction", s->friction);
  if (s->alpha > 0.0) json_number(f, "alpha", s->alpha);
  if (s->contact == MPS_CONTACT_METHOD_IMPULSE) json_number(f, "corner", s->corner);
  json_number(f, "half_width", p->run[0].size[0]);
  json_number(f, "soil_height",
              p->run[0].size[p->run[0].geometry == MPS_MPM_GEOMETRY_SPACE ? 2 : 1]);
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

/* Undrained ground: the net cone factor and what it refers to. */
static void write_factor(output *f, const penetrometer *p, const mean *m) {
  const pen_settings *s = &p->s;
  const pen_factor n = pen_factor_of(p, m->force[PEN_TIP] / base_area(p), m->depth);
  if (s->start > 0.0) json_number(f, "start", s->start);
  if (s->surcharge > 0.0) json_number(f, "surcharge", s->surcharge);
  if (p->hold > 0.0) json_number(f, "q_at_rest", p->run[0].rest / base_area(p));
  if (isnan(n.strength)) return;
  json_number(f, "su", n.strength);
  json_number(f, "rigidity_index", n.rigidity);
  json_number(f, "vertical_stress", n.vertical);
  json_number(f, "stress_deviation", n.deviation);
  json_number(f, "n_kt", n.n_kt);
  if (isfinite(n.teh_houlsby)) json_number(f, "n_kt_teh_houlsby", n.teh_houlsby);
  if (isfinite(n.lu)) json_number(f, "n_kt_lu", n.lu);
  if (!isnan(speed_of(s))) json_number(f, "v_d_over_cv", speed_of(s));
}

/* Of the first run; of both for conditions that must never occur. */
static bool write_summary(app *a, const penetrometer *p, const mean *m) {
  const pen_run *r = &p->run[0], *other = &p->run[p->runs - 1];
  output f;
  if (speed_of(&p->s) > MOST_SPEED)
    app_warn(a,
             "V = v D/c_v is %.3g: hardly any water flows, and the implicit pressures of "
             "--permeability lag: N_kt comes out up to 10 %% too low; undrained ground (without "
             "--permeability) is nearer",
             speed_of(&p->s));
  if (!mpm_model_summary(a, &r->m, p->s.out, &f)) return false;
  write_settings(&f, p);
  json_number(&f, "depth", pen_reached(r));
  json_number(&f, "force_total", m[0].force[PEN_TOTAL]);
  json_number(&f, "force_tip", m[0].force[PEN_TIP]);
  json_number(&f, "force_shaft", m[0].force[PEN_SHAFT]);
  json_number(&f, "q", m[0].force[PEN_TIP] / base_area(p));
  if (p->s.law == PEN_CLAY || p->s.law == PEN_TRESCA)
    json_number(&f, "n_factor", m[0].force[PEN_TIP] / base_area(p) / p->s.cohesion);
  write_factor(&f, p, &m[0]);
  if (p->s.law == PEN_ELASTIC && p->s.tip == PEN_SPHERE) {
    json_number(&f, "force_hertz", m[0].hertz);
    json_number(&f, "hertz_error", m[0].force[PEN_TOTAL] / m[0].hertz - 1.0);
  }
  if (p->runs == 2) {
    json_integer(&f, "axisymmetric_particles", other->particles);
    json_number(&f, "axisymmetric_radius", other->size[0]);
    json_number(&f, "axisymmetric_force_total", m[1].force[PEN_TOTAL]);
    json_number(&f, "space_over_axisymmetric", m[0].force[PEN_TOTAL] / m[1].force[PEN_TOTAL]);
  }
  json_integer(&f, "particles_inside", r->inside > other->inside ? r->inside : other->inside);
  json_number(&f, "deepest_inside", fmax(r->deepest, other->deepest));
  json_number(&f, "volume_ratio_max", fmax(r->ratio_max, other->ratio_max));
  json_number(&f, "volume_ratio_min", fmin(r->ratio_min, other->ratio_min));
  json_end(&f);
  return output_close(&f);
}

/* ---- terminal -------------------------------------------------------------------------------- */

static void tell_factor(pen_factor n) {
  if (!isfinite(n.n_kt)) return;
  printf("net cone factor N_kt = (q - %.4g kPa)/su = %.4g, su = %.4g kPa in triaxial compression, "
         "Ir = G/su = %.4g",
         1e-3 * n.vertical, n.n_kt, 1e-3 * n.strength, n.rigidity);
  if (isfinite(n.teh_houlsby))
    printf("; Teh and Houlsby %.4g, %+.1f %%", n.teh_houlsby,
           100.0 * (n.n_kt / n.teh_houlsby - 1.0));
  if (isfinite(n.lu)) printf("; Lu et al. %.4g, %+.1f %%", n.lu, 100.0 * (n.n_kt / n.lu - 1.0));
  printf("\n");
}

static void tell_run(const penetrometer *p, const pen_run *r, const mean *m) {
  const double q = m->force[PEN_TIP] / base_area(p);
  if (isfinite(m->force[PEN_TOTAL]))
    printf("%s: mean of the last fifth of %.4g m: %.5g N = tip %.5g + shaft %.5g N, q = %.4g kPa",
           r->geometry == MPS_MPM_GEOMETRY_SPACE ? "space" : "axisymmetric", pen_reached(r),
           m->force[PEN_TOTAL], m->force[PEN_TIP], m->force[PEN_SHAFT], 1e-3 * q);
  if (p->s.cohesion > 0.0 && p->s.law != PEN_SAND && p->s.law != PEN_ELASTIC && isfinite(q))
    printf(" = %.4g c", q / p->s.cohesion);
  if (p->s.law == PEN_ELASTIC && p->s.tip == PEN_SPHERE && m->hertz > 0.0)
    printf("; Hertz %.5g N, %+.2f %%", m->hertz, 100.0 * (m->force[PEN_TOTAL] / m->hertz - 1.0));
  printf("\n");
  tell_factor(pen_factor_of(p, q, m->depth));
  if (isfinite(r->ratio_min))
    printf("V/V0 %.4g to %.4g, particles inside the tip: %lld\n", r->ratio_min, r->ratio_max,
           (long long)r->inside);
}

bool pen_finish(app *a, void *user) {
  penetrometer *p = user;
  mpm_model *model = &p->run[0].m;
  mps_particles *soil = model->whole ? model->whole : model->particles;
  const mean m[2] = {mean_of(p, &p->run[0]), mean_of(p, &p->run[1])};
  if (p->runs == 2 && p->run[1].rows < MPM_MODEL_SAMPLES) p->runs = 1; /* interrupted before */
  if (!write_force(a, p, &p->run[0], "force.csv") || !write_section(a, p) ||
      (p->runs == 2 && !write_force(a, p, &p->run[1], "force-axisymmetric.csv")) ||
      !write_summary(a, p, m) || !frame_write(a, soil, p->s.out, "soil.vtkhdf") || !pen_draw(a, p))
    return false;
  app_tell_results(a, p->s.out);
  for (int k = 0; k < p->runs; k++) tell_run(p, &p->run[k], &m[k]);
  return true;
}
