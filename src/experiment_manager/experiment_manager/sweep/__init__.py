"""Many runs in one command: what they differ in, who makes them, where each stands."""
