#!/usr/bin/env bash
# Writes docs/verified.md: what is verified, by what, how closely, as the tests say themselves while they run. Wants the
# program built with its tests; takes a quarter of an hour. With --slow it runs the cases with the tag [slow] as well, which
# takes as long again; without it their rows stay as they are. With --from FILE it takes what a run of all tests has left in
# FILE (MPM_DISTANCES=FILE ctest --test-dir build -LE slow) in place of running them. MPM_BUILD_DIR is the build's folder,
# "build" unless set.
set -euo pipefail
cd "$(dirname "$0")/.."
build=${MPM_BUILD_DIR:-build}
lines=$(mktemp) slow=$(mktemp)
trap 'rm -f "$lines" "$slow"' EXIT

# run SUITE CASES FILE: appends a line for each case to the file.
run() {
  (cd "$build" && MPM_DISTANCES="$3" nice "bin/test_$1" "$2" >/dev/null) || {
    echo "docs/generate_verified.sh: test_$1 failed; mend it first" >&2
    exit 1
  }
}

suites=(conformance verification faults stability parity device regression cli)
if [[ "${1:-}" == --from ]]; then
  for suite in "${suites[@]}"; do grep "^tests/$suite/" "$2" >>"$lines"; done
else
  for suite in "${suites[@]}"; do run "$suite" '~[slow]' "$lines"; done
fi
run unit '[docs]~[slow]~the page of what is verified has a line for every case that it runs' "$lines"  # not yet
# Rows of slow cases carry the day of their run.
if [[ "${1:-}" == --slow ]]; then
  for suite in verification regression; do run "$suite" '[slow]' "$slow"; done
  awk -F'\t' -v day="$(date +%F)" 'BEGIN { OFS = FS } { $2 = $2 " (slow, run of " day ")"; print }' "$slow" >>"$lines"
elif [[ -f docs/verified.md ]]; then
  awk -F' [|] ' 'BEGIN { OFS = "\t" } /^## / { split($0, part, "`"); file = part[2] }
    / \(slow, run of [0-9-]+\) \|/ { sub(/^[|] /, "", $1); sub(/ [|]$/, "", $4); print file, $1, $2, $3, $4 }' docs/verified.md >>"$lines"
fi
{
  cat <<'END'
# What is verified, by what, how closely

Written by `docs/generate_verified.sh` from a run of the tests: a line for each test case. [The catalogue of
cases](verification.md) says where the expected values come from; a file's heading links its part of the catalogue.
**Apart** is the largest distance of a found from an
expected value, relative to that value, in the assertions of the form *found equals expected* (but for values near zero, which
a margin holds); **bound used** the largest
share of its bound that an assertion of the form *value below bound* used. A field is empty where a case has no such
assertion: it compares bits, words or counts, or asks several things at once. Cases with the tag `[slow]` carry the day of
their run.

To run the cases of a file: `ctest --test-dir build -R verification.bar` for `tests/verification/bar.cpp`.

END
  # The catalogue's part of each file; a name without a folder lies in the folder of the name before.
  sort -t$'\t' -k1,1 -s "$lines" | awk -F'\t' '
    FILENAME == ARGV[1] {
      if (/^##+ /) { part = tolower($0); sub(/^#+ /, "", part); gsub(/[^a-z0-9 -]/, "", part); gsub(/ /, "-", part) }
      rest = $0
      while (match(rest, /`[a-z_\/0-9]*\.cpp`/)) {
        name = substr(rest, RSTART + 1, RLENGTH - 2); rest = substr(rest, RSTART + RLENGTH)
        if (name ~ /\//) { folder = name; sub(/[^\/]*$/, "", folder) } else name = folder name
        if (!(name in place)) place[name] = part
      }
      next
    }
    $1 != file {
      file = $1
      printf "%s## `%s`%s\n\n| case | assertions | apart | bound used |\n|---|---:|---:|---:|\n", (some++ ? "\n" : ""), file,
        file in place ? " ([catalogue](verification.md#" place[file] "))" : ""
    }
    { gsub(/\|/, "\\|", $2); printf "| %s | %s | %s | %s |\n", $2, $3, $4, $5 }' docs/verification.md -
} >docs/verified.new
mv docs/verified.new docs/verified.md
echo "docs/verified.md: $(grep -c '^| ' docs/verified.md) lines"
