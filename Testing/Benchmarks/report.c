#include "report.h"

#include "bulk.h"
#include "image.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/* The value of "key : value" in the system's list of processors, without the end of its line. */
static void read_processor(char* out, size_t size)
{
  snprintf(out, size, "unknown processor");
  FILE* file = fopen("/proc/cpuinfo", "r");
  if (file == NULL)
  {
    return;
  }
  char line[256];
  int is_found = 0;
  while (!is_found && fgets(line, sizeof line, file) != NULL)
  {
    const char* value = strchr(line, ':');
    if (strncmp(line, "model name", strlen("model name")) == 0 && value != NULL)
    {
      is_found = 1;
      value += 1 + strspn(value + 1, " \t");
      snprintf(out, size, "%.*s", (int)strcspn(value, "\n"), value);
    }
  }
  fclose(file);
}

void bench_report_machine(const char* command, int thread_count, FILE* out)
{
  char processor[256];
  char date[32] = "";
  const time_t now = time(NULL);
  struct tm day;
  if (localtime_r(&now, &day) != NULL)
  {
    strftime(date, sizeof date, "%Y-%m-%d", &day);
  }
  read_processor(processor, sizeof processor);
  fprintf(out, "- Date: %s\n", date);
  char threads[32] = "one thread";
  if (thread_count > 1)
  {
    snprintf(threads, sizeof threads, "up to %d threads", thread_count);
  }
  fprintf(out, "- Machine: %s, %ld cores; %s in use\n", processor, sysconf(_SC_NPROCESSORS_ONLN),
    threads);
  fprintf(out, "- Compiler: %s; CGAL %s%s; VTK %s\n", BENCH_COMPILER, bench_bulk_version(),
    BENCH_HAS_SLOW_PEERS ? ", its Mesh_3 not optimised" : "", bench_image_version());
  fprintf(out, "- Command: `%s`\n\n", command);
}

/* The whole text of a file; NULL: it cannot be read. */
static char* read_text(const char* path)
{
  FILE* file = fopen(path, "rb");
  char* text = NULL;
  if (file == NULL)
  {
    return NULL;
  }
  if (fseek(file, 0, SEEK_END) == 0)
  {
    const long size = ftell(file);
    rewind(file);
    text = size < 0 ? NULL : malloc((size_t)size + 1);
    if (text != NULL)
    {
      text[fread(text, 1, (size_t)size, file)] = '\0';
    }
  }
  fclose(file);
  return text;
}

int bench_report_replace(const char* path, const char* name, const char* text)
{
  int result = 1;
  FILE* file = NULL;
  char marks[2][64];
  if (BENCH_HAS_SLOW_PEERS)
  {
    fprintf(stderr, "%s is as it was: with MLIM_DEV Mesh_3 is not optimised.\n", path);
    return result;
  }
  snprintf(marks[0], sizeof marks[0], "<!-- %s: begin -->\n", name);
  snprintf(marks[1], sizeof marks[1], "<!-- %s: end -->\n", name);
  char* old = read_text(path);
  char* begin = old == NULL ? NULL : strstr(old, marks[0]);
  char* end = begin == NULL ? NULL : strstr(begin, marks[1]);
  if (end == NULL)
  {
    fprintf(stderr, "%s cannot be read, or lacks the lines %sand %s", path, marks[0], marks[1]);
    goto done;
  }
  file = fopen(path, "wb");
  if (file == NULL)
  {
    fprintf(stderr, "%s cannot be written.\n", path);
    goto done;
  }
  *begin = '\0';
  fprintf(file, "%s%s\n%s%s", old, marks[0], text, end);
  result = fclose(file) != 0;
done:
  free(old);
  return result;
}
