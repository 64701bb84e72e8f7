#include "table.h"

#include <assert.h>
#include <stdarg.h>
#include <string.h>

void bench_table_row(bench_table* table)
{
  assert(table->row_count < BENCH_TABLE_ROWS);
  ++table->row_count;
}

void bench_table_cell(bench_table* table, size_t* column, const char* format, ...)
{
  assert(table->row_count > 0 && *column < BENCH_TABLE_COLUMNS);
  va_list values;
  va_start(values, format);
  vsnprintf(table->cells[table->row_count - 1][*column], BENCH_TABLE_TEXT, format, values);
  va_end(values);
  ++*column;
  table->column_count = *column > table->column_count ? *column : table->column_count;
}

/* Characters of a UTF-8 text. */
static int width_of(const char* text)
{
  int width = 0;
  for (; *text != '\0'; ++text)
  {
    width += (*text & 0xC0) != 0x80;
  }
  return width;
}

static void write_repeated(FILE* out, char c, int count)
{
  for (int i = 0; i < count; ++i)
  {
    fputc(c, out);
  }
}

static void write_rule(const int* widths, size_t column_count, FILE* out)
{
  fputc('|', out);
  for (size_t c = 0; c < column_count; ++c)
  {
    write_repeated(out, '-', widths[c] + 1);
    fputs(c == 0 ? "-|" : ":|", out);
  }
  fputc('\n', out);
}

void bench_table_write(const bench_table* table, FILE* out)
{
  int widths[BENCH_TABLE_COLUMNS] = { 0 };
  for (size_t r = 0; r < table->row_count; ++r)
  {
    for (size_t c = 0; c < table->column_count; ++c)
    {
      const int width = width_of(table->cells[r][c]);
      widths[c] = width > widths[c] ? width : widths[c];
    }
  }
  for (size_t r = 0; r < table->row_count; ++r)
  {
    fputc('|', out);
    for (size_t c = 0; c < table->column_count; ++c)
    {
      const char* text = table->cells[r][c];
      const int space = widths[c] - width_of(text);
      fputc(' ', out);
      write_repeated(out, ' ', c == 0 ? 0 : space);
      fputs(text, out);
      write_repeated(out, ' ', c == 0 ? space : 0);
      fputs(" |", out);
    }
    fputc('\n', out);
    if (r == 0)
    {
      write_rule(widths, table->column_count, out);
    }
  }
}

void bench_table_start(bench_table* table, const char* const* headings)
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
