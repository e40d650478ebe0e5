/* Tables of what only some components have, one for each ability. The host asks for a table by its id
 * (mpm_descriptor::extension) and does without it where the answer is null. The first word of every table is its own
 * version; the host refuses a plugin with a table of another version by name, and one of another kind than the id says.
 *
 * The rules of abi.h for functions and batches hold here too. docs/design/plugin_boundary.md says who asks for each
 * table and which check of `mpm test-plugin` holds it to its words.
 */
#ifndef MPM_PLUGIN_EXTENSIONS_H
#define MPM_PLUGIN_EXTENSIONS_H
#include "plugin/abi.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- mpm.costs: every kind but contact laws --------------------------------------------------------------------
 * Floating-point operations of one call, counted from the functor: +, -, *, / and sqrt are 1 each, log and exp are
 * those of their polynomials in kernel/lanes.hpp. */
#define MPM_COSTS_ID "mpm.costs"
#define MPM_COSTS_VERSION 1u
typedef struct mpm_cost_case {
  uint32_t dimension;        /* 2 or 3 */
  uint32_t single_precision; /* 1: float, whose log and exp are shorter; 0: double */
  uint32_t gradients;        /* shapes: 1 where gradients are wanted too */
  uint32_t flows;            /* materials: 1 for a strain beyond any yield, 0 for none */
  double half_size;          /* shapes: half of an undeformed particle's box, cells */
} mpm_cost_case;
typedef struct mpm_cost {
  /* The operations counted are, for a shape, the weights of one particle along all axes, or its list in the mean over
   * places in a cell; for a transfer a particle's gather and scatter; for a filter a node's update; for a material a
   * particle's advance, J and stress. */
  double operations;
  double nodes; /* nodes of a list, in the mean over the same places; else 0 */
} mpm_cost;
typedef struct mpm_costs {
  uint32_t version, reserved;
  void (*count)(const void* parameters, const mpm_cost_case* of, mpm_cost* cost);
} mpm_costs;

/* ---- mpm.refusal: every kind -----------------------------------------------------------------------------------
 * Parameters that lie in their ranges and yet do not fit one another, or the scene. The host asks once when it has read
 * them, and refuses the experiment in these words; with parameters that are refused it calls nothing else. */
#define MPM_REFUSAL_ID "mpm.refusal"
#define MPM_REFUSAL_VERSION 1u
typedef struct mpm_refusal_case {
  uint32_t dimension; /* 2 or 3 */
  uint32_t axisymmetric;
} mpm_refusal_case;
typedef struct mpm_refusal {
  /* The parameter at fault, a declared one or "cell_size" (mpm.material.cell_size); null: nothing is refused. */
  const char* parameter;
  const char* why; /* why, and what helps, without a capital at the start and a stop at the end */
  double limit;    /* the nearest value that is not refused while the others stay; not a number where there is none */
} mpm_refusal;
typedef struct mpm_refusals {
  uint32_t version, reserved;
  void (*ask)(const void* parameters, const mpm_refusal_case* of, mpm_refusal* refusal);
} mpm_refusals;

/* ---- mpm.shape.boxes: lists of nodes ----------------------------------------------------------------------------
 * The same particles' nodes as dense boxes, for hosts that take rows of nodes at once. A particle's nodes lie within
 * `extent` nodes an axis from `base`; a node (i, j, k) of the box has entry (i * MPM_BOX_WIDTH + j) * MPM_BOX_WIDTH +
 * k, zero where the list has none. Entries with i, j or k from `extent` on are undefined. Extent 0: no box holds the
 * particle's nodes (or its gradients, when these are wanted), and its list counts; all else but `base` is undefined. */
