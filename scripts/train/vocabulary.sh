#!/usr/bin/env bash
# Makes assets/vocabulary/orb.bin anew: draws the built-in scenes with seeds that no test uses, three
# frames a second, and trains the tree on their features. What went into it is recorded beside it.
#   scripts/train/vocabulary.sh [folder for the pictures [folder for the vocabulary]]
# SCENES and SEEDS in the environment stand in for those below: with few of both, a trial of the script.
set -euo pipefail
cd "$(dirname "$0")/../.."

pictures=${1:-out/vocabulary}
vocabulary=${2:-assets/vocabulary}
build=build/release
seeds=${SEEDS:-101 102 103 104}
scenes=${SCENES:-tabletop corner room plane plain-room corridor stair rotation-start}
training_seed=1

scripts/build.sh release planecast train_vocabulary

sequences=()
for seed in $seeds; do
  for scene in $scenes; do
    folder=$pictures/$scene-$seed
    [ -f "$folder/planes.json" ] ||
      $build/planecast synth "$scene" -o "$folder" --seed "$seed" --fps 3 --no-progress --quiet
    sequences+=("$folder")
  done
done

mkdir -p "$vocabulary"
{
  echo "Vocabulary tree over ORB descriptors, made by scripts/train/vocabulary.sh"
  echo "scenes $scenes"
  echo "scene seeds $seeds, 3 frames a second, 640x480"
  $build/scripts/train/train_vocabulary "$vocabulary/orb.bin" $training_seed "${sequences[@]}"
} | tee "$vocabulary/orb.txt"
