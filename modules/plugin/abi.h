/* The plugin boundary of MPM Sandbox, in plain C.
 *
 * A plugin is a shared object that exports ONE symbol, `mpm_plugin_library_v`, a constant `mpm_plugin_library`.
 * The host reads abi_version before anything else and refuses a plugin of another version by name.
 *
 * Each component has a descriptor: what it is called, its parameters and state, and the core table of its kind, which
 * holds what every component of the kind has. What only some have is an extension: a small table of its own, found by
 * an id (plugin/extensions.h).
 *
 * Rules for every function reached from here:
 *  - any thread may call it, several at once, with disjoint batches; it keeps no global or static mutable state;
 *  - it never allocates, throws, prints, or keeps a pointer it was given after it returns;
 *  - it never parses JSON: the host checks values against the tables below and hands over a filled block of doubles.
 *
 * Batches: arrays are laid out [component][stride], 64-byte aligned, stride >= count. `count` is a multiple of
 * MPM_LANES; the tail beyond the real particles holds copies of a valid particle, so every lane may be computed.
 * Scalars are float or double by the entry's precision (`void*` below). Index order of entry tables: see mpm_precision.
 */
#ifndef MPM_PLUGIN_ABI_H
#define MPM_PLUGIN_ABI_H
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The boundary is unstable until 1.0 of the sandbox: any change of a struct or number below makes a new version, and a
 * host takes plugins of its own version alone. */
#define MPM_ABI_VERSION 6u
#define MPM_BATCH 64u /* particles or nodes in a full batch */
#define MPM_LANES 16u /* counts are padded to a multiple of this */

enum mpm_kind {
  MPM_SHAPE = 1,
  MPM_TRANSFER = 2,
  MPM_FILTER = 3,
  MPM_CONTACT = 4,
  MPM_MATERIAL = 5,
  MPM_NORMAL = 6,
  MPM_DETECTION = 7
};

/* Index into the entry tables. The reference backend takes the plain instantiation, MPM_SCALAR_DOUBLE, as its oracle.
 */
enum mpm_precision { MPM_LANES_FLOAT = 0, MPM_LANES_DOUBLE = 1, MPM_SCALAR_DOUBLE = 2, MPM_PRECISIONS = 3 };

enum mpm_parameter_type { MPM_NUMBER = 0, MPM_INTEGER = 1, MPM_BOOLEAN = 2, MPM_CHOICE = 3 };
enum mpm_parameter_flag {
  MPM_REQUIRED = 1,
  MPM_ABOVE_MINIMUM = 2 /* minimum itself excluded */,
  MPM_BELOW_MAXIMUM = 4
};

/* One parameter: an 8-byte double at `offset` in the block; booleans are 0 or 1, a choice is its index. */
typedef struct mpm_parameter {
  const char* name;
  const char* unit;    /* SI unit, e.g. "Pa"; "" for a pure number */
  const char* doc;     /* one sentence */
  const char* choices; /* "first|second|third" for MPM_CHOICE, else "" */
  uint32_t type;
  uint32_t flags;
  uint32_t offset;
  uint32_t reserved;
  double default_value;
  double minimum;
  double maximum;
} mpm_parameter;

/* Components in 2-D / 3-D:
 *   scalar 1/1, vector 2/3, matrix 4/9 (row-major),
 *   symmetric 4/6 (xx yy zz xy / xx yy zz yz xz xy),
 *   deformation 5/9 (a matrix of three-dimensional space: xx xy yx yy zz / row-major),
 *   plane deformation 4/9 as a matrix, but 5 as a deformation in axisymmetric scenes: zz is 1 in plane strain and is
 *   not kept there. */
enum mpm_state_shape {
  MPM_STATE_SCALAR = 0,
  MPM_STATE_VECTOR = 1,
  MPM_STATE_MATRIX = 2,
  MPM_STATE_SYMMETRIC = 3,
  MPM_STATE_DEFORMATION = 4,
  MPM_STATE_PLANE_DEFORMATION = 5
};
enum mpm_state_initial { MPM_INITIAL_ZERO = 0, MPM_INITIAL_ONE = 1, MPM_INITIAL_IDENTITY = 2 };

/* One field a particle carries because this plugin is chosen: a transfer, a material or a contact law. */
typedef struct mpm_state {
  const char* name;
  const char* unit;
  const char* doc;
  uint32_t shape;
  uint32_t initial;
} mpm_state;

