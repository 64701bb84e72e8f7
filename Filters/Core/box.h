/* The box's own boundary where the background reaches it: corners, edges and faces get points, so
   that the cells without far vertices fill the box. For volumes that keep the background. */
#ifndef mlim_box_h
#define mlim_box_h

#include "complex.h"

/* Points about `size` apart. *left receives the number of cells that still reach out of the box.
   MLIM_VERTEX_LIMIT: stopped early, all is valid. */
mlim_status mlim_box_fill(mlim_complex* complex, double size, mlim_context* context, size_t* left);

#endif
