#!/usr/bin/env bash
# figures_test.sh SOURCE_DIR: bench/figures.py draws and writes the table from results of one commit, and refuses two.
# Exit status 77 (skipped) without matplotlib.
set -euo pipefail
source_dir=$1
python3 -c 'import matplotlib' 2>/dev/null || { echo "skipped: matplotlib is not installed"; exit 77; }
temporary=$(mktemp -d)
trap 'rm -rf "$temporary"' EXIT

result() { # result COMMIT: one step of a small bed
  cat <<END
{"benchmark": "step", "commit": "$1", "device": "Some GPU", "precision": "float", "settings": [],
 "results": [{"scene": "bed", "stop": "quality", "solver": "apgd", "bodies": 1000, "contacts": 3300000, "applications": 61.2,
              "residual_relative": 0.00996, "polydisperse": false, "contact_iterations_per_s": 2.72e10,
              "ms": {"collision": {"median": 1.081}, "total": {"median": 8.864}}}]}
END
}
result abc1234 >"$temporary/one.json"
result def5678 >"$temporary/other.json"
(echo "["; result abc1234; echo ","; result abc1234; echo "]") >"$temporary/list.json"
printf 'above\n<!-- measured: begin -->\nold\n<!-- measured: end -->\nbelow\n' >"$temporary/README.md"

python3 "$source_dir/bench/figures.py" "$temporary/list.json" --out "$temporary" --readme "$temporary/README.md"
[ -s "$temporary/bench_steps.png" ] || { echo "no picture"; exit 1; }
grep -qF '| 1,000 | 3.30e6 | `apgd` | 61 | 0.01 v* | 8.86 ms, of which collision 1.08 ms | 2.72e10 |' "$temporary/README.md" ||
  { cat "$temporary/README.md"; exit 1; }
grep -q 'commit abc1234' "$temporary/README.md"
! grep -q '^old$' "$temporary/README.md"
grep -q '^below$' "$temporary/README.md"
if python3 "$source_dir/bench/figures.py" "$temporary/one.json" "$temporary/other.json" --out "$temporary" 2>"$temporary/error"; then
  echo "results of two commits were taken"
  exit 1
fi
grep -q 'several commits (abc1234, def5678)' "$temporary/error"
