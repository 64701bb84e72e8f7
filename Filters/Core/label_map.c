/* Reads a label map: finds the ids that occur, and replaces them by their indices. */
#include "memory.h"
#include "scalars.h"
#include "status.h"

#include <math.h>
#include <string.h>

enum
{
  MAX_LABELS = 32000,
  CHUNK = 256
};

/* What one slice of the image holds. */
typedef struct slice_ids
{
  int32_t* ids; /* ascending */
  size_t count, capacity;
  size_t bad_count; /* values that are not whole numbers of 32 bits */
  size_t first_bad;
  double bad_value;
  int has_failed;
} slice_ids;

typedef struct read_job
{
  const mlim_array* values;
  size_t slice; /* points */
  slice_ids* slices;
  const mlim_label_map* map;
} read_job;

/* Where the id is, or belongs. */
static size_t find_id(const int32_t* ids, size_t count, int32_t id)
{
  size_t low = 0;
  size_t high = count;
  while (low < high)
  {
    const size_t middle = (low + high) / 2;
    if (ids[middle] < id)
    {
      low = middle + 1;
    }
    else
    {
      high = middle;
    }
  }
  return low;
}

static void add_id(slice_ids* slice, int32_t id)
{
  const size_t at = find_id(slice->ids, slice->count, id);
  if (slice->count > MAX_LABELS || (at < slice->count && slice->ids[at] == id))
  {
    return;
  }
  if (mlim_reserve(&slice->ids, &slice->capacity, slice->count + 1, sizeof *slice->ids))
  {
    slice->has_failed = 1;
    return;
  }
  memmove(slice->ids + at + 1, slice->ids + at, (slice->count - at) * sizeof *slice->ids);
  slice->ids[at] = id;
  ++slice->count;
}

static int is_id(double value)
{
  return value >= INT32_MIN && value <= INT32_MAX && value == floor(value);
}

static void scan_body(void* data, size_t begin, size_t end)
{
  const read_job* job = (const read_job*)data;
  for (size_t z = begin; z < end; ++z)
  {
    slice_ids* slice = &job->slices[z];
    int32_t last = 0;
    for (size_t i = 0; i < job->slice; i += CHUNK)
    {
      double value[CHUNK];
      const size_t n = job->slice - i < CHUNK ? job->slice - i : CHUNK;
      mlim_scalars_read(job->values, z * job->slice + i, n, value);
      for (size_t k = 0; k < n; ++k)
      {
        if (!is_id(value[k]))
        {
          slice->first_bad = slice->bad_count == 0 ? i + k : slice->first_bad;
          slice->bad_value = slice->bad_count == 0 ? value[k] : slice->bad_value;
          ++slice->bad_count;
        }
        else if (slice->count == 0 || (int32_t)value[k] != last)
        {
          last = (int32_t)value[k];
          add_id(slice, last);
        }
      }
    }
  }
}

static void index_body(void* data, size_t begin, size_t end)
{
  const read_job* job = (const read_job*)data;
  const mlim_label_map* map = job->map;
  for (size_t z = begin; z < end; ++z)
  {
    size_t last = 0;
    for (size_t i = 0; i < job->slice; i += CHUNK)
    {
      double value[CHUNK];
      const size_t n = job->slice - i < CHUNK ? job->slice - i : CHUNK;
      mlim_scalars_read(job->values, z * job->slice + i, n, value);
      for (size_t k = 0; k < n; ++k)
      {
        if ((double)map->ids[last] != value[k])
        {
          last = find_id(map->ids, (size_t)map->label_count, (int32_t)value[k]);
        }
        map->labels[z * job->slice + i + k] = (uint16_t)last;
      }
    }
  }
}

static mlim_status refuse_bad(
  const mlim_label_map* map, const slice_ids* slices, const char* name, mlim_context* context)
{
  size_t count = 0;
  size_t first = (size_t)map->dims[2];
  for (size_t z = (size_t)map->dims[2]; z-- > 0;)
  {
    count += slices[z].bad_count;
    first = slices[z].bad_count > 0 ? z : first;
  }
  if (count == 0)
  {
    return MLIM_OK;
  }
  const size_t at = slices[first].first_bad;
  return mlim_fail(context, MLIM_INVALID_ARGUMENT,
    "The label map \"%s\" has %zu values that are not whole numbers from %ld to %ld, the first, "
    "%.17g, at point (%zu, %zu, %zu).",
    name, count, (long)INT32_MIN, (long)INT32_MAX, slices[first].bad_value,
    at % (size_t)map->dims[0], at / (size_t)map->dims[0], first);
}

