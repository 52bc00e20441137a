# SPDX-License-Identifier: MIT
# Functions of demo.sh and site.sh. A script sets `name` to its own name before it sources this file in the folder of the
# repository.

say() { printf '\n== %s\n' "$*"; }
fail() { printf '%s: %s\n' "$name" "$*" >&2; exit 1; }

missing=
need() { # PACKAGE COMMAND...: adds a Debian package to $missing if the command fails
    package=$1
    shift
    "$@" >/dev/null 2>&1 || missing="$missing $package"
}
need gcc command -v cc
need make command -v make
need cmake command -v cmake

# Builds build/fathom. At the end of the script, $folder is removed and the programs in $running are stopped.
running=
build_tool() {
    folder=$(mktemp -d)
    trap clean_up EXIT
    trap 'exit 129' HUP
    trap 'exit 130' INT
    trap 'exit 143' TERM
    say 'build build/fathom'
    quietly cmake --preset default
    quietly cmake --build --preset default --target fathom_tool --parallel "$(nproc)"
    fathom=$PWD/build/fathom
}
clean_up() {
    for pid in $running; do kill "$pid" 2>/dev/null || true; done
    for pid in $running; do wait "$pid" 2>/dev/null || true; done
    rm -rf "$folder"
}
quietly() { "$@" >"$folder/log" 2>&1 || { cat "$folder/log" >&2; fail "$1 failed"; }; }

# Waits at most 10 s until the command succeeds. Returns 1 if the program that was started last ends before.
wait_for() { # FAILURE COMMAND...
    failure=$1
    shift
    tries=0
    until "$@"; do
        kill -0 "$!" 2>/dev/null || return 1
        tries=$((tries + 1))
        [ $tries -lt 100 ] || fail "$failure within 10 s"
        sleep 0.1
    done
}

simulate() { # LINK SENSOR [OPTION...]: starts a simulated sensor with the port $folder/LINK
    link=$1
    shift
    "$fathom" sim "$@" --link "$folder/$link" >"$folder/$link.log" 2>&1 &
    running="$running $!"
    wait_for "the simulated $1 did not make its port" test -e "$folder/$link" ||
        { cat "$folder/$link.log" >&2; fail "the simulated $1 did not start"; }
}