/* ---- shape ----------------------------------------------------------------------------------------------------
 * Positions and lengths are in cells. Two forms: a tensor product of weights along the axes, or a list of nodes. */
enum mpm_shape_form { MPM_TENSOR_PRODUCT = 0, MPM_NODE_LIST = 1 };
enum mpm_second_moment {
  MPM_MOMENT_CONSTANT = 0, /* sum w d d^T = second_moment h^2 I everywhere */
  MPM_MOMENT_IS_GRADIENT =
      1, /* w D^-1 d equals grad w identically (linear): the host uses gradients for the affine moment */
  MPM_MOMENT_PER_PARTICLE = 2 /* the batch fills second_moment, positive definite */
};
typedef struct mpm_shape_batch {
  uint32_t count, stride, dimension, reserved;
  const void* position;  /* [D][stride], from any node of the grid */
  const void* half_size; /* [D][stride], half the undeformed particle's box; null unless MPM_NEEDS_HALF_SIZE */
  const void* domain;    /* [D*D][stride], see mpm_list_batch; null unless MPM_NEEDS_DOMAIN */
  int32_t* base;         /* [D][stride] out: first node of the stencil */
  void* offset;          /* [D][stride] out: position - base */
  void* weight;          /* [D][width][stride] out */
  void* gradient;        /* [D][width][stride] out: derivative by position; null when the plan needs none */
  void* second_moment;   /* [D][stride] out: sum w d^2 along each axis; null unless per particle and needed */
} mpm_shape_batch;
/* A shape with MPM_NEEDS_DOMAIN gives all weights zero along an axis on which `width` nodes do not hold the particle's
 * domain; the run then stops with that particle's number. Its `base` depends on the position alone: hosts sort by it.
 */
/* A particle's nodes, each once: `node_count` of them, at most `capacity`. Entries beyond a particle's count are
 * undefined. No node lies farther from the particle than sum_k |domain_ak| + reach along an axis a. */
typedef struct mpm_list_batch {
  uint32_t count, stride, dimension, capacity;
  const void* position;  /* [D][stride] */
  const void* half_size; /* [D][stride]; null unless MPM_NEEDS_HALF_SIZE */
  const void* domain;    /* [D*D][stride] row-major: column k is the k-th semi-side vector of the particle's domain,
                            F times the undeformed one; advanced by the host; null unless MPM_NEEDS_DOMAIN */
  int32_t* node_count;   /* [stride] out */
  int32_t* node;         /* [capacity][D][stride] out: coordinates */
  void* weight;          /* [capacity][stride] out */
  void* gradient;        /* [capacity][D][stride] out: by position; null when the plan needs none */
  void* second_moment;   /* [D*D][stride] out: sum w d d^T, row-major; null unless per particle and needed */
  /* [sample_points][D][stride], cells from the particle; null unless the shape has such points. */
  const void* samples;
} mpm_list_batch;
typedef struct mpm_shape {
  uint32_t form, width, second_moment_kind, reserved; /* width: nodes an axis of a tensor product, 2 to 4 */
  double second_moment;                               /* cells^2, of MPM_MOMENT_CONSTANT */
  void (*evaluate[MPM_PRECISIONS])(const void* parameters,
                                   const mpm_shape_batch* batch); /* tensor product, else null */
  uint32_t capacity[2];                                           /* most nodes of a list, [dimension - 2] */
  double reach;                                                   /* reach of a list, see mpm_list_batch */
  void (*evaluate_list[MPM_PRECISIONS][2])(const void* parameters, const mpm_list_batch* batch); /* list, else null */
  /* Corners that each particle of a list carries, [dimension - 2]: 0, or 4 and 8. The corners of a quadrilateral and of
   * a hexahedron are then its domain (corner c is at the upper end along axis k where bit k of c is set), which the
   * host moves with the grid's multilinear velocity and whose centroid the particle is. No node lies farther than the
   * farthest corner + reach along an axis. A domain turned inside out has node_count 0, and the run stops. */
  uint32_t sample_points[2];
} mpm_shape;

/* ---- transfer ------------------------------------------------------------------------------------------------
 * A particle gives a node  w (b + A d) + S grad w  with d = node - particle (m). Gathered moments are
 * sum w v,  sum w (v+ - v-),  C = sum v (x) (w D^-1 d)  and  L = sum v (x) grad w; only declared ones are filled. */
