#!/usr/bin/env bash
# Writes docs/benchmarks/device_tables.md: what the kernels of every shipped experiment take of a GPU, as NVRTC says, and
# the prediction that follows for the standard scenes. Usage: docs/benchmarks/generate_device.sh [PROGRAM], by default
# build/bin/mpm. It needs NVRTC and a C++ compiler, no GPU; nothing is run on one.
set -euo pipefail
cd "$(dirname "$0")/../.."
program=${1:-build/bin/mpm}
target=docs/benchmarks/device_tables.md
compiler=$("$program" list --devices | sed -n 's/^compiler: \(NVRTC [0-9.]*\).*/\1/p')
[ -n "$compiler" ] || { echo "no NVRTC: see mpm list --devices" >&2; exit 5; }

# The rows of the table of kernels that `mpm plan` prints.
kernels() { "$program" plan "$1" --backend cuda --architecture "$2" | awk '/occupancy$/ { on = 1; next } on'; }

# One row an experiment: how many kernels, the most that any takes, and which of them fills a multiprocessor least.
row() {
  kernels "$1" "$2" | awk -v name="${1#experiments/}" '
    { if ($2 > registers) registers = $2; if ($3 > shared) shared = $3; if ($5 > stack) stack = $5; spilled += $7
      if (!count++ || $9 < least) { least = $9; narrow = $1 } }
    END { printf "| `%s` | %d | %d | %d | %d | %d | %d %% (`%s`) |\n", name, count, registers, shared, stack, spilled, least, narrow }'
}

{
  echo '# What kernels take of a GPU'
  echo
  echo "Written by \`docs/benchmarks/generate_device.sh\` on $(date +%F) with $compiler; do not edit."
  echo '[What this means](device.md). These are figures of compile time: nothing was run on a GPU.'
  for architecture in sm_80 sm_90; do
    echo
    echo "## Shipped experiments, $architecture"
    echo
    echo '| experiment | kernels | registers, at most | shared memory, at most (B) | stack, at most (B) | spilled (B) | occupancy, at least (kernel) |'
    echo '|---|---:|---:|---:|---:|---:|---|'
    # Studies and material points have no plan.
    find experiments -name '*.json' ! -name standard.json | sort | while read -r file; do
      grep -q '"base"\|"material_point"' "$file" || row "$file" "$architecture"
    done
  done
  for file in experiments/benchmarks/cube_3d_rest.json experiments/benchmarks/block_2d_rest.json; do
    echo
    echo "## Kernels of $(basename "$file" .json), sm_90"
    echo
    echo '| kernel | registers | shared memory (B) | stack (B) | spilled (B) | occupancy |'
    echo '|---|---:|---:|---:|---:|---:|'
    kernels "$file" sm_90 | awk '{ printf "| `%s` | %d | %d | %d | %d | %d %% |\n", $1, $2, $3, $5, $7, $9 }'
  done
  echo
  echo '## Prediction for the standard scenes'
  echo
  echo '**Predicted, not measured.** `mpm bench --backend cuda --predict`:'
  echo
  "$program" bench --backend cuda --predict 2>/dev/null
} > "$target.part"
mv "$target.part" "$target"
