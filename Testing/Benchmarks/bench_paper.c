/* Table 2 of Dey, Janoos and Levine beside ours: the same kinds of data, the same numbers of vertices.

     bench_paper [--data FOLDER] [--write FILE] [--quick] */
#include "measure.h"
#include "report.h"
#include "table.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct row
{
  const char* name; /* in the paper */
  int curve_count;
  int vertex_count;
  int protection; /* seconds */
  int meshing;
  const char* image; /* ours of the same kind; NULL: none */
  double facet_size; /* in the smallest spacing: where the search for the number begins;
                        0: the default alone, since no size gives so few vertices */
} row;

static const row rows[] = {
  { "Spheres", 36, 4492, 16, 50, "spheres8_indicators", 1.65 },
  { "Orange", 24, 24543, 14, 8 * 60 + 46, "fruit_orange_synthetic_labels", 3.5 },
  { "Temporal Bone", 16, 24898, 11, 8 * 60 + 32, NULL, 0 },
  { "Tomato", 35, 25701, 61, 9 * 60 + 7, NULL, 0 },
  { "Brain Atlas", 64, 35890, 64, 17 * 60 + 50, "brain_atlas_mni_prob", 6.2 },
  { "Torso", 57, 39826, 97, 19 * 60 + 27, "torso_ct_indicators", 2.5 },
  { "Bulldog Skull", 17, 51474, 10, 32 * 60 + 48, "skull_iguana_ct_labels", 0 },
  { "Soft Brain", 100, 211664, 117, 244 * 60 + 1, "soft_brain_ants19_prob", 2.15 },
};

enum
{
  ROW_COUNT = sizeof rows / sizeof rows[0],
  TRIES = 5,
  QUICK_VERTICES = 100000 /* --quick leaves out larger ones */
};

static const double SAME_PART = 0.02; /* numbers that differ by less are the same */

typedef struct arguments
{
  const char* folder;
  const char* file; /* NULL: nothing to write */
  int is_quick;
} arguments;

/* Not 0: not understood. */
static int parse(int argc, char** argv, arguments* out)
{
  *out = (arguments){ .folder = getenv("MLIM_DATA") };
  for (int i = 1; i < argc; ++i)
  {
    if (strcmp(argv[i], "--quick") == 0)
    {
      out->is_quick = 1;
    }
    else if (strcmp(argv[i], "--data") == 0 && i + 1 < argc)
    {
      out->folder = argv[++i];
    }
    else if (strcmp(argv[i], "--write") == 0 && i + 1 < argc)
    {
      out->file = argv[++i];
    }
    else
    {
      return 1;
    }
  }
  return out->folder == NULL;
}

/* The paper's bounds: no volume tolerance. The number goes with the square of the size, less where
   topology asks for vertices. The run that comes nearest counts. */
static void search(const row* one, const char* folder, bench_figures* best)
{
  const bench_case image = { .name = one->image };
  bench_demand demand = { .one = &image, .facet_size = one->facet_size, .has_bounds_only = 1 };
  double least = INFINITY;
  const int tries = one->facet_size > 0 ? TRIES : 1;
  for (int t = 0; t < tries && least > SAME_PART; ++t)
  {
    bench_figures figures;
    bench_measure(&demand, folder, &figures);
    fprintf(stderr, "%s, facet size %.3f: %zu vertices, %.2f s %s\n", one->image, demand.facet_size,
      figures.vertex_count, figures.total_user, figures.message);
    if (figures.has_failed || figures.vertex_count == 0)
    {
      *best = t == 0 ? figures : *best;
      return;
    }
    const double part = (double)figures.vertex_count / one->vertex_count;
    if (fabs(part - 1) < least)
    {
      least = fabs(part - 1);
      *best = figures;
    }
    demand.facet_size *= pow(part, 0.7);
  }
}

static void add_clock(bench_table* table, size_t* column, int seconds)
{
  bench_table_cell(table, column, "%d:%02d", seconds / 60, seconds % 60);
}

static void add_row(const row* one, const bench_figures* f, bench_table* table)
{
  size_t column = 0;
  bench_table_row(table);
  bench_table_cell(table, &column, "%s", one->name);
  bench_table_cell(table, &column, "%d", one->curve_count);
  bench_table_cell(table, &column, "%d", one->vertex_count);
  add_clock(table, &column, one->protection);
  add_clock(table, &column, one->meshing);
  if (one->image == NULL || f->vertex_count == 0)
  {
    bench_table_cell(table, &column, "%s", one->image == NULL ? "none" : "not run");
    return;
  }
  const double protection = f->user[MLIM_STAGE_CURVES] + f->user[MLIM_STAGE_BALLS];
  const double meshing = f->user[MLIM_STAGE_SURFACE] + f->user[MLIM_STAGE_CERTIFICATE];
  bench_table_cell(table, &column, "%s", one->image);
  bench_table_cell(table, &column, "%.2f", f->facet_size);
  bench_table_cell(table, &column, "%zu", f->curve_count);
  bench_table_cell(table, &column, "%zu", f->vertex_count);
  bench_table_cell(table, &column, "%.2f", f->user[MLIM_STAGE_FIELD]);
  bench_table_cell(table, &column, "%.2f", protection);
  bench_table_cell(table, &column, "%.2f", meshing);
  const double theirs = (double)one->vertex_count / (one->protection + one->meshing);
  const double ours = (double)f->vertex_count / (protection + meshing);
  bench_table_cell(table, &column, "%.0f", theirs);
  bench_table_cell(table, &column, "%.0f", ours);
  bench_table_cell(table, &column, "%.0f", ours / theirs);
}

static int publish(const arguments* given, const bench_table* table)
{
  char* text = NULL;
  size_t size = 0;
  FILE* memory = open_memstream(&text, &size);
  if (memory == NULL)
  {
    fputs("There is not enough memory for the table.\n", stderr);
    return 1;
  }
  bench_report_machine(
    given->is_quick ? "bench_paper --data $MLIM_DATA --quick" : "bench_paper --data $MLIM_DATA", 1,
    memory);
  bench_table_write(table, memory);
  fputc('\n', memory);
  fclose(memory);
  fputs(text, stdout);
  const int has_failed = given->file != NULL && bench_report_replace(given->file, "paper", text);
  free(text);
  return has_failed;
}

int main(int argc, char** argv)
{
  static const char* const headings[] = { "data set", "curves", "vertices", "protection", "meshing",
    "ours", "facet size", "curves", "vertices", "field s", "protection s", "meshing s", "theirs/s",
    "ours/s", "times as fast", NULL };
  arguments given;
  if (parse(argc, argv, &given))
  {
    fprintf(stderr, "usage: %s --data FOLDER [--write FILE] [--quick]\n", argv[0]);
    return 2;
  }
  bench_table* table = calloc(1, sizeof *table);
  if (table == NULL)
  {
    return 1;
  }
  bench_table_start(table, headings);
  for (int r = 0; r < ROW_COUNT; ++r)
  {
    bench_figures figures = { 0 };
    if (rows[r].image != NULL && !(given.is_quick && rows[r].vertex_count > QUICK_VERTICES))
    {
      search(&rows[r], given.folder, &figures);
    }
    add_row(&rows[r], &figures, table);
  }
  const int has_failed = publish(&given, table);
  free(table);
  return has_failed;
}
