#!/usr/bin/env bash
# Draws the figures and films of this folder again; an hour, as the films need eyes of their own.
set -euo pipefail
cd "$(dirname "$0")/../.."
pictures=docs/pictures
film_of_one_stimulus=(--test-stimuli 1 --set eye_plant.stimuli.seed=4 --set 'experiment_manager.test_distances_m=[2.0]')

# Both eyes as they look at an object 0.25 m away with the least energy; loop.svg and scene.svg; scores of environments.
.venv/bin/python docs/examples/draw_eyes.py $pictures/eyes.png
.venv/bin/python docs/examples/draw_model.py $pictures
.venv/bin/python docs/examples/surgery.py $pictures/clinic_surgery.png

# A shorter demonstration; at 2 m the whole image can be fused, of nearer planes only the middle.
launch_scripts/run_experiment.sh --profile demonstration --iterations 20000 --tests 0,2000,6000 \
  "${film_of_one_stimulus[@]}" --set eyes.camera.roi_width_px=320 --set eyes.camera.roi_height_px=240 \
  --set experiment_manager.pictures_every_n_trials=5 --in-process --out runs/short
launch_scripts/inspect_bag.sh runs/short --film $pictures/learning.gif

# Five fixations of a test trial after 60,000 iterations, in simulated time.
launch_scripts/run_experiment.sh --profile gaze_m_c --iterations 60000 --tests 60000 --in-process --out runs/gaze_short
launch_scripts/run_experiment.sh --branch runs/gaze_short --iterations 60000 --tests 60000 \
  "${film_of_one_stimulus[@]}" --set task.iterations_per_trial=50 --set experiment_manager.pictures_every_n_trials=6 \
  --in-process --out runs/looking
launch_scripts/inspect_bag.sh runs/looking --film $pictures/looking.gif --rate 1

# Examinations of trained eyes; docs/model/clinic.md has the commands of the two palsies.
for examination in cover acuity stereo; do
  launch_scripts/examine.sh gaze "--$examination" --figure "$pictures/clinic_$examination.png"
done
launch_scripts/examine.sh triad --accommodation --figure $pictures/accommodation.png
