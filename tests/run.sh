#!/bin/sh
# SPDX-License-Identifier: MIT
#
# Everything that has to pass, on Debian 12, in three steps, or one test by its name.
#
#     sh tests/run.sh              before you believe a change: at most 7 minutes on two idle cores
#     sh tests/run.sh long         before you merge it: at most 18 minutes more
#     sh tests/run.sh full         once for a larger piece of work: some hours
#     sh tests/run.sh KIND NAME    builds what is needed and runs the tests of tests/KIND with this name. NAME is a
#                                  file without its ending, or a part of a test's name.
#
# A step installs the packages that are missing. If they are in place, it needs no root, and from the network only the
# npm package that tests/firmware/rp2040 names, the Python package that tests/firmware/platformio names and, for long,
# the two kernels that tests/port/kernel names; full needs the network also for the clean system of tests/tool/package.
# A step ends with a table of its stages: the seconds that each may take and took. If all tests passed, the last line
# is "N passed, 0 failed" and the exit status is 0.
set -eu
cd "$(dirname "$0")/.."
export LC_ALL=C.UTF-8 PYTHONDONTWRITEBYTECODE=1
step=${1:-short}
name=${2:-}
name=${name##*/} name=${name%.c} name=${name%.py}
jobs=$(nproc)
python=/usr/bin/python3
logs=build-logs
mkdir -p "$logs"

packages='gcc g++ libc6-dev make cmake pkg-config python3 python3-clang-14 libcmocka-dev
clang-14 clang-tidy-14 clang-format-14 libclang-rt-14-dev cppcheck doxygen valgrind
gcc-arm-none-eabi libnewlib-arm-none-eabi gcc-avr avr-libc arduino-core-avr gcc-riscv64-unknown-elf
gcc-powerpc-linux-gnu libc6-dev-powerpc-cross
simavr libsimavr-dev qemu-system-arm qemu-system-misc qemu-user-static
arduino-builder python3-venv
libmodbus-dev mbpoll socat python3-pymodbus python3-serial python3-serial-asyncio
libmosquitto-dev libyaml-dev libssl-dev mosquitto mosquitto-clients openssl
bash-completion zsh fish mandoc'
[ "$step" = short ] || packages="$packages frama-c-base why3 cvc4 z3 clang-19 llvm-19 libclang-rt-19-dev
qemu-system-x86 gcc-aarch64-linux-gnu libc6-dev-arm64-cross libfaketime
lintian debootstrap groff man-db strace dpkg-dev systemd"

# Any node and npm will do.
command -v node >/dev/null && command -v npm >/dev/null || packages="$packages nodejs npm"

install_packages() {
    missing=
    for package in $packages; do
        case $(dpkg-query -W -f '${Status}' "$package" 2>/dev/null) in
        *' ok installed') ;;
        *) missing="$missing $package" ;;
        esac
    done
    [ -n "$missing" ] || return 0
    echo "installing$missing"
    if [ "$(id -u)" -eq 0 ]; then as_root=env; else as_root='sudo env'; fi
    $as_root DEBIAN_FRONTEND=noninteractive apt-get -q update
    # shellcheck disable=SC2086 # a list of words
    $as_root DEBIAN_FRONTEND=noninteractive apt-get -q -y install --no-install-recommends $missing
}

# stage BUDGET NAME COMMAND...: goes on when it fails, and counts that. What a stage prints last may be its cases.
table=
gates=0
stage() {
    budget=$1 name=$2
    shift 2
    printf '\n== %s\n' "$name"
    began=$(date +%s)
    verdict=
    "$@" || { gates=$((gates + 1)) verdict=failed; }
    took=$(($(date +%s) - began))
    [ -n "$verdict" ] || [ "$took" -le "$budget" ] || verdict='over its budget'
    table=$(printf '%s\n%-34s %7d %7d  %s' "$table" "$name" "$budget" "$took" "$verdict")
}
show_stages() { printf '\n%-34s %7s %7s%s\n' stage 'budget' 'seconds' "$table"; }

