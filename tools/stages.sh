# Stages of .ci/run and tools/nightly, sourced from the root of the tree with $logs set. The log of each stage is
# $logs/STAGE.log; a stage that fails prints the end of its log.
mkdir -p "$logs"
rows=() waiting=() failures=0

# name, command...: runs the command, keeps its output and its seconds
stage() {
    local name=$1 start=$SECONDS result=ok
    shift
    "$@" </dev/null >"$logs/$name.log" 2>&1 || result=FAILED
    end_stage "$name" "$result" $((SECONDS - start)) "$*"
}

# the same beside the stages that follow, until `join`: for what waits more than it works
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

# waits for the stages that run beside
join() {
    local name result seconds command
    wait
    for name in "${waiting[@]}"; do
        read -r result seconds command <"$logs/$name.end"
        end_stage "$name" "$result" "$seconds" "$command"
    done
    waiting=()
}

# name, result, seconds, command
end_stage() {
    rows+=("$(printf '%-12s %-6s %5d s' "$1" "$2" "$3")")
    if [ "$2" = FAILED ]; then
        failures=$((failures + 1))
        echo "--- $1 failed: $4"
        grep -vE ' (Passed|Start) ' "$logs/$1.log" | tail -n 80
    fi
}

# all stages with their seconds, then the slowest tests
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
