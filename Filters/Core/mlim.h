/* Interface meshes of multi-label images: the core's whole public interface.

   The core knows an axis-aligned grid whose point (i, j, k) lies at (i sx, j sy, k sz). Every
   length is in the unit of the spacing. The host maps products to world space.

   The flow is one way:
     [label map -> indicators ->] grid -> field -> curves -> balls -> mesh (and volume).

   Every fallible function returns a status, fills `out` last, and on failure leaves `out` empty
   and one sentence in the context. Any product, also an empty one, may be passed to its _free. */
#ifndef mlim_h
#define mlim_h

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum mlim_status
{
  MLIM_OK,
  MLIM_INVALID_ARGUMENT, /* an input or an option is out of range */
  MLIM_OUT_OF_MEMORY,
  MLIM_CANCELLED,    /* the host's progress function asked to stop */
  MLIM_VERTEX_LIMIT, /* the vertex budget is used up; the mesh is valid but unfinished */
  MLIM_INTERNAL,     /* a promise of the core itself was broken: please report */
  MLIM_STATUS_END
} mlim_status;

/* A short text for a status; never NULL. */
const char* mlim_status_text(mlim_status status);

typedef enum mlim_stage
{
  MLIM_STAGE_INDICATORS,
  MLIM_STAGE_FIELD,
  MLIM_STAGE_CURVES,
  MLIM_STAGE_BALLS,
  MLIM_STAGE_SURFACE,
  MLIM_STAGE_CERTIFICATE,
  MLIM_STAGE_VOLUME,
  MLIM_STAGE_END
} mlim_stage;

/* The stage's name in words, for a progress text; never NULL. */
const char* mlim_stage_text(mlim_stage stage);

/* Work on the items [begin, end) of a job. */
typedef void (*mlim_body)(void* job, size_t begin, size_t end);

/* One context a run. Everything may be 0. */
typedef struct mlim_context
{
  /* Called on the calling thread; fraction in [0, 1] does not fall within a stage. A result other
     than 0 cancels. NULL: no progress. */
  int (*progress)(void* user, mlim_stage stage, double fraction);
  /* Calls body on disjoint ranges that cover [0, count), in any order, on any threads, and returns
     when all are done. NULL: the core runs serially. Results never depend on it. */
  void (*parallel_for)(void* user, size_t count, mlim_body body, void* job);
  void* user;        /* borrowed; handed to both functions */
  char message[512]; /* after a failure: one sentence, zero-terminated */
} mlim_context;

/* ---- input --------------------------------------------------------------------------------- */

typedef enum mlim_scalar
{
  MLIM_INT8,
  MLIM_UINT8,
  MLIM_INT16,
  MLIM_UINT16,
  MLIM_INT32,
  MLIM_UINT32,
  MLIM_INT64,
  MLIM_UINT64,
  MLIM_FLOAT32,
  MLIM_FLOAT64,
  MLIM_SCALAR_END
} mlim_scalar;

/* One indicator function on the grid; x varies fastest. */
typedef struct mlim_array
{
  const void* values; /* borrowed; dims[0] dims[1] dims[2] scalars, `stride` apart */
  mlim_scalar type;
  size_t stride;    /* in scalars; 1 for a plain array */
  int32_t id;       /* the label's id in the output; 0 is the background's */
  const char* name; /* borrowed; for messages; NULL: "array <k>" */
} mlim_array;

typedef enum mlim_background
{
  MLIM_BACKGROUND_NONE,      /* every array is a region; only the outside is background */
  MLIM_BACKGROUND_ARRAY,     /* the array number `background_array` */
  MLIM_BACKGROUND_CONSTANT,  /* an extra label, before all arrays: background_value everywhere */
  MLIM_BACKGROUND_COMPLEMENT /* an extra label, before all arrays: (largest sum) - (sum here) */
} mlim_background;

typedef enum mlim_tie_breaking
{
  MLIM_TIE_SMOOTH,      /* on plateaus a low-pass filtered copy of the tied indicators decides */
  MLIM_TIE_LOWEST_INDEX /* the lowest index wins */
} mlim_tie_breaking;

/* What happens to a label between grid points none of which has it: films, wedges and specks thinner
   than the grid can see. A grid point sees a label if one of its 27 neighbours has it. */
