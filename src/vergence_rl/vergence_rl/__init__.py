"""The learner that commands the eye muscles: CACLA+VAR, or hindsight regression."""
