#include "record.h"

#include "report.h"
#include "table.h"

#include <stdlib.h>

static const double MEGABYTE = 1024.0 * 1024.0;
static const double KILOBYTE = 1024.0;

/* ---- the best of several runs ---- */

static void take_less(double* best, double value)
{
  *best = value < *best ? value : *best;
}

static void take_more(size_t* most, size_t value)
{
  *most = value > *most ? value : *most;
}

void bench_result_add(bench_result* result, const bench_figures* figures)
{
  bench_figures* best = &result->best;
  ++result->run_count;
  if (result->run_count == 1 || figures->has_failed)
  {
    *best = *figures;
    return;
  }
  if (best->has_failed)
  {
    return;
  }
  result->has_varied |= best->vertex_count != figures->vertex_count ||
                        best->triangle_count != figures->triangle_count ||
                        best->insertion_count != figures->insertion_count;
  for (int s = 0; s < MLIM_STAGE_END; ++s)
  {
    take_less(&best->user[s], figures->user[s]);
  }
  take_less(&best->total_user, figures->total_user);
  take_less(&best->total_wall, figures->total_wall);
  take_less(&best->bulk, figures->bulk);
  take_more(&best->input_memory, figures->input_memory);
  take_more(&best->peak_memory, figures->peak_memory);
  take_more(&best->refinement_memory, figures->refinement_memory);
}

/* ---- the tables ---- */

static size_t start_row(bench_table* table, const bench_result* result)
{
  size_t column = 0;
  bench_table_row(table);
  bench_table_cell(table, &column, "%s", result->one->name);
  bench_table_cell(table, &column, "%.2f", result->best.facet_size);
  bench_table_cell(table, &column, "%zu", result->best.vertex_count);
  return column;
}

static void add_stage_row(bench_table* table, const bench_result* result)
{
  const bench_figures* f = &result->best;
  size_t column = start_row(table, result);
  bench_table_cell(table, &column, "%zu", f->triangle_count);
  /* No case is a label map, so nothing makes indicators; none is filled. */
  for (int s = MLIM_STAGE_FIELD; s <= MLIM_STAGE_CERTIFICATE; ++s)
  {
    bench_table_cell(table, &column, "%.3f", f->user[s]);
  }
  bench_table_cell(table, &column, "%.3f", f->total_user);
  bench_table_cell(table, &column, "%.3f", f->total_wall);
}

static void add_refinement_row(bench_table* table, const bench_result* result)
{
  const bench_figures* f = &result->best;
  const double refinement = f->user[MLIM_STAGE_SURFACE];
  const double vertices = f->vertex_count > 0 ? (double)f->vertex_count : 1;
  size_t column = start_row(table, result);
  bench_table_cell(table, &column, "%zu", f->ball_count);
  bench_table_cell(table, &column, "%zu", f->insertion_count);
  bench_table_cell(table, &column, "%.1f", 1e6 * refinement / vertices);
  if (f->bulk > 0)
  {
    bench_table_cell(table, &column, "%.3f", f->bulk);
    bench_table_cell(table, &column, "%.1f", refinement / f->bulk);
  }
  else
  {
    bench_table_cell(table, &column, "–");
    bench_table_cell(table, &column, "–");
  }
  bench_table_cell(table, &column, "%.0f", (double)f->input_memory / MEGABYTE);
  bench_table_cell(table, &column, "%.0f", (double)f->peak_memory / MEGABYTE);
  bench_table_cell(table, &column, "%.2f", (double)f->refinement_memory / KILOBYTE / vertices);
}

typedef void (*row_function)(bench_table* table, const bench_result* result);

static void write_table(const char* title, const char* const* headings, row_function add_row,
  const bench_result* results, size_t count, FILE* out)
{
  bench_table* table = calloc(1, sizeof *table);
  if (table == NULL)
  {
    return;
  }
  bench_table_start(table, headings);
  for (size_t r = 0; r < count; ++r)
  {
    if (results[r].run_count > 0 && !results[r].best.has_failed)
    {
      add_row(table, &results[r]);
    }
  }
  fprintf(out, "%s\n\n", title);
  bench_table_write(table, out);
  fputc('\n', out);
  free(table);
}

static void write_remark(const bench_result* result, const char* text, FILE* out)
{
  fprintf(out, "- %s, facet size %.2f: %s\n", result->one->name, result->best.facet_size, text);
}

static void write_remarks(const bench_result* results, size_t count, FILE* out)
{
  for (size_t r = 0; r < count; ++r)
  {
    const bench_figures* f = &results[r].best;
    char text[BENCH_MESSAGE_SIZE + 32];
    if (results[r].run_count > 0 && f->message[0] != '\0')
    {
      snprintf(text, sizeof text, "%s%s", f->has_failed ? "FAILED: " : "", f->message);
      write_remark(&results[r], text, out);
    }
    if (results[r].has_varied)
    {
      write_remark(&results[r], "the runs did NOT give the same counts.", out);
    }
    if (f->unweighted_count > 0)
    {
      snprintf(text, sizeof text,
        "%zu vertices on curves are contacts or balls beside them; bulk insertion takes them "
        "without "
        "a weight.",
        f->unweighted_count);
      write_remark(&results[r], text, out);
    }
  }
}

void bench_record_write(
  const bench_result* results, size_t count, const char* command, int thread_count, FILE* out)
{
  static const char* const stages[] = { "case", "facet size", "vertices", "triangles", "field",
    "curves", "balls", "refinement", "mesh, certificate", "total", "wall clock", NULL };
  static const char* const refinement[] = { "case", "facet size", "vertices", "balls", "insertions",
    "µs a vertex", "bulk s", "ratio to bulk", "image MB", "peak MB", "KB a vertex", NULL };
  bench_report_machine(command, thread_count, out);
  write_table("Seconds of each stage:", stages, add_stage_row, results, count, out);
  write_table("Refinement against bulk insertion, and memory:", refinement, add_refinement_row,
    results, count, out);
  write_remarks(results, count, out);
}
