#!/usr/bin/env bash
# Installs what only the long tests need, builds everything and runs them (label `full`): shells,
# batches by GNU parallel and Slurm, packages in a bare Debian, Blender, then SLAM
# with the sanitizers (build/asan, build/tsan). The quick ones are scripts/test.sh.
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
  scripts/build.sh "$preset" unit_slam planecast
  "build/$preset/test/unit_slam" --gtest_brief=1
  for mode in mono rgbd; do
    "build/$preset/planecast" track "$work/scene" -o "$work/$preset-$mode" --mode "$mode" \
      --threads 2 --quiet
  done
done
echo "all passed"
