#!/usr/bin/env bash
# Runs the benchmark configurations and writes docs/results.md with its plots: what stands there is
# what this wrote. Usage: scripts/bench.sh [CONFIG...] (names in assets/benchmark; default: builtin
# real ablation scaling). Results stay in out/bench; BENCH_RESUME=1 keeps the runs that are complete there.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/setup.sh
scripts/build.sh release planecast
planecast=build/release/planecast
configs=("$@")
[ ${#configs[@]} -gt 0 ] || configs=(builtin real ablation scaling)
resume=()
[ -z "${BENCH_RESUME:-}" ] || resume=(--resume)
out=out/bench
mkdir -p "$out" docs
for config in "${configs[@]}"; do
  # Status 1: a run failed, and its row says so.
  "$planecast" benchmark "assets/benchmark/$config.yaml" -o "$out/$config" --cache "$out/sequences" \
    "${resume[@]}" || [ $? -eq 1 ]
done

results=$(mktemp)
trap 'rm -f "$results"' EXIT
cat >"$results" <<'TEXT'
# Results

Written by `scripts/bench.sh`: nothing here was entered by hand. Units are in the headings. ATE is the
root mean square of the aligned positions' distances to the truth over all frames of the second pass
(monocular: aligned by a similarity; RGB-D: rigidly); causal figures use each pose as it was known at
its frame. Drift and jitter are pixels by which content placed with a tap slides and trembles against
the truth. Figures of others stand in columns of their own, under a name in italics and with their
source.

TEXT
rm -rf docs/results
for config in "${configs[@]}"; do
  mkdir -p "docs/results/$config"
  cp "$out/$config/results.csv" "docs/results/$config/"
  cp "$out/$config"/plots/*.svg "docs/results/$config/" 2>/dev/null || true
  sed -e 's/^#/##/' -e "s|](plots/|](results/$config/|" "$out/$config/results.md" >>"$results"
done
cp "$results" docs/results.md
chmod 644 docs/results.md
echo "results: docs/results.md"
