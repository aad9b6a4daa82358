/* step.c - one step of WLS-MPM: its stages in order, Nakamura 6 and Table 2, in one process and on
 * several ranks.
 *
 * A stage that only this rank makes is left out where the rank has an error, which waits for the
 * next stage with an exchange. Such a stage is made on all ranks whatever their statuses, as others
 * need what it sends; unless it is `later`, all ranks have the same status after it, and an error
 * ends the step. In one process any error does.
 *
 * On an error nothing has changed, but where a particle has left the domain (run.lost: the step is
 * whole) or, in scenes whose steps are not undone (undo.h), has got values that are no numbers
 * (run.broken).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/mpm_solver.h"
#include "mpm/boundary/free_field.h"
#include "mpm/grid/pass.h"
#include "mpm/ranks/messages.h"
#include "mpm/water/water.h"
#include "means.h"
#include "tiles.h"
#include "warnings.h"

typedef struct mpsi_step {
  mps_mpm *mpm;
  const char *function;
  mps_status status; /* of the stages so far on this rank */
  mpsi_pass pass;    /* work on blocks that has not been done yet */
  bool in_contact;   /* some particles may be in contact with a body, here or on another rank */
  bool in_one_wave;  /* contacts are solved within the pass from the particles and back */
  bool unchanged;    /* on ranks: memory and messages are those of the last step */
  bool moved_columns;
  bool ends; /* by an error that all ranks have */
} step;

typedef mps_status (*stage_fn)(step *s);

typedef struct step_stage {
  const char *name;
  bool (*when)(const step *s); /* NULL: in each step */
  stage_fn run;                /* NULL: the exchange alone */
  stage_fn exchange;           /* that follows it on several ranks; NULL: none */
  void (*act)(mps_mpm *mpm);   /* in place of `run`: cannot fail */
} step_stage;

/* Exchanges of a stage that makes them itself: after it all ranks have the same status; they agree
 * on one later. */
static mps_status within(step *s) { return s->status; }
static mps_status later(step *s) { return s->status; }

/* Status of a stage that fails on all ranks alike, while this one may have had an error before. */
static mps_status keep_own(step *s, mps_status status) {
  s->ends = status != MPS_OK;
  return s->ends ? status : s->status;
}

static void walk(step *s, const step_stage *first, int32_t count) {
  for (const step_stage *at = first; at < first + count; at++) {
    if (at->when && !at->when(s)) continue;
    const bool shared = s->mpm->partition && at->exchange;
    const bool all = shared && (at->exchange == within || at->exchange == later);
    if (at->run && (s->status == MPS_OK || all)) s->status = at->run(s);
    if (at->act && s->status == MPS_OK) at->act(s->mpm);
    if (shared) s->status = at->exchange(s);
    const bool agreed = !s->mpm->partition || (shared && at->exchange != later);
    s->ends = s->status != MPS_OK && (agreed || s->ends);
    if (s->ends) return;
  }
}

/* ---- when ------------------------------------------------------------------------------------ */

static bool on_ranks(const step *s) { return s->mpm->partition != NULL; }
static bool has_water(const step *s) { return s->mpm->water != NULL; }
static bool has_bodies(const step *s) { return s->mpm->contact.bodies > 0; }
static bool has_bodies_on_ranks(const step *s) { return on_ranks(s) && has_bodies(s); }

static bool has_strips(const step *s) {
  const mpsi_contacts *contacts = &s->mpm->contact;
  for (int32_t b = 0; b < contacts->bodies; b++)
    if (contacts->handle[b]->inset) return true;
  return false;
}

static bool has_lists(const step *s) { return s->mpm->prescribed.on; }
static bool predicts(const step *s) { return mpsi_pore_predicts(s->mpm); }
static bool is_in_contact(const step *s) { return s->in_contact; }
static bool is_apart(const step *s) { return !s->in_contact; }
static bool changes(const step *s) { return on_ranks(s) && !s->unchanged; }

static bool has_columns(const step *s) { return mpsi_mpm_has_free_field(&s->mpm->boundaries); }

