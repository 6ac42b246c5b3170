#!/usr/bin/env bash
# Fuzzes readers by libFuzzer with ASan and UBSan, from the committed corpora (test/fuzz/corpus) and what
# earlier runs found (out/fuzz). Installs Clang where it is missing and builds the preset `fuzz`.
# Usage: scripts/fuzz.sh [SECONDS [READER...]] (60 seconds; all of them)
# An input that ends a reader is left in out/fuzz/READER/ with its trace in log.txt; status 1.
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${1:-60}
shift || true
readers=("$@")
[ ${#readers[@]} -gt 0 ] || readers=(gltf scene camera lists mask poses map planes tables command_line)
if [ -z "${PLANECAST_FUZZER:-}" ]; then
  scripts/setup.sh
  scripts/setup.sh clang libclang-rt-14-dev
  scripts/build.sh fuzz fuzz_readers
fi
fuzzer=${PLANECAST_FUZZER:-build/fuzz/test/fuzz_readers}

export ASAN_OPTIONS=detect_leaks=1:allocator_may_return_null=1
export LSAN_OPTIONS=suppressions=$PWD/test/sanitizers/leak.supp:print_suppressions=0
export UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1
status=0
for reader in "${readers[@]}"; do
  mkdir -p "out/fuzz/$reader/found"
  log=out/fuzz/$reader/log.txt
  # A model or picture may be large in memory for a moment; one that keeps a second is too slow.
  if PLANECAST_FUZZ=$reader "$fuzzer" -max_total_time="$seconds" -timeout=20 -rss_limit_mb=4096 \
    -max_len=65536 -artifact_prefix="out/fuzz/$reader/" -print_final_stats=1 -close_fd_mask=1 \
    "out/fuzz/$reader/found" "test/fuzz/corpus/$reader" >"$log" 2>&1; then
    runs=$(grep -o 'number_of_executed_units: [0-9]*' "$log" | tail -n 1 | grep -o '[0-9]*$')
    covered=$(grep -o ' cov: [0-9]*' "$log" | tail -n 1 | grep -o '[0-9]*$')
    echo "$reader: nothing in $seconds s, $runs inputs, $covered edges"
  else
    status=1
    echo "$reader: FAILED, see $log"
    grep -E 'ERROR: |SUMMARY: |runtime error' "$log" | head -n 3
  fi
done
exit $status
