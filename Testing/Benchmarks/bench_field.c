/* The field of many labels: seconds and memory, with the number of voxels and of labels.

     bench_field [--write FILE] [--quick]

   --quick leaves out what needs gigabytes. */
#include "clock.h"
#include "process.h"
#include "report.h"
#include "table.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct row
{
  int point_count; /* along each axis */
  int label_count;
  int is_map; /* not 0: also from the label map, by way of its indicators */
} row;

static const row rows[] = {
  { 64, 50, 0 },
  { 128, 50, 0 },
  { 192, 50, 0 },
  { 256, 50, 0 },
  { 128, 10, 0 },
  { 128, 200, 1 },
  { 256, 10, 0 },
  { 256, 200, 1 },
};

enum
{
  ROW_COUNT = sizeof rows / sizeof rows[0],
  RUNS = 2
};

static const double LARGE_BYTES = 1e9; /* measured once, and not at all by --quick */
static const double MEGABYTE = 1024.0 * 1024.0;

typedef struct figures
{
  int has_failed;
  char message[BENCH_MESSAGE_SIZE];
  double reading; /* seconds of user time: all values once */
  double building;
  size_t memory; /* bytes, at most, beside the arrays */
  double indicators;
  double map_building;
  size_t map_memory; /* of the indicators and the field, at most, beside the label map */
} figures;

typedef struct arrays
{
  size_t point_count;
  int32_t label_count;
  uint16_t* values; /* of all labels */
  uint16_t* labels; /* the best of each point */
  mlim_array* list;
} arrays;

/* ---- the arrays ---- */

static double random_number(uint64_t* state)
{
  *state = *state * 6364136223846793005u + 1442695040888963407u;
  return (double)(*state >> 11) / 9007199254740992.0;
}

/* A cone round a seed, 64 units a voxel, so that ties are rare; 0 beyond 1.5 mean distances of
   seeds. */
static void fill_label(int count, const double seed[3], double reach, uint16_t* values)
{
  const double slope = 64;
  const size_t n = (size_t)count;
  memset(values, 0, n * n * n * sizeof *values);
  for (int k = 0; k < count; ++k)
  {
    for (int j = 0; j < count; ++j)
    {
      const double off = (k - seed[2]) * (k - seed[2]) + (j - seed[1]) * (j - seed[1]);
      const double half = reach * reach > off ? sqrt(reach * reach - off) : -1;
      const int first = (int)fmax(0, ceil(seed[0] - half));
      const int last = (int)fmin(count - 1, floor(seed[0] + half));
      uint16_t* line = values + n * ((size_t)j + n * (size_t)k);
      for (int i = first; half >= 0 && i <= last; ++i)
      {
        line[i] = (uint16_t)(slope * (reach - sqrt(off + (i - seed[0]) * (i - seed[0]))));
      }
    }
  }
}

static int make_arrays(const row* one, arrays* out)
{
  const size_t n = (size_t)one->point_count;
  const size_t label_count = (size_t)one->label_count;
  *out = (arrays){ .point_count = n * n * n, .label_count = one->label_count };
  out->values = malloc(out->point_count * label_count * sizeof *out->values);
  out->labels = calloc(out->point_count, sizeof *out->labels);
  out->list = calloc(label_count, sizeof *out->list);
  if (out->values == NULL || out->labels == NULL || out->list == NULL)
  {
    return 1;
  }
  uint64_t state = 7;
  const double reach = 1.5 * one->point_count / cbrt(one->label_count);
  for (size_t l = 0; l < label_count; ++l)
  {
    uint16_t* values = out->values + l * out->point_count;
    double seed[3];
    for (int k = 0; k < 3; ++k)
    {
      seed[k] = random_number(&state) * (one->point_count - 1);
    }
    fill_label(one->point_count, seed, reach, values);
    out->list[l] =
      (mlim_array){ .values = values, .type = MLIM_UINT16, .stride = 1, .id = (int32_t)l };
  }
  return 0;
}

