#!/bin/sh
# Installs the library into a scratch folder, builds the outside project with it, and runs it.
#
#   run.sh BUILD_FOLDER
set -eu
export CMAKE_GENERATOR=Ninja
build=$1
here=$(cd "$(dirname "$0")" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cmake --install "$build" --prefix "$scratch/installed" --component development >/dev/null
# What is installed must do without the sources it came from.
cp -r "$here" "$scratch/project"
cmake -S "$scratch/project" -B "$scratch/build" -DCMAKE_PREFIX_PATH="$scratch/installed" >"$scratch/log" 2>&1 &&
  cmake --build "$scratch/build" >>"$scratch/log" 2>&1 || { cat "$scratch/log"; exit 1; }
"$scratch/build/calibrate_simulated"
if cmake -S "$scratch/project" -B "$scratch/other" -DCMAKE_PREFIX_PATH="$scratch/installed" \
    -DCMAKE_PROJECT_INCLUDE="$scratch/project/wrong_component.cmake" >"$scratch/log" 2>&1; then
  echo "a room that does not exist was found"
  exit 1
fi
grep -q "there is no room kitchen" "$scratch/log" || { cat "$scratch/log"; exit 1; }
