#!/usr/bin/env bash
# Draws the figures of results/ again, from the measures, trials and examinations that are kept there.
set -euo pipefail
cd "$(dirname "$0")/.."
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

# draw FOLDER FIGURES ARGUMENTS...: of the report's figures the named ones, into a folder of results.
draw() {
  local folder=results/$1/figures figures=$2
  shift 2
  launch_scripts/report.sh "$@" --out "$out"
  mkdir -p "$folder"
  for figure in $figures; do cp "$out/figures/$figure.png" "$folder/"; done
}

draw paper "performance boxes motor_space conditions" results/paper
draw paper_falling_rate "performance boxes motor_space" results/paper_falling_rate
draw paper_short motor_space results/paper_short
draw demonstration "performance motor_space" results/demonstration
draw lambda lambda results/lambda results/precise/profile_precise_m_c-seed_1
draw twelve "errors activations_1_M_C" results/twelve
draw rearing "landscapes histograms" results/rearing --conditions --columns landscape,tuning --ages end
draw clinic conditions results/clinic --conditions \
  --columns "cover,acuity.right_acuity_cycles_per_deg,tuning.binocular_share_fine,test.metabolic_rate_w"
draw clinic_treatment treatments results/clinic_treatment results/clinic_untreated --conditions \
  --columns "cover.share_fused,test.share_within_1_px,cover.horizontal_deviation_pd,acuity.right_acuity_cycles_per_deg,tuning.binocular_share_fine"
.venv/bin/python results/draw_nine_positions.py results/gaze profile_gaze_m_c-seed_1 \
  results/gaze/figures/nine_positions_activations.png