static mlim_status collect_ids(
  mlim_label_map* map, const slice_ids* slices, const char* name, mlim_context* context)
{
  slice_ids all = { 0 };
  for (int32_t z = 0; z < map->dims[2]; ++z)
  {
    for (size_t k = 0; k < slices[z].count; ++k)
    {
      add_id(&all, slices[z].ids[k]);
    }
    all.has_failed |= slices[z].has_failed;
  }
  map->ids = all.ids;
  map->label_count = (int32_t)all.count;
  if (all.has_failed)
  {
    return mlim_fail_memory(context, "the ids of the label map");
  }
  if (all.count > MAX_LABELS)
  {
    return mlim_fail(context, MLIM_INVALID_ARGUMENT,
      "The label map \"%s\" has more than %d different values; at most as many labels can be "
      "meshed.",
      name, (int)MAX_LABELS);
  }
  return MLIM_OK;
}

static mlim_status check_shape(
  const int32_t dims[3], const double spacing[3], const mlim_array* values, mlim_context* context)
{
  for (int k = 0; k < 3; ++k)
  {
    if (dims[k] < 2)
    {
      return mlim_fail(context, MLIM_INVALID_ARGUMENT,
        "The label map has %d points along axis %d; at least 2 are needed.", (int)dims[k], k);
    }
    if (!(spacing[k] > 0) || !isfinite(spacing[k]))
    {
      return mlim_fail(context, MLIM_INVALID_ARGUMENT,
        "The spacing along axis %d is %g; it has to be finite and above 0.", k, spacing[k]);
    }
  }
  if (values == NULL || values->values == NULL || values->type >= MLIM_SCALAR_END ||
      values->stride == 0)
  {
    return mlim_fail(context, MLIM_INVALID_ARGUMENT,
      "The label map has no values, an unknown scalar type or a stride of 0.");
  }
  return MLIM_OK;
}

mlim_status mlim_label_map_read(const int32_t dims[3], const double spacing[3],
  const mlim_array* values, mlim_context* context, mlim_label_map* out)
{
  *out = (mlim_label_map){ 0 };
  mlim_status status = check_shape(dims, spacing, values, context);
  if (status != MLIM_OK)
  {
    return status;
  }
  memcpy(out->dims, dims, sizeof out->dims);
  memcpy(out->spacing, spacing, sizeof out->spacing);
  const char* name = values->name != NULL ? values->name : "labels";
  read_job job = { .values = values, .slice = (size_t)dims[0] * (size_t)dims[1], .map = out };
  mlim_stage_work work = { .count = (size_t)dims[2],
    .body = scan_body,
    .job = &job,
    .stage = MLIM_STAGE_INDICATORS,
    .from = 0,
    .to = 0.02 };
  job.slices = mlim_allocate_zeroed(work.count, sizeof *job.slices);
  out->labels = mlim_allocate(work.count * job.slice, sizeof *out->labels);
  status = job.slices != NULL && out->labels != NULL ? mlim_parallel_stage(context, &work)
                                                     : mlim_fail_memory(context, "the label map");
  status = status == MLIM_OK ? refuse_bad(out, job.slices, name, context) : status;
  status = status == MLIM_OK ? collect_ids(out, job.slices, name, context) : status;
  if (status == MLIM_OK)
  {
    work.body = index_body;
    work.from = work.to;
    work.to = 0.04;
    status = mlim_parallel_stage(context, &work);
  }
  for (size_t z = 0; job.slices != NULL && z < work.count; ++z)
  {
    mlim_release(job.slices[z].ids);
  }
  mlim_release(job.slices);
  if (status != MLIM_OK)
  {
    mlim_label_map_free(out);
  }
  return status;
}

mlim_status mlim_label_map_select(
  mlim_label_map* map, const int32_t* ids, size_t count, int32_t other, mlim_context* context)
{
  const size_t before = (size_t)map->label_count;
  int32_t* kept = mlim_allocate(before + 1, sizeof *kept);
  uint16_t* index = mlim_allocate(before, sizeof *index);
  mlim_status status = MLIM_OK;
  if (kept == NULL || index == NULL)
  {
    status = mlim_fail_memory(context, "the ids of the label map");
    goto done;
  }
  slice_ids list = { .ids = kept, .capacity = before + 1 };
  for (size_t l = 0; l < before; ++l)
  {
    const size_t at = find_id(ids, count, map->ids[l]);
    add_id(&list, at < count && ids[at] == map->ids[l] ? map->ids[l] : other);
  }
  for (size_t l = 0; l < before; ++l)
  {
    const size_t at = find_id(ids, count, map->ids[l]);
    const int is_kept = at < count && ids[at] == map->ids[l];
    index[l] = (uint16_t)find_id(kept, list.count, is_kept ? map->ids[l] : other);
  }
  const size_t points = (size_t)map->dims[0] * (size_t)map->dims[1] * (size_t)map->dims[2];
  for (size_t p = 0; p < points; ++p)
  {
    map->labels[p] = index[map->labels[p]];
  }
  memcpy(map->ids, kept, list.count * sizeof *kept);
  map->label_count = (int32_t)list.count;
done:
  mlim_release(kept);
  mlim_release(index);
  return status;
}

void mlim_label_map_free(mlim_label_map* map)
{
  mlim_release(map->ids);
  mlim_release(map->labels);
  *map = (mlim_label_map){ 0 };
}