static void free_arrays(arrays* given)
{
  free(given->values);
  free(given->labels);
  free(given->list);
  *given = (arrays){ 0 };
}

/* The best label of each point: the least that anybody does who reads the arrays. */
static int read_once(arrays* given)
{
  uint16_t* best = calloc(given->point_count, sizeof *best);
  if (best == NULL)
  {
    return 1;
  }
  for (int32_t l = 0; l < given->label_count; ++l)
  {
    const uint16_t* values = given->list[l].values;
    for (size_t p = 0; p < given->point_count; ++p)
    {
      const int is_better = values[p] > best[p];
      best[p] = is_better ? values[p] : best[p];
      given->labels[p] = is_better ? (uint16_t)l : given->labels[p];
    }
  }
  free(best);
  return 0;
}

/* ---- a run ---- */

static mlim_status build(const mlim_grid* grid, double* seconds)
{
  mlim_context context = { 0 };
  mlim_field* field = NULL;
  const double begin = bench_clock_user();
  const mlim_status status = mlim_field_create(grid, &context, &field);
  *seconds = bench_clock_user() - begin;
  mlim_field_free(field);
  return status;
}

/* The same labels as a map. */
static mlim_status build_from_map(const mlim_grid* grid, const uint16_t* labels, figures* out)
{
  const mlim_indicator_options options = mlim_indicator_options_default();
  const mlim_array values = { .values = labels, .type = MLIM_UINT16, .stride = 1 };
  mlim_context context = { 0 };
  mlim_label_map map = { .label_count = 0 };
  mlim_indicators* indicators = NULL;
  mlim_status status = mlim_label_map_read(grid->dims, grid->spacing, &values, &context, &map);
  bench_memory_reset();
  const size_t before = bench_memory_now();
  const double begin = bench_clock_user();
  if (status == MLIM_OK)
  {
    status = mlim_indicators_create(&map, &options, &context, &indicators);
  }
  out->indicators = bench_clock_user() - begin;
  if (status == MLIM_OK)
  {
    mlim_grid from_map = *grid;
    from_map.indicators = indicators;
    from_map.array_count = (size_t)map.label_count;
    status = build(&from_map, &out->map_building);
  }
  out->map_memory = bench_memory_peak() - before;
  mlim_indicators_free(indicators);
  mlim_label_map_free(&map);
  return status;
}

static void work(const void* given, void* result)
{
  const row* one = given;
  figures* out = result;
  arrays made = { 0 };
  *out = (figures){ .has_failed = 1, .message = "There is not enough memory." };
  const double begin_making = bench_clock_user();
  if (make_arrays(one, &made))
  {
    goto done;
  }
  fprintf(stderr, "%d^3 points, %d labels: made in %.1f s\n", one->point_count, one->label_count,
    bench_clock_user() - begin_making);
  const double begin = bench_clock_user();
  if (read_once(&made))
  {
    goto done;
  }
  out->reading = bench_clock_user() - begin;
  const mlim_grid grid = { .dims = { one->point_count, one->point_count, one->point_count },
    .spacing = { 1, 1, 1 },
    .array_count = (size_t)made.label_count,
    .arrays = made.list,
    .background = MLIM_BACKGROUND_ARRAY };
  bench_memory_reset();
  const size_t before = bench_memory_now();
  mlim_status status = build(&grid, &out->building);
  out->memory = bench_memory_peak() - before;
  free(made.values);
  made.values = NULL;
  if (status == MLIM_OK && one->is_map)
  {
    status = build_from_map(&grid, made.labels, out);
  }
  out->has_failed = status != MLIM_OK;
  snprintf(out->message, sizeof out->message, "%s", mlim_status_text(status));
done:
  free_arrays(&made);
}

static double bytes_of(const row* one)
{
  return pow(one->point_count, 3) * one->label_count * sizeof(uint16_t);
}