typedef enum mlim_unseen
{
  MLIM_UNSEEN_KEEP, /* the interpolants decide everywhere */
  MLIM_UNSEEN_DROP  /* where it is not seen a label is at most second: the film ends there */
} mlim_unseen;

/* Indicator functions made from a label map, see below. */
typedef struct mlim_indicators mlim_indicators;

typedef struct mlim_grid
{
  int32_t dims[3];          /* points along each axis; at least 2 */
  double spacing[3];        /* finite, above 0 */
  size_t array_count;       /* 1 to 32000 */
  const mlim_array* arrays; /* borrowed */
  /* Borrowed; NULL: none. Else the values come from here: array k is the indicator of label k of the
     map, the arrays' own values are not used, and there are as many arrays as labels. */
  const mlim_indicators* indicators;
  const unsigned char* is_outside; /* borrowed; one byte a point, not 0: outside; NULL: none */
  mlim_background background;
  size_t background_array; /* with MLIM_BACKGROUND_ARRAY */
  double background_value; /* with MLIM_BACKGROUND_CONSTANT; finite */
  mlim_tie_breaking tie_breaking;
  mlim_unseen unseen;
} mlim_grid;

/* The index over the grid. Holds no pointer into the grid's arrays once it is made. */
typedef struct mlim_field mlim_field;

/* Refuses (MLIM_INVALID_ARGUMENT): fewer than 2 points along an axis, bad spacing, no array,
   non-finite values (says how many, in which array, where first). */
mlim_status mlim_field_create(const mlim_grid* grid, mlim_context* context, mlim_field** out);
void mlim_field_free(mlim_field* field);

/* Labels are indices 0 .. count-1: the background's extra label first if there is one, then the
   arrays in their order. Where no label of the input is background, one more stands for the
   outside. */
int32_t mlim_field_label_count(const mlim_field* field);
int32_t mlim_field_label_id(const mlim_field* field, int32_t label);
/* The label of everything outside the image: the background's. Its id is 0. */
int32_t mlim_field_outside_label(const mlim_field* field);
/* Label of a point; outside the box the outside's. Section 3.1: argmax of the interpolants. */
int32_t mlim_field_label(const mlim_field* field, const double point[3]);

/* Label sets of curves and balls also name the face of the box on which they lie: code
   label_count + face, faces being 0 .. 5 for -x +x -y +y -z +z. */

/* The length of which the defaults are multiples: the cube root of a voxel's volume, and the spacing
   itself where it is the same along all axes. Spacings finite and above 0. */
double mlim_spacing_unit(const double spacing[3]);

/* ---- label maps ---------------------------------------------------------------------------- */

/* One id a grid point. Labels are indices into the ascending ids that occur. */
typedef struct mlim_label_map
{
  int32_t dims[3];
  double spacing[3];
  int32_t label_count;
  int32_t* ids;     /* ascending */
  uint16_t* labels; /* a grid point; x varies fastest */
} mlim_label_map;

/* Reads the values of any scalar type; the array's id is not used. Refuses (MLIM_INVALID_ARGUMENT):
   bad dimensions or spacing, values that are not whole numbers or not of 32 bits (signed), and more
   than 32000 different ones. */
mlim_status mlim_label_map_read(const int32_t dims[3], const double spacing[3],
  const mlim_array* values, mlim_context* context, mlim_label_map* out);
/* Every label whose id is not among the `count` ascending ones becomes `other`, itself an id of the
   map or a new one. */
mlim_status mlim_label_map_select(
  mlim_label_map* map, const int32_t* ids, size_t count, int32_t other, mlim_context* context);
void mlim_label_map_free(mlim_label_map* map);

typedef enum mlim_indicator_method
{
  MLIM_INDICATOR_DISTANCE, /* signed distance to the label's voxels, inside positive, smoothed */
  MLIM_INDICATOR_MASK      /* the label's mask (0 or 1), smoothed */
} mlim_indicator_method;

