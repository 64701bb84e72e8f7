#!/usr/bin/env bash
# Takes the guide's pictures of ParaView, on a virtual screen, with keys and clicks as a user's.
#
#   MLIM_DATA=/path/to/images bash Documentation/screenshots.sh [FOLDER]
#
# FOLDER  for the pictures; default: this one. Look at them.
#
# Needs brain_atlas_mni_prob.vti in MLIM_DATA. Builds the plugin, and installs with apt-get the
# packages that are missing. Steps in menus are those of ParaView 5.11.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
repository=$(dirname "$here")
# shellcheck source-path=SCRIPTDIR source=../.ci/steps.sh
source "$repository/.ci/steps.sh"

# Pixels of the screen and of ParaView's window on it, below its title.
screen=1400x960
window=(1400 925)

if [[ "${1:-}" != --on-the-screen ]]; then
  target=$(realpath "${1:-$here}")
  : "${MLIM_DATA:?names the folder of the images}"
  MLIM_DATA=$(realpath "$MLIM_DATA")
  export MLIM_DATA
  install_packages "${compile_packages[@]}" "${screen_packages[@]}" openbox scrot xdotool imagemagick
  build_plugin -DBUILD_TESTING=ON
  xvfb-run -a -s "-screen 0 ${screen}x24" bash "$here/screenshots.sh" --on-the-screen "$target"
  exit
fi
target=$2

root=$(paraview_root)
scratch=$(mktemp -d)
export PV_PLUGIN_PATH=$repository/build/paraview/lib/paraview-5.11/plugins
export MLIM_READY=$scratch/ready
export MLIM_EXAMPLE_DATA=$repository/ExampleData
# Settings of nobody: no welcome, and nothing of this user is changed.
export HOME=$scratch
mkdir -p "$scratch/.config/ParaView"
printf '[General]\nGeneralSettings.ShowWelcomeDialog=false\n' \
  >"$scratch/.config/ParaView/ParaView5.11.0.ini"
openbox >"$scratch/openbox.log" 2>&1 &
manager=$!
paraview=

finish() {
  kill "$manager" ${paraview:+"$paraview"} 2>/dev/null || true
  wait || true
  rm -rf "$scratch"
}
trap finish EXIT

# start SCRIPT : ParaView with the script run in it, its window in place and its left side wide.
start() {
  local name seconds=0
  rm -f "$MLIM_READY"
  "$root/usr/bin/paraview" --script="$here/$1" >"$scratch/paraview.log" 2>&1 &
  paraview=$!
  while [[ ! -e "$MLIM_READY" ]]; do
    if ! kill -0 "$paraview" 2>/dev/null || ((++seconds > 120)); then
      tail "$scratch/paraview.log" >&2
      return 1
    fi
    sleep 1
  done
  name=$(xdotool search --onlyvisible --name "ParaView 5" | head -n 1)
  xdotool windowmove "$name" 0 0 windowsize "$name" "${window[@]}" windowfocus "$name"
  settle
  drag 297 514 430 514
  drag 200 409 200 290
  xdotool mousemove 900 600
  settle
}

# drag X Y TO_X TO_Y : a divider of the window.
drag() {
  xdotool mousemove "$1" "$2"
  sleep 0.5
  xdotool mousedown 1
  sleep 0.2
  xdotool mousemove $((($1 + $3) / 2)) $((($2 + $4) / 2))
  sleep 0.2
  xdotool mousemove "$3" "$4"
  sleep 0.2
  xdotool mouseup 1
  sleep 0.5
}

stop() {
  kill "$paraview"
  wait "$paraview" || true
  paraview=
}

# settle : until ParaView has had nothing to do for three seconds.
settle() {
  local last=-100 now quiet=0
  while ((quiet < 3)); do
    sleep 1
    now=$(awk '{ print $14 + $15 }' "/proc/$paraview/stat") # clock ticks of its processors
    if ((now - last < 8)); then
      quiet=$((quiet + 1))
    else
      quiet=0
    fi
    last=$now
  done
}

picture() {
  scrot --overwrite "$scratch/$1.png"
  convert "$scratch/$1.png" -crop "${window[0]}x${window[1]}+0+0" +repage -dither None -colors 256 \
    "PNG8:$target/$1.png"
}

keys() {
  local key
  for key in "$@"; do
    xdotool key "$key"
    sleep 0.3
  done
}

start screenshots_image.py
keys alt+l Up Up Up Up Up Right Down Down Down
picture paraview_menu
keys Return
settle
# The gear: advanced properties as well; and down to the sizes.
xdotool mousemove 405 394 click 1
sleep 1
xdotool mousemove 60 780 click --repeat 6 5
sleep 1
picture paraview_properties
xdotool mousemove 60 780 click --repeat 30 4 mousemove 405 394 click 1
keys alt+a
settle
picture paraview_mesh
stop

start screenshots_curves.py
picture paraview_curves_and_balls
stop
ls -l "$target"/paraview_*.png