#define MPM_SHAPE_BOXES_ID "mpm.shape.boxes"
#define MPM_SHAPE_BOXES_VERSION 1u
#define MPM_BOX_WIDTH 4u /* nodes an axis */
typedef struct mpm_box_batch {
  uint32_t count, stride, dimension, reserved;
  const void* position; /* as in mpm_list_batch, as are the next two */
  const void* half_size;
  const void* domain;
  int32_t* base;       /* [D][stride] out: first node of the box */
  int32_t* extent;     /* [stride] out: 0, or at most MPM_BOX_WIDTH */
  void* offset;        /* [D][stride] out: position - base */
  void* weight;        /* [MPM_BOX_WIDTH^D][stride] out */
  void* gradient;      /* [D][MPM_BOX_WIDTH^D][stride] out: by position; null when the plan needs none */
  void* second_moment; /* [D*D][stride] out: as in mpm_list_batch */
} mpm_box_batch;
typedef struct mpm_shape_boxes {
  uint32_t version, reserved;
  void (*evaluate[MPM_PRECISIONS][2])(const void* parameters, const mpm_box_batch* batch);
} mpm_shape_boxes;

/* ---- mpm.shape.courant_limit -------------------------------------------------------------------------------------
 * The largest Courant number dt (c + |v|) / h that a body which flies, collides and vibrates stands on this shape: c is
 * the wave speed, v the particle's velocity, h the cell size. It depends on which velocity strains the particles. Of a
 * shape without this table the host knows no limit: `courant` of the scene counts alone. */
#define MPM_SHAPE_COURANT_LIMIT_ID "mpm.shape.courant_limit"
#define MPM_SHAPE_COURANT_LIMIT_VERSION 1u
enum mpm_strain_velocity {
  MPM_GRID_VELOCITY = 0,    /* that of the grid after the forces, which replaces the particles' (PIC, APIC) */
  MPM_KEPT_VELOCITY = 1,    /* the same, while particles keep what the grid cannot see from step to step (FLIP) */
  MPM_CARRIED_VELOCITY = 2, /* that of the grid before the forces: only what particles carry strains (USF, MUSL) */
  MPM_STRAIN_VELOCITIES = 3
};
typedef struct mpm_shape_courant_limit {
  uint32_t version, reserved;
  double limit[2][MPM_STRAIN_VELOCITIES]; /* [dimension - 2][mpm_strain_velocity] */
} mpm_shape_courant_limit;

/* ---- mpm.transfer.polynomials -----------------------------------------------------------------------------------
 * The highest power along an axis, 0 to 3, of the polynomials that a particle carries beyond b and A: products over
 * the axes of polynomials orthogonal under the shape's weights (kernel/polynomial_basis.hpp), as many an axis as the
 * shape has nodes at most. The host carries, scatters (times the mass) and gathers their coefficients; 0 means none.
 * They need a tensor product, and the traits MPM_SCATTERS_AFFINE, MPM_GATHERS_AFFINE and MPM_AFFINE_CARRIES_ENERGY. */
#define MPM_TRANSFER_POLYNOMIALS_ID "mpm.transfer.polynomials"
#define MPM_TRANSFER_POLYNOMIALS_VERSION 1u
typedef struct mpm_transfer_polynomials {
  uint32_t version, reserved;
  int32_t (*order)(const void* parameters);
} mpm_transfer_polynomials;

/* ---- mpm.filter.step_limit ---------------------------------------------------------------------------------------
 * The longest stable step with the filter, s, where `unfiltered` is the longest without it. A filter without this
 * table leaves the step as it is. */
#define MPM_FILTER_STEP_LIMIT_ID "mpm.filter.step_limit"
#define MPM_FILTER_STEP_LIMIT_VERSION 1u
typedef struct mpm_filter_step_limit {
  uint32_t version, reserved;
  double (*limit)(const void* parameters, double unfiltered);
} mpm_filter_step_limit;

/* ---- mpm.contact.step_limit --------------------------------------------------------------------------------------
 * The longest step, s, in which the law acts as its parameters say, between bodies whose lighter one has `density`, kg/m^3,
 * on cells of `cell_size`, m. A law without this table leaves the step as it is. */
