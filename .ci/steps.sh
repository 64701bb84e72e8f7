# Steps that the scripts of this project share; sourced, not run. The caller sets `repository` and
# the shell's -e.
# shellcheck shell=bash disable=SC2034,SC2154,SC2164

# What a build needs on Debian 12 and its like: of anything, and of the module for Debian's VTK with
# its tests.
compile_packages=(cmake ninja-build g++ dpkg-dev libcgal-dev python3-numpy)
build_packages=("${compile_packages[@]}" libvtk9-dev python3-vtk9 libeigen3-dev python3-meshio)
# What the benchmarks compare with, and what draws and profiles them.
benchmark_packages=(libtbb-dev linux-perf python3-matplotlib)
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
    # Without -noreset the server starts anew when its last client leaves, and a client that comes at
    # that moment finds nobody.
    xvfb-run -a -s "-screen 0 1280x1024x24 -noreset" "$@"
  fi
}

# What a build of the plugin needs beside that, with ParaView itself unpacked beside Debian's VTK:
# python3-paraview and python3-vtk9 exclude each other as packages.
paraview_packages=(paraview libopenmpi-dev openmpi-bin libdouble-conversion-dev libqt5svg5 qtbase5-dev xdotool)
paraview_archives=(paraview paraview-dev python3-paraview)

# unpack_paraview FOLDER : ParaView with its headers and Python below FOLDER, unless it is there.
unpack_paraview() {
  local root=$1 archive part
  if [[ -e "$root/unpacked" ]]; then
    return 0
  fi
  say "Unpacking ParaView"
  part=$(mktemp -d)
  # The downloading user of apt-get may not read the caller's folder.
  chmod 755 "$part"
  (cd "$part" && apt-get download -qq "${paraview_archives[@]}")
  mkdir -p "$root"
  for archive in "$part"/*.deb; do
    dpkg -x "$archive" "$root"
  done
  rm -r "$part"
  touch "$root/unpacked"
}

# paraview_root : the folder above the usr that holds ParaView with its Python; nothing: the system.
# A machine with python3-paraview has all of it.
paraview_root() {
  if [[ "$(dpkg-query -W -f '${db:Status-Status}' python3-paraview 2>/dev/null)" != installed ]]; then
    echo "$repository/build/paraview-root"
  fi
}

# build_plugin [CMAKE_OPTION...] : installs and unpacks ParaView, and builds the preset paraview.
build_plugin() {
  local root architecture
  root=$(paraview_root)
  if [[ -n "$root" ]]; then
    install_packages "${paraview_packages[@]}"
    unpack_paraview "$root"
  else
    install_packages paraview-dev "${paraview_packages[@]}"
  fi
  architecture=$(dpkg-architecture -q DEB_HOST_MULTIARCH)
  build_preset paraview \
    "-DParaView_DIR=$root/usr/lib/$architecture/cmake/paraview-5.11" "$@"
}
