#!/usr/bin/env bash
# Writes docs/verified.md: what is verified, by what, how closely, as the tests say themselves while they run. Wants the
# program built with its tests; takes a quarter of an hour. With --slow it runs the cases with the tag [slow] as well, which
# takes as long again; the rows of slow cases that are not run stay as they are. --from FILE and --slow-from FILE take what
# a run of the tests has left in FILE in place of running them: MPM_DISTANCES=FILE ctest --test-dir build -LE slow, or -L slow.
# --only SUITE.FILE, as parity.bar, runs the quick cases of that file alone and leaves the rows of others as they are; it may
# be given again.
# MPM_BUILD_DIR is the build's folder, "build" unless set.
set -euo pipefail
cd "$(dirname "$0")/.."
build=${MPM_BUILD_DIR:-build}
lines=$(mktemp) slow=$(mktemp)
trap 'rm -f "$lines" "$slow"' EXIT

# run SUITE CASES FILE: appends a line for each case to the file.
run() {
  (cd "$build" && MPM_DISTANCES="$3" nice "bin/test_$1" -# "$2" >/dev/null) || {
    echo "docs/generate_verified.sh: test_$1 failed; mend it first" >&2
    exit 1
  }
}

from="" slow_from="" runs_slow="" only=()
while [[ $# -gt 0 ]]; do
  case $1 in
    --from) from=$2; shift 2 ;;
    --slow-from) slow_from=$2; shift 2 ;;
    --slow) runs_slow=1; shift ;;
    --only) only+=("$2"); shift 2 ;;
    *) echo "docs/generate_verified.sh: what is $1? See its head" >&2; exit 2 ;;
  esac
done
suites=(conformance verification faults stability parity device regression cli config)
of_this_page='the page of what is verified has the cases of the tests and no others'  # holds of the new page only
if [[ ${#only[@]} -gt 0 ]]; then
  for name in "${only[@]}"; do run "${name%%.*}" "[#${name#*.}]~[slow]~\"$of_this_page\"" "$lines"; done
elif [[ $from ]]; then
  grep -v "$of_this_page" "$from" >>"$lines"
else
  for suite in "${suites[@]}"; do run "$suite" '~[slow]' "$lines"; done
  run unit "~[slow]~$of_this_page" "$lines"
fi
# Rows of slow cases carry the day of their run.
if [[ $runs_slow ]]; then
  for suite in "${suites[@]}"; do
    if grep -q '\[slow\]' "tests/$suite"/*.cpp; then run "$suite" '[slow]' "$slow"; fi
  done
elif [[ $slow_from ]]; then
  cat "$slow_from" >>"$slow"
fi
awk -F'\t' -v day="$(date +%F)" 'BEGIN { OFS = FS } { $2 = $2 " (slow, run of " day ")"; print }' "$slow" >>"$lines"
# Those that were not run now have the row that the page has, while the tests have them.
if [[ -f docs/verified.md ]]; then
  awk -F' [|] ' -v runs="$slow" -v only="${only[*]}" '
    BEGIN {
      while ((getline line < runs) > 0) { split(line, field, "\t"); now[field[1] "\t" field[2]] = 1 }
      for (i = split(only, names, " "); i > 0; --i) { sub(/[.]/, "/", names[i]); again["tests/" names[i] ".cpp"] = 1 }
    }
    function is_in(file, name, line, found) {
      while ((getline line < file) > 0) if (index(line, "\"" name "\"")) found = 1
      close(file)
      return found
    }
    /^## / { split($0, part, "`"); file = part[2] }
    / \(slow, run of [0-9-]+\) \|/ {
      sub(/^[|] /, "", $1); gsub(/\\\|/, "|", $1); sub(/ [|]$/, "", $4)
      name = $1; sub(/ \(slow, run of [0-9-]+\)$/, "", name)
      if (!((file "\t" name) in now) && is_in(file, name)) printf "%s\t%s\t%s\t%s\t%s\n", file, $1, $2, $3, $4
      next
    }
    / \(slow, not run yet\) \|/ { next }  # written below, if it still is so
    only && /^[|] .* [|] [0-9]+ [|]/ && !(file in again) {
      sub(/^[|] /, "", $1); gsub(/\\\|/, "|", $1); sub(/ ?[|]$/, "", $4)
      printf "%s\t%s\t%s\t%s\t%s\n", file, $1, $2, $3, $4
    }' docs/verified.md >>"$lines"
fi
# A slow case that no run of this script has met yet has a row without numbers.
for file in tests/*/*.cpp; do
  awk -v RS='TEST_CASE\\(' -v file="$file" 'NR > 1 && match($0, /\) \{/) {
    head = substr($0, 1, RSTART)
    if (head ~ /\[slow\]/) { split(head, part, "\""); printf "%s\t%s\n", file, part[2] }
  }' "$file"
done | while IFS=$'\t' read -r file name; do
  grep -qF "$file	$name (slow, " "$lines" || printf '%s\t%s (slow, not run yet)\t0\t\t\n' "$file" "$name" >>"$lines"
done
{
  cat <<'END'
# What is verified, by what, how closely

Written by `docs/generate_verified.sh` from a run of the tests: a line for each test case. [The catalogue of
cases](verification.md) says where the expected values come from; a file's heading links its part of the catalogue.
**Apart** is the largest distance of a found from an expected value in the assertions of the form *found equals expected*,
relative to the expected value, or the found value itself where zero is expected. Left out are those that hold although the
two are half of the expected value or more apart: a margin holds a value near zero there. **Bound used** is the largest share of its
bound that an assertion of the form *value below bound* used. A field is empty where a case has no such assertion: it compares bits,
words or counts, or asks several things at once. Cases with the tag `[slow]` carry the day of their run; one that says *not run
yet* has not been run for this page. Not here are the
cases of `tests/figures` (`ctest --test-dir build -R figures`), which look at pictures, and the tests in Python (`ctest --test-dir build -R python`), which execute [two](python.md) [pages](lessons/7_own_body.md) and compare
what comes out with what stands there.

Each entry of CTest compares its cases with their rows, and fails where a distance or a share of a bound is more than four times
as large as the row says. Rounding differs between compilers and machines: distances below 10⁻⁹ count as 10⁻⁹, and shares of a
bound below 0.05 as 0.05. Numbers of assertions are those of the machine of the run, as some cases go over the lanes of its
registers or its threads. A case that says that it left something out on this machine is not compared, nor is a build with
sanitizers. Bounds of times have no share here.

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
