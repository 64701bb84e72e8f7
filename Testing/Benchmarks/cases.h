/* What is measured: real images, and scenes that are made here. */
#ifndef mlim_cases_h
#define mlim_cases_h

#include "image.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Value of indicator `label` at a point, in spacings. */
typedef double (*bench_scene)(const double at[3], int label);

typedef struct bench_case
{
  const char* name;  /* in the table; of an image also its file without .vti */
  bench_scene scene; /* NULL: an image */
  int label_count;   /* of a scene; the first is the background */
  double facet_size; /* in the smallest spacing; 0: the default */
} bench_case;

/* All of them, in the order of the table. */
const bench_case* bench_cases(size_t* count);

/* The first of the name; NULL: there is none. */
const bench_case* bench_case_find(const char* name);

/* Makes the scene, or reads the image from the folder. Not 0: `message` says why not. */
int bench_case_load(
  const bench_case* one, const char* folder, char message[BENCH_MESSAGE_SIZE], bench_image* out);

#ifdef __cplusplus
}
#endif

#endif