/* Lengths in units of the grid. */
typedef struct mlim_indicator_options
{
  mlim_indicator_method method;
  int32_t median_radius; /* in grid points, 0 to 8; 0: off */
  int32_t dilate_radius; /* in grid points, 0 to 8; 0: off */
  /* Distances are cut off at this length, inside and outside; at least a voxel's diagonal, at most 60
     spacings along each axis. 0: 3 of the largest spacings. */
  double distance_band;
  /* Of the Gaussian; at most 15 spacings along each axis. 0: 1.5 spacings, along each axis its own;
     below 0: no smoothing. */
  double gaussian_sigma;
  int32_t diffusion_iterations; /* of curvature anisotropic diffusion, 0 to 64; 0: off */
  double diffusion_time_step;   /* in squares of the smallest spacing; above 0, at most 0.125 */
  /* Not 0: distances are smoothed by a kernel without second moment, and each label gets a constant,
     at most six tenths of the smallest spacing, that makes the volume of its region what its voxels have. */
  int keeps_volume;
  /* Not 0: parts of one grid point's thickness, and labels that would be nowhere the largest, keep
     the lead over the others that they have before smoothing. */
  int keeps_thin;
} mlim_indicator_options;

mlim_indicator_options mlim_indicator_options_default(void);

/* The indicators, kept only where they can matter: memory grows with the image and the number of
   labels that meet in a neighbourhood, not with the number of labels. Holds no pointer to the map. */
mlim_status mlim_indicators_create(const mlim_label_map* map, const mlim_indicator_options* options,
  mlim_context* context, mlim_indicators** out);
void mlim_indicators_free(mlim_indicators* indicators);
/* Values of one label at all grid points, x fastest. */
void mlim_indicators_write(const mlim_indicators* indicators, int32_t label, float* out);
/* Whether the label's indicator is the largest at a grid point. */
int mlim_indicators_has(const mlim_indicators* indicators, int32_t label);

/* ---- options ------------------------------------------------------------------------------- */

typedef enum mlim_oracle_mode
{
  MLIM_ORACLE_EXACT,    /* walks the cells, finds every crossing */
  MLIM_ORACLE_BISECTION /* the paper's: looks at midpoints only */
} mlim_oracle_mode;

/* A cell size of its own for one label. */
typedef struct mlim_label_size
{
  int32_t id;  /* of a label of the field; the last entry for an id counts */
  double size; /* > 0 */
} mlim_label_size;

/* Lengths in units of the grid. */
typedef struct mlim_options
{
  double facet_size;               /* bound on the radius of a surface Delaunay ball; > 0 */
  double facet_radius_edge_ratio;  /* bound on circumradius / shortest edge; >= 0.6 */
  double facet_distance;           /* bound on a crossing's height above its facet; > 0 */
  double edge_size;                /* largest distance of neighbours on a curve; > 0 */
  double ball_radius_scale;        /* scales the first radii of the balls; in [0.01, 1] */
  double crossing_tolerance;       /* length at which the search of a crossing stops; > 0 */
  double junction_merge_tolerance; /* junctions closer than this become one; >= 0 */
  double
    smallest_distance; /* no two vertices are made closer than this, but for 0.585 of it in thin films and
                          where a triangle would be out of shape; > 0 */
  /* Regions are meshed finer than facet_distance where their volume would differ more than this,
     relative, from the image's; in [0, 1), 0: off. */
  double volume_tolerance;
  mlim_oracle_mode oracle_mode;
  size_t vertex_limit;         /* largest number of vertices; > 0 */
  size_t min_component_voxels; /* smaller components need not be in the mesh; >= 1 */
  /* Of the volume alone. */
  double cell_size;                   /* bound on the circumradius of a cell; > 0 */
  double cell_radius_edge_ratio;      /* bound on circumradius / shortest edge; >= 1; 0: 2 */
  const mlim_label_size* label_sizes; /* borrowed; in place of cell_size; NULL: none */
  size_t label_size_count;
  int remove_slivers;  /* 0: the cells stay Delaunay */
  int keep_background; /* 0: the volume is of the regions only; else it fills the box */
} mlim_options;

/* Lengths as multiples of the field's spacing (cube root of the voxel's volume): facet_size 2,
   facet_distance and edge_size from it, see mlim_options_complete. */
mlim_options mlim_options_default(const mlim_field* field);
/* Fills in each length that is 0 (junction_merge_tolerance: below 0): facet_size = 2 spacings,
   facet_distance = facet_size / 8, edge_size = facet_size, crossing_tolerance = 1e-6,
   junction_merge_tolerance = 0.25 spacings, smallest_distance = facet_size / 8 but at most 0.25
   spacings, cell_size = 2 facet_size. Then checks every option. */
mlim_status mlim_options_complete(
  const mlim_field* field, mlim_context* context, mlim_options* options);

/* ---- curves -------------------------------------------------------------------------------- */

