#!/usr/bin/env bash
# Installs what Planecast needs and is missing, from Debian 12's packages. Quiet when nothing is.
# Usage: scripts/setup.sh [PACKAGE...] (others instead: what some tests need)
set -euo pipefail

packages=(
  build-essential python3 cmake ninja-build pkg-config ccache git ca-certificates
  libopencv-dev libopencv-contrib-dev libeigen3-dev libceres-dev libflann-dev liblz4-dev
  libglm-dev libosmesa6-dev libgl-dev libegl-dev libtinygltf-dev
  libdraco-dev libmeshoptimizer-dev libjpeg-dev libwebp-dev libstb-dev
  libimgui-dev libglfw3-dev libglfw3 libx11-dev
  libcli11-dev libspdlog-dev libfmt-dev nlohmann-json3-dev libyaml-cpp-dev
  libavcodec-dev libavformat-dev libavutil-dev libswscale-dev ffmpeg
  libgtest-dev libgmock-dev
)

[ $# -eq 0 ] || packages=("$@")

missing=()
for package in "${packages[@]}"; do
  status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
  [ "$status" = installed ] || missing+=("$package")
done
[ ${#missing[@]} -eq 0 ] && exit 0

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || { echo "setup.sh: run as root or install sudo; missing: ${missing[*]}" >&2; exit 2; }
  as_root=(sudo)
fi
echo "setup: installing ${#missing[@]} packages: ${missing[*]}"
log=$(mktemp)
trap 'rm -f "$log"' EXIT
export DEBIAN_FRONTEND=noninteractive
if ! { "${as_root[@]}" apt-get update -qq &&
       "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
         apt-get install -y -qq --no-install-recommends "${missing[@]}"; } >"$log" 2>&1; then
  cat "$log" >&2
  echo "setup.sh: apt-get failed" >&2
  exit 2
fi
