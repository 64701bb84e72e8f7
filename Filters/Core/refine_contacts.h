/* Contacts, and other changes of a few balls, in a complex that stands: the vertices near them make room, the
   others stay. */
#ifndef mlim_refine_contacts_h
#define mlim_refine_contacts_h

#include "refine.h"

/* Brings the complex up to its balls, which are others since the last run. Surface vertices inside a ball, or
   in the neighbourhood of a contact, which is to be sampled anew, go; so do balls that are no more, and
   those that are new go in. Balls without room are marked (one byte each) and counted; if there are
   any, they have to be taken out and this done again. */
mlim_status mlim_contacts_enter(mlim_refinement* refinement, mlim_context* context,
  unsigned char* is_hidden, size_t* hidden_count);

#endif
