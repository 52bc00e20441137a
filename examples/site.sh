#!/bin/sh
# SPDX-License-Identifier: MIT
#
# A site: eight lines with simulated sensors, a Mosquitto on this machine, `fathom publish`, and what a subscriber gets of it.
# It builds Fathom and ends by itself, in less than a minute. What is missing it names; it installs nothing, and needs neither
# root nor the network.
set -eu
cd "$(dirname "$0")/.."
PATH=$PATH:/usr/sbin # where Debian has the broker

say() { printf '\n== %s\n' "$*"; }
fail() { printf 'site: %s\n' "$*" >&2; exit 1; }

# ---- what it needs ----

missing=
need() { # PACKAGE COMMAND...
    package=$1
    shift
    "$@" >/dev/null 2>&1 || missing="$missing $package"
}
need gcc command -v cc
need make command -v make
need cmake command -v cmake
need pkg-config command -v pkg-config
need libmosquitto-dev pkg-config --exists libmosquitto
need libyaml-dev pkg-config --exists yaml-0.1
need mosquitto command -v mosquitto
need mosquitto-clients command -v mosquitto_sub
[ -z "$missing" ] || fail "please install:$missing (on Debian: sudo apt-get install$missing)"

# ---- the tool ----

folder=$(mktemp -d)
running=
clean_up() {
    for pid in $running; do kill "$pid" 2>/dev/null || true; done
    for pid in $running; do wait "$pid" 2>/dev/null || true; done
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

# until WHAT COMMAND...: within 10 s, as long as the program that was begun last runs
until_so() {
    what=$1
    shift
    tries=0
    until "$@"; do
        kill -0 "$!" 2>/dev/null || return 1
        tries=$((tries + 1))
        [ $tries -lt 100 ] || fail "$what within 10 s"
        sleep 0.1
    done
}

# ---- the lines ----

line=0
simulate() { # SENSOR DISTANCE
    line=$((line + 1))
    "$fathom" sim "$1" --distance "$2" --link "$folder/line$line" >"$folder/line$line.log" 2>&1 &
    running="$running $!"
    until_so "line $line has no port" test -e "$folder/line$line" || { cat "$folder/line$line.log" >&2; fail "line $line did not start"; }
}

say 'eight lines, simulated'
simulate a16:1:modbus 1300
simulate a16:1:modbus 2100
simulate a05:2:modbus 900
simulate a05:2:modbus 700
for distance in 480 2500 3000 4000; do simulate hps167s:7 "$distance"; done

# ---- the broker ----

begin_broker() { # on the first port that is free
    for port in 18831 18832 18833 18834 18835 18836 18837 18838; do
        printf '%s\n' "listener $port 127.0.0.1" 'allow_anonymous true' "user $(id -un)" 'log_dest stderr' >"$folder/broker.conf"
        mosquitto -c "$folder/broker.conf" >"$folder/broker.log" 2>&1 &
        running="$running $!"
        until_so 'the broker did not begin' grep -q 'mosquitto version .* running' "$folder/broker.log" && return
    done
    cat "$folder/broker.log" >&2
    fail 'no port for the broker is free'
}

begin_broker
say "mosquitto on port $port of this machine"

# ---- the site ----

cat >"$folder/site.yaml" <<END
site: mill/north
interval: 1000
broker: {host: 127.0.0.1, port: $port}
lines:
  - port: $folder/line1
    sensors:
      - name: tank
        sensor: a16:1:modbus
        median: 3
        level: {mounting: 2300, height: 2000, capacity: 5000}
  - {port: $folder/line2, sensors: [{name: pit, sensor: "a16:1:modbus"}]}
  - {port: $folder/line3, sensors: [{name: bumper, sensor: "a05:2:modbus", probes: "1,2"}]}
  - {port: $folder/line4, sensors: [{name: dock, sensor: "a05:2:modbus", probes: "1"}]}
  - port: $folder/line5
    sensors:
      - name: gate
        sensor: hps167s:7
        interval: 500
        alarm: {when: near<500/600, unknown: on, no-response: on}
  - {port: $folder/line6, sensors: [{name: bay1, sensor: "hps167s:7"}]}
  - {port: $folder/line7, sensors: [{name: bay2, sensor: "hps167s:7"}]}
  - {port: $folder/line8, sensors: [{name: bay3, sensor: "hps167s:7"}]}
END
say 'fathom publish --check site.yaml'
"$fathom" publish --check "$folder/site.yaml"

"$fathom" publish "$folder/site.yaml" &
publisher=$!
running="$running $publisher"
say "mosquitto_sub -p $port -v -t 'fathom/#'    (40 messages)"
mosquitto_sub -h 127.0.0.1 -p "$port" -q 1 -C 40 -W 30 -v -t 'fathom/#' || fail '40 messages did not come within 30 s'

kill "$publisher"
wait "$publisher" || fail 'fathom publish did not end as it should'
say "what is retained now that it has ended"
mosquitto_sub -h 127.0.0.1 -p "$port" -q 1 -C 1 -W 5 -v -t 'fathom/mill/north/status'
say 'Yours: a file like the one above; build/fathom publish --help and examples/fathom/README.md tell what it takes'
