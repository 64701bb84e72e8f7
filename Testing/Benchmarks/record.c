#include "record.h"

#include "bulk.h"
#include "table.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const char BEGIN_MARK[] = "<!-- figures: begin -->\n";
static const char END_MARK[] = "<!-- figures: end -->\n";

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

/* ---- the machine ---- */

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

static void write_machine(const char* command, FILE* out)
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
  fprintf(
    out, "- Machine: %s, %ld cores; one thread in use\n", processor, sysconf(_SC_NPROCESSORS_ONLN));
  fprintf(out, "- Compiler: %s; CGAL %s; VTK %s\n", BENCH_COMPILER, bench_bulk_version(),
    bench_image_version());
  fprintf(out, "- Command: `%s`\n\n", command);
}

/* ---- the tables ---- */

static void start_table(bench_table* table, const char* const* headings)
{
  size_t column = 0;
  table->row_count = 0;
  table->column_count = 0;
  bench_table_row(table);
  for (; *headings != NULL; ++headings)
  {
    bench_table_cell(table, &column, "%s", *headings);
  }
}

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
  start_table(table, headings);
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

void bench_record_write(const bench_result* results, size_t count, const char* command, FILE* out)
{
  static const char* const stages[] = { "case", "facet size", "vertices", "triangles", "field",
    "curves", "balls", "refinement", "mesh, certificate", "total", "wall clock", NULL };
  static const char* const refinement[] = { "case", "facet size", "vertices", "balls", "insertions",
    "µs a vertex", "bulk s", "ratio to bulk", "image MB", "peak MB", "KB a vertex", NULL };
  write_machine(command, out);
  write_table("Seconds of each stage:", stages, add_stage_row, results, count, out);
  write_table("Refinement against bulk insertion, and memory:", refinement, add_refinement_row,
    results, count, out);
  write_remarks(results, count, out);
}

/* ---- the file ---- */

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

int bench_record_replace(const char* path, const char* text)
{
  int result = 1;
  FILE* file = NULL;
  char* old = read_text(path);
  char* begin = old == NULL ? NULL : strstr(old, BEGIN_MARK);
  char* end = begin == NULL ? NULL : strstr(begin, END_MARK);
  if (end == NULL)
  {
    fprintf(stderr, "%s cannot be read, or lacks the lines %sand %s", path, BEGIN_MARK, END_MARK);
    goto done;
  }
  file = fopen(path, "wb");
  if (file == NULL)
  {
    fprintf(stderr, "%s cannot be written.\n", path);
    goto done;
  }
  *begin = '\0';
  fprintf(file, "%s%s\n%s%s", old, BEGIN_MARK, text, end);
  result = fclose(file) != 0;
done:
  free(old);
  return result;
}
