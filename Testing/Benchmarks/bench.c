/* Time and memory of each stage, on scenes that are made here and on real images.

     bench [--quick] [--data FOLDER] [--runs N] [--threads N] [--write FILE] [NAME ...]

   --quick: one run unless said otherwise. --threads: that many of VTK's; else the core runs serially. Without names all cases. Real images are looked for in the
   folder, else in the one that the environment variable MLIM_DATA names; without a folder they are
   left out. */
#include "record.h"
#include "report.h"

#include <stdlib.h>
#include <string.h>

enum
{
  DEFAULT_RUNS = 3,
  MAX_RUNS = 1000,
  MAX_THREADS = 1024
};

typedef struct arguments
{
  const char* folder; /* NULL: scenes only */
  const char* file;   /* NULL: nothing to write */
  int run_count;
  int thread_count; /* 0: no host's parallel-for */
  char** names;
  int name_count; /* 0: all */
} arguments;

/* Not 0: not understood. */
static int parse(int argc, char** argv, arguments* out)
{
  const char* folder = getenv("MLIM_DATA");
  *out = (arguments){ .run_count = DEFAULT_RUNS, .folder = folder };
  int i = 1;
  if (i < argc && strcmp(argv[i], "--quick") == 0)
  {
    out->run_count = 1;
    ++i;
  }
  for (; i + 1 < argc && strncmp(argv[i], "--", 2) == 0; i += 2)
  {
    if (strcmp(argv[i], "--data") == 0)
    {
      out->folder = argv[i + 1];
    }
    else if (strcmp(argv[i], "--write") == 0)
    {
      out->file = argv[i + 1];
    }
    else if (strcmp(argv[i], "--runs") == 0)
    {
      out->run_count = atoi(argv[i + 1]);
    }
    else if (strcmp(argv[i], "--threads") == 0)
    {
      out->thread_count = atoi(argv[i + 1]);
    }
    else
    {
      return 1;
    }
  }
  out->names = argv + i;
  out->name_count = argc - i;
  out->folder = out->folder != NULL && out->folder[0] == '\0' ? NULL : out->folder;
  return out->run_count < 1 || out->run_count > MAX_RUNS || out->thread_count < 0 ||
         out->thread_count > MAX_THREADS || (i < argc && strncmp(argv[i], "--", 2) == 0);
}

static int is_wanted(const bench_case* one, const arguments* given)
{
  if (one->scene == NULL && given->folder == NULL)
  {
    return 0;
  }
  int is_named = given->name_count == 0;
  for (int i = 0; i < given->name_count; ++i)
  {
    is_named |= strcmp(given->names[i], one->name) == 0;
  }
  return is_named;
}

/* Not 0: a name is no case's. */
static int check_names(const arguments* given, const bench_case* cases, size_t count)
{
  for (int i = 0; i < given->name_count; ++i)
  {
    size_t c = 0;
    while (c < count && strcmp(given->names[i], cases[c].name) != 0)
    {
      ++c;
    }
    if (c == count)
    {
      fprintf(stderr, "There is no case %s.\n", given->names[i]);
      return 1;
    }
  }
  return 0;
}

/* Round by round, so that a slow moment of the machine does not hit all runs of one case. */
static int measure_all(const arguments* given, bench_result* results, size_t count)
{
  int has_failed = 0;
  for (int round = 0; round < given->run_count; ++round)
  {
    for (size_t r = 0; r < count; ++r)
    {
      if (is_wanted(results[r].one, given) && !results[r].best.has_failed)
      {
        bench_figures figures;
        const bench_demand demand = { .one = results[r].one,
          .facet_size = results[r].one->facet_size,
          .thread_count = given->thread_count };
        bench_measure(&demand, given->folder, &figures);
        bench_result_add(&results[r], &figures);
        fprintf(stderr, "run %d of %d: %s, %zu vertices, %.2f s%s%s\n", round + 1, given->run_count,
          results[r].one->name, figures.vertex_count, figures.total_wall,
          figures.message[0] == '\0' ? "" : ": ", figures.message);
        has_failed |= figures.has_failed;
      }
    }
  }
  return has_failed;
}

/* The command without the paths, which are those of one machine. */
static void describe(const arguments* given, char* out, size_t size)
{
  int length = snprintf(out, size, "bench%s --runs %d",
    given->folder == NULL ? "" : " --data $MLIM_DATA", given->run_count);
  if (given->thread_count > 0 && length >= 0 && (size_t)length < size)
  {
    length += snprintf(out + length, size - (size_t)length, " --threads %d", given->thread_count);
  }
  for (int i = 0; i < given->name_count && length >= 0 && (size_t)length < size; ++i)
  {
    length += snprintf(out + length, size - (size_t)length, " %s", given->names[i]);
  }
}

static int publish(const arguments* given, const bench_result* results, size_t count)
{
  char command[1024];
  char* text = NULL;
  size_t size = 0;
  FILE* memory = open_memstream(&text, &size);
  if (memory == NULL)
  {
    fputs("There is not enough memory for the tables.\n", stderr);
    return 1;
  }
  describe(given, command, sizeof command);
  bench_record_write(results, count, command, given->thread_count, memory);
  fclose(memory);
  fputs(text, stdout);
  const int has_failed = given->file != NULL && bench_report_replace(given->file, "figures", text);
  free(text);
  return has_failed;
}

int main(int argc, char** argv)
{
  arguments given;
  if (parse(argc, argv, &given))
  {
    fprintf(stderr,
      "usage: %s [--quick] [--data FOLDER] [--runs N] [--threads N] [--write FILE] [NAME ...]\n",
      argv[0]);
    return 2;
  }
  size_t count;
  const bench_case* cases = bench_cases(&count);
  if (check_names(&given, cases, count))
  {
    return 2;
  }
  if (given.folder == NULL)
  {
    fputs("Without --data or MLIM_DATA real images are left out.\n", stderr);
  }
  bench_result* results = calloc(count, sizeof *results);
  if (results == NULL)
  {
    return 1;
  }
  for (size_t r = 0; r < count; ++r)
  {
    results[r].one = &cases[r];
  }
  const int has_failed = measure_all(&given, results, count);
  const int is_lost = publish(&given, results, count);
  free(results);
  return has_failed || is_lost;
}
