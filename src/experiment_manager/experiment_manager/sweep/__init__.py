"""Many runs in one command: what they differ in, where each stands, who makes them."""
