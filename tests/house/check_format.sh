#!/bin/bash
# Fails when a C++ file is not formatted as .clang-format says; run from the root of the project.
set -euo pipefail

version=14 # other versions break lines differently
formatter=
for candidate in "clang-format-$version" clang-format; do
  if command -v "$candidate" >/dev/null && [[ $("$candidate" --version) == *"version $version."* ]]; then
    formatter=$candidate
    break
  fi
done
if [[ -z $formatter ]]; then
  printf 'SKIPPED: clang-format %s is not installed (tools/install-packages test)\n' "$version"
  exit 77
fi
if git -c safe.directory='*' rev-parse --is-inside-work-tree >/dev/null 2>&1; then
  mapfile -t files < <(git -c safe.directory='*' ls-files --cached --others --exclude-standard '*.cpp' '*.hpp')
else
  mapfile -t files < <(find . -path ./build -prune -o \( -name '*.cpp' -o -name '*.hpp' \) -print)
fi
existing=()
for file in "${files[@]}"; do [[ ! -f $file ]] || existing+=("$file"); done
[[ ${#existing[@]} -gt 0 ]] || {
  printf 'found no C++ file to check\n'
  exit 1
}
if ! "$formatter" --dry-run -Werror "${existing[@]}"; then
  printf 'run: %s -i FILE\n' "$formatter"
  exit 1
fi
printf '%s files are formatted\n' "${#existing[@]}"
