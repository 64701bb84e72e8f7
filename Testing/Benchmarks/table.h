/* A table of texts, written in Markdown with its columns aligned. */
#ifndef mlim_table_h
#define mlim_table_h

#include <stddef.h>
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

enum
{
  BENCH_TABLE_COLUMNS = 16,
  BENCH_TABLE_ROWS = 64,
  BENCH_TABLE_TEXT = 48
};

typedef struct bench_table
{
  size_t column_count;
  size_t row_count; /* the headings are the first row */
  char cells[BENCH_TABLE_ROWS][BENCH_TABLE_COLUMNS][BENCH_TABLE_TEXT];
} bench_table;

/* Starts the next row. */
void bench_table_row(bench_table* table);

/* Fills the row's next cell, as printf does. */
void bench_table_cell(bench_table* table, size_t* column, const char* format, ...);

/* The first column to the left, the others to the right. */
void bench_table_write(const bench_table* table, FILE* out);

/* Empties the table and gives it its first row. headings ends with NULL. */
void bench_table_start(bench_table* table, const char* const* headings);

#ifdef __cplusplus
}
#endif

#endif
