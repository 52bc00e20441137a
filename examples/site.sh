#!/bin/sh
# SPDX-License-Identifier: MIT
#
# A site: eight lines with simulated sensors, a Mosquitto on this machine, `fathom publish`, and what a subscriber gets of it.
# It builds Fathom and ends by itself, in less than a minute. What is missing it names; it installs nothing, and needs neither
# root nor the network.
set -eu
cd "$(dirname "$0")/.."
PATH=$PATH:/usr/sbin # where Debian has the broker
name=site
. examples/prepare.sh

# ---- what it needs ----

need pkg-config command -v pkg-config
need libmosquitto-dev pkg-config --exists libmosquitto
need libyaml-dev pkg-config --exists yaml-0.1
need mosquitto command -v mosquitto
need mosquitto-clients command -v mosquitto_sub
[ -z "$missing" ] || fail "please install:$missing (on Debian: sudo apt-get install$missing)"

build_tool

# ---- the lines ----

say 'eight lines, simulated'
simulate line1 a16:1:modbus --distance 1300
simulate line2 a16:1:modbus --distance 2100
simulate line3 a05:2:modbus --distance 900
simulate line4 a05:2:modbus --distance 700
line=4
for distance in 480 2500 3000 4000; do
    line=$((line + 1))
    simulate line$line hps167s:7 --distance $distance
done

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
