# shellcheck shell=bash
# tools/demo --biped, sourced by tools/demo: the biped squats with 4 kg that its model does not declare; the loop is closed on
# the recording, and computed torque with the corrected model is compared with the declared one.
biped=$root/robots/biped

# squat NAME DEPLOYMENT OPTION...: a lockstep run with 4 kg in the torso from the start.
squat() {
  local name=$1 deployment=$2
  shift 2
  quietly "$name" sinew launch "$biped/squat_test/$deployment" --domain "$SINEW_DOMAIN" --duration 15 \
    --set "hand.config=$biped/payload_start.yaml" --record "$out/$name.mcap" "$@"
  echo "  $name.mcap: $(sed -n 's/.* ticks, //p' "$out/$name.log" | sed 's/, 0 overruns.*//')"
}

say "The biped squats with 4 kg that its model does not declare, every participant a process, in lockstep"
squat train deploy.yaml
sed "s#urdf: biped.urdf#urdf: $biped/biped.urdf#; s/depth_m: 0.4/depth_m: 0.33/" "$biped/reference_benchmark.yaml" \
  >"$out/reference_held_out.yaml"
squat held_out deploy.yaml --set "reference.config=$out/reference_held_out.yaml"
quietly render sinew render "$out/train.mcap" --urdf "$biped/biped.urdf" --out "$out/squat.mp4" --from 3

say "Closing the loop: what does the robot carry or rub that its model does not declare?"
sinew close-loop --model "$biped/model.yaml" "$out/train.mcap" --held-out "$out/held_out.mcap" --out "$out/found"

say "Computed torque under the 4 kg, with the declared and with the corrected model"
model_torque=(--set esn.program=sinew-inverse-dynamics --set "esn.config=$biped/esn_model.yaml"
  --set "control.config=$biped/control_computed_torque_stiff.yaml")
squat before deploy_esn.yaml "${model_torque[@]}"
squat after deploy_esn.yaml "${model_torque[@]}" --arg esn=--model --arg "esn=$out/found/model.yaml" \
  --arg control=--model --arg "control=$out/found/model.yaml"
sinew performance "$out/before.mcap" "$out/after.mcap" --config "$biped/performance.yaml" --json >"$out/performance.json"

say "Result"
cat <<TEXT
video: $out/squat.mp4
report: $out/found/report.html, corrected model: $out/found/model.yaml
tracking error (mean square) under 4 kg, same reference: $(json "$out/performance.json" \
  '"%.3g -> %.3g rad2" % (r[0]["robot"]["mean_square_error_rad2"], r[1]["robot"]["mean_square_error_rad2"])')
TEXT