enum mpm_transfer_trait {
  MPM_SCATTERS_AFFINE = 1,        /* fills A */
  MPM_GATHERS_INCREMENT = 2,      /* reads velocity_increment: the grid keeps v- beside v+ */
  MPM_GATHERS_AFFINE = 4,         /* reads affine */
  MPM_STRESS_BY_AFFINE = 8,       /* stress enters as -V0 tau D^-1 in A, not as -V0 tau in S (MLS-MPM) */
  MPM_STRAIN_BY_AFFINE = 16,      /* the velocity gradient that strains the particle is the affine moment itself */
  MPM_AFFINE_CARRIES_ENERGY = 32, /* the kinetic energy of state 0 (affine velocity) is m/2 tr(C D C^T) */
  MPM_GATHERS_GRADIENT = 64,      /* reads velocity_gradient */
  MPM_READS_SECOND_MOMENT = 128,  /* reads second_moment */
  MPM_KEEPS_SPIN_ONLY = 256,      /* state 0 (affine velocity) is antisymmetric; the host starts it so */
  MPM_STARTS_WITH_GRADIENT = 512, /* state 0, a matrix, starts as the gradient of the first velocity field, as it does
                                    with MPM_AFFINE_CARRIES_ENERGY; its energy and momentum do not count */
  /* Velocity and state after a gather follow from what is gathered alone (neither is read), and the particle moves with
   * the gathered velocity: the host need not keep velocity and state from one step to the next. */
  MPM_REPLACES_MOTION = 1024
};
typedef struct mpm_scatter_batch {
  uint32_t count, stride, dimension, reserved;
  const void* mass;         /* [stride], kg */
  const void* velocity;     /* [D][stride], m/s */
  const void* const* state; /* declared state fields, each [components][stride] */
  void* b;                  /* [D][stride] out, kg m/s */
  void* A;                  /* [D*D][stride] out, kg/s, row = component; null unless MPM_SCATTERS_AFFINE */
} mpm_scatter_batch;
typedef struct mpm_gather_batch {
  uint32_t count, stride, dimension, reserved;
  double dt;
  const void* velocity;           /* [D][stride] sum w v+ */
  const void* velocity_increment; /* [D][stride] sum w (v+ - v-), or null */
  const void* affine;             /* [D*D][stride] C, 1/s, or null */
  const void* velocity_gradient;  /* [D*D][stride] L = sum v+ (x) grad w, 1/s, or null */
  void* particle_velocity;        /* [D][stride] in: before, out: after */
  void* const* state;             /* in and out */
  void* advection_velocity;       /* [D][stride] out: velocity that moves the particle */
  /* [D*D][stride] D = sum w d d^T, cells^2; null where it is a multiple of the identity. */
  const void* second_moment;
} mpm_gather_batch;
typedef struct mpm_transfer {
  uint32_t traits, reserved;
  void (*scatter[MPM_PRECISIONS][2])(const void* parameters,
                                     const mpm_scatter_batch* batch); /* [precision][dimension - 2] */
  void (*gather[MPM_PRECISIONS][2])(const void* parameters, const mpm_gather_batch* batch);
} mpm_transfer;

/* ---- filter ---------------------------------------------------------------------------------------------------
 * The host runs the loop; the plugin says how a node's accumulated velocity and increment change in one pass:
 *   increment <- velocity of the grid;  repeat iterations():
 *     projected <- S+ S increment   (one gather and one mass-weighted scatter, by the transfer of the scene)
 *     update(projected, increment, velocity)
 *     conditions and contact correct `velocity`; increment takes the net change of velocity in this pass
 *   until the mass norm of the increment is small enough, when the experiment says so.
 * Gathered, the result replaces the particles' velocity and moves them; after the forces it strains them as well. */
enum mpm_filter_trait {
  /* The filter acts on v-: particles take it plus dt f / m, the strain is that of the unfiltered velocity (XPIC).
   * Without this trait v+ is filtered for everything (FMPM). */
  MPM_FILTERS_BEFORE_FORCES = 1
};
typedef struct mpm_filter_batch {
  uint32_t count, stride, dimension, iteration; /* iteration: from 1 */
  const void* projected;                        /* [D][stride], m/s */
  void* increment;                              /* [D][stride] in and out, m/s */
  void* velocity;                               /* [D][stride] in and out, m/s: accumulated */
} mpm_filter_batch;
typedef struct mpm_filter {
  uint32_t traits, reserved;
  int32_t (*iterations)(const void* parameters); /* passes of the loop, 0 or more */
  void (*update[MPM_PRECISIONS][2])(const void* parameters, const mpm_filter_batch* batch);
} mpm_filter;