static bool signals_may_refuse(const step *s) {
  const mps_mpm *mpm = s->mpm;
  return on_ranks(s) &&
         mpsi_mpm_signals_may_refuse(&mpm->grid, &mpm->loads, &mpm->boundaries, &mpm->contact);
}

/* The nodes are to be complete before any particle moves. */
static bool is_divided(const step *s) {
  return !s->in_one_wave && (s->in_contact || predicts(s) || has_lists(s));
}

static bool has_means(const step *s) {
  return !s->mpm->p.laws.at_once || s->mpm->p.laws.some_filtered;
}

static bool is_accepted(const step *s) { return s->mpm->p.laws.refusal.cells == NULL; }
static bool has_water_accepted(const step *s) { return has_water(s) && is_accepted(s); }

static bool is_complete(const step *s) {
  return has_water(s) && !(on_ranks(s) && s->mpm->partition->lost != MPS_OK);
}

/* ---- before anything moves ------------------------------------------------------------------- */

static mps_status evaluate_signals(step *s) {
  return mpsi_mpm_evaluate_signals(s->mpm, s->function, s->mpm->run.dt, true);
}

static mps_status agree_on_signals(step *s) {
  return mpsi_mpm_agree_in_step(s->mpm, s->function, s->status, 0, NULL);
}

/* After an error only the tractions at rest of absorbing sides are lost, on several ranks. */
static mps_status find_blocks(step *s) {
  mps_mpm *mpm = s->mpm;
  const mpsi_boundary_setup boundaries = mpsi_boundary_setup_of(mpm);
  const mpsi_contact_setup contacts = mpsi_contact_setup_of(mpm);
  mps_status status = s->status;
  mpsi_mpm_plan_dashpots(&mpm->boundaries, mpm->run.steps);
  for (bool removed = true; removed;) { /* particles have been removed by bodies */
    removed = false;
    const bool renewed = mpm->partition && (mpm->run.stale || mpm->partition->outdated);
    if (mpm->partition) status = mpsi_mpm_partition_update(mpm, s->function, status);
    if (status == MPS_OK && mpm->run.stale) {
      status = mpsi_mpm_sort(mpm, s->function);
      mpm->boundaries.outdated = true;
    }
    if (status != MPS_OK && renewed) return status; /* on all ranks */
    if (status == MPS_OK)
      status = mpsi_mpm_prepare_outflow(mpm->context, &mpm->p, &mpm->boundaries, &mpm->rooms,
                                        mpsi_mpm_any_body_removes(&mpm->contact), s->function);
    const bool dashpots = mpm->boundaries.dashpot_count > 0, well = status == MPS_OK;
    status = mpsi_mpm_update_boundaries(&boundaries, s->function, status);
    status = mpsi_mpm_find_borne(&boundaries, s->function, status);
    if (mpm->partition && well && status != MPS_OK) mpm->run.broken = dashpots;
    status = mpsi_mpm_find_near(mpm, s->function, status);
    status = mpsi_mpm_clear_bodies(&contacts, s->function, status, &removed);
    if (removed) status = mpsi_mpm_apply_edits(mpm, s->function);
    if (removed && status != MPS_OK) return status;
  }
  return status;
}

static mps_status find_forces(step *s) {
  mps_mpm *mpm = s->mpm;
  return mpsi_mpm_find_forces(mpm->context, &mpm->grid, &mpm->p, &mpm->rooms, &mpm->loads,
                              s->function);
}

static mps_status begin_energy(step *s) {
  mps_mpm *mpm = s->mpm;
  MPSI_TRY(mpsi_mpm_energy_begin(mpm->context, &mpm->grid, &mpm->p, &mpm->contact, &mpm->energy,
                                 &mpm->def, s->function));
  return mpsi_mpm_begin_balance(mpm->context, &mpm->grid, &mpm->p, &mpm->settling, &mpm->def,
                                s->function);
}

static mps_status prepare_undo(step *s) { return mpsi_mpm_prepare_undo(s->mpm, s->function); }
static mps_status begin_water(step *s) { return mpsi_pore_begin(s->mpm, s->function, s->status); }

