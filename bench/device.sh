#!/usr/bin/env bash
# Everything a GPU machine has to show, in one call: build, GPU tests, sanitizers, benchmarks.
#   bench/device.sh OUTPUT_DIR [stage...]     stages: build ctest tests sanitize micro scenes record ranks
# `record` writes OUTPUT_DIR/record.json, all results of scree bench that figures.py draws. `ranks` is for machines with
# two GPUs or four: the tests of ranks, a scene and `bench scaling` on each number of them, a sanitizer; figures.py draws
# OUTPUT_DIR/scaling.json. A copy of the sources without its history is told its commit by the environment variable
# SCREE_COMMIT.
# Each stage has its own log in OUTPUT_DIR and a time limit; a summary is printed last.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
out=${1:?output directory}
shift
stages=${*:-build ctest tests sanitize micro scenes}
mkdir -p "$out"
export PATH=$PATH:/usr/local/cuda/bin
bin=build/release/bin
summary=$out/summary.txt
: >"$summary"

note() { echo "$*" | tee -a "$summary"; }
stage() { # stage NAME SECONDS COMMAND...: runs it with a limit and notes how it ended
  local name=$1 limit=$2 start=$SECONDS
  shift 2
  timeout "$limit" "$@" >"$out/$name.log" 2>&1
  local status=$?
  note "$name: exit $status, $((SECONDS - start)) s"
  return $status
}
list_of() { # list_of FOLDER: its JSON files as one list
  python3 - "$1" <<'END'
import json, pathlib, sys
print(json.dumps([json.loads(p.read_text()) for p in sorted(pathlib.Path(sys.argv[1]).glob("*.json"))], indent=1))
END
}
wants() { [[ " $stages " == *" $1 "* ]]; }

note "commit ${SCREE_COMMIT:-$(git rev-parse --short HEAD 2>/dev/null || echo unknown)}, $(nvidia-smi --query-gpu=name,driver_version --format=csv,noheader)"
if wants build; then
  stage build 400 ./bootstrap build || { tail -n 40 "$out/build.log"; exit 1; }
fi
if wants ctest; then # everything that needs no GPU
  stage ctest 300 ctest --test-dir build/release -LE '^(cuda|parity)$' -j 8 --output-on-failure
  tail -n 30 "$out/ctest.log"
fi
if wants tests; then
  stage tests_cuda 240 $bin/scree_tests_cuda
  grep -E "^\[  (PASSED|FAILED|SKIPPED)|tests ran" "$out/tests_cuda.log" | tail -n 40
  if [ -x $bin/scree_tests_parity ]; then
    stage tests_parity 240 $bin/scree_tests_parity
    grep -E "^\[  (PASSED|FAILED|SKIPPED)|tests ran" "$out/tests_parity.log" | tail -n 30
  fi
fi
if wants sanitize; then
  small=(pile --steps 12 --set particles.0.count=200 --set particles.0.layers=1 --set particles.0.start=0 --quiet --force)
  for tool in memcheck racecheck; do
    stage "sanitize_$tool" 150 compute-sanitizer --tool $tool --error-exitcode 9 \
      $bin/scree run "${small[@]}" --backend cuda --out "$out/../sanitize_$tool"
    tail -n 2 "$out/sanitize_$tool.log"
  done
  stage sanitize_tests 240 compute-sanitizer --tool memcheck --error-exitcode 9 $bin/scree_tests_cuda \
    --gtest_filter='-*Random*:*Large*:*Properties*:*Oracle*'
  tail -n 3 "$out/sanitize_tests.log"
fi
if wants micro && [ -x $bin/scree_bench ]; then
  stage micro 200 $bin/scree_bench --benchmark_filter='cuda|Cuda' --benchmark_out="$out/micro.json" \
    --benchmark_out_format=json
  tail -n 60 "$out/micro.log"
fi
if wants scenes; then
  for precision in float double; do
    stage "million_$precision" 200 $bin/scree bench million --warmup 300 --steps 20 --backend cuda \
      --precision $precision --json
    cat "$out/million_$precision.log"
  done
fi
if wants record; then
  parts=$(mktemp -d)
  bench() { # bench NAME ARGUMENT...
    stage "record_$1" 150 $bin/scree bench "${@:2}" --backend cuda --json "$parts/$1.json"
    tail -n 12 "$out/record_$1.log"
  }
  bench step step --sizes 1e6
  bench step_small step --sizes 1e5
  bench exact step --sizes 1e5 --set solver.model=exact
  bench column step --sizes 1e6 --kind column
  bench iteration iteration --sizes 1e5,3e5,1e6,3e6
  bench collision collision --sizes 1e5,1e6
  bench capacity capacity --sizes 1e6,1e7
  bench solvers solvers --sizes 1e6 --layers 20 --levels 1e-1,3e-2,1e-2,1e-3,1e-4 --limit 1 \
    --solvers apgd,schwarz,gauss_seidel_colored,jacobi
  list_of "$parts" >"$out/record.json"
fi
if wants ranks; then
  gpus=$(nvidia-smi -L | grep -c '^GPU ')
  launch=(mpirun --oversubscribe)
  [ "$(id -u)" -ne 0 ] || launch+=(--allow-run-as-root)
  stage ranks_tests 120 $bin/scree_tests_parity --gtest_filter='ParityRanks*'
  grep -E "^\[  (PASSED|FAILED|SKIPPED)|tests ran" "$out/ranks_tests.log" | tail -n 20
  stage ranks_cli 200 $bin/scree_tests_cli --gtest_filter='CliRankGpus*'
  grep -E "^\[  (PASSED|FAILED|SKIPPED)|tests ran" "$out/ranks_cli.log" | tail -n 20
  parts=$(mktemp -d)
  for n in 2 4; do
    if [ "$gpus" -lt $n ]; then
      note "ranks on $n GPUs: skipped, this machine has $gpus"
      continue
    fi
    stage "ranks_run_$n" 60 "${launch[@]}" -n $n $bin/scree run pile --steps 300 --backend cuda --out "$parts/pile_$n"
    tail -n 2 "$out/ranks_run_$n.log"
    stage "ranks_scaling_$n" 150 "${launch[@]}" -n $n $bin/scree bench scaling --backend cuda --sizes 1e6,4e6 --warmup 100 \
      --steps 10 --json "$parts/scaling_$n.json"
    tail -n 8 "$out/ranks_scaling_$n.log"
    for transport in nccl hosts; do # what is measured above goes to peers
      stage "ranks_scaling_${n}_$transport" 100 "${launch[@]}" -n $n $bin/scree bench scaling --backend cuda --sizes 1e6 \
        --warmup 100 --steps 10 --transport $transport --json "$parts/scaling_${n}_$transport.json"
      tail -n 3 "$out/ranks_scaling_${n}_$transport.log"
    done
  done
  if [ "$gpus" -ge 2 ]; then
    stage ranks_memcheck 120 "${launch[@]}" -n 2 compute-sanitizer --tool memcheck --error-exitcode 9 \
      $bin/scree run pile --steps 6 --set particles.0.count=300 --backend cuda --quiet --out "$parts/checked"
    tail -n 2 "$out/ranks_memcheck.log"
  fi
  list_of "$parts" >"$out/scaling.json"
fi
logs=$(mktemp) # one archive instead of many files
(cd "$out" && tar -czf "$logs" ./*.log && rm ./*.log && cp "$logs" logs.tar.gz)
rm -f "$logs"
cat "$summary"
