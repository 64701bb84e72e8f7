/* Values of any scalar type as doubles. */
#ifndef mlim_scalars_h
#define mlim_scalars_h

#include "mlim.h"

/* Values `first` .. `first + count` of an array. */
void mlim_scalars_read(const mlim_array* array, size_t first, size_t count, double* out);

#endif
