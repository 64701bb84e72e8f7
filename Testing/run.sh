#!/usr/bin/env bash
# Builds the project and runs its tests; installs with apt-get the packages that are missing.
#
#   bash Testing/run.sh [CTEST_OPTION ...]
#
# MLIM_DATA  environment: folder of the real images; without it their tests are skipped
set -euo pipefail

repository=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# shellcheck source-path=SCRIPTDIR source=../.ci/steps.sh
source "$repository/.ci/steps.sh"

install_packages "${build_packages[@]}" "${screen_packages[@]}"
data=
if [[ -n "${MLIM_DATA:-}" ]]; then
  data=$(realpath "$MLIM_DATA")
fi
build_preset release -DBUILD_TESTING=ON "-DMLIM_DATA=$data"

say "Testing"
on_screen ctest --test-dir "$repository/build/release" --no-tests=error --output-on-failure "$@"
