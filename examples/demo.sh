#!/bin/sh
# SPDX-License-Identifier: MIT
#
# Builds Fathom and reads all three sensors, simulated, through real serial ports (pseudo terminals): less than a
# minute, no hardware. Installs what the build needs where it is missing (Debian; root or sudo), else needs
# neither root nor the network.
set -eu
cd "$(dirname "$0")/.."

say() { printf '\n== %s\n' "$*"; }
fail() { printf 'demo: %s\n' "$*" >&2; exit 1; }

# ---- what the build needs ----

missing=
if command -v dpkg-query >/dev/null; then
    for package in gcc libc6-dev make cmake; do
        case $(dpkg-query -W -f='${Status}' "$package" 2>/dev/null || true) in
            'install ok installed') ;;
            *) missing="$missing $package" ;;
        esac
    done
else
    for program in cc make cmake; do command -v "$program" >/dev/null || missing="$missing $program"; done
    [ -z "$missing" ] || fail "please install:$missing"
fi
if [ -n "$missing" ]; then
    say "installs$missing"
    if [ "$(id -u)" = 0 ]; then sudo=; else sudo=sudo; fi
    [ -z "$sudo" ] || command -v sudo >/dev/null || fail "needs root, or sudo, to install:$missing"
    export DEBIAN_FRONTEND=noninteractive
    $sudo apt-get update -qq || fail "apt-get update failed; please install:$missing"
    # shellcheck disable=SC2086  # a list of packages
    $sudo apt-get install -qq -y --no-install-recommends $missing >/dev/null || fail "could not install:$missing"
fi

# ---- the tool ----

folder=$(mktemp -d)
sims=
clean_up() {
    for pid in $sims; do kill "$pid" 2>/dev/null || true; done
    for pid in $sims; do wait "$pid" 2>/dev/null || true; done
    rm -rf "$folder"
}
trap clean_up EXIT
trap 'exit 129' HUP
trap 'exit 130' INT
trap 'exit 143' TERM

quietly() { "$@" >"$folder/log" 2>&1 || { cat "$folder/log" >&2; fail "$1 failed"; }; }

say 'builds build/fathom'
quietly cmake --preset default
quietly cmake --build --preset default --target fathom_tool --parallel "$(nproc)"
fathom=$PWD/build/fathom
"$fathom" --version

# ---- the sensors ----

simulate() { # SENSOR
    "$fathom" sim "$1" --link "$folder/$1" >"$folder/$1.log" 2>&1 &
    sims="$sims $!"
    tries=0
    until [ -e "$folder/$1" ]; do
        kill -0 "$!" 2>/dev/null || { cat "$folder/$1.log" >&2; fail "the simulated $1 did not start"; }
        tries=$((tries + 1))
        [ $tries -lt 100 ] || fail "the simulated $1 did not make its port within 10 s"
        sleep 0.1
    done
}

read_it() { # SENSOR OPTIONS
    sensor=$1
    shift
    say "fathom read $sensor --port $folder/$sensor $*"
    "$fathom" read "$sensor" --port "$folder/$sensor" "$@" || fail "reading $sensor failed"
}

for sensor in a16 a05 hps167s; do simulate $sensor; done

read_it a16 --count 10 --interval 300
read_it a05 --count 4 --interval 900
read_it hps167s --count 10 --interval 300
read_it hps167s --count 1 --format json

say 'all three were read. Yours: build/fathom read SENSOR --port /dev/ttyUSB0; build/fathom --help tells more'