#define MPM_CONTACT_STEP_LIMIT_ID "mpm.contact.step_limit"
#define MPM_CONTACT_STEP_LIMIT_VERSION 1u
typedef struct mpm_contact_step_limit {
  uint32_t version, reserved;
  double (*limit)(const void* parameters, double density, double cell_size);
} mpm_contact_step_limit;

/* ---- mpm.material.trial ------------------------------------------------------------------------------------------
 * Stress and stored energy of the state that an update would reach, while the state itself stays as it is: to the last
 * bit those of `update` on a copy. Returns as `update` does. */
#define MPM_MATERIAL_TRIAL_ID "mpm.material.trial"
#define MPM_MATERIAL_TRIAL_VERSION 1u
typedef struct mpm_trial_batch {
  uint32_t count, stride, dimension, reserved;
  double dt;
  const void* velocity_gradient; /* as in mpm_material_batch, as are the next two */
  const void* velocity_gradient_zz;
  const void* temperature;
  const void* const* state; /* declared state fields, each [components][stride] */
  void* const* trial_state; /* out: the state reached, in arrays of its own; null when it is not wanted */
  void* kirchhoff_stress;   /* [symmetric][stride] out, Pa, or null */
  void* stored_energy;      /* [stride] out, J/m^3, or null */
} mpm_trial_batch;
typedef struct mpm_material_trial {
  uint32_t version, reserved;
  int32_t (*evaluate[MPM_PRECISIONS][2])(const void* parameters, const mpm_trial_batch* batch);
} mpm_material_trial;

/* ---- mpm.material.tangent ----------------------------------------------------------------------------------------
 * How the trial stress changes with the velocity gradient: d tau / ds of the trial at L + s dL, s = 0. On a yield
 * surface it is the derivative on one side of it. Returns as `update` does. */
#define MPM_MATERIAL_TANGENT_ID "mpm.material.tangent"
#define MPM_MATERIAL_TANGENT_VERSION 1u
typedef struct mpm_tangent_batch {
  uint32_t count, stride, dimension, reserved;
  double dt;
  const void* velocity_gradient;    /* L as in mpm_material_batch, as are the next two; null: zero */
  const void* velocity_gradient_zz; /* null, or given with `direction_zz` */
  const void* temperature;
  const void* direction;    /* [D*D][stride], 1/s: dL */
  const void* direction_zz; /* [stride], 1/s; null in plane strain and 3-D */
  const void* const* state; /* declared state fields, each [components][stride] */
  void* stress_change;      /* [symmetric][stride] out, Pa */
} mpm_tangent_batch;
typedef struct mpm_material_tangent {
  uint32_t version, reserved;
  /* Null, or why this material has no tangent, in one sentence; the entries are null then. */
  const char* refusal;
  int32_t (*evaluate[MPM_PRECISIONS][2])(const void* parameters, const mpm_tangent_batch* batch);
} mpm_material_tangent;

/* ---- mpm.material.projection -------------------------------------------------------------------------------------
 * Replaces a trial state (any F, or what the material keeps of it) by the nearest admissible one: the one to which the
 * law's own return takes it, without strain and without time. Admissible states stay. Returns as `update` does. */
#define MPM_MATERIAL_PROJECTION_ID "mpm.material.projection"
#define MPM_MATERIAL_PROJECTION_VERSION 1u
typedef struct mpm_projection_batch {
  uint32_t count, stride, dimension, axisymmetric; /* axisymmetric: 1 where fields are kept as in such scenes */
  const void* temperature;                         /* as in mpm_material_batch */
  void* const* state;                              /* in: trial, out: admissible */
} mpm_projection_batch;
typedef struct mpm_material_projection {
  uint32_t version, reserved;
  int32_t (*project[MPM_PRECISIONS][2])(const void* parameters, const mpm_projection_batch* batch);
} mpm_material_projection;

/* ---- mpm.material.makes_energy -----------------------------------------------------------------------------------
 * The published law does not keep the dissipation inequality: `dissipated_energy` of its `update` is negative where the
 * law makes energy, so that the work of the stress is stored plus dissipated energy there too. A material without this
 * table dissipates nothing or something, never less. */
