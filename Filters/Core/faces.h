/* The faces of the box from 0 to `size`: face 2 k is the low one across axis k, 2 k + 1 the high one. A
   set of faces has a bit for each. */
#ifndef mlim_faces_h
#define mlim_faces_h

#include <stdint.h>

/* The faces on which a point lies: points are put on a face exactly. */
static inline unsigned mlim_faces_at(const double size[3], const double point[3])
{
  unsigned faces = 0;
  for (int k = 0; k < 3; ++k)
  {
    const double x = point[k];
    faces |= x < 0 || x > 0 ? 0 : 1u << (2 * k);
    faces |= x < size[k] || x > size[k] ? 0 : 2u << (2 * k);
  }
  return faces;
}

static inline int mlim_faces_count(unsigned faces)
{
  int count = 0;
  for (; faces != 0; faces &= faces - 1)
  {
    ++count;
  }
  return count;
}

/* -1: there is none. */
static inline int32_t mlim_faces_first(unsigned faces)
{
  int32_t face = 0;
  while (face < 6 && !(faces >> face & 1u))
  {
    ++face;
  }
  return face < 6 ? face : -1;
}

#endif
