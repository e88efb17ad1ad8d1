#!/usr/bin/env bash
# Speed of the player alone on a recording of the rig, as a ratio to the rig's time (required: 50).
#   bench/player/run.sh [SECONDS] [REPEATS]      (60 s recorded, played three times)
# All topics of the recording but those that command and the status. Build first; nothing else should run on the machine.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
seconds=${1:-60}
repeats=${2:-3}
bin=$root/build/release/bin
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$bin/sinew" launch "$root/robots/rig/deploy_rig.yaml" --set mode=lockstep --duration "$seconds" \
  --domain 209 --record "$work/run.mcap" >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
for run in $(seq "$repeats"); do
  "$bin/sinew" replay "$work/run.mcap" --domain 209 --rate max --json |
    python3 -c '
import json, sys
seconds, run = float(sys.argv[1]), sys.argv[2]
result = json.load(sys.stdin)
ratio = seconds / result["wall_s"]
print("run %s: %d messages, %g s of the rig in %.2f s, %.0f x real time"
      % (run, result["messages"], seconds, result["wall_s"], ratio))' "$seconds" "$run"
done