/* Sets of label codes, each ascending and without repetition. */
typedef struct mlim_sets
{
  size_t count;
  size_t* offsets; /* count + 1; set s is labels[offsets[s] .. offsets[s + 1]) */
  int32_t* labels;
} mlim_sets;

/* The 1-skeleton: where three or more labels meet, and the creases of the caps. */
typedef struct mlim_curves
{
  size_t point_count;
  double* points; /* 3 each */
  size_t curve_count;
  size_t* curve_offsets; /* curve_count + 1, into curve_points */
  int32_t* curve_points; /* a closed loop repeats its first point at its end */
  int32_t* curve_sets;   /* per curve: index into sets */
  size_t junction_count; /* ends of curves; isolated junctions do not occur */
  int32_t* junction_points;
  int32_t* junction_sets;
  mlim_sets sets;
} mlim_curves;

mlim_status mlim_curves_extract(
  const mlim_field* field, const mlim_options* options, mlim_context* context, mlim_curves* out);
void mlim_curves_free(mlim_curves* curves);

/* ---- balls --------------------------------------------------------------------------------- */

enum
{
  MLIM_JUNCTION = -1, /* in the place of a ball's curve: it is a junction's */
  MLIM_CONTACT = -2   /* it is a contact's: one ball over a spot where sheets touch or are nearer to
                         each other than can be meshed. Only refinement makes them. */
};

/* Protecting balls: junction balls first, then those of each curve in order. */
typedef struct mlim_balls
{
  size_t ball_count;
  double* centers;      /* 3 each */
  double* radii;        /* > 0 */
  int32_t* ball_curves; /* curve of each ball, MLIM_JUNCTION or MLIM_CONTACT */
  int32_t* ball_sets;   /* index into sets */
  size_t edge_count;    /* pairs of neighbours on a curve */
  int32_t* edges;       /* 2 each */
  int32_t* edge_curves;
  mlim_sets sets;
} mlim_balls;

mlim_status mlim_balls_cover(
  const mlim_curves* curves, const mlim_options* options, mlim_context* context, mlim_balls* out);
void mlim_balls_free(mlim_balls* balls);

/* ---- mesh ---------------------------------------------------------------------------------- */

/* How far the mesh is right, measured after refinement. */
typedef struct mlim_certificate
{
  size_t label_count;           /* labels that own a component of at least min_component_voxels */
  size_t lost_label_count;      /* of them not in the mesh */
  size_t component_count;       /* 26-connected, at least min_component_voxels */
  size_t lost_component_count;  /* of them not in the mesh */
  size_t disk_failure_count;    /* vertices that do not satisfy the disk condition */
  size_t open_edge_count;       /* edges round which a region's boundary does not close */
  size_t grid_crossing_count;   /* label changes on grid edges */
  size_t far_crossing_count;    /* of them farther than facet_distance from the mesh */
  double max_crossing_distance; /* largest distance of a grid crossing from the mesh; searched up
                                    to 4 facet_distance + 2 spacings */
  double max_volume_difference; /* largest relative difference of a region's volume to the
                                    image's, over labels of at least 1000 voxels */
} mlim_certificate;

/* What refinement left undone, by kind, and the figures of the paper's Table 3. */
typedef struct mlim_report
{
  size_t insertion_count;
  size_t unresolved_crossing_count; /* facets whose dual crosses more than once */
  size_t unresolved_patch_count;    /* facets with a vertex of a foreign patch */
  size_t unresolved_size_count;     /* facets above facet_size, by the length floor or a ball */
  size_t unresolved_distance_count;
  size_t unresolved_ratio_count;      /* without a ball vertex */
  size_t relabeled_ratio_count;       /* without a ball vertex, come to light by relabelled cells */
  size_t unresolved_ball_ratio_count; /* with a ball vertex: quality gives way near balls */
  size_t hidden_ball_count;           /* balls left out because another one covers them */
  size_t lost_curve_edge_count;       /* neighbours on a curve between which the mesh has no edge */
  size_t contact_edge_count;          /* edges of three or more triangles between a contact and a
                                         ball, on no extracted curve */
  size_t off_curve_edge_count;        /* all others on no extracted curve */
  size_t relabeled_cell_count;        /* to mend topology below the smallest distance */
  double max_radius_edge_ratio;       /* triangles without a ball vertex */
  double mean_radius_edge_ratio;      /* all triangles */
  double max_ball_radius_edge_ratio;  /* triangles with a ball vertex */
  double min_dihedral_angle;          /* degrees, between sheets round a curve edge; 180 without */
  double min_angle;                   /* degrees, of all triangles */
} mlim_report;

