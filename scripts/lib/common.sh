# Functions that demo, test and .ci/run share. Scripts source it first: it changes to the root of the repository, and
# stores the path in `root`.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
cd "$root"
mkdir -p build
jobs=$(nproc 2>/dev/null || echo 2)

source "$root/scripts/lib/packages.sh"

fail() {
    echo "$*" >&2
    exit 1
}

# phase NAME COMMAND...: runs the command with its output in build/NAME.log. Shows its progress, adds its times to
# build/phases.txt (name, seconds by the clock, CPU seconds), and shows the end of the log when it fails.
phase() {
    local name=$1 log="build/$1.log" start=$SECONDS status ticker cpu
    shift
    show_progress "$name" "$log" &
    ticker=$!
    trap 'kill '"$ticker"' 2>/dev/null || true' EXIT
    # A subshell, because bash ignores `set -e` in a function whose status is tested.
    set +e
    {
        TIMEFORMAT='%U %S'
        time { (
            set -e
            "$@"
        ) >"$log" 2>&1; }
    } 2>"$log.cpu"
    status=$?
    set -e
    kill "$ticker" 2>/dev/null || true
    wait "$ticker" 2>/dev/null || true
    trap - EXIT
    if [[ -t 1 ]]; then printf '\r\033[K'; fi
    cpu=$(awk '{printf "%.0f", $1 + $2}' "$log.cpu")
    rm -f "$log.cpu"
    echo "$name $((SECONDS - start)) $cpu" >>build/phases.txt
    if [[ $status -ne 0 ]]; then
        {
            echo "$name failed after $((SECONDS - start)) s with status $status. The end of $root/$log:"
            explain "$log" || true  # `head` may end before its input
        } >&2
        exit "$status"
    fi
    if [[ -t 1 || $((SECONDS - start)) -ge 10 ]]; then
        printf '%-22s %4d s (%s s of CPU)\n' "$name" $((SECONDS - start)) "$cpu"
    fi
}

# Prints the important lines of a log: those about failed tests, or from the first failure of ninja on, or the end.
explain() {
    local found
    found=$(grep -n -m 1 '^FAILED: ' "$1" | cut -d: -f1 || true)
    if grep -q '% tests passed' "$1"; then
        grep -vE '^ +Start +[0-9]+: | Passed +[0-9.]+ sec$' "$1" | cut -c-400 | head -n 400
    elif [[ -n $found ]]; then
        tail -n "+$found" "$1" | grep -v '^\[[0-9]*/[0-9]*\] ' | cut -c-400 | head -n 60
    else
        tail -n 40 "$1" | cut -c-400
    fi
}

# Prints the name, the time and the counter of ninja or ctest: on a terminal in one line that changes every second, else
# in a new line every ten seconds.
show_progress() {
    local start=$SECONDS count
    while true; do
        if [[ -t 1 ]]; then sleep 1; else sleep 10; fi
        count=$(tail -n 1 "$2" 2>/dev/null | grep -oE '^\[?[ 0-9]+/[0-9]+(\]| Test)' | tr -d ' []Test' || true)
        if [[ -t 1 ]]; then
            printf '\r\033[K%-22s %4d s %s' "$1" $((SECONDS - start)) "$count"
        else
            printf '%-22s %4d s %s\n' "$1" $((SECONDS - start)) "$count"
        fi
    done
}

# build PRESET [TARGET...]: configures and builds it, with the options of `configure_options` if that is set.
build() {
    local preset=$1
    shift
    phase "$preset-configure" cmake --preset "$preset" ${configure_options:-}
    phase "$preset-build" cmake --build --preset "$preset" -j "$jobs" ${1:+--target "$@"}
}

# run_tests PRESET [CTEST-OPTION...]: prints the summary of ctest and its output about failed tests. The complete output
# is in build/PRESET-test.log.
run_tests() {
    local preset=$1
    shift
    phase "$preset-test" ctest --preset "$preset" -j "$jobs" "$@"
    sed -n '/% tests passed/,$p' "build/$preset-test.log"
}