/* The least of some runs; large ones are measured once. */
static void measure(const row* one, figures* best)
{
  const int run_count = bytes_of(one) < LARGE_BYTES ? RUNS : 1;
  for (int r = 0; r < run_count; ++r)
  {
    figures now;
    if (bench_process_run(work, one, 0, sizeof now, &now, now.message))
    {
      now.has_failed = 1;
    }
    if (r == 0 || now.has_failed)
    {
      *best = now;
    }
    if (best->has_failed)
    {
      return;
    }
    best->reading = fmin(best->reading, now.reading);
    best->building = fmin(best->building, now.building);
    best->indicators = fmin(best->indicators, now.indicators);
    best->map_building = fmin(best->map_building, now.map_building);
  }
}

/* ---- the table ---- */

static void add_row(const row* one, const figures* f, bench_table* table)
{
  const double voxels = pow(one->point_count, 3);
  size_t column = 0;
  bench_table_row(table);
  bench_table_cell(table, &column, "%d³", one->point_count);
  bench_table_cell(table, &column, "%d", one->label_count);
  if (f->has_failed)
  {
    bench_table_cell(table, &column, "%.40s", f->message);
    return;
  }
  bench_table_cell(table, &column, "%.0f", bytes_of(one) / MEGABYTE);
  bench_table_cell(table, &column, "%.2f", f->reading);
  bench_table_cell(table, &column, "%.2f", f->building);
  bench_table_cell(table, &column, "%.0f", 1e9 * f->building / voxels);
  bench_table_cell(table, &column, "%.2f", 1e9 * f->building / voxels / one->label_count);
  bench_table_cell(table, &column, "%.1f", f->building / f->reading);
  bench_table_cell(table, &column, "%.0f", (double)f->memory / MEGABYTE);
  bench_table_cell(table, &column, "%.1f", (double)f->memory / voxels);
  if (one->is_map)
  {
    bench_table_cell(table, &column, "%.2f", f->indicators);
    bench_table_cell(table, &column, "%.2f", f->map_building);
    bench_table_cell(table, &column, "%.0f", (double)f->map_memory / MEGABYTE);
  }
}

static int publish(const char* file, int is_quick, const bench_table* table)
{
  char* text = NULL;
  size_t size = 0;
  FILE* memory = open_memstream(&text, &size);
  if (memory == NULL)
  {
    fputs("There is not enough memory for the table.\n", stderr);
    return 1;
  }
  bench_report_machine(is_quick ? "bench_field --quick" : "bench_field", 1, memory);
  bench_table_write(table, memory);
  fputc('\n', memory);
  fclose(memory);
  fputs(text, stdout);
  const int has_failed = file != NULL && bench_report_replace(file, "field", text);
  free(text);
  return has_failed;
}

int main(int argc, char** argv)
{
  static const char* const headings[] = { "points", "labels", "arrays MB", "reading s", "field s",
    "ns a voxel", "and label", "field over reading", "field MB", "bytes a voxel",
    "map: indicators s", "map: field s", "map: MB", NULL };
  const char* file = NULL;
  int is_quick = 0;
  for (int i = 1; i < argc; ++i)
  {
    const int is_file = strcmp(argv[i], "--write") == 0 && i + 1 < argc;
    if (!is_file && strcmp(argv[i], "--quick") != 0)
    {
      fprintf(stderr, "usage: %s [--write FILE] [--quick]\n", argv[0]);
      return 2;
    }
    is_quick |= !is_file;
    file = is_file ? argv[++i] : file;
  }
  bench_table* table = calloc(1, sizeof *table);
  if (table == NULL)
  {
    return 1;
  }
  bench_table_start(table, headings);
  for (int r = 0; r < ROW_COUNT; ++r)
  {
    if (!is_quick || bytes_of(&rows[r]) < LARGE_BYTES)
    {
      figures best;
      measure(&rows[r], &best);
      add_row(&rows[r], &best, table);
    }
  }
  const int has_failed = publish(file, is_quick, table);
  free(table);
  return has_failed;
}
