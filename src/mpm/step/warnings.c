/* warnings.c - see warnings.h. SPDX-License-Identifier: BSD-3-Clause */
#include "warnings.h"

#include "body/body_internal.h"
#include "mpm/water/water.h"

#define CHATTER 6.0        /* k dt^2/m above which a penalty contact oscillates */
#define LARGEST_VOLUME 1.3 /* V/V0 above which ground is warned of, */
#define VOLUMES_EVERY 16   /* looked at in so many steps, */
#define BODIES_EVERY 64    /* as overlaps of bodies in so many */
#define BEYOND 0.1         /* cells of a free body's reference point beyond a side */
#define WET 0.1            /* share of a normal force by water above which friction is warned of */
#define STEADY 500         /* steps after which an acceleration is none of a motion to and fro */

static void warn_about_courant(mps_mpm *mpm) {
  const double dt = mpm->run.dt, limit = mpsi_mpm_limit(mpm), courant = mpm->def.courant;
  if (mpm->run.warned_about_dt || !(dt > courant * limit * (1.0 + 1e-9))) return;
  mpm->run.warned_about_dt = true;
  mpsi_log(mpm->context, MPS_CONTEXT_LOG_WARNING,
           "step %lld: dt is %.4g s, %.3g of the Courant limit h/(c + v), above the fraction "
           "courant = %g: choose a smaller dt, or NaN for a step that follows the limit",
           (long long)mpm->run.steps, dt, dt / limit, courant);
}

static void warn_about_chatter(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                               const mpsi_contacts *contacts, const mps_mpm_def *def, double dt) {
  double stiffest = 0.0;
  for (int32_t k = 0; k < p->laws.count; k++) stiffest = fmax(stiffest, p->laws.law[k].modulus);
  for (int32_t b = 0; b < contacts->bodies; b++) {
    const mps_contact *contact = contacts->handle[b];
    if (mpsi_by_impulses(contact)) continue;
    const double k =
        grid->measure * mpsi_contact_penalty(contact, stiffest, mps_particles_spacing(p->set),
                                             grid->cell, def->courant);
    const double ratio = k * dt * dt / contacts->least_mass;
    if (!(ratio > CHATTER) || contacts->state[b].warned) continue;
    contacts->state[b].warned = true;
    mpsi_log(context, MPS_CONTEXT_LOG_WARNING,
             "contact with body %d will chatter: k dt^2/m = %.3g, above %g; use a penalty k of at "
             "most %.4g or a dt of at most %.4g s",
             b, ratio, CHATTER, k * CHATTER / ratio, dt * sqrt(CHATTER / ratio));
  }
}

/* V/V0 of a particle; V0 is its mass over its density as written. Water that has come into the
 * pores or left them since is part of the mass. */
static double volume_ratio(const mpsi_columns *p, double water, double density, int64_t k) {
  if (!(density > 1.05 * water)) return 1.0; /* no solid beside the water */
  return p->V[k] * (density - water) / (p->m[k] - water * p->V[k]);
}

/* The loosest sand has 1.3 of the volume of the densest. */
void mpsi_step_warn_about_volume(mps_mpm *mpm) {
  const mpsi_columns *p = &mpm->p;
  if (mpm->run.warned_about_volume || mpm->run.steps % VOLUMES_EVERY != 0) return;
  bool some = false;
  for (int32_t k = 0; k < p->laws.count && !some; k++)
    some = mpsi_material_keeps_volume(p->laws.law[k].material);
  if (!some) return;
  const double *density = mpsi_particles_column(p->set, "density", 0);
  const double water = mpm->water ? mpm->water->def.density : 0.0;
  double largest = LARGEST_VOLUME;
  int64_t at = -1;
  for (int64_t k = 0; k < p->count; k++) {
    const double ratio = volume_ratio(p, water, density[k], k);
    if (!(ratio > largest) || !mpsi_material_keeps_volume(mpsi_law_of(p, k)->material)) continue;
    largest = ratio, at = k;
  }
  if (at < 0) return;
  mpm->run.warned_about_volume = true;
  const mps_material *law = mpsi_law_of(p, at)->material;
  mpsi_log(
      mpm->context, MPS_CONTEXT_LOG_WARNING,
      "step %lld: particle %lld at (%.4g, %.4g, %.4g) m has grown to %.3g of its first volume, "
      "above %g: %s",
      (long long)mpm->run.steps, (long long)p->laws.ids[at], p->x[0][at], p->x[1][at],
      mpm->grid.dim == 3 ? p->x[2][at] : 0.0, largest, LARGEST_VOLUME,
      mpsi_material_dilates_without_end(law)
          ? "the dilation of its law has no end; give void_ratio and max_void_ratio, or a "
            "smaller angle of dilation"
          : "no ground does; look for a wall that lets it through, or take smaller cells");
}

/* Sides are those of the ground: a body that falls beside it, or drifts to a side, continues
 * through it, as a wall that is to reach beyond the ground does. */
