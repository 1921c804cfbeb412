#!/usr/bin/env bash
# Makes the synthetic episodes of the stick task again: stick_1.h5 to stick_5.h5 in a folder. The scene stick_reference plays the real world;
# each episode has its own start, speeds, friction, adhesion, mass and noise of the landmarks. README.md says what for.
# Usage: record.sh TAPESIM FOLDER [EPISODE...]
set -euo pipefail
tapesim=$1 folder=$2
shift 2
scene=$(dirname "$0")/../scenes/stick_reference.yaml

record() {
  local name=stick_$1 set=(--set "seed=$1")
  shift
  for change in "$@"; do set+=(--set "$change"); done
  "$tapesim" run "$scene" "${set[@]}" --out "$folder/$name" --record "$folder/$name.h5" --threads 1
}

[ $# -gt 0 ] || set -- 1 2 3 4 5
for episode in "$@"; do
  case $episode in
    1) record 1 ;;
    2) record 2 script.3.speed=0.24 script.4.speed=0.17 "roll.position=[0.2454, -0.202, 0.7827]" materials.skin.mu=0.9 ;;
    3) record 3 "roll.position=[0.2474, -0.199, 0.7827]" roll.core.density=1200 script.5.speed=0.12 ;;
    4) record 4 interfaces.0.toughness=9 interfaces.2.toughness=12 script.3.speed=0.17 ;;
    5) record 5 "roll.position=[0.2444, -0.201, 0.7827]" materials.abs.mu=0.5 materials.steel.mu=0.25 script.4.speed=0.22 roll.core.density=850 ;;
    *) echo "no episode $episode" >&2 && exit 2 ;;
  esac
done