/* ---- contact law ----------------------------------------------------------------------------------------------
 * One batch entry is the pair (a, b) of velocity fields at one node. Where b is a rigid body that moves as it is told, its
 * mass is infinite, its momentum zero, and the velocity of a is relative to it: the impulse on a stays finite.
 *
 * A law may declare a state, so that it knows what was there before: up to MPM_CONTACT_STATES scalars that begin at 0 and
 * never fall. Particles of both bodies keep them; nodes know of each body the mean by mass. After the forces the law says
 * what the pair has reached, and a particle then takes the mean by weights of this over the nodes that it sees and where its
 * body met another, if that is more than it has. A law that returns more than what the step itself tells, a mean that it
 * was given say, spreads its state by a cell in every step. */
#define MPM_CONTACT_STATES 2u
enum mpm_contact_trait {
  MPM_BYPASSES_DETECTION = 1, /* a weld: no prescreen, detection or cap */
  MPM_PULLS = 2,              /* may resist separation (adhesion) */
  /* Joins the bodies by springs: reads displacement and fills stored. A scene sums displacements for it alone. */
  MPM_COMPLIANT = 4,
  /* Its impulse follows from a force over the step, which it gives after the forces: hosts refuse filters whose loop would
   * add it again in every pass. */
  MPM_ACTS_OVER_TIME = 8,
  /* Reads traction. A scene measures it for such a law alone. */
  MPM_READS_TRACTION = 16
};
/* A law is asked twice in a step: before the forces about the velocity v- that particles bring, and after them about v+. */
enum mpm_contact_stage { MPM_BEFORE_FORCES = 0, MPM_AFTER_FORCES = 1 };
enum mpm_contact_status { MPM_APART = 0, MPM_STICKS = 1, MPM_SLIPS = 2 };
typedef struct mpm_contact_batch {
  uint32_t count, stride, dimension, stage; /* stage: mpm_contact_stage */
  double dt;
  const void* mass_a;     /* [stride], kg */
  const void* mass_b;     /* may be infinite */
  const void* momentum_a; /* [D][stride], kg m/s */
  const void* momentum_b;
  const void* normal;     /* [D][stride], unit, from a to b, shared by the pair unless each has its own */
  const void* separation; /* [stride], m, negative when the surfaces overlap */
  const void* area;       /* [stride], m^2 (m in 2-D per metre of depth) */
  void* impulse;          /* [D][stride] out: added to a, taken from b, kg m/s */
  void* dissipated;       /* [stride] out: energy turned to heat by the law, J */
  int32_t* status;        /* [stride] out: mpm_contact_status */
  /* [D][stride], m: how far b's particles have moved since the start, less how far a's have, both as means by mass over
   * the node's weights. Null unless MPM_COMPLIANT. */
  const void* displacement;
  /* [stride] out: energy that springs take up over the step, J, negative where they give it back. Null unless
   * MPM_COMPLIANT. */
  void* stored;
  /* [D][stride], Pa: the traction on a that would hold the pair together through the step, which is what a weld would give
   * at all nodes within two cells where the pair meets, over dt and the area of these nodes. Null unless
   * MPM_READS_TRACTION. */
  const void* traction;
  double cell_size; /* m */
  /* [state][stride]: what the particles of each body keep, as means by mass, and how much of that the step before has
   * added. Null unless the law has a state. */
  const void* state_a;
  const void* state_b;
  const void* gained_a;
  const void* gained_b;
  void* reached;                 /* [state][stride] out, read after the forces; null likewise */
  uint32_t first_step, reserved; /* 1 in the first step of a scene: nothing has moved yet */
} mpm_contact_batch;
typedef struct mpm_contact {
  uint32_t traits, reserved;
  void (*apply[MPM_PRECISIONS][2])(const void* parameters, const mpm_contact_batch* batch);
} mpm_contact;

