#!/bin/sh
# The bank of rigs as a job array: every task makes, runs and scores its shard of rigs.
#   sbatch --array=1-12 bench/rigs/slurm.sh 1000 200 /scratch/rigs build/release/bin
# then: rig_bank merge /scratch/rigs/outcomes_*.jsonl --confusion
#SBATCH --cpus-per-task=1
#SBATCH --mem=3G
#SBATCH --time=02:00:00
set -eu
first=${1:-1000} count=${2:-200} out=${3:-rigs} bin=${4:-build/release/bin}
part=${SLURM_ARRAY_TASK_ID:-1} of=${SLURM_ARRAY_TASK_COUNT:-1}
cases=$out/cases_$part reports=$out/reports_$part
mkdir -p "$cases" "$reports"
"$bin/rig_bank" make --out "$cases" --first "$first" --count "$count" --shard "$part/$of"
"$bin/rig_bank" run "$cases" --sinew "$bin/sinew" --out "$reports" --jobs 1
"$bin/rig_bank" score "$cases" --reports "$reports" --jsonl "$out/outcomes_$part.jsonl"
