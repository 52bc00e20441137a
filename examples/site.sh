#!/bin/sh
# SPDX-License-Identifier: MIT
#
# Builds the tool, simulates a site of eight lines, starts Mosquitto on this machine and `fathom publish`, and shows what a
# subscriber receives. It takes less than a minute. If a package is missing, the script names it. It installs nothing, and
# needs neither root nor the network.
set -eu
cd "$(dirname "$0")/.."
PATH=$PATH:/usr/sbin # the folder of the broker on Debian
name=site
. examples/prepare.sh

# ---- packages ----

need pkg-config command -v pkg-config
need libmosquitto-dev pkg-config --exists libmosquitto
need libyaml-dev pkg-config --exists yaml-0.1
need mosquitto command -v mosquitto
need mosquitto-clients command -v mosquitto_sub
[ -z "$missing" ] || fail "please install:$missing (on Debian: sudo apt-get install$missing)"

build_tool

# ---- the lines ----

say 'simulate eight lines'
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

start_broker() { # on the first free port
    for port in 18831 18832 18833 18834 18835 18836 18837 18838; do
        printf '%s\n' "listener $port 127.0.0.1" 'allow_anonymous true' "user $(id -un)" 'log_dest stderr' >"$folder/broker.conf"
        mosquitto -c "$folder/broker.conf" >"$folder/broker.log" 2>&1 &
        running="$running $!"
        wait_for 'the broker did not start' grep -q 'mosquitto version .* running' "$folder/broker.log" && return
    done
    cat "$folder/broker.log" >&2
    fail 'no port for the broker is free'
}

start_broker
say "mosquitto listens on port $port of this machine"

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
mosquitto_sub -h 127.0.0.1 -p "$port" -q 1 -C 40 -W 30 -v -t 'fathom/#' || fail 'less than 40 messages arrived within 30 s'

kill "$publisher"
wait "$publisher" || fail 'fathom publish failed at its end'
say "the retained status after the publisher has ended"
mosquitto_sub -h 127.0.0.1 -p "$port" -q 1 -C 1 -W 5 -v -t 'fathom/mill/north/status'
say 'To publish your site, write a file like the one above. See build/fathom publish --help and fathom help config.'