static mps_status agree_before_step(step *s) {
  return mpsi_mpm_agree_before_step(s->mpm, s->function, s->status);
}

static mps_status find_lists(step *s) {
  mps_mpm *mpm = s->mpm;
  const mpsi_contact_stage stage = mpsi_prescribed_stage_of(mpm);
  const bool before = mpsi_forces_apart(&mpm->energy, &mpm->settling, &mpm->p, &mpm->def) ||
                      mpm->def.viscous_damping > 0.0;
  for (int32_t b = MPSI_SIDES; b < mpm->boundaries.count && predicts(s); b++)
    if (s->status == MPS_OK && mpm->boundaries.boundary[b].ids)
      s->status = mpsi_fail(mpm->context, s->function, MPS_ERROR_UNSUPPORTED,
                            "boundary %d is a list of particles, which is not possible with "
                            "implicit pore pressures: prescribe a box of nodes, or use explicit "
                            "pressures",
                            b);
  return mpsi_mpm_find_prescribed(&stage, s->function, before, s->status);
}

/* One thread can scatter the blocks near bodies first, solve the contacts, and then go over all
 * others in one wave. Penalty contact and contact areas need nodes anywhere near a body. */
static bool can_solve_in_one_wave(const step *s) {
  const mpsi_contacts *contacts = &s->mpm->contact;
  bool can = s->in_contact && !on_ranks(s) && !predicts(s) && !has_lists(s) &&
             mpsi_mpm_passes_alone(&s->mpm->grid, &s->mpm->p) && contacts->penalty_bodies == 0;
  for (int32_t b = 0; can && b < contacts->bodies; b++)
    can = mpsi_by_impulses(contacts->handle[b]) &&
          !mpsi_has_areas(contacts->handle[b], contacts->wet);
  return can;
}

static mps_status find_constraints(step *s) {
  s->mpm->contact.wet = s->mpm->water != NULL;
  const mpsi_contact_stage stage = mpsi_contact_stage_of(s->mpm);
  s->in_contact = on_ranks(s) ? has_bodies(s) : s->mpm->contact.cell_pair_count > 0;
  s->in_one_wave = can_solve_in_one_wave(s);
  return mpsi_mpm_find_constraints(&stage, s->function);
}

static mps_status find_bearers(step *s) {
  const mpsi_contact_stage stage = mpsi_contact_stage_of(s->mpm);
  return mpsi_mpm_find_bearers(&stage, s->function, s->status);
}

static mps_status mark_constraints(step *s) {
  mpsi_mpm_mark_contact_blocks(&s->mpm->contact, &s->mpm->grid);
  return s->status;
}

static mps_status move_columns(step *s) {
  const mpsi_boundary_setup setup = mpsi_boundary_setup_of(s->mpm);
  const mps_status status = mpsi_mpm_move_free_fields(&setup, s->function);
  s->moved_columns = status == MPS_OK;
  return status;
}

static void pass_sides(mps_mpm *mpm) {
  const mpsi_boundary_setup setup = mpsi_boundary_setup_of(mpm);
  if (mpsi_mpm_pass_free_fields(&setup)) mpm->run.stale = true;
}

/* ---- particles to nodes ---------------------------------------------------------------------- */

static mps_status send_tiles(step *s) {
  return keep_own(s, mpsi_mpm_send_tiles(s->mpm, s->function));
}

static void run_pass(step *s) {
  mpsi_mpm_run_pass(s->mpm->context, &s->mpm->grid, &s->mpm->p, &s->pass);
  s->pass = (mpsi_pass){.data = s->mpm};
}

/* The work of the pass: it is done together with the gather where nothing lies between. */
static mps_status begin_pass(step *s) {
  s->pass = (mpsi_pass){.data = s->mpm,
                        .step = s,
                        .clear = mpsi_mpm_clear_nodes,
                        .scatter = mpsi_step_scatter,
                        .ranks = s->mpm->partition,
                        .arrive = mpsi_mpm_receive_messages,
                        .update = mpsi_mpm_update_nodes};
  return s->status;
}

