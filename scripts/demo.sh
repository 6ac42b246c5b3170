#!/usr/bin/env bash
# Installs what is missing, builds, makes the built-in sequence and puts an object on its table.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/setup.sh
scripts/build.sh release planecast
planecast=build/release/planecast
[ -f out/demo/sequence/planes.json ] || "$planecast" synth tabletop -o out/demo/sequence
"$planecast" run out/demo/sequence --scene assets/scenes/tabletop.yaml -o out/demo
echo "video:  out/demo/augmented.mp4"
echo "report: out/demo/report.html"
