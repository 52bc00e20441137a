#!/bin/sh
# SPDX-License-Identifier: MIT
#
# Builds Fathom and reads all three sensors, simulated, through real serial ports (pseudo terminals): less than a
# minute, no hardware. Installs what the build needs where it is missing (Debian; root or sudo), else needs
# neither root nor the network.
set -eu
cd "$(dirname "$0")/.."
name=demo
. examples/prepare.sh

# ---- what the build needs ----

need libc6-dev test -e /usr/include/stdio.h
if [ -n "$missing" ]; then
    command -v apt-get >/dev/null || fail "please install:$missing"
    say "installs$missing"
    if [ "$(id -u)" = 0 ]; then sudo=; else sudo=sudo; fi
    [ -z "$sudo" ] || command -v sudo >/dev/null || fail "needs root, or sudo, to install:$missing"
    export DEBIAN_FRONTEND=noninteractive
    $sudo apt-get update -qq || fail "apt-get update failed; please install:$missing"
    # shellcheck disable=SC2086  # a list of packages
    $sudo apt-get install -qq -y --no-install-recommends $missing >/dev/null || fail "could not install:$missing"
fi

build_tool
"$fathom" --version

read_it() { # SENSOR OPTIONS
    sensor=$1
    shift
    say "fathom read $sensor --port $folder/$sensor $*"
    "$fathom" read "$sensor" --port "$folder/$sensor" "$@" || fail "reading $sensor failed"
}

for sensor in a16 a05 hps167s; do simulate $sensor $sensor; done

read_it a16 --count 10 --interval 300
read_it a05 --count 4 --interval 900
read_it hps167s --count 10 --interval 300
read_it hps167s --count 1 --format json

say 'all three were read. Yours: build/fathom read SENSOR --port /dev/ttyUSB0; build/fathom --help tells more'