build() { # PRESET
    if cmake --preset "$1" >"$logs/$1.configure" 2>&1 && cmake --build "build-$1" --parallel "$jobs" >"$logs/$1.build" 2>&1
    then return 0; fi
    tail -n 40 "$logs/$1.configure" "$logs/$1.build"
    printf '%s is not built\n0 passed, 1 failed\n' "$1"
    exit 1
}

results=
run_tests() { # PRESET RESULTS [OPTION...]
    folder=build-$1 output=$PWD/$logs/$2.xml
    results="$results $logs/$2.xml"
    shift 2
    # The tests of the tool wait for a serial line most of the time, so two of them share a core. A test that needs a
    # core for itself has the property PROCESSORS 2.
    ctest --test-dir "$folder" --parallel "$((2 * jobs))" --timeout "${timeout:-120}" --output-on-failure --no-tests=error \
        --quiet --output-log "$output.log" --test-output-size-passed 1000000 --test-output-size-failed 1000000 \
        --output-junit "$output" "$@" || { grep -A 200 'tests failed out of\|\*\*\*Failed' "$output.log"; return 1; }
}

show_costs() {
    cat build-gcc/bench.csv tests/firmware/figures.csv
}

# Another compiler changes nothing for the other kinds.
in_c='unit|devices|port|tool|verify' not_in_c='e2e|interop|second|long'
build_and_test() { # PRESET
    stage 100 "$1: build" build "$1"
    stage 40 "$1: tests in C" run_tests "$1" "$1" --label-regex "$in_c" --label-exclude "$not_in_c"
}

run_short() {
    stage 145 'gcc: build, firmware too' build gcc
    stage 220 'gcc: every kind of test' run_tests gcc gcc --label-exclude long
    build_and_test clang-sanitize
}

run_long() {
    stage 20 'gcc and clang-sanitize: build' build_two # where the short run has built them
    stage 110 'mutants: 400, half of changed files' mutants sample --changed --sample 400
    stage 80 'no run-time error: EVA' program proof $python tests/verify/proof/eva.py --quick
    stage 50 'codecs: WP' program wp $python tests/verify/proof/wp.py --quick
    stage 60 'coverage: each condition decides' program conditions $python tests/verify/coverage/run.py --quick
    stage 20 'states of a small line' program states $python tests/verify/states/run.py --quick
    stage 70 'interrupts at each instruction' program interrupts $python tests/firmware/interrupts/run.py --quick
    stage 110 'fuzzing: 1.5 million inputs' program fuzz $python tests/verify/fuzz/run.py
    stage 20 'chaos: 30 rounds' program chaos env FATHOM=build-gcc/fathom $python tests/tool/chaos/run.py
    stage 40 'publish: 8 kills' program broker env FATHOM=build-gcc/fathom $python tests/tool/chaos/broker.py --kills 8
    stage 40 'Debian packages' program package $python tests/tool/package/run.py --quick
    stage 210 'end to end, second, sanitized' run_tests clang-sanitize sanitized --label-regex 'e2e|interop|second'
    stage 20 'kernels: packages' $python tests/port/kernel/debian.py build-gcc/kernel
    stage 240 'tests that take longer' run_tests gcc later --label-regex long
    stage 1 'what it costs' show_costs
    export FATHOM_LONG=1
    stage 30 'tests in C, exhaustive forms' run_tests gcc long --label-regex "$in_c" --label-exclude "$not_in_c"
}
build_two() { build gcc && build clang-sanitize; }
program() { # NAME COMMAND...
    output=$logs/$1.txt
    results="$results $output"
    shift
    "$@" >"$output" 2>&1
    status=$?
    tail -n 60 "$output"
    return "$status"
}
mutants() { # NAME OPTION...
    name=mutants_$1
    shift
    program "$name" $python tests/verify/mutation/run.py "$@"
}

