#!/usr/bin/env bash
# Speed of the rig in lockstep as separate processes, as a ratio to real time, and the memory they take.
#   bench/lockstep/run.sh [SECONDS] [REPEATS]      (60 s simulated, three times)
# Reference: real time (1 x). Build first; nothing else should run on the machine.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
seconds=${1:-60}
repeats=${2:-3}
bin=$root/build/release/bin
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

for run in $(seq "$repeats"); do
  "$bin/sinew" launch "$root/robots/rig/deploy_rig.yaml" --set mode=lockstep --duration "$seconds" \
    --domain 230 --record "$work/run_$run.mcap" >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
  grep -o '[0-9.]* s in [0-9.]* s ([0-9.]* x real time)' "$work/log" | sed "s/^/run $run: /"
done
echo "resident memory at the end:"
"$bin/sinew" echo component_status "$work/run_$repeats.mcap" --json |
  python3 -c '
import json, sys
resident = {}
for line in sys.stdin:
    status = json.loads(line)
    resident[status["name"]] = status["resident_MB"]
for name, megabytes in sorted(resident.items()):
    print(f"  {name:12} {megabytes:6.1f} MB")
total = sum(resident.values())
print(f"  {len(resident)} processes {total:.1f} MB")'
