#!/usr/bin/env bash
# The seams between the parts: who may include whom, and which calls stay in which file.
#
#   bash Testing/seams.sh
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
core=Filters/Core
failures=0

fail() {
  echo "seams: $*"
  failures=$((failures + 1))
}

# Place, part, files. A file includes files of earlier places, and of its own part those to its left;
# two parts of one place do not see each other. A file of two words that is not named belongs to its
# first one: field_build to field.
order='
0 base          mlim vector faces triangle cubic tie
1 services      memory status team
2 pieces        scalars label_map distance kernel morphology diffusion indicators samples peaks
2 pieces        label_sets point_grid
2 solid         shape solid climb exchange slivers
3 field         plateau winners field clearance field_build options components
4 oracle        oracle crossings
4 curves        network grow curve_face curve_cell crease clean corner curves
5 balls         pieces radius_map span balls
5 triangulation power_sphere predicates delaunay
6 criteria      complex dual clear ahead boundary records sides wedge criteria disk
7 refinement    queue nearby seeds bends partner refine tidy pinch spots zone box cells
8 products      volumes edges skin nearest mesh quality unresolved certificate
9 whole         verify volume build
'

# place_of FILE : "place part column", or nothing.
place_of() {
  local name=${1##*/} try
  name=${name%.*}
  for try in "$name" "${name%%_*}" "${name%%_*}s"; do
    awk -v try="$try" '{ for (i = 3; i <= NF; ++i) if ($i == try) print $1, $2, i }' <<<"$order"
  done | head -n 1
}

includes() {
  sed -n 's/^[[:space:]]*#[[:space:]]*include[[:space:]]*"\([^"]*\)".*/\1/p' "$1"
}

check_order() {
  local file other own_place own_part own_column place part column name
  for file in "$core"/*.c "$core"/*.h; do
    read -r own_place own_part own_column <<<"$(place_of "$file")"
    if [[ -z "$own_place" ]]; then
      fail "$file has no place in the order of Testing/seams.sh"
      continue
    fi
    while IFS= read -r other; do
      read -r place part column <<<"$(place_of "$other")"
      if [[ -z "$place" || ! -f "$core/$other" ]]; then
        fail "$file includes $other, which is not of the core"
      elif [[ "$part" != "$own_part" ]] && ((place >= own_place)); then
        fail "$file ($own_part) includes $other ($part)"
      elif [[ "$part" == "$own_part" ]] && ((column > own_column)); then
        fail "$file includes $other, which stands to its right in $part"
      fi
    done < <(includes "$file")
  done
  while IFS= read -r name; do
    if [[ ! -f "$core/$name.h" && ! -f "$core/$name.c" ]]; then
      fail "the order of Testing/seams.sh names $name, which is not there"
    fi
  done < <(awk '{ for (i = 3; i <= NF; ++i) print $i }' <<<"$order")
}

# forbid TEXT PATTERN FILE... : no line of code of the files matches; comments do not count.
forbid() {
  local text=$1 pattern=$2 file found
  shift 2
  for file in "$@"; do
    [[ -f "$file" ]] || continue
    found=$(strip_comments "$file" | grep -nE "$pattern" || true)
    if [[ -n "$found" ]]; then
      fail "$text in $file: $(head -n 1 <<<"$found")"
    fi
  done
}

# The file with the same lines, its comments and texts emptied.
strip_comments() {
  perl -0777 -pe \
    's{(/\*.*?\*/)|(//[^\n]*)|("(?:\\.|[^"\\\n])*")}{ my $t = $&; $t =~ /^"/ ? $t =~ /\.h"/ ? $t : "\"\"" : $t =~ s/[^\n]//gr }gse' \
    "$1"
}

except() {
  local name=$1 file
  shift
  for file in "$@"; do
    [[ "${file##*/}" == "$name" ]] || echo "$file"
  done
}

check_calls() {
  local sources=("$core"/*.c "$core"/*.h) most
  mapfile -t most < <(except memory.c "${sources[@]}")
  forbid "allocation" '\b(malloc|calloc|realloc|aligned_alloc|strdup|alloca|free)[[:space:]]*\(' "${most[@]}"
  mapfile -t most < <(except status.c "${sources[@]}")
  forbid "formatting" '\bv?sn?printf[[:space:]]*\(' "${most[@]}"
  forbid "printing" '\b(stdout|stderr)\b|\b(v?f?printf|puts|fputs|putchar|perror|fwrite)[[:space:]]*\(' "${sources[@]}"
  forbid "leaving" '\b(exit|_Exit|abort|quick_exit|setjmp|longjmp|getenv|signal)[[:space:]]*\(' \
    "${sources[@]}"
  forbid "randomness" '\b(rand|srand|random|drand48|time|clock)[[:space:]]*\(' "${sources[@]}"
  forbid "thread-local state" '\b(_Thread_local|thread_local|__thread)\b' "${sources[@]}"
}

# sees_only HEADERS FILE... : of the core, the files include these headers alone.
sees_only() {
  local allowed=$1 file other
  shift
  for file in "$@"; do
    [[ -f "$file" ]] || continue
    while IFS= read -r other; do
      if [[ -f "$core/${other##*/}" && " $allowed " != *" ${other##*/} "* ]]; then
        fail "$file includes $other of the core, where it may see $allowed only"
      fi
    done < <(includes "$file")
  done
}

check_libraries() {
  forbid "VTK" '#[[:space:]]*include[[:space:]]*[<"]vtk|\bvtk[A-Z]' \
    "$core"/*.c "$core"/*.h Filters/Delaunay/*
  forbid "CGAL" 'CGAL' "$core"/*.c "$core"/*.h Filters/vtk*.h Filters/vtk*.cxx
  sees_only mlim.h Filters/vtk*.h Filters/vtk*.cxx
  sees_only "predicates.h status.h" Filters/Delaunay/*
  if compgen -G "$core/*.cxx" >/dev/null || compgen -G "$core/*.cpp" >/dev/null; then
    fail "C++ in $core"
  fi
}

# Paths and words that belong to one developer's machine, and notes of unfinished work.
check_words() {
  local found
  found=$(git grep -nIE '/(home|root|work|tmp)/' -- . ':!*/seams.sh' ':!*.md5' || true)
  if [[ -n "$found" ]]; then
    fail "a path of one machine: $(head -n 3 <<<"$found")"
  fi
  found=$(git grep -nIwE 'TODO|FIXME|XXX|HACK|aspect ratio' -- '*.c' '*.h' '*.cxx' '*.py' '*.sh' \
    '*.cmake' '*CMakeLists.txt' ':!*/seams.sh' || true)
  if [[ -n "$found" ]]; then
    fail "an unfinished or forbidden word: $(head -n 3 <<<"$found")"
  fi
}

check_order
check_calls
check_libraries
check_words
if ((failures > 0)); then
  echo "seams: $failures failures"
  exit 1
fi
echo "seams: the parts keep to their places"
