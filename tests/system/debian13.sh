#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
# Builds and tests the committed sources in a folder that holds a Debian 13: Fast DDS 3, PCL 1.15,
# Embree 4. By hand, not in CI: it takes half an hour and 4 GB. A second run builds what has changed.
#
# usage, as root: tests/system/debian13.sh FOLDER [CTEST-OPTION...]
#   MIRROR   where Debian is taken from (http://deb.debian.org/debian)
#   TARGETS  what to build and not to test, such as "bpa_wire bpa-server"; everything otherwise
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

folder=${1:?usage: tests/system/debian13.sh FOLDER [CTEST-OPTION...]}
shift
mirror=${MIRROR:-http://deb.debian.org/debian}
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)

say() { printf '\033[1m==> %s\033[0m\n' "$*"; }

# Debian 13's names of what config/apt-packages*.txt list.
packages() {
  sed -e 's/#.*//' -e 's/[[:space:]]//g' -e '/^$/d' -e 's/^libfastrtps-dev$/libfastdds-dev/' \
    config/apt-packages.txt config/apt-packages-tests.txt
}

# Runs a command in the folder, with mounts that end with it. The network is this machine's.
inside() {
  unshare --mount --fork bash -c '
    set -e
    mount -t proc proc "$0/proc"
    mkdir -p "$0/dev/shm"
    mount -t tmpfs tmpfs "$0/dev/shm"
    exec chroot "$0" env -i HOME=/ LANG=C.UTF-8 PATH=/usr/sbin:/usr/bin:/sbin:/bin \
      DEBIAN_FRONTEND=noninteractive "$@"' "$folder" "$@"
}

if [[ ! -e $folder/etc/debian_version ]]; then
  say "Debian 13 into $folder"
  command -v debootstrap >/dev/null || { apt-get -q -y update && apt-get -q -y install debootstrap; }
  debootstrap --variant=minbase trixie "$folder" "$mirror"
fi

say "packages"
mapfile -t wanted < <(packages)
inside apt-get -q -y -o Acquire::Retries=3 update
inside apt-get -q -y -o Acquire::Retries=3 install --no-install-recommends "${wanted[@]}"

say "sources"
mkdir -p "$folder/bpa" "$folder/bpa.new"
git archive HEAD | tar -x -C "$folder/bpa.new"
# Only what has changed gets a new time, so that a second run builds only that.
inside bash -c 'cd /bpa.new && find . -type f | while read -r file; do
  cmp -s "$file" "/bpa/$file" || install -D -m "$(stat -c %a "$file")" "$file" "/bpa/$file"; done'
rm -rf "$folder/bpa.new"

say "build"
inside cmake -S /bpa -B /bpa/build/release -G Ninja -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_COMPILE_WARNING_AS_ERROR=ON
if [[ -n ${TARGETS:-} ]]; then
  read -r -a targets <<<"$TARGETS"
  inside cmake --build /bpa/build/release --target "${targets[@]}"
  exit
fi
inside cmake --build /bpa/build/release

say "test"
# No test may send a packet off the machine: in a network of its own there is only lo.
unshare --net bash -c 'ip link set lo up; "$@"' - "$(command -v bash)" -c "
  $(declare -f inside)
  folder='$folder'
  inside env ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST \
    ctest --test-dir /bpa/build/release --output-on-failure \"\$@\"" - "$@"
