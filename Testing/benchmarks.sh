#!/usr/bin/env bash
# Measures all that Testing/Benchmarks/RESULTS.md shows and writes it there, with the plot and the
# profile; installs with apt-get the packages that are missing.
#
#   bash Testing/benchmarks.sh [--quick]
#
# MLIM_DATA  environment: folder of the real images; without it they are left out
set -euo pipefail

repository=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# shellcheck source-path=SCRIPTDIR source=../.ci/steps.sh
source "$repository/.ci/steps.sh"

quick=OFF
if [[ "${1:-}" == --quick ]]; then
  quick=ON
fi
install_packages "${build_packages[@]}" "${benchmark_packages[@]}"
data=
if [[ -n "${MLIM_DATA:-}" ]]; then
  data=$(realpath "$MLIM_DATA")
fi
build_preset release "-DMLIM_DATA=$data" "-DMLIM_BENCHMARK_QUICK=$quick" -DMLIM_BUILD_BENCHMARKS=ON
cmake --build "$repository/build/release" --target benchmark-all-record
if [[ -n "$data" ]]; then
  cmake --build "$repository/build/release" --target benchmark-profile-record
fi