static mps_status scatter(step *s) {
  run_pass(s);
  return s->status;
}

/* ---- contact --------------------------------------------------------------------------------- */

static mps_status find_masses(step *s) {
  mpsi_mpm_find_contact_mass(&s->mpm->grid, &s->mpm->contact, s->mpm->partition);
  return s->status;
}

static mps_status press(step *s) { return keep_own(s, mpsi_pore_press(s->mpm, s->function)); }

static mps_status clear_impulses(step *s) {
  mpsi_impulses *all = &s->mpm->contact.impulses;
  all->warm_count = all->sweeps = 0;
  all->left = 0.0;
  return MPS_OK;
}

static mps_status fit_constraints(step *s) {
  const mpsi_contact_stage stage = mpsi_contact_stage_of(s->mpm);
  mpsi_mpm_fit_constraints(&stage);
  mpsi_pore_aim_contacts(s->mpm);
  return s->status;
}

/* No particle moves before all depths are known. */
static mps_status check_depth(step *s) {
  mps_mpm *mpm = s->mpm;
  return mpsi_mpm_check_depth(mpm->context, &mpm->p, &mpm->contact, &mpm->run, s->function);
}

static mps_status exchange_constraints(step *s) {
  const mpsi_contact_stage stage = mpsi_contact_stage_of(s->mpm);
  return mpsi_mpm_exchange_contacts(&stage, s->function, s->status);
}

static mps_status apply_impulses(step *s) {
  const mpsi_contact_stage stage = mpsi_contact_stage_of(s->mpm);
  mpsi_mpm_apply_impulses(&stage);
  if (on_ranks(s)) mpsi_mpm_end_contact_exchange(&s->mpm->contact);
  return MPS_OK;
}

static void save(void *solver, int64_t b, int32_t worker) {
  mps_mpm *mpm = solver;
  mpsi_mpm_save_block(&mpm->grid, &mpm->p, &mpm->undo, b);
}

static mps_status predict(step *s) {
  mps_mpm *mpm = s->mpm;
  mpsi_mpm_for_cells(mpm->context, &mpm->grid, &mpm->p, save, mpm);
  const mps_status status = mpsi_pore_predict(mpm, s->function);
  if (status != MPS_OK)
    mpsi_mpm_undo(&mpm->grid, &mpm->p, &mpm->boundaries, &mpm->contact, &mpm->prescribed,
                  &mpm->undo);
  return status;
}

static mps_status keep_impulses(step *s) {
  const mpsi_contact_stage stage = mpsi_contact_stage_of(s->mpm);
  mpsi_mpm_end_impulses(&stage);
  return MPS_OK;
}

static mps_status begin_boundaries(step *s) {
  mpsi_mpm_begin_boundaries(&s->mpm->boundaries, s->mpm->run.dt);
  return MPS_OK;
}

static const step_stage contact_stages[] = {
    {"contact masses", .when = has_bodies, .run = find_masses, .exchange = later},
    {"pressures ahead of the forces", .when = predicts, .run = press, .exchange = later},
    {"no impulses", .when = is_apart, .run = clear_impulses},
    {"constraints", .when = is_in_contact, .run = fit_constraints, .exchange = later},
    {"depths", .when = is_in_contact, .run = check_depth},
    {"constraints of partners", .when = has_bodies_on_ranks, .run = exchange_constraints,
     .exchange = within},
    {"impulses", .when = is_in_contact, .run = apply_impulses},
    {"implicit pressures", .when = predicts, .run = predict, .exchange = within},
    {"impulses kept", .when = is_in_contact, .run = keep_impulses},
    {"boundaries", .run = begin_boundaries},
};

static mps_status solve_contacts(step *s) {
  walk(s, contact_stages, sizeof contact_stages / sizeof *contact_stages);
  return s->status;
}

static bool solve_within_pass(void *data) { return solve_contacts(data) == MPS_OK; }

