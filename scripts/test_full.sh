#!/usr/bin/env bash
# Installs what only the long tests need, builds everything and runs them (label `full`): shells,
# batches by GNU parallel and Slurm, packages in a bare Debian, ... The quick ones are scripts/test.sh.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/setup.sh
scripts/setup.sh \
  zsh fish mandoc groff-base \
  parallel \
  slurmctld slurmd slurm-client munge \
  debootstrap dpkg-dev
scripts/build.sh release
ctest --preset release -L full --no-tests=error "$@"
