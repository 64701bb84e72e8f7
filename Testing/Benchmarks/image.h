/* An image as the core's input, with the memory that its grid borrows. */
#ifndef mlim_image_h
#define mlim_image_h

#include "mlim.h"

#ifdef __cplusplus
extern "C" {
#endif

enum
{
  BENCH_MESSAGE_SIZE = 512
};

typedef struct bench_image
{
  mlim_grid grid;
  void* owner;
  void (*release)(void* owner); /* NULL: nothing to release */
} bench_image;

/* Reads a .vti file, and makes the indicators of a label map; arrays, labels and background are chosen as the filters choose them. Not 0:
   `message` says in one sentence what is wrong, and `out` is empty. */
int bench_image_read(const char* path, char message[BENCH_MESSAGE_SIZE], bench_image* out);

/* VTK's version; never NULL. */
const char* bench_image_version(void);

#ifdef __cplusplus
}
#endif

#endif
