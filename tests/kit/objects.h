/* objects.h - objects, definitions and fields of a test in one line each: made or the test fails,
 * destroyed where their block ends. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_KIT_OBJECTS_H
#define MPS_TEST_KIT_OBJECTS_H

/* Objects that are destroyed where their block ends; they must have a value where they are
 * declared: scoped_body *body = NULL; */
#define SCOPED(destroy) __attribute__((cleanup(destroy), unused))
#define scoped_absorber SCOPED(mps_absorber_destroy) mps_absorber
#define scoped_body SCOPED(mps_body_destroy) mps_body
#define scoped_contact SCOPED(mps_contact_destroy) mps_contact
#define scoped_context SCOPED(mps_context_destroy) mps_context
#define scoped_coupling SCOPED(mps_coupling_destroy) mps_coupling
#define scoped_domain SCOPED(mps_domain_destroy) mps_domain
#define scoped_dynamics SCOPED(mps_dynamics_destroy) mps_dynamics
#define scoped_elastic SCOPED(mps_elastic_destroy) mps_elastic
#define scoped_fluid SCOPED(mps_fluid_destroy) mps_fluid
#define scoped_kernel SCOPED(mps_kernel_destroy) mps_kernel
#define scoped_material SCOPED(mps_material_destroy) mps_material
#define scoped_mpm SCOPED(mps_mpm_destroy) mps_mpm
#define scoped_neighbours SCOPED(mps_neighbours_destroy) mps_neighbours
#define scoped_particles SCOPED(mps_particles_destroy) mps_particles
#define scoped_recorder SCOPED(mps_recorder_destroy) mps_recorder
#define scoped_signal SCOPED(mps_signal_destroy) mps_signal
#define scoped_snapshot SCOPED(mps_snapshot_destroy) mps_snapshot
#define scoped_waves SCOPED(mps_waves_destroy) mps_waves

/* mps_<noun> *name by mps_<noun>_<how>(..., &name), destroyed where its block ends:
 *   MAKE(material, clay, create_cam_clay, context, &law);
 * MAKE_KEPT leaves that to the caller. */
#define MAKE(noun, name, how, ...)                                                                 \
  scoped_##noun *name = NULL;                                                                      \
  OK(mps_##noun##_##how(__VA_ARGS__, &name))
#define MAKE_KEPT(noun, name, how, ...)                                                            \
  mps_##noun *name = NULL;                                                                         \
  OK(mps_##noun##_##how(__VA_ARGS__, &name))

/* A point or vector as an argument: of three numbers, as a set in space reads three of AT(0.0). */
#define AT(...) ((const double[3]){__VA_ARGS__})

/* What follows, a statement or a block, writes the field between edit and commit:
 *   EDIT(v, set, "velocity")
 *     for (int64_t k = 0; k < v.view.shape[0]; k++) *mps_edit_f64(&v, k, 0) = speed(k); */
#define EDIT(name, set, field)                                                                     \
  for (mps_edit name = edit_field(set, field), *name##_open = &name; name##_open;                  \
       name##_open = commit_field(set, &name))

mps_view view_field(mps_particles *set, const char *field);
mps_edit edit_field(mps_particles *set, const char *field);
mps_edit *commit_field(mps_particles *set, mps_edit *edit); /* NULL */

/* Particles that fill the box from lo to hi of the plane. */
mps_particles *box_of(mps_context *context, double spacing, const double *lo, const double *hi);

/* Component 0 of several fields, of all particles:
 *   SET_FIELDS(set, {"density", 1900.0}, {"young", 1e7}); */
typedef struct field_value {
  const char *field;
  double value;
} field_value;
#define SET_FIELDS(set, ...) set_fields(set, (const field_value[]){__VA_ARGS__, {NULL, 0.0}})
void set_fields(mps_particles *set, const field_value *values);

/* The first call that fails gives `status`; those behind it are not made. */
#define TRY(call)                                                                                  \
  do {                                                                                             \
    if (status == MPS_OK) status = (call);                                                         \
  } while (0)

/* A definition with the defaults but for these members, at most 12:
 *   DEF(mpm, def, .cell = 0.02, .gravity[1] = -9.81);
 * WITH_DEFAULTS has the whole name of the type. */
#define DEF(noun, name, ...)                                                                       \
  mps_##noun##_def name = mps_##noun##_defaults();                                                 \
  SET_MEMBERS(name, __VA_ARGS__)
#define WITH_DEFAULTS(type, name, ...)                                                             \
  type name = type##_defaults();                                                                   \
  SET_MEMBERS(name, __VA_ARGS__)
/* A call that must succeed, with a definition that nothing else reads, named given:
 *   USING(contact, mps_mpm_add_contact(mpm, body, &given, NULL), .friction = 0.4); */
#define USING(noun, call, ...)                                                                     \
  do {                                                                                             \
    DEF(noun, given, __VA_ARGS__);                                                                 \
    OK(call);                                                                                      \
  } while (0)
#define SET_MEMBERS(v, ...)                                                                        \
  SET_COUNT(__VA_ARGS__, SET_12, SET_11, SET_10, SET_9, SET_8, SET_7, SET_6, SET_5, SET_4, SET_3,  \
            SET_2, SET_1, )                                                                        \
  (v, __VA_ARGS__)
#define SET_COUNT(a, b, c, d, e, f, g, h, i, j, k, l, which, ...) which
#define SET_1(v, a) v a
#define SET_2(v, a, ...) v a, SET_1(v, __VA_ARGS__)
#define SET_3(v, a, ...) v a, SET_2(v, __VA_ARGS__)
#define SET_4(v, a, ...) v a, SET_3(v, __VA_ARGS__)
#define SET_5(v, a, ...) v a, SET_4(v, __VA_ARGS__)
#define SET_6(v, a, ...) v a, SET_5(v, __VA_ARGS__)
#define SET_7(v, a, ...) v a, SET_6(v, __VA_ARGS__)
#define SET_8(v, a, ...) v a, SET_7(v, __VA_ARGS__)
#define SET_9(v, a, ...) v a, SET_8(v, __VA_ARGS__)
#define SET_10(v, a, ...) v a, SET_9(v, __VA_ARGS__)
#define SET_11(v, a, ...) v a, SET_10(v, __VA_ARGS__)
#define SET_12(v, a, ...) v a, SET_11(v, __VA_ARGS__)

#endif
