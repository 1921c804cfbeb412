#!/usr/bin/env bash
# clang-tidy with the settings of .clang-tidy.  Usage: tidy.sh BUILD_DIR [BASE]
# With BASE (a commit) only the sources that changed since then, or whose header did; otherwise all of them.
set -euo pipefail
cd "$(dirname "$0")/.."
build=$1 base=${2:-}

if [ -z "$base" ]; then
  stems=(tape robot cosim apps tests)
else
  mapfile -t stems < <(git diff --name-only "$base" -- '*.cpp' '*.hpp' '*.inl' | sed 's/\.[a-z]*$//' | sort -u)
  [ ${#stems[@]} -gt 0 ] || { echo "tidy: no source changed since $base"; exit 0; }
fi
patterns=()
for stem in "${stems[@]}"; do patterns+=("$PWD/$stem[./].*"); done
run-clang-tidy -quiet -p "$build" -j "${JOBS:-$(nproc)}" "${patterns[@]}" 2> >(grep -v 'warnings* generated' >&2)
