/* kinds.h - the library's laws, one row each: all properties of it but its loop. From this list
 * come the enumeration, the descriptors (kinds.c) and the loops for every geometry and instruction
 * set (laws.c), so that a law lacks none of them: a row without one of its columns, or one that
 * names a function that is not there, does not compile.
 *
 *   kind      MPSI_LAW_... of the enumeration
 *   loop      the function of laws.c that applies it to a block, inlined for each geometry
 *   name      of its materials; NULL: the definition gives it
 *   columns   names of its history; a user's law has those of its definition. One that is a row of
 *             core/particles/fields.h is that field, one for all laws; others are "name.column"
 *   kept      recoverable part of the work of its stresses
 *   traits    MPSI_LAW_... bits, below
 *   define    from its definition to its constants: all checks of the values
 *   moduli    the wave moduli of a block in its present state; NULL: that of zero strain. A user's
 *             law may have none: mpsi_material_stiffens
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "material_internal.h"

/* clang-format off */
#define MPSI_LAW_KINDS(X)                                                                          \
  X(LINEAR_ELASTIC, linear_elastic_loop, "linear_elastic", mpsi_no_columns, MPSI_KEPT_ALL,         \
    MPSI_LAW_IS_LINEAR | MPSI_LAW_BY_FIELD,       mpsi_define_elastic,        NULL)                \
  X(VON_MISES,      von_mises_loop,      "von_mises",      mpsi_metal_columns, MPSI_KEPT_ELASTIC,  \
    MPSI_LAW_ISOCHORIC | MPSI_LAW_BY_FIELD | MPSI_LAW_FLOWS, mpsi_define_von_mises, NULL)          \
  X(DRUCKER_PRAGER, drucker_prager_loop, "drucker_prager", mpsi_sand_columns, MPSI_KEPT_ELASTIC,   \
    MPSI_LAW_OPENS | MPSI_LAW_BY_FIELD | MPSI_LAW_FLOWS, mpsi_define_drucker_prager, NULL)         \
  X(MOHR_COULOMB,   mohr_coulomb_loop,   "mohr_coulomb",   mpsi_sand_columns, MPSI_KEPT_ELASTIC,   \
    MPSI_LAW_OPENS | MPSI_LAW_BY_FIELD | MPSI_LAW_FLOWS, mpsi_define_mohr_coulomb, NULL)           \
  X(NEO_HOOKEAN,    neo_hookean_loop,    "neo_hookean",    mpsi_no_columns, MPSI_KEPT_ALL,         \
    MPSI_LAW_READS_VOLUME,                        mpsi_define_neo_hookean,    mpsi_neo_hookean_moduli) \
  X(NEWTONIAN,      newtonian_loop,      "newtonian",      mpsi_no_columns, MPSI_KEPT_PRESSURE,    \
    MPSI_LAW_READS_VOLUME,                        mpsi_define_newtonian,      mpsi_newtonian_moduli)   \
  X(USER,           user_loop,           NULL,             mpsi_no_columns, MPSI_KEPT_ALL,         \
    MPSI_LAW_READS_VOLUME | MPSI_LAW_MAY_REFUSE,  mpsi_define_user,           mpsi_user_moduli)    \
  X(CAM_CLAY,       cam_clay_loop,       "cam_clay",       mpsi_clay_columns, MPSI_KEPT_ALL,        \
    MPSI_LAW_HAS_START | MPSI_LAW_FLOWS,          mpsi_define_cam_clay,       mpsi_cam_clay_moduli)  \
  X(SMALL_STRAIN,   small_strain_loop,   "small_strain",   mpsi_small_columns, MPSI_KEPT_UNDISSIPATED, \
    MPSI_LAW_ISOCHORIC | MPSI_LAW_BY_FIELD,       mpsi_define_small_strain,   NULL)                \
  X(CYCLIC_SAND,    cyclic_sand_loop,    "cyclic_sand",    mpsi_cyclic_columns, MPSI_KEPT_ELASTIC, \
    MPSI_LAW_OPENS | MPSI_LAW_BY_FIELD,           mpsi_define_cyclic_sand,    NULL)
/* clang-format on */

typedef enum mpsi_law_kind {
#define MPSI_LAW_ENTRY(kind, loop, name, columns, kept, traits, define, moduli) MPSI_LAW_##kind,
  MPSI_LAW_KINDS(MPSI_LAW_ENTRY)
#undef MPSI_LAW_ENTRY
      MPSI_LAW_COUNT
} mpsi_law_kind;

