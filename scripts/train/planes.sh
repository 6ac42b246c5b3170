#!/usr/bin/env bash
# Makes assets/network/planes.onnx anew: draws the training rooms, trains, exports, evaluates. What went into
# it is recorded beside it. See README.md. Usage: planes.sh [FOLDER for shards and checkpoints]
set -euo pipefail
cd "$(dirname "$0")/../.."

work=${1:-out/network}
python=/usr/bin/python3
build=build/release
tools=$build/scripts/train
shards=22
rooms_per_shard=334
views=3

[ -f $build/build.ninja ] || cmake --preset release
cmake --build $build --target make_training_set evaluate_planes
mkdir -p "$work" assets/network

shard() { # NAME FIRST_SEED ROOMS VIEWS TEXTURES
  [ -f "$work/$1.bin" ] && return
  $tools/make_training_set "$work/$1.part" "$2" "$3" "$4" "$5"
  mv "$work/$1.part" "$work/$1.bin"
}
shard validation 800000 300 1 800000
for i in $(seq 0 $((shards - 1))); do
  shard "$(printf 'train_%02d' "$i")" $((i * rooms_per_shard)) $rooms_per_shard $views "$i"
done

log=$work/training.log
: >"$log"
train() {
  $python scripts/train/train_planes.py --shards "$work/train_*.bin" \
    --validation "$work/validation.bin" --batch 8 "$@" | tee -a "$log"
}
# Pictures 128 wide first; then the whole size, with the rate falling to nothing, at last from a mean of
# the weights.
train --output "$work/1.pt" --shards "$work/train_0*.bin" --width 128 --steps 4000 --decay 0 --seed 1
train --output "$work/2.pt" --start "$work/1.pt" --steps 8000 --decay 0 --seed 3
train --output "$work/3.pt" --start "$work/2.pt" --steps 7000 --decay 1 --seed 5
train --output "$work/4.pt" --start "$work/3.pt" --steps 5000 --decay 1 --rate 2e-3 --seed 7
train --output "$work/5.pt" --start "$work/4.pt" --steps 24000 --decay 1 --rate 2e-3 --average 0.999 --seed 9
$python scripts/train/export_planes.py "$work/5.pt" assets/network/planes.onnx
grep -E '^(seed |[0-9]*[05]00 )' "$log" >assets/network/training.txt

{
  echo "Plane network, made by scripts/train/planes.sh; log in training.txt"
  echo "training: $((shards * rooms_per_shard)) rooms (seeds from 0), $views views each, 192x144"
  echo "steps of 8 pictures: 4000 at 128x96, then 8000, 7000, 5000 and 24000 (falling rate) at 192x144"
  for rooms in 20 500; do
    $tools/evaluate_planes assets/network/planes.onnx held-out $rooms | tail -1
  done
} | tee assets/network/planes.txt
