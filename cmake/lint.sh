#!/usr/bin/env bash
# What needs no build: layout of the sources, and that every work a source cites as [Name 2020] is listed in README.md.
set -euo pipefail
cd "$(dirname "$0")/.."

folders=()
for folder in tape robot cosim apps tests; do [ -d "$folder" ] && folders+=("$folder"); done
mapfile -t sources < <(find "${folders[@]}" -name '*.hpp' -o -name '*.cpp' -o -name '*.inl' -o -name '*.cu')

clang-format --dry-run -Werror "${sources[@]}"
echo "lint: ${#sources[@]} files laid out as .clang-format says"

unlisted=0
while read -r citation; do
  grep -qF -- "- [$citation]" README.md && continue
  echo "lint: [$citation] is cited but not listed in README.md" >&2
  unlisted=1
done < <(grep -ohE '\[[A-Z][A-Za-z-]+ (19|20)[0-9]{2}' "${sources[@]}" | tr -d '[' | sort -u)
exit $unlisted
