#!/usr/bin/env bash
# Builds the ParaView plugin and runs its tests; installs with apt-get the packages that are missing.
# Without python3-paraview, which excludes Debian's python3-vtk9, ParaView is unpacked into build/.
#
#   bash Testing/paraview.sh [CTEST_OPTION ...]
set -euo pipefail

repository=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# shellcheck source-path=SCRIPTDIR source=../.ci/steps.sh
source "$repository/.ci/steps.sh"

install_packages "${compile_packages[@]}" "${screen_packages[@]}"
build_plugin -DBUILD_TESTING=ON

say "Testing the plugin"
on_screen ctest --test-dir "$repository/build/paraview" --no-tests=error --output-on-failure "$@"