/* ---- contact normal -------------------------------------------------------------------------------------------
 * The direction in which two bodies meet at a node, from sums of their particles over the node's weights, or from the
 * places of those particles. Hosts ask in double whatever the run's precision: sums of two bodies nearly cancel. */
enum mpm_normal_trait {
  MPM_READS_MASS_GRADIENT = 1,   /* mass_gradient_a and _b are filled: a scene sums what its normal reads */
  MPM_READS_VOLUME_GRADIENT = 2, /* volume_gradient_a and _b are filled */
  /* from_points finds the normal. Where it finds none the host takes that of the averaged volume gradients, and sums
   * them for it. */
  MPM_LOOKS_AT_POINTS = 4,
  /* Each body has a normal of its own: own_a and own_b are filled, and momentum is not kept. */
  MPM_OWN_NORMALS = 8
};
/* One batch entry is the pair (a, b) of velocity fields at one node. Gradients are by the particles' positions and point
 * out of a body: sum m grad w, and sum V grad w with the current volumes V. In axisymmetric scenes mass and volume are
 * those of the section, as a ring's grow away from the axis. */
typedef struct mpm_normal_batch {
  uint32_t count, stride, dimension, reserved;
  const void* mass_gradient_a; /* [D][stride], kg/m (kg/m^2 in 2-D, per metre of depth); null unless read */
  const void* mass_gradient_b;
  const void* volume_gradient_a; /* [D][stride], m^2 (m in 2-D); null unless read */
  const void* volume_gradient_b;
  void* normal;   /* [D][stride] out: unit, from a to b; where none is found any value */
  void* own_a;    /* [D][stride] out: that of a alone, unit, out of a; null unless MPM_OWN_NORMALS */
  void* own_b;    /* [D][stride] out: that of b alone, unit, into b; null unless MPM_OWN_NORMALS */
  int32_t* found; /* [stride] out: 1 where there is a normal, else 0 */
} mpm_normal_batch;
/* The particles of both bodies near one node. Lanes from a count to its stride repeat the first particle. */
typedef struct mpm_normal_points {
  uint32_t count_a, stride_a, count_b, stride_b; /* counts are 1 or more */
  const double* position_a;                      /* [3][stride_a], cells from the node; z is 0 in 2-D */
  const double* position_b;                      /* [3][stride_b] */
  /* [stride_a]: the quadratic B-spline's weight of the node at the particle, 0 from 1.5 cells along an axis on; lanes
   * that repeat have 0. */
  const double* weight_a;
  const double* weight_b; /* [stride_b] */
  double* normal;         /* [3] out: unit, from a to b */
} mpm_normal_points;
typedef struct mpm_normal {
  uint32_t traits, reserved;
  void (*from_sums[MPM_PRECISIONS][2])(const void* parameters, const mpm_normal_batch* batch); /* null with points */
  /* [dimension - 2]; returns 1 where there is a normal, else 0. Null without MPM_LOOKS_AT_POINTS. */
  int32_t (*from_points[2])(const void* parameters, const mpm_normal_points* points);
} mpm_normal;

/* ---- contact detection ----------------------------------------------------------------------------------------
 * How far apart the surfaces of two bodies are at a node, along the pair's normal: laws touch where that is not positive.
 * All values are places along the normal, in cells from the node, with a on the near side. Hosts ask in double whatever the
 * run's precision. */
enum mpm_detection_trait {
  MPM_READS_MEAN_POSITION = 1, /* mean_a and mean_b: a scene sums positions for a detection that reads them or edges */
  /* edge_a and edge_b: the faces whose rows of particles would have these means, by the scene's shape function and
   * particles a cell */
  MPM_READS_EDGES = 2,
  /* surface_a and surface_b: how far the outermost particles that the node sees extend, as the ellipses (ellipsoids)
   * inscribed in their deformed domains. Hosts keep the particles near nodes for it, and refuse MPM_OWN_NORMALS. */
  MPM_READS_PARTICLE_SURFACES = 4
};
typedef struct mpm_detection_batch {
  uint32_t count, stride;
  const void* mean_a; /* [stride], where the mass that the node sees of each body lies; null unless read */
  const void* mean_b;
  const void* edge_a; /* [stride]; null unless read */
  const void* edge_b;
  const void* surface_a; /* [stride]; null unless read */
  const void* surface_b;
  void* gap; /* [stride] out: between the surfaces, cells, negative where they overlap */
} mpm_detection_batch;
typedef struct mpm_detection {
  uint32_t traits, reserved;
  void (*find[MPM_PRECISIONS])(const void* parameters, const mpm_detection_batch* batch);
} mpm_detection;