#define MPM_MATERIAL_MAKES_ENERGY_ID "mpm.material.makes_energy"
#define MPM_MATERIAL_MAKES_ENERGY_VERSION 1u
typedef struct mpm_material_makes_energy {
  uint32_t version, reserved;
  const char* where; /* in which states, and why, in one sentence */
} mpm_material_makes_energy;

/* ---- mpm.material.dissipation ------------------------------------------------------------------------------------
 * What becomes of the `dissipated_energy` of a material's `update`. The energy ledger has a row of its own for each cause;
 * the energy of a material without this table stands in the row of all materials alone. */
#define MPM_MATERIAL_DISSIPATION_ID "mpm.material.dissipation"
#define MPM_MATERIAL_DISSIPATION_VERSION 1u
enum mpm_dissipation_cause {
  MPM_PLASTIC_WORK = 1, /* of solids and grains that yield */
  MPM_VISCOUS_FLOW = 2, /* of fluids, and of solids that creep or relax */
  MPM_DAMAGE = 3        /* of cracks that open */
};
typedef struct mpm_material_dissipation {
  uint32_t version, cause; /* mpm_dissipation_cause */
} mpm_material_dissipation;

/* ---- mpm.material.clamps -----------------------------------------------------------------------------------------
 * Where the material goes on otherwise than its law says: a number is held at a bound, or a curve goes on along its
 * tangent. What belongs to the law itself, as the yield of a solid, is no clamp. The host looks at its particles when it
 * records and warns once of each clamp that acted: "WHERE BOUND UNIT, WHAT". */
#define MPM_MATERIAL_CLAMPS_ID "mpm.material.clamps"
#define MPM_MATERIAL_CLAMPS_VERSION 1u
#define MPM_CLAMPS 32u /* of one material, at most */
typedef struct mpm_clamp {
  const char* where; /* a word and the name of what is compared: "below J =", "above T =" */
  const char* unit;  /* of the bound */
  const char* what;  /* what is clamped and what follows, without a capital at the start and a stop at the end */
} mpm_clamp;
typedef struct mpm_clamp_batch {
  uint32_t count, stride, dimension, axisymmetric; /* axisymmetric: 1 where fields are kept as in such scenes */
  const void* temperature;                         /* [stride], K, or null */
  const void* const* state;                        /* declared state fields, each [components][stride], double */
  uint32_t* acting;                                /* [stride] out: bit k where clamp k acts */
} mpm_clamp_batch;
typedef struct mpm_material_clamps {
  uint32_t version, count;
  const mpm_clamp* clamps; /* [count] */
  /* bound[k], [count] out: where clamp k begins; not a number where it cannot act with these parameters */
  void (*bounds)(const void* parameters, double* bound);
  void (*find[2])(const void* parameters, const mpm_clamp_batch* batch); /* [dimension - 2] */
} mpm_material_clamps;

/* ---- mpm.material.temperature ------------------------------------------------------------------------------------
 * The material reads `temperature` of its batches: that of the particles at the call (docs/method.md, Temperature). */
#define MPM_MATERIAL_TEMPERATURE_ID "mpm.material.temperature"
#define MPM_MATERIAL_TEMPERATURE_VERSION 1u
typedef struct mpm_material_temperature {
  uint32_t version, reserved;
  double reference; /* K: what the material takes where the batch has none; its initial state is at rest there */
} mpm_material_temperature;

/* ---- mpm.material.cell_size --------------------------------------------------------------------------------------
 * The material reads the grid's cell size, as laws that soften do, so that the energy of a crack or band does not
 * depend on the grid. The host writes it into the block of parameters, behind the declared ones. */
#define MPM_MATERIAL_CELL_SIZE_ID "mpm.material.cell_size"
#define MPM_MATERIAL_CELL_SIZE_VERSION 1u
typedef struct mpm_material_cell_size {
  uint32_t version;
  uint32_t offset; /* place of the 8-byte double in the block, m */
} mpm_material_cell_size;

#ifdef __cplusplus
}
#endif
#endif
