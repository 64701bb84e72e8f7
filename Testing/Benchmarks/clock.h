/* Time and memory of this process. */
#ifndef mlim_clock_h
#define mlim_clock_h

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Seconds of CPU time spent outside the system. */
double bench_clock_user(void);

/* Seconds since an arbitrary moment. */
double bench_clock_wall(void);

/* Bytes of memory in use, and the most since the start or the last reset. 0: cannot be told. */
size_t bench_memory_now(void);
size_t bench_memory_peak(void);

/* Gives free memory back to the system, and lets the peak begin anew from what is in use. Where
   the system does not offer that, the peak stays that of the whole process. */
void bench_memory_reset(void);

#ifdef __cplusplus
}
#endif

#endif
