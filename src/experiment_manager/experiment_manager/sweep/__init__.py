"""Many runs in one command: what they differ in, who makes them, where each stands.

The pool and the job array are our own. Of what docs/how_to/sweep.md says, submitit (1.5.4) has
the call of sbatch and a requeue. Its local executor starts all runs at once and kills them a
second after Ctrl-C; it reserves no run, sets time limits where none is asked for, and knows no
iterations.
"""
