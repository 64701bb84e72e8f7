/* What is measured: real images, and scenes that are made here. */
#ifndef mlim_cases_h
#define mlim_cases_h

#include "image.h"

/* Value of indicator `label` at a point, in spacings. */
typedef double (*bench_scene)(const double at[3], int label);

typedef struct bench_case
{
  const char* name;  /* in the table; of an image also its file without .vti */
  bench_scene scene; /* NULL: an image */
  double facet_size; /* in the smallest spacing; 0: the default */
} bench_case;

/* All of them, in the order of the table. */
const bench_case* bench_cases(size_t* count);

/* Makes the scene, or reads the image from the folder. Not 0: `message` says why not. */
int bench_case_load(
  const bench_case* one, const char* folder, char message[BENCH_MESSAGE_SIZE], bench_image* out);

#endif