typedef enum mpsi_law_trait {
  MPSI_LAW_IS_LINEAR = 1,    /* stress and strain are proportional, at every strain */
  MPSI_LAW_READS_VOLUME = 2, /* V/V0 decides the stress */
  MPSI_LAW_MAY_REFUSE = 4,   /* a block, with a reason */
  MPSI_LAW_OPENS = 8,        /* a gap opens between grains */
  MPSI_LAW_HAS_START = 16,   /* history that is not 0 at the start stays, and must fit the stress */
  MPSI_LAW_ISOCHORIC = 32, /* yields without change of volume: locks, and takes a mean (volume.c) */
  MPSI_LAW_BY_FIELD = 64,  /* mps_material_create_by_field scales its constants (by_field.c) */
  MPSI_LAW_FLOWS = 128     /* ground or metal that yields without bound, and may be pressed slowly */
} mpsi_law_trait;

struct mpsi_law;

/* Checks a definition and fills the constants. */
typedef mps_status (*mpsi_define_fn)(mps_context *context, const char *function, const void *def,
                                     struct mpsi_law *law);
/* Writes an upper bound of K + 4G/3 (Pa) of each particle. */
typedef void (*mpsi_moduli_fn)(const struct mpsi_law *law, const mps_material_block *block,
                               double *moduli);

typedef struct mpsi_law_type {
  mpsi_law_kind kind;
  const char *name;
  const char *const *columns; /* up to NULL */
  mpsi_kept kept;
  uint32_t traits;
  mpsi_define_fn define;
  mpsi_moduli_fn moduli;
} mpsi_law_type;

extern const mpsi_law_type mpsi_law_types[]; /* by kind */
extern const char *const mpsi_no_columns[],
    *const mpsi_metal_columns[], *const mpsi_sand_columns[], *const mpsi_clay_columns[],
                                                                 *const mpsi_small_columns[],
                                                                     *const mpsi_cyclic_columns[];
/* Columns of Cam-Clay. */
enum { MPSI_CLAY_STRAIN, MPSI_CLAY_PC, MPSI_CLAY_VOID, MPSI_CLAY_GAP, MPSI_CLAY_COLUMNS };
/* Columns of the small-strain law: two, and the deviators of its layers (xx, yy, xy, zx, yz). */
enum {
  MPSI_SMALL_STRAIN,
  MPSI_SMALL_DISSIPATED,
  MPSI_SMALL_FIRST,
  MPSI_LAYERS = 10,
  MPSI_LAYER_PARTS = 5,
  MPSI_SMALL_COLUMNS = MPSI_SMALL_FIRST + MPSI_LAYERS * MPSI_LAYER_PARTS
};
/* Columns of cyclic sand behind those of sand: contraction now and at the last reversal, half
 * cycles, and two deviators of strain (xx, yy, xy, zx, yz): since the reversal, and its farthest.
 */
enum {
  MPSI_CYCLIC_CONTRACTION = 2,
  MPSI_CYCLIC_BEFORE,
  MPSI_CYCLIC_HALVES,
  MPSI_CYCLIC_SINCE,
  MPSI_CYCLIC_FAR = MPSI_CYCLIC_SINCE + 5,
  MPSI_CYCLIC_COLUMNS = MPSI_CYCLIC_FAR + 5
};

/* The definitions of the laws that are given by two numbers. */
typedef struct mpsi_elastic_def {
  double young, poisson;
} mpsi_elastic_def;

/* parameters.c; user.c; cam_clay/start.c; small_strain/backbone.c; sand/definition.c; moduli.c */
mps_status mpsi_define_elastic(mps_context *context, const char *function, const void *def,
                               struct mpsi_law *law);
mps_status mpsi_define_von_mises(mps_context *context, const char *function, const void *def,
                                 struct mpsi_law *law);
mps_status mpsi_define_drucker_prager(mps_context *context, const char *function, const void *def,
                                      struct mpsi_law *law);
mps_status mpsi_define_mohr_coulomb(mps_context *context, const char *function, const void *def,
                                    struct mpsi_law *law);
mps_status mpsi_define_neo_hookean(mps_context *context, const char *function, const void *def,
                                   struct mpsi_law *law);
mps_status mpsi_define_newtonian(mps_context *context, const char *function, const void *def,
                                 struct mpsi_law *law);
mps_status mpsi_define_user(mps_context *context, const char *function, const void *def,
                            struct mpsi_law *law);
mps_status mpsi_define_cam_clay(mps_context *context, const char *function, const void *def,
                                struct mpsi_law *law);
mps_status mpsi_define_small_strain(mps_context *context, const char *function, const void *def,
                                    struct mpsi_law *law);
mps_status mpsi_define_cyclic_sand(mps_context *context, const char *function, const void *def,
                                   struct mpsi_law *law);
void mpsi_user_moduli(const struct mpsi_law *law, const mps_material_block *block, double *moduli);
void mpsi_cam_clay_moduli(const struct mpsi_law *law, const mps_material_block *block,
                          double *moduli);
void mpsi_neo_hookean_moduli(const struct mpsi_law *law, const mps_material_block *block,
                             double *moduli);
void mpsi_newtonian_moduli(const struct mpsi_law *law, const mps_material_block *block,
                           double *moduli);
