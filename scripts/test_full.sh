#!/usr/bin/env bash
# Installs what only the long tests need, builds everything and runs them (label `full`): shells,
# batches by GNU parallel and Slurm, packages in a bare Debian, Blender, then all unit tests with ASan
# and UBSan (build/asan) and SLAM with TSan (build/tsan). The quick ones are scripts/test.sh, the
# fuzzers scripts/fuzz.sh.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/setup.sh
scripts/setup.sh \
  zsh fish mandoc groff-base \
  parallel \
  slurmctld slurmd slurm-client munge \
  debootstrap dpkg-dev \
  blender python3-numpy \
  chromium chromium-driver python3-selenium xvfb xdotool
scripts/build.sh release
scripts/build.sh release system_test
ctest --preset release -L full --no-tests=error "$@"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
build/release/planecast synth tabletop -o "$work/scene" --width 320 --height 240 --count 60 --quiet

supp=$PWD/test/sanitizers
export ASAN_OPTIONS=detect_leaks=1 LSAN_OPTIONS=suppressions=$supp/leak.supp:print_suppressions=0
export UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1
export TSAN_OPTIONS=suppressions=$supp/thread.supp:halt_on_error=1
for preset in asan tsan; do
  echo "== $preset"
  # Threads beside SLAM's are the renderer's own and OpenCV's, which were built without TSan.
  units=(unit_slam)
  [ "$preset" = tsan ] || units+=(unit_render unit_engine)
  scripts/build.sh "$preset" "${units[@]}" planecast
  for unit in "${units[@]}"; do "build/$preset/test/$unit" --gtest_brief=1; done
  for mode in mono rgbd; do
    "build/$preset/planecast" track "$work/scene" -o "$work/$preset-$mode" --mode "$mode" \
      --threads 2 --quiet
  done
done
echo "all passed"
