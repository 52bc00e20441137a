#!/bin/sh
# SPDX-License-Identifier: MIT
#
# Everything that has to pass, on Debian 12: installs what is missing, builds with gcc and clang, runs all
# tests in both and under the sanitizers, builds the firmware of every machine and runs it on simulators,
# measures the coverage of src/, runs the checks of the sources, and prints the number of test cases by kind.
# The last line is "N passed, 0 failed", and the exit status 0, when all is well. With the packages in place it
# needs no root, and of the network only the one npm package that tests/firmware/rp2040 names.
#
# It takes some minutes on two cores; one preset alone: cmake --preset gcc, then build and test the same way.
set -eu
cd "$(dirname "$0")/.."
export LC_ALL=C.UTF-8

packages='gcc g++ libc6-dev make patch cmake pkg-config python3 libcmocka-dev gcovr
clang-14 clang-tidy-14 clang-format-14 libclang-rt-14-dev cppcheck valgrind
gcc-arm-none-eabi libnewlib-arm-none-eabi gcc-avr avr-libc arduino-core-avr gcc-riscv64-unknown-elf
gcc-powerpc-linux-gnu libc6-dev-powerpc-cross gcc-s390x-linux-gnu libc6-dev-s390x-cross
simavr libsimavr-dev qemu-system-arm qemu-system-misc qemu-user-static
libmodbus-dev mbpoll socat python3-pymodbus python3-serial python3-serial-asyncio'

# Any node and npm will do.
command -v node >/dev/null && command -v npm >/dev/null || packages="$packages nodejs npm"

missing=
for package in $packages; do
    case $(dpkg-query -W -f '${Status}' "$package" 2>/dev/null) in
    *' ok installed') ;;
    *) missing="$missing $package" ;;
    esac
done
if [ -n "$missing" ]; then
    echo "installing$missing"
    if [ "$(id -u)" -eq 0 ]; then as_root=env; else as_root='sudo env'; fi
    $as_root DEBIAN_FRONTEND=noninteractive apt-get -q update
    # shellcheck disable=SC2086 # a list of words
    $as_root DEBIAN_FRONTEND=noninteractive apt-get -q -y install --no-install-recommends $missing
fi

jobs=$(nproc)
results=
gates=0 # that were not met
begin() { printf '\n== %s\n' "$*"; }
stop() {
    printf '%s\n0 passed, 1 failed\n' "$*"
    exit 1
}

build() {
    begin "$1: build"
    cmake --preset "$1" || stop "$1: not configured"
    cmake --build "build-$1" --parallel "$jobs" || stop "$1: not built"
    begin "$1: test"
}
run_tests() { # PRESET [OPTION...]
    folder=build-$1
    shift
    # Half of them wait for a serial line most of the time.
    ctest --test-dir "$folder" --parallel "$((2 * jobs))" --timeout 120 --output-on-failure --no-tests=error \
        --test-output-size-passed 1000000 --test-output-size-failed 1000000 --output-junit results.xml "$@"
}

# The programs that wait for serial lines run with gcc, and with clang under its sanitizers.
for preset in gcc clang gcc-sanitize clang-sanitize; do
    case $preset in
    clang | gcc-sanitize) without='e2e|interop' ;;
    *) without=none ;;
    esac
    build "$preset"
    run_tests "$preset" --label-exclude "$without" || echo "$preset: see the failures above"
    results="$results build-$preset/results.xml"
done

# The tests in C alone reach everything; what an earlier run counted is not this run's coverage.
build coverage
find build-coverage -name '*.gcda' -exec rm {} +
run_tests coverage --label-exclude 'e2e|interop' || gates=$((gates + 1))

begin 'coverage of src/: every line and every branch'
gcovr --root . --object-directory build-coverage --filter src/ --print-summary \
    --fail-under-line 100 --fail-under-branch 100 || gates=$((gates + 1))

begin 'what it costs: the library (cmake --build build-gcc --target bench shows it as tables), and the ports'
cat build-gcc/bench.csv tests/firmware/figures.csv || gates=$((gates + 1))

begin 'test cases by kind'
# shellcheck disable=SC2086 # a list of words
exec /usr/bin/python3 tests/checks/count.py --gates "$gates" $results
