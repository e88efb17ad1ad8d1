#!/usr/bin/env bash
# Speed of the player alone on a recording of the rig, as a ratio to real time (required: 50).
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
result = json.load(sys.stdin)
ratio = result["recorded_s"] / result["wall_s"]
print("run '"$run"': {messages} messages, {recorded_s:.1f} s in {wall_s:.2f} s, ".format(**result) + f"{ratio:.0f} x real time")'
done
