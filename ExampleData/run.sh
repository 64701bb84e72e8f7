#!/usr/bin/env bash
# Builds the project, meshes an image, prints a report, and writes .vtp files and pictures.
#
#   bash ExampleData/run.sh [IMAGE] [OPTION ...]
#
# IMAGE   default: the eight spheres beside this script
# OPTION  of the command line (python3 -m mlim --help), as in --facet-size 1.5; and --output FOLDER
#         (default: build/example/<name of the image>)
#
# Installs with apt-get the packages that are missing.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
repository=$(dirname "$here")
# shellcheck source-path=SCRIPTDIR source=../.ci/steps.sh
source "$repository/.ci/steps.sh"

image=$here/spheres.vti
if [[ $# -gt 0 && "$1" != --* ]]; then
  image=$(realpath "$1")
  shift
fi
name=$(basename "$image")
name=${name%%.*}
output=$repository/build/example/$name
options=()
while [[ $# -gt 0 ]]; do
  if [[ "$1" == --output && $# -gt 1 ]]; then
    output=$2
    shift
  else
    options+=("$1")
  fi
  shift
done

packages=("${build_packages[@]}")
if [[ -z "${DISPLAY:-}" ]]; then
  packages+=("${screen_packages[@]}")
fi
install_packages "${packages[@]}"
build_preset release

mkdir -p "$output"
output=$(realpath "$output")
say "Meshing $name"
PYTHONPATH=$(python_path "$repository/build/release") \
  "$python" -m mlim "$image" -o "$output/surface.vtp" --curves "$output/curves.vtp" \
  --balls "$output/balls.vtp" "${options[@]}"
say "Rendering $name"
on_screen "$python" "$here/render.py" "$output/surface.vtp" "$output/$name.png"
on_screen "$python" "$here/network.py" "$output/curves.vtp" "$output/balls.vtp" \
  "$output/${name}_curves.png"
ls -l "$output"