run_full() {
    run_long
    for preset in clang gcc-sanitize; do build_and_test "$preset"; done
    stage 300 "clang's analyzer" $python tests/checks/lint.py --analyze
    stage 1800 'no run-time error: EVA, all machines' program proof_full $python tests/verify/proof/eva.py
    stage 1800 'codecs: WP, both provers' program wp_full $python tests/verify/proof/wp.py
    stage 180 'states of larger lines' program states_full $python tests/verify/states/run.py
    stage 300 'interrupts, all pairs' program interrupts_full $python tests/firmware/interrupts/run.py
    stage 3600 'fuzzing: 10^8 executions' program fuzz_full $python tests/verify/fuzz/run.py --full
    stage 600 'chaos: 1,000 rounds' program chaos_full env FATHOM=build-gcc/fathom $python tests/tool/chaos/run.py --rounds 1000
    stage 300 'publish: 100 kills' program broker_full env FATHOM=build-gcc/fathom $python tests/tool/chaos/broker.py
    stage 300 'publish: 100 restarts, renamed sensors' program publish_restarts env FATHOM=build-gcc/fathom FATHOM_ROUNDS=100 \
        $python tests/tool/e2e/test_publish_left.py Left
    stage 120 'publish: 256 lines' $python tests/bench/publish.py build-gcc
    stage 650 'publish: memory' $python tests/bench/publish.py build-gcc --soak 580
    stage 300 'Debian packages, in a clean system' program package_full $python tests/tool/package/run.py
    timeout=900
    stage 400 'second: 1000 seeds' run_tests gcc seeds --label-regex second
    stage 600 'firmware, exhaustive forms' run_tests gcc firmware --label-regex 'firmware|long'
    unset FATHOM_LONG
    stage 2400 'mutants: all' mutants all --all
}

# Runs the tests of KIND with this name: in one process, or as scripts that CTest starts.
run_one() { # KIND NAME
    case $1 in
    unit | devices | port | tool)
        cmake -S . -B build >"$logs/one.configure" 2>&1 || { tail -n 40 "$logs/one.configure"; exit 1; }
        cmake --build build --parallel "$jobs" --target "tests_$1" >"$logs/one.build" 2>&1 ||
            { tail -n 40 "$logs/one.build"; exit 1; }
        found=2
        for program in build/tests/"$1"/test_*; do
            status=0
            "$program" "$2" >"$logs/one.txt" 2>&1 || status=$?
            [ "$status" -eq 2 ] && continue # no test of this program has the name
            cat "$logs/one.txt"
            found=$status
            [ "$status" -eq 0 ] || break
        done
        [ "$found" -eq 2 ] || exit "$found"
        [ "$1" = tool ] || [ "$1" = port ] || { echo "no test of tests/$1 has $2 in its name" >&2; exit 2; }
        ;;
    esac
    install_packages
    case $1 in
    unit | devices | port | tool) # without firmware
        folder=build-one
        echo "building all tests but firmware into $folder"
        cmake -S . -B "$folder" -DFATHOM_TESTS=ALL -DFATHOM_CHECKS=OFF >"$logs/one.configure" 2>&1 ||
            { tail -n 40 "$logs/one.configure"; exit 1; }
        cmake --build "$folder" --parallel "$jobs" >"$logs/one.build" 2>&1 ||
            { tail -n 40 "$logs/one.build"; exit 1; }
        ;;
    *)
        folder=build-gcc
        echo "building all tests into $folder"
        build gcc
        ;;
    esac
    # A test of CTest's is a file. If no file has the name, run the files that define a test with it.
    files=$2
    ctest --test-dir "$folder" --label-regex "^$1\$" -N --tests-regex "$2" | grep -q 'Test *#' ||
        files=$(grep -rlE "(def|class|TEST\\() ?\\w*$2" "tests/$1" | sed 's,.*/,,; s,\..*,,' | paste -sd '|')
    FATHOM_CASE=$2 ctest --test-dir "$folder" --label-regex "^$1\$" --tests-regex "${files:-$2}" --no-tests=error \
        --output-on-failure
}

case $step in
short) install_packages && run_short ;;
long) install_packages && run_long ;;
full) install_packages && run_full ;;
unit | devices | port | firmware | tool | verify | bench | checks)
    [ -n "$name" ] || { echo "usage: sh tests/run.sh $step NAME" >&2; exit 2; }
    run_one "$step" "$name"
    exit
    ;;
*)
    echo 'usage: sh tests/run.sh [long | full | KIND NAME]' >&2
    exit 2
    ;;
esac
show_stages
# shellcheck disable=SC2086 # a list of words
exec $python tests/checks/count.py --gates "$gates" $results
