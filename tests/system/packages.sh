#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
# Makes the Debian packages of build/release, installs them in a folder that holds nothing but a
# fresh Debian 12, and uses them there: the settings are printed, a model is made, the server is
# started, a program is built with the SDK alone and asks it, and Python does. By hand, not in CI: it loads 400 MB.
#
# usage, as root: tests/system/packages.sh FOLDER
#   MIRROR   where Debian is taken from (http://deb.debian.org/debian)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

folder=${1:?usage: tests/system/packages.sh FOLDER}
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)

say() { printf '\033[1m==> %s\033[0m\n' "$*"; }

# Runs a command in the folder, with mounts that end with it.
inside() {
  unshare --mount --fork bash -c '
    set -e
    mount -t proc proc "$0/proc"
    mkdir -p "$0/dev/shm"
    mount -t tmpfs tmpfs "$0/dev/shm"
    exec chroot "$0" env -i HOME=/ LANG=C.UTF-8 PATH=/usr/sbin:/usr/bin:/sbin:/bin \
      DEBIAN_FRONTEND=noninteractive ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST "$@"' "$folder" "$@"
}

say "packages"
cpack --config build/release/CPackConfig.cmake -B build/release/packages

if [[ ! -e $folder/etc/debian_version ]]; then
  say "Debian 12 into $folder"
  command -v debootstrap >/dev/null || { apt-get -q -y update && apt-get -q -y install debootstrap; }
  debootstrap --variant=minbase bookworm "$folder" "${MIRROR:-http://deb.debian.org/debian}"
fi

say "install"
rm -rf "$folder/packages"
mkdir "$folder/packages"
cp build/release/packages/*.deb "$folder/packages"
inside apt-get -q -y -o Acquire::Retries=3 update
inside bash -c 'apt-get -q -y --reinstall --no-install-recommends install /packages/*.deb'

say "the programs run"
inside bpa-server --print-config >/dev/null
inside bpa --help >/dev/null
inside bpa-client --help >/dev/null
test -e "$folder/lib/systemd/system/bpa-server.service"
test -e "$folder/usr/share/bpa/config/rviz/bpa.rviz"

say "a program with the SDK alone"
inside apt-get -q -y --no-install-recommends install g++ cmake make
inside bash -e -c '
  mkdir -p /packages/source && cd /packages/source
  cp /usr/share/bpa/examples/04_models.cpp main.cpp
  cat >CMakeLists.txt <<TEXT
cmake_minimum_required(VERSION 3.25)
project(consumer LANGUAGES CXX)
find_package(bpa REQUIRED COMPONENTS client)
add_executable(consumer main.cpp)
target_link_libraries(consumer PRIVATE bpa::client)
TEXT
  cmake -B build . && cmake --build build'

say "it asks the server"
# A mesh of a box, 100 x 60 x 40 mm, for the library.
inside bash -e -c '
  cd /packages
  {
    echo "ply"; echo "format ascii 1.0"; echo "element vertex 8"
    echo "property float x"; echo "property float y"; echo "property float z"
    echo "element face 12"; echo "property list uchar int vertex_indices"; echo "end_header"
    for z in 0 0.04; do for y in 0 0.06; do for x in 0 0.1; do echo "$x $y $z"; done; done; done
    for face in "0 2 3" "0 3 1" "4 5 7" "4 7 6" "0 1 5" "0 5 4" \
                "2 6 7" "2 7 3" "0 4 6" "0 6 2" "1 3 7" "1 7 5"; do echo "3 $face"; done
  } >box.ply
  bpa model from-mesh box.ply --name box --library library
  bpa-server --library library --localhost & server=$!
  trap "kill $server" EXIT
  for attempt in 1 2 3 4 5 6; do
    if source/build/consumer | tee answer; then break; fi
  done
  grep -q "^box, 12[0-9]\." answer
  python3 -c "
import bpa
with bpa.Client(localhost_only=True, timeout_s=60) as client:
    assert [model[\"name\"] for model in client.models()] == bpa.Library(\"library\").names"'
say "done"
