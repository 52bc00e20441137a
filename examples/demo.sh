#!/bin/sh
# SPDX-License-Identifier: MIT
#
# Builds the tool and reads three simulated sensors through serial ports (pseudo terminals). It takes less than a minute
# and needs no hardware. If a package of the build is missing, the script installs it, which needs Debian, and root or
# sudo. Otherwise it needs neither root nor the network.
set -eu
cd "$(dirname "$0")/.."
name=demo
. examples/prepare.sh

# ---- packages of the build ----

need libc6-dev test -e /usr/include/stdio.h
if [ -n "$missing" ]; then
    command -v apt-get >/dev/null || fail "please install:$missing"
    say "install:$missing"
    if [ "$(id -u)" = 0 ]; then sudo=; else sudo=sudo; fi
    [ -z "$sudo" ] || command -v sudo >/dev/null || fail "needs root, or sudo, to install:$missing"
    export DEBIAN_FRONTEND=noninteractive
    $sudo apt-get update -qq || fail "apt-get update failed; please install:$missing"
    # shellcheck disable=SC2086  # a list of packages
    $sudo apt-get install -qq -y --no-install-recommends $missing >/dev/null || fail "could not install:$missing"
fi

build_tool
"$fathom" --version

read_sensor() { # SENSOR OPTIONS
    sensor=$1
    shift
    say "fathom read $sensor --port $folder/$sensor $*"
    "$fathom" read "$sensor" --port "$folder/$sensor" "$@" || fail "reading $sensor failed"
}

for sensor in a16 a05 hps167s; do simulate $sensor $sensor; done

read_sensor a16 --count 10 --interval 300
read_sensor a05 --count 4 --interval 900
read_sensor hps167s --count 10 --interval 300
read_sensor hps167s --count 1 --format json

say 'To read your sensor: build/fathom read SENSOR --port /dev/ttyUSB0. See also build/fathom --help.'