/* In one wave the nodes of all constraints are updated before the contacts are solved. */
static mps_status contact(step *s) {
  if (!s->in_one_wave) return solve_contacts(s);
  const mpsi_impulses *all = &s->mpm->contact.impulses;
  const mpsi_grid *grid = &s->mpm->grid;
  for (int64_t k = 0; k < all->block_count; k++)
    for (int q = 0; q < 1 << grid->dim; q++)
      grid->nodes[grid->cells[all->block[k].cells].to[q]].waits = true;
  s->pass.between = solve_within_pass;
  return MPS_OK;
}

/* ---- nodes to particles ---------------------------------------------------------------------- */

static void gather_block(void *solver, int64_t b, int32_t worker) {
  mps_mpm *mpm = solver;
  const mpsi_transfer work = mpsi_transfer_of(mpm, b, worker);
  if (mpm->undo.on && !mpsi_pore_predicts(mpm))
    mpsi_mpm_save_block(&mpm->grid, &mpm->p, &mpm->undo, b);
  mpsi_pore_keep_volumes(mpm, b);
  mpm->kernels->g2p[mpm->grid.geometry][mpm->grid.spline - 2](&work);
}

static mps_status prescribe(step *s) {
  const mpsi_contact_stage stage = mpsi_prescribed_stage_of(s->mpm);
  s->pass.finish = mpsi_mpm_finish_nodes;
  run_pass(s);
  s->pass.finish = mpsi_mpm_damp_after_lists;
  return mpsi_mpm_solve_prescribed(&stage, s->function);
}

static mps_status gather(step *s) {
  if (!has_lists(s)) s->pass.finish = mpsi_mpm_finish_nodes;
  s->pass.gather = gather_block;
  run_pass(s);
  return s->status;
}

/* ---- after the motion ------------------------------------------------------------------------ */

static mps_status add_reactions(step *s) {
  mps_mpm *mpm = s->mpm;
  mpsi_mpm_sum_boundaries(&mpm->grid, &mpm->boundaries, &mpm->mirrors, &mpm->energy);
  mpsi_pore_add_reactions(mpm);
  const mpsi_contact_stage prescribed = mpsi_prescribed_stage_of(mpm);
  mpsi_mpm_end_prescribed(&prescribed, &mpm->energy);
  mpsi_mpm_find_impulse_loss(&mpm->grid, &mpm->contact, &mpm->energy, mpm->kernels);
  return MPS_OK;
}

/* Whether a law of the caller has refused on this rank, or in a step that can be undone a particle
 * has values that are not finite or not possible. */
static bool has_failed(const mps_mpm *mpm) {
  bool failed = mpm->p.laws.refusal.cells != NULL || mpm->bound.beyond >= 0;
  for (int64_t b = 0; b < mpm->grid.cell_count && mpm->undo.on; b++)
    failed = failed || (mpm->grid.cells[b].bad >= 0 && !mpm->grid.cells[b].lost);
  return failed;
}

/* Restores the state at the beginning of a step that has failed here: the law's status with its
 * record, or MPS_ERROR_DIVERGED; MPS_OK where it has failed on another rank. */
static mps_status undo(mps_mpm *mpm, const char *function) {
  mpsi_refusal *r = &mpm->p.laws.refusal;
  const mps_status status = r->cells ? MPS_OK : mpsi_mpm_report_undone(mpm, function);
  mpsi_mpm_undo(&mpm->grid, &mpm->p, &mpm->boundaries, &mpm->contact, &mpm->prescribed, &mpm->undo);
  if (!r->cells) return status;
  r->cells = NULL;
  return mpsi_material_refused(mpm->context, function, r->material, r->status, r->message,
                               r->particle >= 0 ? mpm->p.laws.ids[r->particle] : -1,
                               mpm->run.steps);
}

static mps_status refuse(step *s) {
  bool failed = has_failed(s->mpm);
  mps_status status = MPS_OK;
  if (on_ranks(s) && s->mpm->undo.on)
    status = mpsi_mpm_any_rank(s->mpm->partition, s->function, &failed);
  if (status != MPS_OK || !failed) return status;
  return mpsi_mpm_agree(s->mpm->partition, s->function, undo(s->mpm, s->function));
}

