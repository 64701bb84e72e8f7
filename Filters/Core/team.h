/* Threads that stay awake for one another. One leads; from one offer of work to the next the others stand by without
   being woken: for pieces of work of some 0.1 ms, of which waking a thread would take half. Nothing depends on whether
   others come at all. */
#ifndef mlim_team_h
#define mlim_team_h

#include "mlim.h"

typedef struct mlim_team mlim_team;

/* Runs `lead` once, on any of the host's threads: it may not report to the host. Others that the host has may take
   part in what it offers. It should take long beside waking a thread, and short beside the host's patience. */
void mlim_team_run(mlim_context* context, void (*lead)(void* job, mlim_team* team), void* job);

/* Whether no other thread stands by at the moment. */
int mlim_team_is_alone(const mlim_team* team);

/* Items 0 to count, each for one thread. Those from `second` on begin once all before it are done. */
typedef struct mlim_team_work
{
  void (*body)(void* job, size_t item);
  void* job;
  size_t count, second;
} mlim_team_work;

/* For the one who leads. Others take items until mlim_team_finish, which takes what is left and returns when all
   are done. One offer at a time. */
void mlim_team_offer(mlim_team* team, const mlim_team_work* work);
void mlim_team_finish(mlim_team* team);

#endif
