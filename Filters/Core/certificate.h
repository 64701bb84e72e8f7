/* How far a finished mesh is right: measured, not assumed. */
#ifndef mlim_certificate_h
#define mlim_certificate_h

#include "complex.h"
#include "components.h"
#include "mlim.h"

/* Which components (one byte each) have a cell of the complex, or are too small to be asked for: below
   min_voxels; *lost counts the others. */
void mlim_certificate_find_components(const mlim_complex* complex,
  const mlim_components* components, size_t min_voxels, unsigned char* is_found, size_t* lost);

/* Fills labels and components of mesh->certificate. */
mlim_status mlim_certificate_count_components(const mlim_complex* complex,
  const mlim_components* components, size_t min_voxels, mlim_context* context, mlim_mesh* mesh);

typedef struct mlim_certificate_input
{
  const mlim_oracle* oracle;
  const mlim_options* options;
  const double* volumes; /* of the field, a label */
  const size_t* voxels;  /* a label */
} mlim_certificate_input;

/* The stage's share that is done when the certificate begins. */
#define MLIM_CERTIFY_FROM 0.4

/* Fills distances and volumes of mesh->certificate. */
mlim_status mlim_certificate_measure(
  const mlim_certificate_input* input, mlim_context* context, mlim_mesh* mesh);

#endif
