#!/usr/bin/env bash
# Builds the project, fills the regions of the spheres and of an atlas with tetrahedra, and draws both
# cut open, as in figure 8 of the paper.
#
#   bash ExampleData/volume.sh [PICTURE.png]
#
# PICTURE    default: build/example/volume.png
# MLIM_DATA  environment: folder of the real images, for brain_atlas_mni_prob.vti; without it the
#            tissue of this folder stands in for the atlas
#
# Installs with apt-get the packages that are missing.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
repository=$(dirname "$here")
# shellcheck source-path=SCRIPTDIR source=../.ci/steps.sh
source "$repository/.ci/steps.sh"

work=$repository/build/example
picture=${1:-$work/volume.png}

packages=("${build_packages[@]}")
if [[ -z "${DISPLAY:-}" ]]; then
  packages+=("${screen_packages[@]}")
fi
install_packages "${packages[@]}"
build_preset release

# mesh IMAGE FOLDER [OPTION VALUE ...]
mesh() {
  mkdir -p "$2"
  say "Meshing $1"
  PYTHONPATH=$(python_path "$repository/build/release") \
    "$python" "$here/mesh.py" "$@" --volume True
}

mesh "$here/spheres.vti" "$work/spheres"
atlas=${MLIM_DATA:-}/brain_atlas_mni_prob.vti
if [[ -f "$atlas" ]]; then
  mesh "$atlas" "$work/atlas" --facet-size 10 --facet-distance 2 --cell-size 10 --volume-tolerance 0
else
  mesh "$here/tissue.vti" "$work/atlas"
fi
say "Drawing"
on_screen "$python" "$here/render_volume.py" "$picture" \
  "$work/spheres/volume.vtu" "$work/atlas/volume.vtu"
ls -l "$picture"
