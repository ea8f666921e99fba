# Stages of .ci/run and tools/nightly, sourced from the root of the tree with $logs set. The log of each stage is
# $logs/STAGE.log; a stage that fails prints the end of its log.
mkdir -p "$logs"
rows=() failures=0

# name, command...: runs the command, keeps its output and its seconds
stage() {
    local name=$1 start=$SECONDS result=ok
    shift
    "$@" </dev/null >"$logs/$name.log" 2>&1 || result=FAILED
    rows+=("$(printf '%-12s %-6s %5d s' "$name" "$result" $((SECONDS - start)))")
    if [ "$result" = FAILED ]; then
        failures=$((failures + 1))
        echo "--- $name failed: $*"
        grep -vE ' (Passed|Start) ' "$logs/$name.log" | tail -n 80
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
