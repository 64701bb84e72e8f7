/* What all tables begin with, and their place in a file. */
#ifndef mlim_report_h
#define mlim_report_h

#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Machine, versions, date and command, in Markdown. */
void bench_report_machine(const char* command, int thread_count, FILE* out);

/* Puts the text between the two lines of the file that mark the place of that name. Not 0: the file
   is as it was, and the reason is on stderr; so with MLIM_DEV, which does not optimise Mesh_3. */
int bench_report_replace(const char* path, const char* name, const char* text);

#ifdef __cplusplus
}
#endif

#endif
