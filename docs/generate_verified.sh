#!/usr/bin/env bash
# Writes docs/verified.md: what is verified, by what, how closely, as the tests say themselves while they run. Wants the
# program built with its tests; takes a few minutes. MPM_BUILD_DIR is the build's folder, "build" unless set.
set -euo pipefail
cd "$(dirname "$0")/.."
build=${MPM_BUILD_DIR:-build}
lines=$(mktemp)
trap 'rm -f "$lines"' EXIT
for suite in conformance verification faults stability; do
  (cd "$build" && MPM_DISTANCES="$lines" nice "bin/test_$suite" '~[slow]' >/dev/null) || {
    echo "docs/generate_verified.sh: test_$suite failed; mend it first" >&2
    exit 1
  }
done
{
  cat <<'END'
# What is verified, by what, how closely

Written by `docs/generate_verified.sh` from a run of the tests: a line for each test case. [The catalogue of
cases](verification.md) says where the expected values come from. **Apart** is the largest distance of a found from an
expected value, relative to that value, in the assertions of the form *found equals expected*; **bound used** the largest
share of its bound that an assertion of the form *value below bound* used. A field is empty where a case has no such
assertion: it compares bits, words or counts, or asks several things at once. Cases with the tag `[slow]` are not run here.

To run the cases of a file: `ctest --test-dir build -R verification.bar` for `tests/verification/bar.cpp`.

END
  sort -t$'\t' -k1,1 -s "$lines" | awk -F'\t' '
    $1 != file { file = $1; printf "%s## `%s`\n\n| case | assertions | apart | bound used |\n|---|---:|---:|---:|\n", (NR > 1 ? "\n" : ""), file }
    { gsub(/\|/, "\\|", $2); printf "| %s | %s | %s | %s |\n", $2, $3, $4, $5 }'
} >docs/verified.md
echo "docs/verified.md: $(grep -c '^| ' docs/verified.md) lines"
