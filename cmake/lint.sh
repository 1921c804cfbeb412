#!/usr/bin/env bash
# What needs no build: layout of the sources, and that every work a source cites as [Name 2020] is listed in README.md.
set -euo pipefail
cd "$(dirname "$0")/.."

folders=()
for folder in tape robot cosim apps tests; do [ -d "$folder" ] && folders+=("$folder"); done
mapfile -t sources < <(find "${folders[@]}" -name '*.hpp' -o -name '*.cpp' -o -name '*.inl' -o -name '*.cu')

failed=0
clang-format --dry-run -Werror "${sources[@]}" || failed=1
while read -r citation; do
  grep -qF -- "- [$citation]" README.md && continue
  echo "lint: [$citation] is cited but not listed in README.md" >&2
  failed=1
done < <(grep -ohE '\[[A-Z][A-Za-z-]+ (19|20)[0-9]{2}' "${sources[@]}" | tr -d '[' | sort -u)
[ $failed -eq 0 ] && echo "lint: ${#sources[@]} sources are in order"
exit $failed
