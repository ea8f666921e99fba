# A table of the 64-bit hashes of all positions and velocities at the ends of scenes, for tools/machines and tools/compilers. Source this file in the
# root of the tree; the caller defines `start COLUMN ARGUMENT...`, which runs the program of a column, and sets $failed. Columns after the first
# find in $steps how many steps the first one took.
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT

# scene and the settings that make it short: all methods, contact, refinement, gases, tools
scenes=(
    "sphere-press"
    "organ-press duration=0.2"
    "lens-capsule duration=0.05"
    "sphere-refine duration=0.1"
    "balloon duration=0.06"
    "shell-crushed duration=0.05"
    "caving-ball stop.frames=2"
    "shrinking-torus stop.frames=2"
    "hanging-sheet duration=0.05"
    "sphere-explicit duration=0.05"
)

# print_hashes COLUMN...: one row for each scene; a hash that differs from that of the first column sets failed=1
print_hashes() {
    local column entry scene settings row first hash steps=
    local table="| scene |" line="|---|"
    for column in "$@"; do table+=" $column |" line+="---|"; done
    echo "$table"
    echo "$line"
    for entry in "${scenes[@]}"; do
        read -r scene settings <<<"$entry"
        row="| $scene${settings:+, \`$settings\`} |" first= steps=
        for column in "$@"; do
            rm -rf "$place/run"
            # relative paths: those of this machine mean nothing to Windows
            start "$column" run "scenes/$scene.yaml" ${settings:+--set "$settings"} -o "$(realpath --relative-to=. "$place")/run" -q >"$place/log" 2>&1 ||
                { cat "$place/log"; failed=1; }
            hash=$(sed -n 's/.*"state_hash": "\([0-9a-f]*\)".*/\1/p' "$place/run/summary.json" 2>/dev/null)
            first=${first:-$hash}
            steps=${steps:-$(sed -n 's/.*"steps": \([0-9]*\).*/\1/p' "$place/run/summary.json" 2>/dev/null)}
            [ -n "$hash" ] && [ "$hash" = "$first" ] || failed=1
            row+=" \`${hash:-none}\` |"
        done
        echo "$row"
    done
}