/* Reactions and poses of bodies, energy, time: the step is kept. */
static mps_status complete(step *s) {
  mps_mpm *mpm = s->mpm;
  mpsi_bound_keep(mpm);
  if (has_bodies(s))
    mpsi_mpm_update_bodies(&mpm->grid, &mpm->contact, &mpm->energy, mpm->partition, &mpm->settling,
                           mpm->run.dt);
  mpsi_mpm_energy_end(&mpm->grid, &mpm->p, &mpm->contact, mpm->partition, &mpm->energy, &mpm->def);
  mpm->run.moments = mpm->run.begun = true;
  mpm->run.time += mpm->run.dt;
  mpm->run.steps++;
  mpsi_step_warn_about_volume(mpm);
  mpsi_step_warn_about_bodies(mpm);
  return MPS_OK;
}

static mps_status collect(step *s) { return mpsi_mpm_collect_block_results(s->mpm, s->function); }

/* ---- the step -------------------------------------------------------------------------------- */

static const step_stage stages[] = {
    {"signals", .run = evaluate_signals},
    {"agreement on signals", .when = signals_may_refuse, .exchange = agree_on_signals},
    {"blocks, boundaries and pairs", .run = find_blocks, .exchange = later},
    {"loads", .run = find_forces},
    {"energy budget", .run = begin_energy},
    {"undo", .run = prepare_undo},
    {"cells of water", .when = has_water, .run = begin_water, .exchange = later},
    {"agreement before the step", .when = changes, .exchange = agree_before_step},
    {"exchange of water", .act = mpsi_pore_plan},
    {"warnings", .act = mpsi_step_warn_before},
    {"lists of particles", .run = find_lists, .exchange = within},
    {"contact constraints", .run = find_constraints},
    {"bearers of inset edges", .when = has_strips, .run = find_bearers, .exchange = within},
    {"blocks in contact", .when = has_bodies_on_ranks, .run = mark_constraints, .exchange = later},
    {"free-field columns", .when = has_columns, .run = move_columns},
    {"tiles to other ranks", .when = on_ranks, .run = send_tiles, .exchange = later},
    {"work of the pass", .run = begin_pass, .exchange = later},
    {"scatter and update", .when = is_divided, .run = scatter, .exchange = later},
    {"contact", .run = contact, .exchange = later},
    {"finish, and lists of particles", .when = has_lists, .run = prescribe, .exchange = within},
    {"gather", .run = gather},
    {"reactions", .run = add_reactions},
    {"laws by means, filter", .when = has_means, .act = mpsi_mpm_apply_laws_by_cell},
    {"bounds of the water", .when = has_water_accepted, .act = mpsi_pore_check_step},
    {"bound of the energy", .when = is_accepted, .act = mpsi_bound_check},
    {"refusal", .run = refuse, .exchange = within},
    {"bodies, energy, time", .run = complete},
    {"strips at edges", .when = has_strips, .act = mpsi_mpm_clear_strips},
    {"water", .when = is_complete, .act = mpsi_pore_update},
    {"particles that pass free-field sides", .when = has_columns, .act = pass_sides},
    {"speeds, particles that leave", .run = collect, .exchange = within},
};

mps_status mpsi_mpm_take_step(mps_mpm *mpm, const char *function, double dt) {
  const double former = mpm->run.dt;
  const int64_t steps = mpm->run.steps;
  step s = {.mpm = mpm, .function = function};
  if (mpm->partition)
    s.unchanged = mpsi_mpm_partition_unchanged(&mpm->boundaries, &mpm->contact, mpm->partition,
                                               &mpm->settling, &mpm->run);
  mpm->run.dt = dt;
  walk(&s, stages, sizeof stages / sizeof *stages);
  if (s.status == MPS_OK || mpm->run.steps > steps) return s.status;
  mpm->run.dt = former;
  if (s.moved_columns) mpsi_mpm_return_free_fields(&mpm->boundaries);
  return s.status;
}
