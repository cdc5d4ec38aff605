# What demo, test and .ci/run share. Source it first: it goes to the root of the repository, whose path is then in
# `root`.
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

# phase NAME COMMAND...: runs it with its output in build/NAME.log. Silent when all is well, but for one line on a
# terminal; else the end of the log, and the exit status of the command.
phase() {
    local name=$1 log="build/$1.log" start=$SECONDS status=0 ticker=
    shift
    if [[ -t 1 ]]; then
        show_progress "$name" "$log" &
        ticker=$!
        trap 'kill '"$ticker"' 2>/dev/null || true' EXIT
    fi
    # In a condition `set -e` would be off inside a function that is run, hence the subshell of its own.
    set +e
    (
        set -e
        "$@"
    ) >"$log" 2>&1
    status=$?
    set -e
    if [[ -n $ticker ]]; then
        kill "$ticker" 2>/dev/null || true
        wait "$ticker" 2>/dev/null || true
        trap - EXIT
        printf '\r\033[K'
    fi
    if [[ $status -ne 0 ]]; then
        {
            echo "$name failed after $((SECONDS - start)) s with status $status. The end of $root/$log:"
            explain "$log"
        } >&2
        exit "$status"
    fi
    if [[ -t 1 ]]; then printf '%-22s %4d s\n' "$name" $((SECONDS - start)); fi
}

# The lines of a log that matter: from the first failure of ninja on, or the end.
explain() {
    local found
    found=$(grep -n -m 1 '^FAILED: ' "$1" | cut -d: -f1 || true)
    if [[ -n $found ]]; then
        tail -n "+$found" "$1" | grep -v '^\[[0-9]*/[0-9]*\] ' | cut -c-400 | head -n 60
    else
        tail -n 40 "$1" | cut -c-400
    fi
}

# One line that moves on: name, time, and the counter of ninja when there is one.
show_progress() {
    local start=$SECONDS count
    while true; do
        count=$(tail -n 1 "$2" 2>/dev/null | grep -o '^\[[0-9]*/[0-9]*\]' || true)
        printf '\r\033[K%-22s %4d s %s' "$1" $((SECONDS - start)) "$count"
        sleep 1
    done
}

# build PRESET [TARGET...]: configures and builds it.
build() {
    local preset=$1
    shift
    phase "$preset-configure" cmake --preset "$preset"
    phase "$preset-build" cmake --build --preset "$preset" -j "$jobs" ${1:+--target "$@"}
}

# run_tests PRESET [CTEST-OPTION...]: on a terminal one line that moves on, else failures and the summary only; all of
# it in build/PRESET-test.log.
run_tests() {
    local preset=$1
    shift
    local log="$root/build/$preset-test.log"
    if [[ -t 1 ]]; then
        ctest --preset "$preset" -j "$jobs" --progress --output-log "$log" "$@"
    else
        ctest --preset "$preset" -j "$jobs" --output-log "$log" "$@" |
            { grep --line-buffered -vE '^ +Start +[0-9]+: | Passed +[0-9.]+ sec$' || true; }
    fi
}
