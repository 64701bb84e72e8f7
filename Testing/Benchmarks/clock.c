#include "clock.h"

#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

double bench_clock_user(void)
{
  struct rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  return (double)usage.ru_utime.tv_sec + 1e-6 * (double)usage.ru_utime.tv_usec;
}

double bench_clock_wall(void)
{
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* An entry of Linux's list of a process's figures, which counts in units of 1024 bytes. */
static size_t status_entry(const char* name)
{
  FILE* file = fopen("/proc/self/status", "r");
  if (file == NULL)
  {
    return 0;
  }
  char line[256];
  size_t kilobytes = 0;
  while (kilobytes == 0 && fgets(line, sizeof line, file) != NULL)
  {
    if (strncmp(line, name, strlen(name)) == 0 &&
        sscanf(line + strlen(name), ": %zu", &kilobytes) != 1)
    {
      kilobytes = 0;
    }
  }
  fclose(file);
  return 1024 * kilobytes;
}

size_t bench_memory_now(void)
{
  return status_entry("VmRSS");
}

size_t bench_memory_peak(void)
{
  return status_entry("VmHWM");
}

void bench_memory_reset(void)
{
#ifdef __GLIBC__
  malloc_trim(0);
#endif
  FILE* file = fopen("/proc/self/clear_refs", "w");
  if (file != NULL)
  {
    fputs("5\n", file); /* the code for: the peak is what is in use now */
    fclose(file);
  }
}
