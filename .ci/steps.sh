# Steps that the scripts of this project share; sourced, not run. The caller sets `repository` and
# the shell's -e.
# shellcheck shell=bash disable=SC2034,SC2154,SC2164

# What a build and its tests need on Debian 12 and its like.
build_packages=(cmake ninja-build g++ libvtk9-dev libcgal-dev python3-numpy python3-vtk9
  libeigen3-dev python3-meshio)
# Debian's VTK draws through X: a virtual screen serves where there is no display.
screen_packages=(xvfb xauth libgl1-mesa-dri)
# The interpreter that Debian's VTK is wrapped for; another python3 may come first on the PATH.
python=/usr/bin/python3

say() {
  printf '\n== %s\n' "$*"
}

# install_packages NAME... : those that are missing, with apt-get.
install_packages() {
  local name missing=() as_root=()
  if ! command -v apt-get >/dev/null; then
    echo "No apt-get here. Needed, under their Debian names: $*" >&2
    return 0
  fi
  for name in "$@"; do
    if [[ "$(dpkg-query -W -f '${db:Status-Status}' "$name" 2>/dev/null)" != installed ]]; then
      missing+=("$name")
    fi
  done
  if [[ ${#missing[@]} -eq 0 ]]; then
    return 0
  fi
  say "Installing ${missing[*]}"
  if [[ $EUID -ne 0 ]]; then
    as_root=(sudo)
  fi
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update -qq
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get install -y -qq --no-install-recommends "${missing[@]}"
}

# build_preset NAME [CMAKE_OPTION...] : configures and builds into build/NAME.
build_preset() {
  local preset=$1
  shift
  say "Building the preset $preset"
  (
    cd "$repository"
    cmake --preset "$preset" -B "build/$preset" "-DPython3_EXECUTABLE=$python" "$@"
    cmake --build "build/$preset" --parallel "${MLIM_JOBS:-2}"
  )
}

# python_path BUILD_FOLDER : the folder that holds the package mlim.
python_path() {
  local package
  package=$(find "$1" -path '*-packages/mlim/__init__.py' -print -quit)
  if [[ -z "$package" ]]; then
    echo "no package mlim in $1" >&2
    return 1
  fi
  dirname "$(dirname "$package")"
}

# on_screen COMMAND... : on the display, or on a virtual one.
on_screen() {
  if [[ -n "${DISPLAY:-}" ]]; then
    "$@"
  else
    xvfb-run -a "$@"
  fi
}