/* ---- material -------------------------------------------------------------------------------------------------
 * `update` first advances the state over dt with the velocity gradient (skipped when that is null), then fills every
 * output that is not null. It returns -1, or the index of the first particle whose state is not admissible (J <= 0 or
 * not a number). Energies are per initial volume. Every material has a parameter named `density` (kg/m^3). */
enum mpm_material_trait {
  MPM_HYPERELASTIC = 1, /* tau = (dpsi/dF) F^T: the conformance suite checks it */
  MPM_OBJECTIVE = 2,    /* tau(QF) = Q tau Q^T */
  MPM_DISSIPATES = 4,   /* dissipated_energy may be positive */
  /* 2-D entries read velocity_gradient_zz: the material runs in axisymmetric scenes. */
  MPM_STRAINS_AROUND_AXIS = 8
};
typedef struct mpm_material_batch {
  uint32_t count, stride, dimension, reserved;
  double dt;
  const void* velocity_gradient; /* [D*D][stride], 1/s, row = velocity component; null: only evaluate */
  /* [stride], 1/s: zz of the velocity gradient, v_r / r in axisymmetric scenes (x = r, y the axis, z around it). Null
   * in plane strain and 3-D and only there: without velocity_gradient its values are not read. */
  const void* velocity_gradient_zz;
  /* [stride], K; read by materials with the extension mpm_material_temperature alone. Null: the reference
   * temperature of that extension everywhere. */
  const void* temperature;
  void* const* state;      /* in and out */
  void* kirchhoff_stress;  /* [symmetric][stride] out, Pa */
  void* stored_energy;     /* [stride] out, J/m^3 */
  void* dissipated_energy; /* [stride] out, J/m^3, of this advance */
  void* wave_speed;        /* [stride] out, m/s, of the fastest tangent wave */
  void* volume_ratio;      /* [stride] out, J = det F */
} mpm_material_batch;
typedef struct mpm_material {
  uint32_t traits, reserved;
  int32_t (*update[MPM_PRECISIONS][2])(const void* parameters, const mpm_material_batch* batch);
} mpm_material;

/* ---- descriptor and library ----------------------------------------------------------------------------------- */
enum mpm_dimension_bit { MPM_2D = 1, MPM_3D = 2 };
enum mpm_need {
  MPM_NEEDS_HALF_SIZE = 1, /* shapes: half_size */
  MPM_NEEDS_DOMAIN = 2     /* shapes: domain; each particle then carries D*D scalars that the host advances with L */
};

typedef struct mpm_descriptor {
  const char* id;       /* lower_case, unique within its kind */
  const char* version;  /* the plugin's own version, "1.0.0" */
  const char* summary;  /* one line */
  const char* citation; /* paper, equation */
  const char* manual;   /* Markdown: what it models, its equations, when to use it */
  uint32_t kind;
  uint32_t dimensions; /* mpm_dimension_bit */
  uint32_t precisions; /* 1 << mpm_precision */
  uint32_t needs;      /* mpm_need */
  const mpm_parameter* parameters;
  uint32_t parameter_count;
  uint32_t parameter_bytes;
  const mpm_state* state;
  uint32_t state_count;
  uint32_t kind_table_size;
  const void* kind_table;   /* of the kind: mpm_shape, mpm_transfer, ... */
  const char* functor_name; /* C++ name inside `source` */
  const char* source;       /* text of the functor's header, for run-time compilation */
  /* The table of an extension by its id (plugin/extensions.h), or null where there is none of that id: always the same
   * answer, which lives as long as the library. Null: no extensions. */
  const void* (*extension)(const char* id);
} mpm_descriptor;

typedef struct mpm_plugin_library {
  uint32_t abi_version; /* MPM_ABI_VERSION the plugin was compiled with: first, read alone */
  uint32_t struct_size; /* sizeof(mpm_plugin_library) */
  uint32_t descriptor_count;
  uint32_t reserved;
  const mpm_descriptor* descriptors;
} mpm_plugin_library;

#define MPM_PLUGIN_SYMBOL "mpm_plugin_library_v"

#ifdef __cplusplus
}
#endif
#endif
