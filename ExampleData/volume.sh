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

# mesh IMAGE VOLUME.vtu [OPTION=VALUE ...]
mesh() {
  say "Meshing $1"
  mkdir -p "$(dirname "$2")"
  PYTHONPATH=$(python_path "$repository/build/release") "$python" -c '
import sys
import mlim

options = {name: float(value) for name, value in (word.split("=") for word in sys.argv[3:])}
_, volume = mlim.mesh(sys.argv[1], volume=True, **options)
print(mlim.report(volume))
mlim.write_volume(volume, sys.argv[2])
' "$@"
}

mesh "$here/spheres.vti" "$work/spheres/volume.vtu"
atlas=${MLIM_DATA:-}/brain_atlas_mni_prob.vti
if [[ -f "$atlas" ]]; then
  mesh "$atlas" "$work/atlas/volume.vtu" \
    facet_size=10 facet_distance=2 cell_size=10 volume_tolerance=0
else
  mesh "$here/tissue.vti" "$work/atlas/volume.vtu"
fi
say "Drawing"
on_screen "$python" "$here/render_volume.py" "$picture" \
  "$work/spheres/volume.vtu" "$work/atlas/volume.vtu"
ls -l "$picture"
