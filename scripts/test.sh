#!/usr/bin/env bash
# Installs what is missing, builds and runs every quick test.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/setup.sh
scripts/build.sh release
ctest --preset release -L quick --no-tests=error -j "$(nproc)" "$@"