/* Node types as materials users know them. */
enum
{
  MLIM_NODE_INTERFACE = 2,
  MLIM_NODE_CURVE = 3,
  MLIM_NODE_JUNCTION = 4,
  MLIM_NODE_ON_BOX = 10 /* added to one of the above */
};

/* The labelled partition. Vertices used by triangles, curve edges or junctions only. */
typedef struct mlim_mesh
{
  size_t vertex_count;
  double* vertices;      /* 3 each */
  int32_t* node_types;   /* MLIM_NODE_... */
  int32_t* label_counts; /* number of labels that meet at the vertex, the outside being one */
  size_t triangle_count;
  int32_t* triangles;        /* 3 each; the normal points from the first label to the second */
  int32_t* triangle_labels;  /* 2 label indices each: the background second, else by id */
  int32_t* triangle_faces;   /* face of the box for a cap's triangle, else -1 */
  int32_t* triangle_patches; /* connected interface piece, 0 .. patch_count - 1 */
  size_t patch_count;
  size_t edge_count;    /* curve edges, then those of three or more triangles off the curves */
  int32_t* edges;       /* 2 vertices each */
  int32_t* edge_curves; /* off the curves MLIM_CONTACT at a contact, else -1 */
  size_t junction_count;
  int32_t* junctions;   /* vertices */
  size_t contact_count; /* the last of the junctions are contacts */
  size_t label_count;
  double* volumes; /* per label: enclosed by its triangles; 0 for the outside's */
  double*
    disk_failures; /* places of the vertices that do not satisfy the disk condition, 3 each, as
                                  many as the certificate counts */
  int32_t* disk_failure_types; /* MLIM_NODE_... of each */
  mlim_report report;
  mlim_certificate certificate;
} mlim_mesh;

/* Refines the weighted Delaunay triangulation of the balls until all criteria hold, and reads the
   mesh from it. `balls` may have no ball. MLIM_VERTEX_LIMIT returns a mesh. */
mlim_status mlim_mesh_refine(const mlim_field* field, const mlim_balls* balls,
  const mlim_options* options, mlim_context* context, mlim_mesh* out);
void mlim_mesh_free(mlim_mesh* mesh);

/* ---- volume -------------------------------------------------------------------------------- */

typedef struct mlim_volume_report
{
  size_t insertion_count;         /* vertices that refinement added inside the regions */
  size_t unresolved_size_count;   /* cells that stayed above their size: no place for a point */
  size_t unresolved_ratio_count;  /* cells above the radius-edge ratio, without a ball vertex */
  size_t unresolved_box_count;    /* places where the kept background does not reach the box */
  size_t sliver_count;            /* after refinement: cells with a dihedral angle below 10 degrees
                                     or above 170 */
  size_t unresolved_sliver_count; /* of them left at the end */
  size_t exchange_count;          /* steps that bettered a cell */
  size_t added_vertex_count;      /* vertices that they added */
  double min_dihedral_angle;      /* degrees */
  double max_dihedral_angle;
  double max_radius_edge_ratio; /* cells without a ball vertex */
  double min_cell_volume;       /* of a cell */
} mlim_volume_report;

/* The regions filled with tetrahedra. The faces between two labels, or of one cell only, are exactly
   the surface mesh's triangles. */
typedef struct mlim_volume
{
  size_t vertex_count;
  size_t surface_vertex_count; /* the first vertices are those of the surface, in its order */
  double* vertices;            /* 3 each; every one is in a cell */
  size_t cell_count;
  int32_t* cells;       /* 4 each, positively oriented */
  int32_t* cell_labels; /* label indices */
  size_t label_count;
  double* label_volumes; /* of each label's cells */
  mlim_volume_report report;
} mlim_volume;

/* mlim_mesh_refine, and then the volume in the surface, which it does not change. On failure both
   are empty. MLIM_VERTEX_LIMIT returns both. */
mlim_status mlim_volume_refine(const mlim_field* field, const mlim_balls* balls,
  const mlim_options* options, mlim_context* context, mlim_mesh* surface, mlim_volume* out);
void mlim_volume_free(mlim_volume* volume);

#ifdef __cplusplus
}
#endif

#endif
