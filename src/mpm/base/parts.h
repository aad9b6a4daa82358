/* parts.h - names of the parts of the solver, by which the arguments of functions say what these
 * read and write. A const part does not change, though the arrays that it points to may be written.
 * Each is defined in a header of its subfolder. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

typedef struct mpsi_columns mpsi_columns;             /* base/columns.h: particles and their laws */
typedef struct mpsi_energy mpsi_energy;               /* base/energy.h */
typedef struct mpsi_run mpsi_run;                     /* base/run.h */
typedef struct mpsi_kernels mpsi_kernels;             /* base/kernels.h */
typedef struct mpsi_transfer mpsi_transfer;           /* base/kernels.h */
typedef struct mpsi_contact_stage mpsi_contact_stage; /* base/kernels.h */
typedef struct mpsi_inside_search mpsi_inside_search; /* base/kernels.h */
typedef struct mpsi_grid mpsi_grid;                   /* grid/blocks.h */
typedef struct mpsi_cell_block mpsi_cell_block;       /* grid/blocks.h */
typedef struct mpsi_laws mpsi_laws;                   /* particles/laws.h */
typedef struct mpsi_rooms mpsi_rooms;                 /* particles/rooms.h */
typedef struct mpsi_loads mpsi_loads;                 /* particles/loads.h */
typedef struct mpsi_boundaries mpsi_boundaries;       /* boundary/boundaries.h */
typedef struct mpsi_boundary_setup mpsi_boundary_setup;     /* boundary/boundaries.h */
typedef struct mpsi_mirrors mpsi_mirrors;                   /* boundary/mirror.h */
typedef struct mpsi_contacts mpsi_contacts;                 /* contact/pairs.h */
typedef struct mpsi_impulses mpsi_impulses;                 /* contact/impulses.h */
typedef struct mpsi_constraint_block mpsi_constraint_block; /* contact/impulses.h */
typedef struct mpsi_contact_setup mpsi_contact_setup;       /* contact/pairs.h */
typedef struct mpsi_prescribed mpsi_prescribed;             /* contact/prescribed.h */
typedef struct mpsi_rank_part mpsi_rank_part;               /* ranks/partition.h */
typedef struct mpsi_partition mpsi_partition;               /* ranks/partition.h */
typedef struct mpsi_water mpsi_water;                       /* water/water.h */
typedef struct mpsi_settling mpsi_settling;                 /* step/damping.h */
typedef struct mpsi_undo mpsi_undo;                         /* step/undo.h */
