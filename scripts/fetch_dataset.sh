#!/usr/bin/env bash
# Downloads a public sequence from its makers' page. Usage: scripts/fetch_dataset.sh NAME [FOLDER]
# (FOLDER: PLANECAST_DATASETS, else ./datasets) or scripts/fetch_dataset.sh --list
# Each set has its own licence: read it on the page that is printed.
set -euo pipefail
cd "$(dirname "$0")/.."
checksums=scripts/dataset_checksums.txt

tum=https://cvg.cit.tum.de/rgbd/dataset
icl=https://www.doc.ic.ac.uk/~ahanda
euroc=http://robotics.ethz.ch/~asl-datasets/ijrr_euroc_mav_dataset
scenes=https://download.microsoft.com/download/2/8/5/28564B23-0828-408F-8631-23B1EFF1DAC8

# name, folder that it makes, address, page
datasets() {
  for name in xyz floor desk desk2 room rpy plant; do
    echo "fr1_$name rgbd_dataset_freiburg1_$name $tum/freiburg1/rgbd_dataset_freiburg1_$name.tgz https://cvg.cit.tum.de/data/datasets/rgbd-dataset"
  done
  for name in xyz desk; do
    echo "fr2_$name rgbd_dataset_freiburg2_$name $tum/freiburg2/rgbd_dataset_freiburg2_$name.tgz https://cvg.cit.tum.de/data/datasets/rgbd-dataset"
  done
  for pair in long_office:long_office_household st_tex_far:structure_texture_far \
    st_tex_near:structure_texture_near nst_tex_near:nostructure_texture_near_withloop; do
    folder=rgbd_dataset_freiburg3_${pair#*:}
    echo "fr3_${pair%%:*} $folder $tum/freiburg3/$folder.tgz https://cvg.cit.tum.de/data/datasets/rgbd-dataset"
  done
  for i in 0 1 2 3; do
    echo "lr_kt$i living_room_traj${i}_frei_png $icl/living_room_traj${i}_frei_png.tar.gz https://www.doc.ic.ac.uk/~ahanda/VaFRIC/iclnuim.html"
    echo "of_kt$i traj${i}_frei_png $icl/traj${i}_frei_png.tar.gz https://www.doc.ic.ac.uk/~ahanda/VaFRIC/iclnuim.html"
  done
  for name in MH_01_easy MH_02_easy MH_03_medium; do
    echo "$name $name $euroc/machine_hall/$name/$name.zip https://projects.asl.ethz.ch/datasets/euroc-mav/"
  done
  for name in V1_01_easy V1_02_medium; do
    echo "$name $name $euroc/vicon_room1/$name/$name.zip https://projects.asl.ethz.ch/datasets/euroc-mav/"
  done
  for name in chess fire heads office pumpkin redkitchen stairs; do
    echo "$name $name $scenes/$name.zip https://www.microsoft.com/en-us/research/project/rgb-d-dataset-7-scenes/"
  done
}

fail() {
  echo "fetch_dataset.sh: $*" >&2
  exit 2
}

if [ "${1:-}" = --list ]; then
  datasets | while read -r name folder address page; do echo "$name  $address"; done
  exit 0
fi
[ $# -ge 1 ] || fail "which one? --list shows them"
read -r name folder address page < <(datasets | grep "^$1 " || true) || true
[ -n "${name:-}" ] || fail "$1: no such data set; --list shows them"
target=${2:-${PLANECAST_DATASETS:-datasets}}
[ -d "$target/$folder" ] && { echo "$target/$folder: already there"; exit 0; }
command -v curl >/dev/null || fail "curl is missing (apt-get install curl)"
mkdir -p "$target"
archive=$target/${address##*/}

echo "$name: $address"
echo "page and licence: $page"
if ! curl --fail --location --silent --show-error --connect-timeout 20 --continue-at - \
  --output "$archive.part" "$address" 2>"$archive.log"; then
  reason=$(tail -n 1 "$archive.log")
  rm -f "$archive.log"
  fail "$name: cannot be downloaded, is there a network? ($reason)"
fi
rm -f "$archive.log"
mv "$archive.part" "$archive"

sum=$(sha256sum "$archive" | cut -d ' ' -f 1)
known=$(awk -v file="${archive##*/}" '$2 == file { print $1 }' "$checksums" 2>/dev/null || true)
if [ -z "$known" ]; then
  echo "$sum ${archive##*/}" >>"$checksums"
  echo "no checksum was known: recorded $sum in $checksums"
elif [ "$known" != "$sum" ]; then
  fail "$archive: its SHA-256 is $sum, expected $known; delete it and try again"
else
  echo "checksum good"
fi

# Some archives hold a folder of their own name, others only its content.
unpacked=$target/$folder.part
rm -rf "$unpacked"
mkdir -p "$unpacked"
case $archive in
  *.zip) command -v unzip >/dev/null || fail "unzip is missing (apt-get install unzip)"
         unzip -q "$archive" -d "$unpacked" ;;
  *) tar -xf "$archive" -C "$unpacked" ;;
esac
if [ -d "$unpacked/$folder" ]; then
  mv "$unpacked/$folder" "$target/$folder"
  rm -rf "$unpacked"
else
  mv "$unpacked" "$target/$folder"
fi
# 7-Scenes packs its sequences once more.
for inner in "$target/$folder"/seq-*.zip; do
  [ -e "$inner" ] && unzip -q "$inner" -d "$target/$folder" && rm "$inner"
done
rm -f "$archive"
echo "$target/$folder"
