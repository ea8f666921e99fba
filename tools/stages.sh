# Stages of .ci/run and tools/nightly, and what both run. Source this file in the root of the tree, with $logs set. The log of each stage is
# $logs/STAGE.log; if a stage fails, the end of its log is printed.
mkdir -p "$logs"
rows=() waiting=() failures=0

# stage NAME COMMAND...: runs the command; stores its output, result and duration
stage() {
    local name=$1 start=$SECONDS result=ok
    shift
    "$@" </dev/null >"$logs/$name.log" 2>&1 || result=FAILED
    end_stage "$name" "$result" $((SECONDS - start)) "$*"
}

# beside NAME COMMAND...: the same in parallel to the following stages, until `join`; for commands that mostly wait
beside() {
    local name=$1
    shift
    {
        SECONDS=0
        "$@" </dev/null >"$logs/$name.log" 2>&1 && result=ok || result=FAILED
        echo "$result $SECONDS $*" >"$logs/$name.end"
    } &
    waiting+=("$name")
}

# join: waits for the stages that were started with `beside`
join() {
    local name result seconds command
    wait
    for name in "${waiting[@]}"; do
        read -r result seconds command <"$logs/$name.end"
        end_stage "$name" "$result" "$seconds" "$command"
    done
    waiting=()
}

# later NAME REASON: adds a row for what does not run here, so that no stage is missing without a word
later() {
    rows+=("$(printf '%-12s %-6s           %s' "$1" later "$2")")
}

# end_stage NAME RESULT SECONDS COMMAND: adds a row to the table; on failure, prints the end of the log
end_stage() {
    rows+=("$(printf '%-12s %-6s %5d s' "$1" "$2" "$3")")
    if [ "$2" = FAILED ]; then
        failures=$((failures + 1))
        echo "--- $1 failed: $4"
        grep -vE ' (Passed|Start) ' "$logs/$1.log" | tail -n 80
    fi
}

# print_stages: prints all stages with their durations [s], then the slowest tests
print_stages() {
    echo
    printf '%s\n' "${rows[@]}"
    printf '%-12s %-6s %5d s\n' total "" $SECONDS
    echo
    echo "slowest tests:"
    grep -HE '^ *[0-9]+/[0-9]+ Test .* sec *$' "$logs"/*.log |
        sed -E 's|.*/(\w+)\.log:.*#[0-9]+: (\S+) .* ([0-9.]+) sec *$|\3 s  \1  \2|' |
        sort -rn | head -n 10
    echo
}

# build_and_test PRESET TESTS SKIPPED CMAKE_OPTION...: TESTS and SKIPPED are regular expressions of tests to run and to skip
build_and_test() {
    local preset=$1 chosen=$2 without=$3
    shift 3
    cmake --preset "$preset" -DPELLICLE_STRICT=ON "$@" && cmake --build "build/$preset" -- --quiet &&
        ctest --test-dir "build/$preset" --output-on-failure --timeout 7200 -j 2 -R "$chosen" -E "$without"
}