static void warn_about_sides(mps_mpm *mpm) {
  static const char axis[] = "xyz";
  for (int32_t b = 0; b < mpm->contact.bodies; b++) {
    const mps_body *body = mpm->contact.body[b];
    bool *warned = &mpm->contact.state[b].leaves;
    if (body->def.motion != MPS_BODY_MOTION_FREE || *warned) continue;
    for (int side = 0; side < 2 * mpm->grid.dim && !*warned; side++) {
      const int c = side / 2;
      const double sign = side % 2 ? 1.0 : -1.0;
      const double at = side % 2 ? mpm->def.upper[c] : mpm->def.lower[c];
      const double beyond = sign * (body->pose.x[c] - at);
      if (!(beyond > BEYOND * mpm->grid.cell && sign * body->pose.v[c] > 0.0)) continue;
      *warned = true;
      mpsi_log(mpm->context, MPS_CONTEXT_LOG_WARNING,
               "step %lld: free body %d goes through the side %c = %g m of the domain, and its "
               "reference point is %g m beyond it: sides hold particles alone",
               (long long)mpm->run.steps, b, axis[c], at, beyond);
    }
  }
}

/* ---- friction in saturated ground ------------------------------------------------------------ */

/* What ground and water bear in the particles beside a body: sums, Pa. */
static mpsi_borne beside_body(const mps_mpm *mpm, const mps_body *body) {
  const double reach = mps_particles_spacing(mpm->p.set);
  mpsi_borne sum = {0.0, 0.0};
  for (int64_t k = 0; k < mpm->p.count; k++) {
    double x[3] = {0.0};
    for (int c = 0; c < mpm->grid.dim; c++) x[c] = mpm->p.x[c][k];
    const mpsi_foot foot = mpsi_body_foot(body, x);
    if (!(foot.distance < reach)) continue;
    const mpsi_borne own = mpsi_mpm_borne(&mpm->p, mpm->grid.dim, k, foot.normal);
    sum.ground += own.ground, sum.water += own.water;
  }
  return sum;
}

/* By the penalty the stresses of the rows at a body are wrong, and friction is of the total normal
 * force. */
static void warn_about_friction(const mps_mpm *mpm) {
  for (int32_t b = 0; b < mpm->contact.bodies && mpm->water; b++) {
    const mps_contact *contact = mpm->contact.handle[b];
    bool *warned = &mpm->contact.state[b].wet;
    if (!(contact->friction > 0.0) || *warned || mpsi_by_impulses(contact)) continue;
    const mpsi_borne sum = beside_body(mpm, contact->body);
    const double share = sum.water / (sum.water + sum.ground);
    if (!(sum.water > 0.0 && share > WET)) continue;
    *warned = true;
    mpsi_log(mpm->context, MPS_CONTEXT_LOG_WARNING,
             "step %lld: the friction %.4g of body %d by penalty acts on the total normal stress, "
             "of which the water in the pores bears about %.0f %%: use the method IMPULSE, whose "
             "friction is of the effective stress",
             (long long)mpm->run.steps, contact->friction, b, 100.0 * fmin(share, 1.0));
  }
}

void mpsi_step_warn_about_bodies(mps_mpm *mpm) {
  if (mpm->run.steps % BODIES_EVERY != 0) return;
  mpsi_mpm_warn_about_overlaps(mpm->context, &mpm->grid, &mpm->contact, mpm->run.steps);
  warn_about_sides(mpm);
  warn_about_friction(mpm);
}

/* Of water that flows as if there were gravity alone. Shaking, whose mean is 0, moves hardly any; a
 * steady acceleration would change the pressures of water at rest. */
static void warn_about_steady(mps_mpm *mpm) {
  mpsi_run *run = &mpm->run;
  double *const *a = mpm->loads.body_acceleration;
  if (!mpm->water || !mpm->water->flows || run->steady_since < 0) return;
  bool same = true, some = false;
  for (int c = 0; c < mpm->grid.dim; c++) {
    const double now = a[c] && mpm->p.count > 0 ? a[c][0] : 0.0;
    same &= now == run->steady[c], some |= now != 0.0;
    run->steady[c] = now;
  }
  if (!same || !some) run->steady_since = run->steps;
  if (run->steps - run->steady_since < STEADY) return;
  run->steady_since = -1;
  mpsi_log(mpm->context, MPS_CONTEXT_LOG_WARNING,
           "step %lld: the field body_acceleration has been (%.4g, %.4g, %.4g) m/s2 for %d steps, "
           "and the water in the pores does not feel it: it flows by the gravity of the "
           "definition alone; give a steady acceleration as part of that gravity",
           (long long)run->steps, run->steady[0], run->steady[1], run->steady[2], STEADY);
}

void mpsi_step_warn_before(mps_mpm *mpm) {
  warn_about_courant(mpm);
  warn_about_steady(mpm);
  warn_about_chatter(mpm->context, &mpm->grid, &mpm->p, &mpm->contact, &mpm->def, mpm->run.dt);
}
