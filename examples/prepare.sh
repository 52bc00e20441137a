# SPDX-License-Identifier: MIT
# What demo.sh and site.sh share; `name`, the script's, is set before this is sourced in the repository's folder.

say() { printf '\n== %s\n' "$*"; }
fail() { printf '%s: %s\n' "$name" "$*" >&2; exit 1; }

missing=
need() { # PACKAGE COMMAND...: the package, as Debian calls it, is there if the command succeeds
    package=$1
    shift
    "$@" >/dev/null 2>&1 || missing="$missing $package"
}
need gcc command -v cc
need make command -v make
need cmake command -v cmake

# Makes build/fathom; what is in $folder, and the programs in $running, are gone when the script ends.
running=
build_tool() {
    folder=$(mktemp -d)
    trap clean_up EXIT
    trap 'exit 129' HUP
    trap 'exit 130' INT
    trap 'exit 143' TERM
    say 'builds build/fathom'
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

# Within 10 s, as long as the program that was begun last runs.
until_so() { # WHAT-FAILS COMMAND...
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

simulate() { # LINK SENSOR [OPTION...]: its port is $folder/LINK
    link=$1
    shift
    "$fathom" sim "$@" --link "$folder/$link" >"$folder/$link.log" 2>&1 &
    running="$running $!"
    until_so "the simulated $1 did not make its port" test -e "$folder/$link" ||
        { cat "$folder/$link.log" >&2; fail "the simulated $1 did not start"; }
}
